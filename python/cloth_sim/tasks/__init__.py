"""The tasks, by their names."""
from cloth_sim.tasks.flatten import Flatten
from cloth_sim.tasks.fold import FoldInHalf, FoldInQuarters
from cloth_sim.tasks.part import CutStrip, TearSeam
from cloth_sim.tasks.rod import HangOverRod

TASKS = {task.name: task
         for task in (FoldInHalf, FoldInQuarters, Flatten, HangOverRod, TearSeam, CutStrip)}


def find_task(name):
    """A task by its name."""
    if not isinstance(name, str) or name not in TASKS:
        raise ValueError('task: expected one of %s (got %.40r)' % (', '.join(TASKS), name))
    return TASKS[name]()
