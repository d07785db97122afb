#!/usr/bin/python3
"""Saved states: the run that goes on from one equals the one that was not interrupted."""
import os
import random
import shutil
import struct
import sys

import rospy
import rostest

from cloth_sim import msg, srv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import Listener, wait_until  # noqa: E402
from services import ServiceTest  # noqa: E402

SERVICES = dict(grasp=srv.Grasp, set_phase=srv.StartPhase, pause=srv.Pause, step=srv.Step,
                reset=srv.ResetScene, save_state=srv.SaveState, load_state=srv.LoadState,
                get_state=srv.GetState)


MAGIC = b'cloth_sim state\n'
HEADER = len(MAGIC) + 1 + 4 + 8 + 8  # the byte order, version, length, hash


def forged(state, payload):
    """The saved state `state` with other contents, whose hash is right (src/support/hash.h)."""
    value = 0xcbf29ce484222325
    for at in range(0, len(payload), 8):
        word = int.from_bytes(payload[at:at + 8], 'little')
        value = ((value ^ word) * 0x100000001b3) & 0xffffffffffffffff
        value ^= value >> 32
    return state[:len(MAGIC) + 5] + struct.pack('<QQ', len(payload), value) + payload


class StateTest(ServiceTest):
    SERVICES = SERVICES

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.folder = rospy.get_param('/cloth/state_directory')

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder, ignore_errors=True)

    def setUp(self):
        self.accepted('pause', True)
        self.accepted('reset')

    def refused(self, name, *arguments, says=''):
        before = self.state()
        reply = self.call[name](*arguments)
        self.assertFalse(reply.success, '%s accepted %r' % (name, arguments))
        self.assertIn(says, reply.message)
        self.assertNotEqual(reply.message, '')
        self.assertNotIn('\n', reply.message)
        self.assertEqual(self.state().state_hash, before.state_hash)

    def path(self, name):
        return os.path.join(self.folder, name + '.state')

    def test_goes_on_as_if_nothing_had_happened(self):
        self.accepted('grasp', 'left', True)
        self.accepted('set_phase', 'notch')
        self.accepted('step', 20)
        before = self.state()
        self.assertGreater(before.broken.total, 0)
        saved = self.accepted('save_state', 'in_the_middle')
        self.assertEqual((saved.step, saved.state_hash), (20, before.state_hash))
        self.accepted('step', 30)
        straight = self.state()
        self.accepted('reset')
        self.accepted('step', 7)
        loaded = self.accepted('load_state', 'in_the_middle')
        self.assertEqual((loaded.step, loaded.time, loaded.state_hash),
                         (20, before.time, before.state_hash))
        self.assertEqual(self.state().broken, before.broken)
        self.assertEqual([c.held for c in self.state().clamps], [c.held for c in before.clamps])
        self.accepted('step', 30)
        self.assertEqual(self.state().state_hash, straight.state_hash)
        self.assertNotEqual(straight.state_hash, before.state_hash)
        self.assertIn('in_the_middle.state', os.listdir(self.folder))
        self.assertFalse([name for name in os.listdir(self.folder) if '.tmp' in name])

    def test_places_of_broken_springs_come_along_but_are_not_told_twice(self):
        self.accepted('set_phase', 'notch')
        self.accepted('step', 2)
        total = self.state().broken.total
        self.assertGreater(total, 0)
        with Listener('/cloth/tear_events', msg.TearEvents) as events, \
                Listener('/cloth/broken_springs', msg.BrokenSprings) as broken:
            broken.wait(lambda b: b.counts.total == total)
            self.accepted('save_state', 'broken')
            self.accepted('reset')
            broken.wait(lambda b: b.counts.total == 0)
            wait_until(lambda: events.subscriber.get_num_connections() > 0, 'the node')
            told = sum(len(m.events) for m in events.messages)
            self.accepted('load_state', 'broken')
            wait_until(lambda: broken.messages[-1].counts.total == total, 'the counts')
            self.assertEqual(len(broken.messages[-1].positions), 3 * total)
            self.assertEqual(sum(len(m.events) for m in events.messages), told)

    def test_names_stay_within_the_folder(self):
        for bad in ('', '..', '../x', '/tmp/x', 'a/b', '.hidden', 'a b', 'a' * 101, 'x\n'):
            self.refused('save_state', bad)
            self.refused('load_state', bad)
        self.refused('load_state', 'nothing', says="unknown saved state 'nothing'")

    def test_links_are_not_followed(self):
        self.accepted('save_state', 'target')
        outside = self.folder + '_outside'
        os.rename(self.path('target'), outside)
        try:
            os.symlink(outside, self.path('link'))
            self.refused('load_state', 'link', says='link')
            with open(outside, 'rb') as file:
                before = file.read()
            self.accepted('step', 1)
            self.refused('save_state', 'link', says='link')
            with open(outside, 'rb') as file:
                self.assertEqual(file.read(), before)
            self.assertTrue(os.path.islink(self.path('link')))
        finally:
            os.remove(outside)

    def test_bad_files_are_refused(self):
        self.accepted('save_state', 'good')
        with open(self.path('good'), 'rb') as file:
            good = file.read()
        damaged = bytearray(good)
        damaged[len(good) // 2] ^= 1
        for content, says in ((damaged, 'damaged'), (good[:-1], 'short'), (b'', 'no saved state'),
                              (b'a text\n' * 100, 'no saved state')):
            with open(self.path('bad'), 'wb') as file:
                file.write(content)
            self.refused('load_state', 'bad', says=says)
        os.remove(self.path('bad'))
        os.mkfifo(self.path('pipe'))
        self.refused('load_state', 'pipe', says='is a pipe')
        self.refused('save_state', 'pipe', says='cannot be written')
        os.mkdir(self.path('folder'))
        self.refused('load_state', 'folder', says='is a directory')
        self.refused('save_state', 'folder', says='cannot be written')
        self.assertFalse([name for name in os.listdir(self.folder) if '.tmp' in name])

    def test_wrong_contents_with_the_right_hash_leave_the_node_as_it_is(self):
        """Lengths and indices that are wrong ended the node once (test/fuzz has many more)."""
        self.accepted('grasp', 'left', True)
        self.accepted('step', 10)
        self.accepted('save_state', 'good')
        with open(self.path('good'), 'rb') as file:
            good = file.read()
        payload = good[HEADER:]
        self.assertEqual(forged(good, payload), good)
        choose = random.Random(5)
        refusals = 0
        for _ in range(60):
            at = choose.randrange(len(payload) - 8)
            value = choose.choice((-1, 3, 1 << 20, 1 << 30))
            changed = payload[:at] + struct.pack('<i', value) + payload[at + 4:]
            with open(self.path('bad'), 'wb') as file:
                file.write(forged(good, changed))
            before = self.state().state_hash
            reply = self.call['load_state']('bad')
            self.assertNotIn('\n', reply.message)
            if reply.success:
                self.call['step'](2)  # it may fail, with a word
            else:
                refusals += 1
                self.assertEqual(self.state().state_hash, before)
        self.assertGreater(refusals, 20)
        self.accepted('load_state', 'good')
        self.accepted('step', 2)

    def test_a_running_simulation_is_saved_between_two_steps(self):
        self.accepted('pause', False)
        saved = [self.accepted('save_state', 'running') for _ in range(5)]
        self.accepted('pause', True)
        self.assertGreater(saved[-1].step, saved[0].step)
        loaded = self.accepted('load_state', 'running')
        self.assertEqual((loaded.step, loaded.state_hash), (saved[-1].step, saved[-1].state_hash))


if __name__ == '__main__':
    rospy.init_node('state_test')
    rostest.rosrun('cloth_sim', 'state', StateTest)
