#!/usr/bin/python3
"""scripts/chamfer.py: distance of measured clouds from a simulation. Needs no master."""
import csv
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import rosunit

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, os.pardir, os.pardir)
CHAMFER = os.path.join(ROOT, 'scripts', 'chamfer.py')
PATH = os.path.join(ROOT, 'docs', 'data', 'study', 'reality_fling_path.csv')

# A square of four particles that rises by 1 m within 1 s.
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], dtype=float)


def rows_of(clouds):
    return np.array([[time, *point] for time, cloud in clouds for point in cloud])


class ChamferTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.cloth = self.write('cloth.csv', [(0.0, CORNERS), (1.0, CORNERS + [0, 0, 1])])

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, clouds):
        with open(self.path(name), 'w') as file:
            file.write('time,x,y,z\n')
            np.savetxt(file, rows_of(clouds), delimiter=',')
        return self.path(name)

    def text(self, name, content):
        with open(self.path(name), 'w') as file:
            file.write(content)
        return self.path(name)

    def run_it(self, *arguments, expected=0):
        result = subprocess.run([sys.executable, CHAMFER, *map(str, arguments)],
                                capture_output=True, text=True, timeout=60)
        self.assertEqual(result.returncode, expected, result.stderr)
        return result

    def mean(self, *arguments):
        return float(self.run_it(*arguments).stdout.split()[3])

    def refused(self, *arguments, says):
        error = self.run_it(*arguments, expected=2).stderr
        self.assertEqual(error.count('\n'), 1, error)
        self.assertIn(says, error)

    def test_help(self):
        self.assertIn('--times', self.run_it('--help').stdout)

    def test_a_cloth_is_at_no_distance_from_itself(self):
        self.assertEqual(self.mean(self.cloth, self.cloth), 0.0)

    def test_particles_are_interpolated_and_each_point_has_its_nearest(self):
        # Half-way, the square is at z = 0.5: one point is 0.1 m above it, one 0.3 m beside it.
        cloud = [(0.5, np.array([[0, 0, 0.6], [1.3, 1, 0.5], [np.nan, 0, 0]]))]
        table = self.path('table.csv')
        self.assertAlmostEqual(
            self.mean(self.write('cloud.csv', cloud), self.cloth, '--table', table), 0.2, places=6)
        with open(table, newline='') as file:
            [row] = list(csv.DictReader(file))
        self.assertEqual(int(row['points']), 2)
        self.assertAlmostEqual(float(row['largest_m']), 0.3, places=9)

    def test_it_is_one_sided(self):
        corner = self.write('corner.csv', [(0.0, CORNERS[:1])])
        self.assertEqual(self.mean(corner, self.cloth), 0.0)
        self.assertAlmostEqual(self.mean(self.cloth, corner), (2.0 + 2.0 ** 0.5) / 4.0, places=6)

    def test_offset_and_translation(self):
        cloud = self.write('cloud.csv', [(7.0, CORNERS + [0, 0, 3])])
        self.assertAlmostEqual(
            self.mean(cloud, self.cloth, '--time-offset', -6, '--translate', 0, 0, -2.5), 0.5,
            places=6)

    def test_arrays_and_ply_are_read(self):
        np.save(self.path('frames.npy'), np.array([CORNERS, CORNERS + [0, 0, 1]]))
        np.save(self.path('rows.npy'), rows_of([(1.0, CORNERS)]))
        times = self.text('times.txt', '0\n1\n')
        self.assertEqual(self.mean(self.path('frames.npy'), self.cloth, '--times', times), 0.0)
        self.assertEqual(self.mean(self.path('rows.npy'), self.cloth), 1.0)
        ply = self.text('a.ply', 'ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n'
                                 'property float y\nproperty float z\nproperty uchar red\n'
                                 'end_header\n0 0 0.25 9\n1 1 0.25 9\n')
        once = self.text('once.txt', '0\n')
        self.assertAlmostEqual(self.mean(ply, self.cloth, '--times', once), 0.25, places=6)

    def test_bad_input_is_refused_in_one_line(self):
        self.refused(self.path('none.csv'), self.cloth, says='none.csv')
        self.refused(self.text('x.csv', 'time,x,y,z\n0,1,2\n'), self.cloth, says='x.csv:2')
        self.refused(self.text('y.csv', '0,1,2,three\n'), self.cloth, says='y.csv:1')
        self.refused(self.text('e.csv', 'time,x,y,z\n'), self.cloth, says='no points')
        self.refused(self.text('b.ply', 'ply\nformat binary_little_endian 1.0\nend_header\n'),
                     self.cloth, '--times', self.text('t', '0\n'), says='ascii')
        self.refused(self.write('late.csv', [(5.0, CORNERS)]), self.cloth, says='0 to 1 s')
        np.save(self.path('f.npy'), np.array([CORNERS]))
        self.refused(self.path('f.npy'), self.cloth, says='--times')
        self.refused(self.cloth, self.path('cloth.xyz'), says='.bag')
        self.refused(self.cloth, self.text('no.bag', 'no bag'), says='no.bag')

    def test_the_published_trajectory_is_read(self):
        self.assertEqual(self.mean(PATH, PATH), 0.0)


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'chamfer_test', ChamferTest)
