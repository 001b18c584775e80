#!/usr/bin/python3
"""What a node's CPU sends that does not fit the ring's file, and what it does not send, is told by name; and a sensor
takes its values from a topic."""
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import WrenchStamped
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import Imu, JointState as Joints

from limb_ring import HostPort, JointState, SensorReading
from ring_testing import Newest, Ring, wait_for

# Nobody publishes what they take.
OF_TOPICS = ['hip_force', 'hip_imu']


class OwnSensors(unittest.TestCase):
    def setUp(self):
        self.ring = Ring('/sensed/ring_status')
        self.name = self.ring.wait_until_up(cpus=False).ring
        self.said = []
        self.log = rospy.Subscriber('/rosout', Log, lambda entry: self.said.append(entry.msg))
        self.diagnosed = {}   # what /diagnostics warns of, by node
        self.diagnostics = rospy.Subscriber('/diagnostics', DiagnosticArray, self.take)
        wait_for(lambda: self.log.get_num_connections() > 2, 'the log of both bridges, and our own')

    def tearDown(self):
        self.log.unregister()
        self.diagnostics.unregister()

    def take(self, message):
        for status in message.status:
            if status.name.startswith('sensed/limb_ring: ') and status.level == DiagnosticStatus.WARN:
                self.diagnosed.setdefault(status.name.split(': ')[1], set()).add(status.message)

    def wait_for_diagnosis(self, node, words, meanwhile=lambda: None):
        """A warning at that node in /diagnostics; another may stand beside it."""
        def is_told():
            meanwhile()
            return any(words in message for message in self.diagnosed.get(node, ()))
        wait_for(is_told, lambda: '%s at %s; told: %s' % (words, node, self.diagnosed))

    def cpu(self, node):
        port = HostPort.connect(self.name, node, role='cpu')
        self.addCleanup(port.close)
        return port

    @staticmethod
    def reading(sensor, kind):
        return SensorReading(kind, [0.0, 0.0, 9.81], [0.0, 0.0, 0.0], sensor=sensor)

    def test_one_that_says_nothing_is_listed_until_it_does(self):
        self.ring.status.wait(lambda status: set(status.silent_sensors) >= {'foot_force', 'shin_imu'}, 'both silent')
        leg = self.cpu('leg')

        def is_alone(silent):
            leg.wait(leg.send(0, self.reading(0, 'imu')))
            return [name for name in self.ring.status.get().silent_sensors if name not in OF_TOPICS] == silent
        wait_for(lambda: is_alone(['foot_force']), 'the force sensor alone silent')
        self.ring.status.wait(lambda status: set(status.silent_sensors) >= {'foot_force', 'shin_imu'}, 'both silent again')

    def test_a_cpu_that_leaves_a_sensor_out_is_a_warning_at_its_node_until_it_reads_it(self):
        leg = self.cpu('leg')
        state = JointState([JointState.Joint(0)])
        self.wait_for_diagnosis('leg', 'its CPU runs and sends no readings of shin_imu',
                                lambda: leg.wait(leg.send(0, state)))

        def is_mended(status):
            leg.wait(leg.send(0, self.reading(0, 'imu')))
            return 'shin_imu' not in {seen.name: seen.problem for seen in status.nodes}['leg']
        self.ring.status.wait(is_mended, 'the IMU no problem any more')

    def test_a_cpu_that_obeys_no_command_is_a_warning_at_its_node(self):
        commands = rospy.Publisher('/sensed/joint_commands', Joints, queue_size=1)
        self.addCleanup(commands.unregister)
        leg = self.cpu('leg')

        def is_commanded_in_vain():
            leg.wait(leg.send(0, JointState([JointState.Joint(0)])))
            while leg.receive(0) is not None:   # a CPU that takes what it is given, and does nothing with it
                pass
            commands.publish(Joints(name=['ankle'], position=[0.1]))
        self.wait_for_diagnosis('leg', 'its CPU was given commands for its joints and obeys none: its firmware neither takes '
                                'nor refuses them', is_commanded_in_vain)

    def test_one_with_a_topic_shows_what_the_topic_says_and_is_silent_when_it_is(self):
        self.ring.status.wait(lambda status: set(status.silent_sensors) >= set(OF_TOPICS), 'the topics silent')
        self.wait_for_diagnosis('hip', 'its CPU runs and sends no readings of hip_imu, whose values the bridge takes from the '
                                'topic gazebo/imu')
        imus, forces = Newest('/sensed/sensors/hip_imu', Imu), Newest('/sensed/sensors/hip_force', WrenchStamped)
        imu, force = Imu(), WrenchStamped()
        imu.linear_acceleration.x, imu.angular_velocity.z, force.wrench.force.y = 1.5, -0.25, 40
        out = [(rospy.Publisher('/sensed/gazebo/imu', Imu, queue_size=1), imu),
               (rospy.Publisher('/sensed/gazebo/wrench', WrenchStamped, queue_size=1), force)]

        def come():
            for publisher, message in out:
                publisher.publish(message)
            return imus.count() > 20 and forces.count() > 2 and 'hip_imu' not in self.ring.status.get().silent_sensors
        wait_for(come, 'readings of both')
        # The force sensor is slower than its topic.
        wait_for(lambda: come() and self.ring.counter('sensor_values_left_out') > 0, 'values left out')
        self.assertEqual((imus.get().linear_acceleration.x, imus.get().angular_velocity.z), (1.5, -0.25))
        self.assertEqual((imus.get().header.frame_id, forces.get().wrench.force.y), ('hip_imu', 40))
        self.assertEqual({seen.name: seen.problem for seen in self.ring.status.get().nodes}['body'], '')
        for publisher, _ in out:
            publisher.unregister()
        self.ring.status.wait(lambda status: set(status.silent_sensors) >= set(OF_TOPICS), 'silent again')

    def test_what_does_not_fit_is_reported_with_the_node_that_sends_it(self):
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
                self.wait_for_diagnosis(node, words, lambda: port.wait(port.send(0, packet)))
                port.close()


if __name__ == '__main__':
    rospy.init_node('own_sensors_test')
    rostest.rosrun('limb_ring', 'own_sensors', OwnSensors)
