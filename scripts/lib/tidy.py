#!/usr/bin/python3
"""Runs clang-tidy on source files of the package, several at a time; see scripts/lint.sh.

usage: tidy.py [--jobs N] [--minutes N] WORKSPACE [FILE or FOLDER]...

Prints every warning once, even if several sources include the header that it is about. The exit
status is 1 if there was one.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]


def compiled_units(workspace):
    """What the workspace compiles, as a dictionary from file to the sources in it, whose paths are
    relative to the repository. A file of a unity build holds several sources."""
    package = f'{workspace}/src/cloth_sim/'
    units = {}
    with open(workspace / 'build' / 'compile_commands.json') as file:
        paths = sorted({entry['file'] for entry in json.load(file)})
    for path in paths:
        if path.startswith(package):
            units[path] = [path[len(package):]]
        elif '/Unity/' in path:
            included = re.findall(r'#include "(.*)"', pathlib.Path(path).read_text())
            units[path] = [source[len(package):] for source in included]
    return units


def source_of(header, sources):
    """The source with which a header is checked, or None."""
    header = pathlib.PurePath(header)
    folder = header.parent.name
    for source in map(pathlib.PurePath, sources):
        if (source.stem, source.parent.name) == (header.stem, folder):
            return str(source)
    included = re.compile(rf'#include "(.*/)?{re.escape(header.name)}"')
    return next((source for source in sources
                 if included.search((ROOT / source).read_text())), None)


def chosen_sources(arguments, sources):
    if not arguments:
        return set(sources)
    chosen = set()
    for argument in arguments:
        path = os.path.relpath(argument, ROOT) if os.path.exists(argument) else argument
        if path.endswith('.h'):
            chosen.add(source_of(path, sources))
        else:
            chosen.update(source for source in sources
                          if source == path or source.startswith(path.rstrip('/') + '/'))
    chosen.discard(None)
    return chosen


def tidy(unit, workspace, end):
    """The warnings of clang-tidy about a unit and its headers; None if there was no time left."""
    if time.monotonic() > end:
        return None
    # A unity build includes sources.
    run = subprocess.run(['clang-tidy', '--quiet', '--checks=-bugprone-suspicious-include',
                          '-p', workspace / 'build', unit],
                         capture_output=True, text=True, cwd=ROOT)
    if run.returncode != 0 and not run.stdout.strip():
        return [f'{unit}: clang-tidy failed: {run.stderr.strip()}']
    # Each warning with the lines of code and notes that follow it.
    return [part.replace(f'{workspace}/src/cloth_sim/', '').rstrip() for part in
            re.split(r'\n(?=\S+:\d+:\d+: (?:warning|error): )', run.stdout) if part.strip()]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('--jobs', type=int, default=1)
    parser.add_argument('--minutes', type=float, default=float('inf'))
    parser.add_argument('workspace', type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument('files', nargs='*')
    args = parser.parse_args()

    units = compiled_units(args.workspace)
    chosen = chosen_sources(args.files, sorted(sum(units.values(), [])))
    units = {unit: sources for unit, sources in units.items() if chosen.intersection(sources)}
    end = time.monotonic() + 60.0 * args.minutes
    warnings, unchecked = set(), []
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        results = pool.map(lambda unit: tidy(unit, args.workspace, end), units)
        for sources, found in zip(units.values(), results):
            if found is None:
                unchecked += sources
                continue
            for warning in found:
                if warning not in warnings:
                    warnings.add(warning)
                    print(warning, flush=True)
    if unchecked:
        print(f'== lint: no time left for {len(unchecked)} files:', *unchecked)
    checked = sum(map(len, units.values())) - len(unchecked)
    print(f'== lint: {checked} source files, {len(warnings)} warnings')
    sys.exit(1 if warnings else 0)


if __name__ == '__main__':
    main()
