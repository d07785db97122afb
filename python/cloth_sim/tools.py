"""Tools that actions move: clamps, whose targets follow velocities, and a blade."""
import numpy as np

from cloth_sim import rotations

SPEED = 0.4  # largest speed along each axis [m/s]
TURN = 4.0   # largest angular speed about each axis [rad/s]


class Clamp:
    """A clamp of the node. Its action: velocity [m/s] along x y z and angular velocity [rad/s]
    about x y z of the world, and the grip: above 0 closed, else open."""

    low = np.array([-SPEED] * 3 + [-TURN] * 3 + [-1.0])
    high = -low

    def __init__(self, session, status):
        self._session, self._name = session, status.name
        self._closed = status.state != status.OPEN
        here, turn = status.pose.position, status.pose.orientation
        self._position = np.array([here.x, here.y, here.z])
        self._turn = np.array([turn.x, turn.y, turn.z, turn.w])

    def begin(self, action):
        if (action[6] > 0) != self._closed:
            self._closed = not self._closed
            self._session.call('grasp', self._name, self._closed)

    def advance(self, action, dt):
        """Moves the target on by a step of length dt [s]."""
        if not np.any(action[:6]):
            return
        self._position = self._position + action[:3] * dt
        self._turn = rotations.product(rotations.from_vector(action[3:6] * dt), self._turn)
        self._session.move(self._name, self._position, self._turn)

    def observed(self, state):
        """Position [m], orientation [x, y, z, w], gap [m], whether it holds cloth (1 or 0), and the
        force of the cloth on it in its axes [N]: 12 numbers."""
        status = next(clamp for clamp in state.clamps if clamp.name == self._name)
        here, turn, force = status.pose.position, status.pose.orientation, status.wrench.force
        return [here.x, here.y, here.z, turn.x, turn.y, turn.z, turn.w, status.gap,
                float(status.held > 0), force.x, force.y, force.z]


class Blade:
    """A blade that cuts along its way while it is pressed down. Its action: velocity [m/s] along
    x y z of the world, and the pressure: above 0 down, else up."""

    low = np.array([-SPEED] * 3 + [-1.0])
    high = -low
    DIRECTION = (0.0, 0.0, -1.0)
    REACH = 0.02  # above and below its place [m]

    def __init__(self, session, home):
        self._session, self._position = session, np.array(home, dtype=float)

    def begin(self, action):
        pass

    def advance(self, action, dt):
        before, self._position = self._position, self._position + action[:3] * dt
        if action[3] > 0 and np.any(action[:2]):
            self._session.cut((before, self._position), self.DIRECTION, self.REACH)

    def observed(self, _):
        """Position [m]: 3 numbers."""
        return list(self._position)
