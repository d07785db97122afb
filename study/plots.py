#!/usr/bin/python3
"""Draws the charts of cloth_study from its tables; needs matplotlib, no display.

usage: plots.py DIR

For every scene in DIR/work_precision.csv: DIR/work_precision_<scene>.svg and .png, error against CPU
time per simulated second. Runs that failed stand in the strip above the chart, at what they cost.
From DIR/stability_limits.csv: DIR/stability.svg and .png, from DIR/resolution.csv: DIR/resolution.svg
and .png. From DIR/at_size.csv and, if it is there, DIR/peer_motion.csv: DIR/at_size_<scene>_<size>.svg
and .png and DIR/at_size_growth.svg and .png. From DIR/reality_*.csv: DIR/reality_bending.svg and .png,
reality_drape, reality_pull, reality_fling and reality_tear. Tables that are not there are left out.
"""
import math
import os
import sys

from reality import MEASURED_DRAPE, at_least_energy, over_density
from tables import ERRORS, is_peer, judged_by, read

try:
    import matplotlib
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt
except ImportError:
    sys.exit('error: the charts need matplotlib (Debian: python3-matplotlib)')

# Okabe & Ito (2008): told apart with any colour vision, and by lightness in print. Yellow is left
# out: it is too light on paper.
COLOURS = ['#0072B2', '#D55E00', '#009E73', '#CC79A7', '#000000', '#56B4E9', '#E69F00', '#7F5FA8',
           '#8C564B', '#6B6B6B']
MARKERS = ['o', 's', '^', 'D', 'v', 'P', 'X', '<', '>', 'p']
FAILED = {'diverged': 'diverged', 'wrong': 'error above 1', 'refused': 'refused'}
GREY = '#555555'
TITLES = {
    'hang_swing': 'A hanging cloth swings',
    'in_plane_wave': 'Waves in the plane of a cloth',
    'drape_sphere': 'A cloth drapes over a sphere',
    'table_edge': 'A cloth hangs over the edge of a table',
    'seam_tear': 'A cloth is torn along a seam',
}

plt.rcParams.update({
    'font.size': 10, 'axes.titlesize': 12, 'axes.titleweight': 'bold', 'axes.titlelocation': 'left',
    'axes.spines.top': False, 'axes.spines.right': False, 'axes.grid': True, 'grid.alpha': 0.25,
    'grid.linewidth': 0.6, 'lines.linewidth': 1.4, 'legend.frameon': False, 'svg.fonttype': 'none',
    'svg.hashsalt': 'cloth_study', 'figure.dpi': 100, 'savefig.dpi': 160,
})


def unique(values):
    return list(dict.fromkeys(values))


class Styles:
    """A colour and a marker for each method, the same on every chart."""

    def __init__(self, methods):
        self.order = sorted(methods)

    def __call__(self, method):
        k = self.order.index(method)
        return {'color': COLOURS[k % len(COLOURS)], 'marker': MARKERS[k % len(MARKERS)]}


def save(figure, folder, name):
    figure.savefig(os.path.join(folder, name + '.svg'), bbox_inches='tight', metadata={'Date': None})
    figure.savefig(os.path.join(folder, name + '.png'), bbox_inches='tight')
    plt.close(figure)


# ---- work and precision --------------------------------------------------------------------------

def curves(rows):
    """The rows of each line of a method: the same step and iterations, by substeps."""
    groups = {}
    for row in rows:
        groups.setdefault((row['dt'], row['iterations']), []).append(row)
    for group in groups.values():
        yield sorted(group, key=lambda row: float(row['cpu_s_per_sim_s']))


def draw_method(axes, rows, style):
    """Filled markers and a solid line for the longest step; open and dashed for shorter ones."""
    longest = max(float(row['dt']) for row in rows)
    default = min(unique(row['iterations'] for row in rows), key=int)
    for curve in curves(rows):
        main = float(curve[0]['dt']) == longest
        axes.plot([float(row['cpu_s_per_sim_s']) for row in curve],
                  [float(row['error']) for row in curve], **style,
                  linestyle='-' if main else ':', linewidth=1.4 if main else 0.9,
                  alpha=1.0 if curve[0]['iterations'] == default else 0.6, markersize=6,
                  markerfacecolor=style['color'] if main else 'white', zorder=3)


