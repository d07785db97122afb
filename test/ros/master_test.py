#!/usr/bin/python3
"""The ROS master goes away, and comes back knowing nobody: the node goes on, is found again by
everybody, and ends cleanly with or without a master."""
import os
import signal
import socket
import subprocess
import sys
import unittest

import rosgraph
import rostest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
import polling  # noqa: E402

READER = '''
import rospy
from cloth_sim.msg import ClothFrame
rospy.init_node('reader', anonymous=True, disable_signals=True)
rospy.Subscriber('/cloth/frame', ClothFrame, lambda message: print(message.step, flush=True))
rospy.spin()
'''


def free_port():
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]


def wait_until(condition, what):
    """As polling.wait_until, where what does not answer yet is no failure."""
    def tried():
        try:
            return condition()
        except (OSError, rosgraph.MasterException):
            return None
    return polling.wait_until(tried, what)


class MasterTest(unittest.TestCase):
    def setUp(self):
        self.port = free_port()
        self.uri = 'http://127.0.0.1:%d' % self.port
        self.environment = {**os.environ, 'ROS_MASTER_URI': self.uri}
        self.master = rosgraph.Master('/master_test', master_uri=self.uri)
        self.start_master()
        program = subprocess.check_output(['catkin_find', '--first-only', '--libexec', 'cloth_sim',
                                           'cloth_node'], text=True).strip()
        self.node = self.start(program, '_scene:=' + os.path.join(HERE, 'bench.yaml'),
                               '_threads:=1')
        wait_until(lambda: self.known().get('/cloth/get_state'), 'the node')

    def start(self, *command, **options):
        process = subprocess.Popen(command, env=self.environment, **options)
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        process.kill()
        process.communicate()

    def start_master(self):
        self.process = self.start('rosmaster', '--core', '-p', str(self.port))
        wait_until(self.master.getPid, 'the master')

    def kill_master(self):
        self.process.kill()
        self.process.wait()

    def known(self):
        """What the master knows of the node: {topic or service: what it is to the node}."""
        kinds = ('publisher', 'subscriber', 'service')
        names = {}
        for kind, entries in zip(kinds, self.master.getSystemState()):
            for name, nodes in entries:
                if '/cloth' in nodes:
                    names.setdefault(name, set()).add(kind)
        return names

    def call(self, service, *arguments):
        """What rosservice says, as a client that knows only the master would get it."""
        result = subprocess.run(['rosservice', 'call', '/cloth/' + service, *arguments], text=True,
                                capture_output=True, env=self.environment, timeout=30)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('success: True', result.stdout)
        return result.stdout

    def test_it_is_found_again_by_everybody(self):
        reader = self.start(sys.executable, '-c', READER, stdout=subprocess.PIPE, text=True)
        self.assertTrue(reader.stdout.readline())
        before = self.known()
        self.assertIn('/cloth/frame', before)
        self.kill_master()
        steps = [int(reader.stdout.readline()) for _ in range(30)]
        self.assertEqual(steps, sorted(steps))  # who listened before, does
        self.assertIsNone(self.node.poll())
        self.start_master()
        self.assertEqual(self.known(), {})
        wait_until(lambda: set(self.known()) >= set(before), 'all names')
        self.assertEqual({name: self.known()[name] for name in before}, before)
        # Clients that come now are served: a service, a topic out of the node, a topic into it.
        self.call('step', '3')
        echo = subprocess.run(['rostopic', 'echo', '-n', '1', '/cloth/state/step'], text=True,
                              capture_output=True, env=self.environment, timeout=30)
        self.assertGreater(int(echo.stdout.split()[0]), 3, echo.stderr)
        publisher = self.start('rostopic', 'pub', '-r', '5', '/cloth/phase_command',
                               'std_msgs/String', 'notch', stdout=subprocess.DEVNULL)
        wait_until(lambda: 'phase: "notch"' in self.call('get_state'), 'the phase')
        publisher.terminate()
        self.ends()

    def test_it_ends_cleanly_without_a_master(self):
        self.kill_master()
        self.ends()

    def ends(self):
        self.node.send_signal(signal.SIGINT)
        self.assertEqual(self.node.wait(20.0), 0)


if __name__ == '__main__':
    rostest.rosrun('cloth_sim', 'master', MasterTest)
