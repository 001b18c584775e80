#!/usr/bin/python3
"""Two robots on one master: in namespaces of their own nothing meets; without, what is needed has a name of its own."""
import subprocess
import sys
import unittest

import rosgraph
import rospy
import rostest
from limb_ring.msg import RingStatus
from limb_ring.srv import Resume, Stop
from sensor_msgs.msg import Imu
from visualization_msgs.msg import MarkerArray

from ring_testing import GUARD, Newest, Ring, service, wait_for

SERVICES = ['reset_node', 'send_interrupt', 'stop', 'resume', 'inject_fault', 'clear_faults', 'list_faults']


def provider(name):
    """The node that a call of this service goes to."""
    services = dict(rosgraph.Master(rospy.get_name()).getSystemState()[2])
    return (services.get(rospy.resolve_name(name)) or [None])[0]


class TwoRobots(unittest.TestCase):
    def test_a_stop_in_one_namespace_leaves_the_other_robot_alone(self):
        left, right = (Ring('/%s/ring_status' % side) for side in ('left', 'right'))
        left.wait_until_up()
        right.wait_until_up()
        self.assertTrue(service('/left/stop', Stop)().success)
        left.status.wait(lambda s: s.stopped, 'the left robot to be stopped')
        right.status.wait_for_more(3, 'what the right robot says after it')
        self.assertFalse(right.status.get().stopped)
        self.assertTrue(service('/left/ring_bridge/resume', Resume)().success)
        left.status.wait(lambda s: not s.stopped, 'the left robot to go on')

    def test_the_frames_of_a_robot_have_its_tf_prefix(self):
        for topic, frame in (('/left/sensors/knee_imu', 'left/knee_imu'), ('/right/sensors/knee_imu', 'knee_imu')):
            reading = Newest(topic, Imu).wait(lambda _: True, 'a reading on ' + topic)
            self.assertEqual(reading.header.frame_id, frame)
        picture = Newest('/left/ring_markers', MarkerArray).wait(lambda _: True, 'a picture of the left robot')
        self.assertEqual({marker.header.frame_id for marker in picture.markers}, {'left/ring'})

    def test_each_service_has_the_name_of_its_bridge_as_well(self):
        for namespace in ('/left', '/right', ''):
            Ring(namespace + '/ring_status').wait_until_up()
            for name in SERVICES:
                for path in (namespace + '/', namespace + '/ring_bridge/'):
                    wait_for(lambda: provider(path + name) == namespace + '/ring_bridge', path + name)

    def test_in_one_namespace_the_second_bridge_takes_no_service_from_the_first(self):
        first = Ring().wait_until_up().ring
        wait_for(lambda: provider('/list_faults') == '/ring_bridge', 'the services of the first bridge')
        second_ring = sys.argv[3]
        rings = set()
        rospy.Subscriber('/ring_status', RingStatus, lambda status: rings.add(status.ring))
        bridge = subprocess.Popen(['roslaunch', sys.argv[1], 'config:=' + sys.argv[2], 'ring:=' + second_ring,
                                   'name:=second_bridge'])
        try:
            wait_for(lambda: provider('/second_bridge/list_faults') == '/second_bridge', 'those of the second one')
            for name in SERVICES:
                self.assertEqual(provider('/' + name), '/ring_bridge')
                self.assertEqual(provider('/second_bridge/' + name), '/second_bridge')
            wait_for(lambda: rings == {first, second_ring}, 'the status of both on the topic that they share')
            self.assertTrue(service('/second_bridge/stop', Stop)().success)
            stopped = Newest('/ring_status', RingStatus)
            stopped.wait(lambda s: s.ring == second_ring and s.stopped, 'the second robot to be stopped')
            stopped.wait(lambda s: s.ring == first and not s.stopped, 'the first one to be not')
        finally:
            bridge.terminate()
            bridge.wait(GUARD)

    def test_a_bridge_of_the_same_name_is_refused_and_harms_nobody(self):
        ring = Ring()
        ring.wait_until_up()
        done = subprocess.run(['rosrun', 'limb_ring', 'ring_bridge', '--respawn', '__name:=ring_bridge'],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=GUARD)
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn('node /ring_bridge runs already. End it by `rosnode kill /ring_bridge`, or give this one another name',
                      done.stdout)
        ring.status.wait_for_more(3, 'what the first bridge says after it')


if __name__ == '__main__':
    rospy.init_node('two_robots_test')
    rostest.rosrun('limb_ring', 'two_robots', TwoRobots)
