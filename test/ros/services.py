"""What the rostests share that drive the node by its services."""
import unittest
from xmlrpc.client import ServerProxy

import rospy

from cloth_sim import srv

DEADLINE = 30.0  # for the node to come up [s]


def call(name, kind, *arguments):
    """Calls a service once; it must say that it succeeded."""
    rospy.wait_for_service('/cloth/' + name, DEADLINE)
    reply = rospy.ServiceProxy('/cloth/' + name, kind)(*arguments)
    assert reply.success, reply.message
    return reply


def connections(name='/cloth'):
    """Of a node, to whom it publishes ('o') and from whom it hears ('i'): direction, topic, who. A
    node may list one from whom it hears before that one has connected, or after it has ended."""
    node = ServerProxy(rospy.get_master().lookupNode(name)[2])
    return [(direction, topic, other)
            for _, other, direction, _, topic, *_ in node.getBusInfo(rospy.get_name())[2]]


def state():
    return call('get_state', srv.GetState).state


class ServiceTest(unittest.TestCase):
    """Keeps connections to the services of SERVICES, name: type."""

    SERVICES = {}
    DEADLINE = DEADLINE  # None: none, where time may stand still

    @classmethod
    def setUpClass(cls):
        cls.call = {}
        for name, kind in cls.SERVICES.items():
            rospy.wait_for_service('/cloth/' + name, cls.DEADLINE)
            cls.call[name] = rospy.ServiceProxy('/cloth/' + name, kind, persistent=True)

    def accepted(self, name, *arguments):
        reply = self.call[name](*arguments)
        self.assertTrue(reply.success, '%s: %s' % (name, reply.message))
        return reply

    def state(self):
        return self.call['get_state']().state
