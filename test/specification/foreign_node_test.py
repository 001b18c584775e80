#!/usr/bin/env python3
"""A node that was written from docs/protocol.md alone closes a ring with two daemons, and all reach all; also around a
break, if the ring folds back."""

import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, '..', 'process'))

import foreign_node
from foreign_fold import FOLDED, UP
from foreign_links import END, INTERRUPT, START, TIMEOUTS, WHOLE, Line, agreement, slice_of
import ring_process
from ring_process import PATIENT, RingTest, free_udp_ports, plain_nodes

FOREIGN = 2
NAMES = ['node0', 'node1', 'node2']
TIMES = {**TIMEOUTS, **{name: int(time[:-1]) * 1000 for name, time in PATIENT.items()}}  # PATIENT is in s


class WithAForeignNode(RingTest):
    """Nodes 0 and 1 are daemons, node 2 is the foreign one."""

    node = None

    def wait(self, what, condition):
        return super().wait(what, lambda: self.runs() and condition())

    def runs(self):
        self.assertTrue(self.node is None or self.node.stopped or self.node.is_alive(), 'the node has ended')
        return True

    def start_daemons(self, **sections):
        config = self.write_ring(plain_nodes(3), **{'links': {'transport': 'unix'}, **sections})
        for node in (0, 1):
            self.ringd(config, node)
        self.wait('the daemons', lambda: all(self.row(node) for node in (0, 1)))

    def start_node(self, *lines):
        self.node = foreign_node.Node(*lines, last_boot=self.node.boot if self.node else 0)
        self.node.start()
        self.addCleanup(self.node.stop)
        self.wait('ring of 3 closed', lambda: self.node.joined and self.node.size == 3 and self.daemons_see(3, 'up'))

    def daemons_see(self, size, state):
        return all(row and row['state'] == state and row['ring_size'] == size for row in map(self.row, (0, 1)))

    def outcome(self, token):
        self.wait('an outcome', lambda: token in self.node.ended)
        return self.node.ended[token]

    def assert_all_reach_all(self):
        for source, destination in ((0, FOREIGN), (1, FOREIGN), (0, 1), (1, 0)):
            ping = self.port(source).ask({'do': 'ping', 'to': destination, 'count': 50, 'size': 511})
            self.assertEqual(ping['delivered'], 50, (source, destination))
        for destination in (0, 1, foreign_node.ALL):
            for _ in range(10):  # more than sequence numbers there are
                self.assertEqual(self.outcome(self.node.send(destination, b'abc')), 'delivered')
        for node in (0, 1):
            for bad in ('crc_errors', 'malformed_packets', 'duplicate_id_signs'):
                self.assertEqual(self.counters(node)[bad], 0, bad)


