#!/usr/bin/python3
"""The cloth as a point cloud, a mesh and a camera sees it, figures in the diagnostics, an obstacle
that follows tf."""
import math
import os
import sys
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped
from sensor_msgs import point_cloud2
from sensor_msgs.msg import PointCloud2
from shape_msgs.msg import Mesh
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from cloth_sim import msg, srv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import Listener, connected, node_log, wait_until  # noqa: E402

PARTICLES = 17 * 17


class OutputsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.wait_for_service('/cloth/step', 30.0)
        cls.step = rospy.ServiceProxy('/cloth/step', srv.Step)
        cls.reset = rospy.ServiceProxy('/cloth/reset', srv.ResetScene)

    def test_points(self):
        with Listener('/cloth/points', PointCloud2) as clouds:
            cloud = clouds.wait()
        self.assertEqual(cloud.header.frame_id, 'world')
        names = ['x', 'y', 'z', 'strain', 'normal_x', 'normal_y', 'normal_z']
        self.assertEqual([field.name for field in cloud.fields], names)
        points = list(point_cloud2.read_points(cloud, names))
        self.assertEqual(len(points), PARTICLES)
        for x, y, z, strain, *normal in points:
            self.assertLessEqual(max(abs(x), abs(y)), 0.25)
            self.assertLess(z, 0.6)
            self.assertGreaterEqual(strain, 0.0)
            self.assertAlmostEqual(math.sqrt(sum(n * n for n in normal)), 1.0, places=5)

    def test_mesh(self):
        with Listener('/cloth/mesh', Mesh) as meshes:
            mesh = meshes.wait()
        self.assertEqual(len(mesh.vertices), PARTICLES)
        self.assertEqual(len(mesh.triangles), 2 * 16 * 16)
        used = {v for triangle in mesh.triangles for v in triangle.vertex_indices}
        self.assertEqual(used, set(range(PARTICLES)))

    def test_the_camera_sees_the_cloth_from_where_its_frame_is(self):
        """The camera looks down on the level cloth of 0.4 m from 1 m. A pixel is 2 tan(30 deg) / 80 m
        there, so the cloth is 27.7 pixels wide and covers the middles of 28 x 28 pixels."""
        self.reset(0)
        transform = TransformStamped()
        transform.header.frame_id = 'world'
        transform.child_frame_id = 'eye'
        transform.transform.translation.z = 1.5
        transform.transform.rotation.x = 1.0  # half a turn about x: z points down
        with node_log() as log, Listener('/cloth/camera_points', PointCloud2) as seen:
            log.wait(lambda line: "the camera sends no points: no transform from 'eye'" in line.msg)
            self.assertEqual(seen.messages, [])
            static = connected('/tf_static', TFMessage, latch=True)
            static.publish(TFMessage([transform]))
            cloud = seen.wait()
        self.assertEqual(cloud.header.frame_id, 'eye')
        self.assertEqual((cloud.width, cloud.height), (80, 60))
        names = ['x', 'y', 'z', 'strain']
        self.assertEqual([field.name for field in cloud.fields], names)
        points = [point for point in point_cloud2.read_points(cloud, names)
                  if not math.isnan(point[2])]
        self.assertEqual(len(points), 28 * 28)
        for x, y, z, strain in points:
            self.assertLess(max(abs(x), abs(y)), 0.2)
            self.assertAlmostEqual(z, 1.0, places=5)
            self.assertAlmostEqual(strain, 0.0, places=5)
        self.check_that_nothing_is_sent_without_subscribers(cloud.header.seq)

    def check_that_nothing_is_sent_without_subscribers(self, last):
        """The node numbers what it publishes. It could send each of twenty steps; one message may
        be on its way while it learns that nobody listens."""
        with Listener('/cloth/state', msg.ClothState) as states:
            for _ in range(20):
                step = self.step(1).step
                states.wait(lambda state, step=step: state.step >= step)
        with Listener('/cloth/camera_points', PointCloud2) as seen:
            self.assertLessEqual(seen.wait().header.seq, last + 3)

    def test_diagnostics(self):
        def figures(message):
            for status in message.status:
                values = {entry.key: entry.value for entry in status.values}
                if 'substep [s]' in values:
                    return values
            return None
        with Listener('/diagnostics', DiagnosticArray) as diagnostics:
            values = figures(diagnostics.wait(figures))
        self.assertGreater(float(values['substep [s]']), 0.0)
        self.assertGreater(float(values['substep over the limit of explicit methods']), 0.0)
        for key in ('max strain', 'dropped commands', 'real-time factor'):
            self.assertIn(key, values)

    def test_an_obstacle_goes_where_its_frame_is(self):
        transform = TransformStamped()
        transform.header.frame_id = 'world'
        transform.child_frame_id = 'ball_link'
        transform.transform.rotation.w = 1.0
        static = connected('/tf_static', TFMessage, latch=True)
        with Listener('/cloth/markers', MarkerArray) as markers:
            for height in (0.25, 0.3):
                transform.transform.translation.z = height
                static.publish(TFMessage([transform]))

                def ball_is_there():
                    self.step(1)
                    balls = [m for array in markers.messages[-1:] for m in array.markers
                             if m.ns == 'obstacles' and m.type == Marker.SPHERE]
                    return balls and abs(balls[0].pose.position.z - height) < 1e-9
                wait_until(ball_is_there, 'the sphere at its frame')
            # A static frame says its place once; a reset puts the sphere back to that of the scene.
            self.assertTrue(self.reset(0).success)
            wait_until(ball_is_there, 'the sphere at its frame again')


if __name__ == '__main__':
    rospy.init_node('outputs_test')
    rostest.rosrun('cloth_sim', 'outputs', OutputsTest)
