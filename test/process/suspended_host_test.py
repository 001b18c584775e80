"""A host of a ring is suspended: its monotonic clock stood, and what waits on the lines inside it is old to the others.
$SHIFTED_WALL_CLOCK is the library that lets CLOCK_BOOTTIME of that host's programs go on alone."""

import struct

import ring_process
from hosts_process import HostsTest


class SuspendedHost(HostsTest):
    def setUp(self):
        super().setUp()
        self.set_up_hosts('waist', 'head')
        self.shift = self.shift_clock(self.hosts['head'].environment, 'BOOT_CLOCK_SHIFT')

    def given_up(self):
        """Of each node of the suspended host, how often it has lost its input so."""
        rows = self.json_on('head', 'status', '--all')['nodes']
        return [row['counters']['input_given_up'] for row in rows if row['name'].startswith('head')]

    def sleep(self, seconds):
        self.shift[:] = struct.pack('=q', int(seconds * 1e9))

    def test_it_loses_its_lines_once_and_is_in_the_ring_again(self):
        self.up_all()
        self.assertEqual(self.given_up(), [0, 0])
        self.sleep(3600)
        self.wait('lost lines', lambda: self.given_up() == [1, 1])
        for host in self.hosts:
            self.on(host, 'wait', 'up', '--timeout', 30)
        self.on('waist', 'ping', 'head1', '--from', 'waist0', '-c', 100, '-f', '-q')
        self.assertEqual(self.given_up(), [1, 1])

    def test_nobody_notices_a_short_one(self):
        self.up_all()
        self.sleep(0.4)
        self.on('waist', 'ping', 'head1', '--from', 'waist0', '-c', 100, '-f', '-q')
        self.assertEqual(self.given_up(), [0, 0])


if __name__ == '__main__':
    ring_process.main()
