#!/usr/bin/python3
"""rosbag record on a live node at 128 x 128 and 30 Hz: nothing is dropped, and what is needed to
replay fits."""
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import rosbag
import rospy
import rostest
from geometry_msgs.msg import Point, Vector3

from cloth_sim import msg, srv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import wait_until  # noqa: E402
from services import call, connections, state  # noqa: E402

LAUNCH = os.path.join(os.path.dirname(os.path.realpath(__file__)), os.pardir, os.pardir, 'launch',
                      'cloth.launch')
RATE = 30.0       # of frames [Hz]
SECONDS = 6.0     # of wall time that is recorded, at least
BUDGET = 200e6    # for a run of 30 s [bytes]
NUMBERED = ('/cloth/frame', '/cloth/state', '/cloth/topology', '/cloth/broken_springs',
            '/cloth/tear_events')


def record_arguments():
    """The arguments of rosbag record in cloth.launch with compact:=false, but for the file."""
    with open(LAUNCH) as file:
        text = file.read()
    text = text.replace('$(arg record_form)', '').replace('$(arg record_frames)', '/cloth/frame')
    words = text.split('type="record"')[1].split('args="')[1].split('"')[0].split()
    words[words.index('$(arg') - 1:words.index('bag)') + 1] = []
    return words


def gaps(messages):
    """Messages that are missing between the first and the last: roscpp numbers what it sends."""
    numbers = [message.header.seq for message in messages]
    return numbers[-1] - numbers[0] + 1 - len(numbers)


def recorded():
    """Topics that the node sends to rosbag."""
    return {topic for direction, topic, other in connections()
            if direction == 'o' and other.startswith('/record')}


class RecordTest(unittest.TestCase):
    def test_nothing_is_dropped_at_128_x_128(self):
        rospy.wait_for_service('/cloth/cut', 30.0)
        with tempfile.TemporaryDirectory() as folder:
            bag = os.path.join(folder, 'run.bag')
            recorder = subprocess.Popen(['rosbag', 'record', '-O', bag, *record_arguments()],
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            try:
                wait_until(lambda: os.path.exists(bag + '.active') and
                           os.path.getsize(bag + '.active') > 1e6, 'the bag')
                wait_until(lambda: recorded().issuperset(NUMBERED + ('/cloth/commands',)),
                           'the topics to be recorded')
                start = time.monotonic()
                first = state().step
                self.cut()
                wait_until(lambda: time.monotonic() > start + SECONDS and state().step > first + 60,
                           'steps to record', deadline=60.0)
            finally:
                recorder.send_signal(signal.SIGINT)
                said = recorder.communicate(timeout=30)[0]
            self.assertNotIn('dropping', said)
            self.assertNotIn('exceeded', said)
            self.check(bag)

    def cut(self):
        """Many topologies in a row: what is sent in bursts."""
        for k in range(4):
            stroke = msg.CutStroke()
            stroke.header.frame_id = 'world'
            stroke.points = [Point(-0.1, 0.1 * k - 0.2, 0.5), Point(0.1, 0.1 * k - 0.2, 0.5)]
            stroke.direction, stroke.reach = Vector3(0, 0, -1), 1.0
            call('cut', srv.Cut, stroke)

    def check(self, path):
        messages, sizes = {}, {}
        with rosbag.Bag(path) as bag:
            for topic, message, _ in bag.read_messages():
                messages.setdefault(topic, []).append(message)
            for topic, raw, _ in bag.read_messages(raw=True):
                sizes[topic] = max(sizes.get(topic, 0), len(raw[1]))
        frames, states = messages['/cloth/frame'], messages['/cloth/state']
        rospy.loginfo('recorded %d frames, %d states, %.1f MB', len(frames), len(states),
                      os.path.getsize(path) / 1e6)
        for topic in NUMBERED:
            self.assertEqual(gaps(messages[topic]), 0, topic)
        length = (frames[-1].header.stamp - frames[0].header.stamp).to_sec()
        self.assertGreaterEqual(length, SECONDS - 1.0)
        self.assertGreater(len({frame.step for frame in frames}), 30)
        self.assertEqual([command.number for command in messages['/cloth/commands']], [0, 1, 2, 3])
        counts = {topology.revision: len(topology.uv) // 2
                  for topology in messages['/cloth/topology']}
        self.assertGreater(len(counts), 1)
        for frame in frames:
            self.assertEqual(len(frame.positions), 3 * counts[frame.revision])
        each = sum(size for topic, size in sizes.items()
                   if topic in ('/cloth/frame', '/cloth/state', '/tf') or topic.endswith('/wrench'))
        latched = sizes['/cloth/topology'] + sizes['/cloth/broken_springs']  # again every 5 s
        size = 30.0 * RATE * each + 30.0 / 5.0 * latched
        rospy.loginfo('30 s take %.1f MB', size / 1e6)
        self.assertLess(size, BUDGET)


if __name__ == '__main__':
    rospy.init_node('record_test')
    rostest.rosrun('cloth_sim', 'record', RecordTest)
