#!/usr/bin/env python3
"""The node in C over UDP in a ring with two daemons: traffic, interrupts, restarts, a broken line."""

import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, '..', '..', 'test', 'process'))

import ring_process
from ring_process import RingTest, free_udp_ports, plain_nodes, program

TINY = 2


class TinyNodeInARing(RingTest):
    """Nodes 0 and 1 are daemons, node 2 is the one in C."""

    def setUp(self):
        super().setUp()
        self.first_port = free_udp_ports(3)
        # The node in C has the default times, and no file that says otherwise.
        defaults = {'silence': '250ms', 'stall': '50ms', 'send': '100ms'}
        nodes = plain_nodes(3)
        nodes[0]['cpu'] = 'attached'
        self.config = self.write_ring(nodes, timeouts=defaults, links={'transport': 'udp', 'port': self.first_port})
        self.daemons = {}
        for node in (0, 1):
            self.daemons[node] = self.ringd(self.config, node)
        self.tiny = self.start_tiny()
        self.wait('ring of 3', lambda: self.daemons_see(3, 'up'))

    def start_tiny(self):
        return self.start('tiny_node_udp', [program('tiny_node_udp'), self.ring, str(TINY), str(self.first_port), '0,1,2'])

    def daemons_see(self, size, state):
        return all(row and row['state'] == state and row['ring_size'] == size for row in map(self.row, (0, 1)))

    def assert_all_reach_it(self):
        for source in (0, 1):
            self.wait('it delivers', lambda source=source: self.delivered(source, 20) == 20)

    def delivered(self, source, count):
        return self.port(source).ask({'do': 'ping', 'to': TINY, 'count': count, 'size': 511})['delivered']

    def test_all_reach_it_and_nothing_is_damaged(self):
        self.assert_all_reach_it()
        for node in (0, 1):
            for bad in ('crc_errors', 'malformed_packets', 'input_unknown_peers', 'input_malformed'):
                self.assertEqual(self.counters(node)[bad], 0, bad)

    def test_it_sends_back_what_it_gets(self):
        port = self.port(0, role='cpu')
        self.wait('it comes back', lambda: port.wait(port.send(TINY, b'knee!')).outcome == 'delivered' and
                  port.receive(1.0) is not None)

    def test_its_pins_are_pulled(self):
        port = self.port(0)
        self.wait('delivered', lambda: port.wait(port.interrupt(TINY, 2)).outcome == 'delivered')
        self.assertEqual(port.wait(port.interrupt(TINY, 7)).outcome, 'refused')

    def test_it_may_die_and_come_back(self):
        self.assert_all_reach_it()
        self.tiny.kill()
        self.tiny.wait()
        self.wait('bypassed', lambda: self.daemons_see(2, 'up'))
        self.tiny = self.start_tiny()
        self.wait('ring of 3', lambda: self.daemons_see(3, 'up'))
        self.assert_all_reach_it()

    def test_its_neighbours_may_die_and_come_back(self):
        for node in (0, 1):
            self.daemons[node].kill()
            self.daemons[node].wait()
            self.wait('bypassed', lambda node=node: self.row(1 - node) and self.row(1 - node)['ring_size'] == 2)
            self.daemons[node] = self.ringd(self.config, node)
            self.wait('ring of 3', lambda: self.daemons_see(3, 'up'))
        self.assert_all_reach_it()

    def test_a_line_to_it_may_break_and_be_mended(self):
        fault = self.port(1)
        fault.ask({'do': 'fault', 'fault': 'cut node1:node2'})
        self.wait('open chain', lambda: self.daemons_see(3, 'open_chain'))
        fault.ask({'do': 'fault', 'fault': 'heal node1:node2'})
        self.wait('ring of 3', lambda: self.daemons_see(3, 'up'))
        self.assert_all_reach_it()

    def test_the_line_to_it_may_drop_double_and_damage_packets(self):
        for fault in ('drop node1:node2 once_in=5 seed=7', 'duplicate node1:node2 once_in=3 seed=7', 'corrupt node1:node2 once_in=5 seed=7'):
            answer = self.port(1).ask({'do': 'fault', 'fault': fault})
            self.assertTrue(answer.get('ok', True), answer)
            self.assert_all_reach_it()
            self.port(1).ask({'do': 'fault', 'fault': 'heal node1:node2'})


class ForeignNodeInAFile(RingTest):
    """`controller: foreign`: ringctl starts the others, and knows this one by its beacons."""

    def test_ringctl_starts_the_others_and_waits_for_it(self):
        port = free_udp_ports(3)
        nodes = plain_nodes(3)
        nodes[TINY].update(controller='foreign', name='mine', cpu='attached', joints=[{'name': 'knee'}])
        times = {'silence': '250ms', 'stall': '50ms', 'send': '100ms'}
        config = self.write_ring(nodes, timeouts=times, links={'transport': 'udp', 'port': port})
        out = self.ctl('up', config, '--detach').stdout
        self.addCleanup(lambda: self.ctl('down', self.ring))
        self.assertIn("all daemons are up (2), 2 of 3 are in the ring; 'ringctl wait up' waits for the foreign ones", out)
        told = self.ctl('check', config, '--foreign', 'mine').stdout.split()
        self.assertEqual(told[:-1], [self.ring, str(TINY), str(port), '0,1,2'])
        self.start('tiny_node_udp', [program('tiny_node_udp'), *told])
        self.assertEqual(self.ctl('--ring', self.ring, 'wait', 'up', '--timeout', '30').returncode, 0)
        rows = self.ctl_json('--ring', self.ring, 'status')['nodes']
        self.assertEqual([row['state'] for row in rows], ['up'] * 3)

    def test_what_it_is_told_needs_one_ring_one_node_and_ports_that_follow_from_its_id(self):
        nodes = plain_nodes(3)
        udp = self.write_ring(nodes, links={'transport': 'udp'})
        for words, said in (((udp, udp, '--foreign', 'node1'), 'name one FILE'),
                            ((udp, '--foreign', 'nod1'), "did you mean 'node1'?"),
                            ((self.write_ring(nodes), '--foreign', 'node1'), 'does not listen over UDP at links.port + its id')):
            done = self.ctl('check', *words)
            self.assertEqual((done.returncode, done.stdout), (2, ''), words)
            self.assertIn(said, done.stderr)


if __name__ == '__main__':
    ring_process.main()
