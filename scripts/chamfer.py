#!/usr/bin/python3
"""One-sided Chamfer distance of measured point clouds from a simulated cloth, over time.

  scripts/chamfer.py clouds.csv docs/data/study/reality_fling_path.csv
  scripts/chamfer.py scan_*.ply run.bag --times times.csv --time-offset -1.5 --table distance.csv

For every measured cloud, the distance of its points from the nearest particle of the cloth at the
same time, averaged over the points [m]. Particles between two frames of the simulation are
interpolated. The first arguments are the measured clouds, the last one is the simulation:

  .csv   lines of time,x,y,z (s and m); a first line with names is skipped
  .npy   an array (points, 4) of time, x, y, z, or (frames, points, 3) with --times
  .ply   one ASCII file for each cloud, with --times
  .bag   a bag of the node or of cloth_run --bag (simulation only)

--times names a file with one time a line [s], in the order of the clouds; of several columns, the
last one counts. Both must be in the same frame: --translate moves the measured points, and
--time-offset is added to their times. Points that are not finite are left out. Needs numpy; for
bags, rosbag's Python module. Exit status: 0 done; 2 bad input, with one line on standard error.
"""
import argparse
import csv
import os
import sys

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from read_bag import BadInput, Run, table, write_whole  # noqa: E402

BLOCK = 2048  # points whose distances from all particles are in memory at the same time


def read_text(path):
    try:
        with open(path, newline='', encoding='utf-8') as file:
            return file.read()
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput('%s: cannot be read as text (%s)' % (path, error)) from error


def numbers(path, number, fields, count=None):
    """The fields of a line as numbers."""
    try:
        values = [float(field) for field in fields]
    except ValueError:
        raise BadInput('%s:%d: expected numbers (got %s)' % (path, number, ' '.join(fields)[:40])) \
            from None
    if count is not None and len(values) != count:
        raise BadInput('%s:%d: expected %d numbers (got %d)' % (path, number, count, len(values)))
    return values


def is_name(field):
    try:
        float(field)
    except ValueError:
        return True
    return False


def read_csv(path):
    """Rows of time, x, y, z."""
    rows = []
    for number, fields in enumerate(csv.reader(read_text(path).splitlines()), 1):
        if not fields or (number == 1 and all(is_name(field) for field in fields)):
            continue
        rows.append(numbers(path, number, fields, 4))
    return np.array(rows).reshape(-1, 4)


def clouds_of_rows(path, rows):
    """Splits rows of time, x, y, z into (time, points), ascending by time."""
    if len(rows) == 0:
        raise BadInput('%s: there are no points in it' % path)
    if not np.isfinite(rows[:, 0]).all():
        raise BadInput('%s: expected finite times' % path)
    return [(time, rows[rows[:, 0] == time, 1:]) for time in np.unique(rows[:, 0])]


def read_times(path):
    times = []
    for number, line in enumerate(read_text(path).splitlines(), 1):
        fields = line.replace(',', ' ').split()
        if fields and not (number == 1 and is_name(fields[-1])):
            times += numbers(path, number, fields[-1:])
    return times


def with_times(clouds, times, what):
    if times is None:
        raise BadInput('%s: expected --times, a time for each cloud' % what)
    if len(times) != len(clouds):
        raise BadInput('--times: expected %d times (got %d)' % (len(clouds), len(times)))
    return sorted(zip(times, clouds), key=lambda pair: pair[0])


def read_npy(path, times):
    try:
        array = np.load(path, allow_pickle=False)
    except (OSError, ValueError) as error:
        raise BadInput('%s: no array that can be read (%s)' % (path, error)) from error
    if array.ndim == 2 and array.shape[1] == 4:
        return clouds_of_rows(path, array.astype(float))
    if array.ndim == 3 and array.shape[2] == 3:
        return with_times(list(array.astype(float)), times, path)
    raise BadInput('%s: expected (points, 4) or (frames, points, 3) numbers (got %s)'
                   % (path, array.shape))


def read_ply(path):
    """The vertices of an ASCII PLY file."""
    try:
        with open(path, 'rb') as file:
            data = file.read()
    except OSError as error:
        raise BadInput('%s: cannot be read (%s)' % (path, error.strerror)) from error
    head, end, body = data.partition(b'end_header')
    lines = head.decode('ascii', 'replace').splitlines()
    if not end or not lines or lines[0].strip() != 'ply':
        raise BadInput('%s: no PLY file' % path)
    if 'format ascii 1.0' not in [line.strip() for line in lines]:
        raise BadInput('%s: expected the format "ascii 1.0"' % path)
    elements = [line.split() for line in lines if line.startswith(('element', 'property'))]
    if not elements or elements[0][:2] != ['element', 'vertex'] or len(elements[0]) != 3:
        raise BadInput('%s: expected "element vertex" first' % path)
    count = int(numbers(path, 1, elements[0][2:])[0])
    names = []
    for words in elements[1:]:
        if words[0] == 'element':
            break
        names.append(words[-1])
    try:
        columns = [names.index(axis) for axis in 'xyz']
    except ValueError:
        raise BadInput('%s: expected the properties x, y and z' % path) from None
    rows = body.decode('ascii', 'replace').splitlines()[1:count + 1]
    if len(rows) < count:
        raise BadInput('%s: expected %d vertices (got %d)' % (path, count, len(rows)))
    first = len(lines) + 2
    return np.array([[numbers(path, first + k, row.split(), len(names))[c] for c in columns]
                     for k, row in enumerate(rows)]).reshape(-1, 3)


