"""Unknown peers at the host port and at the links: the ring is not disturbed, and they are counted."""

import random
import socket
import struct

import host_port_wire
import ring_process
from ring_process import RingTest, free_udp_ports, plain_nodes
from limb_ring import HostPortError, Observed

LINK_HEADER = '>HBBQQIBB'  # daemon/io/link_header.h
AGREEMENT_SIZE = 56        # daemon/io/link_header.h
CONNECT, ACCEPT, REFUSE, SLICES, ALIVE, BYE = range(1, 7)
WRONG_VERSION = 7


def head(kind, ring=1, session=1, sequence=0, sender=0, refusal=0, version=3):
    connect = kind == CONNECT and version == 3
    return (struct.pack(LINK_HEADER, 0x4C52, version, kind, ring, session, sequence, sender, refusal) +
            bytes(AGREEMENT_SIZE if connect else 0))


def garbage(size):
    return random.Random(size).randbytes(size) if hasattr(random.Random, 'randbytes') else bytes(
        random.Random(size).getrandbits(8) for _ in range(size))


class UnknownPeer(RingTest):
    def connect(self, path):
        peer = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        peer.settimeout(ring_process.GUARD)
        peer.connect(path)
        self.addCleanup(peer.close)
        return peer

    def read_to_end(self, peer):
        """What it was told before it was thrown out; fails where it never is."""
        told = b''
        try:
            while True:
                data = peer.recv(4096)
                if not data:
                    return told
                told += data
        except ConnectionResetError:
            return told

    def say(self, path, data):
        peer = self.connect(path)
        try:
            peer.sendall(data)
        except (BrokenPipeError, ConnectionResetError):
            pass
        return self.read_to_end(peer)

    def quiet_ring(self, nodes=None, **sections):
        """Starts a ring, and remembers what nothing may change."""
        self.start_ring(nodes or plain_nodes(3), **sections)
        self.losses = [self.counters(node)['input_losses'] for node in range(3)]

    def assert_undisturbed(self):
        self.assertTrue(self.is_closed(range(3)))
        self.assertEqual([self.counters(node)['input_losses'] for node in range(3)], self.losses)
        self.assertEqual(self.ctl_json('ping', '--from', 0, '--to', 2, '--count', 200)['delivered'], 200)

    def test_garbage_on_the_host_port(self):
        self.quiet_ring()
        pieces = [b'GET / HTTP/1.1\r\n\r\n', b'\0' * 100, b'\xff' * 100, garbage(5000),
                  host_port_wire.frame(99, b'what'), host_port_wire.frame(host_port_wire.SEND, b'\1'),
                  struct.pack('>IB', 0x7fffffff, 1), struct.pack('>I', 0),
                  host_port_wire.greeting(self.ring) + host_port_wire.frame(77),
                  host_port_wire.greeting(self.ring) * 2,
                  host_port_wire.greeting(self.ring) + struct.pack('>IB', 2 ** 20, 2)]
        for piece in pieces:
            self.say(self.socket_of(1), piece)
        self.assertEqual(self.counters(1)['host_garbage'], len(pieces))
        self.assert_undisturbed()

    def test_half_open_connection_at_the_host_port_is_closed(self):
        self.quiet_ring()
        peer = self.connect(self.socket_of(1))
        peer.sendall(host_port_wire.greeting(self.ring)[:7])
        self.assertIn(b'greeting', self.read_to_end(peer))
        self.assertEqual(self.counters(1)['host_garbage'], 1)
        self.assert_undisturbed()

    def test_wrong_ring_and_version_are_told_so(self):
        self.quiet_ring()
        for data, expected in ((host_port_wire.greeting('another'), b'another'),
                               (host_port_wire.greeting(self.ring, version=9), b'version')):
            self.assertIn(expected, self.say(self.socket_of(1), data))
        self.assertEqual(self.counters(1)['host_refused'], 2)

    def test_too_many_clients_are_refused(self):
        self.quiet_ring(limits={'clients': 4})
        clients = []
        with self.assertRaises(HostPortError):
            for _ in range(7):
                clients.append(self.port(1))
                clients[-1].observe()  # one that is idle would make room
        clients.pop().close()
        self.wait('a place is free again', lambda: self.row(1))
        self.assertGreaterEqual(self.counters(1)['host_refused'], 1)
        self.assert_undisturbed()

    def test_bad_arguments_are_rejected_and_the_client_stays(self):
        self.quiet_ring()
        port = self.port(0)
        bad = [port.send(1, b''), port.send(1, b'x' * 513), port.send(1, b'x', priority=4),
               port.send(1, b'x', channel=1), port.send(1, b'x', channel=64),
               port.interrupt(1, 8), port.pull(8)]
        for token in bad:
            result = port.wait(token)
            self.assertEqual(result.outcome, 'rejected')
            self.assertNotEqual(result.reason, '')
        self.assertEqual(self.counters(0)['host_rejected'], len(bad))
        for order in ({'do': 'dance'}, {}, {'do': 'ping', 'to': 77}, {'do': 'ping', 'to': 1, 'size': 513},
                      {'do': 'ping', 'to': 1, 'count': -1}, {'do': 'reset'}):
            self.assert_refused('', port, order)
        self.assertEqual(port.wait(port.send(1, b'good')).outcome, 'delivered')

    def test_json_nested_without_end_is_answered_and_the_daemon_stays(self):
        self.quiet_ring()
        port = self.port(0)
        nest = '[' * 32600 + ']' * 32600
        for order in (nest, '{"do":"ping","to":%s}' % nest, '{"do":"ping","to":1,"count":%s}' % nest,
                      '{"do":"status","x":%s}' % nest):
            with self.assertRaisesRegex(HostPortError, 'nested too deep'):
                port.answer(port.request_text(order))
        port.observe_text('{"kinds":%s}' % nest)
        self.assertIn('nested too deep', port.next_of(Observed).content['error'])
        self.assert_undisturbed()

    def test_client_that_does_not_read_is_bounded(self):
        self.quiet_ring()
        peer = self.connect(self.socket_of(0))
        peer.sendall(host_port_wire.greeting(self.ring))
        order = host_port_wire.frame(host_port_wire.REQUEST, struct.pack('>I', 5) + b'{"do": "status"}')
        with self.assertRaises(OSError):
            peer.settimeout(ring_process.GUARD)
            for _ in range(100000):
                peer.sendall(order)
        self.wait('counted', lambda: self.counters(0)['host_slow_clients'] == 1)
        self.assert_undisturbed()

    def test_garbage_on_a_unix_link(self):
        self.quiet_ring()
        before = self.counters(1)['input_unknown_peers']
        pieces = [b'GET / HTTP/1.1\r\n\r\n' * 10, b'\0' * 64, garbage(9000),
                  head(CONNECT, ring=12345), head(ALIVE), head(BYE, sender=0)]
        for piece in pieces:
            self.say(self.socket_of(1, 'link'), piece)
        self.wait('counted', lambda: self.counters(1)['input_unknown_peers'] == before + len(pieces))
        self.assert_undisturbed()

    def test_a_node_of_the_old_protocol_is_named_in_the_log(self):
        daemons = self.start_ring(plain_nodes(3))
        told = self.say(self.socket_of(1, 'link'), head(CONNECT, version=1))
        self.assertEqual((told[2], told[3], told[-1]), (3, REFUSE, WRONG_VERSION))
        self.wait('named', lambda: 'node 0 (node0): protocol mismatch: peer speaks version 1, this is version 3; update it' in
                  self.log_of(daemons[1]))
        self.assertTrue(self.is_closed(range(3)))

    def test_half_open_connections_at_a_unix_link_are_closed(self):
        self.quiet_ring()
        for peer in [self.connect(self.socket_of(1, 'link')) for _ in range(40)]:
            self.read_to_end(peer)
        self.assertGreaterEqual(self.counters(1)['input_unknown_peers'], 40)
        self.assert_undisturbed()

    def test_garbage_on_a_udp_link(self):
        ports = free_udp_ports(3)
        self.quiet_ring(links={'transport': 'udp', 'port': ports})
        before = self.counters(1)['input_unknown_peers']
        peer = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(peer.close)
        pieces = [b'', b'x', b'GET / HTTP/1.1', b'\0' * 64, garbage(1400), garbage(60000),
                  head(CONNECT, ring=12345), head(SLICES, ring=99) + b'\xa7\1\0\4abcd']
        for piece in pieces * 25:
            peer.sendto(piece, ('127.0.0.1', ports + 1))
        self.wait('counted', lambda: self.counters(1)['input_unknown_peers'] > before)
        self.assert_undisturbed()


if __name__ == '__main__':
    ring_process.main()
