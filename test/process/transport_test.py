"""UNIX links, shared memory and UDP, in any mix, and a line slow enough to see who overtakes whom."""

import contextlib
import json
import os
import re
import signal

import ring_process
from ring_process import RingTest, free_udp_ports, plain_nodes
from limb_ring import Result

SEEN_SOON = {'silence': '500ms'}  # UDP tells of no end


class Transport(RingTest):
    def assert_carries(self, count):
        for node in range(count):
            ping = self.ctl_json('ping', '--from', node, '--to', (node + 2) % count, '--count', 100)
            self.assertEqual(ping['delivered'], 100)

    def test_unix_and_udp_links_in_one_ring(self):
        ports = free_udp_ports(4)
        nodes = plain_nodes(4)
        for node in (1, 2):
            nodes[node]['link'] = {'transport': 'udp', 'port': ports + node}
        daemons = self.start_ring(nodes, links={'transport': 'unix'}, timeouts=SEEN_SOON)
        self.assert_carries(4)
        self.assertGreater(self.counters(1)['input_datagrams'], 0)
        self.assertEqual(self.counters(3)['input_datagrams'], 0)
        daemons[2].kill()  # now the UDP sender goes on over UNIX
        self.wait_closed([0, 1, 3])
        self.ringd(os.path.join(self.folder, 'ring.yaml'), 2)
        self.wait_closed(range(4))
        self.assert_carries(4)

    def test_shared_memory_mixes_with_the_others(self):
        nodes = plain_nodes(4)
        nodes[2]['link'] = {'transport': 'udp', 'port': free_udp_ports(1)}
        nodes[3]['link'] = {'transport': 'unix'}
        daemons = self.start_ring(nodes, timeouts=SEEN_SOON)
        self.assert_carries(4)
        self.wait('a beat through shared memory', lambda: self.counters(1)['input_beats'] > 0)
        self.assertEqual([self.counters(node)['input_beats'] for node in (2, 3)], [0, 0])
        daemons[0].kill()  # the one before it goes on through shared memory, to the next
        self.wait_closed([1, 2, 3])
        self.assert_carries_between(1, 3)
        self.ringd(os.path.join(self.folder, 'ring.yaml'), 0)
        self.wait_closed(range(4))
        self.assert_carries(4)
        self.assertEqual(sum(self.counters(node)['input_queue_invalid'] for node in range(4)), 0)

    def assert_carries_between(self, source, to):
        ping = self.ctl_json('ping', '--from', source, '--to', to, '--count', 100)
        self.assertEqual(ping['delivered'], 100)

    def test_nodes_on_another_host_are_shown_by_their_beacons(self):
        """Another host is another runtime folder here."""
        config = self.write_ring(plain_nodes(4), links={'transport': 'udp', 'port': free_udp_ports(4)},
                                 timeouts=SEEN_SOON)
        here, there = self.runtime, os.path.join(self.folder, 'there')
        os.mkdir(there, 0o700)
        daemons = {}
        for node, host in ((0, here), (1, here), (2, there), (3, there)):
            self.environment['XDG_RUNTIME_DIR'] = host
            daemons[node] = self.ringd(config, node)
        for host in (here, there):
            self.environment['XDG_RUNTIME_DIR'] = host
            whole = self.ctl('wait', 'up', '--timeout', 30)
            self.assertEqual(whole.returncode, 0, whole.stderr)
            rows = self.ctl_json('status')['nodes']
            self.assertEqual([row['state'] for row in rows], ['up'] * 4)
            self.assertEqual([row.get('elsewhere', False) for row in rows], [False, False, True, True]
                             if host == here else [True, True, False, False])
            self.assertIn('4 of 4 nodes up', self.ctl('status', '--watch', '--once', '--interval', '0.1').stdout)
        daemons[0].kill()
        gone = self.ctl('wait', 'node0', 'down', '--timeout', 30)
        self.assertEqual(gone.returncode, 0, gone.stderr)

    def test_udp_ring_with_a_kill_and_a_return(self):
        daemons = self.start_ring(plain_nodes(4), links={'transport': 'udp', 'port': free_udp_ports(4)},
                                  timeouts=SEEN_SOON)
        self.assert_carries(4)
        daemons[1].kill()
        self.wait_closed([0, 2, 3])
        self.ringd(os.path.join(self.folder, 'ring.yaml'), 1)
        self.wait_closed(range(4))
        self.assert_carries(4)

    def test_udp_between_hosts_each_with_a_folder_and_an_address_of_its_own(self):
        nodes = plain_nodes(3)
        for node, address in zip(nodes, ('127.0.0.2', '127.0.0.2', '127.0.0.3')):
            node['link'] = {'address': address}
        config = self.write_ring(nodes, links={'transport': 'udp', 'port': free_udp_ports(3)}, timeouts=SEEN_SOON)
        for node in (0, 1):
            self.ringd(config, node)
        here, there = self.runtime, os.path.join(self.folder, 'other_host')
        os.mkdir(there, 0o700)
        self.environment['XDG_RUNTIME_DIR'] = there
        self.ringd(config, 2)
        self.environment['XDG_RUNTIME_DIR'] = here
        self.wait('ring closed', lambda: all(row and row['state'] == 'up' and row['ring_size'] == 3
                                             for row in map(self.row, (0, 1))))
        for end in (('--from', 0, '--to', 2), ('--from', 1, '--to', 'node2')):
            self.assertEqual(self.ctl_json('ping', *end, '--count', 100)['delivered'], 100)
        status = self.ctl_json('status')
        self.assertEqual([row.get('state') for row in status['nodes'][:2]], ['up', 'up'])

    def test_transport_by_argument(self):
        config = self.write_ring(plain_nodes(2), links={'port': free_udp_ports(2)})
        for node in range(2):
            self.ringd(config, node, '--transport', 'udp')
        self.wait_closed([0, 1])
        self.assertGreater(self.counters(0)['input_datagrams'], 0)

    def test_udp_port_that_is_taken_is_named(self):
        port = free_udp_ports(2)
        self.start_ring(plain_nodes(2), links={'transport': 'udp', 'port': port})
        path = self.write('other.yaml', json.dumps({
            'ring': self.ring + 'b', 'nodes': plain_nodes(2), 'links': {'transport': 'udp', 'port': port}}))
        second = self.run_ringd('--config', path, '--node', 1)
        self.assertEqual(second.returncode, 1)
        self.assertIn(str(port + 1), second.stderr)


