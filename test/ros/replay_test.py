#!/usr/bin/python3
"""replay.launch shows a bag without the simulation."""
import os
import signal
import subprocess
import sys
import tempfile
import unittest

import rospy
import rostest
from visualization_msgs.msg import Marker, MarkerArray

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
            with Listener('/cloth/markers', MarkerArray) as markers:
                show = subprocess.Popen(['roslaunch', 'cloth_sim', 'replay.launch', 'bag:=' + bag,
                                         'rviz:=false'], stdout=subprocess.DEVNULL)
                try:
                    self.check(markers)
                finally:
                    show.send_signal(signal.SIGINT)
                    show.wait(timeout=30)

    def check(self, markers):
        def drawn(array):
            return {m.ns: m for m in array.markers if m.action == Marker.ADD}
        last = markers.wait(lambda array: 'torn_edges' in drawn(array))  # it has been notched
        self.assertGreaterEqual(set(drawn(last)), {'cloth', 'clamps', 'obstacles', 'text'})
        self.assertEqual(len(drawn(last)['cloth'].points), 3 * 2 * 16 * 16)
        # The text is that of the last state, which is recorded less often than frames.
        markers.wait(lambda array: 'text' in drawn(array) and 'notch' in drawn(array)['text'].text)
        wait_until(lambda: len({m.markers[0].header.stamp for m in markers.messages}) > 20,
                   'frames')


if __name__ == '__main__':
    rospy.init_node('replay_test')
    rostest.rosrun('cloth_sim', 'replay', ReplayTest)
