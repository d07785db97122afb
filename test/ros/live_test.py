#!/usr/bin/python3
"""What is turned and moved by hand while a node runs: dynamic parameters, handles, drags."""
import os
import subprocess
import sys
import unittest

import dynamic_reconfigure.client
import rospy
import rostest
from cloth_sim import msg, srv
from geometry_msgs.msg import Point, Vector3
from visualization_msgs.msg import (InteractiveMarkerFeedback, InteractiveMarkerInit, MarkerArray)

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import Listener, connected, node_log, wait_until  # noqa: E402
from services import call, state  # noqa: E402

SCENE = {'gravity': 9.81, 'wind_x': 0.0, 'wind_y': 0.0, 'wind_z': 0.0, 'tearing': True,
         'tear_strain': 2.0, 'stiffness': 1.0, 'quasi_static': False}  # of bench.yaml

ROUND_OFF = 1e-20  # of a kinetic energy: (1e-9 m/s)^2 times the 17 g of the cloth, and less [J]


def clamp(name):
    return next(c for c in state().clamps if c.name == name)


class ParametersTest(unittest.TestCase):
    def setUp(self):
        call('reset', srv.ResetScene)
        self.client = dynamic_reconfigure.client.Client('/cloth', timeout=30.0)
        self.shows(SCENE)

    def tearDown(self):
        self.client.close()

    def shows(self, wanted):
        wait_until(lambda: self.client.get_configuration() is not None and
                   all(abs(self.client.get_configuration()[key] - value) < 1e-6
                       for key, value in wanted.items()), 'parameters ' + str(wanted))

    def kinetic_energy(self, **parameters):
        """After ten steps from the start with these parameters."""
        call('reset', srv.ResetScene)
        self.shows(SCENE)
        if parameters:
            self.client.update_configuration(parameters)
        call('step', srv.Step, 10)
        return state().kinetic_energy

    def test_gravity(self):
        usual = self.kinetic_energy()
        self.assertGreater(usual, 1e-4)
        self.assertLess(self.kinetic_energy(gravity=0.0), ROUND_OFF)  # nothing else moves it
        self.assertGreater(self.kinetic_energy(gravity=20.0), 2.0 * usual)

    def test_wind(self):
        self.assertLess(self.kinetic_energy(gravity=0.0, wind_z=0.0), ROUND_OFF)
        self.assertGreater(self.kinetic_energy(gravity=0.0, wind_z=5.0), 1e-4)

    def test_stiffness_and_tear_strain(self):
        """The cloth hangs at its pins: twenty times softer, it stretches more, and tears sooner."""
        def after_a_second(**parameters):
            call('reset', srv.ResetScene)
            self.shows(SCENE)
            self.client.update_configuration(dict(parameters, gravity=30.0))
            call('step', srv.Step, 60)
            return state()
        usual = after_a_second()
        soft = after_a_second(stiffness=0.05)
        self.assertGreater(soft.max_strain, 1.5 * usual.max_strain)
        self.assertEqual(soft.broken.total, 0)
        limit = 0.5 * soft.max_strain
        self.assertGreater(after_a_second(stiffness=0.05, tear_strain=limit).broken_torn, 0)
        self.assertEqual(after_a_second(stiffness=0.05, tear_strain=limit,
                                        tearing=False).broken_torn, 0)

    def test_reset_shows_in_the_parameters(self):
        self.client.update_configuration({'gravity': 1.0, 'stiffness': 2.0, 'wind_x': 3.0})
        self.shows({'gravity': 1.0, 'stiffness': 2.0, 'wind_x': 3.0})
        call('step', srv.Step, 1)
        call('reset', srv.ResetScene)
        self.shows(SCENE)

    def test_out_of_range_is_brought_into_it(self):
        self.client.update_configuration({'gravity': -5.0, 'stiffness': 1e9})
        self.shows({'gravity': 0.0, 'stiffness': 20.0})

    def test_command_line(self):
        subprocess.run(['rosrun', 'dynamic_reconfigure', 'dynparam', 'set', '/cloth', 'gravity',
                        '2.5'], check=True, timeout=60)
        self.shows({'gravity': 2.5})


class DragTest(unittest.TestCase):
    def setUp(self):
        call('reset', srv.ResetScene)

    def drag(self, x, y, held=True, **other):
        """A ray that comes down on (x, y); the cloth lies at z = 0.5, 0.4 m wide, on its pins."""
        ray = msg.DragRay(held=held, origin=Point(x, y, 1.0), direction=Vector3(0.0, 0.0, -2.0))
        ray.header.frame_id = 'world'
        for key, value in other.items():
            setattr(ray, key, value)
        return ray

    def corner(self, frames, step):
        """x of the first particle, at (-0.2, -0.2) at the start, after some steps."""
        return frames.wait(lambda f: f.step == step).positions[0]

    def test_pull_and_let_go(self):
        publisher = connected('/cloth/drag', msg.DragRay)
        with Listener('/cloth/frame', msg.ClothFrame) as frames:
            publisher.publish(self.drag(-0.2, -0.2))
            publisher.publish(self.drag(-0.3, -0.2))
            wait_until(lambda: self.stepped() and self.corner(frames, state().step) < -0.29,
                       'the corner to follow')
            publisher.publish(self.drag(0.0, 0.0, held=False))
            wait_until(lambda: self.stepped() and self.corner(frames, state().step) > -0.25,
                       'the corner to go back')

    def stepped(self):
        return call('step', srv.Step, 2)

    def test_a_client_that_vanishes_lets_go(self):
        publisher = connected('/cloth/drag', msg.DragRay)
        with Listener('/cloth/frame', msg.ClothFrame) as frames:
            publisher.publish(self.drag(-0.2, -0.2))
            publisher.publish(self.drag(-0.3, -0.2))
            wait_until(lambda: self.stepped() and self.corner(frames, state().step) < -0.29,
                       'the corner to follow')
            call('step', srv.Step, 120)  # 2 s, twice the patience
            self.assertGreater(self.corner(frames, state().step), -0.25)

    def test_bad_rays_change_nothing(self):
        publisher = connected('/cloth/drag', msg.DragRay)
        with node_log() as log, Listener('/cloth/frame', msg.ClothFrame) as frames:
            for bad in (self.drag(float('nan'), 0.0), self.drag(2.0, 2.0),
                        self.drag(0.0, 0.0, direction=Vector3())):
                log.messages.clear()

                def refused():
                    publisher.publish(bad)
                    return any('drag: refused' in entry.msg for entry in log.messages)
                wait_until(refused, 'a warning')
            call('step', srv.Step, 1)
            self.assertAlmostEqual(self.corner(frames, 1), -0.2, places=4)


