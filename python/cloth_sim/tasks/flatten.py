"""Flattening a crumpled cloth with two clamps."""
import numpy as np

from cloth_sim import measures
from cloth_sim.tasks.task import Task, is_let_go, random_pose

LEVEL = 0.003  # of the middle of a clamp that grasps cloth on the table [m]


class Flatten(Task):
    name, env_id, number = 'flatten', 'ClothSim/Flatten-v0', 3
    summary = 'spread a towel that was lifted at a random place and dropped'
    scene = 'towel.yaml'
    size = 0.48, 0.32
    clamps = 'left', 'right'
    time_limit = 20.0
    settle = 1.0
    least_coverage = 0.9

    def start(self, random):
        return [random_pose(random, shift=0.03, turn=0.3),
                'clamps.left.plate_size=[0.016, 0.016]', 'clamps.right.plate_size=[0.016, 0.016]']

    def prepare(self, script, random):
        """One clamp lifts the towel at a random place and drops it, twice."""
        for _ in range(2):
            column, row = random.integers(self.grid[0]), random.integers(self.grid[1])
            place = np.append(script.view.points[column, row, :2], 0.0)
            yield from script.move({'left': (place + (0, 0, LEVEL), None)})
            yield from script.grip(True, clamps=['left'])
            yield from script.move({'left': (place + (0, 0, 0.3), None)})
            side = np.append(random.uniform(-0.08, 0.08, 2), 0.12)
            yield from script.move({'left': (side, None)}, 0.4)
            yield from script.grip(False, 0.8, clamps=['left'])
        yield from script.move({'left': (np.array([0.3, -0.148, 0.1]), None)})

    def measures(self, surface, state):
        border = self.border_places()
        points = surface.points[self.vertices('border', border, surface), :2].astype(float)
        return {'coverage': measures.covered_area(surface) / (self.size[0] * self.size[1]),
                'edge_error_m': measures.rms(measures.misfit(points, border))}

    def score(self, measured):
        return min(1.0, measured['coverage'])

    def success(self, measured, state):
        return measured['coverage'] > self.least_coverage and is_let_go(state)

    def plan(self, script):
        """Lifts the towel at both corners of a long side, stretches that side, and lays the towel
        down behind it."""
        width, height = self.size
        left, right = script.view.corner(0, 0), script.view.corner(1, 0)
        above = np.array([0.0, 0.0, LEVEL])
        yield from script.move({'left': (np.append(left[:2], 0) + above, None),
                                'right': (np.append(right[:2], 0) + above, None)})
        yield from script.grip(True)
        yield from script.move({'left': (left + (0, 0, 0.15), None),
                                'right': (right + (0, 0, 0.15), None)}, 0.2)
        # Along x, with the towel hanging below; its free edge then trails behind, along y.
        span, top = np.array([width / 2 - 0.004, 0.0, 0.0]), np.array([0.0, -0.1, height + 0.06])
        yield from script.move({'left': (top - span, None), 'right': (top + span, None)}, 0.3)
        yield from script.wait(0.6)
        yield from script.move_by(np.array([0.0, 0.0, -0.06]), 0.1)
        down = np.array([0.0, -height, -height + 0.005])
        yield from script.move_by(down, 0.15)
        yield from script.move_by(np.array([0.0, -0.03, 0.0]), 0.1)
        yield from script.grip(False, 0.4)
        yield from script.move_by(np.array([0.0, -0.05, 0.0]), 0.15)
