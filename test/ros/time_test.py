#!/usr/bin/python3
"""Simulated time: /clock, its pace, steps, and actions that run until something has happened."""
import os
import sys
import threading
import time

import rospy
import rostest
from actionlib import ActionClient, CommState, GoalStatus
from geometry_msgs.msg import PoseStamped
from rosgraph_msgs.msg import Clock

from cloth_sim import msg, srv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import Listener, wait_until  # noqa: E402
from services import ServiceTest  # noqa: E402

SERVICES = dict(set_clamp_pose=srv.SetClampPose, set_phase=srv.StartPhase, pause=srv.Pause,
                step=srv.Step, reset=srv.ResetScene, get_state=srv.GetState,
                set_real_time_factor=srv.SetRealTimeFactor)
DT = 1.0 / 60.0


class Goal:
    """A goal of an action, waited for by the wall's clock."""

    def __init__(self, client, goal):
        self.feedback = []
        self.handle = client.send_goal(goal, feedback_cb=lambda _, message:
                                       self.feedback.append(message))

    def wait(self):
        wait_until(lambda: self.handle.get_comm_state() == CommState.DONE, 'the end of a goal')
        return self.handle.get_goal_status(), self.handle.get_result()


class TimeTest(ServiceTest):
    SERVICES = SERVICES
    DEADLINE = None  # it would be one of simulated time

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_for = cls.action('run_for', msg.RunForAction)
        cls.run_to_phase = cls.action('run_to_phase', msg.RunToPhaseAction)

    @staticmethod
    def action(name, kind):
        """A client; its own way of waiting would sleep by /clock, which stands still."""
        client = ActionClient('/cloth/' + name, kind)
        wait_until(lambda: client.pub_goal.get_num_connections() > 0 and
                   client.last_status_msg is not None, 'action ' + name)
        return client

    def setUp(self):
        self.accepted('pause', True)
        self.accepted('set_real_time_factor', 0.0)
        self.accepted('reset')

    @staticmethod
    def since_start(clock):
        """Times since the last reset: earlier ones may still have been under way."""
        times = [c.clock.to_nsec() for c in clock.messages]
        return times[len(times) - 1 - times[::-1].index(1):]

    def assertIsSorted(self, times):
        self.assertEqual(times, sorted(times))
        self.assertGreater(len(times), 2)

    # ---- clock -----------------------------------------------------------------------------------

    def test_clock_is_simulated_time(self):
        with Listener('/clock', Clock) as clock:
            self.accepted('reset')
            clock.wait(lambda c: c.clock.to_nsec() == 1)  # not 0, which means "none"
            self.accepted('step', 120)
            clock.wait(lambda c: abs(c.clock.to_sec() - 2.0) < 1e-6)
            self.assertIsSorted(self.since_start(clock))
        with Listener('/clock', Clock) as clock:
            # Latched, though time stands still.
            self.assertAlmostEqual(clock.wait().clock.to_sec(), 2.0, places=6)
        wait_until(lambda: abs(rospy.get_time() - 2.0) < 1e-6, 'our own time')

    def test_time_goes_back_only_when_asked(self):
        with Listener('/clock', Clock) as clock:
            self.accepted('reset')
            clock.wait(lambda c: c.clock.to_nsec() == 1)
            self.accepted('step', 30)
            self.accepted('reset', srv.ResetSceneRequest.STATE)
            self.accepted('step', 30)
            clock.wait(lambda c: abs(c.clock.to_sec() - 60 * DT) < 1e-6)
            self.assertIsSorted(self.since_start(clock))
            self.accepted('reset', srv.ResetSceneRequest.TIME)
            wait_until(lambda: clock.messages[-1].clock.to_nsec() == 1, 'time 0')

    def test_stamps_are_simulated_time(self):
        with Listener('/cloth/state', msg.ClothState) as states:
            self.accepted('step', 60)
            state = states.wait(lambda s: s.step == 60)
            self.assertAlmostEqual(state.header.stamp.to_sec(), state.time, places=6)

    def test_a_missing_frame_does_not_hold_the_node_while_time_stands_still(self):
        pose = PoseStamped()
        pose.header.frame_id = 'nowhere'
        pose.pose.orientation.w = 1.0
        start = time.monotonic()
        reply = self.call['set_clamp_pose']('left', pose)
        self.assertFalse(reply.success)
        self.assertIn('nowhere', reply.message)
        self.assertLess(time.monotonic() - start, 10.0)
        self.accepted('step', 1)

    # ---- pace ------------------------------------------------------------------------------------

    def test_pace(self):
        for bad in (-1.0, 1e-4, 1e4, float('nan')):
            reply = self.call['set_real_time_factor'](bad)
            self.assertFalse(reply.success)
            self.assertIn('real-time factor', reply.message)
        self.accepted('set_real_time_factor', 0.1)
        self.accepted('pause', False)
        start, began = time.monotonic(), self.state().time
        wait_until(lambda: self.state().time > began + 0.1, 'time')
        # 0.1 s of simulated time take 1 s, less what was under way.
        self.assertGreater(time.monotonic() - start, 0.6)
        self.accepted('set_real_time_factor', 0.001)  # a step takes 17 s now
        self.accepted('set_real_time_factor', 0.0)    # unless this wakes it up
        began = self.state().time
        wait_until(lambda: self.state().time > began + 1.0, 'time', deadline=15.0)

    def test_commands_are_carried_out_between_slow_steps(self):
        self.accepted('set_real_time_factor', 0.001)
        self.accepted('pause', False)
        start = time.monotonic()
        self.accepted('set_phase', 'notch')
        self.accepted('pause', True)
        self.assertLess(time.monotonic() - start, 5.0)
        self.assertGreater(self.state().broken.total, 0)

    def test_two_clients_pause_and_step_at_once(self):
        made, failures = [], []

        def client(steps):
            step = rospy.ServiceProxy('/cloth/step', srv.Step, persistent=True)
            pause = rospy.ServiceProxy('/cloth/pause', srv.Pause, persistent=True)
            for _ in range(20):
                reply = step(steps)
                (made if reply.success else failures).append(steps)
                pause(True)
        threads = [threading.Thread(target=client, args=(steps,)) for steps in (3, 5)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60.0)
        self.assertEqual(failures, [])
        self.assertEqual(self.state().step, sum(made))
        self.assertEqual(sum(made), 20 * 8)

    # ---- actions ---------------------------------------------------------------------------------

    def test_run_for(self):
        self.accepted('set_real_time_factor', 1.0)  # slow enough for feedback
        goal = Goal(self.run_for, msg.RunForGoal(duration=1.0))
        status, result = goal.wait()
        self.assertEqual(status, GoalStatus.SUCCEEDED)
        self.assertTrue(result.success)
        self.assertEqual(result.step, 60)
        self.assertAlmostEqual(result.time, 1.0)
        state = self.state()
        self.assertTrue(state.paused)
        self.assertEqual((state.step, state.state_hash), (60, result.state_hash))
        self.assertGreater(len(goal.feedback), 2)
        for feedback in goal.feedback:
            self.assertAlmostEqual(feedback.time + feedback.remaining, 1.0)

    def test_run_to_phase(self):
        result = Goal(self.run_to_phase, msg.RunToPhaseGoal(phase='notch')).wait()[1]
        self.assertTrue(result.success, result.message)
        state = self.state()
        self.assertEqual((state.phase, state.paused, state.step), ('notch', True, result.step))
        history = self.call['get_state']().history
        self.assertAlmostEqual(history[-1].start, state.time - DT)  # stopped in its first step
        again = Goal(self.run_to_phase, msg.RunToPhaseGoal(phase='notch')).wait()[1]
        self.assertEqual((again.success, again.step), (True, result.step))

    def test_a_phase_that_does_not_come(self):
        self.accepted('set_phase', 'stop')
        self.accepted('step', 40)
        status, result = Goal(self.run_to_phase, msg.RunToPhaseGoal(phase='wait')).wait()
        self.assertEqual(status, GoalStatus.ABORTED)
        self.assertIn('ended', result.message)
        self.assertTrue(self.state().paused)

    def test_a_phase_that_is_past(self):
        self.accepted('set_phase', 'notch')
        step = self.state().step
        status, result = Goal(self.run_to_phase, msg.RunToPhaseGoal(phase='wait')).wait()
        self.assertEqual(status, GoalStatus.ABORTED)
        self.assertIn("phase 'wait' is past, the script is in 'notch'", result.message)
        self.assertEqual((result.step, self.state().step), (step, step))
        self.assertTrue(self.state().paused)

    def test_cancelling_pauses(self):
        goal = Goal(self.run_for, msg.RunForGoal(duration=1e5))
        wait_until(lambda: self.state().step > 5, 'steps')
        goal.handle.cancel()
        status, result = goal.wait()
        self.assertEqual(status, GoalStatus.PREEMPTED)
        self.assertFalse(result.success)
        self.assertTrue(self.state().paused)
        self.assertEqual(self.state().step, result.step)

    def test_the_newest_goal_counts(self):
        old = Goal(self.run_for, msg.RunForGoal(duration=1e5))
        wait_until(lambda: self.state().step > 0, 'steps')
        new = Goal(self.run_for, msg.RunForGoal(duration=0.5))
        self.assertEqual(old.wait()[0], GoalStatus.PREEMPTED)
        self.assertEqual(new.wait()[0], GoalStatus.SUCCEEDED)

    def test_a_reset_aborts(self):
        goal = Goal(self.run_for, msg.RunForGoal(duration=1e5))
        wait_until(lambda: self.state().step > 0, 'steps')
        self.accepted('reset')
        status, result = goal.wait()
        self.assertEqual(status, GoalStatus.ABORTED)
        self.assertIn('reset', result.message)

    def test_bad_goals_are_rejected(self):
        for bad in (0.0, -1.0, float('nan'), 1e7):
            status, result = Goal(self.run_for, msg.RunForGoal(duration=bad)).wait()
            self.assertEqual(status, GoalStatus.REJECTED)
            self.assertIn('duration', result.message)
        status, result = Goal(self.run_to_phase, msg.RunToPhaseGoal(phase='nothing')).wait()
        self.assertEqual(status, GoalStatus.REJECTED)
        self.assertIn("unknown phase 'nothing'", result.message)
        self.assertEqual(self.state().step, 0)


if __name__ == '__main__':
    rospy.init_node('time_test')
    rostest.rosrun('cloth_sim', 'time', TimeTest)
