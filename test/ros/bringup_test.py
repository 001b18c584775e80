#!/usr/bin/python3
"""ring.launch brings up the humanoid: its joints are seen and moved."""
import time
import unittest

import rospy
import rostest
from geometry_msgs.msg import WrenchStamped
from sensor_msgs.msg import Imu, JointState

from ring_testing import Newest, Ring, wait_for

JOINTS = (['torso_' + axis for axis in ('pitch', 'roll', 'yaw')] +
          ['neck_' + axis for axis in ('pitch', 'roll', 'yaw')] +
          [side + joint for side in 'lr' for joint in (
              '_shoulder_pitch', '_shoulder_roll', '_shoulder_yaw', '_elbow', '_hip_pitch',
              '_hip_roll', '_hip_yaw', '_knee', '_ankle_pitch', '_ankle_roll')])


class Bringup(unittest.TestCase):
    def setUp(self):
        self.ring = Ring()
        self.states = Newest('joint_states', JointState)
        self.commands = rospy.Publisher('joint_commands', JointState, queue_size=1)
        self.ring.wait_until_up()
        wait_for(self.commands.get_num_connections, 'the bridge to listen')

    def command(self, names, positions):
        """Commands once a period until told to stop, as a controller does."""
        command = JointState(name=names, position=positions)
        return rospy.timer.Timer(rospy.Duration(0.02), lambda _: self.commands.publish(command))

    def position(self, joint):
        state = self.states.get()
        return dict(zip(state.name, state.position)).get(joint)

    def test_all_nodes_are_up_and_know_the_ring_of_sixteen(self):
        status = self.ring.wait_until_up()
        self.assertEqual(len(status.nodes), 16)
        self.assertEqual(status.nodes[0].name, 'body')
        self.ring.status.wait(lambda s: all(n.ring_size == 16 for n in s.nodes), 'ring size 16')
        self.assertTrue(all(n.pid > 0 for n in status.nodes))
        self.assertEqual(len({n.cpu_pid for n in status.nodes}), 16, 'a process per CPU')

    def test_states_of_all_joints_arrive_with_wall_clock_stamps(self):
        state = self.states.wait(lambda s: len(s.name) == 26, 'all 26 joints')
        self.assertEqual(sorted(state.name), sorted(JOINTS))
        self.assertEqual(len(state.position), 26)
        self.assertEqual(len(state.velocity), 26)
        self.assertLess(abs(time.time() - state.header.stamp.to_sec()), 60)
        self.states.wait_for_more(10, 'joint states again and again')

    def test_a_command_moves_its_joints_and_no_other(self):
        self.states.wait(lambda s: len(s.name) == 26, 'all 26 joints')
        knee = self.position('l_knee')
        timer = self.command(['l_elbow', 'r_elbow', 'a_tail'], [1.2, 0.9, 1.0])
        wait_for(lambda: abs((self.position('l_elbow') or 0) - 1.2) < 0.01 and
                 abs((self.position('r_elbow') or 0) - 0.9) < 0.01, 'the elbows to move')
        wait_for(lambda: self.ring.counter('commands_unknown_joint'), 'the unknown joint counted')
        timer.shutdown()
        self.assertAlmostEqual(wait_for(lambda: self.position('l_knee'), 'a state'), knee, 2)

    def test_a_malformed_command_is_refused_and_counted(self):
        before = self.ring.counter('commands_refused')
        timer = self.command(['l_elbow', 'r_elbow'], [1.0])
        wait_for(lambda: self.ring.counter('commands_refused') > before, 'the refusal counted')
        timer.shutdown()
        timer = self.command(['l_elbow'], [float('inf')])
        before = self.ring.counter('commands_refused') + 1
        wait_for(lambda: self.ring.counter('commands_refused') > before, 'the refusal counted')
        timer.shutdown()

    def test_sensors_arrive_under_their_names(self):
        imu = Newest('sensors/head_imu', Imu)
        force = Newest('sensors/left_foot_force', WrenchStamped)
        self.assertEqual(imu.wait(lambda _: True, 'the IMU').header.frame_id, 'head_imu')
        self.assertEqual(force.wait(lambda _: True, 'the force').header.frame_id, 'left_foot_force')


if __name__ == '__main__':
    rospy.init_node('bringup_test')
    rostest.rosrun('limb_ring', 'bringup', Bringup)
