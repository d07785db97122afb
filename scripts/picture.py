#!/usr/bin/env python3
"""Draws pictures of a run from its bag; needs numpy and matplotlib, no display and no master.

usage: picture.py BAG [--out=PNG] [--video=MP4|GIF] [--fps=N] [--scene=SCENE.yaml]
                  [--times=T,T,...] [--size=W[xH]] [--view=AZIMUTH,ELEVATION] [--zoom=F]

One panel per phase, at the phase's end (or one per time given with --times), and a last one with
the springs that failed and the strain over time. The cloth is coloured by strain, its back is of
another colour, edges that tearing made are dark red. --video plays the run in real time, in one
panel. Topics are found by their type, so the bag may be cloth_run's or one recorded from the node.
Obstacles and clamps are those of the scene in the bag; --scene replaces it, or supplies the one
that an older bag lacks. Obstacles that followed something, such as the links of a robot, are where
~scene_markers says. --zoom=0.5 shows twice the surroundings.
"""
import argparse
import math
import os
import sys

import matplotlib
matplotlib.use('Agg')
import matplotlib.animation  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import PolyCollection  # noqa: E402
from matplotlib.colors import LinearSegmentedColormap  # noqa: E402
import numpy as np  # noqa: E402
import rosbag  # noqa: E402

FRONT = LinearSegmentedColormap.from_list('front', ['#7fb2d9', '#3f7fb5', '#f2c14e', '#d7263d'])
BACK = LinearSegmentedColormap.from_list('back', ['#e3d3bd', '#c7a980', '#f2c14e', '#d7263d'])
FULL_STRAIN = 0.2  # [-] where the colours end
TORN = np.array([0.45, 0.02, 0.06])
BOARD = np.array([0.80, 0.79, 0.76])
BALL = np.array([0.45, 0.62, 0.45])
STEEL = np.array([0.30, 0.32, 0.36])
BACKGROUND = np.array([0.965, 0.97, 0.975])
TO_LIGHT = np.array([0.25, -0.45, 0.86])


# ---- the bag -------------------------------------------------------------------------------------

class Run:
    """A run in a bag: figures at all times, shapes at the requested times."""

    def __init__(self, path):
        try:
            self.bag = rosbag.Bag(path)
        except OSError as error:
            sys.exit(f'error: {path}: {error.strerror}')
        except rosbag.ROSBagException as error:
            sys.exit(f'error: {path}: {" ".join(str(error).split())}')
        self.topic_of = {info.msg_type: name
                         for name, info in self.bag.get_type_and_topic_info().topics.items()}
        for needed in ('cloth_sim/ClothFrame', 'cloth_sim/ClothTopology', 'cloth_sim/ClothState'):
            if needed not in self.topic_of:
                sys.exit(f'error: {path} has no messages of type {needed}')
        self.states = [(stamp, message) for _, message, stamp in self._read('ClothState')]
        self.topologies = {message.revision: Topology(message)
                           for _, message, _ in self._read('ClothTopology')}
        if not self.states:
            sys.exit(f'error: {path} has no message of type cloth_sim/ClothState')

    def scene(self):
        """The scene that was recorded, overrides included; empty if there is none in the bag."""
        topic = os.path.dirname(self.topic_of['cloth_sim/ClothState']) + '/scene'
        texts = [message.data for _, message, _ in self.bag.read_messages(topics=[topic])]
        return texts[-1] if texts else ''

    def _read(self, kind, **limits):
        return self.bag.read_messages(topics=[self.topic_of['cloth_sim/' + kind]], **limits)

    def phase_ends(self):
        """[(name, index of the phase's last state)]; without phases, four equal parts."""
        names = [state.phase for _, state in self.states]
        if not any(names):
            last = len(names) - 1
            return [('', round(last * part / 4)) for part in range(5)]
        ends = [(name, i) for i, name in enumerate(names)
                if name and (i + 1 == len(names) or names[i + 1] != name)]
        return ends

    def phase_begins(self):
        """The time at which each phase begins, by its name."""
        begins = {}
        for _, state in self.states:
            begins.setdefault(state.phase, state.time)
        return begins

    def state_at(self, time):
        return min(range(len(self.states)), key=lambda i: abs(self.states[i][1].time - time))

    def shape(self, index):
        """The frame nearest to a state: (positions, topology)."""
        stamp, state = self.states[index]
        best = None
        for margin in (0.1, 1.0, 1e6):
            around = dict(start_time=_shift(stamp, -margin), end_time=_shift(stamp, margin))
            frames = [message for _, message, _ in self._read('ClothFrame', **around)
                      if message.revision in self.topologies]
            if frames:
                best = min(frames, key=lambda frame: abs(frame.time - state.time))
                break
        if best is None:
            sys.exit('error: the bag has no frame that belongs to one of its topologies')
        points = np.array(best.positions, dtype=float).reshape(-1, 3)
        return points, self.topologies[best.revision]


    def obstacle_poses(self, index):
        """The poses of the markers of obstacles at a state, in their order; none without markers."""
        stamp, _ = self.states[index]
        topic = os.path.dirname(self.topic_of['cloth_sim/ClothState']) + '/scene_markers'
        messages = self.bag.read_messages(topics=[topic], start_time=_shift(stamp, -0.2),
                                          end_time=_shift(stamp, 0.2))
        nearest = min(((abs((at - stamp).to_sec()), number, message)
                       for number, (_, message, at) in enumerate(messages)), default=None)
        if nearest is None:
            return []
        return [pose_of(marker.pose) for marker in nearest[2].markers
                if marker.ns == 'obstacles' and marker.action == 0]  # ADD


