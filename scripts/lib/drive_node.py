#!/usr/bin/python3
"""Drives a node for a long time, for scripts/nightly.sh. Starts a master and a node of its own on
the loopback. The last line of the output says what was seen; the exit status is 0 if all was well.

soak:    one client cuts, tears, saves, loads, refines and resets the cloth again and again. The
         resident memory of the node, at the same place of every round, must stay flat to 1 % after
         the first fifth of the time.
clients: two clients send requests and goals from fixed seeds, good and bad, at the same time. The
         node must answer every one, and stay finite.
"""
import argparse
import math
import os
import random
import socket
import subprocess
import sys
import tempfile
import threading
import time

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from cloth_sim import msg, srv
from geometry_msgs.msg import Point, PoseStamped, Quaternion, Vector3
from std_msgs.msg import Header

FLAT = 0.01       # allowed growth of the memory [-]
PATIENCE = 30.0   # for an answer [s]
ANSWERED = (GoalStatus.PREEMPTED, GoalStatus.SUCCEEDED, GoalStatus.ABORTED, GoalStatus.REJECTED,
            GoalStatus.RECALLED)


def free_port():
    with socket.socket() as it:
        it.bind(('127.0.0.1', 0))
        return it.getsockname()[1]


def start_node(folder):
    """Returns the processes of a master and of a node, which is /cloth."""
    os.environ['ROS_MASTER_URI'] = 'http://127.0.0.1:%d' % free_port()
    os.environ['ROS_IP'] = '127.0.0.1'
    port = os.environ['ROS_MASTER_URI'].rsplit(':', 1)[1]
    with open(os.path.join(folder, 'node.log'), 'w') as log:
        master = subprocess.Popen(['rosmaster', '--core', '-p', port], stdout=log, stderr=log)
        node_program = subprocess.check_output(
            ['catkin_find', '--first-only', '--libexec', 'cloth_sim', 'cloth_node'], text=True)
        here = os.path.dirname(os.path.abspath(__file__))
        scene = os.path.join(here, os.pardir, os.pardir, 'test', 'ros', 'bench.yaml')
        time.sleep(2.0)  # the node waits for the master, too
        node = subprocess.Popen(
            [node_program.strip(), '__name:=cloth', '_scene:=' + scene, '_paused:=true',
             '_real_time_factor:=0.0', '_threads:=1', '_state_directory:=' + folder],
            stdout=log, stderr=log)
    return master, node


def resident(pid):
    """Memory that a process holds [bytes]."""
    with open('/proc/%d/statm' % pid) as file:
        return int(file.read().split()[1]) * os.sysconf('SC_PAGE_SIZE')


class Services:
    """Connections to all services that this needs."""

    def __init__(self):
        self.proxies = {}
        for name, kind in (('cut', srv.Cut), ('grasp', srv.Grasp), ('refine', srv.Refine),
                           ('reset', srv.ResetScene), ('set_clamp_pose', srv.SetClampPose),
                           ('set_phase', srv.StartPhase), ('step', srv.Step), ('pause', srv.Pause),
                           ('save_state', srv.SaveState), ('load_state', srv.LoadState),
                           ('get_state', srv.GetState), ('add_clamp', srv.AddClamp),
                           ('remove_clamp', srv.RemoveClamp)):
            rospy.wait_for_service('/cloth/' + name, PATIENCE)
            self.proxies[name] = rospy.ServiceProxy('/cloth/' + name, kind, persistent=True)

    def call(self, service, **fields):
        request = getattr(srv, self.proxies[service].service_class.__name__ + 'Request')()
        for name, value in fields.items():
            setattr(request, name, value)
        return self.proxies[service](request)


def stroke(points, direction=(0.0, 0.0, -1.0), reach=1.0):
    return msg.CutStroke(header=Header(frame_id='world'), points=[Point(*p) for p in points],
                         direction=Vector3(*direction), reach=reach)


def pose(position, orientation=(0.0, 0.0, 0.0, 1.0), frame='world'):
    message = PoseStamped()
    message.header.frame_id = frame
    message.pose.position = Point(*position)
    message.pose.orientation = Quaternion(*orientation)
    return message


def must(reply):
    if not reply.success:
        raise AssertionError('refused: ' + reply.message)
    return reply


def finite(state):
    return all(math.isfinite(v) for v in (state.max_strain, state.time))


