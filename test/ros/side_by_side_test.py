#!/usr/bin/python3
"""Two rings on one host, of the same file, over different links, keep apart."""
import unittest

import rospy
import rostest
from std_msgs.msg import String

from ring_testing import Ring
from topic_testing import Received, open_the_way, publisher_across, serialized


class SideBySide(unittest.TestCase):
    def test_each_ring_has_its_own_nodes_and_its_own_messages(self):
        rings = {side: Ring('/%s/body/ring_status' % side) for side in ('left', 'right')}
        status = {side: ring.wait_until_up() for side, ring in rings.items()}
        self.assertNotEqual(status['left'].ring, status['right'].ring)
        pids = [node.pid for one in status.values() for node in one.nodes]
        self.assertEqual(len(set(pids)), 8)

        received = {side: Received('/%s/head/text_there' % side) for side in rings}
        for side in rings:
            text = publisher_across('/%s/body/text' % side, String)
            open_the_way(text, String(side), received[side])
        for side in rings:
            self.assertEqual(set(received[side].bytes()), {serialized(String(side))})


if __name__ == '__main__':
    rospy.init_node('side_by_side_test')
    rostest.rosrun('limb_ring', 'side_by_side', SideBySide)
