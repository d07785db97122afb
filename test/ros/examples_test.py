#!/usr/bin/python3
"""The clients of examples/ do on a live node what they say, in less than 40 lines each; those of
examples/fold, which fold_test.py runs, in less than 80."""
import os
import subprocess
import sys
import unittest

import rospy
import rostest

from cloth_sim import srv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from services import call, state  # noqa: E402

EXAMPLES = os.path.join(os.path.dirname(os.path.realpath(__file__)), os.pardir, os.pardir,
                        'examples')
LINES = {'': 40, 'core': 40, 'fold': 80}  # that an example has less than, by folder


class ExamplesTest(unittest.TestCase):
    def said_by(self, program, *arguments):
        path = subprocess.check_output(['catkin_find', '--first-only', '--libexec', 'cloth_sim',
                                        program], text=True).strip()
        client = subprocess.run([path, *arguments], capture_output=True, text=True, timeout=60)
        self.assertEqual(client.returncode, 0, client.stdout + client.stderr)
        return client.stdout + client.stderr

    def two_pieces_by(self, program):
        call('reset', srv.ResetScene, srv.ResetSceneRequest.BOTH)
        start = state()
        self.assertEqual((start.pieces, start.broken.total, start.clamps[0].held), (1, 0, 0))
        self.assertIn('two pieces', self.said_by(program))
        end = state()
        self.assertEqual(end.failure, '')
        self.assertEqual(end.pieces, 2)
        self.assertGreater(end.clamps[0].held, 0)
        self.assertGreater(end.clamps[0].pose.position.z, 0.19)  # it was lifted
        self.assertEqual(end.broken_torn, end.broken.total)
        self.assertAlmostEqual(end.mass / start.mass, 1.0, delta=1e-9)

    def test_cpp(self):
        self.two_pieces_by('tear_client')

    def test_python(self):
        self.two_pieces_by('tear_client.py')

    def test_lift(self):
        call('reset', srv.ResetScene, srv.ResetSceneRequest.BOTH)
        self.assertRegex(self.said_by('lift_client.py'), r'it holds \d+ particles')
        end = state()
        self.assertEqual(end.pieces, 1)
        self.assertGreater(end.clamps[0].held, 0)
        self.assertGreater(end.clamps[0].pose.position.z, 0.19)

    def test_random_policy(self):
        self.assertRegex(self.said_by('random_policy.py', 'cut_strip'),
                         r'^reward \d\.\d{3}, score \d\.\d{3} after 8\.0 s\n$')

    def test_they_are_short(self):
        found = [os.path.relpath(os.path.join(folder, name), EXAMPLES)
                 for folder, _, names in os.walk(EXAMPLES) for name in names
                 if not name.endswith('.pyc')]  # of random_policy.py, which another test imports
        self.assertEqual(sorted(found),
                         ['core/core_example.cpp', 'fold/fold_client.cpp', 'fold/fold_client.py',
                          'lift_client.py', 'random_policy.py', 'tear_client.cpp',
                          'tear_client.py'])
        for name in found:
            with open(os.path.join(EXAMPLES, name)) as file:
                lines = file.read().splitlines()
            self.assertLess(len(lines), LINES[os.path.dirname(name)], name)
            self.assertLessEqual(max(len(line) for line in lines), 100, name)


if __name__ == '__main__':
    rospy.init_node('examples_test')
    rostest.rosrun('cloth_sim', 'examples', ExamplesTest)
