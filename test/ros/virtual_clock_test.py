#!/usr/bin/python3
"""A controller in lockstep with a virtual ring: the bridge tells the ring's time, and waits for each answer."""
import subprocess
import threading
import unittest

import rospy
import rostest
from limb_ring.srv import ResetNode
from rosgraph_msgs.msg import Clock, Log
from sensor_msgs.msg import JointState

from ring_testing import Newest, wait_for

GOAL = {'knee': 1.2, 'ankle': -0.7}   # rad


class Controller:
    """Answers each joint_states with a command of the same stamp, while it is on."""

    def __init__(self):
        self.on, self.stamped, self.states = True, True, []
        self.lock = threading.Lock()
        self.commands = rospy.Publisher('joint_commands', JointState, queue_size=10)
        rospy.Subscriber('joint_states', JointState, self.answer, tcp_nodelay=True)

    def answer(self, states):
        with self.lock:
            self.states.append(states)
        if not self.on:
            return
        command = JointState(name=list(GOAL), position=list(GOAL.values()))
        if self.stamped:
            command.header.stamp = states.header.stamp
        self.commands.publish(command)

    def all(self):
        with self.lock:
            return list(self.states)


class VirtualClock(unittest.TestCase):
    def test_a_controller_in_lockstep_misses_nothing(self):
        clock, controller = Newest('/clock', Clock), Controller()
        wait_for(lambda: len(controller.all()) > 20, 'joint states')
        begin = len(controller.all())
        states = wait_for(lambda: controller.all()[begin:] if len(controller.all()) > begin + 300 else None, 'three seconds')
        stamps = [state.header.stamp.to_nsec() for state in states]
        self.assertLess(stamps[0], 3600 * 10 ** 9, 'a stamp is of the ring, which has just begun')
        self.assertEqual({b - a for a, b in zip(stamps, stamps[1:])}, {10 ** 7}, 'every 10 ms, none left out')
        for name, angle in zip(states[-1].name, states[-1].position):
            self.assertAlmostEqual(angle, GOAL[name], 2)
        self.assertGreaterEqual(rospy.get_rostime().to_nsec(), stamps[0], 'nodes that use_sim_time follow')

        # Without a stamp nobody knows what it answers.
        said = []
        rospy.Subscriber('/rosout', Log, lambda line: said.append(line.msg))
        controller.stamped = False
        wait_for(lambda: [line for line in said if 'its command has the stamp 0.000000 s' in line], 'a word about stamps')
        controller.on = False
        before = clock.get().clock
        wait_for(lambda: (clock.get().clock - before).to_sec() > 1, 'time that goes on without a controller')

    def test_who_comes_while_the_clock_stands_is_told_the_time(self):
        ringctl = ['rosrun', 'limb_ring', 'ringctl', '--ring', rospy.get_param('ring_bridge/ring')]
        wait_for(lambda: subprocess.call(ringctl + ['clock', 'pause']) == 0, 'the ring')
        self.addCleanup(subprocess.call, ringctl + ['clock', 'run'])
        first, late = Newest('/clock', Clock), Newest('/clock', Clock)
        first.wait(lambda _: True, 'the time that it is')
        late.wait(lambda clock: clock.clock == first.get().clock, 'the same time')

    def test_services_say_that_the_clock_stands(self):
        ringctl = ['rosrun', 'limb_ring', 'ringctl', '--ring', rospy.get_param('ring_bridge/ring')]
        rospy.wait_for_service('reset_node', 30)
        wait_for(lambda: subprocess.call(ringctl + ['clock', 'pause']) == 0, 'the ring')
        self.addCleanup(subprocess.call, ringctl + ['clock', 'run'])
        answer = rospy.ServiceProxy('reset_node', ResetNode)(node='knee')
        self.assertFalse(answer.success)
        self.assertIn('the virtual clock of ring', answer.message)
        self.assertNotIn('{', answer.message)


if __name__ == '__main__':
    rospy.init_node('virtual_clock_test')
    rostest.rosrun('limb_ring', 'virtual_clock', VirtualClock)
