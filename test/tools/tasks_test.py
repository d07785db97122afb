#!/usr/bin/python3
"""cloth_tasks and what it stands on that needs no node: spaces, measures, rotations, tables, and
the table in docs/tasks.md. Episodes start a master of their own."""
import json
import math
import os
import re
import signal
import socket
import subprocess
import sys
import time
import unittest

import numpy as np
import rosunit

from cloth_sim import measures, rotations, table
from cloth_sim.script import Script
from cloth_sim.spaces import Box
from cloth_sim.tasks import TASKS, find_task

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scratch import ScratchTest, processes  # noqa: E402

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
CLOTH_TASKS = os.path.join(ROOT, 'scripts', 'cloth_tasks')
POLICY = os.path.join(ROOT, 'examples', 'random_policy.py')


def free_port():
    with socket.socket() as it:
        it.bind(('127.0.0.1', 0))
        return it.getsockname()[1]


# No master runs there, so that episodes start their own.
ENVIRONMENT = {**os.environ, 'ROS_MASTER_URI': 'http://127.0.0.1:%d' % free_port()}


class Sheet:
    """A grid of cells of 0.1 m in the plane z = 0, as a Surface."""

    def __init__(self, columns, rows):
        u, v = np.meshgrid(range(columns), range(rows), indexing='ij')
        self.uv = 0.1 * np.stack([u, v], axis=-1).reshape(-1, 2)
        self.points = np.append(self.uv, np.zeros((len(self.uv), 1)), axis=1)
        a = (u[:-1, :-1] * rows + v[:-1, :-1]).ravel()
        b, c, d = a + rows, a + rows + 1, a + 1
        self.faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


class SpacesTest(unittest.TestCase):
    def test_a_box(self):
        box = Box(np.array([-1.0, 0.0], np.float32), np.array([1.0, 2.0], np.float32),
                  dtype=np.float32)
        self.assertEqual((box.shape, box.dtype), ((2,), np.float32))
        self.assertIn(np.array([0.5, 2.0], np.float32), box)
        for outside in ([2.0, 1.0], [0.0, -0.1], [0.0], [[0.0, 0.0]], [np.nan, 1.0]):
            self.assertNotIn(np.array(outside, np.float32), box)
        self.assertNotIn(np.array([0.5, 1.0], np.float64), box)  # would lose digits

    def test_samples_follow_from_the_seed_and_lie_within(self):
        box = Box(np.float32(-0.5), np.float32(0.25), (1000,), dtype=np.float32)
        box.seed(3)
        first = box.sample()
        self.assertIn(first, box)
        self.assertGreater(np.ptp(first), 0.7)
        self.assertTrue((box.sample() != first).any())
        box.seed(3)
        np.testing.assert_array_equal(box.sample(), first)
        self.assertEqual(box, Box(np.float32(-0.5), np.float32(0.25), (1000,), dtype=np.float32))

    def test_boxes_without_bounds(self):
        low = np.array([-np.inf, 1.0, -np.inf], np.float32)
        high = np.array([np.inf, np.inf, -1.0], np.float32)
        box = Box(low, high, dtype=np.float32)
        for _ in range(100):
            self.assertIn(box.sample(), box)


class MeasuresTest(unittest.TestCase):
    def test_areas_of_a_sheet_and_of_one_that_is_folded(self):
        sheet = Sheet(5, 4)
        self.assertAlmostEqual(measures.rest_area(sheet), 0.12, places=12)
        self.assertAlmostEqual(measures.covered_area(sheet), 0.12, delta=2 * 0.7 * measures.CELL)
        sheet.points[:, 0] = np.minimum(sheet.points[:, 0], 0.4 - sheet.points[:, 0])
        self.assertAlmostEqual(measures.covered_area(sheet), 0.06, delta=2 * 0.5 * measures.CELL)
        self.assertAlmostEqual(measures.rest_area(sheet), 0.12, places=12)

    def test_a_shape_fits_itself_moved_turned_and_mirrored(self):
        shape = np.array([[0, 0], [0.3, 0], [0.3, 0.1], [0, 0.2]])
        turn = np.array([[math.cos(2), -math.sin(2)], [math.sin(2), math.cos(2)]])
        np.testing.assert_allclose(measures.misfit(shape @ turn.T + 5, shape), 0, atol=1e-12)
        np.testing.assert_allclose(measures.misfit(shape * (1, -1), shape), 0, atol=1e-12)
        # A vertex moved by d, where the shape would rather keep the mean of four.
        moved = shape + [[0, 0], [0, 0], [0, 0], [0, 0.004]]
        self.assertLess(measures.misfit(moved, shape).max(), 0.004)
        self.assertGreater(measures.misfit(moved, shape).max(), 0.001)

    def test_pieces(self):
        sheet = Sheet(5, 4)
        self.assertEqual(len(measures.piece_areas(sheet)), 1)
        left = sheet.uv[sheet.faces].mean(axis=1)[:, 0] < 0.1
        sheet.faces[left] += len(sheet.uv)  # vertices of its own
        sheet.uv = np.concatenate([sheet.uv, sheet.uv])
        sheet.points = np.concatenate([sheet.points, sheet.points])
        np.testing.assert_allclose(measures.piece_areas(sheet), [0.09, 0.03], rtol=1e-12)

    def test_rotations(self):
        random = np.random.default_rng(1)
        for _ in range(20):
            vector = random.uniform(-1.7, 1.7, 3)  # shorter than half a turn
            turn = rotations.from_vector(vector)
            np.testing.assert_allclose(rotations.to_vector(turn), vector, atol=1e-12)
            back = rotations.product(rotations.inverse(turn), turn)
            np.testing.assert_allclose(back, [0, 0, 0, 1], atol=1e-12)


