#!/usr/bin/python3
"""Prints the results of a run in a few plain lines.

usage: print_summary.py SUMMARY.json     (as written by cloth_run --summary)
"""
import json
import sys


def relative_error(now, initial):
    return abs(now - initial) / initial if initial else float('nan')


def number(value, form):
    return 'not finite' if value is None else format(value, form)


def main():
    with open(sys.argv[1]) as file:
        run = json.load(file)
    broken, springs = run['broken'], run['springs']
    kinds = ', '.join(f'{kind} {count}' for kind, count in broken.items()
                      if kind not in ('total', 'torn', 'cut'))
    mass_error = relative_error(run['mass_kg'], run['initial_mass_kg'])
    area_error = relative_error(run['rest_area_m2'], run['initial_rest_area_m2'])
    lines = [
        ('scene', f"{run['scene']}, method {run['solver']}"),
        ('cloth', f"{run['particles']} particles, {run['faces']} faces, "
                  f"{springs['active']} springs"),
        ('pieces', f"{run['pieces']}"),
        ('broken springs', f"{broken['total']} ({kinds}; torn {broken['torn']}, "
                           f"cut {broken['cut']})"),
        ('mass', f"{run['mass_kg']:.6g} kg, relative error {mass_error:.1e}"),
        ('rest area', f"{run['rest_area_m2']:.6g} m^2, relative error {area_error:.1e}"),
        ('max strain', number(run['max_strain'], '.3f')),
        ('time', f"{number(run['sim_time_s'], '.2f')} s simulated in "
                 f"{number(run['wall_time_s'], '.2f')} s: "
                 f"{number(run['real_time_factor'], '.2f')} times real time"),
        ('finite', 'yes' if run['finite'] else 'NO'),
        ('state hash', run['state_hash']),
    ]
    for phase in run['phases']:
        end = phase.get('end_s')
        span = f"{phase['start_s']:.2f} s to " + ('its abort' if end is None else f'{end:.2f} s')
        lines.append((f"phase {phase['name']}", span))
    print()
    for name, text in lines:
        print(f'  {name:<22} {text}')
    print()


if __name__ == '__main__':
    main()