def draw_front(axes, front):
    points = [(float(row['cpu_s_per_sim_s']), float(row['error'])) for row in front]
    if points:
        # A staircase: until the next better run is paid for, the one before is the best there is.
        axes.plot(*zip(*points), color='#999999', linewidth=7, alpha=0.35, zorder=1,
                  drawstyle='steps-post', solid_capstyle='round', solid_joinstyle='round')


def label_front(axes, front):
    """Writes the rates of substeps at the ends of the front."""
    for row, offset, side in list(zip([front[:1], front[-1:]], [(8, 7), (-9, -3)],
                                      ['left', 'right']))[:len(front)]:
        rate = float(row[0]['substeps']) / float(row[0]['dt'])
        text = f'{rate:,.0f} substeps/s'.replace(',', '\u2009')
        axes.annotate(text, (float(row[0]['cpu_s_per_sim_s']), float(row[0]['error'])), fontsize=8,
                      color=GREY, xytext=offset, textcoords='offset points', ha=side)


def draw_failures(axes, rows, styles):
    """Draws a line of crosses for each method that failed."""
    methods = unique(row['solver'] for row in rows)
    axes.set_ylim(len(methods) - 0.4, -0.6)
    axes.set_yticks(range(len(methods)))
    axes.set_yticklabels(methods, fontsize=8)
    for row in rows:
        at = max(float(row['cpu_s_per_sim_s']), 1e-9) if row['status'] != 'refused' else None
        if at is not None:
            axes.plot(at, methods.index(row['solver']), linestyle='', markersize=6,
                      marker='x' if row['status'] == 'diverged' else '+', markeredgewidth=1.6,
                      color=styles(row['solver'])['color'])
    axes.set_title('Failed runs: × diverged, + error above 1', fontsize=9, fontweight='normal',
                   color=GREY)
    axes.grid(axis='y', visible=False)
    axes.tick_params(axis='y', length=0)
    axes.tick_params(axis='x', which='both', labelbottom=False)
    axes.spines['left'].set_visible(False)


def scene_figure(with_failures, failed_methods):
    if not with_failures:
        figure, chart = plt.subplots(figsize=(8.0, 5.2))
        return figure, chart, None
    strip = 0.24 * failed_methods
    figure, (margin, chart) = plt.subplots(
        2, 1, sharex=True, figsize=(8.0, 5.4 + strip),
        gridspec_kw={'height_ratios': [strip, 4.8], 'hspace': 0.06 + 0.02 * (failed_methods < 3)})
    return figure, chart, margin


