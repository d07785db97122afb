"""Unit quaternions [x, y, z, w] and rotation vectors [rad]."""
import numpy as np


def from_vector(vector):
    """The rotation about a vector by its length."""
    vector = np.asarray(vector, dtype=float)
    angle = np.linalg.norm(vector)
    return np.append(0.5 * np.sinc(angle / (2 * np.pi)) * vector, np.cos(angle / 2))


def to_vector(turn):
    """The shortest rotation vector of a quaternion."""
    turn = np.asarray(turn, dtype=float)
    turn = turn if turn[3] >= 0 else -turn
    sine = np.linalg.norm(turn[:3])
    if sine < 1e-12:
        return 2 * turn[:3]
    return 2 * np.arctan2(sine, turn[3]) / sine * turn[:3]


def product(second, first):
    """First one rotation, then another; of norm 1 to round-off."""
    a, b = np.asarray(second, dtype=float), np.asarray(first, dtype=float)
    vector = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    turn = np.append(vector, a[3] * b[3] - a[:3] @ b[:3])
    return turn / np.linalg.norm(turn)


def inverse(turn):
    return np.append(-np.asarray(turn[:3], dtype=float), turn[3])
