#!/usr/bin/python3
"""The pages of the C++ interface are made without a warning, and their example runs."""
import os
import subprocess
import sys
import unittest

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scratch import ScratchTest, find_program  # noqa: E402

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))


class ApiDocsTest(ScratchTest):
    def test_pages_are_made_without_a_warning(self):
        result = subprocess.run(['bash', os.path.join(ROOT, 'scripts', 'api_docs.sh'),
                                 '--out', self.path('api')], capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        pages = os.listdir(self.path('api/html'))
        self.assertIn('classcloth__sim_1_1Simulation.html', pages)
        with open(self.path('api/html/index.html'), encoding='utf-8') as page:
            self.assertIn('usage: core_example', page.read())

    def test_a_wrong_argument_is_refused_with_the_usage(self):
        result = subprocess.run(['bash', os.path.join(ROOT, 'scripts', 'api_docs.sh'), '--foo'],
                                capture_output=True, text=True)
        self.assertEqual(result.returncode, 2)
        self.assertIn("unknown argument '--foo'", result.stderr)


class ExampleTest(ScratchTest):
    def run_example(self, *arguments):
        return subprocess.run([find_program('core_example'), *arguments], capture_output=True,
                              text=True, timeout=60)

    def test_it_simulates_and_cuts(self):
        result = self.run_example(os.path.join(ROOT, 'config', 'scenes', 'hang.yaml'))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r't = 1\.00 s: the lowest particle is at z = 0\.\d+ m\n'
                                        r'cut 1.* m, \d+ springs severed')

    def test_a_scene_that_is_missing_takes_one_line(self):
        result = self.run_example(self.path('none.yaml'))
        self.assertEqual(result.returncode, 2)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)


class AllTests(unittest.TestSuite):
    def __init__(self):
        super().__init__(unittest.defaultTestLoader.loadTestsFromTestCase(case)
                         for case in (ApiDocsTest, ExampleTest))


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'api_docs_test', '__main__.AllTests')
