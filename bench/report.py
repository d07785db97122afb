#!/usr/bin/python3
"""Writes docs/performance.md from the tables that bench/measure.sh left in a folder."""
import json
import os
import re
import sys
import textwrap

HERE = os.path.dirname(os.path.abspath(__file__))
FIELD = os.path.join(HERE, 'field.json')
STUDY = os.path.join(HERE, '..', 'docs', 'data', 'study')  # of peer_motion.csv
sys.path.insert(0, os.path.join(HERE, '..', 'study'))

from tables import errors_table, is_peer, percent, setting_of, significant  # noqa: E402
from tables import markdown_table as table  # noqa: E402
from tables import read as read_table  # noqa: E402

MOTIONS = {'swing': 'A cloth swings from its edge, 0.8 s',
           'hang': 'A cloth falls into two pinned corners, 1.5 s'}


def read(folder, name):
    """Contents of a file, parsed if it is JSON; None if that part was not measured."""
    if not os.path.exists(os.path.join(folder, name)):
        return None
    with open(os.path.join(folder, name), encoding='utf-8') as file:
        return file.read().strip() if name.endswith('.txt') else json.load(file)


def paragraph(text):
    """The text in lines of at most 98 columns."""
    return '\n'.join(textwrap.wrap(text, 98, break_long_words=False, break_on_hyphens=False))


def described(measured, describe):
    return describe(measured) if measured else 'Not measured yet.'


def is_no_worse(row, other):
    return all(float(row[column]) <= float(other[column])
               for column in ('position_error', 'strain_error'))


def errors_of(row):
    return '%s of the side, strain %s' % (percent(float(row['position_error'])),
                                          significant(float(row['strain_error'])))


def advantage(rows):
    """The cost of the peer's settings whose errors are no smaller than the default's, in words."""
    [default] = [row for row in rows if float(row['error']) > 0.0]
    peer = [row for row in rows if is_peer(row)]
    better = sum(is_no_worse(row, default) for row in peer)
    worse = [row for row in peer if is_no_worse(default, row)]
    text = ('%s of the %d settings of Bullet has errors of positions and strain as small as the '
            'default of cloth_sim, %s (%s).' % (better or 'None', len(peer), setting_of(default),
                                                errors_of(default)))
    if not worse:
        return text
    best = min(worse, key=lambda row: float(row['position_error']))
    least = min(worse, key=lambda row: float(row['ms_per_frame']))
    times = [significant(float(row['ms_per_frame']) / float(default['ms_per_frame']))
             for row in (best, least)]
    return text + (' Of the %d that are worse in both, the most accurate, %s `%s` (%s), costs '
                   '**%s times** as much, and the cheapest, %s `%s` (%s), %s times.' %
                   (len(worse), best['method'], setting_of(best), errors_of(best), times[0],
                    least['method'], setting_of(least), errors_of(least), times[1]))


def motion(rows):
    parts = []
    for scene, title in MOTIONS.items():
        of = [row for row in rows if row['scene'] == scene]
        parts += ['#### %s, %s x %s\n' % (title, of[0]['particles'], of[0]['particles']),
                  errors_table(of) + '\n', paragraph(advantage(of)) + '\n']
    return '\n'.join(parts)


def peers(comparisons):
    parts = []
    for one in comparisons:
        rows = [[row['engine'], '`%s`' % row['setting'],
                 '%.2f [%.2f, %.2f]' % (row['ms_per_frame'], row['ms_least'], row['ms_most']),
                 '%.2f %%' % (100.0 * row['column_stretch']), '%.3f' % row['worst_edge'],
                 '%.4f' % row['speed'], '%d' % row['fallen_through']] for row in one['rows']]
        parts.append('#### `%s`, %d x %d\n' %
                     (one['scene'], one['particles'], one['particles']))
        parts.append(table(['engine', 'setting', 'ms per frame [least, most]', 'column', 'edge',
                            'm/s', 'fallen through'], rows) + '\n')
        if 'ratio' in one:
            parts.append(paragraph('At rest, Bullet with `%s` costs %.1f times as much as `%s`, '
                                   'which stretches the cloth no more.' %
                                   (one['peer'], one['ratio'], one['own'])) + '\n')
        else:
            parts.append(paragraph('No setting of one engine stretches the cloth as little as the '
                                   'cheapest setting of the other that holds it.') + '\n')
    return '\n'.join(parts)


def field(comparisons):
    """Other engines, measured elsewhere, and this one, each relative to Bullet in the same run."""
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
    return table(['engine', 'setting', 'ms per frame [least]', 'relative to Bullet `12 x 4`',
                  'column', 'edge'], rows)


def medians(document):
    """Aggregates of each benchmark (median, cv = coefficient of variation) by its name."""
    result = {}
    for entry in document['benchmarks']:
        if entry.get('error_occurred'):  # for instance, it diverged: nothing was timed
            continue
        result.setdefault(entry['run_name'], {})[entry['aggregate_name']] = entry
    return result


def spread(entry, figure='cpu_time'):
    variation = entry.get('cv')
    return '' if variation is None else ' +- %.0f %%' % (100.0 * variation[figure])


