"""Somebody with a hand on the cable between two nodes of a keyed ring: forged, replayed, truncated, bit-flipped and
reordered datagrams. None is taken, all are counted by reason, and the ring's round trips and memory stay as they are.
FORGE_COUNT and FORGE_RATE: how many, and how many a second; `make forge` has a million."""

import json
import os
import subprocess
import sys

import ring_process
from ring_process import RingTest, free_udp_ports, plain_nodes

COUNT = int(os.environ.get('FORGE_COUNT', 6000))
RATE = int(os.environ.get('FORGE_RATE', 20000))
NODES = range(3)
REASONS = ('unknown_peers', 'datagrams_truncated', 'datagrams_forged', 'datagrams_replayed', 'datagrams_stale',
           'datagrams_duplicate', 'offers')


class Forge(RingTest):
    """Node 0 sends to node 1 through forge_line: its file has another port for that node, which is no part of what
    neighbours must agree on."""

    def setUp(self):
        super().setUp()
        os.chmod(self.write('ring.key', os.urandom(32).hex() + '\n'), 0o600)
        self.ports = free_udp_ports(4)
        links = {'transport': 'udp', 'port': self.ports, 'key': 'ring.key'}
        config = self.write_ring(plain_nodes(3), links=links)
        through = plain_nodes(3)
        through[1] = {**through[1], 'link': {'port': self.ports + 3}}
        with open(config) as file:
            ring = json.load(file)
        self.files = {1: config, 2: config, 0: self.write('through.yaml', json.dumps({**ring, 'nodes': through}))}
        program = os.path.join(os.environ['FORGE_LINE']) if 'FORGE_LINE' in os.environ else None
        self.assertTrue(program, 'FORGE_LINE is the program forge_line')
        self.forger = subprocess.Popen([program, str(self.ports + 3), str(self.ports + 1), '1'],
                                       stdin=subprocess.PIPE, stdout=subprocess.PIPE, universal_newlines=True)
        self.addCleanup(self.end_forger)
        self.daemons = {node: self.ringd(self.files[node], node) for node in NODES}
        self.wait_closed(NODES)

    def end_forger(self):
        self.forger.stdin.close()
        self.forger.wait(timeout=ring_process.GUARD)
        self.forger.stdout.close()

    def order(self, text):
        self.forger.stdin.write(text + '\n')
        self.forger.stdin.flush()

    def answer(self):
        return json.loads(self.forger.stdout.readline())

    def round_trip(self, count):
        ping = self.port(0).ask({'do': 'ping', 'to': 2, 'count': count})
        self.assertEqual(ping['delivered'], count)
        return ping['round_trip_us']['p50']

    def memory_kb(self, node):
        with open('/proc/%d/status' % self.daemons[node].pid) as status:
            return int(next(line for line in status if line.startswith('VmRSS')).split()[1])

    def dropped_by_kernel(self):
        """Datagrams for which the socket of node 1 had no room: the throughput that a flood may cost."""
        with open('/proc/net/udp') as table:
            rows = [line.split() for line in table]
        return sum(int(row[12]) for row in rows[1:] if int(row[1].split(':')[1], 16) == self.ports + 1)

    def new_session(self):
        """Of what was said until now, that of yesterday."""
        self.order('keep')
        self.answer()
        self.daemons[1].terminate()
        self.wait_exit(self.daemons[1])
        self.daemons[1] = self.ringd(self.files[1], 1)
        self.wait_closed(NODES)

    def test_nothing_of_it_is_taken_and_all_is_counted(self):
        self.round_trip(300)
        self.new_session()
        quiet = self.round_trip(2000)
        memory = {node: self.memory_kb(node) for node in NODES}
        before, dropped, sender = self.counters(1), self.dropped_by_kernel(), self.counters(0)
        self.order('forge %d %d' % (COUNT, RATE))
        trips = [self.round_trip(200) for _ in range(max(1, COUNT // RATE // 2))]
        sent = self.answer()
        self.round_trip(100)
        after = self.counters(1)
        self.check_counts(sent, before, after, self.dropped_by_kernel() - dropped)
        self.check_sender(sender)
        growth = {node: self.memory_kb(node) - memory[node] for node in NODES}
        self.report(sent, before, after, quiet, sorted(trips)[len(trips) // 2], growth)
        for node in NODES:
            self.assertLess(growth[node], 2048, 'kB more memory at node %d' % node)

    def check_counts(self, sent, before, after, dropped):
        grown = {name: after['input_' + name] - before['input_' + name] for name in REASONS}
        to_sender = sent.get('to_sender', 0)
        forged = sum(sent.values()) - sent['passed_on'] - to_sender
        self.assertEqual(forged + to_sender, COUNT)
        self.assertGreaterEqual(sum(grown.values()), forged - dropped, 'each is counted: %s' % grown)
        taken = after['input_datagrams'] - before['input_datagrams'] - sum(grown.values())
        self.assertGreater(taken, 0)
        for name in REASONS:
            if name != 'datagrams_duplicate':
                self.assertGreater(grown[name], 0, name)
        for counter in ('input_losses', 'input_malformed', 'crc_errors', 'malformed_packets', 'duplicates'):
            self.assertEqual(after[counter], before[counter], counter)

    def check_sender(self, before):
        after = self.counters(0)
        grown = sum(after['output_datagrams_' + name] - before['output_datagrams_' + name]
                    for name in ('truncated', 'forged', 'replayed'))
        self.assertGreater(grown, 0)
        self.assertEqual(after['output_losses'], before['output_losses'])

    def report(self, sent, before, after, quiet, busy, growth):
        print(', '.join('%d %s' % (number, kind) for kind, number in sorted(sent.items()) if kind != 'passed_on'))
        print('counted: ' + ', '.join('%d %s' % (after['input_' + name] - before['input_' + name], name)
                                      for name in REASONS))
        print('round trip p50 %.0f us, %.0f us meanwhile: ratio %.2f; memory of the daemons: %s kB more' %
              (quiet, busy, busy / quiet, ', '.join(str(growth[node]) for node in NODES)))
        print('forge: %d datagrams, none taken.' % COUNT, flush=True)


if __name__ == '__main__':
    if len(sys.argv) == 1:
        sys.argv.append('-v')
    ring_process.main()
