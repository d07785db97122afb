#!/usr/bin/python3
"""The command line of cloth_study: tables, charts, messages. Needs no master."""
import csv
import json
import math
import os
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scratch import find_program  # noqa: E402

CLOTH_STUDY = find_program('cloth_study')
CLOTH_RUN = find_program('cloth_run')
SCENE = 'hang_swing'
WORK_PRECISION = 'scene,solver,dt,substeps,iterations,cpu_s_per_sim_s,error,max_strain,status'
STABILITY = 'solver,omega_dt,stiffness,dt,outcome,predicted_limit'
HEADERS = {
    'work_precision.csv': WORK_PRECISION,
    'stability.csv': STABILITY,
    'stability_limits.csv': 'solver,system,stiffness,omega,measured_limit,predicted_limit',
    'tearing.csv': 'solver,dt,substeps,first_failure_s,separation_s,broken,status',
    'pareto.csv': 'scene,solver,dt,substeps,iterations,cpu_s_per_sim_s,error',
    'references.csv': 'scene,own_error,source',
    'resolution.csv': 'quantity,particles,value,unit,difference_from_finest,substeps,'
                      'cpu_s_per_sim_s',
}
SCENES = ['hang_swing', 'in_plane_wave', 'drape_sphere', 'table_edge', 'seam_tear']
CHARTS = ['work_precision_' + scene for scene in SCENES] + ['stability']
STATUSES = {'ok', 'diverged', 'wrong', 'refused', 'skipped'}


def run_study(*arguments):
    return subprocess.run([CLOTH_STUDY, *arguments], capture_output=True, text=True, timeout=900)


def registered_methods():
    """The names of all methods, from the message about an unknown one."""
    with tempfile.TemporaryDirectory() as folder:
        scene = os.path.join(folder, 'scene.yaml')
        with open(scene, 'w') as file:
            file.write('cloth: {particles: [3, 3]}\nsolver: {method: no_such_method}\n')
        message = subprocess.run([CLOTH_RUN, scene], capture_output=True, text=True).stderr
    names = re.search(r'expected one of ([a-z0-9_, ]+)', message)
    assert names, message
    return {name.strip() for name in names.group(1).split(',')} - {'auto'}


class ClothStudyTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        # The whole quick study: two minutes on one core that does nothing else.
        cls.result = run_study('--quick', '--jobs', '2', '--out', cls.folder.name)
        cls.methods = registered_methods()

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def rows(self, name):
        with open(self.path(name), newline='') as file:
            return list(csv.DictReader(file))

    def refused(self, *arguments, says=()):
        result = run_study(*arguments)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        for word in says:
            self.assertIn(word, result.stderr)

    def test_ends_well_and_writes_every_table(self):
        self.assertEqual(self.result.returncode, 0, self.result.stderr)
        for name, header in HEADERS.items():
            with open(self.path(name)) as file:
                self.assertEqual(file.readline().strip(), header, name)
        self.assertFalse([name for name in os.listdir(self.folder.name) if name.endswith('.tmp')])

    def test_every_method_has_a_ladder_of_rows(self):
        rows = self.rows('work_precision.csv')
        self.assertEqual({row['solver'] for row in rows}, self.methods)
        self.assertEqual({row['scene'] for row in rows}, set(SCENES))
        for method in self.methods:
            substeps = {row['substeps'] for row in rows if row['solver'] == method}
            self.assertGreaterEqual(len(substeps), 5, method)

    def test_rows_are_consistent(self):
        skipped = 0
        for row in self.rows('work_precision.csv'):
            self.assertIn(row['status'], STATUSES)
            if row['status'] != 'wrong':
                self.assertEqual(math.isfinite(float(row['error'])), row['status'] == 'ok', row)
            if row['status'] == 'ok':
                self.assertLessEqual(float(row['error']), 1.0)
                self.assertGreater(float(row['cpu_s_per_sim_s']), 0.0)
            skipped += row['status'] in ('skipped', 'refused')
        reasons = []
        if os.path.exists(self.path('skipped.txt')):
            with open(self.path('skipped.txt')) as file:
                reasons = file.readlines()
        self.assertEqual(len(reasons), skipped)

    def error(self, scene, solver, substeps):
        """The error of the run with the scene's own step, and with the most iterations of methods
        that iterate."""
        rows = [row for row in self.rows('work_precision.csv')
                if row['scene'] == scene and row['solver'] == solver
                and row['substeps'] == str(substeps) and float(row['dt']) > 0.01]
        row = max(rows, key=lambda row: int(row['iterations']))
        self.assertEqual(row['status'], 'ok', row)
        return float(row['error'])

    def order(self, scene, solver, substeps):
        """The observed order, from a run and one with half the substeps."""
        return math.log2(self.error(scene, solver, substeps // 2)
                         / self.error(scene, solver, substeps))

    def test_errors_are_those_against_the_kept_reference(self):
        references = {row['scene']: row for row in self.rows('references.csv')}
        self.assertEqual(set(references), set(SCENES))
        self.assertIn('CVODE', references[SCENE]['source'])
        self.assertLess(float(references[SCENE]['own_error']), 1e-7)
        # omega h is about 1.3 there, in modes that hardly move; the swing itself is resolved well.
        self.assertLess(self.error(SCENE, 'verlet', 160), 1e-4)

    # ---- findings of docs/accuracy.md that must not regress

    def test_nothing_is_too_expensive_for_the_quick_study(self):
        skipped = [row for row in self.rows('work_precision.csv') if row['status'] == 'skipped']
        self.assertFalse(skipped)

    def test_methods_converge_with_their_orders(self):
        self.assertAlmostEqual(self.order('in_plane_wave', 'verlet', 320), 2.0, delta=0.1)
        self.assertAlmostEqual(self.order('in_plane_wave', 'rk4', 320), 4.0, delta=0.1)
        # Symplectic Euler is of first order where drag acts, and Verlet's equal where none does.
        self.assertAlmostEqual(self.order('hang_swing', 'symplectic_euler', 320), 1.0, delta=0.1)
        self.assertAlmostEqual(self.order('in_plane_wave', 'symplectic_euler', 320), 2.0, delta=0.1)
        self.assertAlmostEqual(self.order('hang_swing', 'xpbd', 80), 1.0, delta=0.1)

    def test_pbd_does_not_converge(self):
        for scene in ('drape_sphere', 'table_edge'):
            self.assertGreater(self.error(scene, 'pbd', 40), 1.5 * self.error(scene, 'pbd', 2))
        self.assertGreater(self.order('in_plane_wave', 'pbd', 40), -0.1)
        self.assertLess(self.order('in_plane_wave', 'pbd', 40), 0.1)

    def test_xpbd_is_on_the_front_at_the_level_of_a_per_cent(self):
        for scene in ('hang_swing', 'table_edge'):
            errors = [float(row['error']) for row in self.rows('pareto.csv')
                      if row['scene'] == scene and row['solver'] == 'xpbd']
            self.assertTrue([e for e in errors if 0.003 < e < 0.03], (scene, errors))

    def test_forward_euler_fails_where_nothing_damps_stiff_springs(self):
        rows = [row for row in self.rows('work_precision.csv')
                if row['solver'] == 'explicit_euler' and row['scene'] == SCENE]
        self.assertEqual({row['status'] for row in rows}, {'diverged'})

    def test_the_swing_does_not_depend_on_the_mesh(self):
        of = {}
        for row in self.rows('resolution.csv'):
            of.setdefault(row['quantity'], []).append(float(row['value']))
        self.assertLess(max(of['swing_period']) / min(of['swing_period']), 1.003)
        self.assertLess(max(map(abs, of['hoop_bias'])), 0.02)
        self.assertLess(max(map(abs, of['hoop_skew'])), 1e-9)  # springs do not know the diagonals

    def test_the_front_is_of_rows_that_nothing_beats(self):
        front = self.rows('pareto.csv')
        self.assertTrue(front)
        ok = [row for row in self.rows('work_precision.csv') if row['status'] == 'ok']
        for best in front:
            cost, error = float(best['cpu_s_per_sim_s']), float(best['error'])
            self.assertFalse([row for row in ok if row['scene'] == best['scene']
                              and float(row['cpu_s_per_sim_s']) < cost
                              and float(row['error']) < error], best)

    def test_measured_limits_are_the_registrys(self):
        rows = self.rows('stability_limits.csv')
        self.assertEqual({row['solver'] for row in rows}, self.methods)
        for row in rows:
            measured, predicted = float(row['measured_limit']), float(row['predicted_limit'])
            if predicted == 0.0 or math.isinf(predicted):
                self.assertEqual(measured, predicted, row)
            else:
                self.assertAlmostEqual(measured / predicted, 1.0, delta=0.03, msg=row)

    def test_probes_bracket_the_limits(self):
        probes = self.rows('stability.csv')
        self.assertEqual({row['outcome'] for row in probes} - {'stable', 'unstable'}, set())
        for row in self.rows('stability_limits.csv'):
            limit = float(row['measured_limit'])
            for probe in probes:
                if (probe['solver'], probe['stiffness']) != (row['solver'], row['stiffness']):
                    continue
                stable = float(probe['omega_dt']) < limit
                self.assertEqual(probe['outcome'], 'stable' if stable else 'unstable', probe)

    def test_charts_are_drawn(self):
        for name in CHARTS:
            with open(self.path(name + '.png'), 'rb') as file:
                image = file.read()
            self.assertEqual(image[:8], b'\x89PNG\r\n\x1a\n')
            self.assertGreater(len(image), 10000, name)
            with open(self.path(name + '.svg')) as file:
                drawing = file.read()
            self.assertIn('</svg>', drawing)
            for method in self.methods:
                self.assertIn(method, drawing, name)

    CLOTH = """
cloth:
  size: [0.2, 0.2]
  particles: [9, 9]
  pose: {rpy: [0.7, 0, 0]}
  fabric: {preset: interlock, damping: 0.00001}
  pins: [last_row]
drag: 0.01
"""

    def scene(self, solver):
        # A soft cloth swings: a hundred steps of any method resolve it well.
        path = self.path('advised.yaml')
        with open(path, 'w') as file:
            file.write(self.CLOTH + solver)
        return path

    def advice(self, scene, *arguments):
        result = run_study('--advise', scene, '--error', '0.02', '--duration', '0.2', *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def test_advice_is_a_cheaper_model_within_the_error(self):
        scene = self.scene('solver: {method: xpbd, substeps: 200}\n')
        text = self.advice(scene)
        for method in self.methods:
            self.assertIn(method, text)
        own = re.search(r"The scene's own \(xpbd\): error \S+, (\S+) s", text).group(1)
        error, cost = re.search(r'Cheapest [^:]*: error (\S+), (\S+) s', text).groups()
        self.assertLessEqual(float(error), 0.02)
        self.assertLess(float(cost), float(own))
        self.assertRegex(text, r'\+ . x . particles +saves \d+ %')  # the simplification it rejected
        # The cloth is cheaper by what the answer says, and both ways of saying it agree.
        block = text.split('---\n')[1]
        self.assertRegex(block, r'particles: \[\d, \d\]')
        self.assertRegex(block, r'solver:\n  method: \w+\n  dt: ')
        command = text.split('---\n')[2].replace('cloth_run ', '', 1)
        run = subprocess.run([CLOTH_RUN, *shlex.split(command), '--duration', '0.2', '--summary',
                              '-'], capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        summary = json.loads(run.stdout)
        self.assertIn('method: ' + summary['solver'], block)
        self.assertIn('particles: [{0}, {0}]'.format(round(math.sqrt(summary['particles']))), block)

    def test_advice_that_is_kept_is_what_auto_takes(self):
        scene = self.scene('solver: {method: xpbd, substeps: 200}\n')
        environment = dict(os.environ, CLOTH_SIM_CACHE=self.path('cache'))
        result = subprocess.run(
            [CLOTH_STUDY, '--advise', scene, '--error', '0.02', '--duration', '0.2', '--cache'],
            capture_output=True, text=True, env=environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('kept in ' + self.path('cache'), result.stdout)
        method, substeps = re.search(r'  method: (\w+)\n.*  substeps: (\d+)', result.stdout,
                                     re.DOTALL).groups()
        scene = self.scene('solver: {method: auto, error: 0.02}\n')
        run = subprocess.run([CLOTH_RUN, scene, '--duration', '0.1', '--summary', '-'],
                             capture_output=True, text=True, env=environment)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertRegex(run.stderr.splitlines()[0], 'solver auto, error 0.02: ' + method)
        self.assertIn(self.path('cache'), run.stderr.splitlines()[0])
        summary = json.loads(run.stdout)
        self.assertEqual(summary['solver'], method)
        self.assertEqual(summary['method_params']['substeps'], int(substeps))

    def test_the_table_of_auto_comes_from_the_studys(self):
        table = self.path('auto.csv')
        result = run_study('--out', self.folder.name, '--make-auto-table', table)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(table) as file:
            rows = [line.split(',') for line in file if not line.startswith('#')]
        self.assertEqual({row[0] for row in rows[1:]}, {'smooth', 'contact', 'tearing'})
        self.assertLessEqual({row[2] for row in rows[1:]},
                             self.methods - {'pbd', 'explicit_euler'})

    def test_comparisons_with_measured_cloth_fill_their_tables(self):
        folder = self.path('reality')
        result = run_study('--quick', '--parts', 'reality', '--no-charts', '--out', folder)
        self.assertEqual(result.returncode, 0, result.stderr)
        names = {name for name in os.listdir(folder) if name.endswith('.csv')}
        self.assertEqual(len(names), 12)
        for name in names:
            with open(os.path.join(folder, name), newline='') as file:
                rows = list(csv.DictReader(file))
            self.assertGreater(len(rows), 0, name)
            self.assertNotIn(None, rows[0].keys() | set(rows[0].values()), name)

    def test_errors_at_size_are_of_the_scenes_and_sizes_that_are_asked_for(self):
        folder = self.path('at_size')
        result = run_study('--parts', 'at_size', '--scenes', 'swing,drop', '--sizes', '8', '--out',
                           folder)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(folder, 'at_size.csv'), newline='') as file:
            rows = list(csv.DictReader(file))
        self.assertEqual({(row['scene'], row['particles']) for row in rows},
                         {('swing', '8'), ('drop', '8')})
        for row in rows:
            self.assertEqual(math.isfinite(float(row['rest_radius_error'])), row['scene'] == 'drop')
        for name in ('at_size_swing_8', 'at_size_drop_8', 'at_size_growth'):
            self.assertGreater(os.path.getsize(os.path.join(folder, name + '.png')), 10000, name)
        self.refused('--out', folder, '--parts', 'at_size', '--scenes', 'no_such',
                     says=['no_such', 'swing'])

    def test_help_says_what_it_does(self):
        result = run_study('--help')
        self.assertEqual(result.returncode, 0)
        for word in ('--quick', '--out', '--scenes', '--make-references', 'Exit status'):
            self.assertIn(word, result.stdout)

    def test_bad_input_is_refused_with_one_line(self):
        self.refused(says=['--out'])
        self.refused('--out', '/proc/nowhere', says=['/proc/nowhere'])
        self.refused('--out', self.path('x'), '--scenes', 'no_such', says=['no_such', SCENE])
        self.refused('--out', self.path('x'), '--parts', 'no_such', says=['no_such'])
        self.refused('--out', self.path('x'), '--no-such-option', says=['--help'])
        self.refused('--advise', 'no_such_scene', says=['no_such_scene'])
        self.refused('--advise', 'hang', '--out', self.path('x'), says=['--advise'])


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'cloth_study_test', ClothStudyTest)
