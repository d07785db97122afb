#!/usr/bin/python3
"""Draws pictures of a run from its bag; needs numpy and matplotlib, no display and no master.

usage: picture.py BAG [--out=PNG] [--video=MP4|GIF] [--fps=N] [--scene=SCENE.yaml]
                  [--times=T,T,...] [--size=W[xH]] [--view=AZIMUTH,ELEVATION] [--zoom=F]

One panel per phase, at the phase's end (or one per time given with --times), and a last one with
the springs that failed and the strain over time. The cloth is coloured by strain, its back is of
another colour, edges that tearing made are dark red. --video plays the run in real time, in one
panel. Topics are found by their type, so the bag may be cloth_run's or one recorded from the node.
Obstacles and clamps are those of the scene in the bag; --scene replaces it, or supplies the one
that an older bag lacks. Obstacles that followed something, such as the links of a robot, are where
~scene_markers says. --zoom=0.5 shows twice the surroundings.
"""
import argparse
import os
import sys

import matplotlib
matplotlib.use('Agg')
import matplotlib.animation  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import rosbag  # noqa: E402
import yaml  # noqa: E402

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.append(os.path.join(HERE, '..', 'python'))
from cloth_sim import drawing, frames  # noqa: E402

SCENES = os.path.join(HERE, '..', 'config', 'scenes')


# ---- the bag -------------------------------------------------------------------------------------

class Run:
    """A run in a bag: figures at all times, shapes at the requested times."""

    def __init__(self, path):
        try:
            self.bag = rosbag.Bag(path)
        except OSError as error:
            sys.exit(f'error: {path}: {error.strerror}')
        except rosbag.ROSBagException as error:
            sys.exit(f'error: {path}: {" ".join(str(error).split())}')
        self.topic_of = {info.msg_type: name
                         for name, info in self.bag.get_type_and_topic_info().topics.items()}
        self.frame_kind = ('CompactFrame' if 'cloth_sim/ClothFrame' not in self.topic_of and
                           'cloth_sim/CompactFrame' in self.topic_of else 'ClothFrame')
        for kind in (self.frame_kind, 'ClothTopology', 'ClothState'):
            needed = 'cloth_sim/' + kind
            if needed not in self.topic_of:
                sys.exit(f'error: {path} has no messages of type {needed}')
        self.states = [(stamp, message) for _, message, stamp in self._read('ClothState')]
        self.topologies = {message.revision: topology_of(message)
                           for _, message, _ in self._read('ClothTopology')}
        if not self.states:
            sys.exit(f'error: {path} has no message of type cloth_sim/ClothState')

    def scene(self):
        """The scene that was recorded, overrides included; empty if there is none in the bag."""
        topic = os.path.dirname(self.topic_of['cloth_sim/ClothState']) + '/scene'
        texts = [message.data for _, message, _ in self.bag.read_messages(topics=[topic])]
        return texts[-1] if texts else ''

    def _read(self, kind, **limits):
        return self.bag.read_messages(topics=[self.topic_of['cloth_sim/' + kind]], **limits)

    def phase_ends(self):
        """[(name, index of the phase's last state)]; without phases, four equal parts."""
        names = [state.phase for _, state in self.states]
        if not any(names):
            last = len(names) - 1
            return [('', round(last * part / 4)) for part in range(5)]
        ends = [(name, i) for i, name in enumerate(names)
                if name and (i + 1 == len(names) or names[i + 1] != name)]
        return ends

    def phase_begins(self):
        """The time at which each phase begins, by its name."""
        begins = {}
        for _, state in self.states:
            begins.setdefault(state.phase, state.time)
        return begins

    def state_at(self, time):
        return min(range(len(self.states)), key=lambda i: abs(self.states[i][1].time - time))

    def shape(self, index):
        """The frame nearest to a state: (positions, topology)."""
        stamp, state = self.states[index]
        best = None
        for margin in (0.1, 1.0, 1e6):
            around = dict(start_time=_shift(stamp, -margin), end_time=_shift(stamp, margin))
            near = [message for _, message, _ in self._read(self.frame_kind, **around)
                    if message.revision in self.topologies]
            if near:
                best = min(near, key=lambda frame: abs(frame.time - state.time))
                break
        if best is None:
            sys.exit('error: the bag has no frame that belongs to one of its topologies')
        return frames.positions(best).astype(float), self.topologies[best.revision]

    def obstacle_poses(self, index):
        """The poses of the markers of obstacles at a state, in their order; none without markers."""
        stamp, _ = self.states[index]
        topic = os.path.dirname(self.topic_of['cloth_sim/ClothState']) + '/scene_markers'
        messages = self.bag.read_messages(topics=[topic], start_time=_shift(stamp, -0.2),
                                          end_time=_shift(stamp, 0.2))
        nearest = min(((abs((at - stamp).to_sec()), number, message)
                       for number, (_, message, at) in enumerate(messages)), default=None)
        if nearest is None:
            return []
        return [drawing.pose_of(marker.pose) for marker in nearest[2].markers
                if marker.ns == 'obstacles' and marker.action == 0]  # ADD


