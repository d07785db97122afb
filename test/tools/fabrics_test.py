#!/usr/bin/python3
"""Built-in fabrics: what cloth_run prints, docs/fabrics.md, and percentiles of measured fabrics."""
import json
import os
import subprocess
import sys
import unittest

import rosunit

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(ROOT, 'study'))
import fabrics as study  # noqa: E402
from scratch import ScratchTest, find_program  # noqa: E402

LISTED = subprocess.check_output([find_program('cloth_run'), '--fabrics'], text=True)
SCENE = 'cloth: {size: [0.2, 0.2], particles: [5, 5], pins: [corner_00]}\n'
FABRICS = json.loads(LISTED)['fabrics']


def interpolated(rows, density, key):
    """The value of a column at a density."""
    for below, above in zip(rows, rows[1:]):
        low, high = below['areal_density'], above['areal_density']
        if low <= density <= high:
            part = (density - low) / (high - low)
            return below[key] + part * (above[key] - below[key])
    raise AssertionError('no measured fabrics of %g kg/m^2' % density)


class FabricsTest(ScratchTest):
    def test_each_fabric_can_be_named_in_a_scene(self):
        scene = self.path('scene.yaml', SCENE)
        for fabric in FABRICS:
            result = subprocess.run(
                [find_program('cloth_run'), scene, '--set', 'cloth.fabric=' + fabric['name'],
                 '--duration', '0.1', '--summary', '-'], capture_output=True, text=True, timeout=60)
            self.assertEqual(result.returncode, 0, result.stderr)
            mass = fabric['values']['areal_density']['value'] * 0.04
            self.assertAlmostEqual(json.loads(result.stdout)['mass_kg'], mass, delta=1e-9)

    def test_rigidity_is_that_of_measured_fabrics_of_the_same_density(self):
        _, rows = study.measured()
        for fabric in FABRICS:
            with self.subTest(fabric=fabric['name']):
                density = fabric['values']['areal_density']['value']
                bending = fabric['values']['bending']['value']
                self.assertGreaterEqual(bending, interpolated(rows, density, 'bending_p05'))
                self.assertLessEqual(bending, interpolated(rows, density, 'bending_p95'))

    def test_elasto_gravity_length_is_that_of_measured_fabrics(self):
        whole, _ = study.measured()
        self.assertEqual(whole['fabrics'], '618')
        for fabric in FABRICS:
            with self.subTest(fabric=fabric['name']):
                length = fabric['elasto_gravity_length_m']
                self.assertGreaterEqual(length, float(whole['length_p05']))
                self.assertLessEqual(length, float(whole['length_p95']))

    def test_sources_are_among_the_references_of_the_page(self):
        with open(os.path.join(ROOT, 'docs', 'fabrics.md')) as file:
            page = file.read()
        for fabric in FABRICS:
            for key, value in fabric['values'].items():
                if '[' in value['source']:
                    name = value['source'].partition('[')[2].partition(']')[0]
                    self.assertIn('- [%s]:' % name, page, '%s.%s' % (fabric['name'], key))

    def test_the_page_is_made_of_what_the_program_prints(self):
        page = study.page(study.fabrics_in(self.path('fabrics.json', LISTED)))
        with open(os.path.join(ROOT, 'docs', 'fabrics.md')) as file:
            self.assertEqual(file.read(), page, 'run study/publish_fabrics.sh')

    def test_the_list_needs_no_scene(self):
        names = [fabric['name'] for fabric in FABRICS]
        self.assertEqual(names, sorted(names))
        self.assertGreaterEqual(len(names), 9)


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'fabrics_test', FabricsTest)
