#!/usr/bin/python3
"""Every service and topic of the node, with good and with bad input."""
import math
import os
import sys

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point, PoseStamped, TransformStamped, Vector3, WrenchStamped
from std_msgs.msg import Bool, String
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from cloth_sim import msg, srv

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from polling import Listener, connected, node_log, wait_until  # noqa: E402
from services import ServiceTest, connections  # noqa: E402

SERVICES = dict(set_clamp_pose=srv.SetClampPose, grasp=srv.Grasp, cut=srv.Cut, refine=srv.Refine,
                set_phase=srv.StartPhase, pause=srv.Pause, step=srv.Step, reset=srv.ResetScene,
                set_resolution=srv.ChangeResolution, get_state=srv.GetState)
NAN = float('nan')


def pose(x=0.0, y=0.0, z=0.6, frame='world', w=1.0):
    message = PoseStamped()
    message.header.frame_id = frame
    message.pose.position = Point(x, y, z)
    message.pose.orientation.w = w
    return message


BAD_POSES = dict(nan=pose(x=NAN), infinite=pose(z=math.inf), not_unit=pose(w=0.5),
                 zero_quaternion=pose(w=0.0), nan_quaternion=pose(w=NAN),
                 unknown_frame=pose(frame='nowhere'), no_frame=pose(frame=''))


def stroke(points=((-0.1, 0.01, 0.5), (0.1, 0.01, 0.5)), direction=(0, 0, -1), frame='world',
           half_width=0.0, heels=(), reach=0.0):
    """By default a slit inside of the cloth, which lies at z = 0.5 from -0.2 to 0.2 in x and y."""
    message = msg.CutStroke()
    message.header.frame_id = frame
    message.points = [Point(*point) for point in points]
    message.heels = [Point(*point) for point in heels]
    message.direction = Vector3(*direction)
    message.reach = reach
    message.half_width = half_width
    return message


THROUGH = stroke(points=((-0.3, 0.01, 0.5), (0.3, 0.01, 0.5)))  # parts the cloth
MISSES = stroke(points=((-0.3, 0.01, 2.5), (0.3, 0.01, 2.5)))   # reaches down to z = 1.5
BAD_STROKES = dict(empty=stroke(points=()), single=stroke(points=((0, 0, 0),)),
                   nan=stroke(points=((0, 0, NAN), (1, 0, 0))),
                   no_direction=stroke(direction=(0, 0, 0)),
                   nan_direction=stroke(direction=(0, 0, NAN)),
                   still=stroke(points=((0, 0, 0.5), (0, 0, 0.5))), reach=stroke(reach=-1.0),
                   heels=stroke(heels=((0, 0, 1),)), unknown_frame=stroke(frame='nowhere'),
                   no_frame=stroke(frame=''), negative=stroke(half_width=-0.1))


