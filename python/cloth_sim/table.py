"""Tables of episodes: one row an episode as CSV and JSON, mean and spread of a task as Markdown."""
import csv
import io
import json

import numpy as np

FIELDS = {'task': str, 'seed': int, 'coverage': float, 'edge_error_m': float,
          'peak_force_n': float, 'sim_time_s': float, 'score': float,
          'success': lambda text: text == 'True', 'failure': str, 'state_hash': str,
          'wall_time_s': float}
# Figure: heading, factor to the unit of the heading, digits.
COLUMNS = {'score': ('score [-]', 1, 3), 'coverage': ('coverage [-]', 1, 3),
           'edge_error_m': ('edge error [mm]', 1000, 1), 'peak_force_n': ('peak force [N]', 1, 2),
           'sim_time_s': ('time [s]', 1, 1)}


def as_csv(rows):
    text = io.StringIO()
    writer = csv.DictWriter(text, list(FIELDS), lineterminator='\n')
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def read_csv(text):
    """The rows that as_csv has written."""
    return [{name: kind(row[name]) for name, kind in FIELDS.items()}
            for row in csv.DictReader(io.StringIO(text))]


def of_task(rows):
    """{task: its rows}, in the order of the rows."""
    found = {}
    for row in rows:
        found.setdefault(row['task'], []).append(row)
    return found


def figures(rows, name):
    return np.array([row[name] for row in rows], dtype=float)


def as_json(rows, policy):
    summary = {task: {'episodes': len(some), 'successes': sum(row['success'] for row in some),
                      **{name: {'mean': float(figures(some, name).mean()),
                                'sd': float(figures(some, name).std())} for name in COLUMNS}}
               for task, some in of_task(rows).items()}
    return json.dumps({'policy': policy, 'tasks': summary, 'episodes': rows}, indent=2) + '\n'


def as_markdown(rows):
    """A row for each task: mean +- standard deviation over its episodes."""
    lines = ['| task | successes | ' + ' | '.join(column[0] for column in COLUMNS.values()) + ' |',
             '|---' * (2 + len(COLUMNS)) + '|']
    for task, some in of_task(rows).items():
        cells = ['`%s`' % task, '%d of %d' % (sum(row['success'] for row in some), len(some))]
        for name, (_, factor, digits) in COLUMNS.items():
            values = factor * figures(some, name)
            cells.append('%.*f ± %.*f' % (digits, values.mean(), digits, values.std()))
        lines.append('| ' + ' | '.join(cells) + ' |')
    return '\n'.join(lines) + '\n'
