#!/usr/bin/python3
"""Folds a towel in half with an arm of three joints and a gripper, as the driver of the arm would:
`roslaunch cloth_sim fold.launch client:=python`. It sends joint states, of which
robot_state_publisher makes tf; the links and the clamp of the simulation follow tf."""
import math

import rospy
from cloth_sim.msg import ClothState
from sensor_msgs.msg import JointState

LINK = 0.34  # length of the upper arm, and of the forearm [m]
SHOULDER = 0.58  # height [m]
HAND = 0.115  # from the wrist to the tips of the fingers [m]
SIDE = 0.18  # of the towel, from the fold to the edge that the fingers take [m]
LIFT = 0.10  # of that edge above the fold, lower than it could be: the towel stays slack [m]
DEPTH = 0.012  # of the edge between the fingers [m]
LEAP = 0.05  # most time on the path between messages: a busy machine makes the arm late [s]

# Time [s], angle about the fold [rad], way from the grasp back [m], gap between the fingers [m].
PATH = [(0.0, 0.0, 0.05, 0.024),  # in front of the edge
        (1.0, 0.0, 0.00, 0.024),  # the edge is between the fingers
        (1.5, 0.0, 0.00, 0.004),  # they hold it
        (4.5, math.pi, 0.00, 0.004),  # over, around the fold
        (5.0, math.pi, 0.00, 0.024),  # they let go
        (6.0, math.pi, 0.06, 0.024)]  # and back, to the other side


def smooth(fraction):
    """From 0 to 1, with no speed at either end."""
    return fraction * fraction * (3.0 - 2.0 * fraction)


def sample(time):
    """Angle, way back and gap at a time of the path."""
    for (t0, *start), (t1, *end) in zip(PATH, PATH[1:]):
        if time < t1:
            s = smooth(max(0.0, time - t0) / (t1 - t0))
            return [a + s * (b - a) for a, b in zip(start, end)]
    return PATH[-1][1:]


def joints(angle, back, gap):
    """Inverse kinematics: of the wrist by two links of one length, then of the hand."""
    reach = HAND - DEPTH + back  # from the edge of the towel to the wrist
    height = -0.002 + 0.017 * angle / math.pi  # by the table, then on two layers
    x = (SIDE + reach) * math.cos(angle)
    z = (LIFT + reach) * math.sin(angle) + height - SHOULDER
    elbow = -2.0 * math.acos(math.hypot(x, z) / (2.0 * LINK))
    shoulder = math.atan2(z, x) - elbow / 2.0
    return [shoulder, elbow, angle - math.pi - shoulder - elbow, gap / 2.0]


def drive():
    publisher = rospy.Publisher('joint_states', JointState, queue_size=1)
    rospy.wait_for_message('/cloth/state', ClothState)
    last = rospy.Time.now()
    path = 0.0  # time on the path [s]
    rate = rospy.Rate(60)
    while not rospy.is_shutdown():
        rate.sleep()
        now = rospy.Time.now()
        if now == last:
            continue  # simulated time goes in steps
        state = JointState(name=['shoulder', 'elbow', 'wrist', 'finger'])
        state.header.stamp = now
        before, path = path, path + min((now - last).to_sec(), LEAP)
        last = now
        state.position = joints(*sample(path))
        publisher.publish(state)
        if before < PATH[-1][0] <= path:
            rospy.loginfo('folded')


rospy.init_node('fold_client')
try:
    drive()
except rospy.ROSInterruptException:
    pass  # Ctrl-C
