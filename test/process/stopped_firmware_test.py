"""The examples' joint, and that of docs/reference/host_port.md: after a while of standing still it makes up for no period, as it
would by states in a burst and steps in no time."""
import os
import signal
import sys
import time
import unittest

from firmware_page_test import PAGE, program_of
import ring_process
from ring_process import GUARD, RingTest, plain_nodes, program
from limb_ring import JointState, Packet

EXAMPLES = os.path.join(os.path.dirname(ring_process.CONFIG), 'examples')
PERIOD_NS = 10 ** 7
STANDS = 1.0   # s


class StoppedFirmware(RingTest):
    def test_in_cpp(self):
        self.makes_up_for_nothing(program('joint_cpu'))

    def test_in_python(self):
        self.makes_up_for_nothing(sys.executable, os.path.join(EXAMPLES, 'joint_cpu.py'))

    def test_from_the_page_alone(self):
        self.makes_up_for_nothing(sys.executable, self.write('foreign_cpu.py', program_of(PAGE)))

    def makes_up_for_nothing(self, *command):
        nodes = plain_nodes(2)
        nodes[0]['cpu'] = 'attached'
        nodes[1].update(cpu='attached', joints=[dict(name='knee', lower=-2, upper=2, velocity=4, effort=10)])
        self.start_ring(nodes)
        body = self.port(0, role='cpu')
        cpu = self.start('cpu', [*command, self.ring, 'node1'])
        before, _ = self.state_after(body, 0)
        stood_ns = self.stands_still(cpu)
        after, count = self.state_after(body, time.time_ns() + 20 * PERIOD_NS)
        ran_ns = after.stamp_ns - before.stamp_ns - stood_ns
        self.assertLessEqual(count, ran_ns / PERIOD_NS + 10)

    def stands_still(self, cpu):
        """For at least so long, ns."""
        self.stop_process(cpu.pid)
        since = time.time_ns()
        time.sleep(STANDS)
        stood = time.time_ns() - since
        cpu.send_signal(signal.SIGCONT)
        return stood

    def state_after(self, body, stamp_ns):
        """The first state that was sampled then or later, and how many came up to it."""
        count = 0
        while True:
            count += 1
            state = body.find(lambda message: isinstance(message, Packet) and isinstance(message.payload, JointState),
                              timeout=GUARD).payload
            if state.stamp_ns >= stamp_ns:
                return state, count


if __name__ == '__main__':
    unittest.main(verbosity=2)
