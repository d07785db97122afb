#!/usr/bin/python3
"""Checks that every suite of tests was built and run.

usage: check_suites.py [--quick] [--without KEY]... [--fewer-cases N] --left-out FILE RESULTS

Reads suites.txt beside this script, the keys that CMake left out (FILE; cmake/left_out.cmake), and
the JUnit files in the folder RESULTS. Prints one line for everything that was not built or not run,
and exits with status 1 if there is any.

  --quick         suites that are marked `full` need not have run
  --without KEY   this part may be left out
  --fewer-cases N
                  sums of properties need only reach an N-th (test/fewer_cases.h)
"""
import argparse
import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIST = pathlib.Path(__file__).resolve().parent / 'suites.txt'
TEST_FILES = ('test/**/*_test.cpp', 'test/tools/*_test.py', 'test/**/*.test')


class Suite:
    """A line of suites.txt: files of tests, and when they must have run."""

    def __init__(self, line):
        self.kind, self.pattern, *conditions = line.split()
        if self.kind not in ('gtest', 'tool', 'rostest'):
            raise ValueError(f'{LIST.name}: there is no kind of suite {self.kind!r}')
        self.full = 'full' in conditions
        self.needs = {word[len('needs:'):] for word in conditions if word.startswith('needs:')}
        sums = (word.split('>=') for word in conditions if '>=' in word)
        self.sums = {name: int(least) for name, least in sums}

    def files(self, root):
        return sorted(root.glob(self.pattern))


def read_suites(path=LIST):
    lines = (line.strip() for line in path.read_text().splitlines())
    return [Suite(line) for line in lines if line and not line.startswith('#')]


def cases_in(path):
    """The test cases in a JUnit file; none if it is not there or cannot be read."""
    try:
        return list(ElementTree.parse(path).iter('testcase'))
    except (OSError, ElementTree.ParseError):
        return []


def is_skipped(case):
    return (case.find('skipped') is not None or case.get('result') == 'skipped' or
            case.get('status') == 'notrun')


def skip_reason(case):
    skipped = case.find('skipped')
    return '' if skipped is None else f"{skipped.get('message', '')} {skipped.text or ''}"


def recorded(case, name):
    """The value of a property that a test recorded: an element; in older versions an attribute."""
    for entry in case.iter('property'):
        if entry.get('name') == name:
            return int(entry.get('value'))
    return int(case.get(name, 0))


def results_of(kind, file, root, results):
    """The test cases of a test file, from the JUnit file to which its kind writes them."""
    relative = file.relative_to(root)
    if kind == 'gtest':
        program = 'cloth_sim_' + '_'.join(relative.parts[1:-1]) + '_test'
        return [case for path in results.glob(f'*-{program}.xml') for case in cases_in(path)
                if case.get('file', '').endswith('/' + str(relative))]
    if kind == 'tool':
        return cases_in(results / f'tool-{file.stem}.xml')
    [name] = re.findall(r'test-name="(\w+)"', file.read_text())
    return cases_in(results / f'rosunit-{name}.xml')


def problems_of(suite, files, root, results, without, fewer_cases):
    if not files:
        yield f'{suite.pattern}: there is no such file'
    sums = dict.fromkeys(suite.sums, 0)
    for file in files:
        cases = results_of(suite.kind, file, root, results)
        if all(is_skipped(case) for case in cases):
            yield f'{file.relative_to(root)}: none of its tests ran'
        for case in cases:
            missing = re.search(r'not installed: (\w+)', skip_reason(case))
            if missing and missing.group(1) not in without:
                yield f"{file.relative_to(root)}: {case.get('name')}: {missing.group(0)}"
            for name in sums:
                sums[name] += recorded(case, name)
    for name, least in suite.sums.items():
        least //= fewer_cases
        if sums[name] < least:
            yield f'{suite.pattern}: {sums[name]} {name}; there should be {least} at least'


def check(suites, root, results, left_out, quick=False, without=(), fewer_cases=1):
    """Yields a line for everything that was not built or not run."""
    for line in left_out.splitlines():
        key, _, text = line.partition(': ')
        if key not in without:
            yield f'not built: {text}'

    listed, exempt = set(), set()
    for suite in suites:
        listed.update(suite.files(root))
        if suite.needs & set(without):
            exempt.update(suite.files(root))
    for suite in suites:
        if suite.needs & set(without) or (suite.full and quick):
            continue
        files = [file for file in suite.files(root) if file not in exempt]
        for problem in problems_of(suite, files, root, results, without, fewer_cases):
            yield f'not run: {problem}'

    for pattern in TEST_FILES:
        for file in sorted(root.glob(pattern)):
            # A program that a .test file starts is covered by that file.
            is_started = file.with_name(file.name.replace('_test.cpp', '.test')).exists()
            if file not in listed and not is_started:
                yield f'not run: {file.relative_to(root)}: {LIST.name} has no suite for it'


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('--quick', action='store_true')
    parser.add_argument('--without', action='append', default=[])
    parser.add_argument('--fewer-cases', type=int, default=1)
    parser.add_argument('--left-out', type=pathlib.Path, required=True)
    parser.add_argument('results', type=pathlib.Path)
    args = parser.parse_args()
    left_out = (args.left_out.read_text() if args.left_out.exists() else
                f'cmake: {args.left_out} is not there; is the workspace configured?')
    problems = list(check(read_suites(), ROOT, args.results, left_out, args.quick, args.without,
                          args.fewer_cases))
    for problem in dict.fromkeys(problems):
        print(f'  {problem}')
    sys.exit(1 if problems else 0)


if __name__ == '__main__':
    main()
