#!/usr/bin/python3
"""The command line of cloth_run: exit statuses, messages, summary and bag. Needs no master."""
import json
import os
import resource
import signal
import subprocess
import sys
import time

import rosbag
import rosunit

from cloth_sim.msg import GraspEvent

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scratch import ScratchTest, find_program  # noqa: E402

BENCH = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, 'ros', 'bench.yaml')
CLOTH_RUN = find_program('cloth_run')

# Small, with a script that ends.
QUICK = """
cloth: {size: [0.2, 0.2], particles: [9, 9], pins: [corner_00, corner_10]}
clamps: {left: {pose: {position: [0.0, 0.0, 0.5]}}}
phases:
  - {name: fall, timeout: 0.2, on_timeout: continue}
  - {name: notch, notch: [[0.1, 0.0], [0.1, 0.1]], until: {elapsed: 0.2}}
"""

# A clamp that is too weak for the cloth: it closes, slips, loses the cloth, and opens.
SLIPS = """
cloth:
  size: [0.2, 0.2]
  particles: [9, 9]
  pose: {position: [0, 0, 1], rpy: [1.5707963267948966, 0, 0]}
solver: {dt: 0.01, substeps: 10}
clamps:
  hand: {pose: {position: [0, 0, 1.09], rpy: [1.5707963267948966, 0, 0]}, plate_size: [0.3, 0.05],
         closing_speed: 20.0, grip_force: 0.01}
phases:
  - {name: grasp, clamps: {hand: {grasp: true}}, timeout: 1.0}
  - {name: open, clamps: {hand: {grasp: false}}, timeout: 0.1}
"""


