#!/usr/bin/python3
"""A recorded run: every command is in the bag, in parts too, and cloth_run comes to the same hashes."""
import glob
import os
import signal
import subprocess
import sys
import tempfile

import rosbag
import rospy
import rostest
from actionlib import GoalStatus, SimpleActionClient
from geometry_msgs.msg import Point, PoseStamped, Vector3
from std_msgs.msg import Bool

from cloth_sim import msg, srv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import Listener, connected, wait_until  # noqa: E402
from services import ServiceTest, connections  # noqa: E402

SERVICES = dict(set_clamp_pose=srv.SetClampPose, grasp=srv.Grasp, cut=srv.Cut, refine=srv.Refine,
                set_phase=srv.StartPhase, pause=srv.Pause, step=srv.Step, reset=srv.ResetScene,
                save_state=srv.SaveState, load_state=srv.LoadState, get_state=srv.GetState,
                set_real_time_factor=srv.SetRealTimeFactor)
CLOTH_RUN = subprocess.check_output(
    ['catkin_find', '--first-only', '--libexec', 'cloth_sim', 'cloth_run'], text=True).strip()


class Recording:
    """rosbag record, connected to every topic before it is used."""

    TOPICS = ('scene', 'commands', 'topology', 'frame', 'state', 'tear_events', 'broken_springs',
              'phase')

    def __init__(self, path, *arguments):
        topics = ['/cloth/' + name for name in self.TOPICS]
        self.process = subprocess.Popen(['rosbag', 'record', '--buffsize=1024', '-O', path,
                                         *arguments, *topics, '__name:=recorder'],
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        wait_until(lambda: self.listens_to() >= set(topics), 'rosbag record')

    @staticmethod
    def listens_to():
        """Topics over which the node has a connection to the recorder."""
        return {topic for _, topic, other in connections() if other == '/recorder'}

    def stop(self):
        self.process.send_signal(signal.SIGINT)
        return self.process.communicate(timeout=30)[0]


def replay(bag):
    return subprocess.run([CLOTH_RUN, '--replay', bag], capture_output=True, text=True, timeout=120)


class BagTest(ServiceTest):
    SERVICES = SERVICES

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def stroke(self):
        message = msg.CutStroke()
        message.header.frame_id = 'world'
        message.points = [Point(-0.1, 0.013, 0.5), Point(0.1, 0.017, 0.5)]
        message.direction = Vector3(0, 0, -1)
        return message

    def move_and_step(self, steps):
        """A goal that ends within these steps: two ways of 0.2 s."""
        goal = msg.MoveClampGoal(times_from_start=[rospy.Duration(0.2), rospy.Duration(0.4)])
        for x in (0.2, 0.15):
            pose = PoseStamped()
            pose.header.frame_id = 'world'
            pose.pose.position = Point(x, -0.15, 0.6)
            pose.pose.orientation.w = 1.0
            goal.poses.append(pose)
        client = SimpleActionClient('/cloth/clamps/right/move', msg.MoveClampAction)
        self.assertTrue(client.wait_for_server(rospy.Duration(20.0)))
        client.send_goal(goal)
        wait_until(lambda: client.get_state() == GoalStatus.ACTIVE, 'the goal to begin')
        self.accepted('step', steps)
        self.assertTrue(client.wait_for_result(rospy.Duration(20.0)))
        self.assertEqual(client.get_state(), GoalStatus.SUCCEEDED)

    def test_a_commanded_run_is_done_again_to_the_bit(self):
        """One test: numbers of commands run from the start of the node on."""
        bag = os.path.join(self.folder.name, 'run.bag')
        recording = Recording(bag)
        states = Listener('/cloth/state', msg.ClothState)
        self.accepted('set_real_time_factor', 0.0)
        self.accepted('grasp', 'left', True)
        self.accepted('pause', False)  # commands come whenever they come
        wait_until(lambda: self.state().step > 20, 'steps')
        self.accepted('set_phase', 'notch')
        self.accepted('cut', self.stroke())
        grasp = connected('/cloth/clamps/right/grasp', Bool)
        grasp.publish(True)
        wait_until(lambda: any(c.state != msg.ClampStatus.OPEN for c in self.state().clamps
                               if c.name == 'right'), 'the clamp')
        refused = self.call['set_phase']('nothing')
        self.assertFalse(refused.success)
        self.accepted('refine', self.stroke().header, self.stroke().points, 0.05, 2, 0.0)
        self.accepted('reset', srv.ResetSceneRequest.STATE)
        self.accepted('step', 20)
        self.accepted('save_state', 'bag_test')
        self.accepted('step', 5)
        self.accepted('load_state', 'bag_test')
        self.accepted('reset', srv.ResetSceneRequest.TIME)
        self.accepted('cut', self.stroke())
        self.move_and_step(30)
        end = self.state()
        # The state is sent once a second while nothing changes: with the second, the first came.
        wait_until(lambda: sum(s.state_hash == end.state_hash for s in states.messages) > 1,
                   'the last state')
        recording.stop()

        with rosbag.Bag(bag) as opened:
            commands = [m for _, m, _ in opened.read_messages(['/cloth/commands'])]
            last = [m for _, m, _ in opened.read_messages(['/cloth/state'])][-1]
        self.assertEqual([command.kind for command in commands],
                         ['set_grasp', 'set_phase', 'cut_along', 'set_grasp', 'refine_near',
                          'reset', 'restore', 'reset', 'cut_along',
                          'guide_clamp', 'guide_clamp', 'set_clamp_target'])
        self.assertEqual([command.number for command in commands], list(range(12)))
        self.assertEqual(commands[1].text, 'notch')
        self.assertEqual(last.state_hash, end.state_hash)
        result = replay(bag)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(end.state_hash, result.stderr.splitlines()[-1])

        lost = os.path.join(self.folder.name, 'lost.bag')
        with rosbag.Bag(bag) as source, rosbag.Bag(lost, 'w') as target:
            for topic, message, stamp in source.read_messages():
                if not (topic == '/cloth/commands' and message.number == 2):
                    target.write(topic, message, stamp)
        result = replay(lost)
        self.assertEqual(result.returncode, 2)
        self.assertIn('command 2 is missing', result.stderr)

    def test_parts_of_a_split_bag_are_whole(self):
        recording = Recording(os.path.join(self.folder.name, 'part'), '--split', '--duration=7')
        wait_until(lambda: len(glob.glob(os.path.join(self.folder.name, 'part_*'))) >= 3,
                   'three parts', deadline=60.0)
        recording.stop()
        parts = sorted(glob.glob(os.path.join(self.folder.name, 'part_*.bag')))
        for part in parts[:2]:  # the last one may be as short as it likes
            with rosbag.Bag(part) as opened:
                counts = opened.get_type_and_topic_info().topics
                for topic in ('scene', 'topology', 'phase', 'broken_springs', 'frame', 'state'):
                    self.assertIn('/cloth/' + topic, counts, part)


if __name__ == '__main__':
    rospy.init_node('bag_test')
    rostest.rosrun('cloth_sim', 'bag', BagTest)
