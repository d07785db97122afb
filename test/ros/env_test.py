#!/usr/bin/python3
"""Tasks as environments: spaces, seeds, same bits, scripted policies on coarse cloths, bad input.

Environments start their nodes themselves, with the master of this test."""
import os
import sys
import unittest

import numpy as np
import rosnode
import rospy
import rostest

from cloth_sim.env import PERIOD, ClothEnv
from cloth_sim.episode import run
from cloth_sim.session import ClothError
from cloth_sim.spaces import Box
from cloth_sim.tasks import TASKS

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from fewer_cases import fewer_cases_of  # noqa: E402

COARSE = {'fold_in_half': '[37, 25]', 'fold_in_quarters': '[37, 25]', 'flatten': '[25, 17]',
          'hang_over_rod': '[26, 16]', 'tear_seam': '[21, 21]', 'cut_strip': '[26, 16]'}


def coarse(task, **options):
    return ClothEnv(task, overrides=['cloth.particles=' + COARSE[task]], **options)


def roll_out(env, seed, count=8):
    """All observations, rewards and hashes of an episode of random actions, which depend on the
    seed alone."""
    env.action_space.seed(seed)
    observation, info = env.reset(seed=seed)
    seen = [(observation.tobytes(), 0.0, info['state_hash'])]
    for _ in range(count):
        observation, reward, _, _, info = env.step(env.action_space.sample())
        seen.append((observation.tobytes(), reward, info['state_hash']))
    return seen


