"""Cloth tasks as environments with Gymnasium's interface, over the services of a node."""
import os

import numpy as np
import yaml

from cloth_sim import drawing
from cloth_sim.script import Script
from cloth_sim.session import Session
from cloth_sim.spaces import Box, Env
from cloth_sim.tasks import TASKS, find_task
from cloth_sim.tools import Blade, Clamp

SCENES = os.path.join(os.path.dirname(os.path.realpath(__file__)), 'scenes')
PERIOD = 6       # simulated steps that an action lasts
SIZE = 480, 360  # of a rendered image [pixels]
START = 'start'  # name of the saved state in which episodes of a seed start


class ClothEnv(Env):
    """One task, on a node of its own.

    Actions are the velocities of the clamps and of the blade (tools.py) for PERIOD simulated steps;
    numbers beyond the bounds of `action_space` are clipped. Observations are, in float32:

    - the positions [m] of the points of the task's grid of material places, x y z each
    - of each clamp, 12 numbers: Clamp.observed
    - of the blade, 3: Blade.observed
    - the simulated time since the start of the episode [s]

    The reward is what an action adds to the score, which is in [0, 1]. An episode terminates with
    success, or when the simulation fails; it is truncated at the time limit of the task. `info` has
    the measures of the task. The same seed and the same actions give the same bits.
    """

    metadata = {'render_modes': ['rgb_array'], 'render_fps': 10}

    def __init__(self, task, render_mode=None, overrides=(), node=None, threads=1):
        """\\param task name of a task
        \\param render_mode None or 'rgb_array'
        \\param overrides of the scene, each `dotted.key=value`, in every episode
        \\param node path of cloth_node; None: of this workspace
        \\param threads of the simulation, on which results do not depend"""
        if render_mode not in (None, *self.metadata['render_modes']):
            raise ValueError("render_mode: expected None or 'rgb_array' (got %.40r)" %
                             (render_mode,))
        self.task, self.render_mode = find_task(task), render_mode
        self._overrides, self._node, self._threads = list(overrides), node, threads
        self._kinds = [Clamp] * len(self.task.clamps) + [Blade] * (self.task.blade is not None)
        low = np.concatenate([kind.low for kind in self._kinds]).astype(np.float32)
        high = np.concatenate([kind.high for kind in self._kinds]).astype(np.float32)
        self.action_space = Box(low, high, dtype=np.float32)
        count = 3 * len(self.task.places) + 12 * len(self.task.clamps) + 1
        count += 3 * (self.task.blade is not None)
        self.observation_space = Box(np.float32(-np.inf), np.float32(np.inf), (count,),
                                     dtype=np.float32)
        self._session, self._from, self._running = None, None, False
        self._camera = None

    # ---- Gymnasium's interface -------------------------------------------------------------------

    def reset(self, *, seed=None, options=None):
        """Starts an episode. Returns an observation and the measures.

        \\param seed of the start state, a whole number >= 0; None: the next random one
        \\param options {'set': list of overrides of the scene} or None"""
        extra = read_options(options)
        check_seed(seed)
        super().reset(seed=seed)
        if seed is None:
            seed = int(self.np_random.integers(2 ** 31))
        start = (int(seed), *extra)
        if self._from == start:
            self._running = False
            self._session.call('load_state', START)
        else:
            self._prepare(seed, extra)
            self._from = start
        self._begin()
        self._running = True
        return self._observation(), self._info()

    def step(self, action):
        """Advances by PERIOD simulated steps. Returns (observation, reward, terminated, truncated,
        info)."""
        action = self._checked(action)
        before = self._score
        parts = np.split(action, np.cumsum([len(kind.low) for kind in self._kinds])[:-1])
        for tool, part in zip(self._tools, parts):
            tool.begin(part)
        for _ in range(PERIOD):
            for tool, part in zip(self._tools, parts):
                tool.advance(part, self._dt)
            self._advance()
            if self._state.failed:
                break
        self._look()
        terminated = self._success or bool(self._state.failed)
        truncated = not terminated and self._time() > self.task.time_limit - 1e-9
        self._running = not (terminated or truncated)
        return (self._observation(), self._score - before, terminated, truncated, self._info())

    def render(self):
        """An image of the cloth, obstacles and clamps, shape (height, width, 3), uint8; None
        without a render mode."""
        if self.render_mode is None:
            return None
        if self._session is None:
            raise RuntimeError('render: there is no episode: call reset')
        if self._camera is None:
            box = np.stack(np.meshgrid(*zip(*self.task.room)), axis=-1).reshape(-1, 3)
            self._camera = drawing.Camera(box, *self.task.view, *SIZE)
        cloth = self._surface
        return drawing.image_of(self._camera, drawing.Scene(self._scene), self._state, cloth.points,
                                drawing.Topology(cloth.faces, cloth.uv, cloth.torn))

    def close(self):
        """Ends the node that the environment has started. A second call does nothing."""
        if self._session is not None:
            self._session.close()
        self._session, self._from, self._running = None, None, False

    # ---- for policies and tools ------------------------------------------------------------------

    @property
    def period(self):
        """Simulated time that an action lasts [s]."""
        return PERIOD * self._dt

    @property
    def surface(self):
        """The cloth, with all its vertices."""
        return self._surface

    # ---- an episode ------------------------------------------------------------------------------

    def _prepare(self, seed, extra):
        """Starts a node, brings the cloth into the start state of a seed, and saves that."""
        random = np.random.default_rng([seed, self.task.number])
        overrides = [*self.task.start(random), *self._overrides, *extra]
        scene = os.path.join(SCENES, self.task.scene)
        session = Session(scene, overrides, self._node, self._threads)
        self.close()  # the node of the episode before
        self._session = session
        with open(scene) as file:
            self._scene = yaml.safe_load(file)
        self._dt = self._session.state().dt
        self._begin()
        script = Script(self.task, self.period, lambda it: self.task.prepare(it, random))
        action = script.act(self._observation())
        while not script.done:
            self._running = True
            action = script.act(self.step(action)[0])
        self._session.step(round(self.task.settle / self._dt))
        self._session.call('save_state', START)

    def _begin(self):
        """Begins to measure at the present state."""
        reply = self._session.state()
        self._state = reply.state
        self._step = self._first = reply.state.step
        status = {clamp.name: clamp for clamp in reply.state.clamps}
        self._tools = [Clamp(self._session, status[name]) for name in self.task.clamps]
        if self.task.blade is not None:
            self._tools.append(Blade(self._session, self.task.blade))
        self._peak = 0.0
        self._look()

    def _advance(self):
        self._step = self._session.step()
        self._state = self._session.state().state
        for clamp in self._state.clamps:
            force = clamp.wrench.force
            self._peak = max(self._peak, float(np.linalg.norm([force.x, force.y, force.z])))

    def _look(self):
        self._surface = self._session.surface(self._step)
        self._measures = {**self.task.measures(self._surface, self._state),
                          'peak_force_n': self._peak}
        self._score = float(self.task.score(self._measures))
        self._success = bool(self.task.success(self._measures, self._state))

    def _time(self):
        return (self._step - self._first) * self._dt

    def _observation(self):
        samples = self._surface.points[self.task.samples(self._surface)].ravel()
        tools = [number for tool in self._tools for number in tool.observed(self._state)]
        return np.concatenate([samples, tools, [self._time()]]).astype(np.float32)

    def _info(self):
        return {**self._measures, 'sim_time_s': self._time(), 'score': self._score,
                'success': self._success, 'failure': self._state.failure,
                'state_hash': self._state.state_hash}

    def _checked(self, action):
        if not self._running:
            raise RuntimeError('step: there is no episode, or it has ended: call reset')
        action = np.asarray(action, dtype=float)
        if action.shape != self.action_space.shape:
            raise ValueError('action: expected shape %s (got %s)' %
                             (self.action_space.shape, action.shape))
        if not np.isfinite(action).all():
            raise ValueError('action: expected finite numbers (got %g at %d)' % next(
                (number, k) for k, number in enumerate(action) if not np.isfinite(number)))
        return np.clip(action, self.action_space.low, self.action_space.high)


def check_seed(seed):
    if seed is None:
        return
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0:
        raise ValueError('seed: expected a whole number >= 0 (got %.40r)' % (seed,))


def read_options(options):
    """The overrides of the scene in the options of `reset`."""
    options = dict(options or {})
    extra = options.pop('set', [])
    if options:
        raise ValueError('options: expected the key set (got %.40r)' % next(iter(options)))
    if not isinstance(extra, (list, tuple)) or not all(isinstance(one, str) for one in extra):
        raise ValueError('options.set: expected a list of texts, each dotted.key=value')
    return list(extra)


def register_all():
    """Makes the tasks known to Gymnasium, by their `env_id`, where it is installed."""
    try:
        from gymnasium import register
    except ImportError:
        return
    for task in TASKS.values():
        register(id=task.env_id, entry_point='cloth_sim.env:ClothEnv', kwargs={'task': task.name})


register_all()
