#!/usr/bin/python3
"""scripts/picture.py: draws a bag, and colours by the strain that the figures tell."""
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy
import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scratch import find_program  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
PICTURE = os.path.join(HERE, os.pardir, os.pardir, 'scripts', 'picture.py')
SCENE = """
cloth: {size: [0.4, 0.4], particles: [17, 17], pose: {position: [0.0, 0.0, 0.5]},
        pins: [corner_01, corner_11], fabric: cotton}
obstacles: {table: {type: board, size: [1.0, 1.0, 0.05], position: [0.0, 0.0, -0.025]}}
clamps: {hand: {pose: {position: [0.15, -0.15, 0.6]}}}
phases:
  - {name: fall, timeout: 0.2}
  - name: operate
    refine: {point: [0.0, 0.0, 0.45], radius: 0.1, generations: 2}
    notch: [[0.2, 0.0], [0.2, 0.1]]
    cut: {path: [[-0.1, 0.013, 0.6], [0.1, 0.017, 0.6]], direction: [0, 0, -1]}
    timeout: 0.3
"""


def load_picture():
    spec = importlib.util.spec_from_file_location('picture', PICTURE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class PictureTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.scene = os.path.join(folder.name, 'scene.yaml')
        cls.bag = os.path.join(folder.name, 'run.bag')
        cls.image = os.path.join(folder.name, 'run.png')
        with open(cls.scene, 'w') as file:
            file.write(SCENE)
        subprocess.run([find_program('cloth_run'), cls.scene, '--bag', cls.bag], check=True,
                       capture_output=True)

    def draw(self, *arguments):
        """Draws, and returns the picture."""
        subprocess.run([sys.executable, PICTURE, self.bag, '--out', self.image, *arguments],
                       check=True, timeout=300)
        with open(self.image, 'rb') as file:
            picture = file.read()
        self.assertEqual(picture[:8], b'\x89PNG\r\n\x1a\n')
        return picture

    def test_the_scene_is_in_the_bag(self):
        at = ('--size', '120x100', '--times', '0.1')
        self.assertEqual(self.draw(*at), self.draw(*at, '--scene', self.scene))
        self.assertNotEqual(self.draw(*at), self.draw(*at, '--scene', 'hang'), 'no table there')
        run = load_picture().Run(self.bag)
        self.assertIn('table', run.scene())

    def video(self, name, *arguments):
        path = os.path.join(os.path.dirname(self.image), name)
        result = subprocess.run([sys.executable, PICTURE, self.bag, '--video', path, '--size',
                                 '120x100', '--fps', '10', *arguments], capture_output=True,
                                text=True, timeout=300)
        return path, result

    def test_a_run_becomes_a_gif(self):
        from PIL import Image
        path, result = self.video('run.gif')
        self.assertEqual((result.returncode, result.stderr), (0, ''))
        with Image.open(path) as image:
            self.assertEqual(image.size, (120, 100))
            self.assertEqual(image.n_frames, 6)  # 0.5 s, both ends
            self.assertEqual(image.info['duration'], 100)  # [ms]

    def test_a_run_becomes_an_mp4_where_ffmpeg_is(self):
        path, result = self.video('run.mp4')
        if shutil.which('ffmpeg'):
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertGreater(os.path.getsize(path), 1000)
        else:
            self.assertEqual(result.returncode, 1)
            self.assertEqual(result.stderr, 'error: --video: %s: mp4 needs ffmpeg (Debian: ffmpeg), '
                             'gif does not\n' % path)

    def test_phases_and_single_times_are_drawn(self):
        self.draw('--size', '120x100')
        one = self.draw('--size', '120x100', '--times', '0.45')
        self.assertNotEqual(self.draw('--size', '120x100', '--times', '0.45', '--zoom', '0.5'), one)

    def test_a_panel_may_be_given_by_its_width(self):
        picture = load_picture()
        self.assertEqual(picture.panel_size('120x100'), (120, 100))
        self.assertEqual(picture.panel_size('560'), (560, 460))

    def test_bad_arguments_are_refused_in_a_line(self):
        for arguments in (['--size', '900,700'], ['--size', '0'], ['--view', '1'],
                          ['--times', 'end'], ['--scene', 'no_such_scene'],
                          ['--video', 'run.avi'], ['--video', '/no/such/run.gif'],
                          ['--fps', '0'], ['--zoom', '0']):
            result = subprocess.run([sys.executable, PICTURE, self.bag, '--out', self.image,
                                     *arguments], capture_output=True, text=True, timeout=300)
            self.assertNotEqual(result.returncode, 0, arguments)
            self.assertNotIn('Traceback', result.stderr)
            self.assertIn(arguments[0], result.stderr.splitlines()[-1])

    def test_a_bag_that_cannot_be_read_is_one_line(self):
        for bag, reason in (('/no_such.bag', 'No such file or directory'), ('/', 'Is a directory'),
                            (PICTURE, 'This does not appear to be a bag file')):
            result = subprocess.run([sys.executable, PICTURE, bag, '--out', self.image],
                                    capture_output=True, text=True, timeout=300)
            self.assertEqual(result.returncode, 1)
            self.assertEqual(result.stderr, 'error: %s: %s\n' % (bag, reason))

    def test_the_strain_of_the_colours_is_that_of_the_figures(self):
        picture = load_picture()
        run = picture.Run(self.bag)
        self.assertGreaterEqual(len(run.topologies), 2, 'the mesh has changed')
        largest = 0.0
        for index, (_, state) in enumerate(run.states):
            points, topology = run.shape(index)
            strain = picture.drawing.vertex_strains(topology, points).max()
            self.assertAlmostEqual(strain, state.max_strain, delta=1e-4, msg=f't = {state.time}')
            largest = max(largest, strain)
        self.assertGreater(largest, 0.01)

    def test_the_border_has_one_face_and_is_not_torn(self):
        drawing = load_picture().drawing
        cell = numpy.array([[0, 1, 3], [0, 3, 2]])
        border = drawing.border_edges(cell, numpy.array([[3, 1]]))
        self.assertEqual(border.tolist(), [[0, 1], [0, 2], [2, 3]])


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'picture', PictureTest)
