"""What scripts/chaos does in one round: one fault, measured, or some at once."""
from live_ring import disturbances, episode, faults
from live_ring.ring import NODES

ONE_IN = 3         # so many rounds has several faults
MOST_AT_ONCE = 3
SHORT, LONG = 0.1, 1.0    # s that faults last


def how_many(chance):
    """Faults that a round has at once."""
    return 2 + chance.randrange(MOST_AT_ONCE - 1) if chance.randrange(ONE_IN) == 0 else 1


class Rounds:
    def __init__(self, live, chance):
        self.live, self.chance = live, chance
        self.begun, self.rows = {}, []     # kind: count; measured ones

    def one(self, tell):
        """Begins faults and mends them. Calls tell(words) before, with what they will be, and returns the same words once
        the ring is whole and all sends have ended."""
        at_once = how_many(self.chance)
        drawn = [self.draw(node) for node in self.chance.sample(range(NODES), at_once)]
        words = ', '.join('%s at node %d' % (fault.kind, fault.node) for fault in drawn)
        tell(words)
        for fault in drawn:
            self.begun[fault.kind] = self.begun.get(fault.kind, 0) + 1
        if at_once == 1 and self.can_be_measured(drawn[0]):
            self.rows += episode.run(drawn[0], self.time())
        else:
            self.unmeasured(drawn)
        self.look_for_ends({fault.node for fault in drawn if isinstance(fault, faults.Crash)})
        return words

    def can_be_measured(self, fault):
        """A foreign node tells no times."""
        told = not self.live.ring.foreign or not {fault.node, (fault.node + 1) % NODES} & set(self.live.ring.foreign)
        return isinstance(fault, faults.MEASURED) and told

    def look_for_ends(self, crashed):
        """CPUs that ended though nobody told them to."""
        for node, event in self.live.watch.events['cpu']:
            if event['state'] == 'failed' and node not in crashed:
                self.live.traffic.promises.broken('the CPU of node %d (pid %d) ended by itself', node, event['pid'])

    def time(self):
        return SHORT + (LONG - SHORT) * self.chance.random()

    def draw(self, node):
        kinds = [kind for kind in faults.MEASURED if kind not in faults.OF_CPUS]
        makers = [disturbances.line] * 4 + [disturbances.power_cycle]
        if node in self.live.ring.child_nodes:   # rare, so that theirs come often
            kinds = list(faults.OF_CPUS)
            makers = [disturbances.child_cpu]
        if node in self.live.ring.foreign:   # it can be told nothing
            kinds, makers = [faults.Dead, faults.Frozen], []
        drawn = self.chance.choice(kinds + makers)
        return drawn(self.live, node, self.chance) if drawn in makers else drawn(self.live, node)

    def unmeasured(self, drawn):
        self.live.watch.forget()
        self.live.traffic.forget()
        for fault in drawn:
            fault.start()
            self.live.loop.run_for(self.time() / len(drawn))
        self.mend(drawn)
        episode.settle(self.live)

    def mend(self, drawn):
        self.chance.shuffle(drawn)
        for fault in drawn:
            fault.mend()
        # Only now: behind a broken line the supervisor cannot reach a CPU.
        for fault in drawn:
            if isinstance(fault, faults.OF_CPUS):
                self.live.wait('the cure of node %d' % fault.node, fault.poll)