def work_precision_chart(folder, scene, rows, front, styles, reference):
    ok = [row for row in rows if row['status'] == 'ok' and float(row['error']) > 0.0]
    failed = [row for row in rows if row['status'] in ('diverged', 'wrong')
              and math.isfinite(float(row['cpu_s_per_sim_s']))]
    figure, chart, margin = scene_figure(bool(failed), len(unique(r['solver'] for r in failed)))
    for method in unique(row['solver'] for row in ok):
        draw_method(chart, [row for row in ok if row['solver'] == method], styles(method))
        chart.plot([], [], label=method, **styles(method))
    draw_front(chart, front)
    label_front(chart, front)
    chart.plot([], [], color='#999999', linewidth=7, alpha=0.35, label='best (Pareto front)')
    chart.set_xscale('log')
    chart.set_yscale('log')
    own = float(reference['own_error']) if reference else 0.0
    errors = [float(row['error']) for row in ok]
    if errors and own > 0.1 * min(errors):
        chart.axhspan(own / 1e6, own, color='#999999', alpha=0.15, linewidth=0, zorder=0)
        chart.set_ylim(bottom=min(0.5 * own, 0.5 * min(errors)))
        chart.text(0.01, own, 'uncertainty of the reference', fontsize=8, color=GREY, va='top',
                   transform=chart.get_yaxis_transform())
    chart.set_xlabel('CPU time per simulated second, one thread [s/s]')
    chart.set_ylabel('relative error of the time of separation' if scene == 'seam_tear'
                     else 'error of positions / side of the cloth')
    if errors:
        chart.legend(loc='center left', bbox_to_anchor=(1.01, 0.5), fontsize=9)
    steps = sorted({float(row['dt']) for row in rows}, reverse=True)
    note = f'Filled: steps of {1e3 * steps[0]:.3g} ms'
    if len(steps) > 1:
        note += ', open: ' + ', '.join(f'{1e3 * step:.3g} ms' for step in steps[1:])
    note += '; points along a line: substeps.'
    skipped = sum(row['status'] == 'skipped' for row in rows)
    if skipped:
        note += f' {skipped} runs were too expensive (skipped.txt).'
    chart.text(0.0, -0.145, note, fontsize=8, color=GREY,
               transform=chart.transAxes)
    figure.suptitle(TITLES.get(scene, scene) + f'  ({scene})', x=0.125, ha='left',
                    fontweight='bold', fontsize=12, y=0.965 if margin is not None else 0.95)
    if margin is not None:
        draw_failures(margin, failed, styles)
    save(figure, folder, 'work_precision_' + scene)


# ---- stability -----------------------------------------------------------------------------------

LEAST, MOST = 0.02, 1000.0  # ends of the bisection


def stability_chart(folder, limits, styles):
    methods = sorted(unique(row['solver'] for row in limits), reverse=True)
    systems = unique(row['system'] for row in limits)
    figure, axes = plt.subplots(figsize=(8.0, 1.4 + 0.52 * len(methods)))
    for y, method in enumerate(methods):
        colour = styles(method)['color']
        for row in [row for row in limits if row['solver'] == method]:
            k = systems.index(row['system'])
            height = y + 0.17 - 0.34 * k
            limit = float(row['measured_limit'])
            end = MOST if math.isinf(limit) else max(limit, LEAST)
            axes.barh(height, end - LEAST, left=LEAST, height=0.3, color=colour,
                      alpha=0.9 if k == 0 else 0.45, linewidth=0)
            text = {True: 'no limit found', False: f'{limit:.3g}'}[math.isinf(limit)]
            if limit == 0.0:
                text = 'unstable at every step'
            inside = math.isinf(limit)
            axes.text(end * (0.93 if inside else 1.07), height, f'{row["system"]}: {text}',
                      va='center', ha='right' if inside else 'left', fontsize=8,
                      color='white' if inside and k == 0 else 'black')
        predicted = float(limits[[r['solver'] for r in limits].index(method)]['predicted_limit'])
        if math.isfinite(predicted) and predicted > 0.0:
            axes.plot([predicted] * 2, [y - 0.42, y + 0.42], color='black', linewidth=1.6)
    axes.plot([], [], color='black', linewidth=1.6, label='limit that theory gives')
    axes.set_xscale('log')
    axes.set_xlim(LEAST, MOST)
    axes.set_yticks(range(len(methods)))
    axes.set_yticklabels(methods)
    axes.grid(axis='y', visible=False)
    axes.tick_params(axis='y', length=0)
    axes.set_xlabel('largest stable ω h  (frequency of the fastest mode times the substep)')
    axes.set_title('Limits of stability, measured without damping')
    axes.legend(loc='center left', bbox_to_anchor=(1.01, 0.5), fontsize=9)
    save(figure, folder, 'stability')


# ---- resolution ----------------------------------------------------------------------------------

QUANTITIES = {'sag': 'sag under its own weight', 'drape_radius': 'radius draped over a sphere',
              'swing_period': 'period of swinging', 'hoop_sag': 'depth in a hoop',
              'hoop_bias': 'deeper at 45° to the threads', 'hoop_skew': 'deeper along the diagonals'}


