#!/usr/bin/python3
"""A scene pays only for what it names: instructions in steps, counted by valgrind's callgrind.

Counts do not depend on what else the machine does. Each is that of steps 4 to 6, so that what the
first ones set up is not in it.
"""
import os
import re
import shutil
import subprocess
import sys
import unittest

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scratch import ScratchTest, find_program  # noqa: E402

CLOTH_RUN = find_program('cloth_run')
LIBRARY = os.path.join(os.path.dirname(CLOTH_RUN), os.pardir, 'libcloth_core.so')
SIDE = 32
SUBSTEPS = 16
FIRST, LAST = 3, 6
DT = 1.0 / 1024.0  # so that substeps are stable with every method

SCENE = '''
cloth:
  particles: [%(side)d, %(side)d]
  fabric: {preset: cotton, damping: 0}
  bending: %(bending)s
  pose: {position: [0, 0, 1], rpy: [1.5707963267948966, 0, 0]}
  pins: [corner_01, corner_11]
drag: %(drag)s
solver: {method: %(method)s, substeps: %(substeps)d, dt: %(dt)g}
%(more)s
'''

# Features that a scene may name, and functions that do their work. All of these functions must be
# in the library: one that was renamed is an error. Most are called from files of other folders, so
# that the compiler cannot inline them, in unity builds either.
FEATURES = {
    'obstacle': ({'more': 'obstacles:\n  ball: {type: sphere, radius: 0.1, position: [0, 0.04, 1]}'},
                 ['ColliderSet::detect', 'Contacts::project']),
    'wind': ({'more': 'wind: {velocity: [0, 1, 0]}'}, ['addLoads', 'addWind']),
    'bending': ({'bending': 'plate'},
                ['BendMatrix::addForces', 'BendMatrix::addProduct', 'BendMatrix::displace',
                 'BendProjection::projectFree']),
    'tearing': ({'more': 'tearing: {ratio: 5}'}, ['Tearing::plan', 'Tearing::findOverloads']),
}


def is_built_otherwise():
    """Whether the library is built by clang, or with a sanitizer, under which valgrind does not
    work."""
    about = subprocess.run(['readelf', '--string-dump=.comment', '--dynamic', LIBRARY], check=True,
                           capture_output=True, text=True).stdout
    return re.search('clang|lib[a-z]+san', about) is not None


def is_function(function, symbol):
    """Whether a demangled symbol is this function, whatever namespace or class it is in."""
    return re.search(r'(^|[:\s])%s\(' % re.escape(function), symbol) is not None


@unittest.skipIf(is_built_otherwise(), 'counts functions that GCC does not inline')
class InstructionsTest(ScratchTest):
    def setUp(self):
        super().setUp()
        self.assertTrue(shutil.which('valgrind'), 'not installed: valgrind')

    def count(self, steps, scene):
        """By function, with what it calls, in all steps."""
        out = self.path('callgrind.out')
        run = subprocess.run(
            ['valgrind', '--tool=callgrind', '--toggle-collect=cloth_sim::Simulation::step()',
             '--callgrind-out-file=' + out, CLOTH_RUN, scene, '--threads', '1', '--duration',
             '%g' % (steps * DT)], capture_output=True, text=True, timeout=600)
        self.assertEqual(run.returncode, 0, run.stderr)
        told = subprocess.run(['callgrind_annotate', '--inclusive=yes', '--threshold=100', out],
                              check=True, capture_output=True, text=True).stdout
        counts = {}
        for line in told.splitlines():
            found = re.match(r'\s*([\d,]+) \([\s\d.]+%\)\s+(?:[^\s:]*:)?(.*)', line)
            if found:
                name = re.sub(r' \[.*', '', found.group(2))
                count = int(found.group(1).replace(',', ''))
                counts[name] = max(count, counts.get(name, 0))
        return counts

    def per_step(self, method='xpbd', **named):
        values = {'side': SIDE, 'substeps': SUBSTEPS, 'dt': DT, 'drag': 0, 'bending': 'none',
                  'more': '', 'method': method, **named}
        scene = self.path('scene.yaml', SCENE % values)
        first, last = self.count(FIRST, scene), self.count(LAST, scene)
        return {name: (count - first.get(name, 0)) / (LAST - FIRST)
                for name, count in last.items()}

    def whole(self, counts):
        return next(count for name, count in counts.items() if 'Simulation::step()' in name)

    def most(self, counts, functions):
        """The cost of the costliest of these functions, and its name."""
        return max(((count, name) for name, count in counts.items()
                    if any(is_function(function, name) for function in functions)), default=(0, 'none'))

    def test_the_functions_exist(self):
        symbols = subprocess.run(['nm', '--demangle', '--defined-only', LIBRARY], check=True,
                                 capture_output=True, text=True).stdout.splitlines()
        for feature, (_, functions) in FEATURES.items():
            for function in functions:
                self.assertTrue(any(is_function(function, symbol) for symbol in symbols),
                                '%s: %s has no function %s' % (feature, LIBRARY, function))

    def expect_paid_only_if_named(self, method):
        bare = self.per_step(method)
        whole = self.whole(bare)
        for feature, (named, functions) in FEATURES.items():
            count, name = self.most(bare, functions)
            self.assertLess(count, 0.01 * whole, '%s: %s in a bare scene' % (feature, name))
            paid, name = self.most(self.per_step(method, **named), functions)
            self.assertGreater(paid, max(10.0 * count, SIDE * SIDE),
                               '%s: %s costs no more where it is named' % (feature, name))

    def test_xpbd(self):
        self.expect_paid_only_if_named('xpbd')

    def test_projective(self):
        self.expect_paid_only_if_named('projective')

    def test_symplectic_euler(self):
        self.expect_paid_only_if_named('symplectic_euler')

    def test_drag_is_not_computed_where_there_is_none(self):
        """Drag costs at least a quarter of an instruction for each particle and substep."""
        for method in ('xpbd', 'symplectic_euler', 'rk4'):
            bare = self.whole(self.per_step(method))
            dragged = self.whole(self.per_step(method, drag=0.5))
            self.assertGreater(dragged - bare, 0.25 * SUBSTEPS * SIDE * SIDE, method)

    def test_what_is_named_but_off_is_not_paid(self):
        bare = self.whole(self.per_step())
        off = self.whole(self.per_step(more='tearing: {enabled: false, ratio: 5}'))
        self.assertLess(abs(off - bare), 0.01 * bare)

    def test_an_obstacle_far_away_is_all_but_free(self):
        """One look at the bounds of the cloth and its speed in a step, of a thousand instructions."""
        more = 'obstacles: {ball: {type: sphere, radius: 0.1, position: [0, 9, 1]}}'
        for method in ('xpbd', 'projective'):
            bare = self.whole(self.per_step(method))
            far = self.whole(self.per_step(method, more=more))
            self.assertLess(far - bare, 27 * SIDE * SIDE, method)  # twenty-seven a particle
            print('%s: %.2f %% more with an obstacle far away' % (method, 100.0 * (far / bare - 1.0)))


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'instructions_test', InstructionsTest)
