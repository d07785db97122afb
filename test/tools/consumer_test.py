#!/usr/bin/python3
"""A program outside of this package builds against the public headers and links cloth_core."""
import os
import subprocess
import sys
import unittest

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scratch import ScratchTest  # noqa: E402

CONSUMER = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, 'consumer')


class ConsumerTest(ScratchTest):
    def done(self, *command):
        result = subprocess.run(command, capture_output=True, text=True, timeout=900)
        self.assertEqual(result.returncode, 0, result.stdout[-4000:] + result.stderr[-4000:])
        return result.stdout

    def test_a_program_outside_of_the_package_builds_and_runs(self):
        build = self.path('build')
        self.done('cmake', '-S', CONSUMER, '-B', build,
                  '-DPYTHON_EXECUTABLE=/usr/bin/python3')
        self.done('cmake', '--build', build)
        self.assertIn('pieces 2', self.done(os.path.join(build, 'hang')))


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'consumer', ConsumerTest)
