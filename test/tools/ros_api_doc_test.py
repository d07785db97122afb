#!/usr/bin/python3
"""docs/ros_api.md names exactly the topics, services, parameters and defaults of the code."""
import ast
import os
import re
import unittest

import rosunit

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir)


def read(*path):
    with open(os.path.join(ROOT, *path)) as file:
        return file.read()


def documented(section):
    """Private names in the first column of the tables of a section."""
    text = read('docs', 'ros_api.md').split('\n## ' + section)[1].split('\n## ')[0]
    return {name: row for name, row in re.findall(r'^\| `~([^`]+)` (.*)$', text, re.M)}


class RosApiDocTest(unittest.TestCase):
    def test_parameters(self):
        code = set(re.findall(r'reader\.(?:read|allow)\("(\w+)"', read('src', 'ros', 'parameters.cpp')))
        self.assertEqual(set(documented('Parameters\n')), code)

    def test_defaults(self):
        header = read('src', 'ros', 'parameters.h')
        fields = dict(re.findall(r'^  [\w:]+ (\w+) = ([^;]+);', header, re.M))
        for name, row in documented('Parameters\n').items():
            field = re.sub(r'_(\w)', lambda match: match.group(1).upper(), name)
            if field in fields:
                self.assertIn('`%s`' % fields[field].strip('"'), row, name)

    def test_dynamic_parameters(self):
        section = read('docs', 'ros_api.md').split('\n## Dynamic parameters')[1]
        rows = [row for row in section.split('\n## ')[0].splitlines() if row.startswith('| `~')]
        tree = ast.parse(read('cfg', 'Cloth.cfg'))
        added = [call.args for call in ast.walk(tree)
                 if isinstance(call, ast.Call) and getattr(call.func, 'attr', '') == 'add']
        names = [re.findall(r'`~(\w+)`', row.split('|')[1]) for row in rows]
        self.assertEqual(sum(names, []), [ast.literal_eval(arguments[0]) for arguments in added])
        for arguments in added:
            row = next(row for row in rows if '`~%s`' % ast.literal_eval(arguments[0]) in row)
            if arguments[1].id == 'double_t':
                low, high = (ast.literal_eval(bound) for bound in arguments[5:7])
                self.assertIn('number, %g ... %g |' % (low, high), row)

    def test_topics_out(self):
        code = read('src', 'ros', 'publishers.cpp')
        names = set(re.findall(r'own\.advertise<[\w:]+>\("(\w+)"', code))
        self.assertIn('base + "/wrench"', read('src', 'ros', 'clamp_ports.cpp'))
        self.assertEqual(set(documented('Published topics')),
                         names | {'clamps/<name>/wrench'})

    def test_topics_in(self):
        code = read('src', 'ros', 'inputs.cpp')
        names = set(re.findall(r'subscribe\("(\w+)"', code))
        clamps = set(re.findall(r'\bbase \+ "/(\w+)"', read('src', 'ros', 'clamp_ports.cpp')))
        clamps.remove('wrench')
        self.assertEqual(set(documented('Subscribed topics')),
                         names | {'clamps/<name>/' + name for name in clamps} |
                         {'handles/feedback'})
        self.assertIn('resolveName("handles")', read('src', 'ros', 'handles.cpp'))

    def test_actions(self):
        code = set(re.findall(r'privateNode, "(run_\w+)"', read('src', 'ros', 'actions.cpp')))
        text = read('docs', 'ros_api.md').split('| action | type | effect |')[1].split('\n\n')[0]
        self.assertEqual(set(re.findall(r'^\| `~(\w+)`', text, re.M)), code)
        self.assertEqual(len(code), 2)

    def test_services(self):
        code = re.findall(r'advertise<(\w+)>\(privateNode, "(\w+)"', read('src', 'ros', 'services.cpp'))
        rows = {name: row for name, row in documented('Services').items() if 'Action`' not in row}
        self.assertEqual(set(rows), {name for _, name in code})
        for kind, name in code:
            self.assertIn('`cloth_sim/%s`' % kind, rows[name])


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'ros_api_doc_test', RosApiDocTest)
