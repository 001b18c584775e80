"""JointNode: what it keeps for firmware, and how it says what is wrong. Emergency stops: one truth, whoever is asked."""
import sys
import unittest

from ring_process import GUARD, RingTest, plain_nodes
from limb_ring import CommandSet, JointCommand, JointState, Packet

KNEE = dict(name='knee', lower=-2, upper=2, velocity=4, effort=10)

# Sets the mode bit of its joint states alone, as firmware does that knows no call.
OLD_FIRMWARE = """
import sys, limb_ring
with limb_ring.HostPort.connect(ring=sys.argv[1], node=sys.argv[2], role='cpu', alive_period=0.1) as port:
    stopped = False
    while port.connected:
        message = port.receive(0.02)
        stopped = stopped or isinstance(message, limb_ring.Interrupt) and message.action == 'stop'
        state = limb_ring.JointState([limb_ring.JointState.Joint(0)])
        state.mode.stopped = stopped
        port.send(0, state, priority=0)
"""
FIRMWARE = """
import sys, time, limb_ring
node = limb_ring.JointNode.of_arguments()
%s
sys.exit(node.run(%s))
"""


class JointNode(RingTest):
    def start_knee(self, firmware, *more):
        nodes = plain_nodes(2)
        nodes[0]['cpu'] = 'attached'
        nodes[1].update(cpu='attached', joints=[KNEE])
        self.start_ring(nodes)
        return self.start('cpu', [sys.executable, self.write('knee.py', firmware), self.ring, 'node1', *more])

    def says(self, cpu, words):
        self.wait('said: ' + words, lambda: words in self.log_of(cpu))

    def state_of_knee(self, body, wanted):
        return body.find(lambda message: isinstance(message, Packet) and isinstance(message.payload, JointState)
                         and wanted(message.payload), timeout=GUARD).payload

    def test_a_stop_is_known_to_whoever_is_asked_also_of_firmware_that_only_says_so_in_its_states(self):
        for firmware in OLD_FIRMWARE, FIRMWARE % ('', 'lambda dt, goals: [0.0]'):
            with self.subTest(firmware):
                cpu = self.start_knee(firmware)
                self.wait_cpu(1, 'running')
                stopped = self.ctl('stop', 'node1')
                self.assertEqual(stopped.returncode, 0)
                self.assertEqual(stopped.stdout.splitlines()[-1], '1 of 1 stopped')
                self.assertTrue(self.row(1)['cpu']['stop']['latched'])
                cpu.kill()
                self.ctl('down')

    def test_obeys_command_sets_and_of_two_with_one_stamp_the_later_sequence(self):
        self.start_knee(FIRMWARE % ('', 'lambda dt, goals: [goal.position for goal in goals]'))
        self.wait_cpu(1, 'running')
        body = self.port(0, role='cpu')
        stamp = body.stamp_ns()
        for sequence, position in (7, 0.5), (8, 1.0):
            command = CommandSet({1: [JointCommand.Joint(position=position)]}, valid_for=60,
                                 sequence=sequence, stamp_ns=stamp)
            self.assertEqual(body.wait(body.send(255, command), timeout=GUARD).outcome, 'delivered')
            state = self.state_of_knee(body, lambda state: state.joints[0].position == position)
            self.assertTrue(state.mode.commanded)
            self.assertEqual(state.refused, 0)

    def test_names_what_is_wrong_with_own_code(self):
        for setup, step, words in (
                ('', 'lambda dt, goals: []', 'step() returned 0 joints, and the ring\'s file gives it 1'),
                ('', 'lambda dt, goals: None', 'step() has to return a list with an entry for each joint, not None'),
                ('node.sensor("imu", lambda: None)', 'None', "node node1 has no sensor 'imu' in the ring's file; it has: none"),
                ('', 'None', 'has joints, and nothing moves them')):
            with self.subTest(words):
                cpu = self.start_knee(FIRMWARE % (setup, step))
                self.says(cpu, words)
                self.assertNotEqual(self.wait_exit(cpu), 0)
                self.ctl('down')

    def test_a_step_that_takes_longer_than_its_period_is_said_once(self):
        cpu = self.start_knee(FIRMWARE % ('', 'lambda dt, goals: time.sleep(0.015) or [0.0]'))
        self.says(cpu, 'step() takes longer than what it steps over')
        self.says(cpu, 'states and sensor readings are left out')


if __name__ == '__main__':
    unittest.main(verbosity=2)
