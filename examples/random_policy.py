#!/usr/bin/python3
"""Acts at random in a task, with a node of its own, and writes an image of the end:
`rosrun cloth_sim random_policy.py [TASK] [PNG]`. `make` is a policy for `cloth_tasks --policy`."""
import sys

from cloth_sim.env import ClothEnv


class RandomPolicy:
    def __init__(self, space):
        self.space = space
        self.space.seed(0)

    def act(self, observation):
        return self.space.sample()


def make(env):
    return RandomPolicy(env.action_space)


def main(task='fold_in_half', picture=None):
    with ClothEnv(task, render_mode='rgb_array') as env:
        observation, info = env.reset(seed=0)
        policy, total, over = make(env), 0.0, False
        while not over:
            observation, reward, terminated, truncated, info = env.step(policy.act(observation))
            total += reward
            over = terminated or truncated
        print('reward %.3f, score %.3f after %.1f s' % (total, info['score'], info['sim_time_s']))
        if picture:
            from matplotlib.image import imsave
            imsave(picture, env.render())


if __name__ == '__main__':
    main(*sys.argv[1:])
