"""Faults whose times are not measured: they damage, delay or restart, and the promises must hold."""
from live_ring.faults import Fault
from live_ring.ring import line_of, name_of

# Faults of a line, with their parameters; a seed is added to those that choose at random.
OF_LINES = {
    'drop': 'once_in=20', 'corrupt': 'once_in=20', 'truncate': 'once_in=20', 'duplicate': 'once_in=10',
    'delay': 'delay=2ms jitter=2ms', 'rate': 'rate=20Mbit/s', 'flap': 'every=400ms'}
OF_UDP_LINES = {'reorder': 'once_in=20'}
SEEDED = {'drop', 'corrupt', 'truncate', 'duplicate', 'delay', 'reorder'}
OF_CHILD_CPUS = {'slow': 'every=5ms', 'not_reading': ''}


class Disturbance(Fault):
    def __init__(self, live, node, kind, parameters):
        super().__init__(live, node)
        self.kind, self.parameters = kind, parameters


class LineDisturbance(Disturbance):
    def begin(self):
        self.order('%s %s %s' % (self.kind, line_of(self.node), self.parameters))

    def mend(self):
        self.order('heal ' + line_of(self.node))


class CpuDisturbance(Disturbance):
    def begin(self):
        self.order('%s %s %s' % (self.kind, name_of(self.node), self.parameters))

    def mend(self):
        self.order('resume ' + name_of(self.node))


class PowerCycle(Fault):
    kind = 'power cycle'

    def begin(self):
        self.live.ring.starts[self.node] += 1
        self.live.watch.ask(self.node, {'do': 'fault', 'fault': 'power_cycle ' + name_of(self.node)})

    def mend(self):
        """The ring is whole when its connections have ended and come back."""
        self.live.wait('node %d to be there again' % self.node, lambda: self.live.watch.is_new(self.node,
                                                                                              self.requested_ns))


def line(live, node, chance):
    kinds = dict(OF_LINES, **(OF_UDP_LINES if live.ring.transport_into(node + 1) == 'udp' else {}))
    kind = chance.choice(sorted(kinds))
    seed = ' seed=%d' % (1 + chance.randrange(10 ** 6)) if kind in SEEDED else ''
    return LineDisturbance(live, node, kind, kinds[kind] + seed)


def child_cpu(live, node, chance):
    kind = chance.choice(sorted(OF_CHILD_CPUS))
    return CpuDisturbance(live, node, kind, OF_CHILD_CPUS[kind])


def power_cycle(live, node, _):
    return PowerCycle(live, node)