def read_measured(paths, times):
    """[(time, points)] of the measured clouds."""
    kinds = {os.path.splitext(path)[1].lower() for path in paths}
    if kinds == {'.ply'}:
        return with_times([read_ply(path) for path in paths], times, paths[0])
    if len(paths) != 1:
        raise BadInput('expected one file of measured clouds, or several of .ply (got %d)'
                       % len(paths))
    if kinds == {'.csv'}:
        return clouds_of_rows(paths[0], read_csv(paths[0]))
    if kinds == {'.npy'}:
        return read_npy(paths[0], times)
    raise BadInput('%s: expected .csv, .npy or .ply' % paths[0])


def read_simulated(path, node):
    """[(time, points)] of the simulation."""
    kind = os.path.splitext(path)[1].lower()
    if kind == '.csv':
        return clouds_of_rows(path, read_csv(path))
    if kind == '.npy':
        return read_npy(path, None)
    if kind == '.bag':
        frames = [(frame.time, positions.astype(float))
                  for frame, positions, _ in Run(path, node).meshes()]
        if not frames:
            raise BadInput('%s: there are no frames in it' % path)
        return sorted(frames, key=lambda pair: pair[0])
    raise BadInput('%s: expected .bag, .csv or .npy' % path)


def at_time(frames, time):
    """The particles at a time, interpolated; None outside of the simulation."""
    times = [frame[0] for frame in frames]
    if not times[0] - 1e-9 <= time <= times[-1] + 1e-9:
        return None
    k = int(np.clip(np.searchsorted(times, time), 1, max(1, len(times) - 1)))
    if len(times) == 1:
        return frames[0][1]
    before, after = frames[k - 1], frames[k]
    part = (time - before[0]) / (after[0] - before[0])
    if len(before[1]) != len(after[1]):  # the cloth was cut in between
        return (before if part < 0.5 else after)[1]
    return (1.0 - part) * before[1] + part * after[1]


def distances(points, particles):
    """Distance of each point from the nearest particle."""
    nearest = []
    for first in range(0, len(points), BLOCK):
        block = points[first:first + BLOCK]
        square = np.full(len(block), np.inf)
        for start in range(0, len(particles), BLOCK):
            part = particles[start:start + BLOCK]
            apart = ((block[:, None, :] - part[None, :, :]) ** 2).sum(axis=2)
            square = np.minimum(square, apart.min(axis=1))
        nearest.append(np.sqrt(square))
    return np.concatenate(nearest)


def compare(measured, frames, translate, offset):
    """Rows of time, points, mean and largest distance; and the number of clouds left out."""
    rows, left_out = [], 0
    for time, points in measured:
        points = points[np.isfinite(points).all(axis=1)] + translate
        particles = at_time(frames, time + offset)
        if particles is None or len(points) == 0:
            left_out += 1
            continue
        apart = distances(points, particles)
        rows.append([time + offset, len(points), apart.mean(), apart.max()])
    return rows, left_out


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('measured', nargs='+', help='measured clouds: .csv, .npy or .ply')
    parser.add_argument('simulated', help='the simulation: .bag, .csv or .npy')
    parser.add_argument('--times', metavar='FILE', help='a time for each cloud, one a line [s]')
    parser.add_argument('--time-offset', type=float, default=0.0, metavar='S',
                        help='added to the measured times')
    parser.add_argument('--translate', type=float, nargs=3, default=[0.0, 0.0, 0.0],
                        metavar=('X', 'Y', 'Z'), help='added to the measured points [m]')
    parser.add_argument('--node', help='namespace of the node in the bag, if there are several')
    parser.add_argument('--table', metavar='CSV', help='the distances over time')
    return parser.parse_args(arguments)


def main(arguments=None):
    options = parse(arguments)
    try:
        times = read_times(options.times) if options.times else None
        measured = read_measured(options.measured, times)
        frames = read_simulated(options.simulated, options.node)
        rows, left_out = compare(measured, frames, np.array(options.translate),
                                 options.time_offset)
        if not rows:
            raise BadInput('no measured cloud is within the time of the simulation, %g to %g s'
                           % (frames[0][0], frames[-1][0]))
        if options.table:
            write_whole(options.table, table(['time_s', 'points', 'mean_m', 'largest_m'], rows))
        print('one-sided Chamfer distance %.6f m, mean of %d clouds (%.6f to %.6f m)'
              % (np.mean([row[2] for row in rows]), len(rows), min(row[2] for row in rows),
                 max(row[2] for row in rows)))
        if left_out:
            print('%d clouds left out: without points, or not within %g to %g s'
                  % (left_out, frames[0][0], frames[-1][0]))
    except BadInput as error:
        print('chamfer.py: %s' % error, file=sys.stderr)
        return 2
    return 0


if __name__ == '__main__':
    sys.exit(main())