def _shift(stamp, seconds):
    moved = stamp.to_sec() + seconds
    return type(stamp).from_sec(min(max(moved, 0.0), 4e9))


def topology_of(message):
    """The drawn topology of a message cloth_sim/ClothTopology."""
    return drawing.Topology(np.array(message.triangles, dtype=np.int64).reshape(-1, 3),
                            np.array(message.uv, dtype=float).reshape(-1, 2),
                            np.array(message.torn_edges, dtype=np.int64).reshape(-1, 2))


def find_scene(path):
    """The file; a plain name is that of a scene in config/scenes."""
    if os.path.exists(path) or os.path.basename(path) != path:
        return path
    return os.path.join(SCENES, path if path.endswith('.yaml') else path + '.yaml')


def read_scene(path, recorded, begins=None):
    """The obstacles and clamps of a scene file, or without one of the text in the bag.

    `begins`: the time at which each phase of the run begins, by its name."""
    try:
        if path:
            with open(find_scene(path)) as file:
                recorded = file.read()
        scene = yaml.safe_load(recorded) or {}
    except (OSError, yaml.YAMLError) as error:
        sys.exit(f'error: --scene: {path}: {" ".join(str(error).split())}')
    return drawing.Scene(scene, [os.path.dirname(find_scene(path)) if path else '', '', SCENES],
                         begins)


# ---- panels and videos ---------------------------------------------------------------------------

def plot_figures(axes, run):
    times = [state.time for _, state in run.states]
    axes.plot(times, [state.broken.total for _, state in run.states], color='#d7263d')
    axes.set_xlabel('simulated time [s]')
    axes.set_ylabel('failed springs', color='#d7263d')
    strain = axes.twinx()
    strain.plot(times, [state.max_strain for _, state in run.states], color='#3f7fb5', lw=0.8)
    strain.set_ylabel('largest strain [-]', color='#3f7fb5')
    axes.set_ylim(bottom=0)
    strain.set_ylim(bottom=0)
    last = None
    for time, (_, state) in zip(times, run.states):
        if state.phase != last:
            axes.axvline(time, color='0.85', lw=0.8, zorder=0)
            last = state.phase


ASPECT = 460 / 560  # of a panel: height over width


def panel_size(text):
    """(width, height) [pixels] of WxH, or of a width alone."""
    width, cross, height = text.partition('x')
    size = int(width), int(height) if cross else round(ASPECT * int(width))
    if min(size) < 16 or max(size) > 10000:
        raise ValueError
    return size


def numbers(text):
    """The numbers of a list with commas."""
    return [float(part) for part in text.split(',')]


def angles(text):
    """(azimuth, elevation) [deg]."""
    azimuth, elevation = numbers(text)
    return azimuth, elevation


def draw_moment(axes, camera, scene, run, index):
    """Draws the cloth and its surroundings at a state of the run."""
    picture = drawing.Picture(camera)
    for triangles, colour in scene.solids(run.states[index][1], run.obstacle_poses(index)):
        picture.add_solid(triangles, colour)
    picture.add_cloth(*run.shape(index))
    axes.imshow(picture.buffer.samples())
    axes.set_axis_off()


def camera_for(run, indices, args):
    everywhere = np.concatenate([run.shape(index)[0][::7] for index in indices])
    return drawing.Camera(everywhere, *args.view, *args.size, args.zoom)


