#!/usr/bin/env python3
"""The node in C on a Cortex-M3 that QEMU emulates, over its UART and ring_serial in a ring of daemons.
Exit code 77, skipped, without arm-none-eabi-gcc or qemu-system-arm."""

import os
import re
import shutil
import struct
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, '..', '..', 'test', 'process'))

import ring_process
from limb_ring import Interrupt, Packet
from ring_process import RingTest, free_udp_ports, plain_nodes, program

BOARD = 1
JOINT = {'name': 'knee', 'lower': -1.0, 'upper': 1.0, 'velocity': 6.0, 'effort': 80.0}
COMMAND, STATE = 2, 1   # on channel 2 (protocol.md section 9.3)
TINY = os.path.join(HERE, '..')


class BoardInARing(RingTest):
    """Nodes 0 and 2 are daemons, node 1 is the board."""

    def setUp(self):
        super().setUp()
        port = free_udp_ports(3)
        times = {'silence': '250ms', 'stall': '50ms', 'send': '100ms', 'command': '5s'}  # the board has the default ones
        nodes = plain_nodes(3)
        nodes[0].update(cpu='attached', pins={'3': 'notify'})
        nodes[BOARD].update(controller='foreign', cpu='attached', joints=[JOINT])
        config = self.write_ring(nodes, timeouts=times, links={'transport': 'udp', 'port': port})
        told = self.ctl('check', config, '--foreign', str(BOARD)).stdout.split()
        self.image = os.path.join(self.folder, 'board.elf')
        subprocess.run([os.path.join(TINY, 'board', 'build_board'), self.image, *told], check=True, stdout=subprocess.DEVNULL)
        self.board = self.start('qemu', ['qemu-system-arm', '-machine', 'lm3s6965evb', '-kernel', self.image, '-display', 'none',
                                         '-monitor', 'none', '-serial', 'pty'])
        self.wait('a terminal', self.terminal)
        self.start('ring_serial', [program('ring_serial'), self.terminal(), str(BOARD), str(port)])
        for node in (0, 2):
            self.ringd(config, node)
        self.wait('ring of 3', self.closed)

    def terminal(self):
        found = re.search(r'/dev/pts/\d+', self.log_of(self.board))
        return found and found.group(0)

    def closed(self):
        return all(row and row['state'] == 'up' and row['ring_size'] == 3 for row in map(self.row, (0, 2)))

    def test_it_takes_packets_and_relays_those_of_others(self):
        for source, to in ((0, BOARD), (2, BOARD), (0, 2)):
            self.wait('it delivers', lambda source=source, to=to:
                      self.port(source).ask({'do': 'ping', 'to': to, 'count': 20, 'size': 500})['delivered'] == 20)
        for node in (0, 2):
            for bad in ('crc_errors', 'malformed_packets', 'input_malformed'):
                self.assertEqual(self.counters(node)[bad], 0, bad)

    def test_its_reset_pin_starts_its_firmware_again(self):
        port = self.port(0)
        before = self.counters(2)['input_connects']
        self.wait('its pin is pulled', lambda: port.wait(port.interrupt(BOARD, 0)).outcome == 'delivered')
        self.wait('it has connected once more', lambda: self.counters(2)['input_connects'] > before)
        self.wait('ring of 3', self.closed)
        self.wait('it delivers', lambda: port.ask({'do': 'ping', 'to': BOARD, 'count': 5, 'size': 50})['delivered'] == 5)

    def test_its_joint_follows_commands(self):
        port, goal, sequence = self.port(0, role='cpu'), 500000, 0
        def there():
            nonlocal sequence
            sequence += 1
            command = struct.pack('>BBHqIBBBi', COMMAND, 1, sequence, time.time_ns(), 10 ** 6, 0, 1, 1, goal)
            port.send(BOARD, command, channel=2)
            state = port.receive(1.0)
            while state is not None and not (isinstance(state, Packet) and state.channel == 2):
                state = port.receive(1.0)
            return state and struct.unpack('>BB', state.data[:2]) == (STATE, 1) and \
                abs(struct.unpack('>i', state.data[16:20])[0] - goal) < 10
        self.wait('it is where it was told to be', there)

    def test_its_watchdog_pulls_a_pin_of_another_node_when_its_cpu_hangs(self):
        port = self.port(0, role='cpu')
        self.wait('it is told to hang', lambda: port.wait(port.send(BOARD, b'hang')).outcome == 'delivered')
        self.wait('its watchdog', lambda: isinstance(port.receive(1.0), Interrupt))
        self.assertEqual(port.wait(port.send(BOARD, b'you?')).outcome, 'refused')
        self.wait('its pin is pulled', lambda: port.wait(port.interrupt(BOARD, 0)).outcome == 'delivered')
        self.wait('it answers again', lambda: port.wait(port.send(BOARD, b'you?')).outcome == 'delivered')


if __name__ == '__main__':
    for needed in ('arm-none-eabi-gcc', 'qemu-system-arm'):
        if shutil.which(needed) is None:
            print('skipped: no %s; apt-get install gcc-arm-none-eabi qemu-system-arm' % needed)
            sys.exit(77)
    ring_process.main()
