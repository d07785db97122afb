#!/usr/bin/python3
"""docs/accuracy.md, at_size.md, reality.md and performance.md agree with the tables in docs/data.
Needs no master."""
import os
import shutil
import subprocess
import tempfile
import unittest

import rosunit

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
DATA = os.path.join(ROOT, 'docs', 'data', 'study')


def report(folder, template='accuracy.md.in'):
    return subprocess.run(['/usr/bin/python3', os.path.join(ROOT, 'study', 'report.py'),
                           os.path.join(ROOT, 'study', template), folder],
                          capture_output=True, text=True)


class AccuracyDocTest(unittest.TestCase):
    def test_the_page_is_made_of_the_tables(self):
        result = report(DATA)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(ROOT, 'docs', 'accuracy.md')) as file:
            self.assertEqual(file.read(), result.stdout, 'run study/publish.sh docs/data/study')

    def test_the_page_of_errors_at_size_is_made_of_the_tables(self):
        result = report(DATA, 'at_size.md.in')
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(ROOT, 'docs', 'at_size.md')) as file:
            self.assertEqual(file.read(), result.stdout,
                             'run study/publish_at_size.sh docs/data/study')

    def test_the_page_of_measured_cloth_is_made_of_the_tables(self):
        result = report(DATA, 'reality.md.in')
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(ROOT, 'docs', 'reality.md')) as file:
            self.assertEqual(file.read(), result.stdout,
                             'run study/publish_reality.sh docs/data/study')
        for name in ('bending', 'drape', 'pull', 'fling'):
            image = os.path.join(ROOT, 'docs', 'images', 'reality_' + name + '.png')
            self.assertGreater(os.path.getsize(image), 10000, image)

    def test_the_comparison_with_bullet_is_made_of_the_tables(self):
        folder = os.path.join(ROOT, 'docs', 'data', 'performance')
        page = subprocess.run(['/usr/bin/python3', os.path.join(ROOT, 'bench', 'report.py'), folder],
                              capture_output=True, text=True)
        self.assertEqual(page.returncode, 0, page.stderr)
        with open(os.path.join(ROOT, 'docs', 'performance.md')) as file:
            self.assertEqual(file.read(), page.stdout, 'run bench/report.py docs/data/performance')

    def test_its_charts_are_there(self):
        for name in ('hang_swing', 'drape_sphere', 'stability', 'resolution'):
            image = os.path.join(ROOT, 'docs', 'images', 'study_' + name + '.png')
            self.assertGreater(os.path.getsize(image), 10000, image)

    def test_a_claim_that_is_false_is_named(self):
        with tempfile.TemporaryDirectory() as parent:
            folder = os.path.join(parent, 'data')
            shutil.copytree(DATA, folder)
            table = os.path.join(folder, 'stability_limits.csv')
            with open(table) as file:
                lines = file.read().splitlines()
            [k] = [k for k, line in enumerate(lines) if line.startswith('verlet,oscillator')]
            fields = lines[k].split(',')
            fields[4] = '1.9'
            lines[k] = ','.join(fields)
            with open(table, 'w') as file:
                file.write('\n'.join(lines) + '\n')
            result = report(folder)
            self.assertEqual(result.returncode, 1)
            self.assertIn('not so: worst_limit() < 0.03', result.stderr)
            self.assertEqual(result.stdout, '')


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'accuracy_doc_test', AccuracyDocTest)
