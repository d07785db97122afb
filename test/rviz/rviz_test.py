#!/usr/bin/python3
"""The display and the tools in the real rviz, on a virtual screen: where the cloth is drawn, in
which colours, and how the mouse cuts and drags it."""
import functools
import itertools
import math
import os
import sys
import unittest

import numpy
import rosgraph
import rospy
import rostest
from cloth_sim import msg, srv

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, os.pardir, 'ros')]
from polling import Listener, wait_until  # noqa: E402
from services import call, connections, state  # noqa: E402
from screen import RVIZ_NODE, Screen, is_near, missing_requirement, view_of  # noqa: E402

wait_until = functools.partial(wait_until, deadline=120.0)  # software GL on a busy machine

LAUNCHER = os.path.join(HERE, os.pardir, os.pardir, 'scripts', 'cloth_rviz')
BACKGROUND = (255, 0, 255)  # magenta, a colour of nothing else
CRIMSON = (230, 13, 64)     # of strokes and torn edges
LAST_STRAIN = (253, 231, 37)
DISTANCE = 2.6              # of the camera from the cloth [m]
MIDDLE = 1.0                # height of the middle of the view [m]
FIELD = math.pi / 4.0       # of view, up and down
WHEN_RELEASED = 'Cut\n      While Pressed: false'

# Looking along y: x is to the right, z up.
CONFIG = """
Panels: []
Visualization Manager:
  Class: ""
  Displays:
    - {Class: cloth_sim/Cloth, Enabled: true, Name: Cloth, Topic: /cloth/frame, %(display)s}
  Enabled: true
  Global Options: {Background Color: 255; 0; 255, Fixed Frame: world, Frame Rate: 30}
  Tools:
    - Class: cloth_sim/%(tool)s
    - Class: rviz/MoveCamera
  Value: true
  Views:
    Current:
      Class: rviz/Orbit
      Distance: %(distance)f
      Field of View: %(field)f
      Focal Point: {X: 0, Y: 0, Z: %(middle)f}
      Near Clip Distance: 0.01
      Pitch: 0
      Target Frame: <Fixed Frame>
      Yaw: %(yaw)f
Window Geometry:
  {Height: 700, Width: 900, X: 20, Y: 20, Hide Left Dock: true, Hide Right Dock: true}
"""


def config(tool, display='Torn Width: 0.02', behind=False, distance=DISTANCE):
    return CONFIG % {'tool': tool, 'display': display, 'distance': distance, 'field': FIELD,
                     'middle': MIDDLE, 'yaw': math.pi / 2 * (1 if behind else 3)}


class View:
    """Maps points of the world to pixels, and cuts regions out of a picture."""

    def __init__(self, screen):
        self.box = view_of(screen, BACKGROUND)
        left, top, right, bottom = self.box
        self.centre = (0.5 * (left + right), 0.5 * (top + bottom))
        self.scale = 0.5 * (bottom - top) / math.tan(0.5 * FIELD) / DISTANCE  # [px/m] at y = 0

    def pixel(self, x, z):
        """The pixel of a point (x, 0, z) [m] in the plane of the hanging cloth."""
        return (round(self.centre[0] + self.scale * x),
                round(self.centre[1] - self.scale * (z - MIDDLE)))

    def part(self, picture, low, high, grow=0):
        """The region of a picture between two points, each (x, z) [m], larger by `grow` pixels."""
        left, bottom = self.pixel(*low)
        right, top = self.pixel(*high)
        return picture[top - grow:bottom + 1 + grow, left - grow:right + 1 + grow]


class RvizTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        missing = missing_requirement()
        if missing:
            raise AssertionError(missing)
        cls.screen = Screen()

    @classmethod
    def tearDownClass(cls):
        cls.screen.close()

    def setUp(self):
        call('pause', srv.Pause, True)
        call('reset', srv.ResetScene)

    def tearDown(self):
        self.screen.release()  # where a test failed while the button was down
        self.screen.save(self.id().split('.')[-1] + '.png')

    def open(self, *arguments, **options):
        """The view, once the whole cloth is drawn as it hangs at the start. Starting rviz is slow, so
        a test uses the rviz of the test before it, in the order of their names, if the settings are
        the same."""
        self.screen.open_rviz(config(*arguments, **options))
        view = View(self.screen)
        wait_until(lambda: self.is_whole(view), 'the cloth')
        return view

    def is_whole(self, view):
        inside = view.part(self.screen.picture(), (-0.5, 0.5), (0.5, 1.5), grow=-2)
        return (is_near(inside, BACKGROUND, 2).mean() < 0.02 and not is_near(inside, CRIMSON).any())

    # ---- the display -----------------------------------------------------------------------------

    def test_display_draws_the_cloth_where_it_is_in_its_colours(self):
        view = self.open('Cut')
        picture = self.screen.picture()
        inside = view.part(picture, (-0.5, 0.5), (0.5, 1.5), grow=-2)
        # At rest and from the front, the first colour of the map, darkened by the shading: blue.
        red, green, blue = (inside[..., part] for part in range(3))
        self.assertGreater(((blue > green) & (green > red)).mean(), 0.98)
        # Nothing else is drawn except the legend at the lower left.
        left, top, right, bottom = view.box
        outside = picture[top:bottom, left:right].copy()
        view_part = view.part(picture, (-0.5, 0.5), (0.5, 1.5), grow=2)
        drawn = (~is_near(picture, BACKGROUND, 2))[top:bottom, left:right].sum()
        self.assertGreater(drawn, inside.shape[0] * inside.shape[1])
        legend = ~is_near(outside[-240:, :130], BACKGROUND, 2)
        self.assertLess(drawn - legend.sum(), 1.01 * view_part.shape[0] * view_part.shape[1])
        # The legend shows the whole colour map.
        self.assertGreater(is_near(outside[-240:, :130], LAST_STRAIN).sum(), 40)
        self.assertGreater(is_near(outside[-240:, :130], (59, 82, 139)).sum(), 40)

    def test_look_of_the_back(self):
        view = self.open('Cut', 'Back: {Value: true, Color: 0; 200; 0}', behind=True)
        inside = view.part(self.screen.picture(), (-0.45, 0.55), (0.45, 1.45))
        self.assertGreater((inside[..., 1] > inside[..., [0, 2]].max(axis=2) + 40).mean(), 0.98)

    def test_look_of_the_border(self):
        green = (0, 200, 0)
        view = self.open('Cut', 'Border: {Value: true, Color: 0; 200; 0, Width: 0.02}')
        picture = self.screen.picture()
        around = is_near(view.part(picture, (-0.5, 0.5), (0.5, 1.5), grow=6), green)
        inside = view.part(picture, (-0.45, 0.55), (0.45, 1.45))
        for name, side in (('top', around[:12].any(axis=0)), ('bottom', around[-12:].any(axis=0)),
                           ('left', around[:, :12].any(axis=1)),
                           ('right', around[:, -12:].any(axis=1))):
            self.assertGreater(side.mean(), 0.95, name)
        self.assertFalse(is_near(inside, green).any())
        self.open('Cut', 'Border: {Value: false, Color: 0; 200; 0, Width: 0.02}')
        self.assertFalse(is_near(self.screen.picture(), green).any())

    def test_look_of_the_wireframe(self):
        self.screen.open_rviz(config('Cut', 'Style: Wireframe'))
        view = View(self.screen)

        def lines():
            inside = view.part(self.screen.picture(), (-0.45, 0.55), (0.45, 1.45))
            return 0.1 < 1.0 - is_near(inside, BACKGROUND, 2).mean() < 0.9
        wait_until(lines, 'a wireframe')

    def test_display_draws_frames_as_they_come(self):
        view = self.open('Cut')
        before = self.screen.picture()
        call('cut', srv.Cut, stroke(0.8))
        call('step', srv.Step, 40)  # the lower part falls out of its place
        wait_until(lambda: is_near(view.part(self.screen.picture(), (-0.4, 0.62), (0.4, 0.72)),
                                   BACKGROUND, 2).mean() > 0.9, 'the fall')
        self.assertGreater((self.screen.picture() != before).sum(), 1000)

    def test_camera_frames_the_scene(self):
        self.screen.open_rviz(config('Cut', 'Frame Scene: true, Strain: false', distance=30.0))
        left, top, right, bottom = view_of(self.screen, BACKGROUND)

        def drawn():
            """Rows and columns of the view in which something is drawn."""
            picture = self.screen.picture()[top:bottom, left:right]
            cloth = ~is_near(picture, BACKGROUND, 2)
            return numpy.flatnonzero(cloth.any(axis=1)), numpy.flatnonzero(cloth.any(axis=0))

        def is_framed():
            rows, columns = drawn()
            return len(rows) > 0.7 * (bottom - top) and len(columns) > 0
        wait_until(is_framed, 'the camera to come near')  # from 30 m it fills a twelfth
        rows, columns = drawn()
        self.assertGreater(rows[0], 2)
        self.assertLess(rows[-1], bottom - top - 3)
        self.assertAlmostEqual(rows.mean(), 0.5 * (bottom - top), delta=0.05 * (bottom - top))
        self.assertAlmostEqual(columns.mean(), 0.5 * (right - left), delta=0.05 * (right - left))

    # ---- the launcher of cloth.launch ------------------------------------------------------------

    def subscribers(self, topic):
        """The nodes that subscribe to a topic. The master also lists nodes that were killed."""
        return {node for name, nodes in rosgraph.Master('/rviz_test').getSystemState()[1]
                if name == topic for node in nodes}

    def launch(self, *topics, **variables):
        """Starts rviz like the launch file and waits until it has subscribed to these topics.
        Returns the names of its nodes."""
        before = self.subscribers('/tf')
        self.screen.open([LAUNCHER], **variables)
        new = wait_until(lambda: self.subscribers('/tf') - before, 'rviz')
        for topic in topics:
            wait_until(lambda: self.subscribers(topic) >= new, topic)
        return new

    def test_launcher_takes_the_plugin(self):
        # The display subscribes to the first two, the panel to the third, its sliders to the last.
        rviz = self.launch('/cloth/frame', '/cloth/scene_markers', '/cloth/state',
                           '/cloth/parameter_updates')
        self.assertFalse(self.subscribers('/cloth/markers') & rviz)

    def test_launcher_takes_markers_where_there_is_no_plugin(self):
        rviz = self.launch('/cloth/markers', CMAKE_PREFIX_PATH='/nowhere')
        self.assertFalse(self.subscribers('/cloth/frame') & rviz)

    # ---- faults ----------------------------------------------------------------------------------

    def test_killed_in_a_run_and_started_again(self):
        self.open('Cut')
        call('pause', srv.Pause, False)
        wait_until(lambda: state().step > 10, 'a run')
        self.screen.kill_rviz()
        start = state().step
        wait_until(lambda: state().step > start + 60, 'the run to go on')
        self.assertFalse(state().failed)
        self.setUp()
        view = self.open('Cut')  # gets the latched topology
        call('cut', srv.Cut, stroke(0.8))
        call('step', srv.Step, 40)
        wait_until(lambda: is_near(view.part(self.screen.picture(), (-0.4, 0.62), (0.4, 0.72)),
                                   BACKGROUND, 2).mean() > 0.9, 'the fall')

    # ---- the tools -------------------------------------------------------------------------------

    def open_tool(self, tool, topic):
        """The view once what the tool publishes reaches the node: rviz may draw frames before."""
        view = self.open(tool)
        wait_until(lambda: ('o', topic, '/cloth') in connections('/' + RVIZ_NODE),
                   'the tool to be connected')
        return view

    def assert_areas(self, large, small):
        # The camera's pixel is 4 mm of the cloth; the row may be off by one.
        areas = [piece.rest_area for piece in state().piece]
        self.assertEqual(len(areas), 2)
        self.assertAlmostEqual(areas[0], large, delta=0.006)
        self.assertAlmostEqual(areas[1], small, delta=0.006)

    def test_cut_while_the_button_is_down(self):
        view = self.open_tool('Cut', '/cloth/cut_stroke')
        whole = state().particles
        row = [view.pixel(x, 0.8) for x in numpy.linspace(-0.65, 0.65, 27)]
        self.screen.drag(row[:14])
        ahead = iter(row[14:18])

        def is_cut():  # goes on by a little: a busy machine may lose a motion of the mouse
            self.screen.mouse('mousemove', *next(ahead, row[18]))
            return state().particles > whole
        wait_until(is_cut, 'a cut while the button is down')
        self.assertEqual(state().pieces, 1)  # half-way
        for point in row[19:]:
            self.screen.mouse('mousemove', *point)
        beyond = itertools.cycle(row[-2:])

        def is_whole():
            self.screen.mouse('mousemove', *next(beyond))
            return state().pieces >= 2 and state().piece[1].rest_area > 0.2
        wait_until(is_whole, 'the rest of it')
        self.screen.release()
        self.assert_areas(0.7, 0.3)

    def test_cut_while_the_button_is_down_and_given_up(self):
        view = self.open_tool('Cut', '/cloth/cut_stroke')
        whole = state().particles
        self.screen.drag([view.pixel(x, 0.8) for x in (-0.6, -0.4, -0.2)])
        wait_until(lambda: state().particles > whole, 'a cut while the button is down')
        self.screen.mouse('click', 3)
        for x in (0.2, 0.6):
            self.screen.mouse('mousemove', *view.pixel(x, 0.8))
        self.screen.release()
        self.screen.drag([view.pixel(x, 1.2) for x in (-0.6, -0.2, 0.2, 0.6)])
        self.screen.release()
        wait_until(lambda: state().pieces == 2, 'the second stroke')
        self.assert_areas(0.7, 0.3)  # the first did not go on

    def test_cut_where_the_mouse_drew_a_stroke(self):
        view = self.open_tool(WHEN_RELEASED, '/cloth/cut_stroke')
        height = 0.8
        row = [view.pixel(x, height) for x in numpy.linspace(-0.65, 0.65, 27)]
        self.screen.drag(row)

        def crimson(picture):
            row_part = view.part(picture, (-0.45, height - 0.02), (0.45, height + 0.02))
            return is_near(row_part, CRIMSON)
        wait_until(lambda: crimson(self.screen.picture()).any(axis=0).mean() > 0.9, 'the stroke')
        self.screen.save('stroke.png')
        self.assertEqual(state().pieces, 1)  # it is not cut before the button is released
        self.screen.release()
        wait_until(lambda: state().pieces == 2, 'the cut')
        self.assert_areas(0.7, 0.3)
        wait_until(lambda: crimson(self.screen.picture()).any(axis=0).mean() > 0.9, 'torn edges')

    def test_cut_that_is_given_up_cuts_nothing(self):
        view = self.open_tool(WHEN_RELEASED, '/cloth/cut_stroke')
        self.screen.drag([view.pixel(x, 0.8) for x in (-0.6, -0.2, 0.2, 0.6)])
        self.screen.mouse('click', 3)
        self.screen.release()
        self.screen.drag([view.pixel(x, 1.2) for x in (-0.6, -0.2, 0.2, 0.6)])
        self.screen.release()
        wait_until(lambda: state().pieces == 2, 'the second stroke')
        self.assert_areas(0.7, 0.3)  # not three pieces

    def test_drag_pulls_a_particle_and_lets_it_go(self):
        view = self.open_tool('Drag', '/cloth/drag')
        with Listener('/cloth/frame', msg.ClothFrame) as frames:
            frames.wait()

            def lowest_right():
                """x of the particle at the lower right corner."""
                return numpy.array(frames.messages[-1].positions).reshape(-1, 3)[32, 0]
            self.assertAlmostEqual(lowest_right(), 0.5, delta=1e-3)
            call('pause', srv.Pause, False)
            path = [view.pixel(x, 0.52) for x in numpy.linspace(0.49, 0.2, 12)]
            self.screen.drag(path)
            wait_until(lambda: lowest_right() < 0.3, 'the corner to follow')
            self.screen.save('drag.png')
            held = lowest_right()
            self.screen.release()
            wait_until(lambda: lowest_right() > held + 0.1, 'the corner to swing back')

    def test_refine_where_the_mouse_hovers(self):
        view = self.open('Refine')
        whole = state().particles
        self.screen.mouse('mousemove', *view.pixel(0.2, 1.1))
        self.screen.mouse('mousemove', *view.pixel(0.21, 1.1))
        wait_until(lambda: state().particles > whole, 'a finer mesh')
        with Listener('/cloth/frame', msg.ClothFrame) as frames:
            frames.wait()
            added = numpy.array(frames.messages[-1].positions).reshape(-1, 3)[whole:]
        # Bisections spread by a few cells (3 cm) beyond the radius of 3 cm.
        self.assertLess(numpy.abs(added - [0.2, 0.0, 1.1]).max(), 0.2)
        self.assertEqual(state().pieces, 1)


def stroke(height):
    from geometry_msgs.msg import Point, Vector3
    message = msg.CutStroke()
    message.header.frame_id = 'world'
    message.points = [Point(-1.0, 0.0, height), Point(1.0, 0.0, height)]
    message.direction = Vector3(0.0, 1.0, 0.0)
    return message


if __name__ == '__main__':
    rospy.init_node('rviz_test')
    rostest.rosrun('cloth_sim', 'rviz', RvizTest)