def draw_panels(run, scene, args):
    if args.times:
        moments = [('', run.state_at(time)) for time in args.times]
    else:
        moments = run.phase_ends()
    camera = camera_for(run, [index for _, index in moments], args)

    width, height = args.size
    only_one = args.times is not None and len(moments) == 1
    panels = len(moments) + (0 if args.times else 1)
    # The fewest empty places; four beside each other where it is all the same.
    columns = min(panels, 4) if panels <= 4 else min((4, 3, 5), key=lambda n: -panels % n)
    rows = -(-panels // columns)
    title_height = 0 if only_one else 40
    figure = plt.figure(facecolor='white', figsize=(columns * width / 100,
                                                    rows * (height + title_height) / 100))
    for number, (name, index) in enumerate(moments):
        axes = figure.add_subplot(rows, columns, number + 1)
        draw_moment(axes, camera, scene, run, index)
        if not only_one:
            title = f'{number + 1}  {name}' if name else f'{number + 1}'
            axes.set_title(f'{title}   {run.states[index][1].time:.2f} s', fontsize=11, loc='left')
    if only_one:
        figure.subplots_adjust(0, 0, 1, 1)
    else:
        figure.tight_layout(pad=0.6)
        if panels > len(moments):
            axes = figure.add_subplot(rows, columns, panels)
            plot_figures(axes, run)
            figure.tight_layout(pad=0.6)
    figure.savefig(args.out, dpi=100)


class GifWriter(matplotlib.animation.PillowWriter):
    """Pillow chooses the 256 colours of a frame better where it has no transparency."""

    def finish(self):
        self._frames = [frame.convert('RGB') for frame in self._frames]
        super().finish()


def video_writer(path, fps):
    if path.endswith('.gif'):
        return GifWriter(fps=fps)
    if not matplotlib.animation.FFMpegWriter.isAvailable():
        sys.exit(f'error: --video: {path}: mp4 needs ffmpeg (Debian: ffmpeg), gif does not')
    # Players want even sizes, and pixels of this kind.
    return matplotlib.animation.FFMpegWriter(fps=fps, extra_args=[
        '-vf', 'pad=ceil(iw/2)*2:ceil(ih/2)*2', '-pix_fmt', 'yuv420p'])


def draw_video(run, scene, args):
    """Draws a frame for every 1/fps of simulated time."""
    writer = video_writer(args.video, args.fps)
    first, last = run.states[0][1].time, run.states[-1][1].time
    count = int((last - first) * args.fps + 1e-6) + 1
    indices = [run.state_at(first + k / args.fps) for k in range(count)]
    camera = camera_for(run, indices[::max(1, count // 12)] + indices[-1:], args)
    width, height = args.size
    figure = plt.figure(facecolor='white', figsize=(width / 100, height / 100))
    axes = figure.add_axes((0, 0, 1, 1))
    try:
        with writer.saving(figure, args.video, dpi=100):
            for index in indices:
                axes.clear()
                draw_moment(axes, camera, scene, run, index)
                state = run.states[index][1]
                axes.text(0.02, 0.97, f'{state.time:.2f} s  {state.phase}', va='top', fontsize=10,
                          transform=axes.transAxes)
                writer.grab_frame()
    except OSError as error:
        sys.exit(f'error: --video: {args.video}: {error.strerror or error}')


def video_name(text):
    if not text.endswith(('.mp4', '.gif')):
        raise ValueError
    return text


def rate(text):
    if not 0 < float(text) <= 100:
        raise ValueError
    return float(text)


def zoom_factor(text):
    if not 0.01 <= float(text) <= 100:
        raise ValueError
    return float(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('bag')
    parser.add_argument('--out', help='the PNG to write')
    parser.add_argument('--video', type=video_name, help='the .mp4 (with ffmpeg) or .gif to write')
    parser.add_argument('--fps', type=rate, default=20, help='frames of the video per second')
    parser.add_argument('--scene', help='the scene file, or the name of one in config/scenes, with '
                        'obstacles and clamps other than those in the bag')
    parser.add_argument('--times', type=numbers, help='simulated times [s] instead of the ends of the phases')
    parser.add_argument('--view', type=angles, default='-62,24', help='azimuth,elevation of the eye [deg]')
    parser.add_argument('--zoom', type=zoom_factor, default=1.0,
                        help='less than 1 shows more of what is around the cloth')
    parser.add_argument('--size', type=panel_size, default='560x460',
                        help='WxH, or the width, of one panel [pixels]')
    args = parser.parse_args()
    if not args.out and not args.video:
        parser.error('--out or --video is required')

    run = Run(args.bag)
    scene = read_scene(args.scene, run.scene(), run.phase_begins())
    try:
        if args.out:
            draw_panels(run, scene, args)
        if args.video:
            draw_video(run, scene, args)
    except drawing.DrawingError as error:
        sys.exit(f'error: {error}')


if __name__ == '__main__':
    main()