def nanoseconds(seconds):
    return '%.2f' % (1e9 * seconds)


def by_suffix(document, prefix):
    """Benchmarks whose names begin with `prefix`, by the rest of their names without settings."""
    return {name[len(prefix):].partition('/iterations')[0]: entry
            for name, entry in medians(document).items() if name.startswith(prefix)}


def with_spread(entry, figure):
    return '%.2f%s' % (entry['median'][figure], spread(entry, figure))


def floors(document):
    """Cost of a spring relative to the floor, measured in turns."""
    rows = []
    kinds = {'grid': 'grid', 'any': 'arbitrary', 'later': 'overflow', 'refined': 'refined'}
    for kind, title in kinds.items():
        for side, entry in by_suffix(document, 'floor/%s/side:' % kind).items():
            rows.append([title, side] + [nanoseconds(entry['median'][figure])
                                        for figure in ('own', 'double', 'float')] +
                        ['**%s**' % with_spread(entry, 'over_double'),
                         with_spread(entry, 'over_float')])
    return described(rows, lambda rows: table(
        ['springs', 'side', '`xpbd`', 'floor, double', 'floor, float', 'over double', 'over float'],
        rows))


def whole(document):
    """Steps of whole scenes relative to the bare one, and of cut cloths relative to the uncut."""
    scenes = {'pins': 'hangs from two pins',
              'armed': 'hangs from two clamps over ground and ball, tearing enabled',
              'cut': 'the same after three cuts',
              'refined': 'the same, refined around the cuts'}
    rows = []
    for method, entry in by_suffix(document, 'whole/').items():
        median = entry['median']
        for what, title in scenes.items():
            is_cut = what in ('cut', 'refined')
            springs = median[what + '_springs']
            rows.append(['`%s`' % method, title, '%d' % median[what + '_particles'], '%d' % springs,
                         with_spread(entry, what), with_spread(entry, what + '_over_pins'),
                         '**%s**' % with_spread(entry, what + '_over_armed') if is_cut else '',
                         '%.2f' % (median[what + '_over_armed'] * median['armed_springs'] / springs)
                         if is_cut else ''])
    return described(rows, lambda rows: table(
        ['method', 'scene', 'particles', 'springs', 'ms per step', 'relative to the first',
         'relative to the uncut cloth', 'the same per spring'], rows))


def parts(document):
    rows = []
    for name, entry in medians(document).items():
        median = entry['median']
        scale = {'ns': 1e-3, 'us': 1.0, 'ms': 1e3}[median['time_unit']]
        per = median.get('per_spring')
        rows.append(['`%s`' % name, '%.4g%s' % (scale * median['cpu_time'], spread(entry)),
                     nanoseconds(per) if per else ''])
    return table(['benchmark', 'CPU time, microseconds', 'ns per spring'], rows)


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
    return table(['method', 'side', 'substeps', 'iterations', 'ms per step',
                  'ns per spring and sweep', 'speed-up with 2 threads'], lines)


def node(document):
    overhead, latency = document['overhead'], document['latency']
    threads = ', '.join('`%s` %.1f %%' % pair
                        for pair in sorted(overhead['threads_percent'].items()))
    return paragraph(
        'Beside its steps (%.1f %% of one core, at a real-time factor of %.2f) the node costs '
        '**%.1f %% of one core**: %.1f %% for snapshots and their hand-over in the simulation thread, '
        'and the rest for messages. %.1f %% are spent in the kernel. By thread: %s. The time from a '
        'command to a clamp until the first `~frame` that shows its effect, for %d commands at random '
        'times: median **%.2f**, 99th percentile **%.2f** frames of 1/60 s.' %
        (overhead['steps_percent'], overhead['real_time_factor'], overhead['overhead_percent'],
         overhead['snapshot_percent'], overhead['overhead_in_kernel_percent'], threads,
         latency['commands'], latency['median_frames'], latency['p99_frames']))


def threads(document):
    """Speed-up by a second thread, and that of two independent simulations on this machine."""
    rows = []
    for name, entry in medians(document).items():
        _, method, side = name.split('/')[:3]
        one, two, gain, apart = (with_spread(entry, figure)
                                 for figure in ('one', 'two', 'gain', 'gain_apart'))
        rows.append(['`%s`' % method, side.split(':')[1], one, two, '**%s**' % gain, apart])
    return table(['method', 'side', 'ms per step', 'with 2 threads', 'speed-up',
                  'two independent simulations'], rows)


