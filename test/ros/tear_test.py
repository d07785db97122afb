#!/usr/bin/python3
"""The whole phase script at 48 x 48: dropped, grasped, lifted, notched, torn into two pieces."""
import os
import sys
import unittest

import rospy
import rostest
from cloth_sim import msg, srv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import Listener, wait_until  # noqa: E402

PHASES = ['drop', 'settle', 'attach', 'close', 'lift', 'lower_and_notch', 'pull_and_tear', 'stop']


def components(triangles):
    """Pieces of a triangle list that share no vertex."""
    parent = list(range(max(triangles) + 1))

    def root(v):
        while parent[v] != v:
            parent[v] = parent[parent[v]]
            v = parent[v]
        return v
    for i in range(0, len(triangles), 3):
        a = root(triangles[i])
        for v in triangles[i + 1:i + 3]:
            parent[root(v)] = a
    return len({root(v) for v in triangles})


class TearTest(unittest.TestCase):
    def test_script_ends_with_two_pieces(self):
        rospy.wait_for_service('/cloth/get_state', 30.0)
        get_state = rospy.ServiceProxy('/cloth/get_state', srv.GetState, persistent=True)
        pause = rospy.ServiceProxy('/cloth/pause', srv.Pause)
        start = get_state().state
        with Listener('/cloth/topology', msg.ClothTopology) as topologies, \
                Listener('/cloth/frame', msg.ClothFrame) as frames, \
                Listener('/cloth/tear_events', msg.TearEvents) as events:
            wait_until(lambda: frames.subscriber.get_num_connections() > 0 and
                       events.subscriber.get_num_connections() > 0, 'connections')
            self.assertTrue(pause(False).success)

            def over(state):
                return state.failed or state.script in (msg.ClothState.SCRIPT_DONE,
                                                        msg.ClothState.SCRIPT_FAILED)
            wait_until(lambda: over(get_state().state), 'the end of the script', deadline=180.0)
            end = get_state()
            state = end.state
            self.assertEqual(state.failure, '')
            self.assertEqual(state.script, msg.ClothState.SCRIPT_DONE)
            self.assertEqual([record.name for record in end.history], PHASES)
            self.assertFalse(any(record.timed_out for record in end.history
                                 if record.name not in ('settle', 'stop')))
            self.assertEqual(state.pieces, 2)
            self.assertGreater(state.broken_torn, 0)
            self.assertGreater(state.broken_cut, 0)
            self.assertEqual(state.broken.total, state.broken_torn + state.broken_cut)
            self.assertAlmostEqual(state.mass / start.mass, 1.0, delta=1e-9)
            self.assertAlmostEqual(state.rest_area / start.rest_area, 1.0, delta=1e-9)

            frame = frames.wait(lambda f: f.revision == state.revision)
            topology = topologies.wait(lambda t: t.revision == state.revision)
            self.assertEqual(components(topology.triangles), 2)
            self.assertEqual(len(frame.positions) // 3, max(topology.triangles) + 1)
            wait_until(lambda: sum(len(m.events) for m in events.messages) == state.broken.total,
                       'all events')
            for event in (event for m in events.messages for event in m.events):
                if event.kind == msg.TearEvent.STRUCTURAL:  # on the seam: between columns 23 and 24
                    self.assertLess(abs(event.material[0] - 0.5), 1.01 / 47)


if __name__ == '__main__':
    rospy.init_node('tear_test')
    rostest.rosrun('cloth_sim', 'tear', TearTest)
