#!/usr/bin/python3
"""What goes wrong around the node: clients that flood it, subscribers that never read, signals."""
import os
import signal
import subprocess
import sys
import unittest
from concurrent.futures import ThreadPoolExecutor
from xmlrpc.client import ServerProxy

import rosgraph
import rospy
import rostest

from cloth_sim import srv
from cloth_sim.msg import ClampStatus

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import wait_until  # noqa: E402

MEGABYTE = 1 << 20
# The address sanitizer keeps what is freed, up to 256 MiB and as much again around it.
ALLOWED_GROWTH = (600 if 'CLOTH_SIM_FEWER_CASES' in os.environ else 30) * MEGABYTE
READER = '''
import rospy
from cloth_sim.msg import ClothFrame
rospy.init_node('reader', anonymous=True)
rospy.Subscriber('/cloth/frame', ClothFrame, lambda message: print('frame', flush=True))
rospy.spin()
'''


def program(name):
    """Path of a program of this package."""
    return subprocess.check_output(['catkin_find', '--first-only', '--libexec', 'cloth_sim', name],
                                   text=True).strip()


def resident(pid):
    """Memory that a process holds [bytes]."""
    with open('/proc/%d/statm' % pid) as file:
        return int(file.read().split()[1]) * os.sysconf('SC_PAGE_SIZE')


class FaultsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.wait_for_service('/cloth/get_state', 30.0)
        cls.get_state = rospy.ServiceProxy('/cloth/get_state', srv.GetState, persistent=True)
        address = rosgraph.Master('/faults_test').lookupNode('/cloth')
        cls.pid = ServerProxy(address).getPid('/faults_test')[2]

    def steps_on(self, steps=30):
        start = self.get_state().state.step
        wait_until(lambda: self.get_state().state.step > start + steps, '%d steps' % steps)

    def test_a_flood_of_commands_at_10_khz_is_survived(self):
        self.steps_on()
        before = resident(self.pid)
        flood = subprocess.Popen([program('flooder'), '3.0'], stdout=subprocess.PIPE, text=True)
        try:
            while flood.poll() is None:  # it steps and answers meanwhile
                self.steps_on(5)
            sent, rate = flood.communicate()[0].split()
        finally:
            flood.kill()
            flood.wait()
        self.assertEqual(flood.returncode, 0)
        rospy.loginfo('flood: %s commands, %s a second', sent, rate)
        self.assertGreater(float(rate), 9000.0)
        self.steps_on()
        self.assertFalse(self.get_state().state.failed)
        self.assertLess(resident(self.pid) - before, ALLOWED_GROWTH)
        # Commands are taken as before, and the last ones count.
        grasp = rospy.ServiceProxy('/cloth/grasp', srv.Grasp)
        for closed in (True, False):
            self.assertTrue(grasp('right', closed).success)
            wait_until(lambda: (self.clamp('right').state != ClampStatus.OPEN) == closed,
                       'the clamp')

    def clamp(self, name):
        return next(clamp for clamp in self.get_state().state.clamps if clamp.name == name)

    def test_two_clients_that_pause_and_step_at_once(self):
        pause = rospy.ServiceProxy('/cloth/pause', srv.Pause)
        self.assertTrue(pause(True).success)
        start = rospy.ServiceProxy('/cloth/step', srv.Step)(1).step
        made = []  # (step after it, steps) of every request

        def steps_by(count, requests):
            step = rospy.ServiceProxy('/cloth/step', srv.Step, persistent=True)
            for _ in range(requests):
                reply = step(count)
                made.append((reply.step, count if reply.success else None))
                pause(True)
        self.together(lambda: steps_by(3, 20), lambda: steps_by(2, 25))
        # Each request got all its steps, and none was made for two of them.
        self.assertEqual(len(made), 45)
        for (before, _), (after, count) in zip([(start, 0)] + sorted(made), sorted(made)):
            self.assertEqual(after, before + count)
        self.assertEqual(self.get_state().state.step, start + 3 * 20 + 2 * 25)

        def pauses():
            own = rospy.ServiceProxy('/cloth/pause', srv.Pause, persistent=True)
            for k in range(50):
                self.assertTrue(own(k % 2 == 1).success)
        del made[:]
        self.together(pauses, lambda: steps_by(2, 20))
        self.assertNotIn(None, [count for _, count in made])
        # Paused, in the end: the next steps are the ones that are asked for.
        step = rospy.ServiceProxy('/cloth/step', srv.Step)
        self.assertTrue(self.get_state().state.paused)
        self.assertEqual(step(1).step + 4, step(4).step)
        self.assertTrue(pause(False).success)
        self.steps_on()

    def together(self, *actions):
        """Has actions done at the same time; fails if one does."""
        with ThreadPoolExecutor(len(actions)) as pool:
            for running in [pool.submit(action) for action in actions]:
                running.result(timeout=30.0)

    def test_a_subscriber_that_never_reads_costs_nothing(self):
        reader = subprocess.Popen([sys.executable, '-c', READER], stdout=subprocess.PIPE)
        try:
            self.assertEqual(reader.stdout.readline(), b'frame\n')  # it gets them ...
            reader.send_signal(signal.SIGSTOP)                      # ... and reads no more
            self.steps_on(60)
            before = resident(self.pid)
            self.steps_on(240)
            self.assertLess(resident(self.pid) - before, ALLOWED_GROWTH)
        finally:
            reader.kill()
            reader.wait()
        self.steps_on()

    def test_signals_end_it_cleanly_in_mid_step(self):
        for sent in (signal.SIGINT, signal.SIGTERM):
            name = 'second_%d' % sent
            node = subprocess.Popen(['rosrun', 'cloth_sim', 'cloth_node', '__name:=' + name,
                                     '_scene:=tear_seam', '_real_time_factor:=0.0'],
                                    start_new_session=True)
            try:
                rospy.wait_for_service('/%s/get_state' % name, 30.0)
                state = rospy.ServiceProxy('/%s/get_state' % name, srv.GetState)
                wait_until(lambda: state().state.step > 5, 'steps')
                os.killpg(node.pid, sent)
                self.assertIn(node.wait(20.0), (0, 128 + sent, -sent))
            finally:
                if node.poll() is None:
                    os.killpg(node.pid, signal.SIGKILL)


if __name__ == '__main__':
    rospy.init_node('faults_test')
    rostest.rosrun('cloth_sim', 'faults', FaultsTest)