class ApiTest(ServiceTest):
    SERVICES = SERVICES

    def setUp(self):
        self.accepted('pause', True)
        self.accepted('reset')

    def accepted(self, name, *arguments):
        reply = super().accepted(name, *arguments)
        self.assertNotEqual(reply.message, '')
        return reply

    def refused(self, name, *arguments, says=''):
        """Refused with a message, and nothing has changed."""
        before = self.state()
        reply = self.call[name](*arguments)
        self.assertFalse(reply.success, '%s accepted bad input' % name)
        self.assertIn(says, reply.message)
        self.assertNotEqual(reply.message, '')
        after = self.state()
        before.header = after.header
        self.assertEqual(before, after)
        return reply.message

    def now(self, topologies):
        """The topology of the cloth as it is: a latched one may be of the run before."""
        revision = self.state().revision
        return topologies.wait(lambda t: t.revision == revision)

    def clamp(self, name):
        return next(clamp for clamp in self.state().clamps if clamp.name == name)

    # ---- services --------------------------------------------------------------------------------

    def test_get_state(self):
        reply = self.accepted('get_state')
        self.assertEqual(reply.scene, 'bench')
        self.assertEqual(reply.clamps, ['left', 'right'])
        self.assertEqual(reply.phases, ['wait', 'notch', 'stop'])
        self.assertAlmostEqual(reply.dt, 1.0 / 60.0)
        self.assertEqual(reply.state.particles, 17 * 17)
        self.assertEqual(reply.state.faces, 2 * 16 * 16)
        self.assertEqual(reply.state.pieces, 1)
        self.assertTrue(reply.state.paused)
        self.assertFalse(reply.state.failed)
        self.assertAlmostEqual(reply.state.rest_area, 0.16, places=9)
        self.assertEqual(reply.state.springs.total, reply.state.springs.structural +
                         reply.state.springs.shear + reply.state.springs.bend)

    def test_step(self):
        reply = self.accepted('step', 5)
        self.assertEqual(reply.step, 5)
        self.assertAlmostEqual(reply.time, 5.0 / 60.0)
        self.assertEqual(self.state().step, 5)
        self.refused('step', 0, says='steps')
        self.refused('step', 1000001, says='steps')

    def test_pause(self):
        self.accepted('pause', False)
        wait_until(lambda: self.state().step > 10, 'steps')
        self.accepted('pause', True)
        self.accepted('step', 1)  # whatever step it was in is over
        self.assertEqual(self.state().step, self.state().step)
        self.assertTrue(self.state().paused)

    def test_step_pauses_a_running_simulation(self):
        self.accepted('pause', False)
        step = self.accepted('step', 2).step
        self.assertTrue(self.state().paused)
        self.assertEqual(self.state().step, step)

    def test_reset(self):
        self.accepted('set_phase', 'notch')
        self.accepted('step', 10)
        self.assertGreater(self.state().broken.total, 0)
        self.accepted('reset')
        state = self.state()
        self.assertEqual((state.step, state.time, state.broken.total), (0, 0.0, 0))

    def test_reset_of_the_state_alone_lets_time_go_on(self):
        start = self.state()
        self.accepted('set_phase', 'notch')
        self.accepted('step', 10)
        self.accepted('reset', srv.ResetSceneRequest.STATE)
        state = self.state()
        self.assertEqual((state.step, state.broken.total), (10, 0))
        self.assertAlmostEqual(state.time, 10.0 / 60.0)
        self.assertEqual(state.mean_speed, start.mean_speed)
        self.assertEqual(self.accepted('step', 1).step, 11)
        self.assertEqual(self.state().phase, 'wait')

    def test_reset_of_time_alone_leaves_the_state(self):
        self.accepted('set_phase', 'notch')
        self.accepted('step', 10)
        before = self.state()
        self.accepted('reset', srv.ResetSceneRequest.TIME)
        state = self.state()
        self.assertEqual((state.step, state.time), (0, 0.0))
        self.assertEqual(state.broken, before.broken)
        self.assertEqual(state.kinetic_energy, before.kinetic_energy)
        self.assertEqual(state.phase, 'notch')
        self.refused('reset', 3, says='scope')

    def test_set_resolution(self):
        self.accepted('set_phase', 'notch')
        self.accepted('step', 3)
        with Listener('/cloth/topology', msg.ClothTopology) as topologies, \
                Listener('/cloth/frame', msg.ClothFrame) as frames:
            reply = self.accepted('set_resolution', 33)
            self.assertEqual(reply.message, 'begins anew with 33 x 33 particles')
            state = self.state()
            self.assertEqual((state.particles, state.faces), (33 * 33, 2 * 32 * 32))
            self.assertEqual((state.step, state.time, state.broken.total), (0, 0.0, 0))
            topologies.wait(lambda it: len(it.uv) == 2 * 33 * 33)
            frames.wait(lambda it: len(it.positions) == 3 * 33 * 33)
        # The patch of radius 1 is as wide as it was.
        self.accepted('grasp', 'left', True)
        self.accepted('step', 60)
        self.assertEqual(self.clamp('left').held, 5 * 5)
        self.accepted('reset')
        self.assertEqual(self.state().particles, 33 * 33)
        self.refused('set_resolution', 1, says='2 to 2048')
        self.refused('set_resolution', 4000000000, says='2 to 2048')
        self.refused('set_resolution', 2000, says='1100000 in all')
        self.assertEqual(self.accepted('get_state').columns, 33)
        self.accepted('set_resolution', 0)
        reply = self.accepted('get_state')
        self.assertEqual((reply.columns, reply.rows, reply.state.particles), (17, 17, 17 * 17))

    def test_set_clamp_pose(self):
        self.accepted('set_clamp_pose', 'right', pose(0.3, 0.1, 0.7))
        self.accepted('step', 300)
        position = self.clamp('right').pose.position
        for got, wanted in zip((position.x, position.y, position.z), (0.3, 0.1, 0.7)):
            self.assertAlmostEqual(got, wanted, places=5)

    def test_set_clamp_pose_in_a_tf_frame(self):
        link = TransformStamped(child_frame_id='hand')
        link.header.frame_id = 'world'
        link.transform.translation = Vector3(0.0, 0.0, 0.25)
        link.transform.rotation.w = 1.0
        publisher = connected('/tf_static', TFMessage, latch=True)
        publisher.publish([link])
        wait_until(lambda: self.call['set_clamp_pose']('right', pose(0.2, 0.0, 0.5, 'hand')).success,
                   'the frame hand')
        self.accepted('step', 300)
        self.assertAlmostEqual(self.clamp('right').pose.position.z, 0.75, places=5)

    def test_set_clamp_pose_refuses(self):
        self.refused('set_clamp_pose', 'middle', pose(), says='left, right')
        self.refused('set_clamp_pose', 'middle', pose(frame=''), says="unknown clamp 'middle'")
        self.refused('set_clamp_pose', 'left', pose(frame=''), says='frame_id')
        self.refused('set_clamp_pose', '', pose())
        for name, bad in BAD_POSES.items():
            with self.subTest(name):
                self.refused('set_clamp_pose', 'right', bad)

    def test_grasp(self):
        self.accepted('grasp', 'left', True)
        self.assertEqual(self.clamp('left').state, msg.ClampStatus.CLOSING)
        self.accepted('step', 60)
        clamp = self.clamp('left')
        self.assertEqual(clamp.state, msg.ClampStatus.CLOSED)
        self.assertEqual(clamp.held, 9)  # the patch of radius 1
        self.accepted('grasp', 'left', False)
        self.accepted('step', 1)
        self.assertEqual(self.clamp('left').held, 0)
        self.refused('grasp', 'middle', True, says='middle')

    def test_set_phase(self):
        self.accepted('set_phase', 'stop')
        self.assertEqual(self.state().phase, 'stop')
        self.refused('set_phase', 'fly', says='wait, notch, stop')
        self.refused('set_phase', '')

    def test_cut_through_the_cloth(self):
        before = self.state()
        reply = self.accepted('cut', THROUGH)
        self.assertIn('2 pieces', reply.message)
        state = self.state()
        self.assertEqual((state.pieces, len(state.piece)), (2, 2))
        self.assertGreater(state.revision, before.revision)
        self.assertGreater(state.broken_cut, 0)
        self.assertEqual(state.broken_cut, state.broken.total)
        # The line y = 0.01 leaves 0.4 m x 0.21 m on its one side and 0.4 m x 0.19 m on its other,
        # but for the part of an edge (0.2 of 0.025 m) by which cuts snap to vertices.
        areas = [piece.rest_area for piece in state.piece]
        self.assertGreaterEqual(areas[0], areas[1])
        self.assertAlmostEqual(areas[0], 0.4 * 0.21, delta=0.4 * 0.2 * 0.025)
        self.assertAlmostEqual(sum(areas) + state.dropped_area, before.rest_area, places=9)
        self.assertAlmostEqual(sum(piece.mass for piece in state.piece) + state.dropped_mass,
                               before.mass, places=9)
        self.assertEqual(sum(piece.faces for piece in state.piece), state.faces)
        self.assertLess(state.piece[0].centre_of_mass.y, state.piece[1].centre_of_mass.y)
        self.assertGreater(state.shortest_edge, 0.0)
        self.assertGreater(state.stable_step, 0.0)

        self.accepted('step', 60)  # the part without pins falls
        heights = [piece.centre_of_mass.z for piece in self.state().piece]
        self.assertLess(heights[0], heights[1] - 0.1)
        self.assertFalse(self.state().failed)

        self.accepted('reset')
        self.assertEqual(self.state().pieces, 1)

    def test_cut_of_a_slit_leaves_one_piece(self):
        self.accepted('cut', stroke())
        state = self.state()
        self.assertEqual(state.pieces, 1)
        self.assertGreater(state.broken_cut, 0)

    def test_cut_by_a_blade_with_heels(self):
        heels = ((-0.3, 0.01, 0.6), (0.3, 0.01, 0.6))
        self.accepted('cut', stroke(points=((-0.3, 0.01, 0.4), (0.3, 0.01, 0.4)), heels=heels,
                                    direction=(0, 0, 0)))
        self.assertEqual(self.state().pieces, 2)
        self.accepted('reset')
        above = stroke(points=((-0.3, 0.01, 0.55), (0.3, 0.01, 0.55)), heels=heels)
        self.assertIn('nothing was cut', self.accepted('cut', above).message)

    def test_cut_that_misses_changes_nothing(self):
        before = self.state()
        self.assertIn('nothing was cut', self.accepted('cut', MISSES).message)
        after = self.state()
        before.header = after.header
        self.assertEqual(before, after)

    def test_cut_refuses(self):
        for name, bad in BAD_STROKES.items():
            with self.subTest(name):
                self.assertNotIn('\n', self.refused('cut', bad))

    def test_refine(self):
        before = self.state()
        header = stroke().header
        point = [Point(0.0, 0.0, 0.5)]
        self.accepted('refine', header, point, 0.05, 2, 0.0)
        after = self.state()
        self.assertGreater(after.particles, before.particles)
        self.assertGreater(after.faces, before.faces)
        self.assertGreater(after.revision, before.revision)
        self.assertLess(after.shortest_edge, before.shortest_edge)
        self.assertEqual((after.pieces, after.broken.total), (1, 0))
        self.assertAlmostEqual(after.rest_area, before.rest_area, places=9)
        self.assertAlmostEqual(after.mass, before.mass, places=9)
        self.accepted('cut', THROUGH)
        self.assertEqual(self.state().pieces, 2)
        self.accepted('step', 10)
        self.assertFalse(self.state().failed)

    def test_refine_refuses(self):
        header = stroke().header
        point = [Point(0.0, 0.0, 0.5)]
        self.refused('refine', header, [], 0.1, 0, 0.0, says='empty')
        self.refused('refine', header, [Point(0.0, NAN, 0.5)], 0.1, 0, 0.0, says='finite')
        self.refused('refine', header, point, NAN, 0, 0.0, says='radius')
        self.refused('refine', header, point, 0.0, 0, 0.0, says='radius')
        self.refused('refine', header, point, 0.1, 13, 0.0, says='generations')
        self.refused('refine', header, point, 0.1, 0, -1.0, says='min_edge')
        self.refused('refine', stroke(frame='nowhere').header, point, 0.1, 0, 0.0,
                     says="no transform from 'nowhere' to 'world'")
        # 512 faces, each halved 6 times: 32768, with about half as many particles.
        self.refused('refine', header, point, 1.0, 6, 0.0, says='max_particles = 5000')

    # ---- topics in -------------------------------------------------------------------------------

    def test_clamp_command(self):
        publisher = connected('/cloth/clamps/right/command', PoseStamped)
        start = self.clamp('right').pose.position
        for bad in BAD_POSES.values():
            publisher.publish(bad)
        publisher.publish(pose(0.3, 0.1, 0.7))

        def arrived():
            self.accepted('step', 10)
            return abs(self.clamp('right').pose.position.x - 0.3) < 1e-5
        self.assertNotAlmostEqual(start.x, 0.3)
        wait_until(arrived, 'the clamp to arrive')

    def test_bad_clamp_commands_change_nothing(self):
        publisher = connected('/cloth/clamps/right/command', PoseStamped)
        before = self.clamp('right').pose
        with node_log() as log:
            def warned():
                for bad in BAD_POSES.values():
                    publisher.publish(bad)
                return any('clamps/right/command: refused' in entry.msg for entry in log.messages)
            wait_until(warned, 'a warning')
        self.accepted('step', 20)
        self.assertEqual(self.clamp('right').pose, before)

    def test_clamp_grasp(self):
        publisher = connected('/cloth/clamps/left/grasp', Bool)
        publisher.publish(True)
        wait_until(lambda: self.clamp('left').state == msg.ClampStatus.CLOSING, 'closing')
        publisher.publish(False)
        wait_until(lambda: self.clamp('left').state == msg.ClampStatus.OPEN, 'opening')

    def test_phase_command(self):
        publisher = connected('/cloth/phase_command', String)
        publisher.publish('fly')
        publisher.publish('')
        publisher.publish('stop')
        wait_until(lambda: self.state().phase == 'stop', 'the phase')

    def test_cut_stroke(self):
        publisher = connected('/cloth/cut_stroke', msg.CutStroke)
        publisher.publish(MISSES)
        publisher.publish(THROUGH)
        wait_until(lambda: self.state().pieces == 2, 'the cut')

    def test_bad_cut_strokes_change_nothing(self):
        self.accepted('cut', stroke())
        wanted = self.state()
        self.accepted('reset')
        publisher = connected('/cloth/cut_stroke', msg.CutStroke)
        for name in ('empty', 'nan', 'still', 'unknown_frame'):
            publisher.publish(BAD_STROKES[name])
        publisher.publish(stroke())  # a good one behind them: strokes are taken in order
        wait_until(lambda: self.state().broken.total > 0, 'the cut')
        self.assertEqual(self.state().broken, wanted.broken)
        self.assertEqual(self.state().particles, wanted.particles)

    def test_cuts_are_told_while_paused(self):
        with Listener('/cloth/tear_events', msg.TearEvents) as events, \
                Listener('/cloth/topology', msg.ClothTopology) as topologies:
            revision = self.now(topologies).revision
            here = ('o', '/cloth/tear_events', rospy.get_name())
            wait_until(lambda: here in connections(), 'the node to be connected for tear_events')
            self.accepted('cut', THROUGH)
            total = self.state().broken.total
            wait_until(lambda: sum(len(m.events) for m in events.messages) >= total, 'events')
            every = [event for m in events.messages for event in m.events]
            self.assertEqual(len(every), total)
            self.assertTrue(all(event.cause == msg.TearEvent.CUT for event in every))
            self.assertGreater(len(topologies.wait(lambda t: t.revision > revision).torn_edges), 0)

    # ---- topics out ------------------------------------------------------------------------------

    def test_topology_and_frame_belong_together(self):
        with Listener('/cloth/topology', msg.ClothTopology) as topologies, \
                Listener('/cloth/frame', msg.ClothFrame) as frames:
            topology = self.now(topologies)
            frame = frames.wait(lambda f: f.revision == topology.revision)
            self.assertEqual(len(topology.triangles), 3 * 2 * 16 * 16)
            self.assertEqual(len(topology.uv), 2 * 17 * 17)
            self.assertEqual(len(frame.positions), 3 * 17 * 17)
            self.assertEqual(max(topology.triangles), 17 * 17 - 1)
            self.assertEqual(frame.header.frame_id, 'world')
            self.assertEqual(len(topology.torn_edges), 0)

            self.accepted('set_phase', 'notch')
            self.accepted('step', 5)
            torn = topologies.wait(lambda t: t.revision > topology.revision)
            frame = frames.wait(lambda f: f.revision == torn.revision and f.step == 5)
            self.assertGreater(len(frame.positions), 3 * 17 * 17)
            self.assertEqual(len(torn.uv) // 2, len(frame.positions) // 3)
            self.assertGreater(len(torn.torn_edges), 0)

    def test_broken_springs_and_tear_events(self):
        with Listener('/cloth/broken_springs', msg.BrokenSprings) as broken, \
                Listener('/cloth/tear_events', msg.TearEvents) as events:
            broken.wait(lambda b: b.counts.total == 0)  # a latched one may be of the run before
            here = ('o', '/cloth/tear_events', rospy.get_name())
            wait_until(lambda: here in connections(), 'the node to be connected for tear_events')
            self.accepted('set_phase', 'notch')
            self.accepted('step', 5)
            total = self.state().broken.total
            self.assertGreater(total, 0)
            last = broken.wait(lambda b: b.counts.total == total)
            self.assertEqual(len(last.positions), 3 * total)
            self.assertEqual((last.cut, last.torn), (total, 0))
            wait_until(lambda: sum(len(m.events) for m in events.messages) >= total, 'events')
            every = [event for m in events.messages for event in m.events]
            self.assertEqual(len(every), total)  # each once
            self.assertTrue(all(event.cause == msg.TearEvent.CUT for event in every))
            self.assertTrue(all(abs(event.material[0] - 0.2) < 0.05 for event in every))
            kinds = [event.kind for event in every]
            self.assertEqual(kinds.count(msg.TearEvent.STRUCTURAL), last.counts.structural)
            self.assertEqual(kinds.count(msg.TearEvent.SHEAR), last.counts.shear)
            self.assertEqual(kinds.count(msg.TearEvent.BEND), last.counts.bend)

    def test_state(self):
        with Listener('/cloth/state', msg.ClothState) as states:
            self.accepted('step', 30)
            state = states.wait(lambda s: s.step == 30)
            self.assertAlmostEqual(state.time, 0.5)
            self.assertAlmostEqual(state.mass, state.rest_area * 0.15, delta=0.1)
            self.assertGreater(state.kinetic_energy, 0.0)
            self.assertEqual([clamp.name for clamp in state.clamps], ['left', 'right'])

    def test_phase_is_latched(self):
        self.accepted('set_phase', 'stop')
        with Listener('/cloth/phase', String) as phases:
            phases.wait(lambda phase: phase.data == 'stop')

    def test_wrench_and_tf_of_a_clamp_that_holds_cloth(self):
        self.accepted('grasp', 'left', True)
        self.accepted('step', 120)
        with Listener('/cloth/clamps/left/wrench', WrenchStamped) as wrenches, \
                Listener('/tf', TFMessage) as transforms:
            wrench = wrenches.wait(lambda w: abs(w.wrench.force.z) > 0.0)
            self.assertEqual(wrench.header.frame_id, 'cloth/clamp_left')
            tf = transforms.wait(lambda m: m.transforms[0].child_frame_id == 'cloth/clamp_left')
            self.assertEqual([t.child_frame_id for t in tf.transforms],
                             ['cloth/clamp_left', 'cloth/clamp_right', 'cloth/obstacle_table',
                              'cloth/obstacle_sphere'])
            position = self.clamp('left').pose.position
            self.assertAlmostEqual(tf.transforms[0].transform.translation.z, position.z)

    def test_wrench_of_an_obstacle(self):
        with Listener('/cloth/obstacles/table/wrench', WrenchStamped) as wrenches:
            wrenches.wait()
            self.accepted('step', 1)  # the cloth hangs above the table
            wrench = wrenches.wait(lambda w: w.header.frame_id == 'cloth/obstacle_table').wrench
            self.assertEqual((wrench.force.z, wrench.torque.x), (0.0, 0.0))

    def test_diagnostics(self):
        with Listener('/diagnostics', DiagnosticArray) as diagnostics:
            status = diagnostics.wait(lambda m: 'simulation' in m.status[0].name).status[0]
            keys = {value.key for value in status.values}
            self.assertLessEqual({'real-time factor', 'step time [s]', 'CPU time of steps [s]',
                                  'max strain'}, keys)

    def test_markers_are_complete_and_keep_their_rate(self):
        self.accepted('pause', False)
        with Listener('/cloth/markers', MarkerArray) as arrays:
            wait_until(lambda: len(arrays.messages) >= 12, 'markers')
            spaces = {marker.ns for marker in arrays.messages[-1].markers}
            self.assertLessEqual({'cloth', 'obstacles', 'clamps', 'text'}, spaces)
            stamps = [m.markers[0].header.stamp.to_sec() for m in arrays.messages[:12]]
            # 10 Hz, less what scheduling may shift; the first may come at once.
            self.assertGreater(stamps[-1] - stamps[1], 10 * 0.1 * 0.8)
            for array in arrays.messages:
                for marker in array.markers:
                    if marker.type in (Marker.TRIANGLE_LIST, Marker.LINE_LIST):
                        self.assertEqual(marker.action == Marker.DELETE, not marker.points)


if __name__ == '__main__':
    rospy.init_node('api_test')
    rostest.rosrun('cloth_sim', 'api', ApiTest)
