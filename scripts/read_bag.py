#!/usr/bin/python3
"""Reads a bag of cloth_sim: plots, a table, and the cloth as a sequence of meshes.

  scripts/read_bag.py run.bag                                  what is in it
  scripts/read_bag.py run.bag --plot run.png --table run.csv   broken springs, strain, forces
  scripts/read_bag.py run.bag --meshes meshes --format ply     one file a frame

Bags are those of the node (roslaunch cloth_sim cloth.launch bag:=...) and of cloth_run --bag. Needs
rosbag's Python module, numpy, and matplotlib for --plot; no ROS master. Exit status: 0 done; 2 bad
input, with one line on standard error.
"""
import argparse
import csv
import io
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.append(os.path.join(HERE, os.pardir, 'python'))
from cloth_sim import frames  # noqa: E402

KIND = 'cloth_sim/ClothState'


class BadInput(Exception):
    """Wrong input; the message is one line."""


def write_whole(path, data):
    """Writes a file completely or not at all."""
    temporary = '%s.tmp%d' % (path, os.getpid())
    try:
        with open(temporary, 'wb') as file:
            file.write(data)
        os.replace(temporary, path)
    except OSError as error:
        if os.path.exists(temporary):
            os.remove(temporary)
        raise BadInput('%s: cannot be written (%s)' % (path, error.strerror)) from error


class Run:
    """The recorded messages of one node in a bag."""

    def __init__(self, path, node=None):
        import rosbag  # here, so that --help needs no ROS
        try:
            self.bag = rosbag.Bag(path)
        except (OSError, rosbag.ROSBagException) as error:
            raise BadInput('%s: no bag that can be read (%s)' % (path, error)) from error
        topics = self.bag.get_type_and_topic_info().topics
        nodes = sorted(topic[:-len('/state')] for topic, info in topics.items()
                       if info.msg_type == KIND and topic.endswith('/state'))
        if node is None:
            if len(nodes) != 1:
                raise BadInput('%s: expected the ~state of one cloth (got %s; choose with --node)'
                               % (path, ', '.join(nodes) or 'none'))
            node = nodes[0]
        elif node not in nodes:
            raise BadInput('%s: there is no %s/state (there is: %s)'
                           % (path, node, ', '.join(nodes) or 'none'))
        self.path, self.node, self.topics = path, node, topics

    def messages(self, *names):
        """Yields (last part of the topic, message) for topics of the node, in the order of the bag."""
        wanted = {self.node + '/' + name: name for name in names}
        for topic, message, _ in self.bag.read_messages(topics=list(wanted)):
            yield wanted[topic], message

    def rows(self):
        """(names of the columns, a row for every state)."""
        names, rows = None, []
        for _, state in self.messages('state'):
            if names is None:
                names = ['time_s', 'step', 'phase', 'pieces', 'broken', 'torn', 'cut', 'max_strain',
                         'kinetic_j', 'elastic_j', 'gravity_j']
                names += ['force_%s_n' % clamp.name for clamp in state.clamps]
                names += ['state_hash']
            row = [state.time, state.step, state.phase, state.pieces, state.broken.total,
                   state.broken_torn, state.broken_cut, state.max_strain, state.kinetic_energy,
                   state.elastic_energy, state.gravity_energy]
            for clamp in state.clamps:
                force = clamp.wrench.force
                row.append(float(np.linalg.norm([force.x, force.y, force.z])))
            rows.append(row + [state.state_hash])
        if not rows:
            raise BadInput('%s: there are no states in it' % self.path)
        return names, rows

    def meshes(self):
        """Yields (frame, positions, topology) of every frame whose topology is in the bag."""
        topologies = {}
        for name, message in self.messages('topology', *frames.TOPICS):
            if name == 'topology':
                topologies[message.revision] = message
                continue
            topology = topologies.get(message.revision)
            positions = frames.positions(message)
            if topology is not None and len(topology.uv) == 2 * len(positions):
                yield message, positions, topology


def describe(run, names, rows):
    last = dict(zip(names, rows[-1]))
    print('%s: %s, %d states, t = %g ... %g s' % (run.path, run.node, len(rows), rows[0][0],
                                                  last['time_s']))
    print('broken %(broken)d (torn %(torn)d, cut %(cut)d), pieces %(pieces)d, hash %(state_hash)s'
          % last)
    for topic, info in sorted(run.topics.items()):
        if topic.startswith(run.node + '/'):
            print('%7d  %-28s %s' % (info.message_count, topic, info.msg_type))


def table(names, rows):
    text = io.StringIO()
    writer = csv.writer(text, lineterminator='\n')
    writer.writerow(names)
    writer.writerows(rows)
    return text.getvalue().encode()


