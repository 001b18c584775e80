"""The ring, its traffic and its watch in one loop."""
import sys

from live_ring import counting_cpu
from live_ring.loop import Loop
from live_ring.ring import NODES, LiveRing, RingFailed
from live_ring.traffic import Traffic
from live_ring.watch import Watch

GUARD = 30.0      # s that the ring may take to be whole again, and sends to end; a busy machine is slow
NOTED_BY_CPU = [sys.executable, counting_cpu.__file__]


def counting(folder):
    return NOTED_BY_CPU + [folder]


class Live:
    def __init__(self, options, rate, child_nodes, child_command=counting, records=False, foreign=()):
        self.loop = Loop()
        self.ring = LiveRing(options, child_nodes, child_command, records, foreign)
        # What other programs receive cannot be checked.
        targets = [node for node in range(NODES) if child_command is counting or node not in child_nodes]
        self.watch = Watch(self.loop, self.ring)
        self.traffic = Traffic(self.loop, self.ring, options.seed, rate, targets)
        self.loop.seldom.append(self.ring.check)

    def start(self):
        self.ring.start()
        self.wait_whole()

    def stop(self):
        self.ring.stop()

    def wait(self, what, condition):
        return self.loop.until(lambda: '%s; the nodes: %s' % (what, self.watch.text()), condition, GUARD)

    def is_whole(self):
        cpus = all(self.watch.nodes[node].cpu_state == 'running' for node in self.ring.ours)
        return cpus and self.watch.whole() and self.traffic.all_connected()

    def wait_whole(self):
        self.wait('the ring whole, all CPUs running', self.is_whole)

    def wait_ended(self, before_ns):
        self.wait('the end of every send', lambda: self.traffic.ended_before(before_ns))

    def ask(self, node, order):
        """@raise RingFailed where the daemon says no"""
        key = self.watch.ask(node, order)
        if key is None:
            raise RingFailed('node %d is not there to be asked: %s' % (node, order))
        answer = self.wait('an answer of node %d to %s' % (node, order), lambda: self.watch.answers.get(key))
        if 'error' in answer:
            raise RingFailed('node %d, asked %s: %s' % (node, order, answer['error']))
        return answer