class PlansTest(unittest.TestCase):
    def test_a_move_ends_at_its_target_at_its_speed(self):
        task = find_task('fold_in_half')
        target = np.array([0.3, 0.1, 0.2])
        upright = rotations.from_vector([0.0, np.pi / 2, 0.0])
        script = Script(task, 0.1, lambda it: it.move({'right': (target, upright)}, 0.2))
        observation = np.zeros(3 * len(task.places) + 12 * 2 + 1)
        observation[[111, 123]] = 1.0  # w of both orientations
        actions = []
        while not script.done:
            actions.append(script.act(observation))
        actions = np.array(actions)
        self.assertFalse(actions[:, :6].any())  # of the left clamp
        np.testing.assert_allclose(actions[:, 7:10].sum(axis=0) * 0.1, target, atol=1e-12)
        np.testing.assert_allclose(actions[:, 10:13].sum(axis=0) * 0.1, [0, np.pi / 2, 0],
                                   atol=1e-12)
        self.assertLessEqual(np.linalg.norm(actions[:, 7:10], axis=1).max(), 0.2 + 1e-12)

    def test_names_of_tasks(self):
        numbers = [task.number for task in TASKS.values()]
        self.assertEqual(len(set(numbers)), len(numbers))
        for name, task in TASKS.items():
            camel = ''.join(word.capitalize() for word in name.split('_'))
            self.assertEqual(task.env_id, 'ClothSim/%s-v0' % camel)


class DocsTest(unittest.TestCase):
    def read(self, *path):
        with open(os.path.join(ROOT, 'docs', *path), encoding='utf-8') as file:
            return file.read()

    def test_the_table_is_that_of_the_recorded_episodes(self):
        rows = table.read_csv(self.read('data', 'tasks_scripted.csv'))
        self.assertEqual({row['task'] for row in rows}, set(TASKS))
        self.assertIn(table.as_markdown(rows), self.read('tasks.md'))

    def test_every_task_is_documented(self):
        page = self.read('tasks.md')
        for task in TASKS.values():
            self.assertIn('### `%s`' % task.name, page)
            self.assertIn('`%s`' % task.env_id, page)
            self.assertIn('`%s`' % task.scene, page)


class PackageTest(ScratchTest):
    def test_all_modules_and_scenes_are_installed(self):
        subprocess.run(['/usr/bin/python3', 'setup.py', '-q', 'build', '--build-base',
                        self.path('base'), '--build-lib', self.path('lib')], cwd=ROOT, check=True,
                       capture_output=True, timeout=120)
        self.assertEqual(files_below(self.path('lib')), files_below(os.path.join(ROOT, 'python')))


def files_below(root):
    """Modules and scenes, relative to a folder."""
    return sorted(os.path.relpath(os.path.join(folder, name), root)
                  for folder, _, names in os.walk(root) for name in names
                  if name.endswith(('.py', '.yaml')))