def resolution_chart(folder, rows):
    figure, axes = plt.subplots(figsize=(6.4, 4.2))
    for k, quantity in enumerate(unique(row['quantity'] for row in rows)):
        of = [row for row in rows if row['quantity'] == quantity]
        finest = of[-1]
        unit = '' if finest['unit'] == '1' else ' ' + finest['unit']
        axes.plot([int(row['particles']) for row in of],
                  [100.0 * float(row['difference_from_finest']) for row in of],
                  color=COLOURS[k], marker=MARKERS[k],
                  label=f'{QUANTITIES.get(quantity, quantity)}\n'
                        f'(finest: {float(finest["value"]):.2g}{unit})')
    sizes = unique(int(row['particles']) for row in rows)
    axes.set_xscale('log', base=2)
    axes.set_xticks(sizes)
    axes.set_xticklabels(sizes)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.set_xlabel('particles a side')
    axes.set_ylabel('difference from the finest [%]')
    axes.set_title('What depends on the resolution')
    axes.legend(loc='center left', bbox_to_anchor=(1.01, 0.5), fontsize=9)
    save(figure, folder, 'resolution')


# ---- errors and cost at the size that people run --------------------------------------------------

SCENES_AT_SIZE = {'swing': 'A cloth swings from its edge',
                  'hang': 'A cloth falls into two pinned corners',
                  'drop': 'A cloth drapes over a ball',
                  'table': 'A cloth falls over the edge of a table',
                  'towel': 'Two clamps lift a towel and shake it',
                  'pull': 'Two clamps tear a notched cloth'}
LEAST_ERROR = 1e-5  # smaller errors are drawn here
GOALS = {'position_error': 'positions within 1 % of the side',
         'strain_error': 'largest strain within 0.01'}
GOAL = 0.01


def line_of(row):
    """The name of the line that a row belongs to: method, and how its substeps are chosen."""
    return row['method'] + (' with solver.error' if float(row['error']) > 0.0 else '')


def series(rows):
    """The rows by what is drawn as one line."""
    lines = {}
    for row in rows:
        lines.setdefault(line_of(row), []).append(row)
    return lines


def draw_errors(axes, rows, column, styles):
    """Draws an error against cost; methods that iterate have points without a line."""
    for name, of in series(rows).items():
        drawn = [row for row in of if math.isfinite(float(row[column]))]
        is_line = len(unique(row['iterations'] for row in drawn)) == 1
        axes.plot([float(row['ms_per_frame']) for row in drawn],
                  [max(LEAST_ERROR, float(row[column])) for row in drawn], label=name,
                  linestyle='-' if is_line else '', markersize=5, **styles(name))


def at_size_chart(folder, scene, rows, styles):
    """Up to four errors against the cost of a frame."""
    ok = [row for row in rows if row['status'] == 'ok']
    [reference] = [row for row in rows if row['status'] == 'reference']
    columns = judged_by(rows)
    figure, panels = plt.subplots(2, 2, figsize=(10.4, 7.2), sharex=True)
    for axes, column in zip(panels.flat, columns):
        draw_errors(axes, ok, column, styles)
        own = max(LEAST_ERROR, float(reference[column]))
        axes.axhspan(LEAST_ERROR / 2, own, color='#999999', alpha=0.15, linewidth=0, zorder=0)
        axes.set_xscale('log')
        axes.set_yscale('log')
        axes.set_title('error of ' + ERRORS[column][0], fontsize=10, fontweight='normal')
        axes.tick_params(labelbottom=True)
    for axes in panels.flat[len(columns):]:
        axes.set_visible(False)
    for axes in panels.flat[max(0, len(columns) - 2):len(columns)]:
        axes.set_xlabel('CPU time of a frame of 1/60 s [ms]')
    figure.legend(*panels[0][0].get_legend_handles_labels(), loc='center left',
                  bbox_to_anchor=(0.91, 0.5), fontsize=9)
    particles = rows[0]['particles']
    figure.suptitle(f'{SCENES_AT_SIZE.get(scene, scene)}, {particles} × {particles}, cotton'
                    '  (grey: uncertainty of the reference)', x=0.125, ha='left',
                    fontweight='bold', fontsize=12, y=0.95)
    save(figure, folder, f'at_size_{scene}_{particles}')


