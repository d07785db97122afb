"""The definition of a task."""
import numpy as np

from cloth_sim import measures

AT_REST = 0.02  # mean speed below which the cloth is at rest [m/s]


class Task:
    """A scene, its start states, what is measured, and a scripted policy.

    name: letters and `_`
    env_id: name in Gymnasium's registry
    summary: one line
    number: of the task among all; start states of one seed differ between tasks
    scene: file in python/cloth_sim/scenes
    size: of the cloth [m]
    grid: columns and rows of the material places that are observed
    clamps: names of the clamps that actions move
    blade: where the blade starts [m]; None: there is no blade
    time_limit: of an episode, in simulated time [s]
    settle: simulated time before the start state [s]
    room: two corners of the box that images show [m]
    view: azimuth and elevation of the eye in images [deg]
    """

    name = env_id = summary = scene = ''
    number = 0
    size = 0.0, 0.0
    grid = 7, 5
    clamps = ()
    blade = None
    time_limit = 15.0
    settle = 0.1
    room = (-0.3, -0.25, 0.0), (0.3, 0.25, 0.15)
    view = -62, 35

    def __init__(self):
        u, v = (np.linspace(0, length, count) for length, count in zip(self.size, self.grid))
        self.places = np.stack(np.meshgrid(u, v, indexing='ij'), axis=-1).reshape(-1, 2)
        self._samples = {}

    # ---- what a task says ------------------------------------------------------------------------

    def start(self, random):
        """Overrides of the scene, by the random numbers of a seed."""
        return []

    def prepare(self, script, random):
        """A plan that brings the cloth into its start state."""
        return iter(())

    def measures(self, surface, state):
        """{'coverage': area reached over area wanted, 'edge_error_m': ...}"""
        raise NotImplementedError

    def score(self, measured):
        """How much of the task is done, in [0, 1]."""
        raise NotImplementedError

    def success(self, measured, state):
        """Whether the task is done; `measured` also has `peak_force_n`, so far [N]."""
        raise NotImplementedError

    def plan(self, script):
        """The plan of the scripted policy."""
        raise NotImplementedError

    # ---- what tasks share ------------------------------------------------------------------------

    def vertices(self, name, places, surface):
        """The vertices nearest to material places; `name` tells the lists of places apart."""
        found = self._samples.get(name)
        if found is None or found[0] != surface.revision:
            found = surface.revision, measures.near(surface, places)
            self._samples[name] = found
        return found[1]

    def samples(self, surface):
        """The vertices at the observed places."""
        return self.vertices('observed', self.places, surface)

    def border_places(self, spacing=0.01):
        """Material places along the border, corners included, shape (n, 2)."""
        (w, h), places = self.size, []
        for a, b in (((0, 0), (w, 0)), ((w, 0), (w, h)), ((w, h), (0, h)), ((0, h), (0, 0))):
            way = np.subtract(b, a)
            count = max(1, round(float(np.linalg.norm(way)) / spacing))
            places += [a + way * k / count for k in range(count)]
        return np.array(places)


def is_let_go(state):
    """Whether no clamp holds cloth, and the cloth is at rest."""
    return all(clamp.held == 0 and clamp.state == clamp.OPEN for clamp in state.clamps) and \
        state.mean_speed < AT_REST


def random_pose(random, shift, turn, at=(0.0, 0.0, 0.001)):
    """An override that moves the cloth by up to `shift` [m] along x and y and turns it about z by
    up to `turn` [rad]."""
    x, y = random.uniform(-shift, shift, 2)
    return 'cloth.pose={position: [%.6f, %.6f, %.6f], rpy: [0.0, 0.0, %.6f]}' % (
        at[0] + x, at[1] + y, at[2], random.uniform(-turn, turn))
