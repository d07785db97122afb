#!/usr/bin/python3
"""scripts/cloth_sweep: the list of jobs, resuming, the table and the plot."""
import csv
import io
import json
import os
import shlex
import signal
import struct
import subprocess
import sys
import time

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from sweep_support import SWEEP, SweepTest  # noqa: E402

GRID = ('phases.hold.timeout=0.1,0.2', 'cloth.fabric.areal_density=0.1,0.3', 'seed=1..2')


def run(job):
    return subprocess.run(job, shell=True, capture_output=True, text=True, timeout=60)


class ClothSweepTest(SweepTest):
    def test_help(self):
        self.assertIn('join', self.sweep('--help').stdout)
        self.assertIn('--duration', self.sweep('jobs', '--help').stdout)
        self.assertIn('--series', self.sweep('join', '--help').stdout)

    def test_a_job_for_each_point_of_the_grid(self):
        jobs = self.jobs(*GRID)
        self.assertEqual(len(jobs), 8)
        self.assertEqual(len(set(jobs)), 8)
        words = shlex.split(jobs[1])
        self.assertEqual(words[1], self.scene)
        self.assertEqual([word[6:] for word in words if word.startswith('--set=')],
                         ['phases.hold.timeout=0.1', 'cloth.fabric.areal_density=0.1', 'seed=2'])
        self.assertEqual(self.summaries(), [])  # a list, and nothing run

    def test_a_job_is_one_run_with_a_summary_of_its_own(self):
        job = self.jobs(*GRID)[3]
        self.assertEqual(run(job).returncode, 0)
        [name] = self.summaries()
        self.assertEqual(name, 'phases.hold.timeout=0.1+cloth.fabric.areal_density=0.3+seed=2.json')
        with open(os.path.join(self.out, name)) as file:
            summary = json.load(file)
        self.assertEqual(summary['seed'], 2)
        self.assertAlmostEqual(summary['initial_mass_kg'], 0.3 * 0.04, places=12)

    def test_a_scene_by_name_is_named_by_its_path(self):
        """Other machines need not know where the package is."""
        [job] = self.sweep('jobs', 'strip', 'seed=1', '--out', self.out).stdout.splitlines()
        scene = shlex.split(job)[1]
        self.assertTrue(os.path.isabs(scene) and os.path.isfile(scene), scene)
        self.assertTrue(scene.endswith('config/scenes/strip.yaml'))

    def test_values_with_commas_spaces_and_slashes(self):
        jobs = self.jobs("cloth.particles=[5, 5],[9,9]", "cloth.fabric={preset: denim},cotton")
        self.assertEqual(len(jobs), 4)
        for job in jobs:
            self.assertEqual(run(job).returncode, 0)
        self.assertEqual(len(self.summaries()), 4)
        self.assertEqual({row['cloth.particles'] for row in self.rows()}, {'[5, 5]', '[9,9]'})

    def test_names_that_would_be_too_long_stay_apart(self):
        values = ','.join('{preset: cotton, areal_density: 0.%s%d}' % ('1' * 200, k)
                          for k in range(3))
        for job in self.jobs('cloth.fabric=' + values):
            self.assertEqual(run(job).returncode, 0)
        self.assertEqual(len(self.summaries()), 3)
        self.assertEqual(self.jobs('cloth.fabric=' + values), [])

    # ---- done, killed, failed --------------------------------------------------------------------

    def test_finished_runs_are_skipped(self):
        jobs = self.jobs(*GRID)
        for job in jobs[:3]:
            run(job)
        self.assertEqual(self.jobs(*GRID), jobs[3:])
        more = self.jobs(GRID[0], GRID[1], 'seed=1..3')  # a wider grid keeps what there is
        self.assertEqual(len(more), 12 - 3)

    def test_killed_runs_are_repeated(self):
        grid = ('phases.hold.timeout=1000',)  # some 20 s
        [job] = self.jobs(*grid)
        for sent in (signal.SIGKILL, signal.SIGINT):
            process = subprocess.Popen(shlex.split(job), stderr=subprocess.PIPE)
            self.assertTrue(process.stderr.readline())  # it is running
            process.send_signal(sent)
            process.communicate(timeout=30)
            self.assertNotEqual(process.returncode, 0)
            self.assertEqual(self.jobs(*grid), [job], sent)
        with open(os.path.join(self.out, self.summaries()[0])) as file:
            self.assertEqual(json.load(file)['status'], 'interrupted')
        self.assertIn('no run is done', self.sweep('join', self.out, expected=2).stderr)

    def test_a_file_that_is_no_summary_does_not_count(self):
        jobs = self.jobs('seed=1,2')
        for job in jobs:
            run(job)
        first, second = (os.path.join(self.out, name) for name in self.summaries())
        os.truncate(first, os.path.getsize(first) // 2)
        with open(second, 'w') as file:
            file.write('[]')
        self.assertEqual(self.jobs('seed=1,2'), jobs)

    def test_a_run_that_fails_is_a_result(self):
        [job] = self.jobs('phases.hold.until={pieces: 2}')
        self.assertEqual(run(job).returncode, 3)
        self.assertEqual(self.jobs('phases.hold.until={pieces: 2}'), [])
        [row] = self.rows()
        self.assertEqual(row['status'], 'failed')
        self.assertEqual(row['separation.time_s'], '')

    # ---- join ------------------------------------------------------------------------------------

    def rows(self, *arguments):
        return list(csv.DictReader(io.StringIO(self.sweep('join', self.out, *arguments).stdout)))

    def test_the_table_has_a_row_for_every_run(self):
        jobs = self.jobs(*GRID)
        for job in jobs[1:]:
            run(job)
        rows = self.rows()
        self.assertEqual(len(rows), 7)
        self.assertIn('1 are missing', self.sweep('join', self.out).stderr)
        for row in rows:
            # Cut through by the step that begins the phase, or the next: dt is 0.01 s.
            self.assertAlmostEqual(float(row['separation.time_s']),
                                   float(row['phases.hold.timeout']), delta=0.021)
            self.assertEqual(row['separation.phase'], 'part')
            self.assertEqual(row['pieces'], '2')
            self.assertEqual(row['peak_force_n'], row['clamps.hand.peak_force_n'])
        light, heavy = ([float(row['peak_force_n']) for row in rows if row['seed'] == '2' and
                         row['cloth.fabric.areal_density'] == density]
                        for density in ('0.1', '0.3'))
        for a, b in zip(light, heavy):
            self.assertGreater(b, 1.5 * a)  # three times the weight

    def test_the_plot(self):
        for job in self.jobs(*GRID):
            run(job)
        table, image = self.path('t.csv'), self.path('t.png')
        result = self.sweep('join', self.out, '--table', table, '--plot', image)
        self.assertEqual(result.stdout, '')
        with open(image, 'rb') as file:
            data = file.read()
        self.assertEqual(data[:8], b'\x89PNG\r\n\x1a\n')
        self.assertGreater(min(struct.unpack('>II', data[16:24])), 400)
        with open(table) as file:
            self.assertEqual(len(list(csv.DictReader(file))), 8)
        self.sweep('join', self.out, '--plot', image, '--x', 'seed', '--y', 'max_strain',
                   '--series', 'phases.hold.timeout')

    def test_lines_are_means_with_their_spread(self):
        # Calls the module, because a picture cannot be compared with numbers.
        from importlib.machinery import SourceFileLoader
        sweep = SourceFileLoader('cloth_sweep', SWEEP).load_module()
        rows = [{'ratio': ratio, 'fabric': fabric, 'seed': seed, 'y': value}
                for ratio, fabric, seed, value in (
                    ('1.5', 'silk', '1', 1.0), ('1.5', 'silk', '2', 3.0),
                    ('2', 'silk', '1', None), ('2', 'wool', '1', 5.0))]
        self.assertEqual(sweep.lines_of(rows, 'ratio', ['fabric'], 'y'),
                         {'silk': [(1.5, 1.0, 2.0, 3.0)], 'wool': [(2.0, 5.0, 5.0, 5.0)]})

    # ---- bad input -------------------------------------------------------------------------------

    def refused(self, *arguments, says=''):
        result = self.sweep(*arguments, expected=2)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertIn(says, result.stderr)
        self.assertEqual(result.stdout, '')

    def test_bad_grids(self):
        for argument, says in (('seed', 'KEY=VALUE'), ('=1', 'KEY=VALUE'), ('a..b=1', 'KEY=VALUE'),
                               ('seed=', 'empty'), ('seed=1,,2', 'empty'), ('seed=1\n', 'new line'),
                               ('seed=3..1', '3..1'), ('seed=1,2,1', 'twice'),
                               ('seed=1..2000000', 'at most'), ('sede=1', 'sede'),
                               ('cloth.fabric=cotton,wol', 'wol'), ('seed=1,x', 'seed')):
            self.refused('jobs', self.scene, argument, '--out', self.out, says=says)
            self.assertFalse(os.path.exists(self.out), argument)
        self.refused('jobs', self.scene, 'seed=1', 'seed=2', '--out', self.out, says='twice')
        self.refused('jobs', self.scene, 'seed=1..2000', 'drag=0..2000', '--out', self.out,
                     says='at most')
        self.refused('jobs', self.path('none.yaml'), 'seed=1', '--out', self.out, says='none.yaml')
        self.refused('jobs', self.scene, 'seed=1', '--out', '/proc/sweep', says='/proc/sweep')
        self.refused('jobs', self.scene, 'seed=1', '--out', self.out, '--cloth-run',
                     self.path('none'), says='cannot be run')

    def test_two_sweeps_do_not_mix(self):
        self.jobs('seed=1')
        self.refused('jobs', self.scene, 'drag=1', '--out', self.out, says='sweep over seed')
        self.refused('jobs', self.scene, 'seed=1', '--duration', '1', '--out', self.out,
                     says='duration')
        with open(self.scene, 'a') as file:
            file.write('drag: 2.0\n')
        self.refused('jobs', self.scene, 'seed=1', '--out', self.out, says="scene's text")

    def test_bad_joins(self):
        self.refused('join', self.path('none'), says='no folder')
        jobs = self.jobs('seed=1,2')
        self.refused('join', self.out, says='no run is done')
        run(jobs[0])
        self.refused_join('--plot', self.path('x.png'), '--y', 'nothing', says='nothing')
        self.refused_join('--plot', self.path('x.png'), '--x', 'drag', says='seed')
        self.refused_join('--table', '/no/such/x.csv', says='/no/such')
        self.path('sweep/sweep.json', '{}')
        self.refused('join', self.out, says='sweep.json')

    def refused_join(self, *arguments, says):
        result = self.sweep('join', self.out, *arguments, expected=2)
        self.assertIn(says, result.stderr.splitlines()[-1])
        self.assertNotIn('Traceback', result.stderr)


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'cloth_sweep_test', ClothSweepTest)
