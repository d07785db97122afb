#!/usr/bin/python3
"""The scripts configure again when packages come, and name what was not built or not run."""
import fnmatch
import os
import pathlib
import subprocess
import sys
import unittest

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scratch import ScratchTest, find_program  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'scripts' / 'lib'))
import check_suites  # noqa: E402


class ConfigurationTest(ScratchTest):
    """drop_stale_configuration, in a workspace without a build, on a machine whose packages are in
    a file."""

    def setUp(self):
        super().setUp()
        self.installed = pathlib.Path(self.path('installed', ''))
        program = pathlib.Path(self.path('dpkg-query', f'#!/bin/sh\ncat {self.installed}\n'))
        program.chmod(0o755)
        self.workspace = pathlib.Path(self.folder.name) / 'workspace'
        self.cache = self.workspace / 'build' / 'CMakeCache.txt'
        self.object = self.workspace / 'build' / 'compiled.o'
        self.object.parent.mkdir(parents=True)
        self.prepare()

    def prepare(self, *arguments, **environment):
        """What a script does before it builds, and then what CMake and the compiler do."""
        subprocess.run(
            ['bash', '-c', 'source "$1"; shift; detect_system; drop_stale_configuration "$@"',
             'bash', ROOT / 'scripts' / 'lib' / 'common.sh', self.workspace, *arguments],
            check=True, capture_output=True,
            env={**os.environ, 'PATH': self.folder.name + ':' + os.environ['PATH'], **environment})
        self.was_dropped = not self.cache.exists()
        self.was_kept = self.object.exists()
        self.cache.parent.mkdir(exist_ok=True)
        self.cache.write_text(f'CMAKE_HOME_DIRECTORY:INTERNAL={self.workspace}/src\n')
        self.object.touch()

    def test_nothing_new_configures_nothing(self):
        self.prepare()
        self.assertFalse(self.was_dropped)

    def test_a_new_package_configures_afresh_and_keeps_what_is_compiled(self):
        self.installed.write_text('librviz-dev 1.14 installed\n')
        self.prepare()
        self.assertTrue(self.was_dropped)
        self.assertTrue(self.was_kept)
        self.prepare()
        self.assertFalse(self.was_dropped)

    def test_another_version_and_a_removed_package_configure_afresh(self):
        for text in ('librviz-dev 1.14 installed\n', 'librviz-dev 1.15 installed\n',
                     'librviz-dev 1.15 config-files\n'):
            self.installed.write_text(text)
            self.prepare()
            self.assertTrue(self.was_dropped, text)

    def test_other_arguments_configure_afresh(self):
        self.prepare('-DCMAKE_DISABLE_FIND_PACKAGE_rviz=TRUE')
        self.assertTrue(self.was_dropped)
        self.prepare()
        self.assertTrue(self.was_dropped)

    def test_another_compiler_builds_anew(self):
        self.prepare(CXX='g++' if 'clang' in os.environ.get('CXX', '') else 'clang++')
        self.assertTrue(self.was_dropped)
        self.assertFalse(self.was_kept)

    def test_a_workspace_that_was_moved_is_built_anew(self):
        self.cache.write_text('CMAKE_HOME_DIRECTORY:INTERNAL=/elsewhere/src\n')
        self.prepare()
        self.assertTrue(self.was_dropped)
        self.assertFalse(self.was_kept)


CASE = '<testcase name="{}" file="/x/{}">{}</testcase>'
SEQUENCES = '<properties><property name="sequences" value="{}"/></properties>'


class LeaveWorkspaceTest(unittest.TestCase):
    def test_a_sourced_workspace_is_taken_out_of_the_paths(self):
        common = ROOT / 'scripts' / 'lib' / 'common.sh'
        variables = {'PYTHONPATH': '/w/devel/lib/python3:/other:/w2/lib',
                     'CMAKE_PREFIX_PATH': '/w/devel', 'ROS_PACKAGE_PATH': '/usr/share'}
        shown = subprocess.run(
            ['bash', '-c', 'source "$1"; leave_workspace /w; '
             'echo "$PYTHONPATH ${CMAKE_PREFIX_PATH-none} $ROS_PACKAGE_PATH"; ls / >/dev/null',
             'bash', common], check=True, capture_output=True, text=True,
            env={**os.environ, **variables}).stdout
        self.assertEqual(shown, '/other:/w2/lib none /usr/share\n')


