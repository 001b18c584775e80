#!/usr/bin/python3
"""Packets come as frames, chosen by the bridge's parameters, and only while somebody subscribes."""
import os
import subprocess
import tempfile
import unittest

import rosbag
import rospy
import rostest
from limb_ring.msg import Frame
from limb_ring.srv import SendInterrupt

from ring_testing import Newest, Ring, wait_for


class Frames(unittest.TestCase):
    def setUp(self):
        self.ring = Ring()
        self.ring.wait_until_up()

    def wait_until_watched(self, nodes):
        self.ring.status.wait(lambda _: self.ring.counter('frames_watched_nodes') == nodes,
                              '%d nodes to be watched' % nodes)

    def test_nothing_is_observed_unless_somebody_subscribes(self):
        self.wait_until_watched(0)
        frames = Newest('ring_frames', Frame)
        self.wait_until_watched(1)
        frames.wait_for_more(5, 'frames')
        frames.unregister()
        self.wait_until_watched(0)

    def test_a_frame_has_the_fields_of_its_packet_and_what_was_left_out(self):
        frames = Newest('ring_frames', Frame)
        state = frames.wait(lambda f: f.kind == Frame.DATA and f.channel == 2, 'joint data')
        self.assertEqual((state.node, state.line_to, state.direction), ('body', 'body', Frame.IN))
        self.assertEqual(state.line_from, 'right_ankle')
        self.assertEqual((state.whole, state.crc_ok, state.embedded), (True, True, False))
        self.assertEqual(state.size, len(state.payload) + 12)
        self.assertGreater(len(state.payload), 0)
        self.assertGreater(state.header.stamp.to_sec(), 0)
        # The test's filter lets every fifth data packet and interrupt pass, no hellos and beacons.
        frames.wait(lambda f: f.sampled_out > 0 and f.filtered > 0, 'the counts of what was left out')
        self.assertNotEqual(frames.get().kind, Frame.CONTROL)
        frames.unregister()

    def test_an_interrupt_comes_with_its_factor(self):
        frames = Newest('ring_frames', Frame)
        frames.wait_for_more(1, 'frames')
        seen = []
        interrupts = rospy.Subscriber('ring_frames', Frame, lambda f: f.kind == Frame.INTERRUPT and seen.append(f))
        send = rospy.ServiceProxy('send_interrupt', SendInterrupt)

        def is_seen():
            self.assertTrue(send(node='head', factor=2, force=False).success)
            return seen
        wait_for(is_seen, 'an interrupt on its way home')
        self.assertEqual((seen[0].sid, seen[0].did, seen[0].factor, seen[0].size), (0, 2, 2, 12))
        self.assertTrue(seen[0].own)
        interrupts.unregister()
        frames.unregister()

    def test_rosbag_records_frames(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'frames.bag')
            subprocess.run(['rosbag', 'record', '--limit=20', '-O', path, rospy.resolve_name('ring_frames')],
                           check=True, timeout=120, stdout=subprocess.DEVNULL)
            with rosbag.Bag(path) as bag:
                recorded = [message for _, message, _ in bag.read_messages()]
        self.assertEqual(len(recorded), 20)
        self.assertTrue(all(message.node == 'body' and message.size for message in recorded))


if __name__ == '__main__':
    rospy.init_node('frames_test')
    rostest.rosrun('limb_ring', 'frames', Frames)