def cheapest(rows, column):
    """The least cost at each size with which the error meets the goal, as (particles, cost)."""
    points = []
    for size in sorted({int(row['particles']) for row in rows}):
        costs = [float(row['ms_per_frame']) for row in rows
                 if int(row['particles']) == size and float(row[column]) <= GOAL]
        points += [(size, min(costs))] if costs else []
    return points


def growth_chart(folder, rows, styles):
    """Cost to reach 1 % of the side, or a strain error of 0.01, against particles."""
    ok = [row for row in rows if row['status'] in ('ok', 'reference')]
    scenes = [scene for scene in unique(row['scene'] for row in ok) if scene != 'drop']
    figure, panels = plt.subplots(2, len(scenes), figsize=(2.9 * len(scenes), 6.4), sharex=True,
                                  sharey=True, squeeze=False)
    for line, (column, goal) in zip(panels, GOALS.items()):
        for axes, scene in zip(line, scenes):
            for name, of in series([row for row in ok if row['scene'] == scene]).items():
                points = cheapest(of, column)
                if points:
                    axes.plot(*zip(*points), label=name, markersize=5, **styles(name))
            axes.set_xscale('log', base=2)
            axes.set_yscale('log')
            axes.set_title(f'{scene}: {goal}', fontsize=8, fontweight='normal')
    sizes = sorted({int(row['particles']) for row in ok})
    for axes in panels[-1]:
        axes.set_xticks(sizes)
        axes.set_xticklabels(sizes)
        axes.set_xlabel('particles a side')
    for line in panels:
        line[0].set_ylabel('CPU time of a frame [ms]')
    handles = {name: handle for axes in panels.flat
               for handle, name in zip(*axes.get_legend_handles_labels())}
    figure.legend(handles.values(), handles.keys(), loc='center left', bbox_to_anchor=(0.91, 0.5),
                  fontsize=9)
    figure.suptitle('Cost of an error of at most 0.01', x=0.125, ha='left', fontweight='bold',
                    fontsize=12, y=0.96)
    save(figure, folder, 'at_size_growth')


def at_size_charts(folder, rows, peers):
    styles = Styles(unique(line_of(row) for row in rows + peers))
    for scene in unique(row['scene'] for row in rows):
        sizes = [int(row['particles']) for row in rows if row['scene'] == scene]
        largest = max((size for size in sizes if size <= 128), default=max(sizes))
        at_size_chart(folder, scene, [row for row in rows + peers if row['scene'] == scene and
                                      int(row['particles']) == largest], styles)
    growth_chart(folder, rows + peers, styles)


# ---- measured cloth ------------------------------------------------------------------------------

def column(rows, name):
    return [float(row[name]) for row in rows]


def bending_chart(folder, cantilevers, folds):
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.0))
    for k, source in enumerate(unique(row['source'] for row in cantilevers)):
        of = [row for row in cantilevers if row['source'] == source]
        left.plot(column(of, 'bending_over_density'),
                  [1e3 * x for x in column(of, 'simulated_overhang')], linestyle='',
                  marker=MARKERS[k], color=COLOURS[k],
                  label='presets' if source.startswith('src/') else source)
    rows = sorted(cantilevers, key=lambda row: float(row['bending_over_density']))
    left.plot(column(rows, 'bending_over_density'),
              [1e3 * x for x in column(rows, 'standard_overhang')], color=GREY, zorder=1,
              label='ASTM D1388')
    left.set_xscale('log')
    left.set_yscale('log')
    left.set_xlabel('B / ρ  [N m / (kg/m²)]')
    left.set_ylabel('overhang at 41.5° [mm]')
    left.set_title('Cantilever')
    left.legend(fontsize=9)
    right.plot(column(folds, 'bending_over_density'), column(folds, 'height_over_length'),
               linestyle='', marker='o', color=COLOURS[0], label='simulated')
    if folds:
        right.axhline(float(folds[0]['elastica']), color=GREY, label='elastica')
    right.set_xscale('log')
    right.set_ylim(0.0, 1.2)
    right.set_xlabel('B / ρ  [N m / (kg/m²)]')
    right.set_ylabel('height of a soft fold / (B / ρ g)$^{1/3}$')
    right.set_title('Soft fold')
    right.legend(fontsize=9, loc='lower right')
    figure.tight_layout()
    save(figure, folder, 'reality_bending')


