#!/usr/bin/python3
"""Under use_sim_time, with a silent /clock, joint data and diagnostics go on by the wall clock."""
import time
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from limb_ring.srv import ResetNode
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import JointState

from ring_testing import Newest, Ring, kill_process, wait_for


class SimulatedTime(unittest.TestCase):
    def test_the_bridge_says_that_a_live_ring_does_not_go_by_it(self):
        said, ring = [], Ring()
        rospy.Subscriber('/rosout', Log, lambda line: said.append(line.msg))
        ring.wait_until_up()

        def is_said():
            gone = ring.node('body').pid
            kill_process(gone)   # the bridge says it as it connects
            ring.wait_for_node('body', lambda node: node.pid not in (0, gone), 'to be there again')
            ring.wait_until_up()
            return [line for line in said if '/use_sim_time is set, but this ring is live' in line]
        wait_for(is_said, 'the warning')

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
