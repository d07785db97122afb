"""A node of cloth_sim that belongs to a program, and the program's connection to it."""
import atexit
import functools
import itertools
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time

import numpy as np
import rosgraph
import rospy

from cloth_sim import frames, keeper, msg, srv
from geometry_msgs.msg import Point, PoseStamped, Quaternion

PATIENCE = 30.0  # for a program to come up, and for a message of what is done [s]
FRAME = 'world'
SERVICES = {'step': srv.Step, 'get_state': srv.GetState, 'set_clamp_pose': srv.SetClampPose,
            'grasp': srv.Grasp, 'cut': srv.Cut, 'save_state': srv.SaveState,
            'load_state': srv.LoadState}


class ClothError(RuntimeError):
    """A request that the node refuses, or a node that cannot be started; its text is one line."""


# ---- programs ------------------------------------------------------------------------------------


def find_program(name):
    """The path of a program of this package."""
    if shutil.which('catkin_find'):
        found = subprocess.run(['catkin_find', '--first-only', '--libexec', 'cloth_sim', name],
                               capture_output=True, text=True).stdout.strip()
        if found:
            return found
    raise ClothError('%s was not found: source devel/setup.bash' % name)


class Program:
    """A program that ends with this process at the latest."""

    def __init__(self, command, log):
        self._log = log
        if shutil.which(command[0]) is None:
            raise ClothError('%s: cannot be run' % command[0])
        with open(log, 'w') as file:
            # In a session of its own: a Ctrl-C in the terminal is for its owner.
            self._process = subprocess.Popen(
                [sys.executable, keeper.__file__, *command], stdin=subprocess.PIPE, stdout=file,
                stderr=file, start_new_session=True)

    def check(self):
        """Throws if it has ended, with the last line that it wrote."""
        if self._process.poll() is not None:
            with open(self._log, errors='replace') as file:
                lines = [line.strip() for line in file if line.strip()]
            raise ClothError(lines[-1] if lines else
                             'it ended with status %d' % self._process.returncode)

    def end(self):
        self._process.stdin.close()
        self._process.wait()


def free_port():
    with socket.socket() as it:
        it.bind(('127.0.0.1', 0))
        return it.getsockname()[1]


@functools.lru_cache(maxsize=None)
def join_ros():
    """Makes this process a node, once, as rospy keeps to one master: of the master that runs, or of
    one on a free port of the loopback, which ends with this process."""
    if not rosgraph.is_master_online():
        start_master()
    if not rospy.core.is_initialized():
        rospy.init_node('cloth_client', anonymous=True, disable_signals=True)


def start_master():
    folder = tempfile.mkdtemp(prefix='cloth_sim_master')
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    port = str(free_port())
    os.environ['ROS_MASTER_URI'] = 'http://127.0.0.1:' + port
    os.environ['ROS_IP'] = '127.0.0.1'
    os.environ.pop('ROS_HOSTNAME', None)  # ROS would prefer it
    master = Program(['rosmaster', '--core', '-p', port], os.path.join(folder, 'log'))
    atexit.register(end_master, master)
    wait_until(rosgraph.is_master_online, master, 'the ROS master')


def end_master(master):
    rospy.signal_shutdown('the program ends')  # while the master can still hear of it
    master.end()


def wait_until(holds, program, name):
    """Waits for a condition, while the program runs."""
    end = time.monotonic() + PATIENCE
    while not holds():
        program.check()
        if time.monotonic() > end:
            raise ClothError('%s did not answer in %g s' % (name, PATIENCE))
        time.sleep(0.01)


# ---- the node ------------------------------------------------------------------------------------


class Surface:
    """The cloth at one time.

    step: number of the simulated step
    points: positions [m], shape (n, 3)
    faces: vertices of the triangles, shape (m, 3)
    uv: material coordinates [m], shape (n, 2)
    torn: vertices of the edges that tearing and cutting made, shape (k, 2)
    revision: of the topology
    """

    def __init__(self, frame, topology):
        self.step, self.revision = frame.step, frame.revision
        self.points = frames.positions(frame)
        self.faces = np.array(topology.triangles, dtype=np.int64).reshape(-1, 3)
        self.uv = np.array(topology.uv, dtype=float).reshape(-1, 2)
        self.torn = np.array(topology.torn_edges, dtype=np.int64).reshape(-1, 2)


