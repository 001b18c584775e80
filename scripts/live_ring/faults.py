"""Faults on purpose, each with timestamps of what the ring does about it (ns of CLOCK_MONOTONIC; None: not yet)."""
import time

from live_ring.ring import NODES, SILENCE_MS, SUPERVISOR, line_of, name_of


class Fault:
    kind = ''
    does = ''     # what the ring does about it
    patience = None   # s to wait for its timestamps; None: as long as for anything

    def __init__(self, live, node):
        self.live, self.node = live, node
        self.requested_ns = self.detected_ns = self.recovered_ns = None

    def start(self):
        self.requested_ns = time.monotonic_ns()
        self.begin()

    def poll(self):
        """True when all timestamps are known."""
        self.detected_ns = self.detected_ns or self.detected()
        self.recovered_ns = self.recovered_ns or self.recovered()
        return self.began() and self.detected_ns and self.recovered_ns

    def began(self):
        """When it took effect."""
        return self.requested_ns

    def concerns(self, source, to):
        """Whether a send is at the faulty node, or cut off by the fault."""
        return self.node in (source, to)

    def repair(self):
        """What mends it, not begun; None where it ends by itself."""
        return None

    def mend(self):
        mending = self.repair()
        if mending:
            mending.start()

    def others(self):
        return [node for node in range(NODES) if node != self.node]

    def order(self, text):
        self.live.ask(self.node, {'do': 'fault', 'fault': text})

    def link(self, nodes, **members):
        """The first event of a link at these nodes that has these members."""
        return self.live.watch.first('link', self.requested_ns, lambda event: members.items() <= event.items(), nodes)


# ---- lines --------------------------------------------------------------------------------

class LineFault(Fault):
    """Of the line out of `node`."""

    def __init__(self, live, node):
        super().__init__(live, node)
        self.folds = live.ring.redundancy == 'foldback'

    def concerns(self, source, to):
        return not self.folds and (self.node - source) % NODES < (to - source) % NODES

    def behind(self):
        return (self.node + 1) % NODES

    def detected(self):
        return self.link([self.behind()], end='input', **{'is': 'lost'})

    def recovered(self):
        return self.live.watch.all_are('folded' if self.folds else 'open_chain', range(NODES))

    def repair(self):
        return Mended(self.live, self.node)


class Cut(LineFault):
    kind = 'broken line'
    does = 'the node behind waits timeouts.break_grace (200 ms) for a bypass, then tells all: open chain, unconfirmed'

    def __init__(self, live, node):
        super().__init__(live, node)
        if self.folds:
            self.does = 'the node before it turns back, the one behind takes the second line: all confirmed'

    def begin(self):
        self.order('cut ' + line_of(self.node))

    def began(self):
        return self.link([self.node], end='output', **{'is': 'lost'})

    def recovered(self):
        # The node before the break stays so where it has lost its input as well, perhaps for a moment, as it does if this
        # machine lets it stand still: without its output it cannot join again (protocol.md section 8.3).
        if not self.folds and self.live.watch.nodes[self.node].state == 'starting':
            return self.live.watch.all_are('open_chain', self.others())
        return super().recovered()


class Stall(LineFault):
    kind = 'silent line'
    does = 'counts as broken after timeouts.silence (%d ms); then as a broken line' % SILENCE_MS

    def begin(self):
        self.order('stall ' + line_of(self.node))


class Mended(LineFault):
    kind = 'line mended'
    does = 'is connected again; the ring closes'

    def begin(self):
        self.order('heal ' + line_of(self.node))

    def detected(self):
        return self.link([self.behind()], end='input', **{'is': 'up'})

    def recovered(self):
        return self.live.watch.whole()

    def repair(self):
        return None


class Noise(LineFault):
    """One bit of one packet."""
    kind = 'noisy line'
    does = 'the node behind it counts the damage; the source sends again'
    patience = 1.0    # the packet may be a beacon, of whose second try nobody is told

    def begin(self):
        self.order('corrupt %s packets=1 seed=%d' % (line_of(self.node), self.node + 1))

    def began(self):
        return self.noise(self.node)

    def noise(self, node):
        return self.live.watch.first('noise', self.requested_ns, lambda _: True, [node])

    def detected(self):
        return self.noise(self.behind())

    def recovered(self):
        hit = self.began()
        return hit and self.live.watch.first(
            'sent', hit, lambda event: event['outcome'] == 'delivered' and event['tries'] > 1)

    def concerns(self, source, to):
        return False

    def repair(self):
        return None


# ---- CPUs ---------------------------------------------------------------------------------

class CpuFault(Fault):
    def cpu(self, since_ns, wanted):
        return self.live.watch.first('cpu', since_ns, wanted, [self.node])

    def recovered(self):
        return self.detected_ns and self.cpu(self.detected_ns, lambda event: event['state'] == 'running')


class Hang(CpuFault):
    kind = 'hung CPU'
    does = 'the supervisor (auto) finds it by the beacons and resets it by INT0; the node relays on'

    def begin(self):
        self.order('hang ' + name_of(self.node))

    def detected(self):
        return self.live.watch.first('watchdog', self.requested_ns, lambda event: event['id'] == self.node and
                                     event['verdict'] == 'hung', [SUPERVISOR])


class Crash(CpuFault):
    kind = 'crashed CPU'
    does = 'its node relays on and starts it again'

    def begin(self):
        self.order('crash ' + name_of(self.node))

    def detected(self):
        return self.cpu(self.requested_ns, lambda event: event['state'] != 'running')


# ---- nodes --------------------------------------------------------------------------------

class Dead(Fault):
    kind = 'dead node'
    does = 'its neighbours bypass it; the ring goes on with %d' % (NODES - 1)

    def begin(self):
        self.live.ring.kill(self.node)

    def detected(self):
        return self.link(self.others(), **{'is': 'lost'})

    def recovered(self):
        return self.live.watch.whole(self.others())

    def repair(self):
        return Returned(self.live, self.node)


class Frozen(Dead):
    kind = 'frozen node'
    does = 'counts as dead after timeouts.silence (%d ms); then as a dead node' % SILENCE_MS

    def begin(self):
        self.live.ring.freeze(self.node)

    def repair(self):
        return Thawed(self.live, self.node)


class Returned(Dead):
    kind = "node's return"
    does = 'from the start of its ringd: its neighbours take it in, it says hello; %d again' % NODES

    def begin(self):
        self.live.ring.gone(self.node)
        self.live.ring.start_node(self.node)

    def detected(self):
        return self.link(self.others(), other=self.node, **{'is': 'up'})

    def recovered(self):
        return self.live.watch.whole()

    def repair(self):
        return None


class Thawed(Returned):
    kind = 'frozen node goes on'
    does = 'finds itself bypassed, forgets what is stale, says a new hello'

    def begin(self):
        self.live.ring.thaw(self.node)


MEASURED = (Cut, Stall, Hang, Crash, Dead, Frozen, Noise)
OF_CPUS = (Hang, Crash)
