"""Policies that follow a plan: a generator of actions, which may look at the cloth at any time."""
import math

import numpy as np

from cloth_sim import rotations
from cloth_sim.tools import TURN


class View:
    """An observation of a task, taken apart.

    points: positions [m] of the task's grid of material places, shape (columns, rows, 3)
    positions, turns: of each clamp by its name, [m] and [x, y, z, w]
    blade: position [m], or None
    time: since the start of the episode [s]
    """

    def __init__(self, task, observation):
        observation = np.asarray(observation, dtype=float)
        count = 3 * len(task.places)
        self.points = observation[:count].reshape(*task.grid, 3)
        clamps = observation[count:count + 12 * len(task.clamps)].reshape(-1, 12)
        self.positions = {name: row[:3] for name, row in zip(task.clamps, clamps)}
        self.turns = {name: row[3:7] for name, row in zip(task.clamps, clamps)}
        self.blade = observation[-4:-1] if task.blade is not None else None
        self.time = observation[-1]

    def corner(self, u, v):
        """Position [m] of a corner of the cloth; u and v are 0 or 1."""
        return self.points[-u, -v]

    def axes(self):
        """Horizontal directions of u and v, on average, and the rotation of the cloth about z."""
        along = (self.points[-1] - self.points[0]).mean(axis=0)
        yaw = math.atan2(along[1], along[0])
        return (np.array([math.cos(yaw), math.sin(yaw), 0.0]),
                np.array([-math.sin(yaw), math.cos(yaw), 0.0]),
                rotations.from_vector([0.0, 0.0, yaw]))


class Script:
    """A policy: `act` gives the next action of the plan, and rest after its end."""

    def __init__(self, task, period, plan):
        """\\param period simulated time of an action [s]
        \\param plan function of this script that returns the generator"""
        self.task, self.period = task, period
        self.view, self.done = None, False
        self._grips = dict.fromkeys(task.clamps, -1.0)
        self._targets = None
        self._plan = plan(self)

    def act(self, observation):
        self.view = View(self.task, observation)
        if self._targets is None:
            self._targets = {name: (self.view.positions[name], self.view.turns[name])
                             for name in self.task.clamps}
        action = next(self._plan, None)
        self.done = action is None
        return self._action({}) if self.done else action

    def target(self, clamp):
        """Where a clamp has been sent [m]."""
        return self._targets[clamp][0]

    # ---- parts of plans: `yield from` them -------------------------------------------------------

    def wait(self, duration):
        """Keeps everything where it is for a time [s]."""
        for _ in range(math.ceil(duration / self.period - 1e-9)):
            yield self._action({})

    def grip(self, closed, duration=0.3, clamps=None):
        """Closes or opens clamps (None: all), and waits."""
        for name in clamps or self.task.clamps:
            self._grips[name] = 1.0 if closed else -1.0
        yield from self.wait(duration)

    def move(self, targets, speed=0.3):
        """Moves clamps evenly to targets, {name: (position [m], orientation or None: as it is)};
        the farthest at a speed [m/s]."""
        ways = {}
        for name, (position, turn) in targets.items():
            here, now = self._targets[name]
            turn = now if turn is None else turn
            ways[name] = (np.asarray(position) - here,
                          rotations.to_vector(rotations.product(turn, rotations.inverse(now))))
            self._targets[name] = np.asarray(position), turn
        duration = max(max(np.linalg.norm(way) / speed, np.abs(turn).max() / (0.5 * TURN))
                       for way, turn in ways.values())
        count = max(1, math.ceil(duration / self.period - 1e-9))
        velocities = {name: np.concatenate(way) / (count * self.period)
                      for name, way in ways.items()}
        for _ in range(count):
            yield self._action(velocities)

    def move_by(self, way, speed=0.3, clamps=None):
        """Moves clamps (None: all) along a vector [m]."""
        yield from self.move({name: (self._targets[name][0] + way, None)
                              for name in clamps or self.task.clamps}, speed)

    def cut(self, path, speed=0.2):
        """Draws the blade along a path [m], to whose start it goes in the air."""
        yield from self._slide(self.view.blade, path[0], speed, -1.0)
        for a, b in zip(path, path[1:]):
            yield from self._slide(a, b, speed, 1.0)

    def _slide(self, a, b, speed, pressure):
        count = max(1, math.ceil(np.linalg.norm(b - a) / speed / self.period - 1e-9))
        for _ in range(count):
            yield np.append((b - a) / (count * self.period), pressure)

    def _action(self, velocities):
        parts = [np.append(velocities.get(name, np.zeros(6)), self._grips[name])
                 for name in self.task.clamps]
        if self.task.blade is not None:
            parts.append(np.array([0.0, 0.0, 0.0, -1.0]))
        return np.concatenate(parts)
