"""What the Python rostests share: polling with a deadline instead of sleeping."""
import time

import rospy
from rosgraph_msgs.msg import Log

DEADLINE = 20.0  # [s], generous: a build machine may be busy


def wait_until(condition, what, deadline=DEADLINE):
    """The first true value of `condition()`; fails after `deadline` seconds of wall time."""
    end = time.monotonic() + deadline
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > end or rospy.is_shutdown():
            raise AssertionError('still waiting after %g s for: %s' % (deadline, what))
        time.sleep(0.01)


class Listener:
    """Collects the messages of a topic."""

    def __init__(self, topic, kind):
        self.topic = topic
        self.messages = []
        self.subscriber = rospy.Subscriber(topic, kind, self.messages.append, queue_size=100)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.subscriber.unregister()

    def wait(self, condition=lambda message: True):
        """The newest message that meets the condition."""
        def found():
            return next((m for m in reversed(list(self.messages)) if condition(m)), None)
        return wait_until(lambda: found() is not None, 'a message on ' + self.topic) and found()


def node_log():
    """A listener to what the node and this test log; connected to both."""
    log = Listener('/rosout', Log)
    wait_until(lambda: log.subscriber.get_num_connections() > 1, 'the log of the node')
    return log


def connected(topic, kind, **options):
    """A publisher that somebody listens to."""
    publisher = rospy.Publisher(topic, kind, queue_size=10, **options)
    wait_until(lambda: publisher.get_num_connections() > 0, 'a subscriber of ' + topic)
    return publisher