class ClothRunTest(ScratchTest):
    def setUp(self):
        super().setUp()
        self.scene = self.path('quick.yaml', QUICK)

    def run_cloth(self, *arguments, timeout=120):
        return subprocess.run([CLOTH_RUN, *arguments], capture_output=True, text=True,
                              timeout=timeout)

    def refused(self, *arguments, says=()):
        result = self.run_cloth(*arguments)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        for word in says:
            self.assertIn(word, result.stderr)

    def test_frames_every_few_steps(self):
        bag = self.path('run.bag')
        result = self.run_cloth(self.scene, '--bag', bag, '--frame-every', '5')
        self.assertEqual(result.returncode, 0, result.stderr)
        with rosbag.Bag(bag) as opened:
            steps = [message.step for _, message, _ in opened.read_messages(['/cloth/frame'])]
        self.assertEqual(sorted(set(steps)), steps)
        self.assertEqual([step for step in range(0, steps[-1] + 1, 5) if step not in steps], [])
        others = [step for step in steps if step % 5]  # a phase has begun, or the run has ended
        self.assertLessEqual(len(others), 2)
        self.refused(self.scene, '--frame-every', '5', says=('--frame-every', '--bag'))
        self.refused(self.scene, '--bag', bag, '--frame-every', '0', says=('--frame-every',))
        self.refused(self.scene, '--bag', bag, '--frame-every', '5', '--bag-rate', '10',
                     says=('--frame-every', '--bag-rate'))

    def test_runs_the_script_to_its_end(self):
        result = self.run_cloth(self.scene, '--summary', '-', '--threads', '1')
        self.assertEqual(result.returncode, 0, result.stderr)
        summary = json.loads(result.stdout)
        self.assertEqual([phase['name'] for phase in summary['phases']], ['fall', 'notch'])
        self.assertAlmostEqual(summary['sim_time_s'], 0.4, delta=0.05)
        self.assertEqual(summary['status'], 'done')
        self.assertEqual(summary['failure'], '')
        self.assertTrue(summary['finite'])
        self.assertGreater(summary['broken']['cut'], 0)
        self.assertIn('notch', result.stderr)  # progress in plain lines, as stderr is no terminal
        self.assertNotIn('\r', result.stderr)

    def test_duration_ends_it(self):
        result = self.run_cloth(self.scene, '--summary', '-', '--duration', '0.1')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertAlmostEqual(json.loads(result.stdout)['sim_time_s'], 0.1, delta=1e-6)

    def test_without_phases_it_runs_ten_seconds(self):
        scene = self.path('still.yaml', 'cloth: {size: [0.2, 0.2], particles: [3, 3]}\n')
        result = self.run_cloth(scene, '--summary', '-')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertAlmostEqual(json.loads(result.stdout)['sim_time_s'], 10.0, delta=0.02)

    def test_overrides(self):
        result = self.run_cloth('--set', 'cloth.particles=[5, 5]', self.scene, '--set',
                                'cloth.fabric.areal_density=0.2', '--summary', '-', '--duration=0')
        self.assertEqual(result.returncode, 0, result.stderr)
        summary = json.loads(result.stdout)
        self.assertEqual(summary['particles'], 25)
        self.assertAlmostEqual(summary['mass_kg'], 0.2 * 0.04, places=9)

    def test_scene_by_name(self):
        result = self.run_cloth('hang', '--summary', '-', '--duration', '0')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout)['scene'], 'hang')

    def test_same_run_gives_the_same_hash(self):
        hashes = {json.loads(self.run_cloth(self.scene, '--summary', '-', '--threads',
                                            threads).stdout)['state_hash']
                  for threads in ('1', '1', '2')}
        self.assertEqual(len(hashes), 1)

    def test_bad_scenes(self):
        self.refused('no_such_scene', says=['no_such_scene', 'tear_seam'])
        self.refused('/no/such/scene.yaml', says=['/no/such/scene.yaml'])
        self.refused(self.path('a.yaml', 'cloth: {particels: [9, 9]}'),
                     says=['a.yaml', 'particels', 'particles'])
        self.refused(self.path('b.yaml', 'cloth: {particles: many}'), says=['b.yaml', 'particles'])
        self.refused(self.path('c.yaml', 'cloth: {particles: [9, 9]}\ngravity: [0, 0'), says=['c.yaml'])
        self.refused(self.scene, '--set', 'cloth.fabric.areal_density=-1',
                     says=['quick.yaml', 'cloth.fabric.areal_density'])
        self.refused(self.scene, '--set', 'cloth.particles=[1000000, 9]', says=['cloth.particles'])
        self.refused(self.path('d.yaml', QUICK.replace('name: fall', 'name: fall, '
                                                       'clamps: {middle: {grasp: true}}')),
                     says=['d.yaml', 'middle', 'left'])

    def test_bad_command_lines(self):
        self.refused(says=['SCENE'])
        self.refused(self.scene, '--duraton', '1', says=['--duraton'])
        self.refused(self.scene, '--duration', 'long', says=['--duration'])
        self.refused(self.scene, '--duration', '-1', says=['--duration'])
        self.refused('hang', '--duration', 'nan', says=['--duration', 'expected a number'])
        self.refused('hang', '--bag', self.path('x.bag'), '--bag-rate', 'nan',
                     says=['--bag-rate', 'expected a number'])
        self.refused(self.scene, '--threads', '-1', says=['--threads'])
        self.refused(self.scene, '--set', 'nothing', says=['nothing'])
        self.refused(self.scene, '--summary', '/no/such/folder/x.json', says=['/no/such/folder'])
        self.refused(self.scene, '--bag', '/no/such/folder/x.bag', says=['/no/such/folder'])

    def test_help(self):
        result = self.run_cloth('--help')
        self.assertEqual(result.returncode, 0)
        for option in ('--set', '--duration', '--bag', '--summary', '--threads'):
            self.assertIn(option, result.stdout)

    def test_failed_phase_is_3_and_the_summary_says_how(self):
        scene = self.path('late.yaml', QUICK.replace('on_timeout: continue',
                                                     'until: {pieces: 2}'))
        summary = self.path('late.json')
        result = self.run_cloth(scene, '--summary', summary)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn('fall', result.stderr.splitlines()[-1])
        with open(summary) as file:
            self.assertNotEqual(json.load(file)['status'], 'done')

    def test_diverging_run_is_3_and_the_summary_says_how(self):
        scene = self.path('stiff.yaml', QUICK + """
solver: {method: symplectic_euler, substeps: 1, dt: 0.05}
""")
        result = self.run_cloth(scene, '--summary', '-', '--duration', '10')
        self.assertEqual(result.returncode, 3, result.stderr)
        summary = json.loads(result.stdout)
        self.assertNotEqual(summary['status'], 'done')
        self.assertNotEqual(summary['failure'], '')
        self.assertIn('failed', result.stderr.splitlines()[-1])

    def test_warnings_are_on_one_line_each_and_in_the_summary(self):
        scene = os.path.join(os.path.dirname(BENCH), 'doubtful.yaml')
        result = self.run_cloth(scene, '--summary', '-', '--duration', '0.5')
        self.assertEqual(result.returncode, 0, result.stderr)
        warnings = json.loads(result.stdout)['warnings']
        self.assertEqual(len([w for w in warnings if 'does not keep solver.error' in w]), 1)
        told = [line for line in result.stderr.splitlines() if ': warning: ' in line]
        self.assertEqual([line.split(': warning: ')[1] for line in told], warnings)
        self.assertEqual(result.stderr.count('solver.error'), 1)

    def test_bag(self):
        bag = self.path('run.bag')
        result = self.run_cloth(self.scene, '--bag', bag)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertFalse(os.path.exists(bag + '.active'))
        with rosbag.Bag(bag) as opened:
            topics = opened.get_type_and_topic_info().topics
            self.assertEqual(set(topics), {
                '/cloth/scene', '/cloth/topology', '/cloth/frame', '/cloth/state', '/cloth/tear_events',
                '/cloth/broken_springs', '/cloth/phase', '/cloth/clamps/left/wrench', '/tf',
                '/cloth/scene_markers'})
            messages = [(topic, message, stamp.to_sec())
                        for topic, message, stamp in opened.read_messages()]
        frames = [message for topic, message, _ in messages if topic == '/cloth/frame']
        self.assertAlmostEqual(len(frames), 0.4 * 30 + 2, delta=3)  # 30 Hz, phase changes, the ends
        sizes = {message.revision: len(message.uv) // 2
                 for topic, message, _ in messages if topic == '/cloth/topology'}
        self.assertGreater(len(sizes), 1)  # the notch
        for frame in frames:
            self.assertEqual(len(frame.positions), 3 * sizes[frame.revision])
        phases = [message.data for topic, message, _ in messages if topic == '/cloth/phase']
        self.assertEqual([phase for phase in phases if phase], ['fall', 'notch'])
        states = [(message, stamp) for topic, message, stamp in messages if topic == '/cloth/state']
        for state, stamp in states:
            self.assertAlmostEqual(stamp, state.time, delta=1e-6)
        events = [event for topic, message, _ in messages if topic == '/cloth/tear_events'
                  for event in message.events]
        self.assertEqual(len(events), states[-1][0].broken.total)
        self.assertGreater(min(stamp for _, _, stamp in messages), 0.0)

    def test_bag_has_the_grasp_events(self):
        bag = self.path('grip.bag')
        result = self.run_cloth(self.path('grip.yaml', SLIPS), '--bag', bag)
        self.assertEqual(result.returncode, 0, result.stderr)
        with rosbag.Bag(bag) as opened:
            events = [message for _, message, _ in opened.read_messages(['/cloth/grasp_events'])]
            last = [message for _, message, _ in opened.read_messages(['/cloth/state'])][-1]
        self.assertEqual([event.kind for event in events],
                         [GraspEvent.CLOSED, GraspEvent.SLIPPING, GraspEvent.LOST,
                          GraspEvent.RELEASED])
        self.assertTrue(all(event.clamp == 'hand' for event in events))
        self.assertGreater(events[0].held, 0)
        self.assertEqual(events[2].held, 0)
        self.assertLess(events[0].time, 0.5)
        self.assertAlmostEqual(events[3].time, 1.0, delta=0.03)  # when phase open says so
        self.assertEqual(last.clamps[0].held, 0)

    def test_a_full_disk_while_recording_is_one_line_and_no_bag(self):
        """A limit on the size of files stands for a full disk, met early, late and at the end."""
        bag = self.path('run.bag')
        self.assertEqual(self.run_cloth(self.scene, '--bag', bag).returncode, 0)
        whole = os.path.getsize(bag)
        os.remove(bag)
        for size in (100, whole // 4, whole - 5000, whole - 1):
            result = subprocess.run(
                [CLOTH_RUN, self.scene, '--bag', bag, '--summary', self.path('run.json')],
                capture_output=True, text=True, timeout=120, restore_signals=False,
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)))
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertRegex(result.stderr.splitlines()[-1], 'run.bag[.a-z]*: cannot be written')
            self.assertNotIn('terminate', result.stderr)
            left = ['run.bag.active'] if size > 100 else []  # nothing was recorded in the other
            self.assertEqual(sorted(os.listdir(self.folder.name)), ['quick.yaml', *left])
        self.assertEqual(self.run_cloth(self.scene, '--bag', bag).returncode, 0)  # now it fits
        self.assertEqual(sorted(os.listdir(self.folder.name)), ['quick.yaml', 'run.bag'])

    def test_interrupted_run_ends_cleanly(self):
        bag, summary = self.path('cut.bag'), self.path('cut.json')
        process = subprocess.Popen([CLOTH_RUN, BENCH, '--duration', '100000', '--bag', bag,
                                    '--summary', summary], stderr=subprocess.PIPE, text=True)
        end = time.monotonic() + 30.0
        active = bag + '.active'
        while not (os.path.exists(active) and os.path.getsize(active) > 100000):
            self.assertLess(time.monotonic(), end, 'the bag does not grow')
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 128 + signal.SIGINT, errors)
        with open(summary) as file:
            self.assertGreater(json.load(file)['sim_time_s'], 0.0)
        with rosbag.Bag(bag) as opened:
            self.assertGreater(opened.get_message_count('/cloth/frame'), 1)
        self.assertEqual(sorted(os.listdir(self.folder.name)), ['cut.bag', 'cut.json', 'quick.yaml'])

    def test_signal_ends_a_long_step(self):
        """A step takes a minute; the run ends within a second of the signal, with its outputs."""
        summary, bag, state = self.path('long.json'), self.path('long.bag'), self.path('long.state')
        sets = ['--set', 'solver={method: verlet, dt: 1.0, substeps: 100000}',
                '--set', 'cloth.particles=[128, 128]', '--set', 'cloth.surgery.max_particles=100000']
        process = subprocess.Popen(
            [CLOTH_RUN, BENCH, '--duration', '100', '--summary', summary, '--bag', bag,
             '--save-state', state] + sets, stderr=subprocess.PIPE, text=True)
        self.wait_until_it_steps(process)
        sent = time.monotonic()
        process.send_signal(signal.SIGTERM)
        _, errors = process.communicate(timeout=30)
        self.assertLess(time.monotonic() - sent, 3.0)  # 0.1 s, and a loaded machine
        self.assertEqual(process.returncode, 128 + signal.SIGTERM, errors)
        self.assertRegex(errors, 'interrupted at t = 0 s')
        with open(summary) as file:
            result = json.load(file)
        self.assertEqual((result['status'], result['sim_time_s']), ('interrupted', 0.0))
        with rosbag.Bag(bag) as opened:
            self.assertEqual(opened.get_message_count('/cloth/frame'), 1)
        end = self.run_cloth(BENCH, '--load-state', state, '--duration', '0', '--summary', '-', *sets)
        self.assertEqual(json.loads(end.stdout)['state_hash'], result['state_hash'])

    def wait_until_it_steps(self, process):
        """Waits until the process catches SIGTERM, as it does from the first step on."""
        end = time.monotonic() + 30.0
        while True:
            with open('/proc/%d/status' % process.pid) as status:
                self.assertIsNone(process.poll(), 'the run has ended')
                caught = [line for line in status if line.startswith('SigCgt')][0]
            if int(caught.split()[1], 16) >> (signal.SIGTERM - 1) & 1:
                return
            self.assertLess(time.monotonic(), end, 'the run does not begin')
            time.sleep(0.01)


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'cloth_run_test', ClothRunTest)
