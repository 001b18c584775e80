"""Topics across the ring: raw messages received, and publishers the near bridge listens to."""
import io
import threading

import rospy

from ring_testing import wait_for


class Received:
    """All messages of a topic, whatever their type, as they came: `_buff` holds the bytes."""

    def __init__(self, topic):
        self._lock = threading.Lock()
        self._messages = []
        self._topic = topic
        self._subscriber = rospy.Subscriber(topic, rospy.AnyMsg, self._take, tcp_nodelay=True)

    def _take(self, message):
        with self._lock:
            self._messages.append(message)

    def all(self):
        with self._lock:
            return list(self._messages)

    def unregister(self):
        self._subscriber.unregister()

    def bytes(self):
        return [message._buff for message in self.all()]

    def wait_for(self, number, guard=60):
        wait_for(lambda: len(self.all()) >= number,
                 '%d messages on %s' % (number, self._topic), guard)
        return self.all()


def publisher_across(topic, message_type, latch=False):
    """A publisher that the bridge has subscribed to."""
    publisher = rospy.Publisher(topic, message_type, queue_size=1000, latch=latch)
    wait_for(publisher.get_num_connections, 'a bridge to subscribe to ' + topic)
    return publisher


def open_the_way(publisher, message, received):
    """Sends `message` until it comes out: the far topic is advertised with the first message, and
    until a subscriber has found it, it gets none. Returns once nothing more is under way."""
    def is_through():
        publisher.publish(message)
        return received.all()
    wait_for(is_through, 'the way across')


def serialized(message):
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()
