"""The examples' joint after a stop that came on its way: what resumes it gives no goal, and it does not move."""
import os
import sys
import unittest

import ring_process
from ring_process import GUARD, RingTest, plain_nodes, program
from limb_ring import JointCommand, JointState, Packet

EXAMPLES = os.path.join(os.path.dirname(ring_process.CONFIG), 'examples')
FAR = 1000.0   # rad: on its way there for minutes


class ResumedJoint(RingTest):
    def test_in_cpp(self):
        self.stays_after_a_resume(program('joint_cpu'))

    def test_in_python(self):
        self.stays_after_a_resume(sys.executable, os.path.join(EXAMPLES, 'joint_cpu.py'))

    def stays_after_a_resume(self, *command):
        nodes = plain_nodes(2)
        nodes[0]['cpu'] = 'attached'
        nodes[1].update(cpu='attached', joints=[dict(name='knee', lower=-2, upper=FAR, velocity=4, effort=10)])
        self.start_ring(nodes)
        self.start('cpu', [*command, self.ring, 'node1'])
        self.wait_cpu(1, 'running')
        self.body, self.seen_ns = self.port(0, role='cpu'), 0
        self.obeys(JointCommand([JointCommand.Joint(position=FAR)], valid_for=60))
        self.first_state(lambda state: state.joints[0].position > 0.1)
        self.assertEqual(self.ctl('stop', 'node1').returncode, 0)
        stopped_at = self.first_state(lambda state: state.mode.stopped).joints[0].position
        self.obeys(JointCommand(resume=True, valid_for=60))
        resumed = self.first_state(lambda state: not state.mode.stopped)
        for state in [resumed] + [self.first_state() for _ in range(10)]:
            self.assertEqual((state.joints[0].position, state.mode.commanded), (stopped_at, False))
        self.obeys(JointCommand([JointCommand.Joint(position=FAR)], valid_for=60))
        self.first_state(lambda state: state.joints[0].position > stopped_at)

    def obeys(self, command):
        self.assertEqual(self.body.wait(self.body.send(1, command)).outcome, 'delivered')

    def first_state(self, wanted=lambda state: True):
        """The first one that was sampled after the one before."""
        def is_it(message):
            state = message.payload if isinstance(message, Packet) else None
            return isinstance(state, JointState) and state.stamp_ns > self.seen_ns and wanted(state)

        state = self.body.find(is_it, timeout=GUARD).payload
        self.seen_ns = state.stamp_ns
        return state


if __name__ == '__main__':
    unittest.main(verbosity=2)