def drape_chart(folder, drapes, rim):
    """The rims from above, and the coefficient against the density."""
    fabrics = unique(row['fabric'] for row in drapes)
    figure, panels = plt.subplots(1, len(fabrics) + 1, figsize=(4.1 * (len(fabrics) + 1), 4.1))
    for axes, fabric in zip(panels, fabrics):
        of = [row for row in rim if row['fabric'] == fabric]
        if of:
            axes.fill([100.0 * x for x in column(of, 'x')], [100.0 * y for y in column(of, 'y')],
                      color=COLOURS[0], alpha=0.25)
        for radius, style in ((15.0, '--'), (9.0, '-')):
            axes.add_patch(plt.Circle((0, 0), radius, fill=False, color=GREY, linestyle=style))
        axes.set_xlim(-16, 16)
        axes.set_ylim(-16, 16)
        axes.set_aspect('equal')
        axes.set_title(fabric + ', from above [cm]')
    for k, fabric in enumerate(fabrics):
        panels[-1].axhline(MEASURED_DRAPE[fabric], color=COLOURS[k], linestyle='--',
                           label=f'{fabric}, measured')
        for j, (shows, line) in enumerate((('density', '-'), ('hysteresis', ':'))):
            of = over_density(at_least_energy(drapes), fabric, shows)
            panels[-1].plot(column(of, 'density'), column(of, 'coefficient'), linestyle=line,
                            marker=MARKERS[j], color=COLOURS[k], markersize=5,
                            label=fabric + (', with friction' if shows == 'hysteresis' else ''))
        for j, shows in enumerate(('shear', 'mesh')):
            of = [row for row in at_least_energy(drapes)
                  if (row['fabric'], row['shows']) == (fabric, shows)]
            panels[-1].plot(column(of, 'density'), column(of, 'coefficient'), linestyle='',
                            marker=MARKERS[j + 2], color=COLOURS[k], markersize=5,
                            label=f'{fabric}, other {shows}')
    panels[-1].set_xlabel('density [kg/m²]')
    panels[-1].set_ylabel('drape coefficient [%]')
    panels[-1].set_title('What it depends on')
    panels[-1].legend(fontsize=8, loc='center left', bbox_to_anchor=(1.01, 0.5))
    figure.tight_layout()
    save(figure, folder, 'reality_drape')


def pull_chart(folder, rows):
    presets = unique(row['preset'] for row in rows)
    figure, panels = plt.subplots(1, len(presets), figsize=(3.6 * len(presets), 3.8), squeeze=False)
    for axes, preset in zip(panels[0], presets):
        for k, pull in enumerate(unique(row['pull'] for row in rows)):
            of = [row for row in rows if (row['preset'], row['pull']) == (preset, pull)]
            if not of:
                continue
            axes.plot(column(of, 'strain'), column(of, 'fitted'), color=COLOURS[k],
                      label=f'{pull}, fit to measurements')
            axes.plot(column(of, 'strain'), column(of, 'simulated'), color=COLOURS[k], linestyle=':',
                      marker=MARKERS[k], markersize=5, label=f'{pull}, simulated')
        axes.set_yscale('log')
        axes.set_title(preset)
        axes.set_xlabel('strain')
    panels[0][0].set_ylabel('force per width [N/m]')
    panels[0][-1].legend(fontsize=8, loc='center left', bbox_to_anchor=(1.01, 0.5))
    figure.tight_layout()
    save(figure, folder, 'reality_pull')


