#!/usr/bin/python3
"""joint_commands for several nodes cross the ring in one broadcast."""
import unittest

import rospy
import rostest
from sensor_msgs.msg import JointState

from ring_testing import Newest, Ring, wait_for
from topic_testing import publisher_across

JOINTS = ['hip_pitch', 'hip_roll', 'knee_pitch', 'ankle_pitch']
NODES = 3.0   # that own them
NEAR = 0.01   # rad


class CommandSets(unittest.TestCase):
    # One for each ring in all tests: of a topic that is given up and published again at once, roscpp may connect to the
    # new publisher, drop that connection, since it hears only now that the old one is gone, and connect once more. What
    # was published meanwhile is lost.
    commands = {}

    def ring(self, name):
        self.states = Newest('/%s/joint_states' % name, JointState)
        self.addCleanup(self.states.unregister)
        ring = Ring('/%s/ring_status' % name)
        ring.status.wait(lambda status: status.connected and not status.silent_joints, 'joints of %s' % name)
        self.status = ring.status
        if name not in self.commands:
            self.commands[name] = publisher_across('/%s/joint_commands' % name, JointState)
        return self.commands[name]

    def counter(self, name, node=None):
        """Of the bridge, or of the body's network controller."""
        status = self.status.get()
        counted = status if node is None else status.nodes[node]
        return dict(zip(counted.counter_names, counted.counter_values)).get(name, 0)

    def command(self, commands, angles):
        """One message; returns when all joints are there."""
        commands.publish(JointState(name=JOINTS, position=angles))

        def are_there(state):
            there = dict(zip(state.name, state.position))
            return all(abs(there.get(name, 9) - angle) < NEAR for name, angle in zip(JOINTS, angles))
        self.states.wait(are_there, 'the joints at %s' % angles)

    def changes(self, commands, angles, counted):
        """What one message changes: (commands delivered, sends of the body's that ended so)."""
        self.status.wait_for_more(2, 'ring_status')   # so that nothing of before is still to be counted
        before = [counter() for counter in counted]
        self.command(commands, angles)
        wait_for(lambda: counted[0]() - before[0] >= NODES, 'all commands counted')
        self.status.wait_for_more(2, 'ring_status')
        return [counter() - old for counter, old in zip(counted, before)]

    def test_one_message_is_one_packet(self):
        commands = self.ring('taken')
        counted = [lambda: self.counter('commands_delivered'), lambda: self.counter('ended_delivered', 0)]
        for angles in [0.3, -0.2, 0.4, 0.1], [-0.1, 0.2, 0.3, -0.4]:
            self.assertEqual(self.changes(commands, angles, counted), [NODES, 1])
        self.assertEqual([node.commands_not_obeyed for node in self.status.get().nodes], [0] * 4)

    def test_what_a_node_has_refused_goes_to_each_of_the_others_alone(self):
        commands = self.ring('refused')
        counted = [lambda: self.counter('commands_delivered'), lambda: self.counter('ended_delivered', 0),
                   lambda: self.counter('ended_refused', 0)]
        self.assertEqual(self.changes(commands, [0.3, -0.2, 0.4, 0.1], counted), [NODES, NODES, 1])

    def test_the_newest_of_many_arrives_though_each_set_is_refused(self):
        for name in 'taken', 'refused':
            commands = self.ring(name)
            for step in range(300):
                commands.publish(JointState(name=JOINTS, position=[step * 0.001] * 4))
            self.command(commands, [0.2, 0.1, 0.3, -0.1])

    def test_what_is_for_one_node_goes_to_it_alone(self):
        commands = self.ring('refused')
        refused = self.counter('ended_refused', 0)
        commands.publish(JointState(name=['knee_pitch'], position=[0.7]))
        self.states.wait(lambda state: abs(dict(zip(state.name, state.position)).get('knee_pitch', 9) - 0.7) < NEAR,
                         'the knee')
        self.status.wait_for_more(2, 'ring_status')
        self.assertEqual(self.counter('ended_refused', 0), refused)


if __name__ == '__main__':
    rospy.init_node('command_sets_test')
    rostest.rosrun('limb_ring', 'command_sets', CommandSets)
