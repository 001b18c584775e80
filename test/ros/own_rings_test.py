#!/usr/bin/python3
"""The small rings that come with the package come up under ring.launch."""
import unittest

import rospy
import rostest
from std_msgs.msg import String

from ring_testing import Ring
from topic_testing import Received, open_the_way, publisher_across, serialized


class OwnRings(unittest.TestCase):
    def test_a_ring_without_cpus_comes_up_and_is_seen(self):
        status = Ring('/plain/ring_status').wait_until_up()
        self.assertEqual([node.name for node in status.nodes], ['node0', 'node1', 'node2', 'node3'])
        self.assertEqual({node.cpu_state for node in status.nodes}, {'none'})

    def test_with_two_nodes_for_a_bridge_the_first_has_it(self):
        status = Ring('/one_bridge/ring_status').wait_until_up(cpus=False)
        cpus = {node.name: node.cpu_state for node in status.nodes}
        self.assertEqual(cpus, {'body': 'running', 'neck': 'none', 'head': 'absent', 'spine': 'none'})

    def test_two_bridges_carry_a_topic_across(self):
        Ring('/body/ring_status').wait_until_up()
        received = Received('/head/head/wrench')
        open_the_way(publisher_across('/body/wrench', String), String('hello'), received)
        self.assertEqual(set(received.bytes()), {serialized(String('hello'))})


if __name__ == '__main__':
    rospy.init_node('own_rings_test')
    rostest.rosrun('limb_ring', 'own_rings', OwnRings)
