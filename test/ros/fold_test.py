#!/usr/bin/python3
"""The arm of fold.launch folds the towel in half: edge on edge, without a layer through another."""
import os
import sys
import unittest

import numpy as np
import rospy
import rostest
from geometry_msgs.msg import WrenchStamped

from cloth_sim import msg

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from intersections import crossings  # noqa: E402
from polling import Listener, wait_until  # noqa: E402
from services import state  # noqa: E402

COLUMNS, ROWS = 55, 37  # particles of the towel
EDGE = 0.010  # distance of the edges of a fold that counts as one [m]
# 0.25 kg/m^2 x 0.36 m x 0.24 m x 9.81 m/s^2: the fingers carry half of it at most, and accelerate it.
WEIGHT = 0.21  # of the towel [N]
MOST = 120.0  # wall time of the fold, on a busy machine [s]


class FoldTest(unittest.TestCase):
    def towel(self):
        """The places of the particles, by row and column, and the faces."""
        with Listener('/cloth/topology', msg.ClothTopology) as topologies, \
                Listener('/cloth/frame', msg.ClothFrame) as frames:
            faces = np.array(topologies.wait().triangles).reshape(-1, 3)
            places = np.array(frames.wait().positions, dtype=float).reshape(-1, 3)
        return places, faces

    def folded(self):
        """Waits for the grasp, the fold, and rest. Gives the forces at the fingers."""
        with Listener('/cloth/clamps/hand/wrench', WrenchStamped) as wrenches:
            wait_until(lambda: state().clamps[0].held >= ROWS, 'a grasp', MOST)
            places, faces = self.towel()
            self.assertEqual(crossings(places, faces), 0)
            wait_until(lambda: state().clamps[0].held == 0, 'that the gripper lets go', MOST)
            released = state().time
            wait_until(lambda: state().time > released + 2.0, 'that it falls', MOST)
            wait_until(lambda: state().mean_speed < 1e-3, 'rest', MOST)
        forces = [message.wrench.force for message in wrenches.messages]
        return [np.linalg.norm([force.x, force.y, force.z]) for force in forces]

    def test_the_towel_is_folded_in_half(self):
        forces = self.folded()
        self.assertGreater(max(forces), 0.25 * WEIGHT, 'the fingers lift the towel')
        self.assertLess(max(forces), WEIGHT)
        self.assertEqual(state().failure, '')
        self.assertTrue(state().contact.on)

        places, faces = self.towel()
        self.assertEqual(crossings(places, faces), 0)
        rows = places.reshape(ROWS, COLUMNS, 3)
        apart = rows - rows[:, ::-1]  # of the particles that the fold lays on each other
        self.assertLess(np.linalg.norm(apart[:, 0, :2], axis=1).max(), EDGE, 'the short edges')
        self.assertLess(np.abs(apart[[0, -1], :, 1]).max(), EDGE, 'the long edges')
        self.assertLess(places[:, 2].max(), 0.03, 'it lies flat but for the fold')


if __name__ == '__main__':
    rospy.init_node('fold_test')
    rostest.rosrun('cloth_sim', 'fold', FoldTest)
