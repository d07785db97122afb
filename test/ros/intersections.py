"""Places where a surface of triangles passes through itself."""
import numpy as np


def crossings(places, faces):
    """The number of edges that pass through a face with which they share no vertex.

    places: [n, 3] [m]; faces: [m, 3] vertex numbers."""
    edges = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]],
                                              faces[:, [2, 0]]]), axis=1), axis=0)
    corners, ends = places[faces], places[edges]
    face_low, face_high = corners.min(axis=1), corners.max(axis=1)
    edge_low, edge_high = ends.min(axis=1), ends.max(axis=1)
    count = 0
    for face, low, high, triangle in zip(faces, face_low, face_high, corners):
        near = np.all((edge_low <= high) & (edge_high >= low), axis=1)
        near &= ~np.isin(edges, face).any(axis=1)
        count += np.count_nonzero(_pass_through(ends[near], triangle))
    return count


def _pass_through(ends, triangle):
    """Whether each edge [n, 2, 3] passes through the triangle [3, 3]."""
    def volume(a, b, c, d):  # six times that of the tetrahedron, with a sign
        return np.einsum('...i,...i->...', np.cross(b - a, c - a), d - a)

    a, b = ends[:, 0], ends[:, 1]
    p, q, r = triangle
    apart = volume(p, q, r, a) * volume(p, q, r, b) < 0
    turns = np.stack([volume(a, b, p, q), volume(a, b, q, r), volume(a, b, r, p)])
    return apart & (np.all(turns > 0, axis=0) | np.all(turns < 0, axis=0))
