#!/usr/bin/python3
"""cloth_run continues from a saved state, and replays the commands of a bag. Needs no master."""
import json
import os
import resource
import subprocess
import sys

import rosbag
import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scratch import ScratchTest, find_program  # noqa: E402

CLOTH_RUN = find_program('cloth_run')

# A cloth that is cut, falls and tears.
SCENE = """
cloth:
  size: [0.4, 0.4]
  particles: [17, 17]
  pose: {position: [0.0, 0.0, 0.3]}
  pins: [corner_00, corner_10]
  fabric: {preset: interlock}
obstacles: {sphere: {type: sphere, radius: 0.1, position: [0.1, 0.1, 0.1]}}
tearing: {enabled: true, ratio: 1.2}
phases:
  - {name: fall, timeout: 0.3}
  - {name: notch, notch: [[0.2, 0.0], [0.2, 0.1]], timeout: 0.3}
"""

TWO = """
cloth:
  - {name: sheet, size: [0.4, 0.4], particles: [9, 9], pose: {position: [0, 0, 0.3]}, fabric: cotton}
  - {name: strip, size: [0.2, 0.4], particles: [5, 9], pose: {position: [1, 0, 0.3]}, fabric: denim}
obstacles: {ground: {type: plane, position: [0, 0, 0.2]}}
phases:
  - {name: fall, timeout: 0.1}
  - {name: cut, notch: {cloth: strip, path: [[-0.01, 0.21], [0.21, 0.23]]}, timeout: 0.2}
"""