def _shift(stamp, seconds):
    moved = stamp.to_sec() + seconds
    return type(stamp).from_sec(min(max(moved, 0.0), 4e9))


class Topology:
    def __init__(self, message):
        self.faces = np.array(message.triangles, dtype=np.int64).reshape(-1, 3)
        self.uv = np.array(message.uv, dtype=float).reshape(-1, 2)
        self.torn = np.array(message.torn_edges, dtype=np.int64).reshape(-1, 2)

        self.lines = strain_lines(self.faces, self.uv)


# ---- strain: the definition of include/cloth_sim/cloth/strain.h ------------------------------------

def strain_lines(faces, uv):
    """Vertex pairs (n, 2) of the structural and shear springs: every edge, and across every inner
    bias edge the other diagonal, if that is a bias direction, too."""
    edges = np.concatenate([np.sort(faces[:, [k, (k + 1) % 3]], axis=1) for k in range(3)])
    opposite = np.concatenate([faces[:, (k + 2) % 3] for k in range(3)])
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, opposite = edges[order], opposite[order]
    twice = np.flatnonzero((edges[1:] == edges[:-1]).all(axis=1))
    across = np.stack([opposite[twice], opposite[twice + 1]], axis=1)
    bias = is_bias(uv, edges[twice]) & is_bias(uv, across)
    return np.concatenate([np.delete(edges, twice + 1, axis=0), across[bias]])


def is_bias(uv, pairs):
    """Whether pairs are farther than 22.5 degrees from both thread directions."""
    direction = np.abs(uv[pairs[:, 1]] - uv[pairs[:, 0]])
    length = np.linalg.norm(direction, axis=1)
    return (direction <= math.cos(math.pi / 8) * length[:, None]).all(axis=1)


def vertex_strains(topology, points):
    """Largest strain of the springs at each vertex: length over rest length less 1, or 0 if slack."""
    a, b = topology.lines.T
    rest = np.maximum(np.linalg.norm(topology.uv[b] - topology.uv[a], axis=1), 1e-6)
    strain = np.linalg.norm(points[b] - points[a], axis=1) / rest - 1.0
    strains = np.zeros(len(points))
    for ends in (a, b):
        np.maximum.at(strains, ends, strain)
    return strains


def face_strains(topology, points):
    """Largest strain of the three corners of each face."""
    return vertex_strains(topology, points)[topology.faces].max(axis=1)


# ---- obstacles and clamps --------------------------------------------------------------------------

def quaternion_matrix(q):
    x, y, z, w = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def pose_of(pose):
    q = pose.orientation
    return (np.array([pose.position.x, pose.position.y, pose.position.z]),
            quaternion_matrix((q.x, q.y, q.z, q.w)))


