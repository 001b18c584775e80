#!/usr/bin/python3
"""A hung CPU, a killed daemon and a killed bridge come back, and the others do not notice."""
import unittest

import rospy
import rostest
from limb_ring.srv import ResetNode, Resume, SendInterrupt, Stop
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool

from ring_testing import Newest, Ring, is_alive, kill_process, service, stop_process, wait_for


def lost(node):
    """Sends of that node that ended lost. Samples that its CPU left out, as it does on a slow machine, are none."""
    return dict(zip(node.counter_names, node.counter_values))['ended_lost']


class Recovery(unittest.TestCase):
    def setUp(self):
        self.ring = Ring()
        self.states = Newest('joint_states', JointState)
        self.ring.wait_until_up()

    def others(self, *names):
        return {n.name: n for n in self.ring.status.get().nodes if n.name not in names}

    def test_a_frozen_cpu_falls_silent_and_is_brought_back_by_a_reset(self):
        before = self.ring.node('left_knee')
        calm = self.others('left_knee')
        stop_process(before.cpu_pid)
        self.ring.status.wait(lambda s: s.silent_joints == ['l_knee'], 'the knee to fall silent')
        self.states.wait(lambda s: 'l_knee' not in s.name and len(s.name) == 25,
                         'joint states without the knee')

        answer = service('reset_node', ResetNode)(node='left_knee', timeout=rospy.Duration(10))
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(answer.boots, before.cpu_boots + 1)
        self.assertGreater(answer.round_trip, 0)

        after = self.ring.wait_for_node(
            'left_knee', lambda n: n.cpu_boots == answer.boots and n.cpu_pid > 0, 'the new process')
        self.assertNotEqual(after.cpu_pid, before.cpu_pid)
        wait_for(lambda: not is_alive(before.cpu_pid), 'the frozen process to be gone')
        self.states.wait(lambda s: 'l_knee' in s.name and len(s.name) == 26, 'the knee again')
        for name, node in self.others('left_knee').items():
            self.assertEqual(node.cpu_pid, calm[name].cpu_pid, name)
            self.assertEqual(lost(node), lost(calm[name]), name)

    def test_a_reset_that_cannot_be_says_why(self):
        reset = service('reset_node', ResetNode)
        answer = reset(node='left_tail', timeout=rospy.Duration(0))
        self.assertFalse(answer.success)
        self.assertIn("no node 'left_tail'", answer.message)
        self.assertIn('left_knee (10)', answer.message)
        self.assertIn('own', reset(node='body').message)
        for wrong in (-1, 61, 2e-9):  # the last is what rosservice makes of 2
            answer = reset(node='left_knee', timeout=rospy.Duration.from_sec(wrong))
            self.assertFalse(answer.success)
            self.assertIn('1 ms to 60 s', answer.message)

    def test_an_interrupt_tells_its_outcome(self):
        send = service('send_interrupt', SendInterrupt)
        answer = send(node='head', factor=2, force=False)
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(answer.outcome, 'delivered')
        self.assertEqual(send(node='head', factor=7, force=False).outcome, 'refused')
        self.assertIn('0 to 7', send(node='head', factor=8, force=False).message)
        self.assertFalse(send(node='all', factor=0, force=False).success, 'a reset of all needs force')
        self.assertIn('own', send(node='body', factor=0, force=False).message)

    def test_a_stop_of_all_is_latched_until_resumed(self):
        stopped = Newest('stopped', Bool)
        stopped.wait(lambda s: not s.data, 'the state before a stop')
        answer = service('stop', Stop)(node='', timeout=rospy.Duration(20))
        self.assertTrue(answer.success, answer.message)
        limbs = [n.name for n in self.ring.status.get().nodes if n.states_received] + ['waist']  # that has no joints
        for name in limbs:
            self.ring.wait_for_node(name, lambda n: n.stopped, 'stopped')
        stopped.wait(lambda s: s.data, 'the state after a stop')
        self.ring.status.wait(lambda s: s.stopped, 'the ring to be stopped')
        late = Newest('stopped', Bool)
        late.wait(lambda s: s.data, 'the state for one who comes late')
        self.a_command_is_not_obeyed_and_counted()
        answer = service('resume', Resume)(node='all')
        self.assertTrue(answer.success, answer.message)
        for name in limbs:
            self.ring.wait_for_node(name, lambda n: not n.stopped, 'resumed')
        stopped.wait(lambda s: not s.data, 'the state after resuming')
        self.ring.status.wait(lambda s: not s.stopped, 'the ring to be stopped no more')
        answer = service('resume', Resume)(node='waist')
        self.assertFalse(answer.success)
        self.assertIn('is not stopped', answer.message)

    def a_command_is_not_obeyed_and_counted(self):
        before = self.ring.node('left_knee').commands_not_obeyed
        commands = rospy.Publisher('joint_commands', JointState, queue_size=1)
        wait_for(commands.get_num_connections, 'the bridge to listen')
        commands.publish(JointState(name=['l_knee'], position=[-0.6]))
        self.ring.wait_for_node('left_knee', lambda n: n.commands_not_obeyed == before + 1, 'to count the command')
        commands.unregister()

    def test_all_are_resumed_even_if_the_time_is_up_at_the_first(self):
        self.assertTrue(service('stop', Stop)(node='', timeout=rospy.Duration(20)).success)
        limbs = [n.name for n in self.ring.status.get().nodes if n.states_received]
        for name in limbs:
            self.ring.wait_for_node(name, lambda n: n.stopped, 'stopped')
        answer = service('resume', Resume)(node='all', timeout=rospy.Duration(0.001))
        for name in limbs:
            self.assertIn(name, answer.message)
            self.ring.wait_for_node(name, lambda n: not n.stopped, 'resumed')

    def test_a_killed_daemon_comes_back_with_its_cpu(self):
        before = self.ring.node('right_elbow')
        kill_process(before.pid)
        after = self.ring.wait_for_node('right_elbow', lambda n: n.pid not in (0, before.pid) and
                                        n.state == 'up' and n.cpu_state == 'running', 'to return')
        self.assertNotEqual(after.cpu_pid, before.cpu_pid)
        wait_for(lambda: not is_alive(before.cpu_pid), 'the old CPU to be gone')
        self.states.wait(lambda s: len(s.name) == 26, 'all joints')
        self.ring.wait_until_up()

    def test_a_bridge_outlives_its_daemon_and_says_that_it_is_gone(self):
        before = self.ring.node('body')
        kill_process(before.pid)
        gone = self.ring.status.wait(lambda s: not s.connected, 'the bridge to notice')
        self.assertTrue(gone.message)
        self.ring.status.wait(lambda s: len(s.silent_joints) == 26, 'all joints to fall silent')
        self.ring.wait_until_up()
        self.assertNotEqual(self.ring.node('body').pid, before.pid)
        self.assertEqual(self.ring.node('body').cpu_pid, before.cpu_pid, 'the same bridge')
        self.states.wait_for_more(10, 'joint states again')

    def test_a_killed_bridge_comes_back_and_the_ring_does_not_notice(self):
        before = self.ring.wait_until_up()
        kill_process(self.ring.node('body').cpu_pid)
        after = self.ring.status.wait(
            lambda s: s.connected and s.nodes[0].cpu_boots > before.nodes[0].cpu_boots and
            s.nodes[0].cpu_pid != before.nodes[0].cpu_pid and all(node.pid for node in s.nodes),
            'the new bridge, answered by all daemons')
        for old, new in zip(before.nodes[1:], after.nodes[1:]):
            self.assertEqual((new.pid, new.cpu_pid, new.cpu_boots),
                             (old.pid, old.cpu_pid, old.cpu_boots), new.name)
        self.states.wait_for_more(10, 'joint states again')
        self.ring.wait_until_up()


if __name__ == '__main__':
    rospy.init_node('recovery_test')
    rostest.rosrun('limb_ring', 'recovery', Recovery)
