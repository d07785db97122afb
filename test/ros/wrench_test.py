#!/usr/bin/python3
"""A clamp that holds a hanging cloth of 0.2 kg bears 1.96 N; with less grip force the cloth slips."""
import os
import sys
import unittest

import rospy
import rostest
from geometry_msgs.msg import WrenchStamped

from cloth_sim import msg, srv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import Listener, connected, wait_until  # noqa: E402

WEIGHT = 0.2 * 9.81  # [N]


class WrenchTest(unittest.TestCase):
    def setUp(self):
        rospy.wait_for_service('/cloth/reset', 30.0)
        self.get_state = rospy.ServiceProxy('/cloth/get_state', srv.GetState)
        rospy.ServiceProxy('/cloth/reset', srv.ResetScene)()

    def state(self):
        return self.get_state().state

    def at_rest(self):
        wait_until(lambda: self.state().time > 4.0 and self.state().mean_speed < 2e-3, 'rest')

    def test_a_hanging_cloth_pulls_with_its_weight(self):
        self.at_rest()
        self.assertAlmostEqual(self.state().mass, 0.2, places=9)
        with Listener('/cloth/clamps/hand/wrench', WrenchStamped) as wrenches:
            wait_until(lambda: len(wrenches.messages) >= 50, '50 wrenches')
            force = [0.0, 0.0, 0.0]
            for message in wrenches.messages[-50:]:
                self.assertEqual(message.header.frame_id, 'cloth/clamp_hand')
                for axis, name in enumerate('xyz'):
                    force[axis] += getattr(message.wrench.force, name) / 50.0
        # The clamp's y points up.
        self.assertAlmostEqual(force[1], -WEIGHT, delta=0.005 * WEIGHT)
        self.assertAlmostEqual(force[0], 0.0, delta=0.005 * WEIGHT)
        self.assertAlmostEqual(force[2], 0.0, delta=0.005 * WEIGHT)

    def test_it_slips_out_of_a_weaker_grip(self):
        self.at_rest()
        with Listener('/cloth/grasp_events', msg.GraspEvent) as events, \
                Listener('/cloth/clamps/hand/wrench', WrenchStamped) as wrenches:
            wait_until(lambda: events.subscriber.get_num_connections() > 0, 'the node')
            wrenches.wait()
            held = self.state().clamps[0].held
            self.assertGreater(held, 0)
            gripper = connected('/cloth/clamps/hand/gripper_command', msg.GripperCommand)
            gripper.publish(position=0.0, max_effort=1.0)
            slipping = events.wait(lambda e: e.kind == msg.GraspEvent.SLIPPING)
            lost = events.wait(lambda e: e.kind == msg.GraspEvent.LOST)
            self.assertAlmostEqual(slipping.force.z, -1.0, delta=1e-3)
            self.assertEqual(slipping.clamp, 'hand')
            self.assertEqual(lost.held, 0)
            self.assertGreater(lost.slipped, 0.02)
            wait_until(lambda: self.state().clamps[0].held == 0, 'an empty clamp')
            self.assertAlmostEqual(self.state().clamps[0].grip_force, 1.0)
            # Nothing is left to pull.
            empty = wrenches.wait(lambda m: m.header.stamp > lost.header.stamp)
            self.assertEqual(empty.wrench.force.y, 0.0)


if __name__ == '__main__':
    rospy.init_node('wrench_test')
    rostest.rosrun('cloth_sim', 'wrench', WrenchTest)
