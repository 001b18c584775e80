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
# Sends states and takes no commands.
DEAF = """
import sys, limb_ring
with limb_ring.HostPort.connect(ring=sys.argv[1], node=sys.argv[2], role='cpu', alive_period=0.1) as port:
    while port.connected:
        port.receive(0.02)
        port.send(0, limb_ring.JointState([limb_ring.JointState.Joint(0)]), priority=0)
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

    def warnings(self):
        return [warning['text'] for warning in self.answered(1)['warnings']]

    def warns(self, words, cpu=None):
        self.wait('status says: ' + words, lambda: any(words in text for text in self.warnings()))
        self.assertIn(words, self.ctl('status').stdout)
        self.assertGreater(self.answered(1)['counters']['cpu_warnings'], 0)
        if cpu:
            self.assertEqual(self.answered(1)['cpu']['state'], cpu)

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
                self.assertTrue(self.answered(1)['cpu']['stop']['latched'])
                cpu.kill()
                self.ctl('down')

    def test_a_bare_port_in_python_tells_that_it_is_stopped(self):
        self.start_ring([dict(node, cpu='attached') for node in plain_nodes(2)])
        cpu = self.port(1, role='cpu')
        for stopped in True, False:
            cpu.tell_stopped(stopped)
            self.wait('known', lambda: self.answered(1)['cpu']['stop']['latched'] is stopped)

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
                self.warns(words)  # also of a CPU that has ended by it
                self.ctl('down')

    def test_a_node_that_obeys_none_of_its_commands_is_reported_with_the_reason(self):
        for firmware, why in ((DEAF, 'neither takes nor refuses them'),
                              (FIRMWARE % ('', 'lambda dt, goals: [0.0]'), 'it refuses them')):
            with self.subTest(why):
                self.start_knee(firmware)
                self.wait_cpu(1, 'running')
                body = self.port(0, role='cpu')

                def told():
                    # Too many joints: JointNode refuses them.
                    body.send(1, JointCommand([JointCommand.Joint(position=0.1)] * 2, valid_for=1))
                    return any('obeys none: ' in text and why in text for text in self.warnings())
                self.wait('told', told)
                self.ctl('down')

    def test_joint_packets_that_do_not_fit_and_a_silent_sensor_are_reported_and_counted_once(self):
        nodes = plain_nodes(2)
        nodes[0]['cpu'] = 'attached'
        nodes[1].update(cpu='attached', joints=[KNEE], sensors=[dict(name='foot', kind='imu')])
        self.start_ring(nodes)
        self.start('cpu', [sys.executable, self.write('two.py', DEAF.replace('(0)]', '(0)] * 2')), self.ring, 'node1'])
        self.warns('its CPU sends the state of 2 joints, and the ring\'s file gives it 1')
        self.warns('its CPU runs and sends no readings of foot')
        self.assertEqual(self.answered(1)['counters']['cpu_warnings'], 2)

    def test_a_step_that_takes_longer_than_its_period_is_reported_once(self):
        cpu = self.start_knee(FIRMWARE % ('', 'lambda dt, goals: time.sleep(0.015) or [0.0]'))
        self.says(cpu, 'step() takes longer than what it steps over')
        self.says(cpu, 'states and sensor readings are left out')
        self.warns('step() takes longer than what it steps over', cpu='running')

    def test_a_step_that_sleeps_on_a_virtual_clock_is_reported_in_status(self):
        nodes = plain_nodes(2)
        nodes[0]['cpu'] = 'attached'
        firmware = self.write('knee.py', FIRMWARE % ('', 'lambda dt, goals: time.sleep(0.015) or [0.0]'))
        nodes[1].update(cpu={'command': [sys.executable, firmware]}, joints=[KNEE])
        up = self.ctl('up', self.write_ring(nodes), '--detach', '--clock', 'virtual', '--timeout', '60')
        self.assertEqual(up.returncode, 0, up.stderr)
        self.warns('the virtual ring waits for it; do not sleep in it, time is dt')
        self.assertIn('do not sleep in it', self.ctl('log', 'node1').stdout)


if __name__ == '__main__':
    unittest.main(verbosity=2)
