#!/usr/bin/python3
"""A robot in a scene: its links are obstacles that follow tf, and its gripper is a clamp."""
import math
import os
import subprocess
import sys
import threading
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from cloth_sim import msg, srv

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from polling import Listener, connected, wait_until  # noqa: E402

AWAY = -1000.0  # height of links that tf does not know [m]


def transform(parent, frame, place):
    message = TransformStamped()
    message.header.frame_id = parent
    message.header.stamp = rospy.Time.now()
    message.child_frame_id = frame
    translation = message.transform.translation
    translation.x, translation.y, translation.z = place
    message.transform.rotation.w = 1.0
    return message


class Gripper:
    """Says at 50 Hz where the palm and the fingers are, as a robot does."""
    def __init__(self):
        self.palm = (0.19, 0.0, 0.0)
        self.half = 0.04  # from the palm to the middle of a finger [m]
        self.publisher = connected('/tf', TFMessage)
        self.stopping = threading.Event()
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def run(self):
        while not self.stopping.is_set() and not rospy.is_shutdown():
            self.publisher.publish(TFMessage([
                transform('world', 'palm', self.palm),
                transform('palm', 'lower', (0.0, 0.0, -self.half)),
                transform('palm', 'upper', (0.0, 0.0, self.half))]))
            self.stopping.wait(0.02)

    def stop(self):
        self.stopping.set()
        self.thread.join()


def obstacles():
    """The places of the obstacles but the table, by shape."""
    with Listener('/cloth/scene_markers', MarkerArray) as markers:
        found = [marker for marker in markers.wait().markers if marker.ns == 'obstacles']
    return sorted((marker.pose.position.x, marker.pose.position.y, marker.pose.position.z)
                  for marker in found)