class HandlesTest(unittest.TestCase):
    def setUp(self):
        call('reset', srv.ResetScene)
        self.publisher = connected('/cloth/handles/feedback', InteractiveMarkerFeedback)

    def feedback(self, marker, kind, position=(0.0, 0.0, 0.0), entry=0):
        message = InteractiveMarkerFeedback(marker_name=marker, client_id='test', event_type=kind,
                                            menu_entry_id=entry)
        message.header.frame_id = 'world'
        message.pose.position = Point(*position)
        message.pose.orientation.w = 1.0
        self.publisher.publish(message)

    def test_there_is_one_for_each_clamp_and_obstacle(self):
        with Listener('/cloth/handles/update_full', InteractiveMarkerInit) as inits:
            markers = inits.wait().markers
        self.assertEqual({marker.name for marker in markers},
                         {'clamp/left', 'clamp/right', 'obstacle/table', 'obstacle/sphere'})
        menus = {marker.name: [entry.title for entry in marker.menu_entries] for marker in markers}
        self.assertEqual(menus['clamp/left'], ['Grasp', 'Release'])
        self.assertEqual(menus['obstacle/sphere'], [])

    def test_handles_come_and_go_with_clamps(self):
        def handled():
            with Listener('/cloth/handles/update_full', InteractiveMarkerInit) as inits:
                return {marker.name for marker in inits.wait().markers}
        request = srv.AddClampRequest(name='extra')
        request.pose.header.frame_id = 'world'
        request.pose.pose.position = Point(0.0, 0.0, 2.0)
        request.pose.pose.orientation.w = 1.0
        reply = rospy.ServiceProxy('/cloth/add_clamp', srv.AddClamp)(request)
        self.assertTrue(reply.success, reply.message)
        wait_until(lambda: 'clamp/extra' in handled(), 'its handle')
        self.assertIn('clamp/left', handled())
        call('remove_clamp', srv.RemoveClamp, 'extra')
        wait_until(lambda: 'clamp/extra' not in handled(), 'no handle')
        self.assertIn('clamp/left', handled())

    def test_clamp_follows_its_handle(self):
        self.feedback('clamp/right', InteractiveMarkerFeedback.POSE_UPDATE, (0.25, 0.1, 0.7))

        def arrived():
            call('step', srv.Step, 10)
            return abs(clamp('right').pose.position.x - 0.25) < 1e-4
        wait_until(arrived, 'the clamp')

    def test_menu_grasps_and_releases(self):
        self.feedback('clamp/left', InteractiveMarkerFeedback.MENU_SELECT, entry=1)
        wait_until(lambda: clamp('left').state == msg.ClampStatus.CLOSING, 'closing')
        self.feedback('clamp/left', InteractiveMarkerFeedback.MENU_SELECT, entry=2)
        wait_until(lambda: clamp('left').state == msg.ClampStatus.OPEN, 'opening')

    def test_sphere_goes_to_its_handle_at_its_speed(self):
        with Listener('/cloth/scene_markers', MarkerArray) as markers:
            def x():
                sphere = [m for m in markers.messages[-1].markers
                          if m.ns == 'obstacles' and m.type == m.SPHERE]
                return sphere[0].pose.position.x
            wait_until(lambda: markers.messages, 'markers')
            self.assertAlmostEqual(x(), 0.3)
            self.feedback('obstacle/sphere', InteractiveMarkerFeedback.POSE_UPDATE,
                          (0.6, 0.3, 0.05))
            wait_until(lambda: call('step', srv.Step, 1) and x() > 0.45, 'the sphere')
            # 0.15 m at 0.5 m/s take 0.3 s at least.
            self.assertGreater(state().time, 0.28)
            wait_until(lambda: call('step', srv.Step, 1) and abs(x() - 0.6) < 1e-6, 'its goal')


class LiveTests(unittest.TestSuite):
    def __init__(self):
        super().__init__(unittest.defaultTestLoader.loadTestsFromTestCase(case)
                         for case in (ParametersTest, DragTest, HandlesTest))


if __name__ == '__main__':
    rospy.init_node('live_test')
    rostest.rosrun('cloth_sim', 'live', '__main__.LiveTests')
