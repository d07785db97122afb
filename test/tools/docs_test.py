#!/usr/bin/python3
"""The documentation hangs together: links and file names lead somewhere, every page can be reached
from the README, and lines are short. Needs no master."""
import os
import re
import unittest

import rosunit

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
LONGEST_LINE = 100  # [columns]; tables, links and code may be longer


def files():
    """Paths of all files of the package, relative to its root; hidden folders are left out."""
    result = []
    for folder, subfolders, names in os.walk(ROOT):
        subfolders[:] = [name for name in subfolders if not name.startswith('.')]
        result += [os.path.relpath(os.path.join(folder, name), ROOT) for name in names]
    return sorted(result)


def pages():
    return [path for path in files() if path.endswith('.md')]


def read(page):
    with open(os.path.join(ROOT, page), encoding='utf-8') as file:
        return file.read()


def without_code(text):
    """The text without fenced and indented code blocks; lines keep their numbers."""
    text = re.sub(r'^```.*?^```', lambda match: '\n' * match.group().count('\n'), text, flags=re.M | re.S)
    return re.sub(r'(?<=\n\n)(?: {4,}.*\n+)+', lambda match: '\n' * match.group().count('\n'), text)


def links(page):
    """Targets of the relative links of a page, as (path relative to the root, anchor)."""
    folder = os.path.dirname(page)
    for target in re.findall(r'\]\(([^)\s]+)\)', without_code(read(page))):
        if '://' not in target:
            path, _, anchor = target.partition('#')
            yield os.path.normpath(os.path.join(folder, path)) if path else page, anchor


def anchors(page):
    """Names of the headings of a page, as GitHub makes them."""
    headings = re.findall(r'^#+ (.*)$', without_code(read(page)), re.M)
    return {re.sub(r'[^\w\- ]', '', heading.lower()).replace(' ', '-') for heading in headings}


class DocsTest(unittest.TestCase):
    def test_links_lead_somewhere(self):
        for page in pages():
            for path, anchor in links(page):
                with self.subTest(page=page, link=path):
                    self.assertTrue(os.path.exists(os.path.join(ROOT, path)))
                    if anchor:
                        self.assertIn(anchor, anchors(path))

    def test_every_page_can_be_reached_from_the_readme(self):
        reached, waiting = set(), ['README.md']
        while waiting:
            page = waiting.pop()
            if page not in reached and page.endswith('.md'):
                reached.add(page)
                waiting += [path for path, _ in links(page)]
        self.assertEqual(sorted(set(pages()) - reached), [])

    def test_source_files_that_are_named_exist(self):
        """Names in backticks, such as `clamp/slip.cpp`, are the ends of paths."""
        ends = '\n' + '\n'.join('/' + path for path in files()) + '\n'
        for page in pages():
            for name in re.findall(r'`([\w./]+\.(?:h|cpp|py|sh|in))`', without_code(read(page))):
                with self.subTest(page=page, file=name):
                    self.assertTrue('/%s\n' % name in ends)

    def test_lines_are_short(self):
        for page in pages():
            for number, line in enumerate(without_code(read(page)).splitlines(), 1):
                if not line.startswith('|') and '](' not in line:
                    self.assertLessEqual(len(line), LONGEST_LINE, '%s:%d' % (page, number))


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'docs_test', DocsTest)
