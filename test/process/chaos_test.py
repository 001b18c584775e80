"""Daemons killed, frozen and brought back at random under traffic: every send ends once, what was
delivered has arrived, nothing arrives twice, order is kept."""

import os
import random
import signal
import struct

import ring_process
from ring_process import RingTest, plain_nodes
from limb_ring import Packet, Result

RECEIVER, SENDERS, NODES = 2, (0, 4), 5
OUTSTANDING = 16
SHIPPED = {'silence': '250ms', 'stall': '50ms', 'send': '100ms'}  # as a ring has them by default
MAY_HAVE_ARRIVED = {'lost', 'unconfirmed', 'cancelled'}
NEVER_ARRIVED = {'no such node', 'refused', 'rejected'}


class Sender:
    """Keeps numbered packets under way to the receiver, and books how each ended."""

    def __init__(self, node, port):
        self.node, self.port = node, port
        self.ended = {}  # token -> outcome
        self.doubled = []
        self.sent = 0

    def top_up(self):
        while self.sent - len(self.ended) < OUTSTANDING:
            self.send()

    def send(self, priority=2):
        self.sent += 1
        token = self.port.send(RECEIVER, struct.pack('>BI', self.node, self.sent), priority)
        assert token == self.sent  # tokens count from 1: a packet's number is that of its result
        return token

    def take_results(self):
        for result in self.port.received(Result):
            if result.token in self.ended:
                self.doubled.append(result.token)
            self.ended[result.token] = result.outcome

    def done(self):
        self.take_results()
        return len(self.ended) == self.sent


class Chaos(RingTest):
    def start_traffic(self):
        nodes = plain_nodes(NODES)
        nodes[RECEIVER]['cpu'] = 'attached'
        self.daemons = self.start_ring(nodes, timeouts=SHIPPED)
        self.cpu = self.port(RECEIVER, role='cpu')
        self.senders = [Sender(node, self.port(node)) for node in SENDERS]
        self.arrived = {node: [] for node in SENDERS}

    def run_traffic(self, sends):
        goal = sum(sender.sent for sender in self.senders) + sends
        self.wait('%d sends' % sends, lambda: self.turn() >= goal)

    def turn(self):
        for sender in self.senders:
            sender.top_up()
            sender.take_results()
        self.take_packets()
        return sum(len(sender.ended) for sender in self.senders)

    def take_packets(self):
        for packet in self.cpu.received(Packet):
            node, number = struct.unpack('>BI', packet.data)
            self.arrived[node].append(number)

    def finish(self):
        """All sends end; a last packet of the lowest priority says that nothing comes after it."""
        self.wait_closed(range(NODES))
        self.wait('every send ended', lambda: all([sender.done() for sender in self.senders]))
        for sender in self.senders:
            last = sender.send(priority=3)
            self.wait('the last one', lambda: self.take_packets() or last in self.arrived[sender.node])
            self.wait('its result', sender.done)

    def assert_promises_kept(self, seed):
        for sender in self.senders:
            arrived, told = self.arrived[sender.node], 'seed %d, node %d' % (seed, sender.node)
            self.assertEqual(sender.doubled, [], told)
            self.assertEqual(arrived, sorted(set(arrived)), told)  # once each, in order
            for token, outcome in sender.ended.items():
                if outcome == 'delivered':
                    self.assertIn(token, arrived, told)
                elif outcome not in MAY_HAVE_ARRIVED:
                    self.assertIn(outcome, NEVER_ARRIVED, told)
                    self.assertNotIn(token, arrived, '%s: %s' % (told, outcome))

    def freeze(self, node, sends):
        self.daemons[node].send_signal(signal.SIGSTOP)
        self.run_traffic(sends) if node not in SENDERS else self.wait_bypassed(node)
        self.daemons[node].send_signal(signal.SIGCONT)

    def wait_bypassed(self, node):
        self.wait('bypass', lambda: self.answered((node + 2) % NODES)['ring_size'] < NODES)

    def kill(self, node, sends):
        self.daemons[node].kill()
        self.run_traffic(sends)
        self.daemons[node] = self.ringd(os.path.join(self.folder, 'ring.yaml'), node)

    def test_others_are_killed_and_frozen(self):
        seed = random.randrange(10 ** 6)
        chance = random.Random(seed)
        self.start_traffic()
        for _ in range(8):
            harm = chance.choice([self.freeze, self.kill])
            harm(chance.choice([1, 3]), chance.randrange(1, 400))
            self.run_traffic(chance.randrange(1, 200))
        self.finish()
        self.assert_promises_kept(seed)

    def test_sender_and_receiver_are_frozen(self):
        seed = random.randrange(10 ** 6)
        chance = random.Random(seed)
        self.start_traffic()
        for _ in range(8):
            self.freeze(chance.randrange(NODES), chance.randrange(1, 100))
            self.run_traffic(chance.randrange(1, 200))
        self.finish()
        self.assert_promises_kept(seed)


if __name__ == '__main__':
    ring_process.main()
