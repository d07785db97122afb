#!/usr/bin/python3
"""Writes docs/performance.md from the tables that bench/measure.sh left in a folder."""
import json
import os
import re
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
TRIED = os.path.join(HERE, 'tried.md')
FIELD = os.path.join(HERE, 'field.json')


def read(folder, name):
    """What a file says; nothing if that part was not measured."""
    if not os.path.exists(os.path.join(folder, name)):
        return None
    with open(os.path.join(folder, name), encoding='utf-8') as file:
        return file.read().strip() if name.endswith('.txt') else json.load(file)


def table(header, rows):
    lines = ['| ' + ' | '.join(header) + ' |', '|' + '---|' * len(header)]
    return '\n'.join(lines + ['| ' + ' | '.join(row) + ' |' for row in rows])


def told(measured, tell):
    return tell(measured) if measured else 'Not measured yet.'


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


def field(comparisons):
    """Other engines, measured elsewhere, and this one, over what Bullet took beside each."""
    with open(FIELD, encoding='utf-8') as file:
        others = json.load(file)
    there = next(row['ms'] for row in others if row['engine'].startswith('Bullet'))
    rows = [[row['engine'], '`%s`' % row['setting'],
             '%g' % row['ms'] + (' [%g]' % row['least'] if row['least'] else ''),
             '%.3f' % (row['ms'] / there), row['column'], row['edge']] for row in others]
    own = comparisons[0]['rows']
    here = next(row['ms_per_frame'] for row in own
                if row['engine'] == 'Bullet' and row['setting'] == '12 x 4')
    rows += [['**here:** ' + row['engine'], '`%s`' % row['setting'],
              '%.2f [%.2f]' % (row['ms_per_frame'], row['ms_least']),
              '%.3f' % (row['ms_per_frame'] / here), '%.2f %%' % (100.0 * row['column_stretch']),
              '%.3f' % row['worst_edge']] for row in own
             if row['setting'] in ('12 x 4', 'projective substeps=1 iterations=1')]
    return table(['engine', 'setting', 'ms a frame [least]', 'over Bullet `12 x 4` beside it', 'column',
                  'edge'], rows)


def medians(document):
    """Of each benchmark: its median, its least and greatest are not told by aggregates, the spread is."""
    result = {}
    for entry in document['benchmarks']:
        if entry.get('error_occurred'):  # it diverged, say: nothing was timed
            continue
        result.setdefault(entry['run_name'], {})[entry['aggregate_name']] = entry
    return result


def spread(entry, figure='cpu_time'):
    variation = entry.get('cv')
    return '' if variation is None else ' +- %.0f %%' % (100.0 * variation[figure])


def nanoseconds(seconds):
    return '%.2f' % (1e9 * seconds)


def told_by(document, prefix):
    """Benchmarks whose names begin so, by what follows; without the settings of the run."""
    return {name[len(prefix):].partition('/iterations')[0]: entry
            for name, entry in medians(document).items() if name.startswith(prefix)}


def with_spread(entry, figure):
    return '%.2f%s' % (entry['median'][figure], spread(entry, figure))


def floors(document):
    """What a spring costs over what it costs at the floor, in turns."""
    rows = []
    for kind in ('grid', 'any', 'later'):
        for side, entry in told_by(document, 'floor/%s/side:' % kind).items():
            rows.append([kind, side] + [nanoseconds(entry['median'][figure])
                                        for figure in ('own', 'double', 'float')] +
                        ['**%s**' % with_spread(entry, 'over_double'),
                         with_spread(entry, 'over_float')])
    return told(rows, lambda rows: table(
        ['springs', 'side', '`xpbd`', 'floor, double', 'floor, float', 'over double', 'over float'],
        rows))


def whole(document):
    """Steps of whole scenes over those of the bare one, and cut ones over the same uncut."""
    scenes = {'pins': 'hanging from two pins',
              'armed': 'from two clamps, over ground and ball, tearing armed',
              'cut': 'the same after three cuts',
              'refined': 'the same, refined around the cuts'}
    rows = []
    for method, entry in told_by(document, 'whole/').items():
        median = entry['median']
        for what, title in scenes.items():
            is_cut = what in ('cut', 'refined')
            springs = median[what + '_springs']
            rows.append(['`%s`' % method, title, '%d' % median[what + '_particles'], '%d' % springs,
                         with_spread(entry, what), with_spread(entry, what + '_over_pins'),
                         '**%s**' % with_spread(entry, what + '_over_armed') if is_cut else '',
                         '%.2f' % (median[what + '_over_armed'] * median['armed_springs'] / springs)
                         if is_cut else ''])
    return told(rows, lambda rows: table(
        ['method', 'scene', 'particles', 'springs', 'ms a step', 'over the first',
         'over the uncut one', 'the same a spring'], rows))


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


def threads(document):
    """What a second thread gains, beside what the machine gives."""
    rows = []
    for name, entry in medians(document).items():
        _, method, side = name.split('/')[:3]
        one, two, gain, apart = (with_spread(entry, figure)
                                 for figure in ('one', 'two', 'gain', 'gain_apart'))
        rows.append(['`%s`' % method, side.split(':')[1], one, two, '**%s**' % gain, apart])
    return table(['method', 'side', 'ms a step', 'with 2 threads', 'times faster',
                  'two simulations apart'], rows)


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
ours. The run has five parts, at each of which all take turns. `bench/peer/peer_bullet.cpp`

%(peers)s
## The field

The same hanging cloth. The rows above *here* were measured by others, on another machine with two cores and AVX2
(`bench/field.json`), and are not repeated by `bench/measure.sh`: only what each is over Bullet in its own run
compares. With the same `12 x 4` Bullet stretched twice as far there; its other settings are not known.

%(field)s

## The floor

Nanoseconds a spring, in turns with the floors: sweeps that do nothing but correct lengths, on a grid whose
structure is known and over any topology by colours, in the double precision that `xpbd` has and in single
precision. *Any*: particles along a Z curve, so that no springs are in a row. *Later*: those springs of a grid that three
slits, refined around, have made or moved, over any topology, too. `bench/kernels/floor_bench.cpp`

%(floors)s

## Whole scenes

128 x 128 particles, one thread, in turns; `projective` with one substep and one iteration. `bench/kernels/whole_bench.cpp`

%(whole)s

## Parts

`part/start_up` is a simulation made and its first step.

%(parts)s

## Steps of every method

The hanging cloth, with each method's default parameters; methods with a limit of stability divide the
frame until they are below (`solver.step_guard: subdivide`). `explicit_euler` has none without damping.

%(steps)s

## Two threads

The hanging cloth by `xpbd` (its defaults) and by `projective` (one substep, one iteration), wall time: one thread,
two threads and, for what this machine's two cores give at all, two simulations that have nothing to do with
each other, in turns, before each of which threads are given 50 ms to settle on their cores. `bench/kernels/threads_bench.cpp`

%(threads)s

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
                'field': told(read(folder, 'hang.json'), field),
                'floors': told(read(folder, 'turns.json'), floors),
                'whole': told(read(folder, 'turns.json'), whole),
                'parts': told(read(folder, 'parts.json'), parts),
                'node': told(read(folder, 'node.json'), node),
                'threads': told(read(folder, 'threads.json'), threads),
                'scale': told(read(folder, 'scale.json'), scale),
                'steps': told(read(folder, 'steps.json'), steps), 'tried': tried})


if __name__ == '__main__':
    main()
