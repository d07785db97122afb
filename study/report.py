#!/usr/bin/python3
"""Writes a page of docs from a template and the tables of cloth_study.

usage: report.py TEMPLATE DIR > PAGE

In the template, {{ expression }} becomes the value of a Python expression over the tables in DIR
(the functions of the class Tables), and a line "%% expression" is a claim that the text makes: it
must be true, and does not show. A claim that is false ends the program with status 1, and names it.
"""
import math
import os
import re
import sys

from reality import Reality
from tables import errors_table, is_peer, percent, read, significant


def text_of(folder, name):
    with open(os.path.join(folder, name)) as file:
        return file.read().strip()


class Run(dict):
    """A row of work_precision.csv."""

    @property
    def error(self):
        return float(self['error'])

    @property
    def cost(self):
        return float(self['cpu_s_per_sim_s'])

    @property
    def ok(self):
        return self['status'] == 'ok'

    @property
    def rate(self):
        """Substeps per simulated second."""
        return float(self['substeps']) / float(self['dt'])

    def __str__(self):
        return f"`{self['solver']}`, {self.rate:.0f}/s"


class Tables:
    """The functions that templates may call."""

    def __init__(self, folder):
        self.folder = folder
        self.runs = [Run(row) for row in read(folder, 'work_precision.csv')]
        self.front_rows = [Run(row, status='ok') for row in read(folder, 'pareto.csv')]
        self.limits = read(folder, 'stability_limits.csv')
        self.resolution = read(folder, 'resolution.csv')
        self.at_size = read(folder, 'at_size.csv')
        self.peers = [row for row in read(folder, 'peer_motion.csv') if is_peer(row)]
        self.reality = Reality(folder)
        self.scenes = list(dict.fromkeys(run['scene'] for run in self.runs))

    def of(self, scene, solver=None):
        return [run for run in self.runs
                if run['scene'] == scene and solver in (None, run['solver'])]

    def coarsest(self, scene, solver):
        """The successful run with the fewest substeps."""
        return min([run for run in self.of(scene, solver) if run.ok], key=lambda run: run.rate)

    def least(self, scene, solver):
        """The least error of a method."""
        return min(run.error for run in self.of(scene, solver) if run.ok)

    def confirmed(self, run, error):
        """Whether the next run with more substeps keeps the error, too (once may be an accident)."""
        finer = [other for other in self.of(run['scene'], run['solver'])
                 if other.rate > run.rate * 1.001 and other['dt'] == run['dt']
                 and other['iterations'] == run['iterations'] and other['status'] != 'skipped']
        if not finer:
            return False
        following = min(finer, key=lambda other: other.rate)
        return following.ok and following.error <= error

    def cheapest(self, scene, error, solver=None):
        """The cheapest run that keeps this error, as the next finer one does; None if there is
        none."""
        good = [run for run in self.of(scene, solver)
                if run.ok and run.error <= error and self.confirmed(run, error)]
        return min(good, key=lambda run: run.cost) if good else None

    def times(self, scene, error, solver):
        """The cost of a method over that of the cheapest, in words."""
        run = self.cheapest(scene, error, solver)
        if run is None:
            return 'does not get there'
        return f'costs {significant(run.cost / self.cheapest(scene, error).cost)} times as much'

    def cell(self, scene, error, solver=None):
        """The cost of a method over that of the cheapest, for a table."""
        run = self.cheapest(scene, error, solver)
        if run is None:
            return 'none |'
        return f'{run}: {percent(run.error)} | {significant(run.cost)}'

    def front(self, scene):
        """The methods on the scene's Pareto front, by cost."""
        return list(dict.fromkeys(run['solver'] for run in self.front_rows
                                  if run['scene'] == scene))

    def on_front(self, solver, least=0.0, most=1.0):
        """The scenes whose front has the method with an error between two bounds."""
        return list(dict.fromkeys(run['scene'] for run in self.front_rows
                                  if run['solver'] == solver and least <= run.error <= most))

    def fails(self, scene, solver):
        """The largest rate of substeps with which a method diverges; 0 if it never does."""
        return max([run.rate for run in self.of(scene, solver) if run['status'] == 'diverged'],
                   default=0.0)

    def limit(self, solver, system='oscillator'):
        [row] = [row for row in self.limits
                 if (row['solver'], row['system']) == (solver, system)]
        return float(row['measured_limit'])

    def worst_limit(self):
        """The largest deviation of a measured limit of stability from its prediction."""
        return max(abs(float(row['measured_limit']) / float(row['predicted_limit']) - 1.0)
                   for row in self.limits
                   if math.isfinite(float(row['predicted_limit']))
                   and float(row['predicted_limit']) > 0.0)

    def unlimited(self):
        return sorted({row['solver'] for row in self.limits
                       if math.isinf(float(row['measured_limit']))})

    def quantity(self, name, particles):
        """(value, difference from the finest)"""
        [row] = [row for row in self.resolution
                 if (row['quantity'], int(row['particles'])) == (name, particles)]
        return float(row['value']), float(row['difference_from_finest'])

    def differences(self, name):
        """'-11 %, -0.9 %', coarsest first, without the finest."""
        rows = [row for row in self.resolution if row['quantity'] == name][:-1]
        return ', '.join(f"{100.0 * float(row['difference_from_finest']):+.2g} %".replace('-', '−')
                         for row in rows)

    def resolutions(self):
        return list(dict.fromkeys(int(row['particles']) for row in self.resolution))

    def tear_error(self, solver, dt):
        """Error of the time of separation in the run with a step and the most substeps."""
        runs = [run for run in self.of('seam_tear', solver)
                if run.ok and abs(float(run['dt']) / dt - 1.0) < 1e-3]
        return max(runs, key=lambda run: run.rate).error

    def order(self, scene, solver):
        """The observed order, from the finest run and the one with half as many substeps. Runs whose
        error is as small as that of the reference do not count."""
        runs = [run for run in self.of(scene, solver) if run.ok and run.error > 1e-8]
        for fine in sorted(runs, key=lambda run: -run.rate):
            half = [run for run in runs if abs(2.0 * run.rate / fine.rate - 1.0) < 1e-3
                    and run['dt'] == fine['dt'] and run['iterations'] == fine['iterations']]
            if half:
                return math.log2(half[0].error / fine.error)
        raise KeyError(f'{scene}: no two runs of {solver}')

    def errors(self, scene, particles=128):
        """The table of a scene of at_size, with the peer's rows at its end."""
        return errors_table([row for row in self.at_size + self.peers
                             if (row['scene'], int(row['particles'])) == (scene, particles)])

    def at(self, scene, method, substeps=0, iterations=0, error=0.0, particles=128):
        """A row of at_size, its numbers as numbers."""
        for row in self.at_size + self.peers:
            if (row['scene'], row['method'], int(row['particles']), int(row['substeps']),
                    int(row['iterations']), float(row['error'])) == (
                        scene, method, particles, substeps, iterations, error):
                return {key: float(row[key]) for key in row
                        if key not in ('scene', 'method', 'status')}
        raise KeyError(f'{scene}: no run of {method}, {substeps} x {iterations}, {error}')

    def reference(self, scene, particles=128):
        """The row of the reference of a scene of at_size."""
        [row] = [row for row in self.at_size if row['status'] == 'reference' and
                 (row['scene'], int(row['particles'])) == (scene, particles)]
        return {key: float(row[key]) for key in row if key not in ('scene', 'method', 'status')}

    def count(self, status=None):
        return sum(status in (None, run['status']) for run in self.runs)

    def text(self, name):
        """A text file beside the tables."""
        return text_of(self.folder, name)


def names_for(tables):
    names = {name: getattr(tables, name) for name in dir(tables) if not name.startswith('_')}
    names.update(percent=percent, significant=significant, math=math)
    return names


def render(template, tables):
    """The page, and the claims that are false."""
    names = names_for(tables)
    lines, false = [], []
    for line in template.splitlines():
        if line.startswith('%% '):
            if not eval(line[3:], names):  # the template is part of the package
                false.append(line[3:])
            continue
        lines.append(re.sub(r'\{\{(.*?)\}\}', lambda match: str(eval(match.group(1), names)), line))
    return '\n'.join(lines) + '\n', false


def main(template, folder):
    with open(template) as file:
        page, false = render(file.read(), Tables(folder))
    for claim in false:
        print('error: not so: ' + claim, file=sys.stderr)
    if false:
        sys.exit(1)
    sys.stdout.write(page)


if __name__ == '__main__':
    if len(sys.argv) != 3:
        print(__doc__)
        sys.exit(2)
    main(sys.argv[1], sys.argv[2])