class Session:
    """A paused node of its own; time passes by `step` only."""

    _numbers = itertools.count()

    def __init__(self, scene, overrides=(), node=None, threads=1):
        """\\param scene file, or the name of one in config/scenes
        \\param overrides of the scene, each `dotted.key=value`
        \\param node path of cloth_node; None: of this workspace
        \\param threads of the simulation, on which results do not depend"""
        node = node or find_program('cloth_node')
        join_ros()
        self._name = '/cloth_env_%d_%d' % (os.getpid(), next(self._numbers))
        self._folder = tempfile.TemporaryDirectory(prefix='cloth_sim_env')
        self._changed = threading.Condition()
        self._frame, self._topologies = None, {}
        self._proxies, self._subscribers, self._program = {}, [], None
        try:
            self._start(node, scene, list(overrides), threads)
        except Exception:
            self.close()
            raise

    def _start(self, node, scene, overrides, threads):
        for key, value in (('scene', scene), ('set', overrides), ('paused', True),
                           ('real_time_factor', 0.0), ('threads', threads),
                           ('rate_frame', 1000.0), ('state_directory', self._folder.name)):
            rospy.set_param(self._name + '/' + key, value)
        for topic, kind, take in (('topology', msg.ClothTopology, self._take_topology),
                                  ('frame', msg.ClothFrame, self._take_frame)):
            self._subscribers.append(rospy.Subscriber(self._name + '/' + topic, kind, take,
                                                      tcp_nodelay=True))
        self._program = Program([node, '__name:=' + self._name[1:]],
                                os.path.join(self._folder.name, 'node.log'))
        last = self._name + '/get_state'
        wait_until(lambda: has_service(last), self._program, 'the node')
        for name, kind in SERVICES.items():
            rospy.wait_for_service(self._name + '/' + name, PATIENCE)
            self._proxies[name] = rospy.ServiceProxy(self._name + '/' + name, kind, persistent=True)

    def call(self, service, *arguments):
        """Calls a service of SERVICES, and returns its reply; throws if it is refused."""
        try:
            reply = self._proxies[service](*arguments)
        except (rospy.ServiceException, rospy.exceptions.TransportException) as error:
            self._program.check()
            raise ClothError('%s: %s' % (service, ' '.join(str(error).split()))) from error
        if not reply.success:
            raise ClothError('%s: %s' % (service, reply.message))
        return reply

    def step(self, count=1):
        """Makes a number of steps. Returns the number of all steps so far."""
        return self.call('step', count).step

    def state(self):
        """The cloth_sim/GetStateResponse: figures, names, and the length of a step."""
        return self.call('get_state')

    def move(self, clamp, position, orientation):
        """Sends a clamp to a pose, [m] and [x, y, z, w]; it goes there within its limits."""
        pose = PoseStamped()
        pose.header.frame_id = FRAME
        pose.pose.position, pose.pose.orientation = Point(*position), Quaternion(*orientation)
        self.call('set_clamp_pose', clamp, pose)

    def cut(self, path, direction, reach):
        """Draws a blade along a path [m], to `reach` [m] on both sides of it."""
        stroke = msg.CutStroke(points=[Point(*point) for point in path], reach=reach)
        stroke.header.frame_id = FRAME
        stroke.direction.x, stroke.direction.y, stroke.direction.z = direction
        self.call('cut', stroke)

    def surface(self, step):
        """The cloth after the step of this number."""
        end = time.monotonic() + PATIENCE
        with self._changed:
            while not self._has(step):
                self._program.check()
                if time.monotonic() > end:
                    raise ClothError('the node sent no frame of step %d in %g s' % (step, PATIENCE))
                self._changed.wait(0.2)
            return Surface(self._frame, self._topologies[self._frame.revision])

    def _has(self, step):
        return (self._frame is not None and self._frame.step == step and
                self._frame.revision in self._topologies)

    def _take_frame(self, message):
        with self._changed:
            self._frame = message
            self._changed.notify_all()

    def _take_topology(self, message):
        with self._changed:
            self._topologies = {**dict(list(self._topologies.items())[-3:]),
                                message.revision: message}
            self._changed.notify_all()

    def close(self):
        """Ends the node. A second call does nothing."""
        for proxy in self._proxies.values():
            proxy.close()
        for subscriber in self._subscribers:
            subscriber.unregister()
        self._proxies, self._subscribers = {}, []
        if self._program is not None:
            self._program.end()
            self._program = None
        if os.path.isdir(self._folder.name):
            self._folder.cleanup()
            if rospy.has_param(self._name):
                rospy.delete_param(self._name)


def has_service(service):
    """Whether a node has registered a service."""
    try:
        return bool(rosgraph.Master('/cloth_env').lookupService(service))
    except rosgraph.MasterError:
        return False
