"""Helpers of the tests of cloth_sweep: a quick scene whose cloth is cut in two, and its command."""
import os
import subprocess
import sys

from scratch import ScratchTest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
SWEEP = os.path.join(ROOT, 'scripts', 'cloth_sweep')

# A cloth that hangs from a clamp and is cut in two after phases.hold.timeout. Runs in 0.1 s.
SCENE = """
cloth:
  size: [0.2, 0.2]
  particles: [9, 9]
  pose: {position: [0, 0, 1], rpy: [1.5707963267948966, 0, 0]}
  fabric: {preset: interlock}
solver: {dt: 0.01, substeps: 10, sleep: false}
clamps:
  hand: {pose: {position: [0, 0, 1.09], rpy: [1.5707963267948966, 0, 0]}, plate_size: [0.3, 0.05],
         closing_speed: 20.0}
phases:
  - {name: hold, clamps: {hand: {grasp: true}}, timeout: 0.2}
  - {name: part, notch: [[0, 0.07], [0.2, 0.07]], timeout: 0.1}
"""


class SweepTest(ScratchTest):
    def setUp(self):
        super().setUp()
        self.scene = self.path('hang.yaml', SCENE)
        self.out = self.path('sweep')

    def sweep(self, *arguments, expected=0):
        result = subprocess.run([sys.executable, SWEEP, *arguments], capture_output=True, text=True,
                                timeout=120)
        self.assertEqual(result.returncode, expected, result.stderr)
        return result

    def jobs(self, *grid):
        """The commands of the runs that are not finished."""
        return self.sweep('jobs', self.scene, *grid, '--out', self.out).stdout.splitlines()

    def job_list(self, *grid):
        """The path of a file with these commands."""
        return self.path('jobs.txt', ''.join(job + '\n' for job in self.jobs(*grid)))

    def summaries(self):
        return sorted(name for name in os.listdir(self.out) if name != 'sweep.json')
