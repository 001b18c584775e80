#!/usr/bin/env python3
"""The node in C as a library on a virtual ring: in step with the ring's clock, the same each time."""

import os
import re
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, '..', '..', 'test', 'process'))

import ring_process
from ring_process import plain_nodes
from virtual_process import VirtualTest

TINY = 1
TIMES = {'silence': '250ms', 'stall': '50ms', 'send': '100ms'}  # the node in C has the default ones


class LibraryOnAVirtualRing(VirtualTest):
    """Of three nodes, 1 is the library; of five, 1 and 3 are."""

    def nodes(self, count=3):
        nodes = plain_nodes(count)
        for node in nodes[1:count - 1:2]:
            node.update(controller='foreign', library=os.environ['TINY_NODE_LIBRARY'])
        nodes[0]['cpu'] = 'attached'
        return nodes

    def start_ring_with_it(self, count=3):
        self.up(self.nodes(count), timeouts=TIMES, links={'transport': 'udp'})
        self.wait_whole(count)

    def ours(self, count):
        return [node for node in range(count) if node % 2 == 0]

    def wait_whole(self, count):
        self.wait('ring of %d' % count, lambda: all(row and row['state'] == 'up' and row['ring_size'] == count
                                                    for row in map(self.row, self.ours(count))))

    def ping(self, source, to):
        return self.port(source).ask({'do': 'ping', 'to': to, 'count': 20, 'size': 511})['delivered']

    def test_it_takes_packets_and_relays_those_of_others(self):
        self.start_ring_with_it(5)
        port = self.port(0, role='cpu')
        self.assertEqual(port.wait(port.send(TINY, b'knee?')).outcome, 'delivered')
        self.assertEqual(bytes(port.receive(5.0).data), b'knee?')
        self.assertEqual(port.wait(port.interrupt(TINY, 2)).outcome, 'delivered')
        self.assertEqual(port.wait(port.interrupt(TINY, 7)).outcome, 'refused')
        for source, to in ((0, 1), (4, 3), (2, 1), (0, 4), (4, 2)):
            self.assertEqual(self.ping(source, to), 20, (source, to))
        for node in self.ours(5):
            for bad in ('crc_errors', 'malformed_packets', 'stray_slices', 'ended_lost'):
                self.assertEqual(self.counters(node)[bad], 0, (node, bad))

    def test_status_knows_it_by_its_beacons(self):
        self.start_ring_with_it()
        rows = {row['id']: row for row in self.ctl_json('--ring', self.ring, 'status')['nodes']}
        self.assertEqual(rows[TINY]['state'], 'up')
        refused = self.ctl('--ring', self.ring, 'fault', 'hang', 'node1')
        self.assertEqual(refused.returncode, 3)
        self.assertIn('has no daemon on this host', refused.stderr)

    def test_it_and_its_neighbours_die_stand_still_and_come_back(self):
        self.start_ring_with_it(5)
        for node in (1, 0, 2):
            for off, on in (('kill', 'start'), ('freeze', 'thaw')):
                self.ring_ctl('fault', off, 'node%d' % node)
                rest = [each for each in self.ours(5) if each != node]
                self.wait('%s: bypassed' % off, lambda rest=rest: all(row['ring_size'] == 4 for row in map(self.row, rest)))
                self.ring_ctl('fault', on, 'node%d' % node)
                self.wait_whole(5)
                self.wait('it delivers', lambda: self.ping(4, 1) == 20)

    def test_a_line_to_it_and_one_from_it_may_break_and_be_mended(self):
        self.start_ring_with_it(5)
        for line in ('node0:node1', 'node4:node0'):
            self.ring_ctl('fault', 'cut', line)
            self.wait('open chain', lambda: all(row['state'] == 'open_chain' for row in map(self.row, self.ours(5))))
            self.ring_ctl('fault', 'heal', line)
            self.wait_whole(5)
            self.wait('it delivers', lambda: self.ping(4, 1) == 20)

    def test_a_run_is_the_same_each_time(self):
        config = self.write_ring([dict(node, cpu={'command': ['echo_cpu']}) if node['id'] == 2 else node for node in self.nodes()],
                                 timeouts=TIMES, links={'transport': 'udp'})
        def run():
            done = self.ctl('up', config, '--clock', 'virtual', '--pace', 'max', '--for', '3s')
            self.assertEqual(done.returncode, 0, done.stderr)
            return re.search(r'trace hash (\S+) of 3\.0\d+ s$', done.stdout + done.stderr, re.MULTILINE).group(1)
        self.assertEqual(run(), run())

    def test_what_is_not_a_library_is_named(self):
        nodes = self.nodes()
        nodes[TINY]['library'] = self.write('no.so', 'text')
        config = self.write_ring(nodes, timeouts=TIMES, links={'transport': 'udp'})
        done = self.ctl('up', config, '--clock', 'virtual', '--detach', '--timeout', 20)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn('no.so is not a shared library for this machine', done.stdout + done.stderr)
        nodes[TINY]['library'] = 'nowhere.so'
        done = self.ctl('check', self.write_ring(nodes))
        self.assertIn('there is no file', done.stderr)
        nodes[TINY].update(library=os.environ['TINY_NODE_LIBRARY'], controller='ringd')
        self.assertIn('controller: foreign beside it', self.ctl('check', self.write_ring(nodes)).stderr)


if __name__ == '__main__':
    ring_process.main()
