"""The wall clock of a host is set while a joint is commanded, and the joint obeys every command all the same.
$SHIFTED_WALL_CLOCK is the library that shifts it, for the programs of this test alone."""
import os
import struct
import subprocess
import sys
import unittest

import ring_process
from ring_process import GUARD, RingTest, plain_nodes, program

# For each line of its input it commands the joint for 1.1 s at 100 Hz, and prints how many commands the joint has refused.
COMMANDER = '''
import sys, limb_ring
from limb_ring import JointCommand, JointState, Packet
sequence = 0
with limb_ring.HostPort.connect(ring=sys.argv[1], node='node0', role='cpu') as port:
    for line in sys.stdin:
        for _ in range(110):
            sequence = sequence + 1 & 0xFFFF
            sent = port.send(1, JointCommand([JointCommand.Joint(position=0.5)], sequence=sequence, valid_for=1), priority=0)
            assert port.wait(sent, 10).outcome == 'delivered'
            due = port.now() + 0.01
            while port.now() < due:
                port.receive(max(0.0, due - port.now()))   # else states would wait in the node, for long
        for _ in range(3):   # the first ones may be from before the last command
            state = port.find(lambda message: isinstance(message, Packet) and isinstance(message.payload, JointState))
        print(state.payload.refused, flush=True)
'''
EXAMPLES = os.path.join(os.path.dirname(ring_process.CONFIG), 'examples')


class ClockStep(RingTest):
    def setUp(self):
        super().setUp()
        self.shift = self.shift_clock(self.environment, 'WALL_CLOCK_SHIFT')

    def test_limb_firmware(self):
        self.obeys_across_steps(program('limb_firmware'), '--config', self.write_ring(self.nodes()), '--ring', self.ring, '--node', 'node1')

    def test_the_example_in_cpp(self):
        self.obeys_across_steps(program('joint_cpu'), self.ring, 'node1')

    def test_the_example_in_python(self):
        self.obeys_across_steps(sys.executable, os.path.join(EXAMPLES, 'joint_cpu.py'), self.ring, 'node1')

    def nodes(self):
        nodes = plain_nodes(2)
        nodes[0]['cpu'] = nodes[1]['cpu'] = 'attached'
        nodes[1].update(joints=[dict(name='knee', lower=-2, upper=2, velocity=4, effort=10)])
        return nodes

    def obeys_across_steps(self, *cpu):
        self.start_ring(self.nodes())
        self.start('cpu', cpu)
        self.wait_cpu(1, 'running')
        self.commander = subprocess.Popen([sys.executable, '-c', COMMANDER, self.ring], env=self.environment,
                                          stdin=subprocess.PIPE, stdout=subprocess.PIPE, universal_newlines=True)
        self.addCleanup(self.commander.stdout.close)
        self.addCleanup(self.commander.wait, GUARD)
        self.addCleanup(self.commander.stdin.close)
        self.all_obeyed()
        for seconds in 2, -3600, 0:
            self.all_obeyed(seconds)

    def all_obeyed(self, step_to=None):
        """The wall clock is set while the joint is commanded for longer than a process may believe in the clock of before."""
        self.commander.stdin.write('go\n')
        self.commander.stdin.flush()
        if step_to is not None:
            self.shift[:] = struct.pack('<q', step_to * 10 ** 9)
        self.assertEqual(self.commander.stdout.readline(), '0\n', 'refused; clock set to %s s' % step_to)


if __name__ == '__main__':
    unittest.main(verbosity=2)