def plot(names, rows, title):
    import matplotlib
    matplotlib.use('Agg')
    from matplotlib import pyplot
    columns = dict(zip(names, zip(*rows)))
    time = columns['time_s']
    forces = [name for name in names if name.startswith('force_')]
    figure, axes = pyplot.subplots(2 + bool(forces), 1, sharex=True, figsize=(8, 7))
    for name in ('broken', 'torn', 'cut'):
        axes[0].step(time, columns[name], where='post', label=name)
    axes[0].set_ylabel('failed springs')
    axes[0].legend()
    axes[1].plot(time, columns['max_strain'], color='tab:red')
    axes[1].set_ylabel('largest strain')
    for name in forces:
        axes[2].plot(time, columns[name], label=name[len('force_'):-len('_n')])
    if forces:
        axes[2].set_ylabel('force on clamp [N]')
        axes[2].legend()
    axes[-1].set_xlabel('simulated time [s]')
    for axis in axes:
        axis.grid(alpha=0.3)
    axes[0].set_title(title)
    image = io.BytesIO()
    figure.savefig(image, format='png', dpi=110, bbox_inches='tight')
    return image.getvalue()


def obj(positions, topology):
    """The mesh as a Wavefront OBJ with material coordinates as texture coordinates; z is up."""
    faces = np.array(topology.triangles).reshape(-1, 3) + 1
    lines = ['v %.9g %.9g %.9g' % tuple(p) for p in positions]
    lines += ['vt %.9g %.9g' % tuple(p) for p in np.array(topology.uv).reshape(-1, 2)]
    lines += ['f %d/%d %d/%d %d/%d' % (a, a, b, b, c, c) for a, b, c in faces]
    return ('\n'.join(lines) + '\n').encode()


def ply(positions, topology):
    """The mesh as a binary PLY; material coordinates are the properties s and t."""
    uv = np.array(topology.uv, dtype='<f4').reshape(-1, 2)
    faces = np.array(topology.triangles, dtype='<i4').reshape(-1, 3)
    header = ['ply', 'format binary_little_endian 1.0', 'element vertex %d' % len(positions)]
    header += ['property float ' + name for name in ('x', 'y', 'z', 's', 't')]
    header += ['element face %d' % len(faces), 'property list uchar int vertex_indices',
               'end_header', '']
    packed = np.empty(len(faces), dtype=[('count', 'u1'), ('corners', '<i4', 3)])
    packed['count'] = 3
    packed['corners'] = faces
    return '\n'.join(header).encode() + np.hstack([positions, uv]).tobytes() + packed.tobytes()


def write_meshes(run, folder, kind, every):
    """Writes frame_<number>.<kind> for every N-th frame, and times.csv; returns their number."""
    os.makedirs(folder, exist_ok=True)
    times, number = [], 0
    for number, (frame, positions, topology) in enumerate(run.meshes()):
        if number % every:
            continue
        name = 'frame_%05d.%s' % (number, kind)
        data = obj(positions, topology) if kind == 'obj' else ply(positions, topology)
        write_whole(os.path.join(folder, name), data)
        times.append([name, frame.time, frame.step, frame.revision])
    write_whole(os.path.join(folder, 'times.csv'),
                table(['file', 'time_s', 'step', 'revision'], times))
    return len(times)


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('bag')
    parser.add_argument('--node', help='namespace of the node, if there are several: /cloth')
    parser.add_argument('--plot', metavar='PNG', help='charts over time')
    parser.add_argument('--table', metavar='CSV', help='the figures over time')
    parser.add_argument('--meshes', metavar='DIR', help='folder for a mesh of every frame')
    parser.add_argument('--format', choices=('obj', 'ply'), default='obj', help='of meshes')
    parser.add_argument('--every', type=int, default=1, metavar='N', help='only each N-th frame')
    options = parser.parse_args(arguments)
    if options.every < 1:
        parser.error('--every: expected a number >= 1')
    return options


def main(arguments=None):
    options = parse(arguments)
    try:
        run = Run(options.bag, options.node)
        names, rows = run.rows()
        describe(run, names, rows)
        if options.table:
            write_whole(options.table, table(names, rows))
        if options.plot:
            write_whole(options.plot, plot(names, rows, os.path.basename(options.bag)))
        if options.meshes:
            count = write_meshes(run, options.meshes, options.format, options.every)
            print('%d meshes in %s' % (count, options.meshes))
    except BadInput as error:
        print('read_bag.py: %s' % error, file=sys.stderr)
        return 2
    return 0


if __name__ == '__main__':
    sys.exit(main())
