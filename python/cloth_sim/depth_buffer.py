"""A depth buffer: of coloured triangles and lines on a screen, the nearest at each place."""
import numpy as np

SAMPLES = 3         # of a pixel, along each side
AT_ONCE = 2000000   # samples of triangles that are looked at together
NEAR = 0.01         # [m]: nothing is drawn that is not farther away


class DepthBuffer:
    """An image of `width` x `height` pixels, each the mean of SAMPLES x SAMPLES samples.

    Corners are (x [px], y [px], depth [m]), with the depth > 0 along the line of sight."""

    def __init__(self, width, height, background):
        self._size = np.array([width, height]) * SAMPLES
        count = self._size.prod()
        self._nearness = np.zeros(count)  # 1 / depth, which is linear on the screen
        self._colours = np.broadcast_to(_bytes(background), (count, 3)).copy()

    def add_triangles(self, corners, colours):
        """Draws triangles, corners (n, 3, 3), in colours (n, 3) of 0 to 1."""
        low, size = self._boxes(corners)
        area, planes = _planes(corners)
        seen = ((size.min(axis=1) > 0) & (np.abs(area) > 1e-12) &
                (corners[..., 2] > NEAR).all(axis=1))
        low, size, planes = low[seen], size[seen], planes[seen]
        colours = _bytes(colours[seen])
        counts = size.prod(axis=1)
        groups = np.cumsum(counts) // AT_ONCE
        for begin in np.flatnonzero(np.diff(groups, prepend=-1)):
            end = begin + np.count_nonzero(groups[begin:] == groups[begin])
            group = slice(begin, end)
            self._fill(low[group], size[group], counts[group], planes[group], colours[group])

    def add_lines(self, ends, colour, width, ahead):
        """Draws lines between ends (n, 2, 3), `width` [px] wide.

        `ahead`: by which fraction of their depth they are drawn nearer than they are"""
        ends = ends.copy()
        ends[..., 2] *= 1 - ahead
        along = ends[:, 1, :2] - ends[:, 0, :2]
        along *= width / 2 / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
        across = np.stack([-along[:, 1], along[:, 0]], axis=1)
        corners = np.repeat(ends, 2, axis=1)
        for k, offset in enumerate((-along - across, -along + across, along - across,
                                    along + across)):
            corners[:, k, :2] += offset
        triangles = np.concatenate([corners[:, :3], corners[:, 1:]])
        self.add_triangles(triangles, np.broadcast_to(colour, (len(triangles), 3)))

    def samples(self):
        """The colours of all samples, shape (SAMPLES * height, SAMPLES * width, 3), uint8."""
        return self._colours.reshape(self._size[1], self._size[0], 3)

    def image(self):
        """The image, shape (height, width, 3), uint8."""
        width, height = self._size // SAMPLES
        blocks = self._colours.reshape(height, SAMPLES, width, SAMPLES, 3)
        return np.round(blocks.mean(axis=(1, 3))).astype(np.uint8)

    def _boxes(self, corners):
        """The first sample and the number of samples (n, 2) of the box around each triangle."""
        places = corners[..., :2] * SAMPLES - 0.5
        low = np.maximum(np.ceil(places.min(axis=1)), 0)
        high = np.minimum(np.floor(places.max(axis=1)), self._size - 1)
        return low.astype(int), np.maximum(high - low + 1, 0).astype(int)

    def _fill(self, low, size, counts, planes, colours):
        """Draws triangles sample by sample, in boxes of `counts` samples."""
        triangle = np.repeat(np.arange(len(counts)), counts)
        place = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        y, x = np.divmod(place, size[triangle, 0])
        x += low[triangle, 0]
        y += low[triangle, 1]
        # Weights of the corners, and the nearness.
        values = [planes[:, k, 0][triangle] * x + planes[:, k, 1][triangle] * y +
                  planes[:, k, 2][triangle] for k in range(4)]
        inside = np.minimum(np.minimum(values[0], values[1]), values[2]) >= -1e-9
        sample = (y * self._size[0] + x)[inside]
        nearness = values[3][inside]
        np.maximum.at(self._nearness, sample, nearness)
        nearest = nearness == self._nearness[sample]
        self._colours[sample[nearest]] = colours[triangle[inside][nearest]]


def _planes(corners):
    """Twice the area (n), and (n, 4, 3): three numbers (a, b, c) for the weight of each corner and
    for the nearness, each of which is a x + b y + c at the sample (x, y)."""
    places = corners[..., :2] * SAMPLES - 0.5
    (ax, ay), (bx, by), (cx, cy) = (places[:, k].T for k in range(3))
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    inverse = 1 / np.where(np.abs(area) > 1e-12, area, 1)
    weights = np.stack([np.stack([(py - qy) * inverse, (qx - px) * inverse,
                                  (px * qy - qx * py) * inverse], axis=1)
                        for (px, py), (qx, qy) in (((bx, by), (cx, cy)), ((cx, cy), (ax, ay)),
                                                   ((ax, ay), (bx, by)))], axis=1)
    nearness = np.einsum('nk,nkc->nc', 1 / corners[..., 2], weights)
    return area, np.concatenate([weights, nearness[:, None]], axis=1)


def _bytes(colours):
    return np.round(255 * np.clip(colours, 0, 1)).astype(np.uint8)
