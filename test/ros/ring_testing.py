"""What the rostests share: waiting for conditions, the newest message of a topic, the ring's status."""
import os
import signal
import threading
import time

import rospy

from limb_ring.msg import RingStatus
from limb_ring.processes import is_gone, process_state  # noqa: F401

GUARD = 60.0  # s; generous, since a ring shares few cores with other tests


def wait_for(condition, what, guard=GUARD):
    """The first true value of condition(); fails after `guard` seconds of the wall clock. `what`: words, or what makes
    them then."""
    deadline = time.monotonic() + guard
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > deadline:
            raise AssertionError('waited %g s in vain for %s' % (guard, what() if callable(what) else what))
        time.sleep(0.02)


def service(name, kind):
    """A proxy of the service, once somebody offers it."""
    rospy.wait_for_service(name, GUARD)
    return rospy.ServiceProxy(name, kind)


class Newest:
    """The newest message of a topic, and how many have come."""

    def __init__(self, topic, message_type):
        self._lock = threading.Lock()
        self._message, self._count = None, 0
        self._subscriber = rospy.Subscriber(topic, message_type, self._take, tcp_nodelay=True)

    def _take(self, message):
        with self._lock:
            self._message, self._count = message, self._count + 1

    def unregister(self):
        self._subscriber.unregister()

    def get(self):
        with self._lock:
            return self._message

    def count(self):
        with self._lock:
            return self._count

    def wait(self, condition, what):
        """The newest message, once condition(message) is true."""
        def poll():
            message = self.get()
            return message if message is not None and condition(message) else None
        return wait_for(poll, what)

    def wait_for_more(self, number, what):
        before = self.count()
        wait_for(lambda: self.count() >= before + number, what)


class Ring:
    """The ring as `ring_status` shows it."""

    def __init__(self, topic='ring_status'):
        self.status = Newest(topic, RingStatus)

    def wait_until_up(self, cpus=True):
        def is_up(status):
            return status.connected and status.nodes and all(
                node.state == 'up' and (not cpus or node.cpu_state in ('running', 'none'))
                for node in status.nodes) and not (cpus and status.silent_joints)
        return self.status.wait(is_up, 'all nodes up')

    def wait_until_events_heard(self):
        self.status.wait(lambda status: status.nodes and all(node.events_heard for node in status.nodes),
                         'the events of all nodes heard by the bridge')

    def node(self, name):
        return {node.name: node for node in self.status.get().nodes}[name]

    def wait_for_node(self, name, condition, what):
        wait_for(lambda: condition(self.node(name)), '%s: %s' % (name, what))
        return self.node(name)

    def counters(self):
        status = self.status.get()
        return dict(zip(status.counter_names, status.counter_values)) if status else {}

    def counter(self, name):
        return self.counters().get(name, 0)


def stop_process(pid):
    os.kill(pid, signal.SIGSTOP)


def kill_process(pid):
    os.kill(pid, signal.SIGKILL)


def is_alive(pid):
    return not is_gone(pid)
