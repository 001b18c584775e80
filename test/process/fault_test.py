"""Faults on a living ring: each takes effect before it is answered, is listed, is removed, and the ring is
whole again."""

import os
import re

import ring_process
from ring_process import RingTest, free_udp_ports, is_gone, plain_nodes, process_state

QUICK = {'silence': '300ms', 'bypass': '50ms', 'send': '100ms'}


class FaultTest(RingTest):
    def fault(self, *arguments, code=0):
        done = self.ctl('fault', *arguments)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout if code == 0 else done.stderr

    def begin(self, *arguments):
        """Ids of the faults that last."""
        return [begun['id'] for begun in self.ctl_json('fault', *arguments)]

    def listed(self):
        return {fault['id']: fault for fault in self.ctl_json('fault', 'list')['faults']}

    def ping(self, source, target, count=20):
        return self.ctl_json('ping', '--from', source, '--to', target, '--count', count)

    def udp_nodes(self, count):
        first = free_udp_ports(count)
        return [dict(node, link={'transport': 'udp', 'port': first + node['id']}) for node in plain_nodes(count)]


class Lines(FaultTest):
    def cut_and_heal(self, nodes):
        self.start_ring(nodes, timeouts=QUICK)
        cut = self.begin('cut', 'node1:node2')
        self.assertEqual(cut, ['node1.1'])
        attempts = self.row(1)['counters']['output_attempts']
        self.assertEqual(self.row(1)['output']['state'], 'down')  # at once
        self.wait('break located by all', lambda: all(
            (self.row(i)['broken_line'] or {}).get('behind') == 2 for i in range(len(nodes))))
        row = self.row(2)
        self.assertEqual((row['state'], row['broken_line']['before']), ('open_chain', 1))
        text = self.ctl('status').stdout
        self.assertRegex(text, r'broken line node1 -> node2 since [0-9.]+ s, noticed after [0-9.]+ ms\n')
        self.assertRegex(text, r'fault on purpose node1\.1: cut node1 -> node2')
        self.assertEqual(self.row(1)['counters']['output_attempts'], attempts, 'it was bypassed')
        self.assertIn('cut node1 -> node2', self.fault('list'))
        self.fault('remove', 'node1.1')
        self.wait_closed(range(len(nodes)))
        self.assertEqual(self.listed(), {})
        self.assertNotIn('broken line', self.ctl('status').stdout)
        return row['broken_line']['noticed_ms']

    def test_a_cut_unix_line_is_noticed_at_once_located_and_whole_again_when_removed(self):
        self.cut_and_heal(plain_nodes(4))

    def test_a_cut_udp_line_is_silent_located_and_whole_again_when_removed(self):
        noticed = self.cut_and_heal(self.udp_nodes(4))
        self.assertGreaterEqual(noticed, 300, 'the silence counts')

    def test_dropped_packets_are_sent_again_and_the_fault_ends_by_itself(self):
        self.start_ring(plain_nodes(3), timeouts={'send': '100ms'})
        self.assertEqual(self.begin('drop', 'node0 -> node1', '--packets', 3), ['node0.1'])
        self.assertEqual(self.ping(0, 2)['delivered'], 20)
        self.assertEqual(self.counters(0)['line_dropped'], 3)
        self.assertEqual(self.listed(), {})

    def test_a_noisy_line_is_shown_at_the_input_that_has_it_and_its_seed_is_told(self):
        self.start_ring(plain_nodes(3), timeouts={'send': '100ms'})
        said = self.fault('corrupt', 'node0:node1', '--once-in', 2, '--packets', 4)
        self.assertRegex(said, r'^node0\.1: corrupt node0 -> node1 packets=4 once_in=2 seed=[0-9]+\n$')
        self.wait('four packets hit', lambda: self.ping(0, 2) and not self.listed())
        self.assertEqual(self.counters(1)['crc_errors'], 4)
        text = self.ctl('status').stdout
        self.assertIn('noisy line node0 -> node1: 4 packets came in damaged', text)
        self.assertEqual(text.count('noisy line'), 1, text)

    def test_truncated_and_doubled_packets_are_neither_lost_nor_taken_twice(self):
        self.start_ring(plain_nodes(3), timeouts={'send': '100ms'})
        received = self.row(2)['received']
        self.begin('truncate', 'node0:node1', '--packets', 2)
        self.begin('duplicate', 'node1:node2', '--packets', 5)
        self.assertEqual(self.ping(0, 2)['delivered'], 20)
        self.assertEqual(self.row(2)['received'], received + 20)
        self.assertEqual((self.counters(0)['line_truncated'], self.counters(1)['line_duplicated']), (2, 5))

    def test_a_late_datagram_is_discarded_and_sent_again(self):
        self.start_ring(self.udp_nodes(3), timeouts={'send': '100ms'})
        before = self.counters(1)
        self.begin('reorder', 'node0:node1', '--packets', 1)
        self.assertEqual(self.ping(0, 2)['delivered'], 20)
        after = self.counters(1)
        for counter in ('input_datagrams_duplicate', 'input_datagrams_lost'):
            self.assertEqual(after[counter] - before[counter], 1, counter)

    def test_a_unix_line_keeps_order_and_says_so(self):
        self.start_ring(plain_nodes(2))
        self.assertIn('needs a UDP line', self.fault('reorder', 'node0:node1', code=1))

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

    def test_a_short_stall_loses_nothing_and_a_long_one_is_a_broken_line(self):
        self.start_ring(plain_nodes(3), timeouts={'silence': '1s', 'bypass': '50ms', 'send': '2s'})
        self.begin('stall', 'node0:node1', '--for', '200ms')
        done = self.ping(0, 2, 5)
        self.assertEqual(done['delivered'], 5)
        self.assertGreater(self.counters(0)['line_held'], 0)
        self.assertEqual(self.counters(1)['input_losses'], 0)
        stall = self.begin('stall', 'node0:node1')
        self.wait('broken line', lambda: (self.row(1)['broken_line'] or {}).get('before') == 0)
        self.fault('remove', stall[0])
        self.wait_closed(range(3))

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
        self.wait('cut', lambda: self.row(1)['output']['state'] == 'down')
        self.fault('clear')
        self.wait_closed(range(3))
        self.begin('cut', 'node1:node2', '--after', '100ms', '--for', '100ms')
        self.wait('cut', lambda: self.row(1)['output']['state'] == 'down')
        self.wait('its end', lambda: not self.listed())
        self.wait_closed(range(3))


