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
                    Listener('/cloth/frame', ClothFrame) as frames, \
                    Listener('/cloth/markers', MarkerArray) as cloth:
                show = subprocess.Popen(['roslaunch', 'cloth_sim', 'replay.launch', 'bag:=' + bag,
                                         'rviz:=false'], stdout=subprocess.DEVNULL)
                try:
                    self.check(markers, topologies, frames)
                    self.check_markers(cloth)
                finally:
                    show.send_signal(signal.SIGINT)
                    show.wait(timeout=30)

    def check_markers(self, cloth):
        """Without the plugin of rviz, this topic has everything."""
        last = cloth.wait(lambda array: {m.ns: m.action for m in array.markers} ==
                          {'cloth': Marker.ADD, 'torn_edges': Marker.ADD})
        surface, torn = last.markers
        self.assertEqual(len(surface.points), 3 * 2 * 16 * 16)
        self.assertEqual(len(surface.colors), len(surface.points))
        self.assertGreater(len(torn.points), 0)
        self.assertEqual(surface.header.frame_id, 'world')
        cloth.wait(lambda array: 'obstacles' in {m.ns for m in array.markers})

    def test_the_fallback_without_the_plugin_says_so(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, 'rviz'), 'w') as file:
                file.write('#!/bin/sh\necho "$@"\n')
                os.chmod(file.name, 0o755)
            environment = dict(os.environ, CMAKE_PREFIX_PATH='',
                               PATH=folder + ':' + os.environ['PATH'])
            script = subprocess.check_output(['rospack', 'find', 'cloth_sim'], text=True).strip()
            shown = subprocess.run([os.path.join(script, 'scripts', 'cloth_rviz')],
                                   env=environment, capture_output=True, text=True, check=True)
        self.assertTrue(shown.stdout.endswith('markers.rviz\n'), shown.stdout)
        self.assertIn('the rviz plugin is not built', shown.stderr)
        self.assertEqual(len(shown.stderr.splitlines()), 1)

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
