#!/usr/bin/python3
"""Topics of any type cross the ring from one bridge to another, byte for byte."""
import itertools
import random
import time
import unittest

import rosgraph
import rospy
import rostest
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import JointState
from std_msgs.msg import Int32, String

from ring_testing import Newest, Ring, kill_process, wait_for
from topic_testing import Received, open_the_way, publisher_across, serialized

NOBODY = 'http://127.0.0.1:1/'   # where no node answers


class LongerString(String):
    """std_msgs/String after its definition has changed."""
    _md5sum = 'c0ffee' + String._md5sum[6:]
    _full_text = String._full_text + '\nstring more\n'


class Topics(unittest.TestCase):
    def setUp(self):
        self.ring = Ring('/body/ring_status')
        self.ring.wait_until_up()

    def lines_of_the_bridge(self):
        """What it logs from now on: it is heard once it has complained of a joint that nobody has."""
        said, number = [], itertools.count()
        subscriber = rospy.Subscriber('/rosout', Log, lambda line: said.append(line.msg))
        self.addCleanup(subscriber.unregister)
        commands = publisher_across('/body/joint_commands', JointState)
        self.addCleanup(commands.unregister)

        def is_heard():
            commands.publish(JointState(name=['nobodys_joint_%d' % next(number)], position=[0.0]))
            return any('nobodys_joint' in line for line in said)
        wait_for(is_heard, 'the log of the bridge')
        return said

    def test_a_message_arrives_with_its_type_and_definition(self):
        received = Received('/head/text_there')
        text = publisher_across('/body/text', String)
        open_the_way(text, String('across'), received)
        first = received.all()[0]
        self.assertEqual(first._connection_header['type'], String._type)
        self.assertEqual(first._connection_header['md5sum'], String._md5sum)
        self.assertEqual(first._connection_header['message_definition'].strip(),
                         String._full_text.strip())
        self.assertEqual(first._buff, serialized(String('across')))

    def test_messages_of_all_sizes_arrive_byte_for_byte_in_order(self):
        received = Received('/body/frames_here')
        frames = publisher_across('/head/frames', String)
        open_the_way(frames, String('first'), received)
        noise = random.Random(1)
        sizes = [0, 1, 491, 492, 493, 70000, 1 << 20] + [noise.randrange(3000) for _ in range(40)]
        sent = [String(''.join(noise.choices('0123456789abcdef', k=size))) for size in sizes]
        for message in sent:
            frames.publish(message)
        first = serialized(String('first'))
        wait_for(lambda: len([m for m in received.bytes() if m != first]) == len(sent),
                 'all messages')
        self.assertEqual([m for m in received.bytes() if m != first],
                         [serialized(m) for m in sent])

    def test_a_topic_is_carried_on_after_its_type_has_changed(self):
        for message in [String('text'), Int32(5), String('text again'), LongerString('defined anew')]:
            received = Received('/head/wrench_there')
            there = publisher_across('/body/wrench', type(message))
            def is_through():
                there.publish(message)
                return [m for m in received.all() if m._connection_header['md5sum'] == message._md5sum]
            self.assertEqual(wait_for(is_through, message._type + ' across')[0]._buff, serialized(message))
            there.unregister()
            received.unregister()

    def test_a_subscriber_that_is_busy_while_the_type_changes_hears_the_new_type(self):
        heard = []

        def slowly(message):
            heard.append(message._connection_header['md5sum'])
            time.sleep(0.5)   # meanwhile rospy does not notice the end of its connection
        subscriber = rospy.Subscriber('/head/wrench_there', rospy.AnyMsg, slowly)
        self.addCleanup(subscriber.unregister)
        for message in String('text'), Int32(5), String('text again'):
            there = publisher_across('/body/wrench', type(message))

            def is_through():
                there.publish(message)
                return heard and heard[-1] == message._md5sum
            wait_for(is_through, message._type + ' across')
            there.unregister()

    def test_a_publisher_that_died_without_a_word_is_warned_of(self):
        said = self.lines_of_the_bridge()
        dead = rosgraph.Master('/dead_node')
        dead.registerPublisher('/body/wrench', String._type, NOBODY)
        self.addCleanup(dead.unregisterPublisher, '/body/wrench', NOBODY)
        there = publisher_across('/body/wrench', String)
        self.addCleanup(there.unregister)
        warning = wait_for(lambda: [line for line in said if "'wrench': 1 of its 2 publishers" in line], 'the warning')
        self.assertIn('rosnode cleanup', warning[0])

    def test_a_latched_message_stays_for_late_subscribers_and_a_new_far_bridge(self):
        latched = publisher_across('/body/map', String, latch=True)
        latched.publish('keep me')
        text = Newest('/head/map_there', String)
        text.wait(lambda m: m.data == 'keep me', 'the latched text')
        text.unregister()
        late = Newest('/head/map_there', String)
        late.wait(lambda m: m.data == 'keep me', 'the latched text, late')
        late.unregister()

        boots = self.ring.node('head').cpu_boots
        kill_process(self.ring.node('head').cpu_pid)
        self.ring.wait_for_node('head', lambda n: n.cpu_boots > boots, 'a new bridge')
        after = Newest('/head/map_there', String)
        after.wait(lambda m: m.data == 'keep me', 'the latched text after the restart')


if __name__ == '__main__':
    rospy.init_node('topics_test')
    rostest.rosrun('limb_ring', 'topics', Topics)
