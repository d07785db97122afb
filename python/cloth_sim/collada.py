"""Triangles of a Collada file, for pictures: as src/scene/dae_mesh.cpp reads them for simulations,
which has said before what is wrong with a file."""
import math
import xml.etree.ElementTree as ElementTree

import numpy as np


def read_collada(data):
    """Triangles (n, 3, 3) [m] of the bytes of a file, where the nodes of its scene have them."""
    root = ElementTree.fromstring(data)
    for element in root.iter():
        element.tag = element.tag.rpartition('}')[2]  # without the namespace
    by_id = {element.get('id'): element for element in root.iter() if element.get('id')}
    instance = root.find('scene/instance_visual_scene')
    scene = _target(by_id, instance.get('url')) if instance is not None else \
        root.find('library_visual_scenes/visual_scene')
    if scene is None:
        parts = [_triangles(by_id, mesh) for mesh in root.iterfind('library_geometries/geometry/mesh')]
    else:
        parts = list(_instances(by_id, scene, np.eye(4)))
    unit = root.find('asset/unit')
    metre = float(unit.get('meter', 1)) if unit is not None else 1.0
    return metre * np.concatenate(parts or [np.empty((0, 3, 3))])


def _target(by_id, url):
    return by_id[url[1:]]


def _instances(by_id, node, transform):
    for element in node:
        if element.tag == 'node':
            yield from _instances(by_id, element, transform)
        elif element.tag == 'instance_node':
            yield from _instances(by_id, _target(by_id, element.get('url')), transform)
        elif element.tag == 'instance_geometry':
            mesh = _target(by_id, element.get('url')).find('mesh')
            if mesh is not None:
                yield _triangles(by_id, mesh) @ transform[:3, :3].T + transform[:3, 3]
        else:
            transform = transform @ _transform(element)


def _transform(element):
    result = np.eye(4)
    if element.tag not in ('matrix', 'translate', 'scale', 'rotate'):
        return result
    numbers = np.array(element.text.split(), dtype=float)
    if element.tag == 'matrix':
        return numbers.reshape(4, 4)
    if element.tag == 'translate':
        result[:3, 3] = numbers
    elif element.tag == 'scale':
        result[:3, :3] = np.diag(numbers)
    else:
        x, y, z = numbers[:3] / np.linalg.norm(numbers[:3])
        c, s = math.cos(math.radians(numbers[3])), math.sin(math.radians(numbers[3]))
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        result[:3, :3] = np.eye(3) + s * cross + (1 - c) * cross @ cross
    return result


def _triangles(by_id, mesh):
    corners = []
    for faces in mesh:
        if faces.tag not in ('triangles', 'polylist', 'polygons', 'tristrips', 'trifans'):
            continue
        inputs = faces.findall('input')
        stride = 1 + max(int(it.get('offset', 0)) for it in inputs)
        vertex = next(it for it in inputs if it.get('semantic') == 'VERTEX')
        vertices = _target(by_id, vertex.get('source'))
        source = next(it for it in vertices.findall('input') if it.get('semantic') == 'POSITION')
        positions = _positions(_target(by_id, source.get('source')))
        counts = faces.findtext('vcount')
        for p in faces.findall('p'):
            points = positions[np.array(p.text.split(), dtype=int)[int(vertex.get('offset', 0))::stride]]
            corners += _divide(faces.tag, points, counts)
    return np.array(corners).reshape(-1, 3, 3)


def _positions(source):
    numbers = np.array(source.findtext('float_array').split(), dtype=float)
    accessor = source.find('technique_common/accessor')
    stride = 3 if accessor is None else int(accessor.get('stride', 1))
    numbers = numbers[0 if accessor is None else int(accessor.get('offset', 0)):]
    rows = (len(numbers) - 3) // stride + 1
    return np.array([numbers[k * stride:k * stride + 3] for k in range(rows)])


def _divide(kind, points, counts):
    if kind == 'tristrips':
        return [(a, b, c) if k % 2 == 0 else (b, a, c)
                for k, (a, b, c) in enumerate(zip(points, points[1:], points[2:]))]
    if kind == 'triangles':
        sizes = [3] * (len(points) // 3)
    elif kind == 'polylist':
        sizes = [int(word) for word in counts.split()]
    else:
        sizes = [len(points)]
    triangles, first = [], 0
    for size in sizes:
        fan = points[first:first + size]
        triangles += [(fan[0], b, c) for b, c in zip(fan[1:], fan[2:])]
        first += size
    return triangles
