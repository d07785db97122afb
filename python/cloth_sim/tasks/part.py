"""Parting a cloth: tearing along a seam, and cutting off a strip."""
import numpy as np

from cloth_sim import measures
from cloth_sim.tasks.task import Task, random_pose


class Part(Task):
    """The cloth shall become two pieces along a straight line in the material.

    line: its first and last point [m], on two opposite sides
    fraction: of the rest area that the smaller piece shall have
    worst: error of the edge at which the score is 0 [m]
    strongest: force on a clamp below which a success stays [N]
    """

    line = (0.0, 0.0), (0.0, 0.0)
    fraction = worst = 0.0
    largest_error = smallest_coverage = 0.0
    strongest = np.inf

    def measures(self, surface, state):
        edge = surface.uv[np.unique(surface.torn)]
        begin, way = np.array(self.line[0]), np.subtract(self.line[1], self.line[0])
        length = np.linalg.norm(way)
        along = (edge - begin) @ way / length
        aside = (edge - begin) @ np.array([-way[1], way[0]]) / length
        areas = measures.piece_areas(surface)
        wanted = self.fraction * measures.rest_area(surface)
        return {'coverage': areas[1] / wanted if len(areas) > 1 else 0.0,
                'edge_error_m': measures.rms(aside),
                'parted': float(np.ptp(along) / length) if len(edge) else 0.0,
                'pieces': len(areas)}

    def score(self, measured):
        return min(1.0, measured['parted']) * max(0.0, 1.0 - measured['edge_error_m'] / self.worst)

    def success(self, measured, state):
        return (measured['pieces'] == 2 and measured['edge_error_m'] < self.largest_error and
                measured['coverage'] > self.smallest_coverage and
                measured['peak_force_n'] < self.strongest)


class TearSeam(Part):
    name, env_id, number = 'tear_seam', 'ClothSim/TearSeam-v0', 5
    summary = 'tear a cloth in two along a slanted seam that begins with a notch'
    scene = 'seam.yaml'
    size = 0.2, 0.2
    clamps = 'left', 'right'
    time_limit = 10.0
    line, fraction, worst = ((0.11, 0.0), (0.09, 0.2)), 0.5, 0.012
    largest_error, smallest_coverage, strongest = 0.006, 0.9, 30.0
    room = (-0.25, -0.25, 0.0), (0.25, 0.2, 0.1)

    def start(self, random):
        return [random_pose(random, shift=0.02, turn=0.2)]

    def plan(self, script):
        """Grasps the cloth on both sides of the notch, and pulls apart what it holds."""
        along, across, level = script.view.axes()
        mouth = script.view.corner(0, 0) + self.line[0][0] * along + 0.015 * across
        mouth[2] = 0.002
        yield from script.move({'left': (mouth - 0.03 * along, level),
                                'right': (mouth + 0.03 * along, level)})
        yield from script.grip(True)
        pull = 0.3 * along
        ends = {name: (script.target(name) + way, None)
                for name, way in (('left', -pull), ('right', pull))}
        yield from script.move(ends, 0.1)


class CutStrip(Part):
    name, env_id, number = 'cut_strip', 'ClothSim/CutStrip-v0', 6
    summary = 'cut a strip of 20 mm off a cloth'
    scene = 'sheet.yaml'
    size = 0.2, 0.12
    blade = -0.15, -0.1, 0.03
    time_limit = 8.0
    line, fraction, worst = ((0.0, 0.02), (0.2, 0.02)), 1.0 / 6.0, 0.02
    largest_error, smallest_coverage = 0.001, 0.95
    room = (-0.15, -0.12, 0.0), (0.15, 0.12, 0.05)

    def start(self, random):
        return [random_pose(random, shift=0.02, turn=0.3)]

    def plan(self, script):
        """Draws the blade along the line, from before the cloth to behind it."""
        along, across, _ = script.view.axes()
        start = script.view.corner(0, 0) + self.line[0][1] * across
        yield from script.cut([start - 0.02 * along, start + (self.size[0] + 0.02) * along])
