"""Tools at a host port: own results, observers, status, shutdown."""

import os
import re
import resource
import subprocess

import ring_process
from ring_process import RingTest, plain_nodes
from limb_ring import BROADCAST, Disconnected, HostPortError, Observed, Packet, Result


def few_descriptors(limit):
    return lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (limit, limit))


class Tools(RingTest):
    def test_each_client_gets_its_own_results(self):
        self.start_ring(plain_nodes(3))
        clients = [self.port(0) for _ in range(5)]  # 50 sends: the queue holds 64
        tokens = [[client.send(1 + i % 2, b'%d' % i) for i in range(8 + c)]
                  for c, client in enumerate(clients)]
        for client, sent in zip(clients, tokens):
            results = [client.next_of(Result) for _ in sent]
            self.assertEqual([r.token for r in results], sent)
            self.assertEqual({r.outcome for r in results}, {'delivered'})
            self.assertIsNone(client.receive(0.05))

    def test_a_request_with_an_unknown_member_is_refused_by_name(self):
        self.start_ring(plain_nodes(2))
        port = self.port(0)
        self.assert_refused("ping: 'size_bytes' is unknown; it takes: count, deadline_ms, duration_ms, interval_us, "
                            'priority, size, to', port, {'do': 'ping', 'to': 1, 'size_bytes': 5})
        self.assert_refused("status: 'node' is unknown; it takes: heard", port, {'do': 'status', 'node': 1})
        self.assert_refused('heard: 0 is neither true nor false', port, {'do': 'status', 'heard': 0})
        self.assert_refused("clock: 'node' is unknown; it takes nothing", port, {'do': 'clock', 'node': 1})

    def test_a_status_row_says_what_was_heard_of_others_unless_it_is_asked_not_to(self):
        self.start_ring(plain_nodes(3))
        port = self.port(0)
        whole, less = port.ask({'do': 'status'}), port.ask({'do': 'status', 'heard': False})
        self.assertEqual([peer['id'] for peer in whole['heard']], [1, 2])
        self.assertEqual(set(whole) - set(less), {'heard'})

    def test_each_request_is_known_documented_and_answered(self):
        self.start_ring(plain_nodes(2))
        port = self.port(0)
        with self.assertRaises(HostPortError) as refused:
            port.ask({'do': 'dance'})
        known = str(refused.exception).split('there are ')[1].split(', ')
        page = os.path.join(os.path.dirname(__file__), '..', '..', 'docs', 'reference', 'requests.md')
        with open(page) as text:
            table = text.read().split('|---|---|---|')[1].split('\n\n')[0]
        columns = [[re.findall('`([a-z_]+)`', cell) for cell in row.split('|')[1:3]] for row in table.strip().split('\n')]
        members = {name: sorted(set(more)) for names, more in columns for name in names}
        self.assertEqual(known, sorted(members))
        for name in known:
            with self.assertRaisesRegex(HostPortError, "%s: 'nonsense' is unknown; it takes" % name) as refused:
                port.ask({'do': name, 'nonsense': 1})
            takes = str(refused.exception).split('it takes: ')[1:]
            self.assertEqual(takes[0].split(', ') if takes else [], members[name], name)
        known.remove('shutdown')
        for name in known + ['shutdown']:
            with self.subTest(request=name):
                try:
                    port.ask({'do': name})
                except HostPortError as error:  # says what is missing, or on which ring it can be done
                    self.assertRegex(str(error), 'missing|allowed|virtual|may say|no pin')

    def test_client_that_leaves_takes_its_sends_along(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = 'attached'  # absent: refuses, so sends wait
        self.start_ring(nodes, timeouts={'refused': '60s', 'queue': '60s'})
        leaving = self.port(0)
        for _ in range(30):
            leaving.send(1, b'never')
        self.wait('refusals', lambda: self.counters(0)['refusals'] > 0)
        leaving.close()
        self.wait('cancelled', lambda: self.counters(0)['ended_cancelled'] == 30)

    def test_full_send_queue_rejects_with_the_reason(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = 'attached'
        self.start_ring(nodes, limits={'send_queue': 4}, timeouts={'refused': '60s', 'queue': '60s'})
        port = self.port(0)
        for _ in range(10):
            port.send(1, b'full')
        result = port.next_of(Result)
        self.assertEqual(result.outcome, 'rejected')
        self.assertIn('queue', result.reason)

    def test_observer_sees_what_happens(self):
        nodes = plain_nodes(3)
        nodes[1].update(cpu='attached', pins={'3': 'notify'})
        daemons = self.start_ring(nodes)
        observer = self.port(1)
        observer.observe('pin', 'state', 'link', 'cpu')
        observer.ask({'do': 'latch'})  # answered after it has become one
        self.ctl_json('interrupt', '--from', 0, '--to', 1, 3)
        seen = observer.next_of(Observed).content
        self.assertEqual((seen['kind'], seen['factor'], seen['source']), ('pin', 3, 0))
        cpu = self.port(1, role='cpu')
        self.assertEqual(observer.next_of(Observed).content['state'], 'running')
        daemons[2].kill()
        self.assertEqual(observer.next_of(Observed).content['kind'], 'link')
        cpu.close()

    def test_observer_is_told_of_noise_and_of_the_rings_size(self):
        daemons = self.start_ring(plain_nodes(3), timeouts={'first_successor': '50ms', 'break_grace': '50ms'})
        observer = self.port(1)
        observer.observe('ring', 'noise')
        self.assertEqual(observer.next_of(Observed).content['ring_size'], 3)
        self.port(0).ask({'do': 'fault', 'fault': 'corrupt node0 -> node1 packets=1 seed=1'})
        self.assertEqual(observer.next_of(Observed).content['crc_errors'], 1)
        daemons[2].kill()
        self.assertEqual(observer.next_of(Observed).content['ring_size'], 2)

    def test_observer_with_a_wrong_filter_is_told(self):
        self.start_ring(plain_nodes(2))
        observer = self.port(0)
        observer.observe_text('{"kinds": ["weather"]}')
        self.assertIn('weather', observer.next_of(Observed).content['error'])

    def test_status_holds_what_is_promised(self):
        daemons = self.start_ring(plain_nodes(3))
        daemons[2].kill()
        self.wait_closed([0, 1])
        status = self.ctl_json('status')
        self.assertEqual(status['ring'], self.ring)
        self.assertEqual([(n['id'], n['name'], n['state']) for n in status['nodes']],
                         [(0, 'node0', 'up'), (1, 'node1', 'up'), (2, 'node2', 'down')])
        row = status['nodes'][1]
        self.assertEqual((row['pid'], row['ring_size']), (daemons[1].pid, 2))
        self.assertLessEqual({'pid', 'boots', 'state'}, set(row['cpu']))
        self.assertLessEqual({'p50', 'p99', 'max'}, set(row['round_trip_us']))
        self.assertGreater(row['counters']['relayed_data'], 0)

    def test_without_descriptors_no_living_node_is_shown_as_down(self):
        self.start_ring(plain_nodes(8))
        unanswered = 0
        for limit in range(4, 14):
            status = self.ctl('status', preexec_fn=few_descriptors(limit))
            self.assertNotIn(' down ', status.stdout)
            if status.returncode != 0 or 'unanswered' in status.stdout:
                self.assertIn('Too many open files', status.stdout + status.stderr)
                unanswered += 1
        self.assertGreater(unanswered, 0)

    def test_a_daemon_with_too_few_descriptors_says_so_in_its_log_and_its_status(self):
        words = r'only 48 file descriptors may be open \(ulimit -n\), this node needs up to \d+'
        config = self.write_ring(plain_nodes(2))
        up = self.ctl('up', config, '--detach', '--timeout', 60, preexec_fn=few_descriptors(48))
        self.addCleanup(self.ctl, 'down', self.ring)
        self.assertEqual(up.returncode, 0, up.stderr)
        self.assertRegex(self.ctl('status').stdout, 'node0, node1: ' + words)
        with open(os.path.join(self.ring_folder(), '0.log')) as log:
            self.assertEqual(len(re.findall(words, log.read())), 1)

    def test_an_up_without_descriptors_fails_with_the_reason(self):
        config = self.write_ring(plain_nodes(2))
        for limit in range(4, 8):
            up = self.ctl('up', config, '--detach', preexec_fn=few_descriptors(limit))
            self.assertEqual(up.returncode, 1, up.stderr)
            self.assertIn('Too many open files', up.stderr)

    def test_a_ring_that_is_frozen_as_a_whole_is_shown_and_thawed(self):
        daemons = self.start_ring(plain_nodes(3))
        for daemon in daemons.values():
            self.stop_process(daemon.pid)
        status = self.ctl('status')
        self.assertEqual((status.returncode, status.stderr), (0, ''))  # it would say whom it waits for
        self.assertEqual([row['state'] for row in self.ctl_json('status')['nodes']], ['frozen'] * 3)
        stop = self.ctl('stop')
        self.assertEqual(stop.returncode, 3, stop.stdout)
        self.assertRegex(stop.stderr, "no daemon of ring .* answers: 3 nodes frozen; 'ringctl fault clear' thaws them")
        self.assertEqual(self.ctl('fault', 'clear').returncode, 0)
        self.wait_closed(range(3))

    def test_a_fault_at_several_nodes_says_where_it_was_done(self):
        nodes = plain_nodes(3)
        for node in nodes[1:]:
            node['cpu'] = {'command': ['echo_cpu']}
        self.start_ring(nodes)
        for node in (1, 2):
            self.wait_cpu(node, 'running')
        part = self.ctl('fault', 'hang', 'node0', 'node2')   # node0 has no CPU
        self.assertEqual(part.returncode, 1, part.stderr)
        self.assertEqual(part.stdout, 'node2.1: hang node2\n')
        self.assertIn('CPU', part.stderr)
        self.assertEqual(self.ctl('fault', 'clear').returncode, 0)

    def test_shutdown_ends_the_daemon_cleanly(self):
        daemons = self.start_ring(plain_nodes(2))
        self.assertEqual(self.port(1).ask({'do': 'shutdown'}), {})
        self.assertEqual(self.wait_exit(daemons[1]), 0)
        self.assertFalse(os.path.exists(self.socket_of(1)))

    def test_sends_under_way_end_when_the_daemon_goes(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = 'attached'
        daemons = self.start_ring(nodes, timeouts={'refused': '60s', 'queue': '60s'})
        port = self.port(0)
        waits = port.send(1, b'waits')
        daemons[0].terminate()
        self.assertTrue(port.next_of(Disconnected).reason)
        self.assertEqual(port.wait(waits).outcome, 'cancelled')
        self.assertEqual(self.wait_exit(daemons[0]), 0)

    def test_totals_are_shown_even_if_the_daemon_ends(self):
        daemons = self.start_ring(plain_nodes(3))
        for arguments in (['ping', '-q', '--to', '1', '--from', '0', '-f'],
                          ['ping', '--json', '--to', '1', '--from', '0', '-f', '-c', '1000000'],
                          ['send', '--from', '0', '--to', '1', '--size', '8', '-c', '1000000']):
            before = self.answered(1)['received']
            tool = self.start(arguments[0], [ring_process.program('ringctl')] + arguments)
            self.wait('some to arrive', lambda: self.answered(1)['received'] > before + 10)
            daemons[0].kill()
            self.assertEqual(self.wait_exit(tool), 3, self.log_of(tool))
            self.assertRegex(self.log_of(tool), r'delivered')
            self.assertIn('ringctl: ', self.log_of(tool).splitlines()[-1])
            daemons[0] = self.ringd(os.path.join(self.folder, 'ring.yaml'), 0)
            self.wait_closed(range(3))

    def test_a_command_whose_output_nobody_reads_ends_even_on_a_quiet_ring(self):
        self.start_ring(plain_nodes(2))
        for words in (['traffic', 'events', '0', '--kinds', 'cpu'], ['traffic', 'show', '0', '--kind', 'interrupt']):
            command = [ring_process.program('ringctl'), '--ring', self.ring] + words
            shown = subprocess.Popen(command, env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                     stderr=subprocess.DEVNULL)
            self.addCleanup(shown.kill)
            shown.stdout.close()
            self.wait_exit(shown)

    def test_a_daemon_that_dies_during_a_request_is_named(self):
        daemons = self.start_ring(plain_nodes(3))
        # No stop comes home: its answer would be waited for.
        self.assertEqual(self.ctl('--ring', self.ring, 'fault', 'freeze', 'node1').returncode, 0)
        stop = self.start('stop', [ring_process.program('ringctl'), '--ring', self.ring, 'stop', '--from', 'node0'])
        self.wait('it to wait', lambda: 'waiting for node 0 (node0)' in self.log_of(stop))
        daemons[0].kill()
        self.assertEqual(self.wait_exit(stop), 3)
        self.assertIn('node 0 (node0) of ring %s: the daemon has closed the connection' % self.ring, self.log_of(stop))

    def test_packet_to_oneself_and_packet_to_all(self):
        nodes = plain_nodes(3)
        for node in nodes:
            node['cpu'] = 'attached'
        self.start_ring(nodes)
        cpus = [self.port(node, role='cpu') for node in range(3)]
        own = cpus[0].send(0, b'to me', priority=1, channel=5)
        self.assertEqual(cpus[0].wait(own).outcome, 'delivered')
        packet = cpus[0].next_of(Packet)
        self.assertEqual((packet.source, packet.destination, packet.priority, packet.channel), (0, 0, 1, 5))
        self.assertEqual(packet.data, b'to me')
        cpus[0].send(BROADCAST, b'to all')
        for cpu in cpus[1:]:
            self.assertEqual(cpu.next_of(Packet).data, b'to all')
        with self.assertRaises(TimeoutError):
            cpus[0].next_of(Packet, timeout=0.05)  # not received by its source


if __name__ == '__main__':
    ring_process.main()