class SavedRunsTest(ScratchTest):
    def setUp(self):
        super().setUp()
        self.scene = self.path('scene.yaml', SCENE)

    def run_cloth(self, *arguments, expected=0):
        result = subprocess.run([CLOTH_RUN, *arguments], capture_output=True, text=True,
                                timeout=120)
        self.assertEqual(result.returncode, expected, result.stderr)
        return result

    def summary(self, *arguments):
        return json.loads(self.run_cloth(*arguments, '--summary', '-').stdout)

    def refused(self, *arguments, says=''):
        result = self.run_cloth(*arguments, expected=2)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertIn(says, result.stderr)

    # ---- saved states ----------------------------------------------------------------------------

    def test_continues_from_a_saved_state(self):
        straight = self.summary(self.scene, '--duration', '0.6')
        state = self.path('half.state')
        half = self.summary(self.scene, '--duration', '0.35', '--save-state', state)
        self.assertNotEqual(half['state_hash'], straight['state_hash'])
        rest = self.summary(self.scene, '--load-state', state, '--duration', '0.25')
        self.assertEqual(rest['state_hash'], straight['state_hash'])
        self.assertEqual(rest['broken'], straight['broken'])
        self.assertEqual(rest['phases'], straight['phases'])
        self.assertEqual(rest['initial_mass_kg'], straight['initial_mass_kg'])
        self.assertGreater(rest['broken']['total'], 0)

    def test_several_cloths_by_name_from_a_bag_and_from_a_state(self):
        scene = self.path('two.yaml')
        with open(scene, 'w') as file:
            file.write(TWO)
        overrides = ['--set', 'cloth.strip.particles=[7, 9]', '--set', 'cloth.0.fabric=silk']
        bag, state = self.path('two.bag'), self.path('two.state')
        summary = self.summary(scene, *overrides, '--bag', bag)
        self.assertEqual([(c['name'], c['fabric'], c['particles']) for c in summary['cloths']],
                         [('sheet', 'silk', 81), ('strip', 'denim', 63)])
        self.assertEqual(summary['pieces'], 3)
        self.run_cloth('--replay', bag)
        self.run_cloth(scene, *overrides, '--duration', '0.15', '--save-state', state)
        again = self.summary(scene, *overrides, '--load-state', state)
        self.assertEqual(again['state_hash'], summary['state_hash'])
        self.refused(scene, '--set', 'cloth.strip.name=sheet',
                     says='cloth.sheet.name: expected a name that no other cloth has')

    def test_without_a_duration_the_phases_end_it(self):
        state = self.path('half.state')
        self.run_cloth(self.scene, '--duration', '0.35', '--save-state', state)
        self.assertEqual(self.summary(self.scene, '--load-state', state)['state_hash'],
                         self.summary(self.scene)['state_hash'])

    def test_states_of_other_scenes_are_refused(self):
        state = self.path('a.state')
        self.run_cloth(self.scene, '--duration', '0.1', '--save-state', state)
        self.refused(self.scene, '--set', 'seed=2', '--load-state', state, says='another scene')
        self.refused(self.scene, '--load-state', self.scene, says='no saved state')
        self.refused(self.scene, '--load-state', self.path('none'), says='cannot be read')
        self.refused(self.scene, '--save-state', self.path('no/where'), says='cannot be written')

    def test_a_full_disk_leaves_nothing_behind(self):
        """A limit on the size of files stands for a full disk: write() fails in the middle."""
        state = self.path('a.state')
        result = subprocess.run(
            [CLOTH_RUN, self.scene, '--duration', '0.1', '--save-state', state],
            capture_output=True, text=True, timeout=120, restore_signals=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (10000, 10000)))
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn('a.state: cannot be written', result.stderr.splitlines()[-1])
        self.assertEqual(os.listdir(self.folder.name), ['scene.yaml'])

    # ---- bags ------------------------------------------------------------------------------------

    def test_a_bag_leads_to_its_own_hash(self):
        bag = self.path('run.bag')
        recorded = self.summary(self.scene, '--bag', bag)
        result = self.run_cloth('--replay', bag, '--summary', '-')
        again = json.loads(result.stdout)
        self.assertEqual(again['state_hash'], recorded['state_hash'])
        self.assertIn(recorded['state_hash'], result.stderr.splitlines()[-1])

    def test_a_bag_of_a_replay_and_of_a_loaded_state_can_be_replayed_too(self):
        state, first, second = self.path('a.state'), self.path('a.bag'), self.path('b.bag')
        self.run_cloth(self.scene, '--duration', '0.35', '--save-state', state)
        end = self.summary(self.scene, '--load-state', state, '--bag', first)['state_hash']
        again = self.summary('--replay', first, '--bag', second)
        self.assertEqual(again['state_hash'], end)
        self.assertEqual(self.summary('--replay', second)['state_hash'], end)

    def test_overrides_are_in_the_bag(self):
        bag = self.path('run.bag')
        self.run_cloth(self.scene, '--set', 'gravity=[0.0, 1.0, -3.0]', '--bag', bag)
        self.run_cloth('--replay', bag)

    def rewrite(self, bag, change):
        """A copy of a bag with other messages. \\return its path."""
        path = self.path('changed.bag')
        with rosbag.Bag(bag) as source, rosbag.Bag(path, 'w') as target:
            for topic, message, stamp in source.read_messages():
                if change(topic, message):
                    target.write(topic, message, stamp)
        return path

    def test_another_result_is_noticed(self):
        bag = self.path('run.bag')
        self.run_cloth(self.scene, '--bag', bag)

        def heavier(topic, message):
            if topic == '/cloth/scene':
                message.data = message.data.replace('interlock', 'cotton')
            return True
        result = self.run_cloth('--replay', self.rewrite(bag, heavier), expected=4)
        self.assertIn('was not reproduced', result.stderr.splitlines()[-1])

    def test_bags_that_cannot_be_replayed(self):
        bag = self.path('run.bag')
        self.run_cloth(self.scene, '--bag', bag)
        without = self.rewrite(bag, lambda topic, _: topic != '/cloth/scene')
        self.refused('--replay', without, says='no scene')
        without = self.rewrite(bag, lambda topic, _: topic != '/cloth/state')
        self.refused('--replay', without, says='expected the ~state of one cloth')
        self.refused('--replay', self.scene, says='no bag')
        self.refused('--replay', self.path('none'), says='cannot be read')
        self.refused('--replay', bag, self.scene, says='SCENE')

    def test_every_part_of_a_bag_is_complete(self):
        bag = self.path('long.bag')
        self.run_cloth(self.scene, '--duration', '11', '--bag', bag, '--bag-rate', '5')
        with rosbag.Bag(bag) as opened:
            for topic in ('/cloth/scene', '/cloth/topology', '/cloth/phase',
                          '/cloth/broken_springs'):
                times = [0.0] + [stamp.to_sec() for _, _, stamp in opened.read_messages([topic])]
                self.assertGreaterEqual(len(times), 4, topic)
                gaps = [b - a for a, b in zip(times, times[1:])]
                self.assertLess(max(gaps), 5.3, topic)  # 5 s, rounded up to a frame


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'saved_runs_test', SavedRunsTest)
