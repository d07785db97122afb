#!/usr/bin/python3
"""Warnings about the results of a run: each once in the log, in the diagnostics and in ~state."""
import os
import sys
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rosgraph_msgs.msg import Log

from cloth_sim import srv
from cloth_sim.msg import ClothState

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import Listener, node_log  # noqa: E402

# Of the error control, and of the watch over results.
WORDS = ['does not keep solver.error', 'softer than its fabric']


class WarningsTest(unittest.TestCase):
    def test_each_is_logged_once_and_diagnosed(self):
        with node_log() as log, Listener('/diagnostics', DiagnosticArray) as diagnoses:
            rospy.wait_for_service('/cloth/pause', 30.0)
            self.assertTrue(rospy.ServiceProxy('/cloth/pause', srv.Pause)(False).success)

            def diagnosed(message):
                return any(status.level == DiagnosticStatus.WARN and
                           all(words in status.message for words in WORDS)
                           for status in message.status)
            for _ in range(3):
                diagnoses.messages.clear()
                diagnoses.wait(diagnosed)
            for words in WORDS:
                told = [m for m in log.messages if words in m.msg and m.name == '/cloth']
                self.assertEqual([m.level for m in told], [Log.WARN], words)

    def test_the_state_has_them(self):
        rospy.wait_for_service('/cloth/pause', 30.0)
        self.assertTrue(rospy.ServiceProxy('/cloth/pause', srv.Pause)(False).success)
        with Listener('/cloth/state', ClothState) as states:
            last = states.wait(lambda state: len(state.warnings) >= len(WORDS))
        for words in WORDS:
            self.assertEqual(sum(words in text for text in last.warnings), 1, last.warnings)


if __name__ == '__main__':
    rospy.init_node('warnings_test')
    rostest.rosrun('cloth_sim', 'warnings', WarningsTest)
