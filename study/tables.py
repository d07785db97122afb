"""Reads the CSV tables of cloth_study, and writes numbers and tables for pages."""
import csv
import math
import os

# Columns of at_size.csv that are errors, with their titles and whether they are shown in per cent.
ERRORS = {
    'position_error': ('positions', True),
    'strain_error': ('largest strain', False),
    'force_error': ('force at the pins', True),
    'energy_error': ('energy', True),
    'rest_strain_error': ('largest strain at rest', False),
    'rest_elastic_error': ('elastic energy at rest', True),
    'rest_radius_error': ('radius at rest [m]', False),
    'peak_force_error': ('peak force', True),
    'separation_error': ('separation [s]', False),
}


def read(folder, name):
    """The rows of DIR/NAME as dictionaries; none if there is no such table."""
    path = os.path.join(folder, name)
    if not os.path.exists(path):
        return []
    with open(path, newline='') as file:
        return list(csv.DictReader(file))


def percent(value, digits=2):
    """Formats a fraction with some significant digits: 0.00123 -> '0.12 %'."""
    return f'{significant(100.0 * value, digits)} %'


def significant(value, digits=2):
    """Formats a number with some significant digits, without an exponent."""
    if value == 0.0 or not math.isfinite(value):
        return '0' if value == 0.0 else '-'
    decimals = digits - 1 - math.floor(math.log10(abs(value)))
    return f'{round(value, decimals):,.{max(0, decimals)}f}'


def markdown_table(header, rows):
    lines = ['| ' + ' | '.join(header) + ' |', '|' + '---|' * len(header)]
    return '\n'.join(lines + ['| ' + ' | '.join(row) + ' |' for row in rows])


def is_peer(row):
    """Whether a row of at_size.csv or peer_motion.csv is of Bullet."""
    return row['method'].startswith('Bullet')


def judged_by(rows):
    """The columns of errors that say something about a scene: all that its reference has; only those
    at rest and the positions, if it comes to rest; peak and separation instead of the force and the
    energy, if it tears."""
    [reference] = [row for row in rows if row['status'] == 'reference'][:1]
    columns = [name for name in ERRORS if math.isfinite(float(reference[name]))]
    at_rest = [name for name in columns if name.startswith('rest_')]
    if 'peak_force_error' in columns:
        return ['position_error', 'strain_error', 'peak_force_error', 'separation_error']
    return ['position_error'] + at_rest if at_rest else columns


def short(value):
    """Two significant digits, with an exponent only if the number is tiny."""
    return f'{value:.1e}' if 0.0 < abs(value) < 1e-5 else significant(value)


def shown_error(row, column):
    value = float(row[column])
    if not math.isfinite(value):
        return '-'
    return short(100.0 * value) + ' %' if ERRORS[column][1] else short(value)


def setting_of(row):
    if float(row['error']) > 0.0:
        return f"`error: {float(row['error']):g}`"
    return row['substeps'] + (f" x {row['iterations']}" if int(row['iterations']) else '')


def errors_table(rows):
    """The rows of one scene at one size, as a table."""
    columns = judged_by(rows)
    lines = []
    for row in rows:
        is_reference = row['status'] == 'reference'
        name = 'reference' if is_reference else row['method'] if is_peer(row) else f"`{row['method']}`"
        errors = [shown_error(row, column) for column in columns]
        if row['status'] not in ('ok', 'reference'):
            errors = ['failed'] + [''] * (len(columns) - 1)
        lines.append([name, setting_of(row), significant(float(row['ms_per_frame']), 3)] + errors)
    return markdown_table(['method', 'substeps', 'ms per frame'] +
                          [ERRORS[column][0] for column in columns], lines)
