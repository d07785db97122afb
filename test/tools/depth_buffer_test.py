#!/usr/bin/python3
"""The depth buffer of pictures: what is nearest is seen, in its place and to the pixel."""
import unittest

import numpy
import rosunit
from cloth_sim.depth_buffer import DepthBuffer, SAMPLES

WHITE = numpy.ones(3)
RED, BLUE = numpy.eye(3)[[0, 2]]


def square(low, high, depth):
    """Two triangles (2, 3, 3) between (x, y) of `low` and `high` [px]."""
    (x, y), (right, top) = low, high
    corners = numpy.array([[x, y], [right, y], [right, top], [x, top]], dtype=float)
    corners = numpy.column_stack([corners, numpy.broadcast_to(depth, 4)])
    return corners[[[0, 1, 2], [0, 2, 3]]]


def is_colour(image, colour):
    return (image == numpy.round(255 * colour)).all(axis=-1)


class DepthBufferTest(unittest.TestCase):
    def setUp(self):
        self.buffer = DepthBuffer(20, 10, WHITE)

    def add(self, triangles, colour):
        self.buffer.add_triangles(triangles, numpy.broadcast_to(colour, (len(triangles), 3)))

    def test_a_square_fills_its_pixels(self):
        self.add(square((3, 2), (12, 6), 1.0), RED)
        image = self.buffer.image()
        self.assertEqual(image.shape, (10, 20, 3))
        wanted = numpy.zeros((10, 20), dtype=bool)
        wanted[2:6, 3:12] = True
        numpy.testing.assert_array_equal(is_colour(image, RED), wanted)
        numpy.testing.assert_array_equal(is_colour(image, WHITE), ~wanted)

    def test_a_border_within_a_pixel_is_a_mean(self):
        self.add(square((0, 0), (4 + 1 / SAMPLES, 10), 1.0), RED)
        numpy.testing.assert_array_equal(self.buffer.image()[5, 4],
                                         [255, *2 * [round(255 * (1 - 1 / SAMPLES))]])

    def test_the_nearer_is_seen_whatever_comes_first(self):
        near, far = square((0, 0), (10, 10), 1.0), square((5, 0), (15, 10), 2.0)
        images = []
        for first in (True, False):
            self.setUp()
            for triangles, colour in sorted(((near, RED), (far, BLUE)), reverse=first,
                                            key=lambda pair: pair[0][0, 0, 2]):
                self.add(triangles, colour)
            images.append(self.buffer.image())
        numpy.testing.assert_array_equal(images[0], images[1])
        self.assertTrue(is_colour(images[0][:, :10], RED).all())
        self.assertTrue(is_colour(images[0][:, 10:15], BLUE).all())

    def test_planes_cross_where_perspective_has_them(self):
        # From 1 m at the left to 3 m at the right; half-way on the screen it is 1.5 m away.
        self.add(square((0, 0), (20, 10), [1.0, 3.0, 3.0, 1.0]), RED)
        self.add(square((0, 0), (20, 10), 1.5), BLUE)
        image = self.buffer.image()
        self.assertTrue(is_colour(image[:, :10], RED).all())
        self.assertTrue(is_colour(image[:, 10:], BLUE).all())

    def test_a_line_is_hidden_by_what_is_nearer_than_it_is_ahead(self):
        self.add(square((0, 0), (10, 10), 1.0), RED)
        self.add(square((10, 0), (20, 10), 1.01), RED)
        self.buffer.add_lines(numpy.array([[[2.0, 5.0, 1.01], [18.0, 5.0, 1.01]]]), BLUE, width=2,
                              ahead=0.001)
        image = self.buffer.image()
        self.assertTrue(is_colour(image[4:6, 10:19], BLUE).all())
        self.assertTrue(is_colour(image[4:6, :10], RED).all())
        self.assertFalse(is_colour(image[:4], BLUE).any())

    def test_what_is_outside_or_a_line_on_the_screen_draws_nothing(self):
        self.add(square((-30, 2), (-20, 8), 1.0), RED)
        self.add(square((5, 2), (5, 8), 1.0), RED)
        self.add(numpy.zeros((0, 3, 3)), RED)
        self.assertTrue(is_colour(self.buffer.image(), WHITE).all())
        self.add(square((-1e6, -1e6), (1e6, 1e6), 1.0), RED)
        self.assertTrue(is_colour(self.buffer.image(), RED).all())


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'depth_buffer', DepthBufferTest)