class Nodes(FaultTest):
    def test_a_killed_node_is_gone_when_answered_is_listed_and_started_again(self):
        daemons = self.start_ring(plain_nodes(4))
        self.assertEqual(self.begin('kill', 'node2'), ['node2.kill'])
        self.assertTrue(is_gone(daemons[2].pid))
        self.wait_closed([0, 1, 3])
        self.assertEqual(self.listed()['node2.kill']['fault'], 'kill node2')
        self.assertIn('no daemon', self.fault('freeze', 'node2', code=1))
        self.fault('start', 'node2')
        self.wait_closed(range(4))
        self.assertEqual(self.listed(), {})
        self.assertIn('runs already', self.fault('start', 'node2', code=1))

    def test_a_frozen_node_is_shown_as_frozen_and_goes_on_when_thawed(self):
        daemons = self.start_ring(plain_nodes(4), timeouts=QUICK)
        self.begin('freeze', 'node2')
        self.assertEqual(process_state(daemons[2].pid), 'T')
        self.wait_closed([0, 1, 3])
        self.assertRegex(self.ctl('status').stdout, r'(?m)^ *2 +node2 +frozen ')
        self.assertIn('is frozen', self.fault('cut', 'node2:node3', code=1))
        self.assertEqual(list(self.listed()), ['node2.freeze'])
        self.fault('thaw', 'node2')
        self.assertNotEqual(process_state(daemons[2].pid), 'T')
        self.wait_closed(range(4))
        self.assertEqual(self.listed(), {})

    def test_a_power_cycle_gives_a_new_boot_number_a_new_cpu_and_the_same_pid(self):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = {'command': ['limb_firmware']}
        daemons = self.start_ring(nodes)
        cpu, boot = self.wait_cpu(1, 'running')['pid'], self.row(1)['boot']
        self.fault('power_cycle', 'node1')
        row = self.row(1)
        self.assertGreater(row['boot'], boot)
        self.assertEqual((row['pid'], daemons[1].poll()), (daemons[1].pid, None))
        self.assertTrue(is_gone(cpu))
        self.wait_closed(range(3))
        self.assertNotEqual(self.wait_cpu(1, 'running')['pid'], cpu)
        self.assertEqual(self.ping(0, 1)['delivered'], 20)

    def test_a_power_cycle_of_all_over_udp_closes_the_ring_again(self):
        self.start_ring(self.udp_nodes(4), timeouts=QUICK)
        boots = [self.row(i)['boot'] for i in range(4)]
        self.fault('power_cycle', 'all')
        self.wait_closed(range(4))
        for i in range(4):
            self.assertGreater(self.row(i)['boot'], boots[i])

    def test_clear_ends_everything(self):
        self.start_ring(plain_nodes(5), timeouts=QUICK)
        self.begin('kill', 'node1')
        self.begin('freeze', 'node2')
        self.begin('drop', 'node3:node4', '--once-in', 1000)
        self.begin('not_reading', 'node4')
        self.assertEqual(sorted(self.listed()), ['node1.kill', 'node2.freeze', 'node3.1', 'node4.1'])
        self.fault('clear')
        self.assertEqual(self.listed(), {})
        self.wait_closed(range(5))


