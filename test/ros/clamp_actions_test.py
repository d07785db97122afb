#!/usr/bin/python3
"""The actions of clamps, and their trajectories."""
import os
import sys

import rospy
import rostest
from actionlib import ActionClient, CommState, GoalStatus
from geometry_msgs.msg import PoseStamped, Transform
from trajectory_msgs.msg import MultiDOFJointTrajectory, MultiDOFJointTrajectoryPoint

from cloth_sim import msg, srv

try:
    from control_msgs import msg as gripper_msgs
except ImportError:  # Debian 12 has no such package
    gripper_msgs = msg

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import connected, node_log, wait_until  # noqa: E402
from services import ServiceTest  # noqa: E402

SERVICES = dict(set_clamp_pose=srv.SetClampPose, grasp=srv.Grasp, pause=srv.Pause, step=srv.Step,
                set_phase=srv.StartPhase, reset=srv.ResetScene, get_state=srv.GetState,
                add_clamp=srv.AddClamp, remove_clamp=srv.RemoveClamp)
NAN = float('nan')
DT = 1.0 / 60.0
MOVE = msg.MoveClampResult
GRASP = msg.GraspClothResult


def pose(x=0.6, y=0.0, z=0.8, frame='world'):
    message = PoseStamped()
    message.header.frame_id = frame
    message.pose.position.x, message.pose.position.y, message.pose.position.z = x, y, z
    message.pose.orientation.w = 1.0
    return message


def move(*poses, times=(), **fields):
    return msg.MoveClampGoal(poses=list(poses),
                             times_from_start=[rospy.Duration.from_sec(t) for t in times], **fields)


def trajectory(*points, frame='world'):
    """\\param points  (time, x, y, z) each."""
    message = MultiDOFJointTrajectory()
    message.header.frame_id = frame
    for time, x, y, z in points:
        transform = Transform()
        transform.translation.x, transform.translation.y, transform.translation.z = x, y, z
        transform.rotation.w = 1.0
        message.points.append(MultiDOFJointTrajectoryPoint(
            transforms=[transform], time_from_start=rospy.Duration.from_sec(time)))
    return message


class Goal:
    """A goal of an action. It runs while the simulation does."""

    def __init__(self, client, goal):
        self.feedback = []
        self.handle = client.send_goal(goal, feedback_cb=lambda _, message:
                                       self.feedback.append(message))

    def answered(self):
        wait_until(lambda: self.handle.get_goal_status() != GoalStatus.PENDING, 'an answer')

    def begun(self):
        wait_until(lambda: self.handle.get_goal_status() == GoalStatus.ACTIVE, 'the goal to begin')
        return self

    def wait(self):
        wait_until(lambda: self.handle.get_comm_state() == CommState.DONE, 'the end of a goal')
        return self.handle.get_goal_status(), self.handle.get_result()


