"""Runs one episode of a task, and prints its figures as a line of JSON.

`python3 -m cloth_sim.episode TASK SEED [--policy FILE:FUNCTION] [--set KEY=VALUE]...
[--picture PNG]`; an error is one line on standard error, and status 1.
"""
import argparse
import importlib.util
import json
import os
import signal
import sys
import time

from cloth_sim.env import ClothEnv
from cloth_sim.script import Script

FIGURES = ('coverage', 'edge_error_m', 'peak_force_n', 'sim_time_s', 'score', 'success', 'failure',
           'state_hash')


def scripted(env):
    """The scripted policy of the environment's task."""
    return Script(env.task, env.period, env.task.plan)


def load_policy(text):
    """The function FILE:FUNCTION of an environment, which returns a policy for one episode."""
    path, _, name = text.rpartition(':')
    if not os.path.isfile(path):
        raise ValueError('--policy: expected FILE:FUNCTION (got %.80r)' % text)
    spec = importlib.util.spec_from_file_location('policy', path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    if not callable(getattr(module, name, None)):
        raise ValueError('--policy: %s has no function %s' % (path, name))
    return getattr(module, name)


def run(env, seed, make_policy=scripted):
    """Runs an episode. Returns its `info` at the end, with the wall time [s] of its steps."""
    observation, info = env.reset(seed=seed)
    policy, start, over = make_policy(env), time.monotonic(), False
    while not over:
        observation, _, terminated, truncated, info = env.step(policy.act(observation))
        over = terminated or truncated
    return {**info, 'wall_time_s': time.monotonic() - start}


def write_picture(image, path):
    """Writes an image completely or not at all."""
    from matplotlib.image import imsave
    temporary = '%s.tmp%d' % (path, os.getpid())
    imsave(temporary, image, format='png')
    os.replace(temporary, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('task')
    parser.add_argument('seed', type=int)
    parser.add_argument('--policy')
    parser.add_argument('--set', action='append', default=[])
    parser.add_argument('--picture')
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit('ended by a signal'))
    try:
        make_policy = load_policy(options.policy) if options.policy else scripted
        with ClothEnv(options.task, 'rgb_array' if options.picture else None,
                      options.set) as env:
            info = run(env, options.seed, make_policy)
            if options.picture:
                write_picture(env.render(), options.picture)
    except Exception as error:  # whatever it is, also of the policy, it is one line
        sys.exit('%s: %s' % (type(error).__name__, ' '.join(str(error).split())))
    names = FIGURES + ('wall_time_s',)
    print(json.dumps({'task': options.task, 'seed': options.seed,
                      **{name: info[name] for name in names}}))


if __name__ == '__main__':
    main()