def patient(text):
    for name, value in ring_process.PATIENT.items():
        text = re.sub(r'^  %s: \w+' % name, '  %s: %s' % (name, value), text, flags=re.MULTILINE)
    return text


class SlowLine(RingTest):
    @contextlib.contextmanager
    def stopped(self, node):
        daemon = self.daemons[node]
        self.stop_process(daemon.pid)
        try:
            yield
        finally:
            daemon.send_signal(signal.SIGCONT)

    def setUp(self):
        super().setUp()
        with open(os.path.join(ring_process.CONFIG, 'slow_line.yaml')) as shipped:
            config = self.write('slow.yaml', patient(shipped.read()))
        self.daemons = [self.ringd(config, node, '--ring', self.ring) for node in range(4)]
        self.wait_closed(range(4))

    def test_interrupt_sent_after_a_large_packet_ends_before_it(self):
        port = self.port(0)
        for _ in range(10):
            with self.stopped(0):   # so it finds both, whatever this process has to wait for
                data = port.send(2, bytes(512))
                interrupt = port.interrupt(2, 2)
            self.assertEqual([port.next_of(Result).token, port.next_of(Result).token], [interrupt, data])
        self.assertGreater(self.counters(0)['embedded_interrupts'], 0)

    def test_interrupt_overtakes_the_data_of_others(self):
        sender, other = self.port(3), self.port(0)
        data = [sender.send(2, bytes(512)) for _ in range(20)]
        interrupt = other.interrupt(2, 2)
        self.assertEqual(other.wait(interrupt).outcome, 'delivered')
        self.assertEqual([sender.wait(t).outcome for t in data], ['delivered'] * 20)

    def test_higher_priority_ends_first(self):
        port = self.port(0)
        tokens = [port.send(2, bytes(512), priority=3) for _ in range(6)]
        urgent = port.send(2, b'urgent', priority=0)
        order = [port.next_of(Result).token for _ in range(7)]
        self.assertLess(order.index(urgent), order.index(tokens[2]))
        self.assertEqual([t for t in order if t != urgent], tokens)


if __name__ == '__main__':
    ring_process.main()
