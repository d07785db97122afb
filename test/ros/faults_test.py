#!/usr/bin/python3
"""What goes wrong around the node: clients that flood it, subscribers that never read, signals."""
import os
import signal
import subprocess
import sys
import time
import unittest
from xmlrpc.client import ServerProxy

import rosgraph
import rospy
import rostest
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import Bool

from cloth_sim import srv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import connected, wait_until  # noqa: E402

MEGABYTE = 1 << 20
READER = '''
import rospy
from cloth_sim.msg import ClothFrame
rospy.init_node('reader', anonymous=True)
rospy.Subscriber('/cloth/frame', ClothFrame, lambda message: print('frame', flush=True))
rospy.spin()
'''


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

    def test_a_flood_of_commands_is_survived(self):
        self.steps_on()
        before = resident(self.pid)
        target = connected('/cloth/clamps/right/command', PoseStamped)
        grasp = connected('/cloth/clamps/right/grasp', Bool)
        message = PoseStamped()
        message.header.frame_id = 'world'
        message.pose.orientation.w = 1.0
        sent = 0
        start = time.monotonic()
        while time.monotonic() < start + 3.0:
            message.pose.position.z = 0.5 + 1e-6 * sent
            target.publish(message)
            grasp.publish(bool(sent % 2))
            sent += 2
        self.assertGreater(sent, 3000, 'messages that were no flood')
        rospy.loginfo('flood: %d messages a second', sent / 3.0)
        self.steps_on()
        self.assertFalse(self.get_state().state.failed)
        self.assertLess(resident(self.pid) - before, 30 * MEGABYTE)

    def test_a_subscriber_that_never_reads_costs_nothing(self):
        reader = subprocess.Popen([sys.executable, '-c', READER], stdout=subprocess.PIPE)
        try:
            self.assertEqual(reader.stdout.readline(), b'frame\n')  # it gets them ...
            reader.send_signal(signal.SIGSTOP)                      # ... and reads no more
            self.steps_on(60)
            before = resident(self.pid)
            self.steps_on(240)
            self.assertLess(resident(self.pid) - before, 30 * MEGABYTE)
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