class SuitesTest(ScratchTest):
    """check_suites, on a tree with one test file of each kind."""

    LIST = ('gtest test/unit/*_test.cpp', 'tool test/tools/*_test.py',
            'gtest test/unit/property_test.cpp needs:rapidcheck sequences>=10',
            'rostest test/ros/*.test full', 'rostest test/rviz/*.test full needs:rviz')

    def setUp(self):
        super().setUp()
        self.root = pathlib.Path(self.folder.name)
        for path in ('test/unit/mesh_test.cpp', 'test/unit/property_test.cpp',
                     'test/tools/run_test.py'):
            self.write(path)
        for name in ('ros/api', 'rviz/panel'):
            self.write(f'test/{name}.test', f'<test test-name="{name[-3:]}" />')
        self.write('test/rviz/panel_test.cpp')  # panel.test starts it
        self.unit(CASE.format('Mesh', 'test/unit/mesh_test.cpp', ''))
        for name in ('tool-run_test', 'rosunit-api', 'rosunit-nel'):
            self.write(f'results/{name}.xml', '<testsuite><testcase name="a" /></testsuite>')

    def write(self, path, text=''):
        path = self.root / path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def unit(self, *cases, sequences=10):
        """The results of the program of test/unit."""
        cases += CASE.format('P', 'test/unit/property_test.cpp', SEQUENCES.format(sequences)),
        self.write('results/gtest-cloth_sim_unit_test.xml',
                   f'<testsuites><testsuite>{"".join(cases)}</testsuite></testsuites>')

    def problems(self, left_out='', **options):
        suites = [check_suites.Suite(line) for line in self.LIST]
        return list(check_suites.check(suites, self.root, self.root / 'results', left_out,
                                       **options))

    def test_all_ran(self):
        self.assertEqual(self.problems(), [])

    def test_a_file_whose_tests_are_not_in_the_program(self):
        self.unit()
        self.assertEqual(self.problems(), ['not run: test/unit/mesh_test.cpp: none of its tests ran'])

    def test_a_file_all_of_whose_tests_were_skipped(self):
        self.unit(CASE.format('Mesh', 'test/unit/mesh_test.cpp', '<skipped message="no"/>'))
        self.assertEqual(self.problems(), ['not run: test/unit/mesh_test.cpp: none of its tests ran'])

    def test_a_test_that_lacks_a_library(self):
        self.unit(CASE.format('Mesh', 'test/unit/mesh_test.cpp', ''),
                  CASE.format('Other', 'test/unit/mesh_test.cpp',
                              '<skipped message="not installed: cvode"/>'))
        self.assertEqual(self.problems(),
                         ['not run: test/unit/mesh_test.cpp: Other: not installed: cvode'])
        self.assertEqual(self.problems(without=['cvode']), [])

    def test_too_few_sequences(self):
        self.unit(CASE.format('Mesh', 'test/unit/mesh_test.cpp', ''), sequences=9)
        self.assertEqual(self.problems(), ['not run: test/unit/property_test.cpp: 9 sequences; there '
                                           'should be 10 at least'])
        self.assertEqual(self.problems(fewer_cases=2), [])
        self.unit(CASE.format('Mesh', 'test/unit/mesh_test.cpp', ''), sequences=4)
        self.assertEqual(self.problems(fewer_cases=2),
                         ['not run: test/unit/property_test.cpp: 4 sequences; there should be 5 at '
                          'least'])

    def test_a_missing_and_a_broken_result(self):
        (self.root / 'results' / 'rosunit-api.xml').unlink()
        self.write('results/rosunit-nel.xml', '<testsuite')
        self.assertEqual(self.problems(), ['not run: test/ros/api.test: none of its tests ran',
                                           'not run: test/rviz/panel.test: none of its tests ran'])
        self.assertEqual(self.problems(quick=True), [])

    def test_what_cmake_left_out(self):
        left_out = 'rviz: rviz was not found\nbullet: Bullet was not found\n'
        self.assertEqual(self.problems(left_out),
                         ['not built: rviz was not found', 'not built: Bullet was not found'])
        (self.root / 'results' / 'rosunit-nel.xml').unlink()
        self.assertEqual(self.problems('rviz: rviz was not found\n', without=['rviz']), [])

    def test_a_file_that_is_in_no_suite(self):
        self.write('test/other/new_test.cpp')
        [problem] = self.problems()
        self.assertIn('test/other/new_test.cpp', problem)

    def test_a_suite_without_files(self):
        (self.root / 'test' / 'tools' / 'run_test.py').unlink()
        self.assertEqual(self.problems(), ['not run: test/tools/*_test.py: there is no such file'])

    def test_the_list_covers_every_test_file(self):
        suites = check_suites.read_suites()
        unlisted = [line for line in check_suites.check(suites, ROOT, self.root, '')
                    if 'has no suite for it' in line]
        self.assertEqual(unlisted, [])


class InterpreterTest(unittest.TestCase):
    def test_scripts_start_the_python_that_ros_is_installed_for(self):
        """The first python3 on PATH may be that of pyenv or conda, which lacks matplotlib and rosbag.
        (catkin rewrites the first lines of what it installs, and of cfg/.)"""
        for folder in ('bench', 'examples', 'python', 'scripts', 'study', 'test'):
            for path in (ROOT / folder).rglob('*'):
                if not path.is_file() or path.suffix in ('.png', '.gif', '.stl'):
                    continue
                with open(path, 'rb') as file:
                    first = file.readline()
                if first.startswith(b'#!') and b'python' in first:
                    with self.subTest(path=path):
                        self.assertEqual(first, b'#!/usr/bin/python3\n')


class TooLongTest(unittest.TestCase):
    """test/sanitizers/too_long.txt, whose patterns test.sh makes a filter of gtest of."""

    def test_each_pattern_names_a_case(self):
        lines = (ROOT / 'test/sanitizers/too_long.txt').read_text().splitlines()
        patterns = [line.split()[0] for line in lines if line and not line.startswith('#')]
        environment = {name: value for name, value in os.environ.items()
                       if name not in ('GTEST_FILTER', 'CLOTH_SIM_FEWER_CASES')}
        cases = []
        for folder in ('determinism', 'study', 'surgery', 'verify'):
            listed = subprocess.check_output(
                [find_program(f'cloth_sim_{folder}_test'), '--gtest_list_tests'], text=True,
                env=environment)
            for line in listed.splitlines():
                if line.startswith('  '):
                    cases.append(suite + line.split()[0])
                else:
                    suite = line.split()[0]
        self.assertGreater(len(cases), 1000)
        unknown = [pattern for pattern in patterns if not fnmatch.filter(cases, pattern)]
        self.assertEqual(unknown, [])


class ScriptsTests(unittest.TestSuite):
    def __init__(self):
        super().__init__(unittest.defaultTestLoader.loadTestsFromTestCase(case)
                         for case in (ConfigurationTest, LeaveWorkspaceTest, SuitesTest,
                                      InterpreterTest, TooLongTest))


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'scripts_test', '__main__.ScriptsTests')
