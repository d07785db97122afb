"""Measures of a cloth's shape, from its vertices; lengths in m, areas in m^2."""
import numpy as np

CELL = 0.002  # of the raster of covered_area [m]


def area(faces):
    """Area of triangles in a plane, corners (n, 3, 2)."""
    a, b, c = (faces[:, k] for k in range(3))
    return float(0.5 * np.abs(_cross(b - a, c - a)).sum())


def rest_area(surface):
    return area(surface.uv[surface.faces])


def covered_area(surface, cell=CELL):
    """Area of the cloth as seen from above: the cells of a raster whose middle is under a face."""
    corners = surface.points[surface.faces][..., :2].astype(float) / cell
    low = np.ceil(corners.min(axis=1) - 0.5).astype(int)
    size = int((np.floor(corners.max(axis=1) - 0.5).astype(int) - low).max(initial=0)) + 1
    window = np.stack(np.meshgrid(range(size), range(size), indexing='ij'), -1).reshape(1, -1, 2)
    cells = low[:, None] + window
    a, b, c = (corners[:, None, k] for k in range(3))
    middle = cells + 0.5
    sides = np.stack([_cross(b - a, middle - a), _cross(c - b, middle - b),
                      _cross(a - c, middle - c)])
    inside = cells[(sides >= 0).all(axis=0) | (sides <= 0).all(axis=0)]
    return len(np.unique(inside, axis=0)) * cell * cell


def _cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def near(surface, places):
    """The vertex nearest to each material place (n, 2)."""
    places = np.asarray(places, dtype=float)
    return np.array([((surface.uv - place) ** 2).sum(axis=1).argmin() for place in places])


def rms(lengths):
    lengths = np.asarray(lengths, dtype=float)
    return float(np.sqrt(np.mean(lengths ** 2))) if lengths.size else 0.0


def misfit(points, shape):
    """Distances of points (n, 2) from a shape (n, 2), which is first moved, turned and, if need be,
    mirrored to fit best (Kabsch 1976)."""
    points, shape = points - points.mean(axis=0), shape - shape.mean(axis=0)
    u, _, v = np.linalg.svd(shape.T @ points)
    return np.linalg.norm(shape @ u @ v - points, axis=1)


def pieces(surface):
    """The piece of each face: numbers from 0."""
    label = np.arange(len(surface.points))
    while True:
        least = label[surface.faces].min(axis=1)
        after = label.copy()
        np.minimum.at(after, surface.faces.ravel(), np.repeat(least, 3))
        after = after[after]
        if np.array_equal(after, label):
            break
        label = after
    return np.unique(label[surface.faces[:, 0]], return_inverse=True)[1]


def piece_areas(surface):
    """Rest areas of the pieces, the largest first."""
    piece = pieces(surface)
    return sorted((area(surface.uv[surface.faces[piece == k]]) for k in range(piece.max() + 1)),
                  reverse=True)