class RobotTest(unittest.TestCase):
    nodes = 0  # that were refused

    @classmethod
    def setUpClass(cls):
        rospy.wait_for_service('/cloth/get_state', 30.0)
        cls.get_state = rospy.ServiceProxy('/cloth/get_state', srv.GetState)
        cls.static = connected('/tf_static', TFMessage, latch=True)
        cls.static.publish(TFMessage([transform('world', 'stand', (-0.5, 0.3, 0.1)),
                                      transform('world', 'post', (0.19, 0.0, 0.0))]))
        cls.joints = connected('/joint_states', JointState)
        cls.gripper = Gripper()

    @classmethod
    def tearDownClass(cls):
        cls.gripper.stop()

    def setUp(self):
        self.gripper.palm, self.gripper.half = (0.19, 0.0, 0.0), 0.04

    def hand(self):
        return self.hand_of(self.get_state)

    @staticmethod
    def hand_of(get_state):
        return next(it for it in get_state().state.clamps if it.name == 'hand')

    def place_is(self, *place):
        """Waits for an obstacle at a place."""
        def there():
            return any(max(abs(a - b) for a, b in zip(it, place)) < 1e-6 for it in obstacles())
        wait_until(there, 'an obstacle at %s' % (place,))

    def test_links_follow_tf(self):
        self.place_is(-0.5, 0.3, 0.1)  # the stand
        self.place_is(0.19, 0.0, 0.1)  # the palm, 0.1 m above its frame
        self.gripper.palm = (0.19, 0.1, 0.2)
        self.place_is(0.19, 0.1, 0.3)
        self.assertEqual(len(obstacles()), 4, 'the table, the stand, the palm and the camera')

    def test_a_link_pushes_the_cloth(self):
        """The palm, a cylinder on the table, sweeps the strip aside (it is 0.2 m wide, along y).

        It moves in jumps, which may flick the strip away from it: the particles that lay across
        its way are followed wherever they go.
        """
        self.gripper.palm = (0.1, -0.2, -0.085)
        self.place_is(0.1, -0.2, 0.015)
        self.assertTrue(rospy.ServiceProxy('/cloth/reset', srv.ResetScene)().success)
        across = [k for k, (x, _, _) in enumerate(self.particles()) if abs(x - 0.1) < 0.003]
        self.assertEqual(len(across), 17)
        for centimetres in range(-20, 1):
            self.gripper.palm = (0.1, centimetres / 100, -0.085)
            self.place_is(0.1, centimetres / 100, 0.015)
        wait_until(lambda: self.is_aside(across), 'that the strip is past the palm')
        self.assertFalse(self.get_state().state.failed)
        self.assertTrue(rospy.ServiceProxy('/cloth/reset', srv.ResetScene)().success)

    def is_aside(self, across):
        """No particle is in the palm (radius 0.02 m, at (0.1, 0)); those across are past it."""
        places = self.particles()
        return (min(math.hypot(x - 0.1, y) for x, y, _ in places) > 0.02 and
                min(places[k][1] for k in across) > 0.0)

    def particles(self):
        """The positions of the cloth's particles [m]."""
        with Listener('/cloth/frame', msg.ClothFrame) as frames:
            flat = frames.wait().positions
        return list(zip(flat[0::3], flat[1::3], flat[2::3]))

    def test_a_reset_puts_links_back(self):
        self.place_is(-0.5, 0.3, 0.1)
        self.assertTrue(rospy.ServiceProxy('/cloth/reset', srv.ResetScene)().success)
        self.place_is(-0.5, 0.3, 0.1)
        self.place_is(0.19, 0.0, 0.1)

    def test_a_link_that_tf_never_knows_stays_away(self):
        process = self.start('lonely', description='gripper', links=['camera'])
        try:
            with Listener('/diagnostics', DiagnosticArray) as diagnostics:
                diagnostics.wait(lambda message: any(
                    status.name.startswith('lonely') and entry.key == 'robot link camera'
                    and entry.value.startswith('lost')
                    for status in message.status for entry in status.values))
        finally:
            process.terminate()
            _, errors = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 0, errors)
        self.assertEqual(errors.count('robot link camera'), 1, errors)
        self.place_is(0.0, 0.0, AWAY)

    def test_the_clamp_is_between_the_fingers(self):
        self.place_is(0.19, 0.0, 0.1)  # back from other tests, which may have moved the strip
        self.assertTrue(rospy.ServiceProxy('/cloth/reset', srv.ResetScene)().success)
        wait_until(lambda: self.hand().state == msg.ClampStatus.OPEN, 'an open hand')
        self.assertEqual(self.hand().held, 0)
        self.gripper.half = 0.01  # the fingers are 1 cm apart
        wait_until(lambda: self.hand().held > 0, 'a grasp')
        self.gripper.palm = (0.15, 0.0, 0.1)
        wait_until(lambda: abs(self.hand().pose.position.z - 0.1) < 1e-3, 'a lift')
        self.assertGreater(self.hand().held, 0)
        self.assertAlmostEqual(self.hand().pose.position.x, 0.15, delta=1e-3)
        self.gripper.half = 0.04
        wait_until(lambda: self.hand().held == 0, 'an open hand')

    def press(self, *effort):
        """The gripper reports the effort of the joint of its upper finger [N]."""
        self.joints.publish(JointState(name=['arm', 'b'], effort=[0.0, *effort] if effort else []))

    def grip_is(self, force):
        wait_until(lambda: abs(self.hand().grip_force - force) < 1e-9, 'a grip of %g N' % force)

    def test_the_motor_limits_the_grip(self):
        self.assertTrue(rospy.ServiceProxy('/cloth/reset', srv.ResetScene)().success)
        self.press(50.0)
        self.grip_is(40.0)  # friction of 0.4 at both plates
        self.gripper.half = 0.01
        wait_until(lambda: self.hand().held > 0, 'a grasp')
        self.press()  # a message without efforts
        self.press(float('nan'))
        self.press(50.1)  # hardly a change
        self.gripper.palm = (0.15, 0.0, 0.1)
        wait_until(lambda: abs(self.hand().pose.position.z - 0.1) < 1e-3, 'a lift')
        self.assertGreater(self.hand().held, 0)
        self.assertAlmostEqual(self.hand().grip_force, 40.0)
        self.press(0.0)  # the motor is off
        self.grip_is(0.001)
        wait_until(lambda: self.hand().held == 0, 'that the strip slips out')
        self.press(-50.0)  # drivers differ in the sign
        self.grip_is(40.0)
        self.gripper.half = 0.04
        self.assertTrue(rospy.ServiceProxy('/cloth/reset', srv.ResetScene)().success)
        self.grip_is(40.0)

    def test_fingers_close_on_a_base_that_stands(self):
        """About a base in /tf_static there is no news, but there is about its fingers."""
        with open(os.path.join(HERE, 'robot.urdf')) as file:
            text = file.read()
        for old, new in (('stand', 'rack'), ('palm', 'post'), ('lower', 'left'),
                         ('upper', 'right')):
            text = text.replace('"%s"' % old, '"%s"' % new)
        rospy.set_param('/bolted_urdf', text)
        process = self.start('bolted', description='/bolted_urdf', links=['post'],
                             clamps={'hand': ['left', 'right']})
        try:
            rospy.wait_for_service('/bolted/get_state', 30.0)
            get_state = rospy.ServiceProxy('/bolted/get_state', srv.GetState)

            def is_at(half, state):
                self.gripper.publisher.publish(TFMessage([
                    transform('post', 'left', (0.0, 0.0, -half)),
                    transform('post', 'right', (0.0, 0.0, half))]))
                return self.hand_of(get_state).state == state
            for half, state in ((0.04, msg.ClampStatus.OPEN), (0.01, msg.ClampStatus.CLOSED),
                                (0.04, msg.ClampStatus.OPEN)):
                wait_until(lambda h=half, s=state: is_at(h, s), 'state %d of the hand' % state)
        finally:
            process.terminate()
            _, errors = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 0, errors)

    def test_commands_to_the_plates_last(self):
        wait_until(lambda: self.hand().state == msg.ClampStatus.OPEN, 'an open hand')
        reply = rospy.ServiceProxy('/cloth/grasp', srv.Grasp)('hand', True)
        self.assertTrue(reply.success, reply.message)
        step = self.get_state().state.step
        wait_until(lambda: self.get_state().state.step > step + 30, 'steps')
        self.assertEqual(self.hand().state, msg.ClampStatus.CLOSED)
        self.assertTrue(rospy.ServiceProxy('/cloth/grasp', srv.Grasp)('hand', False).success)

    def start(self, name, **robot):
        rospy.set_param('/%s/scene' % name, 'strip')
        rospy.set_param('/%s/robot' % name, robot)
        path = subprocess.check_output(['catkin_find', '--first-only', '--libexec', 'cloth_sim',
                                        'cloth_node'], text=True).strip()
        return subprocess.Popen([path, '__name:=' + name], stderr=subprocess.PIPE, text=True)

    def refused(self, says, **robot):
        """Another node ends with status 2 and one line."""
        RobotTest.nodes += 1
        process = self.start('bad%d' % RobotTest.nodes, **robot)
        _, errors = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 2, errors)
        lines = errors.splitlines()
        self.assertEqual(len(lines), 1, errors)
        self.assertIn(says, lines[0])

    def test_bad_robots_are_refused(self):
        with open(os.path.join(HERE, 'robot.urdf')) as file:
            text = file.read()
        self.refused('there is no parameter /nothing with a URDF', description='nothing')
        self.refused("unknown link 'plam' (known: camera, lower", description='gripper',
                     links=['plam'])
        self.refused("unknown clamp 'foot' (known: hand)", description='gripper',
                     clamps={'foot': ['lower', 'upper']})
        self.refused("unknown key 'link'", description='gripper', link=['palm'])
        self.refused('expected two links', description='gripper', clamps={'hand': ['lower']})
        self.refused('expected a list of links', description='gripper', links='palm')

        def refused_hand(says, **hand):
            self.refused(says, description='gripper', clamps={'hand': hand})
        refused_hand('expected two links as plates', motor='b')
        refused_hand('expected a joint as motor', plates=['lower', 'upper'], friction=0.4)
        refused_hand("unknown key 'moter'", plates=['lower', 'upper'], motor='b', moter='b')
        refused_hand("unknown joint 'c' (known: a, arm, b, eye)", plates=['lower', 'upper'],
                     motor='c')
        refused_hand("joint 'arm': expected one that slides or turns", plates=['lower', 'upper'],
                     motor='arm')
        refused_hand('expected a number > 0 and <= 10', plates=['lower', 'upper'], motor='b',
                     friction=0.0)
        rospy.set_param('/malformed', text.replace('</link>', '', 1))
        self.refused('the URDF is malformed', description='malformed')
        rospy.set_param('/bare', '<robot name="r"><link name="palm"/></robot>')
        self.refused('the URDF has no collision geometry', description='bare')
        rospy.set_param('/no_mesh', text.replace(
            '<sphere radius="0.02" />', '<mesh filename="package://cloth_sim/palm.stl" />'))
        self.refused("link 'camera': ", description='no_mesh')
        rospy.set_param('/no_package', text.replace(
            '<sphere radius="0.02" />', '<mesh filename="package://no_arm/palm.stl" />'))
        self.refused("there is no package 'no_arm'", description='no_package')
        rospy.set_param('/taken', text.replace('"stand"', '"table"'))
        self.refused("the scene has an obstacle 'table' already", description='taken')


if __name__ == '__main__':
    rospy.init_node('robot_test')
    rostest.rosrun('cloth_sim', 'robot', RobotTest)
