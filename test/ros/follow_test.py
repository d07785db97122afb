#!/usr/bin/python3
"""Clamps that follow tf frames and topics, come and go, and open and close by a hand's width."""
import os
import sys
import threading
import time
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point, PoseStamped, TransformStamped, WrenchStamped
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64
from tf2_msgs.msg import TFMessage

from cloth_sim import msg, srv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import Listener, connected, wait_until  # noqa: E402

START = (0.2, 0.0, 1.0)  # of the clamp "hand"
LIFTED = (0.2, 0.0, 1.01)


class Mover:
    """Says at 50 Hz where something is that starts at a place and moves evenly along x."""
    def __init__(self, say, start=START, velocity=0.0):
        self.say, self.start, self.velocity = say, start, velocity
        self.begun = time.monotonic()
        self.last = start  # place that it said
        self.stopping = threading.Event()
        self.thread = threading.Thread(target=self.run)

    def place(self):
        x, y, z = self.start
        return x + self.velocity * (time.monotonic() - self.begun), y, z

    def run(self):
        while not self.stopping.is_set() and not rospy.is_shutdown():
            self.last = self.place()
            self.say(self.last)
            self.stopping.wait(0.02)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.stopping.set()
        self.thread.join()


def transform(frame, place):
    message = TransformStamped()
    message.header.frame_id = 'world'
    message.header.stamp = rospy.Time.now()
    message.child_frame_id = frame
    translation = message.transform.translation
    translation.x, translation.y, translation.z = place
    message.transform.rotation.w = 1.0
    return TFMessage([message])


def broadcaster(frame):
    """Says on /tf where a frame is."""
    publisher = connected('/tf', TFMessage)
    return lambda place: publisher.publish(transform(frame, place))


class FollowTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.wait_for_service('/cloth/follow', 30.0)
        cls.static = connected('/tf_static', TFMessage, latch=True)
        cls.static.publish(transform('gripper_link', START))
        cls.get_state = rospy.ServiceProxy('/cloth/get_state', srv.GetState)
        cls.follow = rospy.ServiceProxy('/cloth/follow', srv.Follow)
        cls.add = rospy.ServiceProxy('/cloth/add_clamp', srv.AddClamp)
        cls.remove = rospy.ServiceProxy('/cloth/remove_clamp', srv.RemoveClamp)

    def setUp(self):
        self.follows(clamp='hand')
        self.assertTrue(rospy.ServiceProxy('/cloth/reset', srv.ResetScene)().success)

    def follows(self, **request):
        reply = self.follow(**request)
        self.assertTrue(reply.success, reply.message)

    def state(self):
        return self.get_state().state

    def hand(self, name='hand'):
        return next(clamp for clamp in self.state().clamps if clamp.name == name)

    def arrives(self, place, name='hand', within=1e-3):
        def there():
            p = self.hand(name).pose.position
            return max(abs(p.x - place[0]), abs(p.y - place[1]), abs(p.z - place[2])) < within
        wait_until(there, '%s at %s' % (name, (place,)))

    def test_1_a_static_and_then_a_moving_frame_tear_the_cloth(self):
        self.follows(clamp='hand', tf='gripper_link')  # as the launch file says
        wait_until(lambda: self.hand().held > 0, 'a grasp')
        self.arrives(START)
        self.assertEqual(self.state().pieces, 1)
        # The frame will not say its place again after a reset, which puts the clamp back.
        self.follows(clamp='hand', tf='lifted_link')
        self.static.publish(transform('lifted_link', LIFTED))
        self.arrives(LIFTED)
        self.assertTrue(rospy.ServiceProxy('/cloth/reset', srv.ResetScene)().success)
        self.arrives(LIFTED)
        with Mover(broadcaster('moving_link'), velocity=0.1) as mover:
            self.follows(clamp='hand', tf='moving_link')
            wait_until(lambda: self.state().pieces == 2, 'two pieces')
            p = self.hand().pose.position
            self.assertAlmostEqual(p.x, mover.place()[0], delta=0.05)
        self.assertGreater(self.state().broken_torn, 0)

    def test_a_source_that_is_gone_is_held_and_reported_and_found_again(self):
        frame = broadcaster('lift_link')
        with Listener('/diagnostics', DiagnosticArray) as diagnostics:
            with Mover(frame, velocity=0.02) as mover:
                self.follows(clamp='hand', tf='lift_link')
                wait_until(lambda: self.hand().pose.position.x > START[0] + 0.01, 'motion')
            lost = self.follower_says(diagnostics, 'lost')
            self.assertIn('lift_link', lost)
            self.arrives(mover.last, within=1e-9)  # and not where it would have been by now
            place = self.hand().pose.position.x
            step = self.state().step
            wait_until(lambda: self.state().step > step + 30, 'steps')
            self.assertEqual(self.hand().pose.position.x, place)
            self.assertFalse(self.state().failed)
            with Mover(frame, start=(START[0] + 0.01, 0.0, 1.02)):
                self.follower_says(diagnostics, 'following')
                self.arrives((START[0] + 0.01, 0.0, 1.02))

    def follower_says(self, diagnostics, what):
        def value(message):
            for status in message.status:
                for entry in status.values:
                    if entry.key == 'clamp hand' and entry.value.startswith(what):
                        return entry.value
            return None
        return value(diagnostics.wait(value))

    def test_an_unknown_frame_is_reported(self):
        with Listener('/diagnostics', DiagnosticArray) as diagnostics:
            self.follows(clamp='hand', tf='nowhere')
            self.assertIn('nowhere', self.follower_says(diagnostics, 'lost'))
        self.arrives(START)

    def test_a_pose_topic_in_another_frame(self):
        target = connected_after(
            lambda: self.follows(clamp='hand', pose='/arm/pose'), '/arm/pose', PoseStamped)
        message = PoseStamped()
        message.header.frame_id = 'gripper_link'  # which is at the start
        message.pose.position = Point(0.01, 0.0, 0.02)
        message.pose.orientation.w = 1.0
        target.publish(message)
        self.arrives((START[0] + 0.01, START[1], START[2] + 0.02))
        message.pose.orientation.w = 0.5  # no unit quaternion
        message.pose.position.z = 1.0
        target.publish(message)
        message.pose.orientation.w = 1.0
        message.pose.position.z = 0.03
        target.publish(message)
        self.arrives((START[0] + 0.01, START[1], START[2] + 0.03))

    def test_odometry(self):
        target = connected_after(
            lambda: self.follows(clamp='hand', odometry='/arm/odom'), '/arm/odom', Odometry)
        message = Odometry()
        message.header.frame_id = 'world'
        message.pose.pose.position = Point(START[0] + 0.02, 0.0, 1.0)
        message.pose.pose.orientation.w = 1.0
        target.publish(message)
        self.arrives((START[0] + 0.02, 0.0, 1.0))

    def test_a_width_closes_and_opens(self):
        wait_until(lambda: self.hand().held > 0, 'a grasp')
        width = connected_after(
            lambda: self.follows(clamp='hand', grasp_width='/arm/width'), '/arm/width', Float64)
        width.publish(0.05)
        wait_until(lambda: self.hand().held == 0, 'an open hand')
        width.publish(0.01)
        wait_until(lambda: self.hand().state == msg.ClampStatus.CLOSED, 'a closed hand')
        gripper = connected('/cloth/clamps/hand/gripper_command', msg.GripperCommand)
        gripper.publish(position=0.05, max_effort=7.0)
        wait_until(lambda: self.hand().state == msg.ClampStatus.OPEN, 'an open hand')
        self.assertEqual(self.hand().grip_force, 7.0)
        gripper.publish(position=float('nan'), max_effort=9.0)
        gripper.publish(position=0.0, max_effort=0.0)
        wait_until(lambda: self.hand().state == msg.ClampStatus.CLOSED, 'a closed hand')
        self.assertEqual(self.hand().grip_force, 7.0)

    def test_clamps_come_and_go_with_their_topics(self):
        request = srv.AddClampRequest()
        request.name = 'extra'
        request.pose.header.frame_id = 'gripper_link'
        request.pose.pose.position = Point(-0.4, 0.0, 0.0)
        request.pose.pose.orientation.w = 1.0
        request.gap_open = 0.3
        reply = self.add(request)
        self.assertTrue(reply.success, reply.message)
        self.assertFalse(self.add(request).success, 'there is one already')
        self.assertAlmostEqual(self.hand('extra').pose.position.x, START[0] - 0.4)
        self.assertAlmostEqual(self.hand('extra').gap, 0.3)
        with Listener('/cloth/clamps/extra/wrench', WrenchStamped) as wrenches:
            wrenches.wait()
        self.assertIn('extra', self.get_state().clamps)
        self.follows(clamp='extra', tf='gripper_link')
        self.arrives(START, 'extra')
        self.assertTrue(self.remove('extra').success)
        self.assertFalse(self.remove('extra').success)
        self.assertFalse(self.follow(clamp='extra').success)
        self.assertNotIn('extra', self.get_state().clamps)
        wait_until(lambda: not any('/extra/' in topic for topic, _ in
                                   rospy.get_published_topics('/cloth')), 'no topics of it')

    def test_bad_requests_are_refused(self):
        for bad in (dict(clamp='foot', tf='gripper_link'), dict(clamp='hand', tf='a', pose='/b'),
                    dict(clamp='hand', pose='no topic')):
            reply = self.follow(**bad)
            self.assertFalse(reply.success)
            self.assertNotEqual(reply.message, '')
        request = srv.AddClampRequest()
        request.pose.header.frame_id = 'world'
        request.pose.pose.orientation.w = 1.0
        for name in ('', 'all', '1st', 'a/b'):
            request.name = name
            self.assertFalse(self.add(request).success, name)
        request.name = 'good'
        for field, value in (('gap_open', 0.001), ('grip_force', -1.0), ('max_speed', -1.0)):
            setattr(request, field, value)
            self.assertFalse(self.add(request).success, field)
            setattr(request, field, 0.0)
        self.assertEqual(self.get_state().clamps, ['hand'])


def connected_after(start, topic, kind):
    """Has the node subscribe to a topic, and gives a publisher of it."""
    start()
    return connected(topic, kind)


if __name__ == '__main__':
    rospy.init_node('follow_test')
    rostest.rosrun('cloth_sim', 'follow', FollowTest)