class Cpus(FaultTest):
    def start_limb(self, **cpu):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = dict({'command': ['limb_firmware']}, **cpu)
        self.start_ring(nodes)
        return self.wait_cpu(1, 'running')

    def test_a_hung_cpu_is_stopped_shown_and_goes_on(self):
        pid = self.start_limb()['pid']
        self.assertEqual(self.begin('hang', 'node1'), ['node1.1'])
        self.assertEqual(process_state(pid), 'T')
        self.assertRegex(self.ctl('status').stdout, r'(?m)^ *1 +node1 +up .* stopped ')
        self.assertEqual(self.listed()['node1.1']['fault'], 'hang node1')
        self.assertEqual(self.fault('resume', 'node1'), 'done: resume node1\n')
        self.assertNotEqual(process_state(pid), 'T')
        self.assertEqual(self.listed(), {})

    def test_a_hang_ends_with_its_time_or_with_a_reset(self):
        cpu = self.start_limb()
        self.begin('hang', 'node1', '--for', '100ms')
        self.wait('running again', lambda: process_state(cpu['pid']) != 'T')
        self.begin('hang', 'node1')
        self.fault('reset', 'node1')
        self.assertEqual(self.wait_cpu(1, 'running')['boots'], cpu['boots'] + 1)
        self.assertEqual(self.listed(), {})

    def test_a_crashed_cpu_is_gone_even_where_it_hung(self):
        pid = self.start_limb()['pid']
        self.begin('hang', 'node1')
        self.fault('crash', 'node1')
        self.assertTrue(is_gone(pid))
        self.wait('its end told', lambda: 'signal 11' in self.row(1)['cpu']['last_exit'])

    def test_an_attached_cpu_is_hit_as_well(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = 'attached'
        self.start_ring(nodes)
        firmware = self.start('cpu', [ring_process.program('limb_firmware'), '--ring', self.ring, '--node', '1',
                                      '--config', os.path.join(self.folder, 'ring.yaml')])
        self.wait_cpu(1, 'running')
        self.begin('hang', 'node1')
        self.assertEqual(process_state(firmware.pid), 'T')
        self.fault('clear')
        self.assertNotEqual(process_state(firmware.pid), 'T')

    def test_a_cpu_that_does_not_read_refuses_and_a_slow_one_takes_its_time(self):
        self.start_ring(plain_nodes(2), limits={'receive_buffers': 2}, timeouts={'refused': '50ms'})
        self.begin('not_reading', 'node1')
        port = self.port(0)
        outcomes = [port.result(port.send(1, b'x'))['outcome'] for _ in range(4)]
        self.assertEqual(outcomes, ['delivered', 'delivered', 'refused', 'refused'])
        self.fault('resume', 'node1')
        self.assertEqual(port.result(port.send(1, b'x'))['outcome'], 'delivered')
        slow = self.begin('slow', 'node1', '--every', '10s')
        self.wait('full again', lambda: port.result(port.send(1, b'x'))['outcome'] == 'refused')
        self.fault('remove', slow[0])
        self.assertEqual(port.result(port.send(1, b'x'))['outcome'], 'delivered')

    def test_a_babbling_cpu_is_counted_and_does_not_starve_the_others(self):
        self.start_ring(plain_nodes(3))
        babble = self.begin('babble', 'node1')
        self.wait('a hundred packets', lambda: self.listed()[babble[0]]['hits'] >= 100)
        self.assertEqual(self.ping(0, 2, 50)['delivered'], 50)
        self.fault('remove', babble[0])
        sent = self.counters(1)['sent_data']
        self.assertEqual(self.ping(0, 2, 200)['delivered'], 200)
        self.assertLess(self.counters(1)['sent_data'] - sent, 100, 'beacons alone')

    def test_a_node_without_a_process_has_nothing_to_hang(self):
        self.start_ring(plain_nodes(2))
        self.assertIn('no CPU', self.fault('hang', 'node1', code=1))


class Words(FaultTest):
    def test_help_has_one_line_for_every_fault(self):
        text = self.ctl('fault', '--help').stdout
        for word in ('cut heal drop corrupt truncate duplicate reorder delay rate stall flap kill start power_cycle '
                     'freeze thaw hang resume reset crash slow not_reading babble list remove clear').split():
            self.assertRegex(text, r'(?m)^  %s +\S' % re.escape(word))

    def test_wrong_words_are_refused_with_what_would_be_right(self):
        self.start_ring(plain_nodes(3))
        for arguments, what in (
                (('cut', 'node0:node2'), 'node0 -> node1'),
                (('cut', 'node0', '-'), "the shell has taken '>'"),
                (('drop', 'node0:nodf1'), "did you mean 'node1'"),
                (('drop', 'node0:node1', '--packets', 'few'), 'a whole number'),
                (('drop', 'node0:node1', '--after-packets', 5), 'of=NODE'),
                (('delay', 'node0:node1'), 'delay says no delay or jitter'),
                (('stall', 'node0:node1', '--for', 3), 'a time such as'),
                (('stall', 'node0:node1', '--packets', 3), '--packets'),
                (('hang',), 'WHERE'),
                (('explode', 'node1'), 'subcommand is required')):
            self.assertIn(what, self.fault(*arguments, code=2), arguments)
        self.assertIn('any more', self.fault('remove', 'node1.7', code=1))
        self.assertIn("no fault's id", self.fault('remove', 'seven', code=1))
        self.assertEqual(self.fault('list'), 'ring %s has no faults on purpose\n' % self.ring)

    def test_no_ring_is_exit_code_3(self):
        self.fault('list', code=3)


if __name__ == '__main__':
    ring_process.main()