class EnvTest(unittest.TestCase):
    # ---- the interface ---------------------------------------------------------------------------

    def test_spaces_and_what_step_returns(self):
        for task, clamps, blade in (('fold_in_half', 2, 0), ('cut_strip', 0, 1)):
            with coarse(task) as env:
                self.assertEqual(env.action_space.shape, (7 * clamps + 4 * blade,))
                self.assertEqual(env.observation_space.shape,
                                 (3 * 7 * 5 + 12 * clamps + 3 * blade + 1,))
                observation, info = env.reset(seed=4)
                self.assertIn(observation, env.observation_space)
                self.assertEqual(observation[-1], 0.0)
                observation, reward, terminated, truncated, after = env.step(
                    env.action_space.sample())
                self.assertIn(observation, env.observation_space)
                self.assertAlmostEqual(observation[-1], env.period, places=6)
                self.assertIsInstance(reward, float)
                self.assertEqual((terminated, truncated), (False, False))
                self.assertEqual(reward, after['score'] - info['score'])

    def test_the_observation_has_the_cloth_at_its_places(self):
        with coarse('cut_strip') as env:
            observation, _ = env.reset(seed=1)
            points = observation[:105].reshape(7, 5, 3)
            sides = [np.linalg.norm(points[-1, 0] - points[0, 0]),
                     np.linalg.norm(points[0, -1] - points[0, 0])]
            np.testing.assert_allclose(sides, env.task.size, atol=1e-3)  # 1 mm: it may have creased

    def test_a_clamp_moves_with_the_velocity_of_the_action(self):
        """It starts with the acceleration of its limit, 10 m/s^2, so that it lags by v^2 / (2 a) at
        most, 2 mm at 0.2 m/s, and by the way of a step where it stands."""
        with coarse('fold_in_half') as env:
            before, _ = env.reset(seed=0)
            action = np.zeros(14)
            action[2] = 0.2
            for _ in range(5):
                after, *_ = env.step(action)
            way = (after - before)[105:108]
            np.testing.assert_allclose(way, [0.0, 0.0, 5 * PERIOD / 60 * 0.2], atol=0.006)

    def test_an_image(self):
        with coarse('cut_strip', render_mode='rgb_array') as env:
            env.reset(seed=0)
            first = env.render()
            self.assertEqual((first.shape, first.dtype), ((360, 480, 3), np.uint8))
            self.assertGreater(len(np.unique(first.reshape(-1, 3), axis=0)), 20)
            np.testing.assert_array_equal(env.render(), first)
            env.reset(seed=1)
            self.assertTrue((env.render() != first).any())
        with coarse('cut_strip') as env:
            self.assertIsNone(env.render())

    # ---- seeds and bits --------------------------------------------------------------------------

    def test_the_same_seed_and_actions_give_the_same_bits(self):
        with coarse('fold_in_half') as env:
            first = roll_out(env, 5)
            self.assertEqual(roll_out(env, 5), first)  # from the saved start state
            other = roll_out(env, 6)
            self.assertNotEqual(other[0], first[0])
            self.assertEqual(roll_out(env, 5), first)  # of a new node
        with coarse('fold_in_half', threads=2) as env:
            self.assertEqual(roll_out(env, 5), first)

    def test_a_cut_of_one_episode_is_not_seen_in_the_next(self):
        def cut(env, along):
            """The surface after a cut across the middle of the cloth."""
            env.reset(seed=0)
            middle = env.surface.points.mean(axis=0) - env.task.blade
            for velocity, pressure in ((middle - 0.1 * along, -1), (0.2 * along, 1)):
                for _ in range(8):
                    env.step(np.append(velocity / (8 * env.period), pressure))
            return env.surface
        x, y = np.eye(3)[:2]
        with coarse('cut_strip') as env:
            cut(env, x)
            after_another = cut(env, y)
        with coarse('cut_strip') as env:
            first = cut(env, y)
        self.assertGreater(len(first.torn), 0)
        for name in ('points', 'faces', 'uv', 'torn'):
            np.testing.assert_array_equal(getattr(after_another, name), getattr(first, name))

    def test_seeds_that_are_not_given_follow_from_the_last_one(self):
        starts = []
        with coarse('cut_strip') as env:
            for seed in (2, None, 2, None):
                starts.append(env.reset(seed=seed)[0].tobytes())
        self.assertEqual(starts[:2], starts[2:])
        self.assertNotEqual(starts[0], starts[1])

    def test_options_change_the_scene_of_an_episode(self):
        with coarse('cut_strip') as env:
            env.reset(seed=0, options={'set': ['cloth.particles=[17, 9]']})
            self.assertEqual(len(env.surface.points), 17 * 9)
            env.reset(seed=0)
            self.assertEqual(len(env.surface.points), 26 * 16)

    # ---- the tasks -------------------------------------------------------------------------------

    def scripted(self, task, seed=0):
        with coarse(task) as env:
            _, start = env.reset(seed=seed)
            end = run(env, seed)
            self.assertEqual(end['failure'], '')
            return start, end

    def scripted_twice(self, task):
        """The start and the end of an episode, or, if it does not succeed, of another one: of 16
        in which a towel was folded in quarters, 2 failed, and which ones depends on the processor
        (docs/tasks.md)."""
        start, end = self.scripted(task, seed=0)
        return (start, end) if end['success'] else self.scripted(task, seed=1)

    def test_scripted_policies_succeed(self):
        for task in fewer_cases_of(
                ('fold_in_half', 'fold_in_quarters', 'hang_over_rod', 'tear_seam', 'cut_strip')):
            start, end = self.scripted_twice(task)
            self.assertFalse(start['success'], task)
            self.assertLess(start['score'], 0.2, task)
            self.assertTrue(end['success'], (task, end))
            self.assertGreater(end['score'], 0.9, task)

    def test_the_scripted_policy_spreads_a_crumpled_towel(self):
        start, end = self.scripted('flatten', seed=2)  # not of every seed: see docs/tasks.md
        self.assertLess(start['coverage'], 0.8)
        self.assertGreater(end['coverage'], start['coverage'] + 0.1)

    def test_doing_nothing_does_nothing(self):
        with coarse('hang_over_rod') as env:
            env.reset(seed=0)
            total, over = 0.0, False
            while not over:
                _, reward, terminated, over, info = env.step(np.zeros(14))
                self.assertFalse(terminated)
                total += reward
            self.assertEqual(total, 0.0)
            self.assertAlmostEqual(info['sim_time_s'], env.task.time_limit, places=6)

    # ---- bad input -------------------------------------------------------------------------------

    def refused(self, error, text, function, *arguments, **named):
        with self.assertRaises(error) as caught:
            function(*arguments, **named)
        self.assertIn(text, str(caught.exception))
        self.assertNotIn('\n', str(caught.exception))

    def test_bad_tasks_and_nodes(self):
        self.refused(ValueError, "task: expected one of fold_in_half", ClothEnv, 'fold')
        self.refused(ValueError, 'task: expected one of', ClothEnv, None)
        self.refused(ValueError, 'render_mode: expected', ClothEnv, 'flatten', 'human')
        env = ClothEnv('cut_strip', node='/no/such/cloth_node')
        self.refused(ClothError, '/no/such/cloth_node: cannot be run', env.reset, seed=0)
        env = ClothEnv('cut_strip', overrides=['cloth.colour=red'])
        self.refused(ClothError, 'cloth.colour', env.reset, seed=0)
        env.close()

    def test_bad_actions_change_nothing(self):
        with coarse('cut_strip') as env:
            self.refused(RuntimeError, 'call reset', env.step, np.zeros(4))
            first = roll_out(env, 1, count=3)
            env.action_space.seed(1)
            env.reset(seed=1)
            for bad, text in ((np.zeros(3), 'expected shape (4,)'), (np.zeros((1, 4)), 'shape'),
                              ([0, 0, np.nan, 0], 'got nan at 2'), ([np.inf, 0, 0, 0], 'inf at 0')):
                self.refused(ValueError, text, env.step, bad)
            again = [env.step(env.action_space.sample()) for _ in range(3)]
            self.assertEqual([step[0].tobytes() for step in again], [one[0] for one in first[1:]])

    def test_bad_seeds_and_options(self):
        with coarse('cut_strip') as env:
            for seed in (-1, 1.5, True, '1'):
                self.refused(ValueError, 'seed: expected a whole number >= 0', env.reset, seed=seed)
            self.refused(ValueError, 'options: expected the key set', env.reset,
                         options={'state': 1})
            self.refused(ValueError, 'options.set: expected a list', env.reset,
                         options={'set': 'a=b'})

    def test_a_step_after_the_end_is_refused(self):
        with coarse('cut_strip') as env:
            run(env, 0)
            self.refused(RuntimeError, 'it has ended: call reset', env.step, np.zeros(4))
            env.reset(seed=0)
            env.step(np.zeros(4))

    def test_only_the_own_node_ends(self):
        def nodes():
            return [name for name in rosnode.get_node_names() if name.startswith('/cloth_env_')]
        with coarse('cut_strip') as first, coarse('cut_strip') as second:
            first.reset(seed=0)
            second.reset(seed=0)
            both = nodes()
            second.close()
            second.close()
            self.assertEqual(len(set(both) - set(nodes())), 1)
            first.step(np.zeros(4))
        self.assertEqual([name for name in nodes() if name in both], [])
        self.assertFalse([name for name in rospy.get_param_names() if '/cloth_env_' in name])

    def test_every_task_is_tested(self):
        self.assertEqual(sorted(COARSE), sorted(TASKS))
        self.assertIsInstance(ClothEnv('flatten').action_space, Box)


if __name__ == '__main__':
    rospy.init_node('env_test')
    rostest.rosrun('cloth_sim', 'env', EnvTest)
