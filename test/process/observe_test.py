"""Clients that see the packets on a node's lines, as fast or as slow as they read."""

import os
import signal

import ring_process
from ring_process import RingTest, plain_nodes
from limb_ring import CaptureCounts, CapturedPacket, Observed, Result

CONTROL = 1


def fields(packet):
    """Of a whole packet: its source, destination and last trailer byte, and its payload."""
    data = packet.bytes
    return {'kind': 'interrupt' if data[0] & 0x20 else 'data', 'hop': data[2], 'source': data[3],
            'destination': data[-6], 'last': data[-5], 'payload': data[4:-8]}


class Events(RingTest):
    def test_are_printed_until_ctrl_c_which_is_a_good_end(self):
        self.start_ring(plain_nodes(2))
        observe = self.start('observe', [ring_process.program('ringctl'), '--ring', self.ring, 'traffic', 'events', '0'])
        self.wait('it observes', lambda: self.log_of(observe))
        observe.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(observe), 0)


class Packets(RingTest):
    def observe(self, node, **choice):
        observer = self.port(node)
        observer.observe(packets=choice)
        self.assertEqual(observer.next_of(CaptureCounts).seen, 0)
        return observer

    def user_packet(self, observer):
        return observer.find(lambda message: isinstance(message, CapturedPacket) and
                             fields(message)['last'] >> 2 != CONTROL)

    def test_a_packet_is_seen_on_its_way_with_all_its_bytes(self):
        self.start_ring(plain_nodes(3))
        observer = self.observe(1, at=['in', 'out'], kinds=['data'])
        sender = self.port(0)
        sender.send(2, b'look at me', priority=3)
        self.assertEqual(sender.next_of(Result).outcome, 'delivered')
        seen = [self.user_packet(observer) for _ in range(2)]
        self.assertEqual([p.line for p in seen], [(0, 1), (1, 2)])
        self.assertEqual([p.input for p in seen], [True, False])
        self.assertEqual([fields(p)['hop'] for p in seen], [0, 1])
        for packet in seen:
            self.assertEqual(fields(packet)['payload'], b'look at me')
            self.assertEqual((fields(packet)['source'], fields(packet)['destination']), (0, 2))
            self.assertFalse(packet.crc_bad or packet.own or packet.retry)
        self.assertLessEqual(seen[0].steady_ns, seen[1].steady_ns)

    def test_a_node_sees_its_own_packet_leave_and_come_home(self):
        self.start_ring(plain_nodes(3))
        observer = self.observe(0, at=['in', 'out'], kinds=['interrupt'])
        self.ctl('interrupt', '--from', 0, '--to', 1, 5)
        seen = [observer.next_of(CapturedPacket) for _ in range(2)]
        self.assertEqual([(p.input, p.own, fields(p)['hop']) for p in seen],
                         [(False, True, 0), (True, True, 2)])

    def test_only_what_was_asked_for_comes_and_the_rest_is_counted(self):
        self.start_ring(plain_nodes(3))
        observer = self.observe(1, kinds=['data'], source=['node2'], priority=[1], sample=2)
        ports = {node: self.port(node) for node in (0, 2)}
        for _ in range(10):
            for node, priority in ((0, 1), (2, 1), (2, 3)):
                ports[node].send(1, b'x', priority=priority)
                self.assertEqual(ports[node].next_of(Result).outcome, 'delivered')
        observer.observe(packets=None)
        observer.ask({'do': 'latch'})
        seen = observer.received(CapturedPacket)
        self.assertEqual([(fields(p)['source'], fields(p)['last'] & 3) for p in seen], [(2, 1)] * 5)
        counts = observer.received(CaptureCounts)[-1]
        self.assertEqual((counts.given, counts.sampled_out, counts.lost), (5, 5, 0))
        self.assertGreaterEqual(counts.filtered, 20)
        self.assertEqual(counts.seen,
                         counts.filtered + counts.sampled_out + counts.limited + counts.lost + counts.given)

    def test_a_slow_observer_loses_and_is_told_while_the_ring_loses_nothing(self):
        self.start_ring(plain_nodes(2))
        observer = self.observe(0, at=['in', 'out'])
        self.ctl_json('ping', '--from', 0, '--to', 1, '--count', 3000, '--size', 512)
        self.assertGreater(self.counters(0)['host_captured_lost'], 0)
        self.assertEqual(self.counters(0)['host_slow_clients'], 0)
        self.assertEqual(sum(self.counters(node)['ended_lost'] for node in (0, 1)), 0)
        # It reads again: what it missed is told, and nothing is missing beside that.
        observer.ask({'do': 'latch'})
        self.ctl_json('ping', '--from', 0, '--to', 1, '--count', 1, '--size', 512)
        observer.observe(packets=None)
        observer.ask({'do': 'latch'})
        seen = observer.received(CapturedPacket)
        counts = observer.received(CaptureCounts)[-1]
        self.assertEqual(len(seen), counts.given)
        self.assertGreater(counts.lost, 0)
        self.assertEqual(sum(p.lost_before for p in seen), counts.lost)

    def test_a_wrong_order_is_answered_with_what_would_be_right(self):
        self.start_ring(plain_nodes(2))
        observer = self.port(0)
        for choice, words in (({'kinds': ['weather']}, ['weather', 'data, control, interrupt']),
                              ({'at': ['above']}, ['above', 'in, out']),
                              ({'priority': [4]}, ['priority', '0 to 3']),
                              ({'source': ['nobody']}, ['nobody', 'node1']),
                              ({'sample': 0}, ['sample', 'from 1'])):
            observer.observe(packets=choice)
            error = observer.next_of(Observed).content['error']
            for word in words:
                self.assertIn(word, error)


class Orders(RingTest):
    def test_what_is_unknown_in_an_order_is_refused_with_what_there_is(self):
        self.start_ring(plain_nodes(2))
        observer = self.port(1)
        for order, error in (('{"kind": ["pin"]}', "observe: 'kind' is unknown; there are kinds, packets, promises"),
                             ('{"packets": {"kind": []}}', "observe: packets: 'kind' is unknown; there are at, kinds")):
            observer.observe_text(order)
            self.assertIn(error, observer.next_of(Observed).content['error'])

    def test_an_order_that_cannot_be_followed_changes_nothing(self):
        self.start_ring(plain_nodes(2))
        os.mkdir(self.socket_of(1, 'watch'))   # where the file for the promises would be
        observer = self.port(1)
        observer.observe('pin', promises=True)
        self.assertIn('1.watch', observer.next_of(Observed).content['error'])
        self.ctl_json('interrupt', '--from', 0, '--to', 1, 1)
        self.wait('the pin pulled', lambda: self.counters(1)['pins_pulled'] == 1)
        observer.ask({'do': 'latch'})
        self.assertEqual([seen.content for seen in observer.received(Observed)], [])


if __name__ == '__main__':
    ring_process.main()
