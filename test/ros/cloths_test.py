#!/usr/bin/python3
"""Several cloths in one scene, as the node tells of them: topology, markers, cuts, saved states."""
import os
import shutil
import sys

import rospy
import rostest
from geometry_msgs.msg import Point, Vector3
from visualization_msgs.msg import Marker, MarkerArray

from cloth_sim import msg, srv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import Listener, wait_until  # noqa: E402
from services import ServiceTest  # noqa: E402

SCARF, BANNER = 61 * 61, 33 * 49


class ClothsTest(ServiceTest):
    SERVICES = dict(cut=srv.Cut, pause=srv.Pause, step=srv.Step, reset=srv.ResetScene,
                    save_state=srv.SaveState, load_state=srv.LoadState, get_state=srv.GetState)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(rospy.get_param('/cloth/state_directory'), ignore_errors=True)

    def setUp(self):
        self.accepted('pause', True)
        self.accepted('reset')

    def cut_banner(self):
        stroke = msg.CutStroke()
        stroke.header.frame_id = 'world'
        stroke.points = [Point(0.1, 0.0, 0.7), Point(0.7, 0.0, 0.72)]
        stroke.direction = Vector3(0.0, 1.0, 0.0)
        stroke.reach = 0.1
        return self.accepted('cut', stroke)

    def test_topology_says_whose_particles_are_whose(self):
        with Listener('/cloth/topology', msg.ClothTopology) as topologies:
            topology = topologies.wait()
        scarf, banner = topology.cloths
        self.assertEqual((scarf.name, scarf.first_particle, scarf.particles), ('scarf', 0, SCARF))
        self.assertEqual((banner.name, banner.first_particle, banner.particles),
                         ('banner', SCARF, BANNER))
        self.assertEqual((scarf.material_offset, banner.material_offset), (0.0, 2.0))
        u = topology.uv[0::2]
        self.assertLess(max(u[:SCARF]), 0.6 + 1e-6)
        self.assertAlmostEqual(min(u[SCARF:]), 2.0)

    def test_both_are_shown(self):
        with Listener('/cloth/markers', MarkerArray) as markers:
            array = markers.wait(lambda m: any(k.ns == 'cloth' and k.points for k in m.markers))
        [cloth] = [m for m in array.markers if m.ns == 'cloth' and m.type == Marker.TRIANGLE_LIST]
        self.assertLess(min(p.x for p in cloth.points), -0.6)
        self.assertGreater(max(p.x for p in cloth.points), 0.55)

    def test_the_second_is_cut_saved_and_goes_on(self):
        self.accepted('step', 3)
        self.assertEqual(self.state().pieces, 2)
        with Listener('/cloth/tear_events', msg.TearEvents) as events:
            wait_until(lambda: events.subscriber.get_num_connections() > 0, 'the node')
            self.assertIn('3 pieces', self.cut_banner().message)
            told = events.wait(lambda m: m.events)
        self.assertTrue(all(event.material[0] > 1.9 for event in told.events))
        self.accepted('save_state', 'cut')
        self.accepted('step', 10)
        straight = self.state()
        self.accepted('reset')
        self.assertEqual(self.state().pieces, 2)
        self.accepted('load_state', 'cut')
        self.assertEqual(self.state().pieces, 3)
        self.accepted('step', 10)
        self.assertEqual(self.state().state_hash, straight.state_hash)


if __name__ == '__main__':
    rospy.init_node('cloths_test')
    rostest.rosrun('cloth_sim', 'cloths', ClothsTest)
