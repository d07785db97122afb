#!/usr/bin/python3
"""Parameters of the node: a bad one ends it with one line and status 2; an unknown one is told."""
import os
import subprocess
import sys
import unittest

import rospy
import rostest
from cloth_sim import srv

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from polling import wait_until  # noqa: E402

BENCH = os.path.join(HERE, 'bench.yaml')


def node(name, **parameters):
    """Starts a node; its parameters go with its name, so that no node sees another's."""
    for key, value in parameters.items():
        rospy.set_param('/%s/%s' % (name, key), value)
    path = subprocess.check_output(['catkin_find', '--first-only', '--libexec', 'cloth_sim',
                                    'cloth_node'], text=True).strip()
    return subprocess.Popen([path, '__name:=' + name], stderr=subprocess.PIPE, text=True)


class ParametersTest(unittest.TestCase):
    def ends_with_2(self, name, says, **parameters):
        process = node(name, **parameters)
        _, errors = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 2, errors)
        lines = [line for line in errors.splitlines() if line.startswith('cloth_node: ')]
        self.assertEqual(len(lines), 1, errors)
        for word in says:
            self.assertIn(word, lines[0])

    def test_bad_values(self):
        self.ends_with_2('bad1', ['/bad1/rate_state', '> 0'], scene=BENCH, rate_state=-1.0)
        self.ends_with_2('bad2', ['/bad2/threads', 'whole number'], scene=BENCH, threads='two')
        self.ends_with_2('bad3', ['/bad3/paused', 'true or false'], scene=BENCH, paused=1)
        self.ends_with_2('bad4', ['/bad4/real_time_factor'], scene=BENCH, real_time_factor=-2)
        self.ends_with_2('bad5', ['/bad5/set', 'list of strings'], scene=BENCH, set='a=b')
        self.ends_with_2('bad10', ['/bad10/quasi_static', 'true or false', 'banana'], scene=BENCH,
                         quasi_static='banana')
        self.ends_with_2('bad11', ['/bad11/wind_x', 'a number'], scene=BENCH, wind_x=[1.0])
        self.ends_with_2('bad6', ['/bad6/world_frame'], scene=BENCH, world_frame='')

    def test_bad_cameras(self):
        for k, (camera, says) in enumerate([
                ({'frame': 'eye', 'fow': 60.0}, ['camera', 'fow', 'fov']),
                ({'frame': 'eye', 'fov': 0}, ['camera/fov', '>= 1 and <= 170', 'got 0']),
                ({'frame': 'eye', 'size': [320]}, ['camera/size', 'two whole numbers']),
                ({'frame': 'eye', 'size': [320, 2000]}, ['camera/size', '<= 1920']),
                ({'frame': 'eye', 'size': [320, 24.5]}, ['camera/size', 'whole numbers']),
                ({'frame': 'eye', 'near': 0}, ['camera/near', '> 0']),
                ({'frame': 'eye', 'near': 2.0, 'far': 1.0}, ['camera', 'far > near']),
                ({'frame': 'eye', 'rate': 'often'}, ['camera/rate', 'a number']),
                ({'frame': ''}, ['camera', 'tf frame']),
                ({'frame': 7}, ['camera/frame', 'tf frame']),
                ({'fov': 60.0}, ['camera', 'tf frame']),
                ('eye', ['camera', 'a map'])]):
            self.ends_with_2('bad_camera%d' % k, says, scene=BENCH, camera=camera)

    def test_bad_scenes(self):
        self.ends_with_2('bad7', ['no_such_scene', 'tear_seam'], scene='no_such_scene')
        self.ends_with_2('bad8', ['bench.yaml', 'cloth.fabric.areal_density'], scene=BENCH,
                         set=['cloth.fabric.areal_density=-1'])
        self.ends_with_2('bad9', ['bench.yaml', 'gravitation'], scene=BENCH, set=['gravitation=1'])

    def test_good_ones_run_and_unknown_ones_are_told(self):
        process = node('good', scene=BENCH, rate_marker=5.0, gravity=3,
                       quasi_static=True, real_time_factor=2, paused=False,
                       set=['cloth.particles=[9, 9]'])
        try:
            rospy.wait_for_service('/good/get_state', 30.0)
            get_state = rospy.ServiceProxy('/good/get_state', srv.GetState)
            self.assertEqual(get_state().state.particles, 81)
            wait_until(lambda: get_state().state.step > 3, 'steps')
        finally:
            process.terminate()
            _, errors = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 0, errors)
        self.assertIn('did you mean rate_markers?', errors)


if __name__ == '__main__':
    rospy.init_node('parameters_test')
    rostest.rosrun('cloth_sim', 'parameters', ParametersTest)
