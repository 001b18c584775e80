#!/usr/bin/python3
"""A recorded wrench and recorded camera frames cross the ring unchanged."""
import glob
import os
import subprocess
import unittest

import rosbag
import rospy
import rostest
from geometry_msgs.msg import WrenchStamped
from sensor_msgs.msg import CompressedImage, JointState

from ring_testing import Ring, wait_for
from topic_testing import Received, open_the_way, publisher_across

LIMBS = ('shoulder', 'elbow')


def sends_not_delivered(node):
    return {name: value for name, value in zip(node.counter_names, node.counter_values)
            if name.startswith('ended_') and name != 'ended_delivered'}


class RecordedTopics(unittest.TestCase):
    """Where this machine does not run a program for a while, more comes at once than the bridge has room for: such a
    loss is counted, and there is no other."""

    def setUp(self):
        self.data = rospy.get_param('~data')
        self.rings = [Ring('/body/ring_status'), Ring('/head/ring_status')]
        self.ring = self.rings[0]
        self.ring.wait_until_up()

    def dropped(self, *topics):
        return sum(value for ring in self.rings for name, value in ring.counters().items()
                   if any(name.startswith('topic_%s_dropped_' % topic) for topic in topics))

    def check_all_came(self, sent, received, topics):
        """All that was sent, byte for byte and in order, but for what the bridges have counted as dropped."""
        def missing():
            return '%d of %d messages; counters %s' % (len(sent) - len(received()), len(sent),
                                                       [ring.counters() for ring in self.rings])
        wait_for(lambda: len(received()) + self.dropped(*topics) >= len(sent), missing, 120)
        came = received()
        self.assertEqual(len(came) + self.dropped(*topics), len(sent))
        rest = iter(sent)
        self.assertTrue(came and all(message in rest for message in came), 'changed, or not in order')

    def test_a_bag_played_onto_the_ring_comes_out_as_it_was_recorded(self):
        bag = os.path.join(self.data, 'jsk_force_torque', 'wrench_sensing_drill_vibration.bag')
        with rosbag.Bag(bag) as recording:
            messages = list(recording.read_messages(raw=True))
        topics = {topic for topic, _, _ in messages}
        self.assertEqual(len(topics), 1)
        recorded = [message[1] for _, message, _ in messages]

        warm_up = WrenchStamped()
        warm_up.header.frame_id = 'warm-up'
        received = Received('/head/wrench_there')
        opener = publisher_across('/body/wrench', WrenchStamped)
        open_the_way(opener, warm_up, received)

        # It stays until all have arrived: as it ends, it throws away what it has not yet handed to the kernel.
        player = subprocess.Popen(['rosbag', 'play', '--quiet', '--wait-for-subscribers', '--keep-alive',
                                   '--queue=%d' % len(recorded), bag, '%s:=/body/wrench' % topics.pop()],
                                  stdout=subprocess.DEVNULL)
        try:
            self.check_all_came(recorded, lambda: [m._buff for m in received.all() if b'warm-up' not in m._buff],
                                ('wrench', 'wrench_there'))
        finally:
            player.terminate()
            player.wait(30)

    def test_camera_frames_cross_byte_exact_while_joint_data_is_complete_and_in_order(self):
        paths = sorted(glob.glob(os.path.join(self.data, 'realsense_frames', 'frames', '*.jpg')))
        self.assertGreaterEqual(len(paths), 40)
        received = Received('/body/frames_here')
        camera = publisher_across('/head/frames', CompressedImage)
        open_the_way(camera, CompressedImage(format='warm-up'), received)
        states = {limb: [] for limb in LIMBS}
        subscribers = [rospy.Subscriber('/body/states/' + limb, JointState, states[limb].append)
                       for limb in LIMBS]
        wait_for(lambda: all(states.values()), 'joint states of every limb')
        before = {limb: self.ring.node(limb) for limb in LIMBS}
        not_delivered = {limb: sends_not_delivered(before[limb]) for limb in LIMBS}

        sent = []
        for number, path in enumerate(paths):
            frame = CompressedImage(format='jpeg')
            frame.header.seq = number
            with open(path, 'rb') as file:
                frame.data = file.read()
            sent.append(frame.data)
            camera.publish(frame)
            rospy.rostime.wallsleep(0.1)  # the camera's rate

        def frames():
            images = [CompressedImage().deserialize(m._buff) for m in received.all()]
            return [image.data for image in images if image.format == 'jpeg']
        self.check_all_came(sent, frames, ('frames', 'frames_here'))
        for limb in LIMBS:
            after = self.ring.wait_for_node(
                limb, lambda n: n.states_received > before[limb].states_received + 100, 'states')
            # A limb that the machine does not run leaves samples out, which is not the ring's doing.
            self.assertEqual(sends_not_delivered(after), not_delivered[limb], limb)
            stamps = [state.header.stamp for state in states[limb]]
            self.assertTrue(all(a < b for a, b in zip(stamps, stamps[1:])), limb)
        for subscriber in subscribers:
            subscriber.unregister()


if __name__ == '__main__':
    rospy.init_node('recorded_topics_test')
    rostest.rosrun('limb_ring', 'recorded_topics', RecordedTopics)
