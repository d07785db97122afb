#!/usr/bin/python3
"""A step that takes a minute, and requests that wait for it, hold up neither services that need no
step, nor the end of the node."""
import os
import signal
import sys
import threading
import time
from xmlrpc.client import ServerProxy

import rospy
import rostest

from cloth_sim import srv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import wait_until  # noqa: E402
from services import ServiceTest  # noqa: E402

ANSWER = 2.0  # [s]; docs/reliability.md has what it takes on an idle machine
END = 10.0    # [s]; likewise
WAITING = 8   # requests, of which each takes a thread of the node


class LongStepTest(ServiceTest):
    SERVICES = dict(get_state=srv.GetState, pause=srv.Pause)

    def timed(self, call, *arguments):
        start = time.monotonic()
        reply = call(*arguments)
        self.assertTrue(reply.success, reply.message)
        return time.monotonic() - start

    def longest(self, what, call, *arguments):
        times = sorted(self.timed(call, *arguments) for _ in range(20))
        print('%s: median %.3f s, longest %.3f s' % (what, times[10], times[-1]))
        return times[-1]

    @staticmethod
    def wait_for_a_step():
        try:
            rospy.ServiceProxy('/cloth/step', srv.Step)(1000)
        except rospy.ServiceException:
            pass  # the node has ended

    def test_a_long_step_and_those_who_wait_for_it_hold_up_nobody(self):
        waiting = [threading.Thread(target=self.wait_for_a_step) for _ in range(WAITING)]
        for thread in waiting:
            thread.start()
        wait_until(lambda: self.call['get_state']().state.paused, 'requests of steps')
        self.assertLess(self.longest('get_state', self.call['get_state']), ANSWER)
        self.assertLess(self.longest('pause', self.call['pause'], True), ANSWER)
        pid = self.pid_of_node()
        start = time.monotonic()
        os.kill(pid, signal.SIGTERM)
        wait_until(lambda: not self.is_running(pid), 'the end of the node', END)
        print('SIGTERM: %.3f s' % (time.monotonic() - start))
        for thread in waiting:
            thread.join(END)
            self.assertFalse(thread.is_alive(), 'a request of steps was never answered')

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
