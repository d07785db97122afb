"""Folding a towel with two clamps."""
import numpy as np

from cloth_sim import measures, rotations
from cloth_sim.tasks.task import Task, is_let_go, random_pose

INSET = 0.012  # of a grasp from both sides of a corner [m]
LEVEL = 0.002  # of the middle of a clamp that holds cloth on the table [m]


class Fold(Task):
    """A fold: points of the border shall come to lie above others."""

    scene = 'towel.yaml'
    size = 0.48, 0.32
    clamps = 'left', 'right'
    layers = 1         # of the folded towel
    largest_error = 0  # of a success [m]

    def __init__(self):
        super().__init__()
        upper = self.border_places()
        lower = self.image(upper)
        moves = np.linalg.norm(upper - lower, axis=1) > 1e-9
        self._upper, self._lower = upper[moves], lower[moves]
        self._flat_error = measures.rms(np.linalg.norm(self._upper - self._lower, axis=1))

    def image(self, places):
        """Where the folds bring material places (n, 2)."""
        raise NotImplementedError

    def start(self, random):
        return [random_pose(random, shift=0.03, turn=0.3)]

    def measures(self, surface, state):
        upper = surface.points[self.vertices('upper', self._upper, surface)]
        lower = surface.points[self.vertices('lower', self._lower, surface)]
        wanted = self.size[0] * self.size[1] / self.layers
        return {'coverage': measures.covered_area(surface) / wanted,
                'edge_error_m': measures.rms(np.linalg.norm((upper - lower)[:, :2], axis=1))}

    def score(self, measured):
        done = 1.0 - measured['edge_error_m'] / self._flat_error
        return max(0.0, done) * min(1.0, measured['coverage'])

    def success(self, measured, state):
        return (measured['edge_error_m'] < self.largest_error and
                0.85 < measured['coverage'] < 1.25 and is_let_go(state))


class FoldInHalf(Fold):
    name, env_id, number = 'fold_in_half', 'ClothSim/FoldInHalf-v0', 1
    summary = 'fold a towel in half across its longer side'
    layers = 2
    largest_error = 0.02
    time_limit = 12.0

    def image(self, places):
        return np.stack([np.minimum(places[:, 0], self.size[0] - places[:, 0]), places[:, 1]], 1)

    def plan(self, script):
        yield from fold_over_u(script, self.size[0])


class FoldInQuarters(Fold):
    name, env_id, number = 'fold_in_quarters', 'ClothSim/FoldInQuarters-v0', 2
    summary = 'fold a towel in half twice, across its longer and then its shorter side'
    layers = 4
    largest_error = 0.03
    time_limit = 20.0

    def image(self, places):
        return np.minimum(places, np.array(self.size) - places)

    def plan(self, script):
        yield from fold_over_u(script, self.size[0])
        yield from fold_over_v(script, self.size[1])


def fold_over_u(script, width):
    """Carries the edge at the end of u over that at its beginning."""
    along, across, level = script.view.axes()
    inset = INSET * across
    corners = {'left': script.view.corner(1, 0) - INSET * along + inset,
               'right': script.view.corner(1, 1) - INSET * along - inset}
    yield from carry_over(script, corners, -along, level, width - 2 * INSET)


def fold_over_v(script, height):
    """Carries both layers of the towel, folded over u, over v."""
    low = (script.view.corner(0, 1) + script.view.corner(1, 1)) / 2
    high = script.view.points[len(script.view.points) // 2, -1]  # on the fold
    along = high - low
    along[2] = 0
    length = np.linalg.norm(along)
    along /= length
    across = np.array([-along[1], along[0], 0.0])
    level = rotations.from_vector([0.0, 0.0, np.arctan2(along[1], along[0])])
    corners = {'left': low + INSET * along - INSET * across,
               'right': high - INSET * along - INSET * across}
    yield from script.move_by(np.array([0.0, 0.0, 0.1]))
    yield from carry_over(script, corners, -across, level, height - 2 * INSET)


def carry_over(script, corners, way, level, distance):
    """Grasps the cloth at two places, turns it over along a horizontal direction, lays it down and
    lets go."""
    axis = np.cross([0.0, 0.0, 1.0], way)  # a turn about it throws what is above along the way
    upright = rotations.product(rotations.from_vector(np.pi / 2 * axis), level)
    over = rotations.product(rotations.from_vector(np.pi / 2 * axis), upright)
    corners = {name: np.append(place[:2], LEVEL) for name, place in corners.items()}
    height = 0.26 * distance

    def at(fraction, z, turn):
        return {name: (place + fraction * distance * way + np.array([0.0, 0.0, z]), turn)
                for name, place in corners.items()}

    yield from script.move({name: (place + np.array([0.0, 0.0, 0.05]), level)
                            for name, place in corners.items()})
    yield from script.move(at(0.0, 0.0, level), 0.15)
    yield from script.grip(True)
    yield from script.move(at(0.22, height, upright))
    yield from script.move(at(0.77, height, over))
    yield from script.move(at(1.0, 0.003, over), 0.15)
    yield from script.grip(False, 0.4)
    yield from script.move_by(0.06 * way, 0.15)
    yield from script.move_by(np.array([0.0, 0.0, 0.1]))