def box(size, position, rotation, cells=24):
    """Triangles (n, 3, 3) of a box, each side as a grid."""
    steps = np.linspace(-0.5, 0.5, cells + 1)
    u, v = (grid.ravel() for grid in np.meshgrid(steps[:-1], steps[:-1], indexing='ij'))
    h = steps[1] - steps[0]
    sides = []
    for axis in range(3):
        for sign in (-0.5, 0.5):
            corners = []
            for du, dv in ((0, 0), (h, 0), (h, h), (0, h)):
                corner = np.empty((u.size, 3))
                corner[:, axis] = sign
                corner[:, (axis + 1) % 3] = u + du
                corner[:, (axis + 2) % 3] = v + dv
                corners.append(corner)
            p, q, r, s = corners if sign > 0 else corners[::-1]
            sides += [np.stack([p, q, r], axis=1), np.stack([p, r, s], axis=1)]
    return (np.concatenate(sides) * size) @ rotation.T + position


def ball(radius, position, parts=48):
    polar, around = np.meshgrid(np.linspace(0, math.pi, parts // 2 + 1),
                                np.linspace(0, 2 * math.pi, parts + 1), indexing='ij')
    points = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around),
                       np.cos(polar)], axis=2) * radius + position
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    return np.concatenate([np.stack([a, b, c], axis=2).reshape(-1, 3, 3),
                           np.stack([a, c, d], axis=2).reshape(-1, 3, 3)])


def capsule(radius, length, position, rotation):
    ends = ball(radius, np.zeros(3))
    ends[..., 2] += np.where(ends[..., 2] > 1e-9, length / 2, -length / 2)
    return ends @ rotation.T + position


def cylinder(radius, length, position, rotation, parts=48):
    around = np.linspace(0, 2 * math.pi, parts + 1)
    low = np.stack([radius * np.cos(around), radius * np.sin(around),
                    np.full(parts + 1, -length / 2)], axis=1)
    high = low + (0, 0, length)
    a, b, c, d = low[:-1], low[1:], high[1:], high[:-1]
    middle = np.broadcast_to([0, 0, length / 2], a.shape)
    sides = [np.stack(part, axis=1) for part in ((a, b, c), (a, c, d), (d, c, middle),
                                                 (b, a, -middle))]
    return np.concatenate(sides) @ rotation.T + position


def read_mesh(path):
    """Triangles (n, 3, 3) of an STL or OBJ file, in its units."""
    with open(path, 'rb') as file:
        data = file.read()
    if path.lower().endswith('.obj'):
        vertices, triangles = [], []
        for words in (line.split() for line in data.decode('ascii', 'replace').splitlines()):
            if words[:1] == ['v']:
                vertices.append([float(word) for word in words[1:4]])
            elif words[:1] == ['f']:
                corners = [int(word.split('/')[0]) for word in words[1:]]
                corners = [k - 1 if k > 0 else len(vertices) + k for k in corners]
                triangles += [(corners[0], b, c) for b, c in zip(corners[1:], corners[2:])]
        return np.array(vertices)[np.array(triangles)]
    count = int.from_bytes(data[80:84], 'little')
    if len(data) == 84 + 50 * count:
        kind = np.dtype([('normal', '<f4', 3), ('corners', '<f4', (3, 3)), ('more', '<u2')])
        return np.frombuffer(data, kind, count, 84)['corners'].astype(float)
    words = data.decode('ascii', 'replace').split()
    corners = [words[k + 1:k + 4] for k, word in enumerate(words) if word == 'vertex']
    return np.array(corners, dtype=float).reshape(-1, 3, 3)


