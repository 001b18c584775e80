#!/usr/bin/python3
"""What a node's CPU sends that does not fit the ring's file, and what it does not send, is told by name."""
import unittest

import rospy
import rostest
from rosgraph_msgs.msg import Log

from limb_ring import HostPort, JointState, SensorReading
from ring_testing import Ring, wait_for


class OwnSensors(unittest.TestCase):
    def setUp(self):
        self.ring = Ring('/sensed/ring_status')
        self.name = self.ring.wait_until_up(cpus=False).ring
        self.said = []
        self.log = rospy.Subscriber('/rosout', Log, lambda entry: self.said.append(entry.msg))
        wait_for(lambda: self.log.get_num_connections() > 1, 'the log of the bridges')

    def tearDown(self):
        self.log.unregister()

    def cpu(self, node):
        port = HostPort.connect(self.name, node, role='cpu')
        self.addCleanup(port.close)
        return port

    @staticmethod
    def reading(sensor, kind):
        return SensorReading(kind, [0.0, 0.0, 9.81], [0.0, 0.0, 0.0], sensor=sensor)

    def test_one_that_says_nothing_is_listed_until_it_does(self):
        self.ring.status.wait(lambda status: sorted(status.silent_sensors) == ['foot_force', 'shin_imu'], 'both silent')
        leg = self.cpu('leg')

        def is_alone(silent):
            leg.wait(leg.send(0, self.reading(0, 'imu')))
            return list(self.ring.status.get().silent_sensors) == silent
        wait_for(lambda: is_alone(['foot_force']), 'the force sensor alone silent')
        self.ring.status.wait(lambda status: len(status.silent_sensors) == 2, 'both silent again')

    def test_what_does_not_fit_is_said_with_the_node_that_sends_it(self):
        for node, packet, words in (
                ('leg', JointState([JointState.Joint(), JointState.Joint()]), 'it sends the state of 2 joints'),
                ('leg', self.reading(1, 'imu'), 'it sends a reading of an IMU as sensor 1 (from 0)'),
                ('neck', self.reading(0, 'imu'), 'it sends a reading of an IMU as sensor 0 (from 0)')):
            with self.subTest(words):
                before = self.ring.counter('joint_packets_unfit')
                port = self.cpu(node)

                def is_named(status):
                    port.wait(port.send(0, packet))
                    return words in {seen.name: seen.problem for seen in status.nodes}[node]
                self.ring.status.wait(is_named, 'the node named')
                self.assertGreater(self.ring.counter('joint_packets_unfit'), before)
                wait_for(lambda: any('node %s: %s' % (node, words) in said for said in self.said), 'a line in the log')
                port.close()


if __name__ == '__main__':
    rospy.init_node('own_sensors_test')
    rostest.rosrun('limb_ring', 'own_sensors', OwnSensors)
