"""Parting a cloth: tearing along a seam, and cutting off a strip."""
import numpy as np

from cloth_sim import measures
from cloth_sim.tasks.task import Task, random_pose


class Part(Task):
    """The cloth shall become two pieces along a straight line in the material.

    across: index of the material coordinate that the line keeps: 0 or 1
    line: its value [m]
    worst: error of the edge at which the score is 0 [m]
    """

    across = 0
    line = worst = 0.0
    largest_error = smallest_coverage = 0.0

    def measures(self, surface, state):
        edge = surface.uv[np.unique(surface.torn)]
        along = 1 - self.across
        share = np.ptp(edge[:, along]) / self.size[along] if len(edge) else 0.0
        wanted = self.line / self.size[self.across] * measures.rest_area(surface)
        areas = measures.piece_areas(surface)
        return {'coverage': areas[1] / wanted if len(areas) == 2 else 0.0,
                'edge_error_m': measures.rms(edge[:, self.across] - self.line),
                'parted': float(share), 'pieces': len(areas)}

    def score(self, measured):
        return min(1.0, measured['parted']) * max(0.0, 1.0 - measured['edge_error_m'] / self.worst)

    def success(self, measured, state):
        return (measured['pieces'] == 2 and measured['edge_error_m'] < self.largest_error and
                measured['coverage'] > self.smallest_coverage)


class TearSeam(Part):
    name, env_id, number = 'tear_seam', 'ClothSim/TearSeam-v0', 5
    summary = 'tear a cloth in two along a weak seam that begins with a notch'
    scene = 'seam.yaml'
    size = 0.3, 0.3
    clamps = 'left', 'right'
    time_limit = 12.0
    across, line, worst = 0, 0.15, 0.015
    largest_error, smallest_coverage = 0.008, 0.9

    def start(self, random):
        return [random_pose(random, shift=0.02, turn=0.2)]

    def plan(self, script):
        """Grasps both sides of the cloth along their whole length, and pulls them apart."""
        along, _, level = script.view.axes()
        points = script.view.points
        inset, low = 0.014 * along, np.array([0.0, 0.0, 0.002])
        places = {'left': points[0].mean(axis=0) + inset, 'right': points[-1].mean(axis=0) - inset}
        yield from script.move({name: (np.append(place[:2], 0) + low, level)
                                for name, place in places.items()})
        yield from script.grip(True)
        for _ in range(200):
            here = {name: script.view.positions[name] for name in self.clamps}
            yield from script.move({'left': (here['left'] - 0.01 * along, None),
                                    'right': (here['right'] + 0.01 * along, None)}, 0.1)


class CutStrip(Part):
    name, env_id, number = 'cut_strip', 'ClothSim/CutStrip-v0', 6
    summary = 'cut a strip of 20 mm off a cloth'
    scene = 'sheet.yaml'
    size = 0.2, 0.12
    blade = -0.15, -0.1, 0.03
    time_limit = 8.0
    across, line, worst = 1, 0.02, 0.02
    largest_error, smallest_coverage = 0.001, 0.95

    def start(self, random):
        return [random_pose(random, shift=0.02, turn=0.3)]

    def plan(self, script):
        """Draws the blade along the line, from before the cloth to behind it."""
        along, across, _ = script.view.axes()
        start = script.view.corner(0, 0) + self.line * across
        yield from script.cut([start - 0.02 * along, start + (self.size[0] + 0.02) * along])
