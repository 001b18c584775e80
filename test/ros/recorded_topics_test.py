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


class RecordedTopics(unittest.TestCase):
    def setUp(self):
        self.data = rospy.get_param('~data')
        self.ring = Ring('/body/ring_status')
        self.ring.wait_until_up()

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

        def arrived():
            return [m._buff for m in received.all() if b'warm-up' not in m._buff]
        subprocess.run(['rosbag', 'play', '--quiet', '--wait-for-subscribers', bag,
                        '%s:=/body/wrench' % topics.pop()], check=True, timeout=120,
                       stdout=subprocess.DEVNULL)
        wait_for(lambda: len(arrived()) >= len(recorded), 'all recorded wrenches')
        self.assertEqual(arrived(), recorded)

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
        wait_for(lambda: len(frames()) >= len(sent), 'all frames')
        self.assertEqual(frames(), sent)
        for limb in LIMBS:
            after = self.ring.wait_for_node(
                limb, lambda n: n.states_received > before[limb].states_received + 100, 'states')
            self.assertEqual(after.states_missing, before[limb].states_missing, limb)
            stamps = [state.header.stamp for state in states[limb]]
            self.assertTrue(all(a < b for a, b in zip(stamps, stamps[1:])), limb)
        for subscriber in subscribers:
            subscriber.unregister()


if __name__ == '__main__':
    rospy.init_node('recorded_topics_test')
    rostest.rosrun('limb_ring', 'recorded_topics', RecordedTopics)
