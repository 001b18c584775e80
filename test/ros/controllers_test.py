#!/usr/bin/python3
"""Two controllers in lockstep with a virtual ring, processes of their own: started late, killed, back again; and the
bridge's services beside them."""
import signal
import subprocess
import sys
import threading
import unittest

import rospy
import rostest
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import JointState

from limb_ring.srv import ResetNode, SendInterrupt
from ring_testing import wait_for

CONTROLLERS = {'elbow': ('arm_commands', 0.5), 'knee': ('leg/commands', 1.0)}   # rad


class Heard:
    """All joint_states, and what the bridge has said."""

    def __init__(self):
        self.lock, self.states, self.said = threading.Lock(), [], []
        self.subscribers = [rospy.Subscriber('joint_states', JointState, self.take, tcp_nodelay=True),
                            rospy.Subscriber('/rosout', Log, self.hear)]

    def take(self, states):
        with self.lock:
            self.states.append((states.header.stamp.to_nsec(), dict(zip(states.name, states.position))))

    def hear(self, line):
        with self.lock:
            self.said.append(line.msg)

    def count(self):
        with self.lock:
            return len(self.states)

    def since(self, begin):
        with self.lock:
            return self.states[begin:]

    def wait_said(self, words):
        def said():
            with self.lock:
                return [line for line in self.said if words in line]
        return wait_for(said, words)


class Controllers(unittest.TestCase):
    def start(self, joint):
        topic, angle = CONTROLLERS[joint]
        process = subprocess.Popen([sys.executable, rospy.get_param('~controller'), topic, joint, str(angle)])
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def await_goals(self, heard, count=100):
        for joint, (_, angle) in CONTROLLERS.items():
            wait_for(lambda: heard.count() and abs(heard.since(-1)[0][1].get(joint, 9) - angle) < 0.01, joint + ' at its goal')
        begin = heard.count()
        states = wait_for(lambda: heard.since(begin) if heard.count() >= begin + count else None, 'a second of states')
        stamps = [stamp for stamp, _ in states]
        self.assertEqual({b - a for a, b in zip(stamps, stamps[1:])}, {10 ** 7}, 'every 10 ms, none left out')

    def test_two_controllers_and_what_becomes_of_one_that_dies(self):
        heard = Heard()
        # The bridge waits for the controllers, and time with it; a service does not.
        rospy.wait_for_service('reset_node', 60)
        elbow = self.start('elbow')
        answer = rospy.ServiceProxy('send_interrupt', SendInterrupt)(node='knee', factor=2)
        self.assertTrue(answer.success, answer.message)
        answer = rospy.ServiceProxy('reset_node', ResetNode)(node='knee', timeout=rospy.Duration(3))
        self.assertTrue(answer.success, answer.message)
        knee = self.start('knee')
        self.await_goals(heard)

        # One that stops answering is found by the real time limit.
        knee.send_signal(signal.SIGSTOP)
        missing = heard.wait_said('/knee_controller has not answered the joint_states of ')[0]
        self.assertIn('leg/commands', missing)
        begin = heard.count()
        wait_for(lambda: heard.count() > begin + 100, 'time that goes on without it')
        knee.send_signal(signal.SIGCONT)
        heard.wait_said('/knee_controller publishes leg/commands again')
        self.await_goals(heard)

        # One that leaves is seen at once.
        elbow.send_signal(signal.SIGINT)
        self.assertIn('arm_commands', heard.wait_said('/elbow_controller has gone')[0])
        begin = heard.count()
        wait_for(lambda: heard.count() > begin + 100, 'time that goes on without it')
        self.start('elbow')
        heard.wait_said('/elbow_controller publishes arm_commands again')
        self.await_goals(heard)


if __name__ == '__main__':
    rospy.init_node('controllers_test')
    rostest.rosrun('limb_ring', 'controllers', Controllers)