def divided(triangles, count=5000):
    """The same surface in at least `count` triangles: few large ones are drawn in a wrong order."""
    while 0 < len(triangles) < count:
        a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        triangles = np.concatenate([np.stack(part, axis=1) for part in (
            (a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return triangles


def turn_by(vector):
    """The rotation about a vector by its length [rad]."""
    angle = float(np.linalg.norm(vector))
    if angle == 0:
        return np.eye(3)
    half = np.sin(angle / 2) / angle * np.asarray(vector, dtype=float)
    return quaternion_matrix((*half, math.cos(angle / 2)))


def rotation_of(entry):
    if 'rpy' in entry:
        r, p, y = entry['rpy']
        halves = [(math.cos(a / 2), math.sin(a / 2)) for a in (r, p, y)]
        (cr, sr), (cp, sp), (cy, sy) = halves
        return quaternion_matrix((sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
                                  cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy))
    return quaternion_matrix(entry.get('orientation', (0, 0, 0, 1)))


class SceneFile:
    """The obstacles and clamps of a scene; the cloth comes from the bag."""

    MARKERS = {'bounds': 0, 'capsule': 3}  # of an obstacle; of all other types it is one

    def __init__(self, path, recorded, begins=None):
        """From a file, or without one from the text of the bag.

        `begins`: the time at which each phase of the run begins, by its name."""
        import yaml
        try:
            if path:
                with open(self._find(path)) as file:
                    recorded = file.read()
            scene = yaml.safe_load(recorded) or {}
        except (OSError, yaml.YAMLError) as error:
            sys.exit(f'error: --scene: {path}: {" ".join(str(error).split())}')
        self.folder = os.path.dirname(self._find(path)) if path else ''
        self.meshes = {}
        self.obstacles = scene.get('obstacles') or {}
        # Phases come in the order of the scene; one that did not begin moves nothing.
        self.changes = [(begins[phase['name']], phase['obstacles'])
                        for phase in scene.get('phases') or []
                        if phase.get('obstacles') and phase.get('name') in (begins or {})]
        self.plates = {name: clamp.get('plate_size')
                       for name, clamp in (scene.get('clamps') or {}).items()}

    @staticmethod
    def _find(path):
        """The file; a plain name is that of a scene in config/scenes."""
        if os.path.exists(path) or os.path.basename(path) != path:
            return path
        here = os.path.dirname(os.path.realpath(__file__))
        return os.path.join(here, '..', 'config', 'scenes',
                            path if path.endswith('.yaml') else path + '.yaml')

    def solids(self, state, poses=()):
        """[(triangles, colour)] at the time of a state.

        `poses`: of the markers of the obstacles (Run.obstacle_poses), if there are any."""
        counts = [self.MARKERS.get(entry['type'], 1) for entry in self.obstacles.values()]
        found = []
        for number, (name, entry) in enumerate(self.obstacles.items()):
            pose = self._pose(name, entry, state.time)
            if len(poses) == sum(counts) and entry['type'] not in ('bounds', 'plane'):
                pose = poses[sum(counts[:number])]
            found += self._obstacle(entry, *pose)
        for clamp in state.clamps:
            found += self._clamp(clamp)
        return found

    def _pose(self, name, entry, time):
        """(position, rotation) of an obstacle, moved by its own velocities and those of phases."""
        where = np.array(entry.get('position', (0, 0, 0)), dtype=float)
        turn = rotation_of(entry)
        moves = [(0.0, entry)] + [(begin, change[name]) for begin, change in self.changes
                                  if name in change and begin < time]
        for (begin, move), end in zip(moves, [begin for begin, _ in moves[1:]] + [time]):
            where += np.array(move.get('velocity', (0, 0, 0)), dtype=float) * (end - begin)
            spin = np.array(move.get('angular_velocity', (0, 0, 0)), dtype=float)
            turn = turn_by(spin * (end - begin)) @ turn
        return where, turn

    def _mesh(self, entry):
        """The triangles of a mesh, in its axes [m]."""
        name = entry['file']
        if name not in self.meshes:
            here = os.path.dirname(os.path.realpath(__file__))
            folders = [self.folder, '', os.path.join(here, '..', 'config', 'scenes')]
            paths = [os.path.join(folder, name) for folder in folders]
            path = next((path for path in paths if os.path.exists(path)), None)
            if path is None:
                sys.exit(f'error: cannot find the mesh {name}: give --scene')
            self.meshes[name] = divided(read_mesh(path))
        return self.meshes[name] * float(entry.get('scale', 1))

    def _obstacle(self, entry, where, turn):
        if entry['type'] == 'sphere':
            return [(ball(float(entry['radius']), where), BALL)]
        if entry['type'] == 'capsule':
            return [(capsule(float(entry['radius']), float(entry['length']), where, turn), BALL)]
        if entry['type'] == 'cylinder':
            return [(cylinder(float(entry['radius']), float(entry['length']), where, turn), BALL)]
        if entry['type'] == 'mesh':
            triangles = self._mesh(entry) @ turn.T + where
            return [(np.concatenate([triangles, triangles[:, ::-1]]), BALL)]  # both sides
        if entry['type'] in ('board', 'box'):
            return [(box(np.array(entry['size'], dtype=float), where, turn), BOARD)]
        if entry['type'] == 'plane':
            ground = np.array([3.0, 3.0, 0.01])
            return [(box(ground, where - turn[:, 2] * ground[2] / 2, turn), BOARD)]
        if entry['type'] == 'bounds':
            return []  # invisible
        sys.exit(f"error: cannot draw an obstacle of type {entry['type']}")

    def _clamp(self, clamp):
        size = np.array([*(self.plates.get(clamp.name) or (0.06, 0.06)), 0.008])
        position, rotation = pose_of(clamp.pose)
        for side in (-1, 1):
            offset = rotation[:, 2] * side * (clamp.gap + size[2]) / 2
            yield box(size, position + offset, rotation, cells=4), STEEL


# ---- drawing -------------------------------------------------------------------------------------

class Camera:
    """A perspective camera, z up, at the distance from which all `points` fit into the picture, or
    `zoom` times as large, below the middle."""

    MARGIN = 0.06  # of the picture, on each side

    def __init__(self, points, azimuth, elevation, width, height, zoom):
        a, e = math.radians(azimuth), math.radians(elevation)
        back = np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
        right = np.cross([0, 0, 1.0], back)
        right /= np.linalg.norm(right)
        self.axes = np.stack([right, np.cross(back, right), back])
        self.width, self.height = width, height
        self.focal = 1.9 * max(width, height)

        room = np.array([width, height]) * (1 - 2 * self.MARGIN)
        self.eye = points.mean(axis=0) + 5 * np.ptp(points, axis=0).max() * back
        for _ in range(6):  # perspective makes one correction inexact
            seen = self.project(points)
            low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
            depth = np.median(seen[:, 2])
            off = ((low + high) - (width, height)) / 2 * depth / self.focal
            self.eye = self.eye + off[0] * self.axes[0] - off[1] * self.axes[1]
            self.eye = self.eye + (((high - low) / room).max() / zoom - 1) * depth * back
        if zoom < 1:  # what is around the cloth is above it: the cloth goes down in the picture
            self.eye = self.eye + (1 - zoom) * height / 3 * depth / self.focal * self.axes[1]

    def project(self, points):
        """Projects points to (x [px], y [px], depth [m])."""
        local = (points - self.eye) @ self.axes.T
        depth = np.maximum(-local[..., 2], 1e-3)
        return np.stack([self.width / 2 + self.focal * local[..., 0] / depth,
                         self.height / 2 - self.focal * local[..., 1] / depth, depth], axis=-1)


class Picture:
    """Triangles with a colour each, drawn by matplotlib from far to near."""

    def __init__(self, camera):
        self.camera = camera
        self.parts = []  # (corners on the screen, depth, colour, width of the outline)

    def add_solid(self, triangles, colour):
        """Adds triangles (n, 3, 3) of a closed body; cloth that lies on it is drawn over it."""
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        towards_us = np.einsum('td,td->t', normal, self.camera.eye - triangles[:, 0]) > 0
        triangles, normal = triangles[towards_us], unit(normal[towards_us])
        screen = self.camera.project(triangles)
        self._add(screen, screen[..., 2].max(axis=1), colour * lighting(normal)[:, None])

    def add_cloth(self, points, topology):
        """Adds both sides of a cloth, coloured by strain, and its torn edges."""
        faces = topology.faces
        normals = vertex_normals(points, faces)[faces].mean(axis=1)
        from_front = np.einsum('td,td->t', normals, self.camera.eye - points[faces[:, 0]]) > 0
        level = np.clip(face_strains(topology, points) / FULL_STRAIN, 0.0, 1.0)
        colours = np.where(from_front[:, None], FRONT(level)[:, :3], BACK(level)[:, :3])
        light = lighting(unit(np.where(from_front[:, None], normals, -normals)))
        screen = self.camera.project(points[faces])
        self._add(screen, screen[..., 2].mean(axis=1), colours * light[:, None])
        torn = self.camera.project(points[topology.torn])[:, [0, 1, 1]]
        self._add(torn, torn[..., 2].min(axis=1), TORN, width=1.5)

    def _add(self, screen, depth, colours, width=0.5):
        shape = (len(screen), 3)
        self.parts.append((screen[..., :2], depth, np.broadcast_to(np.clip(colours, 0, 1), shape),
                           np.full(len(screen), width)))

    def draw(self, axes):
        corners, depth, colours, widths = (np.concatenate(part) for part in zip(*self.parts))
        order = np.argsort(-depth)
        # Outlines in the colour of the face, so that no background shows between two faces.
        axes.add_collection(PolyCollection(corners[order], facecolors=colours[order],
                                           edgecolors=colours[order], linewidths=widths[order]))
        axes.set_xlim(0, self.camera.width)
        axes.set_ylim(self.camera.height, 0)
        axes.set_aspect('equal')
        axes.set_facecolor(BACKGROUND)
        axes.set_xticks([])
        axes.set_yticks([])
        for side in axes.spines.values():
            side.set_visible(False)


def unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)


def lighting(normal):
    """The factor of a colour: light from the side and from above, and ambient light."""
    light = TO_LIGHT / np.linalg.norm(TO_LIGHT)
    return 0.50 + 0.42 * np.maximum(normal @ light, 0.0) + 0.12 * (0.5 + 0.5 * normal[:, 2])


def vertex_normals(points, faces):
    """Mean normals of the faces around each vertex, weighted by area."""
    flat = np.cross(points[faces[:, 1]] - points[faces[:, 0]],
                    points[faces[:, 2]] - points[faces[:, 0]])
    normals = np.zeros_like(points)
    for k in range(3):
        np.add.at(normals, faces[:, k], flat)
    return unit(normals)


def plot_figures(axes, run):
    times = [state.time for _, state in run.states]
    axes.plot(times, [state.broken.total for _, state in run.states], color='#d7263d')
    axes.set_xlabel('simulated time [s]')
    axes.set_ylabel('failed springs', color='#d7263d')
    strain = axes.twinx()
    strain.plot(times, [state.max_strain for _, state in run.states], color='#3f7fb5', lw=0.8)
    strain.set_ylabel('largest strain [-]', color='#3f7fb5')
    axes.set_ylim(bottom=0)
    strain.set_ylim(bottom=0)
    last = None
    for time, (_, state) in zip(times, run.states):
        if state.phase != last:
            axes.axvline(time, color='0.85', lw=0.8, zorder=0)
            last = state.phase


ASPECT = 460 / 560  # of a panel: height over width


def panel_size(text):
    """(width, height) [pixels] of WxH, or of a width alone."""
    width, cross, height = text.partition('x')
    size = int(width), int(height) if cross else round(ASPECT * int(width))
    if min(size) < 16 or max(size) > 10000:
        raise ValueError
    return size


def numbers(text):
    """The numbers of a list with commas."""
    return [float(part) for part in text.split(',')]


def angles(text):
    """(azimuth, elevation) [deg]."""
    azimuth, elevation = numbers(text)
    return azimuth, elevation


def draw_moment(axes, camera, scene, run, index):
    """Draws the cloth and its surroundings at a state of the run."""
    picture = Picture(camera)
    for triangles, colour in scene.solids(run.states[index][1], run.obstacle_poses(index)):
        picture.add_solid(triangles, colour)
    picture.add_cloth(*run.shape(index))
    picture.draw(axes)


def camera_for(run, indices, args):
    everywhere = np.concatenate([run.shape(index)[0][::7] for index in indices])
    return Camera(everywhere, *args.view, *args.size, args.zoom)


def draw_panels(run, scene, args):
    if args.times:
        moments = [('', run.state_at(time)) for time in args.times]
    else:
        moments = run.phase_ends()
    camera = camera_for(run, [index for _, index in moments], args)

    width, height = args.size
    only_one = args.times is not None and len(moments) == 1
    panels = len(moments) + (0 if args.times else 1)
    # The fewest empty places; four beside each other where it is all the same.
    columns = min(panels, 4) if panels <= 4 else min((4, 3, 5), key=lambda n: -panels % n)
    rows = -(-panels // columns)
    title_height = 0 if only_one else 40
    figure = plt.figure(facecolor='white', figsize=(columns * width / 100,
                                                    rows * (height + title_height) / 100))
    for number, (name, index) in enumerate(moments):
        axes = figure.add_subplot(rows, columns, number + 1)
        draw_moment(axes, camera, scene, run, index)
        if not only_one:
            title = f'{number + 1}  {name}' if name else f'{number + 1}'
            axes.set_title(f'{title}   {run.states[index][1].time:.2f} s', fontsize=11, loc='left')
    if only_one:
        figure.subplots_adjust(0, 0, 1, 1)
    else:
        figure.tight_layout(pad=0.6)
        if panels > len(moments):
            axes = figure.add_subplot(rows, columns, panels)
            plot_figures(axes, run)
            figure.tight_layout(pad=0.6)
    figure.savefig(args.out, dpi=100)


class GifWriter(matplotlib.animation.PillowWriter):
    """Pillow chooses the 256 colours of a frame better where it has no transparency."""

    def finish(self):
        self._frames = [frame.convert('RGB') for frame in self._frames]
        super().finish()


def video_writer(path, fps):
    if path.endswith('.gif'):
        return GifWriter(fps=fps)
    if not matplotlib.animation.FFMpegWriter.isAvailable():
        sys.exit(f'error: --video: {path}: mp4 needs ffmpeg (Debian: ffmpeg), gif does not')
    # Players want even sizes, and pixels of this kind.
    return matplotlib.animation.FFMpegWriter(fps=fps, extra_args=[
        '-vf', 'pad=ceil(iw/2)*2:ceil(ih/2)*2', '-pix_fmt', 'yuv420p'])


def draw_video(run, scene, args):
    """Draws a frame for every 1/fps of simulated time."""
    writer = video_writer(args.video, args.fps)
    first, last = run.states[0][1].time, run.states[-1][1].time
    count = int((last - first) * args.fps + 1e-6) + 1
    indices = [run.state_at(first + k / args.fps) for k in range(count)]
    camera = camera_for(run, indices[::max(1, count // 12)] + indices[-1:], args)
    width, height = args.size
    figure = plt.figure(facecolor='white', figsize=(width / 100, height / 100))
    axes = figure.add_axes((0, 0, 1, 1))
    try:
        with writer.saving(figure, args.video, dpi=100):
            for index in indices:
                axes.clear()
                draw_moment(axes, camera, scene, run, index)
                state = run.states[index][1]
                axes.text(0.02, 0.97, f'{state.time:.2f} s  {state.phase}', va='top', fontsize=10,
                          transform=axes.transAxes)
                writer.grab_frame()
    except OSError as error:
        sys.exit(f'error: --video: {args.video}: {error.strerror or error}')


def video_name(text):
    if not text.endswith(('.mp4', '.gif')):
        raise ValueError
    return text


def rate(text):
    if not 0 < float(text) <= 100:
        raise ValueError
    return float(text)


def zoom_factor(text):
    if not 0.01 <= float(text) <= 100:
        raise ValueError
    return float(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('bag')
    parser.add_argument('--out', help='the PNG to write')
    parser.add_argument('--video', type=video_name, help='the .mp4 (with ffmpeg) or .gif to write')
    parser.add_argument('--fps', type=rate, default=20, help='frames of the video per second')
    parser.add_argument('--scene', help='the scene file, or the name of one in config/scenes, with '
                        'obstacles and clamps other than those in the bag')
    parser.add_argument('--times', type=numbers, help='simulated times [s] instead of the ends of the phases')
    parser.add_argument('--view', type=angles, default='-62,24', help='azimuth,elevation of the eye [deg]')
    parser.add_argument('--zoom', type=zoom_factor, default=1.0,
                        help='less than 1 shows more of what is around the cloth')
    parser.add_argument('--size', type=panel_size, default='560x460',
                        help='WxH, or the width, of one panel [pixels]')
    args = parser.parse_args()
    if not args.out and not args.video:
        parser.error('--out or --video is required')

    run = Run(args.bag)
    scene = SceneFile(args.scene, run.scene(), run.phase_begins())
    if args.out:
        draw_panels(run, scene, args)
    if args.video:
        draw_video(run, scene, args)


if __name__ == '__main__':
    main()
