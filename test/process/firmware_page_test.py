"""The program of docs/reference/host_port.md, as it stands there, is a CPU whose joint obeys and shows up."""
import os
import re
import struct
import sys
import time
import unittest

import ring_process
from ring_process import RingTest, plain_nodes
from limb_ring import Packet

PAGE = os.path.join(os.path.dirname(ring_process.CONFIG), 'docs', 'reference', 'host_port.md')


def program_of(page):
    with open(page) as file:
        found, = re.findall(r'^```python\n(.*?)^```', file.read(), re.M | re.S)
    return found


def command_to(position):
    return struct.pack('>BBHqIBBBi', 2, 1, 1, time.time_ns(), 10000000, 0, 1, 1, round(position * 1e6))


class FirmwarePage(RingTest):
    def test_its_program_obeys_a_command_and_sends_what_became_of_it(self):
        nodes = plain_nodes(3)
        nodes[0]['cpu'] = 'attached'
        nodes[1].update(cpu='attached', joints=[dict(name='knee', lower=-2, upper=2, velocity=4, effort=10)])
        self.start_ring(nodes)
        body = self.port(0, role='cpu')
        self.start('cpu', [sys.executable, self.write('foreign_cpu.py', program_of(PAGE)), self.ring, 'node1'])
        self.assertEqual(self.wait_cpu(1, 'running')['state'], 'running')
        self.assertEqual(body.wait(body.send(1, command_to(0.75), channel=2)).outcome, 'delivered')
        self.wait('a state at 0.75 rad', lambda: self.position_in(body) == 0.75)

    @staticmethod
    def position_in(body):
        packet = body.next_of(Packet)
        state = packet.payload
        return state.joints[0].position if state and len(state.joints) == 1 else None


if __name__ == '__main__':
    unittest.main(verbosity=2)