class ClampActionsTest(ServiceTest):
    SERVICES = SERVICES

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clients = {}
        for clamp in ('hand', 'empty', 'far'):
            for name, kind in (('gripper', gripper_msgs.GripperCommandAction),
                               ('grasp_cloth', msg.GraspClothAction),
                               ('move', msg.MoveClampAction)):
                cls.clients[clamp, name] = cls.client(clamp, name, kind)

    @staticmethod
    def client(clamp, name, kind):
        client = ActionClient('/cloth/clamps/%s/%s' % (clamp, name), kind)
        wait_until(lambda: client.pub_goal.get_num_connections() > 0 and
                   client.last_status_msg is not None, 'action ' + name)
        return client

    def setUp(self):
        self.accepted('pause', True)
        self.accepted('reset')

    def clamp(self, name):
        return next(clamp for clamp in self.state().clamps if clamp.name == name)

    def send(self, clamp, name, goal):
        return Goal(self.clients[clamp, name], goal)

    def finished(self, goal):
        """Runs from the time that the goal is answered until it is over; then pauses again."""
        goal.answered()
        self.accepted('pause', False)
        end = goal.wait()
        self.accepted('pause', True)
        return end

    def refused(self, clamp, name, goal, says):
        before = self.state()
        status, result = self.send(clamp, name, goal).wait()
        self.assertEqual(status, GoalStatus.REJECTED)
        after = self.state()
        before.header = after.header
        self.assertEqual(before, after)
        if name != 'gripper':
            self.assertIn(says, result.message)
            self.assertNotIn('\n', result.message)
        return result

    @staticmethod
    def grip(position, effort=0.0):
        return gripper_msgs.GripperCommandGoal(
            command=gripper_msgs.GripperCommand(position=position, max_effort=effort))

    # ---- gripper ---------------------------------------------------------------------------------

    def test_gripper_closes_on_cloth_and_opens(self):
        goal = self.send('hand', 'gripper', self.grip(0.0, 20.0))
        status, result = self.finished(goal)
        self.assertEqual(status, GoalStatus.SUCCEEDED)
        self.assertAlmostEqual(result.position, 0.01)
        self.assertTrue(result.reached_goal)
        self.assertTrue(result.stalled, 'it holds cloth')
        self.assertEqual(self.clamp('hand').grip_force, 20.0)
        self.assertGreater(self.clamp('hand').held, 0)

        status, result = self.finished(self.send('hand', 'gripper', self.grip(0.08)))
        self.assertEqual(status, GoalStatus.SUCCEEDED)
        self.assertAlmostEqual(result.position, 0.08)
        self.assertTrue(result.reached_goal)
        self.assertFalse(result.stalled)
        self.assertEqual(result.effort, 0.0)
        self.assertEqual(self.clamp('hand').grip_force, 20.0, 'an effort of 0 changes nothing')

    def test_gripper_that_closes_on_nothing_is_not_stalled(self):
        status, result = self.finished(self.send('empty', 'gripper', self.grip(0.02)))
        self.assertEqual(status, GoalStatus.SUCCEEDED)
        self.assertEqual((result.reached_goal, result.stalled), (True, False))

    def test_gripper_waits_while_the_simulation_is_paused(self):
        goal = self.send('hand', 'gripper', self.grip(0.0)).begun()
        wait_until(lambda: len(goal.feedback) >= 3, 'feedback')
        self.assertAlmostEqual(goal.feedback[-1].position, 0.08)
        self.assertFalse(goal.feedback[-1].reached_goal)
        self.assertEqual(self.finished(goal)[0], GoalStatus.SUCCEEDED)

    def test_gripper_refuses(self):
        for bad in (self.grip(NAN), self.grip(0.0, -1.0), self.grip(0.0, NAN)):
            self.refused('hand', 'gripper', bad, '')

    def test_gripper_is_preempted_by_a_goal_and_by_a_service(self):
        first = self.send('hand', 'gripper', self.grip(0.0)).begun()
        second = self.send('hand', 'gripper', self.grip(0.08))
        self.assertEqual(first.wait()[0], GoalStatus.PREEMPTED)
        self.assertEqual(second.wait()[0], GoalStatus.SUCCEEDED)
        third = self.send('hand', 'gripper', self.grip(0.0)).begun()
        self.accepted('grasp', 'hand', False)
        self.assertEqual(third.wait()[0], GoalStatus.PREEMPTED)

    # ---- grasp_cloth -----------------------------------------------------------------------------

    def test_grasp_tells_what_it_holds(self):
        status, result = self.finished(self.send('hand', 'grasp_cloth', msg.GraspClothGoal()))
        self.assertEqual(status, GoalStatus.SUCCEEDED)
        self.assertEqual(result.outcome, GRASP.HOLDS)
        clamp = self.clamp('hand')
        self.assertEqual(clamp.state, msg.ClampStatus.CLOSED)
        self.assertEqual(result.held, clamp.held)
        self.assertEqual(len(result.particles), clamp.held)
        self.assertEqual(list(result.particles), sorted(result.particles))
        # Plates of 0.06 m around x = 0.19 and y = 0, where particles are 0.025 m apart.
        self.assertEqual({v % 17 for v in result.particles}, {15, 16})
        self.assertEqual({v // 17 for v in result.particles}, {7, 8, 9})
        self.assertAlmostEqual(result.held_area, clamp.held_area)
        self.assertEqual(result.revision, self.state().revision)

    def test_grasp_of_nothing_is_aborted(self):
        status, result = self.finished(self.send('empty', 'grasp_cloth', msg.GraspClothGoal()))
        self.assertEqual(status, GoalStatus.ABORTED)
        self.assertEqual(result.outcome, GRASP.NOTHING)
        self.assertIn('nothing', result.message)

    def test_a_patch_out_of_reach_is_refused(self):
        result = self.refused('far', 'grasp_cloth', msg.GraspClothGoal(grip_force=3.0), '0.9')
        self.assertIn('attach', result.message)
        self.refused('far', 'gripper', self.grip(0.0, 3.0), '')
        reply = self.call['grasp']('far', True)
        self.assertFalse(reply.success)
        self.assertIn('0.9', reply.message)
        self.refused('hand', 'grasp_cloth', msg.GraspClothGoal(grip_force=-1.0), 'grip_force')

    def test_a_patch_within_reach_is_grasped(self):
        end = self.finished(self.send('far', 'move', move(pose(-0.1, 0.0, 0.5))))
        self.assertEqual(end[0], GoalStatus.SUCCEEDED)
        status, result = self.finished(self.send('far', 'grasp_cloth', msg.GraspClothGoal()))
        self.assertEqual(status, GoalStatus.SUCCEEDED)
        self.assertEqual(result.held, 9)

    # ---- move ------------------------------------------------------------------------------------

    def near(self, actual, wanted, delta=0.0011):
        for axis in 'xyz':
            self.assertAlmostEqual(getattr(actual.position, axis),
                                   getattr(wanted.pose.position, axis), delta=delta)

    def test_move_to_a_pose(self):
        goal = self.send('empty', 'move', move(pose(0.6, 0.2, 1.0)))
        status, result = self.finished(goal)
        self.assertEqual(status, GoalStatus.SUCCEEDED)
        self.assertEqual(result.outcome, MOVE.REACHED)
        self.near(result.pose, pose(0.6, 0.2, 1.0))
        self.assertLessEqual(result.position_error, 0.001)

    def test_move_along_poses(self):
        goal = self.send('empty', 'move', move(pose(0.7), pose(0.7, 0.1), pose(0.7, 0.1, 0.9)))
        goal.begun()
        wait_until(lambda: goal.feedback, 'feedback')
        self.assertEqual(goal.feedback[0].waypoint, 0)
        self.assertAlmostEqual(goal.feedback[0].distance, 0.3, places=9)
        status, result = self.finished(goal)
        self.assertEqual(status, GoalStatus.SUCCEEDED)
        self.near(result.pose, pose(0.7, 0.1, 0.9))

    def test_move_keeps_the_times(self):
        goal = self.send('empty', 'move', move(pose(0.8), pose(0.8, 0.3), times=(1.0, 3.0))).begun()
        self.accepted('step', 30)  # half a second: half of the first way, less what it lags behind
        self.assertAlmostEqual(self.clamp('empty').pose.position.x, 0.7, delta=0.002)
        self.accepted('step', 90)  # at 2 s
        self.near(self.clamp('empty').pose, pose(0.8, 0.15), delta=0.002)
        self.accepted('step', 59)
        self.assertEqual(goal.handle.get_comm_state(), CommState.ACTIVE)
        self.accepted('step', 2)
        status, result = goal.wait()
        self.assertEqual(status, GoalStatus.SUCCEEDED)
        self.assertAlmostEqual(result.time, 3.0, delta=1.5 * DT)
        self.near(result.pose, pose(0.8, 0.3))

    def test_move_keeps_the_speed(self):
        goal = self.send('empty', 'move', move(pose(0.7), pose(0.7, 0.1), speed=0.1))
        status, result = self.finished(goal)
        self.assertEqual(status, GoalStatus.SUCCEEDED)
        self.assertAlmostEqual(result.time, 2.0, delta=3 * DT)

    def test_move_refuses(self):
        nan = pose(NAN)
        for goal, says in (
                (move(), 'poses'),
                (move(nan), 'poses[0]'),
                (move(pose(), pose(frame='nowhere')), 'poses[1]'),
                (move(pose(0.7), pose(0.8), times=(1.0,)), 'as many as poses'),
                (move(pose(0.7), pose(0.8), times=(1.0, 1.0)), 'times_from_start[1]'),
                (move(pose(0.7), pose(0.8), times=(2.0, 1.0)), 'times_from_start[1]'),
                (move(pose(0.7), times=(-1.0,)), 'times_from_start[0]'),
                (move(pose(0.7), times=(0.0,)), '0.1 m away'),
                (move(pose(1.6), times=(1.0,)), "clamp's 0.5 m/s on the way there (got 1)"),
                (move(pose(0.7), speed=0.6), "clamp's 0.5 m/s"),
                (move(pose(0.7), speed=NAN), 'speed'),
                (move(pose(0.7), position_tolerance=-1.0), 'position_tolerance'),
                (move(pose(0.7), time_limit=NAN), 'time_limit')):
            with self.subTest(says=says):
                result = self.refused('empty', 'move', goal, says)
                self.assertEqual(result.outcome, MOVE.REFUSED)

    def test_a_refused_move_leaves_the_one_under_way(self):
        goal = self.send('empty', 'move', move(pose(0.8))).begun()
        self.assertEqual(self.send('empty', 'move', move(pose(NAN))).wait()[0], GoalStatus.REJECTED)
        self.assertEqual(self.send('empty', 'move', move(pose(9.0), times=(1.0,))).wait()[0],
                         GoalStatus.REJECTED)
        self.assertEqual(self.finished(goal)[0], GoalStatus.SUCCEEDED)

    def test_move_is_preempted(self):
        def preempted(goal, says):
            status, result = goal.wait()
            self.assertEqual((status, result.outcome), (GoalStatus.PREEMPTED, MOVE.PREEMPTED))
            self.assertIn(says, result.message)

        first = self.send('empty', 'move', move(pose(0.8))).begun()
        second = self.send('empty', 'move', move(pose(0.9))).begun()
        preempted(first, 'another goal')
        self.accepted('set_clamp_pose', 'empty', pose(0.7))
        preempted(second, 'something else')
        third = self.send('empty', 'move', move(pose(0.9), times=(2.0,))).begun()
        self.accepted('step', 10)
        self.accepted('set_phase', 'drive')
        self.accepted('step', 1)
        preempted(third, 'something else')
        fourth = self.send('empty', 'move', move(pose(0.6))).begun()
        self.accepted('step', 5)
        x = self.clamp('empty').pose.position.x
        fourth.handle.cancel()
        preempted(fourth, 'cancelled')
        self.accepted('step', 120)
        self.assertAlmostEqual(self.clamp('empty').pose.position.x, x, delta=0.03)

    def test_move_gives_up_in_time(self):
        goal = self.send('empty', 'move', move(pose(2.6), time_limit=0.5))
        status, result = self.finished(goal)
        self.assertEqual((status, result.outcome), (GoalStatus.ABORTED, MOVE.TIMED_OUT))
        self.assertAlmostEqual(result.time, 0.5, delta=1.5 * DT)
        self.assertGreater(result.position_error, 1.5)

    def test_a_reset_and_a_removal_abort(self):
        goal = self.send('empty', 'move', move(pose(0.8))).begun()
        self.accepted('reset')
        status, result = goal.wait()
        self.assertEqual((status, result.outcome), (GoalStatus.ABORTED, MOVE.FAILED))
        request = srv.AddClampRequest(name='guest', pose=pose(0.0, 0.6, 0.8))
        self.assertTrue(self.call['add_clamp'](request).success)
        client = self.client('guest', 'move', msg.MoveClampAction)
        goal = Goal(client, move(pose(0.0, 0.9, 0.8))).begun()
        self.accepted('step', 1)
        self.accepted('remove_clamp', 'guest')
        status, result = goal.wait()
        self.assertEqual((status, result.outcome), (GoalStatus.ABORTED, MOVE.FAILED))
        self.assertIn('removed', result.message)
        self.assertNotIn('guest', [clamp.name for clamp in self.state().clamps])

    def test_the_target_in_an_obstacle_is_told_once(self):
        with node_log() as log:
            self.accepted('set_clamp_pose', 'empty', pose(0.6, 0.0, 0.0))
            log.wait(lambda entry: "obstacle 'table'" in entry.msg)
            self.accepted('set_clamp_pose', 'empty', pose(0.6, 0.0, 0.01))
            self.accepted('set_clamp_pose', 'hand', pose(0.6, 0.0, 0.01))
            log.wait(lambda entry: "'hand' is told to go into obstacle" in entry.msg)
            told = [entry.msg for entry in log.messages if 'obstacle' in entry.msg]
            self.assertEqual(len(told), 2, told)

    # ---- trajectory ------------------------------------------------------------------------------

    def test_trajectory(self):
        publisher = connected('/cloth/clamps/empty/trajectory', MultiDOFJointTrajectory)
        publisher.publish(trajectory((1.0, 0.8, 0.0, 0.8), (2.0, 0.8, 0.2, 0.8)))

        def moved():
            self.accepted('step', 1)
            return self.clamp('empty').pose.position.x > 0.601
        wait_until(moved, 'the clamp to go')
        start = self.state().time
        wait_until(lambda: self.accepted('step', 10) and
                   self.clamp('empty').pose.position.y > 0.199, 'the clamp to arrive')
        self.assertAlmostEqual(self.state().time - start, 2.0, delta=0.25)

        publisher.publish(trajectory((3.0, 0.8, -1.0, 0.8)))
        wait_until(lambda: self.accepted('step', 1) and
                   self.clamp('empty').pose.position.y < 0.19, 'the clamp to go')
        publisher.publish(trajectory())  # stops it

        def stands():
            self.accepted('step', 10)
            y = self.clamp('empty').pose.position.y
            self.accepted('step', 10)
            return self.clamp('empty').pose.position.y == y
        wait_until(stands, 'the clamp to stop')
        self.assertGreater(self.clamp('empty').pose.position.y, -0.9)

    def test_bad_trajectories_change_nothing(self):
        publisher = connected('/cloth/clamps/empty/trajectory', MultiDOFJointTrajectory)
        two = trajectory((1.0, 0.8, 0.0, 0.8))
        two.points[0].transforms *= 2
        names = trajectory((1.0, 0.8, 0.0, 0.8))
        names.joint_names = ['a', 'b']
        bad = {'transforms': two, 'joint_names': names,
               'times_from_start[1]': trajectory((1.0, 0.7, 0, 0.8), (0.5, 0.8, 0, 0.8)),
               'poses[0]': trajectory((1.0, NAN, 0.0, 0.8)),
               'nowhere': trajectory((1.0, 0.7, 0.0, 0.8), frame='nowhere'),
               "clamp's 0.5 m/s": trajectory((0.1, 2.0, 0.0, 0.8))}
        before = self.clamp('empty').pose
        with node_log() as log:
            for says, message in bad.items():
                publisher.publish(message)
                log.wait(lambda entry: 'trajectory: refused: ' in entry.msg and says in entry.msg)
        self.accepted('step', 10)
        self.assertEqual(self.clamp('empty').pose, before)


if __name__ == '__main__':
    rospy.init_node('clamp_actions_test')
    rostest.rosrun('cloth_sim', 'clamp_actions', ClampActionsTest)
