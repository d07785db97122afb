#!/usr/bin/python3
"""Adds up the JUnit files of a test run.

usage: junit_total.py FOLDER

Prints every failed test case, then three numbers for the caller: passed failed skipped.

A rostest writes two files: rosunit-NAME.xml with the test cases of the program that it started, and
rostest-*.xml with one case for the program as a whole. The second counts only if it failed (the
program crashed, or ran out of time), so that no case is counted twice.
"""
import pathlib
import sys
import xml.etree.ElementTree as ElementTree


def outcome(case):
    tags = {child.tag for child in case}
    if tags & {'failure', 'error'}:
        return 'failed'
    if 'skipped' in tags or case.get('status') == 'notrun' or case.get('result') == 'skipped':
        return 'skipped'
    return 'passed'


def main():
    counts = {'passed': 0, 'failed': 0, 'skipped': 0}
    for path in sorted(pathlib.Path(sys.argv[1]).rglob('*.xml')):
        try:
            cases = list(ElementTree.parse(path).iter('testcase'))
        except ElementTree.ParseError as error:
            print(f'  FAILED {path.name}: not readable ({error})')
            counts['failed'] += 1
            continue
        for case in cases:
            result = outcome(case)
            if path.name.startswith('rostest-') and result != 'failed':
                continue
            counts[result] += 1
            if result == 'failed':
                name = f"{case.get('classname', '')}.{case.get('name', '')}"
                print(f'  FAILED {name} ({path.name})')
    print(counts['passed'], counts['failed'], counts['skipped'])


if __name__ == '__main__':
    main()
