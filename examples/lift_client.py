#!/usr/bin/python3
"""Grasps a strip of cloth and lifts it, with the actions of the clamp:
`roslaunch cloth_sim cloth.launch scene:=strip`, then `rosrun cloth_sim lift_client.py`."""
import actionlib
import rospy
from cloth_sim.msg import GraspClothAction, GraspClothGoal, MoveClampAction, MoveClampGoal
from geometry_msgs.msg import PoseStamped


def do(action, kind, goal):
    client = actionlib.SimpleActionClient('/cloth/clamps/hand/' + action, kind)
    client.wait_for_server()
    status = client.send_goal_and_wait(goal)
    print(client.get_result().message)
    if status != actionlib.GoalStatus.SUCCEEDED:
        raise SystemExit(1)


rospy.init_node('lift_client')
do('grasp_cloth', GraspClothAction, GraspClothGoal())
up = PoseStamped()
up.header.frame_id = 'world'
up.pose.position.x, up.pose.position.z, up.pose.orientation.w = 0.12, 0.2, 1.0  # [m]
do('move', MoveClampAction, MoveClampGoal(poses=[up], times_from_start=[rospy.Duration(2.0)]))
