#!/usr/bin/env python3
"""The node in C on a Cortex-M3 that QEMU emulates, over its UART and ring_serial in a ring of daemons.
Exit code 77, skipped, without arm-none-eabi-gcc or qemu-system-arm."""

import os
import re
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, '..', '..', 'test', 'process'))

import ring_process
from ring_process import RingTest, free_udp_ports, plain_nodes, program

BOARD = 1
TINY = os.path.join(HERE, '..')


class BoardInARing(RingTest):
    """Nodes 0 and 2 are daemons, node 1 is the board."""

    def setUp(self):
        super().setUp()
        self.image = os.path.join(self.folder, 'board.elf')
        subprocess.run([os.path.join(TINY, 'board', 'build_board'), self.image, self.ring, str(BOARD), '3'], check=True,
                       stdout=subprocess.DEVNULL)
        port = free_udp_ports(3)
        times = {'silence': '250ms', 'stall': '50ms', 'send': '100ms'}  # the board has the default ones
        config = self.write_ring(plain_nodes(3), timeouts=times, links={'transport': 'udp', 'port': port})
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
        for source, to in ((0, BOARD), (2, BOARD), (0, 2), (2, 0)):
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


if __name__ == '__main__':
    for needed in ('arm-none-eabi-gcc', 'qemu-system-arm'):
        if shutil.which(needed) is None:
            print('skipped: no %s; apt-get install gcc-arm-none-eabi qemu-system-arm' % needed)
            sys.exit(77)
    ring_process.main()
