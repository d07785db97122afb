#!/usr/bin/python3
"""Grasps a strip of cloth, lifts it, tears it and waits for two pieces:
`roslaunch cloth_sim cloth.launch scene:=strip`, then `rosrun cloth_sim tear_client.py`."""
import rospy
from cloth_sim.msg import ClothState
from cloth_sim.srv import Grasp, SetClampPose
from geometry_msgs.msg import PoseStamped


def call(service, kind, *arguments):
    rospy.wait_for_service('/cloth/' + service)
    reply = rospy.ServiceProxy('/cloth/' + service, kind)(*arguments)
    if not reply.success:
        raise SystemExit('%s: %s' % (service, reply.message))


def move(x, z):
    """A target of the clamp [m]."""
    target = PoseStamped()
    target.header.frame_id = 'world'
    target.pose.position.x, target.pose.position.z = x, z
    target.pose.orientation.w = 1.0
    call('set_clamp_pose', SetClampPose, 'hand', target)


def wait_until(holds):
    while not holds(rospy.wait_for_message('/cloth/state', ClothState)):
        pass


rospy.init_node('tear_client')
call('grasp', Grasp, 'hand', True)
wait_until(lambda state: state.clamps[0].held > 0)
move(0.12, 0.2)
wait_until(lambda state: state.clamps[0].pose.position.z > 0.199)
move(0.5, 0.2)
wait_until(lambda state: state.pieces == 2)
print('two pieces')
