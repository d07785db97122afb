"""Positions of the particles in the frames of a bag or topic."""
import numpy as np

TOPICS = ('frame', 'compact_frame')  # last parts of their names


def positions(frame):
    """The positions [m] of a ClothFrame or a CompactFrame, shape (particles, 3)."""
    if hasattr(frame, 'positions'):
        return np.array(frame.positions, dtype='f4').reshape(-1, 3)
    increments = np.array(frame.increments, dtype='i8').reshape(-1, 3)
    return (frame.origin + frame.unit * np.cumsum(increments, axis=0)).astype('f4')
