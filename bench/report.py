#!/usr/bin/python3
"""Writes docs/performance.md from the tables that bench/measure.sh left in a folder."""
import json
import os
import re
import sys

TRIED = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'tried.md')


def read(folder, name):
    """What a file says; nothing if that part was not measured."""
    if not os.path.exists(os.path.join(folder, name)):
        return None
    with open(os.path.join(folder, name), encoding='utf-8') as file:
        return file.read().strip() if name.endswith('.txt') else json.load(file)


def table(header, rows):
    lines = ['| ' + ' | '.join(header) + ' |', '|' + '---|' * len(header)]
    return '\n'.join(lines + ['| ' + ' | '.join(row) + ' |' for row in rows])


def told(document, tell):
    return tell(document) if document else 'Not measured yet.'


def peers(comparisons):
    parts = []
    for one in comparisons:
        rows = [[row['engine'], '`%s`' % row['setting'],
                 '%.2f [%.2f, %.2f]' % (row['ms_per_frame'], row['ms_least'], row['ms_most']),
                 '%.2f %%' % (100.0 * row['column_stretch']), '%.3f' % row['worst_edge'],
                 '%.4f' % row['speed'], '%d' % row['fallen_through']] for row in one['rows']]
        parts.append('### `%s`, %d x %d\n' % (one['scene'], one['particles'], one['particles']))
        parts.append(table(['engine', 'setting', 'ms a frame [least, most]', 'column', 'edge',
                            'm/s', 'fallen through'], rows) + '\n')
        if 'ratio' in one:
            parts.append('Bullet with `%s` costs **%.1f times** what `%s` costs, which is stretched '
                         'no more.\n' % (one['peer'], one['ratio'], one['own']))
        else:
            parts.append('No setting of one is as little stretched as the cheapest of the other that '
                         'holds the cloth.\n')
    return '\n'.join(parts)


def medians(document):
    """Of each benchmark: its median, its least and greatest are not told by aggregates, the spread is."""
    result = {}
    for entry in document['benchmarks']:
        result.setdefault(entry['run_name'], {})[entry['aggregate_name']] = entry
    return result


def spread(entry):
    variation = entry.get('cv')
    return '' if variation is None else ' +- %.0f %%' % (100.0 * variation['cpu_time'])


def nanoseconds(seconds):
    return '%.2f' % (1e9 * seconds)


def parts(document):
    rows = []
    for name, entry in medians(document).items():
        median = entry['median']
        scale = {'ns': 1e-3, 'us': 1.0, 'ms': 1e3}[median['time_unit']]
        per = median.get('per_spring')
        rows.append(['`%s`' % name, '%.4g%s' % (scale * median['cpu_time'], spread(entry)),
                     nanoseconds(per) if per else ''])
    return table(['what', 'CPU time, microseconds', 'ns a spring'], rows)


def steps(document):
    rows = []
    for name, entry in medians(document).items():
        found = re.match(r'step/(\w+)/threads:(\d+)/side:(\d+)/', name)
        if not found:
            continue
        median = entry['median']
        rows.append((found.group(1), int(found.group(3)), int(found.group(2)),
                     median['real_time'], spread(entry), median))
    by = {(method, side, threads): real for method, side, threads, real, _, _ in rows}
    lines = []
    for method, side, threads, real, variation, median in sorted(rows, key=lambda r: r[:3]):
        if threads != 1:
            continue
        two = by.get((method, side, 2))
        sweeps = median['substeps'] * max(1.0, median['iterations'] / median['substeps'])
        lines.append(['`%s`' % method, str(side), '%d' % median['substeps'],
                      '%d' % median['iterations'], '%.3g%s' % (real, variation),
                      nanoseconds(median['per_spring'] / sweeps),
                      '%.2f' % (real / two) if two else ''])
    return table(['method', 'side', 'substeps', 'iterations', 'ms a step',
                  'ns a spring and sweep', 'faster with 2 threads'], lines)


def node(document):
    overhead, latency = document['overhead'], document['latency']
    threads = ', '.join('`%s` %.1f %%' % pair for pair in sorted(overhead['threads_percent'].items()))
    return ('Beside its steps (%.1f %% of one core, at a real-time factor of %.2f) the node costs **%.1f %% '
            'of one core**: snapshots and hand-over in the stepping thread %.1f %%, and the rest for '
            'messages; %.1f %% of it in the kernel. By thread: %s. The time from a command to a clamp to '
            'the first `~frame` that shows it, of %d commands at random times: median **%.2f**, 99th '
            'percentile **%.2f** frames of 1/60 s.' %
            (overhead['steps_percent'], overhead['real_time_factor'], overhead['overhead_percent'],
             overhead['snapshot_percent'], overhead['overhead_in_kernel_percent'], threads,
             latency['commands'], latency['median_frames'], latency['p99_frames']))


def scale(document):
    counters = ['loaded', 'peak', 'stepped', 'mesh', 'springs', 'model', 'state', 'solver']
    rows = []
    for name, entry in medians(document).items():
        median = entry['median']
        rows.append(['`%s`' % name, '%.3g' % (1e-3 * median['cpu_time'])] +
                    ['%.0f' % median[key] if key in median else '' for key in counters])
    return table(['what', 'CPU time, s'] + counters, rows)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__ + '\nusage: bench/report.py FOLDER')
    folder = sys.argv[1]
    with open(TRIED, encoding='utf-8') as file:
        tried = file.read().strip()
    print('''# What a step costs

Measured by `bench/measure.sh BUILD` on %(machine)s. Times are CPU times (steps: wall times); each is a
median of five, with the spread. Accuracy stands beside speed: how far the cloth of a peer hangs through is
part of its row. What errors cost is in [accuracy.md](accuracy.md).

## Beside a peer

A cloth of 1 m and 0.2 kg, frames of 1/60 s for 5 s, one thread. *Column*: how much longer than at rest the worst
column is at the end; *edge*: the longest edge over its rest length; *m/s*: the fastest particle then. Bullet is
the soft body of Bullet 3.24, `substeps x iterations`, with bending links and full stiffness. Tearing is armed in
ours. `bench/peer/peer_bullet.cpp`

%(peers)s
## Parts, and the floor

`floor/structured` and `floor/any_topology` are sweeps that do nothing but correct lengths in single
precision; what a spring costs a method beyond that is double precision, material, damping, contact and
tearing.

%(parts)s

## Steps of every method

The hanging cloth, with each method's default parameters.

%(steps)s

## The node

The node at 128 x 128, with the pace of the wall's clock, one subscriber of `~frame` (60 Hz) and one of
`~markers` (30 Hz). `bench/node_overhead`

%(node)s

## Large cloths

What is there before the first step, in bytes per particle; *model* has a mesh and springs of its own.
`bench/kernels/scale_bench.cpp`

%(scale)s

%(tried)s''' % {'machine': read(folder, 'machine.txt'),
                'peers': told((read(folder, 'hang.json') or []) + (read(folder, 'sphere.json') or []),
                              peers),
                'parts': told(read(folder, 'parts.json'), parts),
                'node': told(read(folder, 'node.json'), node),
                'scale': told(read(folder, 'scale.json'), scale),
                'steps': told(read(folder, 'steps.json'), steps), 'tried': tried})


if __name__ == '__main__':
    main()
