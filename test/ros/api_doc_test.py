#!/usr/bin/python3
"""docs/ros_api.md names exactly the topics, services, actions and parameters of a running node.

test/ros/unit/parameter_defaults_test.cpp compares the defaults.
"""
import ast
import os
import re
import subprocess
import time
import unittest

import rosgraph
import rospy
import rosservice
import rostest

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))

NODE = '/cloth'
# Names of roscpp, dynamic_reconfigure and interactive_markers.
COMMON_SERVICES = {'get_loggers', 'set_logger_level', 'set_parameters'}
COMMON_TOPICS = {'parameter_descriptions', 'parameter_updates',
                 'handles/update', 'handles/update_full'}  # the last two: docs/rviz.md
ACTION = re.compile(r'(?!handles/)((?:clamps/\w+/)?\w+)/(goal|cancel|status|feedback|result)$')
# The type of the grippers is that of control_msgs, where this package is.
GRIPPER = {'control_msgs/GripperCommandAction': 'cloth_sim/GripperCommandAction'}


def read(*path):
    with open(os.path.join(ROOT, *path)) as file:
        return file.read()


def documented(section):
    """The private names in the first column of the tables of a section, with the second column."""
    text = read('docs', 'ros_api.md').split('\n## ' + section + '\n')[1].split('\n## ')[0]
    rows = (line.split('|')[1:3] for line in text.splitlines() if line.startswith('| `~'))
    return {name: cell.strip() for names, cell in rows for name in re.findall(r'`~([^`]+)`', names)}


def without_names(names):
    """The topics with <name> for the names of clamps and obstacles."""
    return {re.sub('^(clamps|obstacles)/[^/]+/', r'\1/<name>/', name) for name in names}


class ApiDocTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.wait_for_service(NODE + '/get_state', 30.0)
        cls.master = rosgraph.Master('/api_doc_test')

    def topics(self, side):
        """Private topics that the node publishes (0) or subscribes to (1), without the common ones
        and those of actions and handles."""
        names = (topic for topic, nodes in self.master.getSystemState()[side] if NODE in nodes)
        private = {name[len(NODE) + 1:] for name in names if name.startswith(NODE + '/')}
        return {name for name in private - COMMON_TOPICS if not ACTION.match(name)}

    def check_topics(self, section, side):
        table = documented(section)
        end = time.monotonic() + 20.0  # the node registers its topics one by one
        while without_names(self.topics(side)) != set(table) and time.monotonic() < end:
            time.sleep(0.1)
        self.assertEqual(set(table), without_names(self.topics(side)))
        types = dict(self.master.getTopicTypes())
        for name, cell in table.items():
            name_of = 'sphere' if name.startswith('obstacles/') else 'left'
            topic = NODE + '/' + name.replace('<name>', name_of)
            self.assertEqual(cell, '`%s`' % types[topic], name)

    def test_published_topics(self):
        self.check_topics('Published topics', 0)

    def test_subscribed_topics(self):
        self.check_topics('Subscribed topics', 1)

    def test_services_and_actions(self):
        services = {name[len(NODE) + 1:] for name, nodes in self.master.getSystemState()[2]
                    if NODE in nodes and name.startswith(NODE + '/')}
        types = {name: rosservice.get_service_type(NODE + '/' + name)
                 for name in services - COMMON_SERVICES}
        goals = (ACTION.match(topic[len(NODE) + 1:]) for topic, _ in self.master.getTopicTypes()
                 if topic.startswith(NODE + '/'))
        for action in {goal.group(1) for goal in goals if goal and goal.group(2) == 'goal'}:
            kind = dict(self.master.getTopicTypes())['%s/%s/goal' % (NODE, action)]
            kind = re.sub('Goal$', '', kind)
            types[re.sub('^clamps/(left|right)/', 'clamps/<name>/', action)] = GRIPPER.get(kind, kind)
        self.assertEqual(documented('Services'),
                         {name: '`%s`' % kind for name, kind in types.items()})

    def test_parameters(self):
        """The node lists its parameters when it warns about one that resembles none of them."""
        rospy.set_param('/known/scene', os.path.join(HERE, 'bench.yaml'))
        rospy.set_param('/known/qqqqqqqqqq', 1)
        path = subprocess.check_output(['catkin_find', '--first-only', '--libexec', 'cloth_sim',
                                        'cloth_node'], text=True).strip()
        process = subprocess.Popen([path, '__name:=known'], stderr=subprocess.PIPE, text=True)
        try:
            rospy.wait_for_service('/known/get_state', 30.0)
        finally:
            process.terminate()
            _, errors = process.communicate(timeout=30)
        [names] = re.findall('qqqqqqqqqq has no effect; known are: (.*?)(?:\033.*)?$', errors, re.M)
        self.assertEqual(set(documented('Parameters')) | set(documented('Dynamic parameters')),
                         set(names.split(', ')))

    def test_dynamic_parameters(self):
        tree = ast.parse(read('cfg', 'Cloth.cfg'))
        added = [call.args for call in ast.walk(tree)
                 if isinstance(call, ast.Call) and getattr(call.func, 'attr', '') == 'add']
        table = documented('Dynamic parameters')
        self.assertEqual(list(table), [ast.literal_eval(arguments[0]) for arguments in added])
        for arguments in added:
            if arguments[1].id == 'double_t':
                low, high = (ast.literal_eval(bound) for bound in arguments[5:7])
                self.assertEqual(table[ast.literal_eval(arguments[0])],
                                 'number, %g ... %g' % (low, high))


if __name__ == '__main__':
    rospy.init_node('api_doc_test')
    rostest.rosrun('cloth_sim', 'api_doc', ApiDocTest)