class ClothTasksTest(ScratchTest):
    def tasks(self, *arguments):
        return subprocess.run([CLOTH_TASKS, *arguments], capture_output=True, text=True,
                              timeout=120, env=ENVIRONMENT)

    def refused(self, status, text, *arguments):
        result = self.tasks(*arguments)
        self.assertEqual(result.returncode, status, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertIn(text, result.stderr)

    def test_help_and_list(self):
        self.assertIn('--policy', self.tasks('--help').stdout)
        lines = self.tasks('--list').stdout.splitlines()
        self.assertEqual([line.split()[0] for line in lines], list(TASKS))

    def test_bad_input_is_refused_in_a_line(self):
        out = '--out=' + self.path('out')
        self.refused(2, "--task: expected some of fold_in_half", '--task', 'iron', out)
        for seeds in ('-1', 'a', '3-1', '', '0-99999999'):
            self.refused(2, '--seeds: expected whole numbers', '--seeds=' + seeds, out)
        self.refused(2, '--out: expected a folder', '--task=cut_strip')
        self.refused(2, 'cannot be made', '--task=cut_strip', '--out=/proc/x')
        self.assertFalse(os.path.exists(self.path('out')))

    def test_an_episode_that_cannot_be_run_is_a_line(self):
        run = ('--task=cut_strip', '--seeds=0', '--out=' + self.path('out'))
        self.refused(1, 'cut_strip, seed 0: ClothError: ', *run, '--set=cloth.colour=red')
        self.refused(1, 'cloth.colour', *run, '--set=cloth.colour=red')
        self.refused(1, 'expected FILE:FUNCTION', *run, '--policy=make')
        self.refused(1, 'has no function act', *run, '--policy=%s:act' % POLICY)
        self.assertEqual(os.listdir(self.path('out')), [])

    def test_tables_of_two_episodes(self):
        result = self.tasks('--task=cut_strip', '--seeds=0,3', '--set=cloth.particles=[26, 16]',
                            '--pictures', '--out=' + self.path('out'))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(len(re.findall(r'\d of 2: cut_strip, seed [03]: score 1.000, success',
                                        result.stderr)), 2, result.stderr)
        self.assertEqual(sorted(os.listdir(self.path('out'))),
                         ['cut_strip_0.png', 'cut_strip_3.png', 'episodes.csv', 'tasks.json',
                          'tasks.md'])
        rows = {}
        for name in os.listdir(self.path('out')):
            with open(os.path.join(self.path('out'), name), 'rb') as file:
                rows[name] = file.read()
        episodes = table.read_csv(rows['episodes.csv'].decode())
        self.assertEqual([(row['task'], row['seed'], row['success']) for row in episodes],
                         [('cut_strip', 0, True), ('cut_strip', 3, True)])
        self.assertEqual(result.stdout, rows['tasks.md'].decode())
        self.assertEqual(table.as_markdown(episodes), result.stdout)
        whole = json.loads(rows['tasks.json'])
        self.assertEqual((whole['policy'], whole['episodes']), ('scripted', episodes))
        scores = [row['score'] for row in episodes]
        self.assertAlmostEqual(whole['tasks']['cut_strip']['score']['mean'], sum(scores) / 2)

    def test_a_policy_of_a_user(self):
        result = self.tasks('--task=cut_strip', '--seeds=0', '--policy=%s:make' % POLICY,
                            '--set=cloth.particles=[26, 16]', '--out=' + self.path('out'))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('no success, 8.0 s of simulated time', result.stderr)
        with open(os.path.join(self.path('out'), 'tasks.json')) as file:
            self.assertEqual(json.load(file)['policy'], POLICY + ':make')

    def test_nothing_is_left_of_an_interrupted_run(self):
        """Neither a table, nor a node, nor a folder."""
        before = processes('cloth_env_')
        with subprocess.Popen([CLOTH_TASKS, '--task=fold_in_half', '--out', self.path('out')],
                              stderr=subprocess.PIPE, text=True, env=self.own_folder()) as run:
            self.wait_for(lambda: processes('cloth_env_') - before)
            started = processes('cloth_env_') - before
            run.send_signal(signal.SIGTERM)
            _, said = run.communicate(timeout=30)
        self.assertEqual(run.returncode, 1)
        self.assertIn('cloth_tasks: interrupted', said)
        self.assertEqual(os.listdir(self.path('out')), [])
        self.assertEqual(os.listdir(self.folder.name), ['out'])
        self.wait_for(lambda: not processes('cloth_env_') & started)

    def test_a_node_ends_with_a_program_that_is_killed(self):
        before = processes('cloth_env_')
        program = [sys.executable, '-m', 'cloth_sim.episode', 'fold_in_half', '0']
        with subprocess.Popen(program, env=self.own_folder()) as run:
            self.wait_for(lambda: processes('cloth_env_') - before)
            started = processes('cloth_env_') - before
            run.kill()
        self.wait_for(lambda: not processes('cloth_env_') & started)

    def own_folder(self):
        """An environment in which temporary files go into the folder of the test."""
        return {**ENVIRONMENT, 'TMPDIR': self.folder.name}

    def wait_for(self, holds, deadline=60.0):
        end = time.monotonic() + deadline
        while not holds():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.1)


class TasksTests(unittest.TestSuite):
    def __init__(self):
        super().__init__(unittest.defaultTestLoader.loadTestsFromTestCase(case)
                         for case in (SpacesTest, MeasuresTest, PlansTest, DocsTest,
                                      PackageTest, ClothTasksTest))


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'tasks_test', '__main__.TasksTests')
