#!/usr/bin/python3
"""cloth_run with solver.budget real_time: one line, one file, and the same bits elsewhere. Needs no
master."""
import json
import os
import re
import subprocess
import sys

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scratch import ScratchTest, find_program  # noqa: E402

CLOTH_RUN = find_program('cloth_run')

# Needs more substeps for its error than either calibration of these tests allows.
SCENE = """
cloth:
  size: [0.8, 0.8]
  particles: [20, 20]
  pose: {position: [0, 0, 1], rpy: [0.6, 0, 0]}
  fabric: silk
  pins: [last_row]
solver: {error: 0.002, budget: real_time}
"""


class RealTimeTest(ScratchTest):
    def setUp(self):
        super().setUp()
        self.scene = self.path('swing.yaml', SCENE)
        self.file = self.path('real_time.csv')

    def run_cloth(self, *arguments, expected=0):
        result = subprocess.run([CLOTH_RUN, *arguments, '--summary', '-'], capture_output=True,
                                text=True, timeout=120,
                                env=dict(os.environ, CLOTH_SIM_CACHE=self.folder.name))
        self.assertEqual(result.returncode, expected, result.stderr)
        summary = json.loads(result.stdout) if result.stdout else None
        lines = [line for line in result.stderr.splitlines() if 'real' in line and
                 'real-time factor' not in line]
        return summary, lines

    def budget_in(self, line):
        return int(re.search(r'solver.budget real_time: (\d+) substeps in a step of 16.7 ms',
                             line).group(1))

    def set_cost(self, substep):
        """As if the machine took so long for a substep [s]."""
        with open(self.file) as file:
            lines = file.read().splitlines()
        row = lines[-1].split(',')
        with open(self.file, 'w') as file:
            file.write('\n'.join(lines[:-1] + [','.join(row[:-2] + ['0', str(substep)])]) + '\n')

    def test_is_printed_recorded_and_kept(self):
        first, lines = self.run_cloth(self.scene, '--duration', '0.1')
        self.assertEqual(len(lines), 1)
        self.assertEqual(first['method_params']['budget'], self.budget_in(lines[0]))
        self.assertEqual(first['error_estimate']['budget'], self.budget_in(lines[0]))
        self.assertIn('measured now', lines[0])
        second, lines = self.run_cloth(self.scene, '--duration', '0.1')
        self.assertIn(self.file, lines[0])
        self.assertEqual(second['state_hash'], first['state_hash'])
        self.set_cost(1.3e-3)
        _, lines = self.run_cloth(self.scene, '--duration', '0.1')
        self.assertEqual(self.budget_in(lines[0]), 10)
        _, lines = self.run_cloth(self.scene, '--duration', '0.1', '--calibrate')
        self.assertIn('measured now', lines[0])

    def test_a_bag_and_a_state_lead_to_the_same_bits_on_another_machine(self):
        self.run_cloth(self.scene, '--duration', '0')
        self.set_cost(1.3e-3)
        bag, state = self.path('run.bag'), self.path('half.state')
        straight, _ = self.run_cloth(self.scene, '--duration', '0.4', '--bag', bag)
        self.run_cloth(self.scene, '--duration', '0.2', '--save-state', state)
        self.set_cost(0.6e-3)
        other, _ = self.run_cloth(self.scene, '--duration', '0.4')
        self.assertEqual(other['method_params']['budget'], 22)
        self.assertNotEqual(other['state_hash'], straight['state_hash'])
        replayed, lines = self.run_cloth('--replay', bag)
        self.assertEqual(lines, [])
        self.assertEqual(replayed['state_hash'], straight['state_hash'])
        self.assertEqual(replayed['method_params'], straight['method_params'])
        rest, _ = self.run_cloth(self.scene, '--load-state', state, '--duration', '0.2')
        self.assertEqual(rest['state_hash'], straight['state_hash'])
        self.assertEqual(rest['error_estimate']['budget'], 10)

    def test_a_damaged_file_is_said_in_one_line_and_replaced(self):
        self.path('real_time.csv', 'no table\n')
        _, lines = self.run_cloth(self.scene, '--duration', '0')
        self.assertEqual(len(lines), 2)
        self.assertIn(self.file + ': line 1', lines[0])
        _, lines = self.run_cloth(self.scene, '--duration', '0')
        self.assertEqual(len(lines), 1)

    def test_bad_words_are_refused_in_one_line(self):
        for arguments in (['--set', 'solver.budget=fast'],
                          ['--set', 'solver.budget=40', '--calibrate']):
            _, lines = self.run_cloth(self.scene, *arguments, expected=2)
            self.assertEqual(len(lines), 1)
            self.assertIn('solver.budget', lines[0])


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'real_time', RealTimeTest)
