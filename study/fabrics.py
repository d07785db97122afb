#!/usr/bin/python3
"""Makes docs/fabrics.md and its chart from what `cloth_run --fabrics` prints.

usage: fabrics.py page FABRICS.json > docs/fabrics.md
       fabrics.py chart FABRICS.json DIR         (DIR/fabrics.svg and .png; needs matplotlib)
       fabrics.py percentiles DATASET.csv > docs/data/fabrics/measured.csv

The page is study/fabrics.md.in with a table for each fabric in place of "{{ fabrics }}". DATASET.csv
is dataset/dataset.csv of https://github.com/DrapeTester/ClothDrapeTester (Feng et al. 2022): areal
density, and bending rigidity along warp, weft and bias.
"""
import csv
import json
import os
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
MEASURED = os.path.join(ROOT, 'docs', 'data', 'fabrics', 'measured.csv')
GRAVITY = 9.81  # [m/s^2]
PERCENTS = (5, 25, 50, 75, 95)
WINDOW = 0.15   # fabrics whose density differs by at most this part are "of this density"
FEWEST = 15     # fewer fabrics have no percentiles
# With those of the presets.
DENSITIES = (0.05, 0.06, 0.07, 0.083, 0.09, 0.1036, 0.115, 0.128, 0.14, 0.16, 0.187, 0.2, 0.22,
             0.24, 0.26, 0.28, 0.3, 0.324, 0.35, 0.4, 0.45, 0.4806, 0.5, 0.55)


def percentile(values, percent):
    """Interpolates between the two values beside it."""
    values = sorted(values)
    place = percent / 100 * (len(values) - 1)
    below = int(place)
    above = min(below + 1, len(values) - 1)
    return values[below] + (place - below) * (values[above] - values[below])


def write_percentiles(dataset):
    with open(dataset) as file:
        rows = [[float(text) for text in row] for row in list(csv.reader(file))[1:]]
    fabrics = [(row[0], 0.5e-9 * (row[1] + row[2])) for row in rows]
    out = csv.writer(sys.stdout, lineterminator='\n')
    out.writerow(['areal_density', 'fabrics'] + ['bending_p%02d' % p for p in PERCENTS] +
                 ['length_p%02d' % p for p in PERCENTS])
    for density in DENSITIES + ('all',):
        near = [it for it in fabrics if density == 'all' or abs(it[0] / density - 1) <= WINDOW]
        if len(near) < FEWEST:
            sys.exit('error: only %d fabrics of %s kg/m^2' % (len(near), density))
        bending = [it[1] for it in near]
        lengths = [(it[1] / (it[0] * GRAVITY)) ** (1 / 3) for it in near]
        out.writerow([density, len(near)] +
                     ['%.3g' % percentile(values, p) for values in (bending, lengths)
                      for p in PERCENTS])


def measured():
    """Rows of docs/data/fabrics/measured.csv: that of all fabrics, and those of a density."""
    with open(MEASURED) as file:
        rows = list(csv.DictReader(file))
    [whole] = [row for row in rows if row['areal_density'] == 'all']
    return whole, [{key: float(text) for key, text in row.items()} for row in rows
                   if row['areal_density'] != 'all']


def fabrics_in(path):
    with open(path) as file:
        return json.load(file)['fabrics']


def number(value):
    return '%.5g' % value


def table(fabric):
    description = fabric['description']
    lines = ['### `%s`' % fabric['name'], '',
             description[0].upper() + description[1:] + '.',
             'Elasto-gravity length: %.1f mm.' % (1e3 * fabric['elasto_gravity_length_m']), '',
             '| quantity | value | spread | unit | | source |', '|---|---|---|---|---|---|']
    for key, it in fabric['values'].items():
        spread = ('none' if it['low'] == it['high'] else
                  '%s to %s' % (number(it['low']), number(it['high'])))
        lines.append('| `%s` | %s | %s | %s | %s | %s |' % (
            key, number(it['value']), spread, it['unit'],
            'assumed' if it['assumed'] else 'measured', it['source']))
    return '\n'.join(lines)


def page(fabrics):
    with open(os.path.join(ROOT, 'study', 'fabrics.md.in')) as file:
        return file.read().replace('{{ fabrics }}', '\n\n'.join(table(it) for it in fabrics))


def draw(axes, fabrics, rows, quantity, scale, value_of):
    densities = [row['areal_density'] for row in rows]

    def column(percent):
        return [scale * row['%s_p%02d' % (quantity, percent)] for row in rows]

    axes.fill_between(densities, column(5), column(95), color='#0072B2', alpha=0.15, linewidth=0,
                      label='5th to 95th percentile')
    axes.fill_between(densities, column(25), column(75), color='#0072B2', alpha=0.25, linewidth=0,
                      label='25th to 75th percentile')
    axes.plot(densities, column(50), color='#0072B2', label='median of measured fabrics')
    for fabric in fabrics:
        density, value = fabric['values']['areal_density']['value'], scale * value_of(fabric)
        axes.plot(density, value, 'o', color='#D55E00')
        axes.annotate(fabric['name'], (density, value), textcoords='offset points', xytext=(5, 4))
    axes.set_xlabel('areal density [kg/m$^2$]')


def chart(fabrics, folder):
    try:
        import matplotlib
        matplotlib.use('Agg')
        import matplotlib.pyplot as plt
    except ImportError:
        sys.exit('error: the chart needs matplotlib (Debian: python3-matplotlib)')
    plt.rcParams.update({'svg.fonttype': 'none', 'svg.hashsalt': 'fabrics', 'font.size': 10})
    _, rows = measured()
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.4))
    draw(left, fabrics, rows, 'bending', 1e6, lambda it: it['values']['bending']['value'])
    left.set_xscale('log')
    left.set_yscale('log')
    left.set_xticks([0.05, 0.1, 0.2, 0.5], labels=['0.05', '0.1', '0.2', '0.5'])
    left.set_ylabel('bending rigidity [\u00b5N m]')
    left.legend(frameon=False, loc='upper left', fontsize=8)
    draw(right, fabrics, rows, 'length', 1e3, lambda it: it['elasto_gravity_length_m'])
    right.set_ylabel('elasto-gravity length [mm]')
    right.set_ylim(bottom=0)
    for axes in (left, right):
        axes.spines[['top', 'right']].set_visible(False)
    figure.tight_layout()
    figure.savefig(os.path.join(folder, 'fabrics.svg'), metadata={'Date': None})
    figure.savefig(os.path.join(folder, 'fabrics.png'), dpi=130)


def main(arguments):
    if len(arguments) == 2 and arguments[0] == 'page':
        sys.stdout.write(page(fabrics_in(arguments[1])))
    elif len(arguments) == 3 and arguments[0] == 'chart':
        chart(fabrics_in(arguments[1]), arguments[2])
    elif len(arguments) == 2 and arguments[0] == 'percentiles':
        write_percentiles(arguments[1])
    else:
        sys.exit(__doc__)


if __name__ == '__main__':
    main(sys.argv[1:])
