#!/usr/bin/python3
"""replay.launch plays what the rviz display draws: topology, frames, and the markers around them."""
import os
import signal
import subprocess
import sys
import tempfile
import unittest

import rospy
import rostest
from visualization_msgs.msg import Marker, MarkerArray

from cloth_sim.msg import ClothFrame, ClothTopology

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import Listener, wait_until  # noqa: E402

BENCH = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'bench.yaml')
CLOTH_RUN = subprocess.check_output(
    ['catkin_find', '--first-only', '--libexec', 'cloth_sim', 'cloth_run'], text=True).strip()


class ReplayTest(unittest.TestCase):
    def test_a_bag_is_drawn(self):
        with tempfile.TemporaryDirectory() as folder:
            bag = os.path.join(folder, 'run.bag')
            subprocess.run([CLOTH_RUN, BENCH, '--set', 'phases.wait.timeout=0.2', '--duration', '2',
                            '--bag', bag], check=True, capture_output=True)
            with Listener('/cloth/scene_markers', MarkerArray) as markers, \
                    Listener('/cloth/topology', ClothTopology) as topologies, \
                    Listener('/cloth/frame', ClothFrame) as frames:
                show = subprocess.Popen(['roslaunch', 'cloth_sim', 'replay.launch', 'bag:=' + bag,
                                         'rviz:=false'], stdout=subprocess.DEVNULL)
                try:
                    self.check(markers, topologies, frames)
                finally:
                    show.send_signal(signal.SIGINT)
                    show.wait(timeout=30)

    def check(self, markers, topologies, frames):
        notched = topologies.wait(lambda topology: topology.torn_edges)
        self.assertEqual(len(notched.triangles), 3 * 2 * 16 * 16)
        frame = frames.wait(lambda frame: frame.revision == notched.revision)
        self.assertEqual(2 * len(frame.positions), 3 * len(notched.uv))

        def drawn(array):
            return {m.ns: m for m in array.markers if m.action == Marker.ADD}
        last = markers.wait(lambda array: 'text' in drawn(array) and
                            'notch' in drawn(array)['text'].text)
        self.assertEqual(set(drawn(last)), {'clamps', 'obstacles', 'text'})
        wait_until(lambda: len({m.header.stamp for m in frames.messages}) > 20, 'frames')


if __name__ == '__main__':
    rospy.init_node('replay_test')
    rostest.rosrun('cloth_sim', 'replay', ReplayTest)
