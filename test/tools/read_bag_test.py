#!/usr/bin/python3
"""scripts/read_bag.py: a table, charts and meshes of a bag. Needs no master."""
import csv
import os
import struct
import subprocess
import sys
import tempfile
import unittest

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scratch import find_program  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
READ_BAG = os.path.join(HERE, os.pardir, os.pardir, 'scripts', 'read_bag.py')
BENCH = os.path.join(HERE, os.pardir, 'ros', 'bench.yaml')
CLOTH_RUN = find_program('cloth_run')
SCRIPT = ['phases.wait.timeout=0.2', 'phases.notch.timeout=0.3', 'phases.stop.timeout=0.1']


class ReadBagTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.bag = os.path.join(cls.folder.name, 'run.bag')
        overrides = [part for text in SCRIPT for part in ('--set', text)]
        subprocess.run([CLOTH_RUN, BENCH, *overrides, '--bag', cls.bag], check=True,
                       capture_output=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def read(self, *arguments, expected=0):
        result = subprocess.run([sys.executable, READ_BAG, *arguments], capture_output=True,
                                text=True, timeout=120)
        self.assertEqual(result.returncode, expected, result.stderr)
        return result

    def test_help(self):
        self.assertIn('--meshes', self.read('--help').stdout)

    def test_description(self):
        text = self.read(self.bag).stdout
        self.assertIn('/cloth/topology', text)
        self.assertIn('pieces 1', text)

    def test_table(self):
        self.read(self.bag, '--table', self.path('run.csv'))
        with open(self.path('run.csv')) as file:
            rows = list(csv.DictReader(file))
        self.assertGreater(len(rows), 15)
        times = [float(row['time_s']) for row in rows]
        self.assertEqual(times, sorted(times))
        broken = [int(row['broken']) for row in rows]
        self.assertEqual(broken[0], 0)
        self.assertGreater(broken[-1], 0)
        self.assertIn('force_left_n', rows[0])
        self.assertEqual(len(rows[-1]['state_hash']), 16)

    def test_plot(self):
        self.read(self.bag, '--plot', self.path('run.png'))
        with open(self.path('run.png'), 'rb') as file:
            data = file.read()
        self.assertEqual(data[:8], b'\x89PNG\r\n\x1a\n')
        width, height = struct.unpack('>II', data[16:24])
        self.assertGreater(min(width, height), 400)

    def test_meshes(self):
        self.read(self.bag, '--meshes', self.path('obj'), '--every', '3')
        with open(self.path('obj/times.csv')) as file:
            frames = list(csv.DictReader(file))
        self.assertEqual(sorted(os.listdir(self.path('obj'))),
                         sorted([frame['file'] for frame in frames] + ['times.csv']))
        with open(self.path('obj/' + frames[0]['file'])) as file:
            lines = [line.split() for line in file]
        self.assertEqual(sum(line[0] == 'v' for line in lines), 17 * 17)
        self.assertEqual(sum(line[0] == 'f' for line in lines), 2 * 16 * 16)
        corners = [int(part.split('/')[0]) for line in lines if line[0] == 'f' for part in line[1:]]
        self.assertEqual((min(corners), max(corners)), (1, 17 * 17))
        first = [float(part) for part in lines[0][1:]]
        self.assertAlmostEqual(first[0], -0.2, places=6)  # corner of a cloth of 0.4 m at z = 0.5
        self.assertAlmostEqual(first[2], 0.5, places=6)
        with open(self.path('obj/' + frames[-1]['file'])) as file:  # notched: more vertices
            self.assertGreater(sum(line.startswith('v ') for line in file), 17 * 17)

    def test_ply(self):
        self.read(self.bag, '--meshes', self.path('ply'), '--format', 'ply', '--every', '1000')
        with open(self.path('ply/frame_00000.ply'), 'rb') as file:
            header, body = file.read().split(b'end_header\n', 1)
        self.assertIn(b'element vertex 289\n', header)
        self.assertIn(b'element face 512\n', header)
        self.assertEqual(len(body), 289 * 5 * 4 + 512 * 13)
        self.assertEqual(body[289 * 20], 3)

    def test_bad_input(self):
        for arguments, says in (((self.path('none'),), 'no bag'), ((READ_BAG,), 'no bag'),
                                ((self.bag, '--node', '/other'), '/cloth'),
                                ((self.bag, '--table', '/proc/x.csv'), 'cannot be written'),
                                ((self.bag, '--every', '0'), '--every')):
            result = self.read(*arguments, expected=2)
            self.assertIn(says, result.stderr)
            self.assertNotIn('Traceback', result.stderr)


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'read_bag_test', ReadBagTest)
