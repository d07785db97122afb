"""Draws the cloth, obstacles and clamps in perspective; needs no display.

Colours of the cloth show its strain; its back is of another colour, its border is dark, edges that
tearing made are dark red.
"""
import math
import os

import numpy as np

from cloth_sim.collada import read_collada
from cloth_sim.depth_buffer import DepthBuffer

# Colours of equal steps of strain.
FRONT = np.array([[127, 178, 217], [63, 127, 181], [242, 193, 78], [215, 38, 61]]) / 255
BACK = np.array([[227, 211, 189], [199, 169, 128], [242, 193, 78], [215, 38, 61]]) / 255
FULL_STRAIN = 0.2  # [-] where the colours end
TORN = np.array([0.45, 0.02, 0.06])
BORDER = np.array([0.13, 0.20, 0.30])
BOARD = np.array([0.80, 0.79, 0.76])
BALL = np.array([0.45, 0.62, 0.45])
STEEL = np.array([0.30, 0.32, 0.36])
BACKGROUND = np.array([0.965, 0.97, 0.975])
TO_LIGHT = np.array([0.25, -0.45, 0.86])


# ---- strain: the definition of include/cloth_sim/cloth/strain.h ----------------------------------

class Topology:
    """The fixed part of a drawn cloth: vertices of its triangles (m, 3) and of its torn edges
    (k, 2), and material coordinates [m] (n, 2)."""

    def __init__(self, faces, uv, torn):
        self.faces, self.uv, self.torn = faces, uv, torn
        self.lines = strain_lines(faces, uv)
        self.border = border_edges(faces, torn)


def face_edges(faces):
    """Vertex pairs (3 m, 2), the lower one first: one edge of all faces, then the next."""
    return np.concatenate([np.sort(faces[:, [k, (k + 1) % 3]], axis=1) for k in range(3)])


def border_edges(faces, torn):
    """Vertex pairs (k, 2) of the edges with one face that are not torn."""
    pairs = np.concatenate([face_edges(faces), np.sort(torn, axis=1)])
    keys = pairs @ (pairs.max(initial=0) + 1, 1)
    _, index, count = np.unique(keys, return_index=True, return_counts=True)
    return pairs[index[count == 1]]


def strain_lines(faces, uv):
    """Vertex pairs (n, 2) of the structural and shear springs: every edge, and across every inner
    bias edge the other diagonal, if that is a bias direction, too."""
    edges = face_edges(faces)
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
    """Largest strain of the springs at each vertex: length over rest length less 1; slack: 0."""
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


# ---- obstacles and clamps ------------------------------------------------------------------------

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
    """Triangles (n, 3, 3) of an STL or OBJ file in its units, or of a Collada file in metres."""
    with open(path, 'rb') as file:
        data = file.read()
    if path.lower().endswith('.dae'):
        return read_collada(data)
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


class DrawingError(Exception):
    """A scene that cannot be drawn; the message is one line."""


class Scene:
    """The obstacles and clamps of a scene."""

    MARKERS = {'bounds': 0, 'capsule': 3}  # of an obstacle; of all other types it is one

    def __init__(self, scene, folders=(), begins=None):
        """From the maps of a scene file.

        `folders`: where meshes of obstacles may be
        `begins`: the time at which each phase of the run begins, by its name"""
        self.folders = folders
        self.meshes = {}
        self.obstacles = scene.get('obstacles') or {}
        # Phases come in the order of the scene; one that did not begin moves nothing.
        self.changes = [(begins[phase['name']], phase['obstacles'])
                        for phase in scene.get('phases') or []
                        if phase.get('obstacles') and phase.get('name') in (begins or {})]
        self.plates = {name: clamp.get('plate_size')
                       for name, clamp in (scene.get('clamps') or {}).items()}

    def solids(self, state, poses=()):
        """[(triangles, colour)] at the time of a state.

        `poses`: of the markers of the obstacles, in their order, if there are any"""
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
            paths = [os.path.join(folder, name) for folder in self.folders]
            path = next((path for path in paths if os.path.exists(path)), None)
            if path is None:
                raise DrawingError(f'cannot find the mesh {name}: give --scene')
            self.meshes[name] = read_mesh(path)
        return self.meshes[name] * np.array(entry.get('scale', 1), dtype=float)

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
        raise DrawingError(f"cannot draw an obstacle of type {entry['type']}")

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

    def __init__(self, points, azimuth, elevation, width, height, zoom=1.0):
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
    """Bodies and cloths as they are seen by a camera."""

    BEHIND = 0.002   # of the depth: bodies are drawn farther away, so that cloth lies on them
    AHEAD = 0.00025  # of the depth: the border is nearer than its faces, not than a layer above
    TORN_AHEAD = 0.002

    def __init__(self, camera):
        self.camera = camera
        self.buffer = DepthBuffer(camera.width, camera.height, BACKGROUND)

    def add_solid(self, triangles, colour):
        """Adds triangles (n, 3, 3) of a closed body, over which cloth that lies on it is drawn."""
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        towards_us = np.einsum('td,td->t', normal, self.camera.eye - triangles[:, 0]) > 0
        triangles, normal = triangles[towards_us], unit(normal[towards_us])
        screen = self.camera.project(triangles)
        screen[..., 2] *= 1 + self.BEHIND
        self.buffer.add_triangles(screen, colour * lighting(normal)[:, None])

    def add_cloth(self, points, topology):
        """Adds both sides of a cloth, coloured by strain, its border and its torn edges."""
        faces = topology.faces
        normals = vertex_normals(points, faces)[faces].mean(axis=1)
        from_front = np.einsum('td,td->t', normals, self.camera.eye - points[faces[:, 0]]) > 0
        level = face_strains(topology, points) / FULL_STRAIN
        colours = np.where(from_front[:, None], colour_of(level, FRONT), colour_of(level, BACK))
        light = lighting(unit(np.where(from_front[:, None], normals, -normals)))
        self.buffer.add_triangles(self.camera.project(points[faces]), colours * light[:, None])
        for edges, colour, width, ahead in ((topology.border, BORDER, 1.0, self.AHEAD),
                                            (topology.torn, TORN, 1.5, self.TORN_AHEAD)):
            self.buffer.add_lines(self.camera.project(points[edges]), colour, width, ahead)


def colour_of(level, colours):
    """Colours (n, 3) at levels (n) of 0 to 1, between equally spaced ones."""
    steps = np.linspace(0, 1, len(colours))
    return np.stack([np.interp(level, steps, part) for part in colours.T], axis=1)


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


def image_of(camera, scene, state, points, topology):
    """An image of one moment, shape (height, width, 3), uint8.

    `state`: a message cloth_sim/ClothState
    `points`: positions [m] of the cloth"""
    picture = Picture(camera)
    for triangles, colour in scene.solids(state):
        picture.add_solid(triangles, colour)
    picture.add_cloth(points, topology)
    return picture.buffer.image()
