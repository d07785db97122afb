"""Hanging a cloth over a rod with two clamps."""
import numpy as np

from cloth_sim import measures
from cloth_sim.tasks.task import Task, is_let_go, random_pose

INSET, LEVEL = 0.012, 0.002  # of a grasp from both sides of a corner, and above the table [m]
ROD_HEIGHT, ROD_RADIUS = 0.4, 0.015  # as in the scene [m]
CLEAR = 0.02  # height above which cloth does not lie on the table [m]


class HangOverRod(Task):
    name, env_id, number = 'hang_over_rod', 'ClothSim/HangOverRod-v0', 4
    summary = 'hang a cloth over a rod, with both ends level'
    scene = 'rod.yaml'
    size = 0.5, 0.3
    grid = 9, 5
    clamps = 'left', 'right'
    time_limit = 15.0
    room = (-0.2, -0.3, 0.0), (0.6, 0.3, 0.5)
    view = -50, 12

    def start(self, random):
        return [random_pose(random, shift=0.02, turn=0.15, at=(0.35, 0.0, 0.001))]

    def measures(self, surface, state):
        clear = (surface.points[surface.faces][..., 2] > CLEAR).all(axis=1)
        ends = self.vertices('ends', [(u, v) for u in (0.0, self.size[0])
                                      for v in np.linspace(0, self.size[1], 31)], surface)
        heights = surface.points[ends, 2].astype(float)
        return {'coverage': (measures.area(surface.uv[surface.faces[clear]]) /
                             measures.rest_area(surface)),
                'edge_error_m': measures.rms(heights - heights.mean())}

    def score(self, measured):
        return measured['coverage'] * max(0.0, 1.0 - 2 * measured['edge_error_m'] / self.size[0])

    def success(self, measured, state):
        return (measured['coverage'] > 0.99 and measured['edge_error_m'] < 0.05 and
                is_let_go(state))

    def plan(self, script):
        """Grasps the edge near the rod, lifts it over the rod, and pulls until half of the cloth
        has passed."""
        along, across, level = script.view.axes()
        corners = {'left': script.view.corner(0, 0) + INSET * (along + across),
                   'right': script.view.corner(0, 1) + INSET * (along - across)}
        corners = {name: np.append(place[:2], LEVEL) for name, place in corners.items()}
        yield from script.move({name: (place, level) for name, place in corners.items()})
        yield from script.grip(True)
        half = 0.5 * np.linalg.norm(corners['left'] - corners['right'])
        middle = {'left': np.array([0.0, -half, 0.0]), 'right': np.array([0.0, half, 0.0])}
        straight = np.array([0.0, 0.0, 0.0, 1.0])

        def at(x, z):
            return {name: (place + (x, 0.0, z), straight) for name, place in middle.items()}

        yield from script.move(at(0.08, ROD_HEIGHT + 0.08), 0.2)
        yield from script.move(at(-0.08, ROD_HEIGHT + 0.08), 0.15)
        end = self.size[0] / 2 - INSET - np.pi / 2 * ROD_RADIUS  # below the middle of the rod
        yield from script.move(at(-0.05, ROD_HEIGHT - end), 0.15)
        yield from script.move(at(-ROD_RADIUS, ROD_HEIGHT - end), 0.1)
        yield from script.wait(0.5)
        yield from script.grip(False, 0.4)
        yield from script.move_by(np.array([-0.06, 0.0, 0.0]), 0.1)
