"""Faults on a living line: each takes effect before it is answered, is listed, is removed, and the ring is
whole again."""

import ring_process
from fault_process import QUICK, FaultTest
from ring_process import plain_nodes


class Lines(FaultTest):
    def cut_and_heal(self, nodes):
        self.start_ring(nodes, timeouts=QUICK)
        cut = self.begin('cut', 'node1:node2')
        self.assertEqual(cut, ['node1.1'])
        attempts = self.answered(1)['counters']['output_attempts']
        self.assertEqual(self.answered(1)['output']['state'], 'down')  # at once
        self.wait('break located by all', lambda: all(
            (self.answered(i)['broken_line'] or {}).get('behind') == 2 for i in range(len(nodes))))
        row = self.answered(2)
        self.assertEqual((row['state'], row['broken_line']['before']), ('open_chain', 1))
        text = self.ctl('status').stdout
        self.assertRegex(text, r'broken line node1 -> node2, [0-9.]+ s ago, announced [0-9.]+ s later\n')
        self.assertRegex(text, r'fault on purpose node1\.1: cut node1 -> node2')
        self.assertEqual(self.answered(1)['counters']['output_attempts'], attempts, 'it was bypassed')
        self.assertIn('cut node1 -> node2', self.fault('list'))
        self.fault('remove', 'node1.1')
        self.wait_closed(range(len(nodes)))
        self.assertEqual(self.listed(), {})
        self.assertNotIn('broken line', self.ctl('status').stdout)
        return row['broken_line']['announced_ms']

    def test_a_cut_unix_line_is_noticed_at_once_located_and_whole_again_when_removed(self):
        self.cut_and_heal(plain_nodes(4))

    def test_a_cut_udp_line_is_silent_located_and_whole_again_when_removed(self):
        detected = self.cut_and_heal(self.udp_nodes(4))
        self.assertGreaterEqual(detected, 300, 'the silence counts')

    def test_dropped_packets_are_sent_again_and_the_fault_ends_by_itself(self):
        self.start_ring(plain_nodes(3), timeouts={'send': '100ms'})
        self.assertEqual(self.begin('drop', 'node0 -> node1', '--packets', 3), ['node0.1'])
        self.assertEqual(self.ping(0, 2)['delivered'], 20)
        self.assertEqual(self.counters(0)['line_dropped'], 3)
        self.assertEqual(self.listed(), {})

    def test_a_noisy_line_is_shown_at_the_input_that_has_it_and_its_seed_is_told(self):
        self.start_ring(plain_nodes(3), timeouts={'send': '100ms'})
        said = self.fault('corrupt', 'node0:node1', '--once-in', 2, '--packets', 3)
        self.assertRegex(said, r'^node0\.1: corrupt node0 -> node1 packets=3 once_in=2 seed=[0-9]+\n$')
        self.wait('three packets hit', lambda: self.ping(0, 2) and not self.listed())
        self.assertEqual(self.counters(1)['crc_errors'], 3)
        text = self.ctl('status').stdout
        self.assertIn('noisy line node0 -> node1: 3 packets came in damaged', text)
        self.assertEqual(text.count('noisy line'), 1, text)

    def test_no_line_is_blamed_for_what_a_node_that_was_started_again_had_passed_on(self):
        self.start_ring(plain_nodes(3), timeouts={'send': '100ms'})
        self.fault('corrupt', 'node0:node1', '--once-in', 2, '--packets', 3)
        self.wait('three packets hit', lambda: self.ping(0, 2) and not self.listed())
        self.fault('power_cycle', 'node1')
        self.assertNotIn('noisy line', self.ctl('status').stdout)

    def test_truncated_and_doubled_packets_are_neither_lost_nor_taken_twice(self):
        self.start_ring(plain_nodes(3), timeouts={'send': '100ms'})
        received = self.answered(2)['received']
        self.begin('truncate', 'node0:node1', '--packets', 2)
        self.begin('duplicate', 'node1:node2', '--packets', 5)
        self.assertEqual(self.ping(0, 2)['delivered'], 20)
        self.assertEqual(self.answered(2)['received'], received + 20)
        self.assertEqual((self.counters(0)['line_truncated'], self.counters(1)['line_duplicated']), (2, 5))

    def test_a_late_datagram_is_discarded_and_sent_again(self):
        self.start_ring(self.udp_nodes(3), timeouts={'send': '100ms'})
        before = self.counters(1)
        self.begin('reorder', 'node0:node1', '--packets', 1)
        self.assertEqual(self.ping(0, 2)['delivered'], 20)
        after = self.counters(1)
        for counter in ('input_datagrams_duplicate', 'input_datagrams_lost'):
            self.assertEqual(after[counter] - before[counter], 1, counter)

    def test_a_line_that_keeps_order_says_what_it_is(self):
        nodes = plain_nodes(3)
        nodes[2]['link'] = {'transport': 'unix'}
        self.start_ring(nodes)
        for line, what in (('node0:node1', 'from node0 to node1 is shared memory,'),
                           ('node1:node2', 'from node1 to node2 is a UNIX stream,')):
            refused = self.fault('reorder', line, '--packets', 2, code=1)
            self.assertIn(what + ' which keeps order; it needs a UDP line', refused)

    def test_delay_and_rate_make_round_trips_longer_until_removed(self):
        self.start_ring(plain_nodes(3))
        delay = self.begin('delay', 'node0:node1', '--delay', '20ms', '--jitter', '5ms')
        self.assertGreaterEqual(self.ping(0, 2, 5)['round_trip_us']['min'], 20000)
        self.assertGreaterEqual(self.listed()[delay[0]]['hits'], 5)
        self.fault('remove', delay[0])
        rate = self.begin('rate', 'node1:node2', '--rate', '1Mbit/s')
        self.assertGreaterEqual(self.ping(0, 2, 5)['round_trip_us']['min'], 524 * 8)
        self.fault('remove', rate[0])
        self.assertEqual(self.ping(0, 2)['delivered'], 20)

    def test_faults_that_end_while_they_are_listed_are_listed_whole_or_not_at_all(self):
        self.start_ring(plain_nodes(2))
        port, packets = self.port(0), 10 ** 6
        for i in range(60):
            port.ask({'do': 'fault', 'fault': 'delay node0 -> node1 delay=1us packets=%d for=%dms' % (packets, 100 + 2 * i)})
        rows = True
        while rows:
            rows = port.ask({'do': 'faults'})['faults']
            for row in rows:
                self.assertEqual(row['packets_left'] + row['hits'], packets, row)

    def test_a_short_stall_loses_nothing_and_a_long_one_is_a_broken_line(self):
        self.start_ring(plain_nodes(3), timeouts={'silence': '1s', 'first_successor': '50ms', 'break_grace': '50ms', 'send': '2s'})
        losses = self.counters(1)['input_losses']   # of a start in which one node was alone for a moment
        self.begin('stall', 'node0:node1', '--for', '200ms')
        done = self.ping(0, 2, 5)
        self.assertEqual(done['delivered'], 5)
        self.assertGreater(self.counters(0)['line_held'], 0)
        self.assertEqual(self.counters(1)['input_losses'], losses)
        stall = self.begin('stall', 'node0:node1')
        self.wait('broken line', lambda: (self.answered(1)['broken_line'] or {}).get('before') == 0)
        self.fault('remove', stall[0])
        self.wait_closed(range(3))

    def test_the_second_line_breaks_unnoticed_but_for_the_status_and_is_noisy_when_it_is_needed(self):
        self.start_ring(plain_nodes(4), timeouts=QUICK, redundancy='foldback')
        self.assertEqual(self.begin('cut', 'node2:node1'), ['node2.1'])
        said = 'broken second line node2 -> node1: the ring can fold back only around node1 -> node2'
        self.wait('shown', lambda: said in self.ctl('status').stdout)
        self.assertEqual({self.answered(i)['state'] for i in range(4)}, {'up'})
        self.begin('cut', 'node1:node2')
        self.wait('folded around it', lambda: {self.answered(i)['state'] for i in range(4)} == {'folded'})
        self.fault('heal', 'node1:node2')
        self.fault('heal', 'node2:node1')
        self.assertEqual(self.listed(), {})
        self.wait('whole', lambda: 'second line' not in self.ctl('status').stdout)
        self.begin('cut', 'node3:node0')
        self.wait('folded', lambda: {self.answered(i)['state'] for i in range(4)} == {'folded'})
        self.begin('drop', 'node2:node1', '--packets', 3)
        self.assertEqual(self.ping(0, 2)['delivered'], 20)
        self.assertEqual(self.counters(2)['line_dropped'], 3)
        self.fault('clear')
        self.wait_closed(range(4))

    def test_a_ring_without_a_second_line_says_so(self):
        self.start_ring(plain_nodes(3))
        self.assertIn('redundancy: foldback', self.fault('cut', 'node2:node1', code=2))

    def test_a_flapping_line_comes_and_goes(self):
        self.start_ring(plain_nodes(3), timeouts=QUICK)
        losses = self.counters(1)['input_losses']
        self.begin('flap', 'node0:node1', '--every', '200ms')
        self.wait('three times', lambda: self.counters(1)['input_losses'] >= losses + 3)
        self.fault('heal', 'node0:node1')
        self.wait_closed(range(3))
        self.assertEqual(self.listed(), {})

    def test_a_fault_waits_for_its_time_or_for_packets_of_a_node(self):
        self.start_ring(plain_nodes(3), timeouts=QUICK)
        self.begin('cut', 'node1:node2', '--after-packets', 10, '--of', 'node0')
        self.assertTrue(self.listed()['node1.1']['waits'])
        self.ping(1, 0)
        self.assertTrue(self.listed()['node1.1']['waits'], 'packets of another node')
        self.assertEqual(self.ping(0, 1, 9)['delivered'], 9)
        self.assertTrue(self.listed()['node1.1']['waits'])
        self.ctl('send', '--from', 'node0', '--to', 'node1', '--data', 'tenth')
        self.wait('cut', lambda: self.answered(1)['output']['state'] == 'down')
        self.fault('clear')
        self.wait_closed(range(3))
        self.begin('cut', 'node1:node2', '--after', '100ms', '--for', '100ms')
        self.wait('cut', lambda: self.answered(1)['output']['state'] == 'down')
        self.wait('its end', lambda: not self.listed())
        self.wait_closed(range(3))


if __name__ == '__main__':
    ring_process.main()
