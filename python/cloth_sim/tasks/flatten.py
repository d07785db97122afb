"""Flattening a crumpled cloth with two clamps."""
import numpy as np

from cloth_sim import measures
from cloth_sim.tasks.task import Task, is_let_go, random_pose

ROUNDS = 3        # in which the scripted policy pulls at both short sides
LIFT = 0.03, 0.3  # of the clamps above the table: the least, and where a corner is far [m]
FAR = 0.2         # from its place [m]


class Flatten(Task):
    name, env_id, number = 'flatten', 'ClothSim/Flatten-v0', 3
    summary = 'spread a towel that was lifted at a random place and dropped'
    scene = 'towel.yaml'
    size = 0.48, 0.32
    clamps = 'left', 'right'
    time_limit = 30.0
    settle = 1.0
    least_coverage = 0.9

    def start(self, random):
        fingers = ['clamps.%s.%s' % (name, value) for name in self.clamps for value in (
            'plate_size=[0.02, 0.02]', 'gap_open=0.006', 'gap_closed=0.002', 'grip_force=5.0')]
        return [random_pose(random, shift=0.03, turn=0.3), 'cloth.particles=[37, 25]',
                'solver.error=0.05', 'solver.budget=20', *fingers]

    def prepare(self, script, random):
        """One clamp lifts the towel at a random place, carries it to the middle and drops it."""
        column, row = random.integers(self.grid[0]), random.integers(self.grid[1])
        place = script.view.points[column, row]
        home = script.target('left')
        yield from script.move({'left': (place, None)})
        yield from script.grip(True, clamps=['left'])
        yield from script.move({'left': (place + (0, 0, 0.3), None)})
        middle = np.append(random.uniform(-0.08, 0.08, 2), 0.15)
        yield from script.move({'left': (middle, None)}, 0.4)
        yield from script.grip(False, 0.8, clamps=['left'])
        yield from script.move({'left': (home, None)})

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
        """Pulls the corners to where those of a flat towel are, one short side after the other, as
        the oracle of Seita et al. (2020) does with one corner at a time."""
        for _ in range(ROUNDS):
            corners = self.nearest_rectangle(script.view)
            for side in (0, 1):
                yield from self.pull(script, side, corners)

    def nearest_rectangle(self, view):
        """Where the corners of a flat towel are [m], {(u, v): place}: of the four ways in which it
        may lie in the middle of the table, either side up, the one nearest to the corners now."""

        def rectangle(sign_u, sign_v):
            return {(u, v): np.array([sign_u * (u - 0.5) * self.size[0],
                                      sign_v * (v - 0.5) * self.size[1], 0.003])
                    for u in (0, 1) for v in (0, 1)}

        def distance(places):
            return sum(np.linalg.norm((view.corner(*corner) - place)[:2])
                       for corner, place in places.items())

        return min((rectangle(a, b) for a in (1, -1) for b in (1, -1)), key=distance)

    def pull(self, script, u, corners):
        """Carries the corners of a short side, u = 0 or 1, to their places: where they are far,
        lifts them, so that the rest hangs down, and lays them down outwards."""
        ends = dict(zip(self.clamps, (0, 1)))
        for speed in (0.4, 0.1):  # the towel may have moved meanwhile
            yield from script.move({name: (script.view.corner(u, v), None)
                                    for name, v in ends.items()}, speed)
        yield from script.grip(True)
        places = {name: corners[u, v] for name, v in ends.items()}
        away = max(np.linalg.norm((script.target(name) - place)[:2])
                   for name, place in places.items())
        fraction = min(1.0, away / FAR)
        lift = np.array([0.0, 0.0, LIFT[0] + fraction * (LIFT[1] - LIFT[0])])
        inwards = lift - (fraction * corners[u, 0][0], 0.0, 0.0)
        yield from script.move_by(lift, 0.2)
        yield from script.move({name: (place + inwards, None)
                                for name, place in places.items()}, 0.2)
        yield from script.move({name: (place, None) for name, place in places.items()}, 0.2)
        yield from script.grip(False)
        yield from script.move_by(np.array([0.0, 0.0, 0.1]))
