"""What the ring promises its users, checked on every packet: one result for each send, and a true one; nothing
damaged, nothing twice, nothing out of order, no interrupt more often than it was sent."""
from collections import Counter, defaultdict

from live_ring import built, payload  # noqa: F401
from limb_ring import BROADCAST

NEVER_ARRIVED = ('no such node', 'refused', 'rejected')
# An INTP doubled by a link in the moment its target joins may be told as this though it pulled the pin: accepted.
MAY_HAVE_PULLED = ('delivered', 'lost', 'unconfirmed', 'cancelled', 'no such node')
MOST_TOLD = 20


class Promises:
    def __init__(self, nodes):
        self.arrived = {node: set() for node in nodes}   # of (source, number)
        self.never = {node: set() for node in nodes}     # those that were said not to have arrived
        self.owed = {node: set() for node in nodes}      # delivered, and not seen yet
        self.last = {}                                   # (node, source, priority, broadcast): number
        self.pulled, self.may_pull = Counter(), Counter()   # (source, destination)
        self.interrupts = defaultdict(Counter)              # (source, destination): how they ended
        self.problems = []

    def broken(self, text, *values):
        if len(self.problems) < MOST_TOLD:
            self.problems.append(text % values)

    def packet(self, node, source, number, destination, priority):
        what = (source, number)
        if what in self.arrived[node]:
            self.broken('node %d was given packet %d of node %d twice', node, number, source)
        if what in self.never[node]:
            self.broken('node %d was given packet %d of node %d, which was said not to have arrived', node, number,
                        source)
        self.arrived[node].add(what)
        self.owed[node].discard(what)
        flow = (node, source, priority, destination == BROADCAST)
        if self.last.get(flow, 0) > number:
            self.broken('node %d was given packet %d of node %d, priority %d, after %d', node, number, source, priority,
                        self.last[flow])
        self.last[flow] = number

    def message(self, node, packet):
        known = payload.read(packet.data)
        if known is None or known[0] != packet.source:
            return self.broken('node %d was given a damaged packet of node %d', node, packet.source)
        self.packet(node, *known, packet.destination, packet.priority)

    def pin(self, node, source):
        self.pulled[(source, node)] += 1

    def ended(self, send, outcome, can_be_owed):
        """`can_be_owed`: the destination's program has been connected for all the time of the send."""
        if send.interrupt:
            self.interrupts[(send.source, send.to)][outcome] += 1
            if outcome in MAY_HAVE_PULLED:
                self.may_pull[(send.source, send.to)] += 1
            return
        what = (send.source, send.number)
        for node in [] if send.to == BROADCAST else [send.to]:
            if outcome in NEVER_ARRIVED:
                self.never[node].add(what)
                if what in self.arrived[node]:
                    self.broken('packet %d of node %d ended as %s, and node %d has it', send.number, send.source,
                                outcome, node)
            if outcome == 'delivered' and can_be_owed and what not in self.arrived[node]:
                self.owed[node].add(what)

    def connection_lost(self, node):
        """What its network controller had taken, its program can not get any more."""
        self.owed[node].clear()

    def nothing_owed(self):
        return not any(self.owed.values())

    def settle(self):
        """At the end, when nothing is under way any more."""
        for node, owed in self.owed.items():
            for source, number in sorted(owed):
                self.broken('packet %d of node %d was delivered to node %d and never came', number, source, node)
        for (source, node), count in self.pulled.items():
            if count > self.may_pull[(source, node)]:
                ended = ', '.join('%d %s' % (n, outcome) for outcome, n in self.interrupts[(source, node)].items())
                self.broken('node %d pulled the pin of node %d %d times, with %d interrupts that may have arrived (%s)',
                            source, node, count, self.may_pull[(source, node)], ended)