class ForeignNode(WithAForeignNode):
    def unix_line(self):
        return Line(self.ring, FOREIGN, [0, 1, 2], self.socket_of(FOREIGN, 'link'), self.socket_of(0, 'link'),
                    agreement(NAMES, timeouts=TIMES))

    def close_unix_ring(self):
        self.start_daemons()
        self.start_node(self.unix_line())

    def test_over_unix_lines(self):
        self.close_unix_ring()
        self.assert_all_reach_all()

    def test_over_udp_lines(self):
        ports = free_udp_ports(3)
        self.start_daemons(links={'transport': 'udp', 'port': ports})
        self.start_node(Line(self.ring, FOREIGN, [0, 1, 2], ('127.0.0.1', ports + FOREIGN), ('127.0.0.1', ports),
                             agreement(NAMES, timeouts=TIMES)))
        self.assert_all_reach_all()
        self.assertEqual(self.counters(0)['input_datagrams_lost'], 0)
        self.assertEqual(self.counters(0)['input_unknown_peers'], 0)

    def test_it_may_leave_and_come_back(self):
        self.close_unix_ring()
        self.assert_all_reach_all()
        self.node.stop()
        self.wait('bypassed', lambda: self.daemons_see(2, 'up'))
        port = self.port(0)
        self.assertEqual(port.wait(port.send(FOREIGN, b'x')).outcome, 'no such node')
        self.start_node(self.unix_line())
        self.assert_all_reach_all()

    def test_damage_stays_damage_all_the_way_round(self):
        self.close_unix_ring()
        with self.node.lock:
            self.node.write(WHOLE, self.damaged_packet())
        self.wait('both have counted it', lambda: all(self.counters(n)['crc_errors'] == 1 for n in (0, 1)))
        self.wait('it is back', lambda: self.node.damaged_returns == 1)

    def damaged_packet(self):
        covered = bytes([0, foreign_node.SOP, 0, FOREIGN]) + b'abcd' + bytes([foreign_node.EOP, 0xFF, 1, 0])
        return covered[:5] + b'X' + covered[6:] + foreign_node.crc(covered)

    # ---- what is said of it where it is wrong -----------------------------------------------

    def assert_told(self, words):
        """By status at node 0, which is downstream of it, and in the log of that."""
        def is_told():
            return 'node0: ' + words in ' '.join(self.ctl('--ring', self.ring, 'status').stdout.split())
        self.wait('the word in status: ' + words, is_told)
        self.assertIn(words, ''.join(self.log_of(process) for what, process in self.processes if what == 'ringd_0'))

    def test_it_is_named_if_it_does_not_count_hop(self):
        self.close_unix_ring()
        judge = self.start('judge', [ring_process.program('ringctl'), '--ring', self.ring, 'traffic', 'judge'])
        self.node.adds_hop = 0
        words = 'node2: HOP of packets of node1 is 0, 1 expected (protocol.md section 2.2)'
        self.assert_told(words)
        self.wait('the word of judge', lambda: words in self.log_of(judge))
        self.assertIn('3 of 3 nodes up, but by HOP the ring has 2', self.ctl('--ring', self.ring, 'status').stdout)

    def test_it_is_named_if_it_passes_nothing_on(self):
        self.close_unix_ring()
        self.node.relays = False
        self.assert_told('node2 passes nothing on: it hears node1, and only its own packets come (protocol.md section 2.2)')

    def test_it_is_named_if_it_sends_what_is_not_a_packet(self):
        self.close_unix_ring()
        with self.node.lock:
            self.node.write(WHOLE, bytes([0, 0, 0, 1]) + self.damaged_packet()[4:])
        self.assert_told('1 packet in 10 s from node2 with a wrong header or trailer, the last of source node1')
        with self.node.lock:
            for _ in range(21):
                self.node.write(END, b'abcdefgh')
        self.assert_told('21 slices in 10 s from node2 that belong to no packet')

    def test_data_priority_and_channel_arrive(self):
        self.close_unix_ring()
        port = self.port(1)
        self.assertEqual(port.wait(port.send(FOREIGN, b'knee!', priority=1, channel=4)).outcome, 'delivered')
        self.assertEqual(self.node.received, [(1, 1, 4, b'knee!')])

    def test_interrupts_pull_pins_both_ways(self):
        self.close_unix_ring()
        port = self.port(0)
        self.assertEqual(port.wait(port.interrupt(FOREIGN, 2)).outcome, 'delivered')
        self.assertEqual(self.node.pins, [(2, 0)])
        self.assertEqual(self.outcome(self.node.interrupt(0, 2)), 'delivered')  # pin 2: sync
        self.assertEqual(self.outcome(self.node.interrupt(0, 7)), 'refused')    # wired to nothing
        self.assertEqual(self.counters(0)['pins_pulled'], 1)

    def test_an_interrupt_is_taken_out_of_a_packet_and_both_go_on(self):
        self.close_unix_ring()
        for size in (1, 4, 21, 512):
            pulled = self.counters(1)['pins_pulled']
            data, interrupt = self.send_embedded(bytes(size))
            self.assertEqual(self.outcome(data), 'delivered')
            self.assertEqual(self.outcome(interrupt), 'delivered')
            self.assertEqual(self.counters(1)['pins_pulled'], pulled + 1)

    def send_embedded(self, data):
        """A DATP to node 0 leaves as `start` and `end` with an INTP to node 1 between them."""
        node, written = self.node, []
        node.transmit = lambda: None  # nothing leaves by itself
        self.wait('nothing outstanding', lambda: node.out == {False: None, True: None})
        with node.lock:
            node.queue[False].clear()  # a beacon
            tokens = node.send(0, data), node.interrupt(1, 2)
            write, node.line.output.write = node.line.output.write, written.append
            node.transmit_kind(False)
            node.transmit_kind(True)
            node.line.output.write = write
            packet, interrupt = (slice_[4:] for slice_ in written)
            words = 4 + len(data) // 4 * 4
            write(slice_of(START, packet[:words]) +
                  slice_of(INTERRUPT, interrupt) +
                  slice_of(END, packet[words:]))
            del node.transmit
        return tokens


class FoldingForeignNode(WithAForeignNode):
    """The ring has a second line, and one line of the first is cut."""

    def setUp(self):
        super().setUp()
        self.start_daemons(redundancy='foldback')
        folds = agreement(NAMES, 'foldback', TIMES)
        self.start_node(
            Line(self.ring, FOREIGN, [0, 1, 2], self.socket_of(FOREIGN, 'link'), self.socket_of(0, 'link'), folds),
            Line(self.ring, FOREIGN, [2, 1, 0], self.socket_of(FOREIGN, 'link2'), self.socket_of(1, 'link2'), folds))

    def assert_folds_and_unfolds(self, cut, heal, place):
        self.assert_all_reach_all()
        cut()
        self.wait('folded', lambda: self.daemons_see(3, 'folded') and place())
        self.assert_all_reach_all()
        heal()
        self.wait('unfolded', lambda: self.daemons_see(3, 'up') and self.node.fold.link_states() == (UP, UP))
        self.assert_all_reach_all()

    def fault(self, node, text):
        return lambda: self.port(node).ask({'do': 'fault', 'fault': text})

    def set_cut(self, value):
        def change():
            self.node.line.output.cut = value
        return change

    def test_it_takes_the_second_line_behind_a_break(self):
        self.assert_folds_and_unfolds(self.fault(1, 'cut node1:node2'), self.fault(1, 'heal node1:node2'),
                                      lambda: self.node.fold.link_states() == (FOLDED, UP))

    def test_it_turns_back_before_a_break(self):
        self.assert_folds_and_unfolds(self.set_cut(True), self.set_cut(False),
                                      lambda: self.node.fold.link_states() == (UP, FOLDED))

    def test_it_repeats_what_others_turned_back(self):
        self.assert_folds_and_unfolds(self.fault(0, 'cut node0:node1'), self.fault(0, 'heal node0:node1'),
                                      lambda: self.node.fold.repeats())
        self.assertGreater(self.node.fold.repeated, 0)


if __name__ == '__main__':
    ring_process.main()