def soak(services, node, seconds):
    """\\return what was seen, and whether all was well."""
    end, rounds, memory = time.time() + seconds, 0, []
    began = time.time()
    while time.time() < end:
        must(services.call('reset'))
        must(services.call('grasp', clamp='left', grasp=True))
        must(services.call('step', steps=10))
        must(services.call('set_phase', phase='notch'))
        must(services.call('cut', stroke=stroke([(-0.3, 0.05, 0.5), (0.0, 0.08, 0.5)])))
        must(services.call('set_clamp_pose', clamp='left', pose=pose((-0.4, 0.0, 0.8))))
        must(services.call('step', steps=30))
        must(services.call('save_state', name='soak'))
        must(services.call('step', steps=10))
        must(services.call('load_state', name='soak'))
        must(services.call('step', steps=10))
        if not finite(must(services.call('get_state')).state):
            return 'not finite after %d rounds' % rounds, False
        rounds += 1
        if time.time() - began > 0.2 * seconds:
            memory.append(resident(node.pid))
    if len(memory) < 10:
        return 'only %d rounds' % rounds, False
    part = max(1, len(memory) // 5)
    growth = max(memory[-part:]) / max(memory[:part]) - 1.0
    text = '%d rounds; memory %.1f MiB, then %.1f MiB (%+.2f %%)' % (
        rounds, max(memory[:part]) / 2**20, max(memory[-part:]) / 2**20, 100.0 * growth)
    return text, growth <= FLAT


class Client(threading.Thread):
    """Sends requests and goals from a seed."""

    def __init__(self, seed, end):
        super().__init__()
        self.random = random.Random(seed)
        self.services = Services()
        self.end, self.asked, self.accepted, self.error = end, 0, 0, ''
        self.run_for = actionlib.SimpleActionClient('/cloth/run_for', msg.RunForAction)
        if not self.run_for.wait_for_server(rospy.Duration(PATIENCE)):
            raise AssertionError('no server of actions')

    def number(self):
        return self.random.choice([self.random.uniform(-0.5, 0.5)] * 12 +
                                  [math.nan, math.inf, 1e308, -1e9, 0.0])

    def point(self):
        return (self.number(), self.number(), self.number())

    def name(self, known):
        return self.random.choice(known * 4 + ['', 'nobody', 'a/b', '\x07', 'x' * 5000])

    def goal(self):
        """Runs for a time; may be cancelled, or replaced by the other client's. A pause of the
        other client makes it wait, so that it is cancelled in the end."""
        goal = msg.RunForGoal(duration=self.random.choice([0.05, 0.2, 0.0, -1.0, math.nan]))
        self.run_for.send_goal(goal)
        if self.random.random() < 0.5:
            self.run_for.cancel_goal()
        if self.is_answered(2.0):
            return
        self.run_for.cancel_goal()
        if not self.is_answered(PATIENCE):
            raise AssertionError('a goal of %g s was not answered, state %d' %
                                 (goal.duration, self.run_for.get_state()))

    def is_answered(self, patience):
        """Python's actionlib may miss the end, but not the state, of a goal of two clients."""
        return (self.run_for.wait_for_result(rospy.Duration(patience)) or
                self.run_for.get_state() in ANSWERED)

    def once(self):
        ask = self.services.call
        clamps = ['left', 'right', 'third']
        choice = self.random.randrange(13)
        if choice == 0:
            return ask('cut', stroke=stroke([self.point() for _ in range(self.random.randrange(5))],
                                            self.point(), self.number()))
        if choice == 1:
            return ask('grasp', clamp=self.name(clamps), grasp=self.random.random() < 0.5)
        if choice == 2:
            turn = self.random.choice([(0, 0, 0, 1), (0, 0, 0, 0), (math.nan, 0, 0, 1)])
            return ask('set_clamp_pose', clamp=self.name(clamps),
                       pose=pose(self.point(), turn, self.name(['world'])))
        if choice == 3:
            return ask('set_phase', phase=self.name(['wait', 'notch', 'stop']))
        if choice == 4:
            return ask('step', steps=self.random.choice([0, 1, 5, 20]))
        if choice == 5:
            return ask('pause', paused=self.random.random() < 0.7)
        if choice == 6:
            return ask('save_state', name=self.name(['a', 'b']))
        if choice == 7:
            return ask('load_state', name=self.name(['a', 'b']))
        if choice == 8:
            return ask('reset', scope=self.random.randrange(5))
        if choice == 9:
            return ask('add_clamp', name=self.name(['third']), pose=pose(self.point()))
        if choice == 10:
            return ask('remove_clamp', clamp=self.name(['third']))
        if choice == 11:
            self.goal()
            return None
        return ask('get_state')

    def run(self):
        try:
            while time.time() < self.end:
                reply = self.once()
                self.asked += 1
                if reply is not None and reply.success:
                    self.accepted += 1
                elif reply is not None and '\n' in reply.message:
                    raise AssertionError('not one line: ' + reply.message)
        except Exception as error:  # whatever it is, it is the result
            self.error = '%s: %s' % (type(error).__name__, error)


def clients(services, node, seconds, seed):
    end = time.time() + seconds
    both = [Client(seed + k, end) for k in (0, 1)]
    for client in both:
        client.start()
    for client in both:
        client.join(seconds + 3 * PATIENCE)
    errors = [c.error for c in both if c.error] + ['no end' for c in both if c.is_alive()]
    if node.poll() is not None:
        errors.append('the node ended with status %d' % node.returncode)
    elif not errors and not finite(services.call('get_state').state):
        errors.append('not finite')
    text = '%d requests, %d accepted' % (sum(c.asked for c in both), sum(c.accepted for c in both))
    return text + ''.join('; ' + ' '.join(e.split())[:200] for e in errors), not errors


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('mode', choices=['soak', 'clients'])
    parser.add_argument('--minutes', type=float, default=60.0)
    parser.add_argument('--seed', type=int, default=1, help='of the first client')
    options = parser.parse_args()
    folder = tempfile.mkdtemp(prefix='cloth_sim_drive')
    master, node = start_node(folder)
    well = False
    try:
        rospy.init_node('drive', disable_signals=True)
        services = Services()
        if options.mode == 'soak':
            text, well = soak(services, node, 60.0 * options.minutes)
        else:
            text, well = clients(services, node, 60.0 * options.minutes, options.seed)
    except Exception as error:
        text = ' '.join(('%s: %s' % (type(error).__name__, error)).split())[:200]
    for process in (node, master):
        process.terminate()
        process.wait(PATIENCE)
    print('%s (log of the node: %s)' % (text, os.path.join(folder, 'node.log')))
    return 0 if well else 1


if __name__ == '__main__':
    code = main()
    sys.stdout.flush()
    os._exit(code)  # rospy's threads do not end by themselves