def scale(document):
    counters = ['loaded', 'peak', 'stepped', 'mesh', 'springs', 'model', 'state', 'solver']
    rows = []
    for name, entry in medians(document).items():
        median = entry['median']
        rows.append(['`%s`' % name, '%.3g' % (1e-3 * median['cpu_time'])] +
                    ['%.0f' % median[key] if key in median else '' for key in counters])
    return table(['benchmark', 'CPU time, s'] + counters, rows)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__ + '\nusage: bench/report.py FOLDER')
    folder = sys.argv[1]
    print('''# What a step costs

%(measured)s

Times are CPU times; those of steps are wall times. Each is the median of five runs, with the
spread. A speed counts only with its accuracy, so each row of a comparison says how far the cloth
is stretched. [accuracy.md](accuracy.md) relates cost to error, and
[verification.md](verification.md) compares with closed forms. The decisions behind these numbers
are in [decisions](decisions/README.md), the experiments that lost in
[bench/tried.md](../bench/tried.md).

## Beside a peer

### In motion

Both engines move the cloths of [at_size.md](at_size.md): cotton of 1 m and 0.1 kg, 128 x 128
particles, the same masses, pins, gravity and drag, frames of 1/60 s, one thread. One run of
Verlet, which follows the fabric with 0.35 of its longest stable step, is the reference of both;
its row has the differences of a run with half as many substeps. Bullet is the soft body of Bullet
3.24 at full stiffness, `substeps x iterations`, as its demos have it and without bending links;
cotton strains by a thousandth here, so that the stiffest links are the nearest. Bullet has no
force at fixed nodes; its force is what the momentum of its cloth lacks. All contenders take turns
of three frames (`peer_bullet --motion FILE`; `bench/peer/motions.cpp`).
[cloth_study.md](cloth_study.md) defines the errors.

%(motion)s
### At rest

These tables compare cloth at the end of 5 s, when it hangs or lies, and say nothing about motion:
one substep of `projective` per frame damps so much that a cloth in motion is off by half its side
([at_size.md](at_size.md), [limits.md](limits.md)). `xpbd` and `line_xpbd` damp no more than the
air does, so their cloth still sways (*m/s*).

A cloth of 1 m and 0.2 kg, frames of 1/60 s for 5 s, one thread. *Column* says how much longer
than at rest the worst column is at the end, *edge* is the longest edge over its rest length, and
*m/s* is the speed of the fastest particle at the end. Bullet is the soft body of Bullet 3.24 with
bending links and full stiffness; its setting is `substeps x iterations`. Tearing is enabled in
cloth_sim, at a ratio that no spring reaches. The run is divided into five parts, and in each part
all contenders take turns (`bench/peer/peer_bullet.cpp`).

%(peers)s
## Other engines

The same hanging cloth. Others measured the rows above *here*, on another machine with two cores
and AVX2 (`bench/field.json`); `bench/measure.sh` does not repeat them. Only the cost relative to
Bullet in the same run can be compared. With the same `12 x 4`, Bullet stretched twice as far
there; its other settings are not known.

%(field)s

## The floor

Nanoseconds per spring, measured in turns with the floors. A floor is a sweep that does nothing
but correct lengths: on a grid whose structure is known, and over any topology by colours; in
double precision, which `xpbd` uses, and in single precision. *Arbitrary*: particles along a Z
curve, so that no springs form a row. *Overflow*: only the springs of a grid that three slits with
refinement have created or moved, over any topology; *refined*: the whole grid with these slits
(`bench/kernels/floor_bench.cpp`).

%(floors)s

## Whole scenes

128 x 128 particles, one thread, measured in turns; `projective` with one substep and one
iteration (`bench/kernels/whole_bench.cpp`).

%(whole)s

## Parts

`part/start_up` creates a simulation and makes its first step.

%(parts)s

## Steps of every method

The hanging cloth, with the default parameters of each method. Methods with a limit of stability
divide the frame until they are below it (`solver.step_guard: subdivide`). `explicit_euler` has no
stable substep without damping, so it has no row.

%(steps)s

## Two threads

The hanging cloth with `line_xpbd` and `xpbd` (30 and 20 substeps) and with `projective` (one
substep, one iteration), wall time. One thread, two threads and two independent simulations take
turns; the last show what the two cores of this machine give at all. Before each turn threads are
given 50 ms to settle on their cores (`bench/kernels/threads_bench.cpp`). The cores were near each
other; where they are not, two threads may take longer than one
([decision 048](decisions/048-line-solves.md)).

%(threads)s

## The node

The node at 128 x 128, at the pace of the wall clock, with one subscriber of `~frame` (60 Hz) and
one of `~markers` (30 Hz) (`bench/node_overhead`).

%(node)s

## Large cloths

Memory before the first step, in bytes per particle. *Model* has a mesh and springs of its own
(`bench/kernels/scale_bench.cpp`).

%(scale)s''' % {'measured': paragraph('Measured by `bench/measure.sh BUILD` on %s.' %
                                      read(folder, 'machine.txt')),
                'motion': described(read_table(STUDY, 'peer_motion.csv'), motion),
                'peers': described((read(folder, 'hang.json') or []) +
                                   (read(folder, 'sphere.json') or []), peers),
                'field': described(read(folder, 'hang.json'), field),
                'floors': described(read(folder, 'turns.json'), floors),
                'whole': described(read(folder, 'turns.json'), whole),
                'parts': described(read(folder, 'parts.json'), parts),
                'node': described(read(folder, 'node.json'), node),
                'threads': described(read(folder, 'threads.json'), threads),
                'scale': described(read(folder, 'scale.json'), scale),
                'steps': described(read(folder, 'steps.json'), steps)})


if __name__ == '__main__':
    main()