def fling_chart(folder, rows):
    """The cloth from the side, at some times."""
    times = unique(row['time'] for row in rows)
    figure, axes = plt.subplots(figsize=(8.0, 5.0))
    shown = times[::3] + times[-1:]
    colours = plt.get_cmap('viridis')
    for k, time in enumerate(unique(shown)):
        of = [row for row in rows if row['time'] == time]
        axes.plot([y + 0.45 * k for y in column(of, 'y')], column(of, 'z'), linestyle='', marker='.',
                  markersize=2, color=colours(0.9 * k / max(1, len(shown) - 1)))
        axes.text(0.45 * k, 0.2, f'{float(time):.1f} s', ha='center', fontsize=8)
    axes.set_aspect('equal')
    axes.set_xlabel('y [m], each time moved by 0.45 m')
    axes.set_ylabel('z [m]')
    axes.set_title('Fling, from the side', pad=14)
    save(figure, folder, 'reality_fling')


def tear_chart(folder, trace, tears):
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 3.8))
    left.plot(column(trace, 'time'), column(trace, 'force'), color=COLOURS[0], linewidth=1.0)
    half = 0.5 * float(tears[0]['energy'])
    for axes, level, label in ((left, half, 'half of the tear energy'), (right, 1.0, None)):
        axes.axhline(level, color=GREY, linestyle='--', label=label)
    left.set_xlabel('time [s]')
    left.set_ylabel('force of a clamp [N]')
    left.set_title('A trouser tear, 65 x 65')
    left.legend(fontsize=9)
    for k, particles in enumerate(sorted({int(row['particles']) for row in tears})):
        of = [row for row in tears if int(row['particles']) == particles]
        right.plot(column(of, 'angle'), column(of, 'force_over_half_energy'), color=COLOURS[k],
                   marker=MARKERS[k], label=f'{particles} x {particles}')
    right.set_ylim(0.8, 1.2)
    right.set_xlabel('angle to the threads [°]')
    right.set_ylabel('force over half of the tear energy')
    right.set_title('On meshes of all sizes, at all angles')
    right.legend(fontsize=9, ncol=2)
    figure.tight_layout()
    save(figure, folder, 'reality_tear')


def reality_charts(folder):
    cantilevers = read(folder, 'reality_cantilever.csv')
    if not cantilevers:
        return
    bending_chart(folder, cantilevers, read(folder, 'reality_fold.csv'))
    drape_chart(folder, read(folder, 'reality_drape.csv'), read(folder, 'reality_rim.csv'))
    pull_chart(folder, read(folder, 'reality_pull.csv'))
    fling_chart(folder, read(folder, 'reality_fling_path.csv'))
    tear_chart(folder, read(folder, 'reality_tear_trace.csv'), read(folder, 'reality_tear.csv'))


def main(folder):
    rows = read(folder, 'work_precision.csv')
    front = read(folder, 'pareto.csv')
    limits = read(folder, 'stability_limits.csv')
    references = {row['scene']: row for row in read(folder, 'references.csv')}
    styles = Styles(unique(row['solver'] for row in rows + limits))
    for scene in unique(row['scene'] for row in rows):
        work_precision_chart(folder, scene, [row for row in rows if row['scene'] == scene],
                             [row for row in front if row['scene'] == scene], styles,
                             references.get(scene))
    if limits:
        stability_chart(folder, limits, styles)
    resolution = read(folder, 'resolution.csv')
    if resolution:
        resolution_chart(folder, resolution)
    at_size = read(folder, 'at_size.csv')
    if at_size:
        peers = [row for row in read(folder, 'peer_motion.csv') if is_peer(row)]
        at_size_charts(folder, at_size, peers)
    reality_charts(folder)


if __name__ == '__main__':
    if len(sys.argv) != 2 or sys.argv[1] in ('-h', '--help'):
        print(__doc__)
        sys.exit(0 if len(sys.argv) == 2 else 2)
    if not os.path.isdir(sys.argv[1]):
        sys.exit(f'error: {sys.argv[1]} is no folder')
    main(sys.argv[1])
