#!/usr/bin/python3
"""Bags with compact frames: smaller, and good for the same things."""
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import rosbag
import rosunit

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, os.pardir, os.pardir)
sys.path[:0] = [HERE, os.path.join(ROOT, 'python')]
from cloth_sim import frames  # noqa: E402
from scratch import find_program  # noqa: E402

HALF_UNIT = 0.5e-4  # largest error of a position [m]
SCENE = ['cut', '--set', 'cloth.particles=[33, 33]', '--duration', '2.0']


class CompactBagTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.full, cls.compact = (os.path.join(cls.folder, name) for name in ('full', 'compact'))
        for path, options in ((cls.full, []), (cls.compact, ['--compact-bag'])):
            subprocess.run([find_program('cloth_run'), *SCENE, '--bag', path, *options], check=True,
                           capture_output=True)

    def script(self, name, *arguments):
        done = subprocess.run([sys.executable, os.path.join(ROOT, 'scripts', name), *arguments],
                              capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_positions_are_within_half_a_unit(self):
        def read(path, topic):
            with rosbag.Bag(path) as bag:
                return [message for _, message, _ in bag.read_messages(topics=[topic])]
        pairs = list(zip(read(self.full, '/cloth/frame'),
                         read(self.compact, '/cloth/compact_frame')))
        self.assertGreater(len(pairs), 50)
        self.assertGreater(len({compact.revision for _, compact in pairs}), 1)  # it was cut
        for full, compact in pairs:
            self.assertEqual((full.step, full.time, full.revision),
                             (compact.step, compact.time, compact.revision))
            error = np.abs(frames.positions(full).astype(float) - frames.positions(compact)).max()
            self.assertLess(error, HALF_UNIT + 5e-7)

    def test_it_is_a_fraction_of_the_size(self):
        self.assertLess(os.path.getsize(self.compact), 0.35 * os.path.getsize(self.full))

    def test_it_repeats_the_run(self):
        done = subprocess.run([find_program('cloth_run'), '--replay', self.compact],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_scripts_read_it(self):
        picture = os.path.join(self.folder, 'run.png')
        self.script('picture.py', self.compact, '--out', picture)
        self.assertGreater(os.path.getsize(picture), 10000)
        meshes = os.path.join(self.folder, 'meshes')
        self.script('read_bag.py', self.compact, '--meshes', meshes)
        self.assertGreater(len(os.listdir(meshes)), 50)


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'compact_bag', CompactBagTest)
