#!/usr/bin/python3
"""A step that takes a minute holds up neither services that need no step, nor the end of the node."""
import os
import signal
import sys
import time
from xmlrpc.client import ServerProxy

import rospy
import rostest

from cloth_sim import srv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import wait_until  # noqa: E402
from services import ServiceTest  # noqa: E402

ANSWER = 2.0  # [s]; 0.1 s on an idle machine
END = 10.0    # [s]; 0.5 s on an idle machine


class LongStepTest(ServiceTest):
    SERVICES = dict(get_state=srv.GetState, pause=srv.Pause)

    def timed(self, call, *arguments):
        start = time.monotonic()
        reply = call(*arguments)
        self.assertTrue(reply.success, reply.message)
        return time.monotonic() - start

    def test_a_long_step_holds_up_nobody(self):
        self.assertLess(self.timed(self.call['get_state']), ANSWER)
        self.assertLess(self.timed(self.call['pause'], True), ANSWER)
        pid = self.pid_of_node()
        os.kill(pid, signal.SIGTERM)
        wait_until(lambda: not self.is_running(pid), 'the end of the node', END)

    @staticmethod
    def pid_of_node():
        return ServerProxy(rospy.get_master().lookupNode('/cloth')[2]).getPid('/test')[2]

    @staticmethod
    def is_running(pid):
        """Whether a process exists that has not become a zombie."""
        try:
            with open('/proc/%d/stat' % pid) as stat:
                return stat.read().rsplit(')', 1)[1].split()[0] != 'Z'
        except FileNotFoundError:
            return False


if __name__ == '__main__':
    rospy.init_node('long_step_test')
    rostest.rosrun('cloth_sim', 'long_step_test', LongStepTest)
