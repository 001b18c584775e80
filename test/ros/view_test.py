#!/usr/bin/python3
"""What RViz is given: markers of ring and limbs, and the robot's joints, also those that are silent."""
import socket
import unittest

import rospy
import rostest
from limb_ring.msg import RingStatus
from limb_ring.srv import ClearFaults, InjectFault
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from ring_testing import Newest, Ring, service, wait_for


class View(unittest.TestCase):
    def setUp(self):
        self.ring = Ring()
        self.markers = Newest('ring_markers', MarkerArray)
        self.ring.wait_until_up()
        wait_for(lambda: self.spaces() == {'', 'nodes', 'names', 'lines'}, 'a picture of a whole ring')

    def spaces(self):
        message = self.markers.get()
        return {marker.ns for marker in message.markers} if message else set()

    def fault(self, words):
        answer = service('inject_fault', InjectFault)(fault=words)
        self.assertTrue(answer.success, answer.message)

    def test_a_ball_a_name_and_an_arrow_for_every_node(self):
        message = self.markers.get()
        for space in ('nodes', 'names', 'lines'):
            self.assertEqual([m.id for m in message.markers if m.ns == space], list(range(16)))
        self.assertTrue(all(m.header.frame_id == 'ring' for m in message.markers if m.ns == 'nodes'))

    def test_the_frames_of_the_robot_are_known(self):
        parents = {}

        def take(message):
            parents.update({one.child_frame_id: one.header.frame_id for one in message.transforms})
        fixed = rospy.Subscriber('/tf_static', TFMessage, take)  # of ring_view and of robot_state_publisher
        wanted = {'base_link': 'ring', 'body': 'base_link', 'l_sole': 'l_ankle_roll_link', 'r_sole': 'r_ankle_roll_link',
                  'head_imu': 'neck_yaw_link', 'left_foot_force': 'l_ankle_roll_link'}
        wait_for(lambda: wanted.items() <= parents.items(), 'the frames that stay where they are')
        fixed.unregister()

    def test_what_it_shows_is_sent_to_it_at_once(self):
        for topic, kind in (('ring_status', RingStatus), ('joint_states', JointState)):
            publisher = rospy.Publisher(topic, kind, queue_size=1)   # it sends nothing

            def no_delay():
                return [link.socket.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
                        for link in publisher.impl.connections if 'ring_view' in link.endpoint_id]
            self.assertEqual(len(wait_for(no_delay, 'ring_view to listen to ' + topic)), 1)
            wait_for(lambda: all(no_delay()), 'no wait for a full segment')
            publisher.unregister()

    def test_a_hung_limb_is_marked_where_it_is_and_keeps_its_pose(self):
        transforms, held = Newest('/tf', TFMessage), Newest('held_joint_states', JointState)
        self.fault('hang left_knee')
        message = self.markers.wait(lambda m: any(k.ns == 'limbs of left_knee' for k in m.markers), 'the knee marked')
        limb = [m for m in message.markers if m.ns == 'limbs of left_knee'][0]
        self.assertEqual(limb.header.frame_id, 'l_knee_link')
        states = Newest('joint_states', JointState)
        states.wait(lambda s: len(s.name) == 25, 'the knee to fall silent')
        held.wait_for_more(30, 'held joint states')
        self.assertEqual(len(held.get().name), 26)
        transforms.wait(lambda t: 'l_knee_link' in [one.child_frame_id for one in t.transforms], 'the knee to be shown')
        self.assertTrue(service('clear_faults', ClearFaults)(id='').success)
        wait_for(lambda: 'limbs of left_knee' not in self.spaces(), 'the knee to look well')

    def test_a_break_is_marked_until_it_is_healed(self):
        self.fault('cut left_hip -> left_hip_yaw')
        message = self.markers.wait(lambda m: any(k.ns == 'breaks' for k in m.markers), 'the break marked')
        self.assertEqual([m.id for m in message.markers if m.ns == 'breaks'], [8])
        self.assertTrue(service('clear_faults', ClearFaults)(id='').success)
        wait_for(lambda: 'breaks' not in self.spaces(), 'the break to be gone')


if __name__ == '__main__':
    rospy.init_node('view_test')
    rostest.rosrun('limb_ring', 'view', View)
