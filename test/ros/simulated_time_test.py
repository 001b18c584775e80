#!/usr/bin/python3
"""Under use_sim_time, with a silent /clock, joint data and diagnostics go on by the wall clock."""
import time
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from limb_ring.srv import ResetNode
from sensor_msgs.msg import JointState

from ring_testing import Newest, Ring, wait_for


class SimulatedTime(unittest.TestCase):
    def test_joint_data_diagnostics_and_services_go_by_the_wall_clock(self):
        self.assertEqual(rospy.get_time(), 0, 'ROS time stands still here')
        ring, states = Ring(), Newest('joint_states', JointState)
        commands = rospy.Publisher('joint_commands', JointState, queue_size=1)
        ring.wait_until_up()
        states.wait_for_more(20, 'joint states')
        self.assertLess(abs(time.time() - states.get().header.stamp.to_sec()), 60)

        told = Newest('/diagnostics', DiagnosticArray).wait(lambda _: True, 'diagnostics')
        self.assertLess(abs(time.time() - told.header.stamp.to_sec()), 60)

        command = JointState(name=['l_elbow'], position=[1.3])

        def has_moved():
            commands.publish(command)
            state = states.get()
            return abs(dict(zip(state.name, state.position)).get('l_elbow', 0) - 1.3) < 0.01
        wait_for(has_moved, 'the elbow to move')
        answer = rospy.ServiceProxy('reset_node', ResetNode)(node='left_elbow', timeout=rospy.Duration(10))
        self.assertTrue(answer.success, answer.message)


if __name__ == '__main__':
    rospy.init_node('simulated_time_test')
    rostest.rosrun('limb_ring', 'simulated_time', SimulatedTime)
