"""What the nodes say of themselves as it happens: the observe stream, with the daemons' own times."""
import functools
import time

from live_ring.port import Port
from live_ring.ring import NODES, RingFailed
from limb_ring import Observed, ObservedLost, Reply

KINDS = ('state', 'ring', 'link', 'noise', 'cpu', 'watchdog', 'sent')


class Seen:
    """What is known of one node."""

    def __init__(self):
        self.port, self.state, self.size, self.changed_ns, self.boot = None, None, 0, 0, 0
        self.cpu_state, self.since_ns = None, time.monotonic_ns()


class Watch:
    def __init__(self, loop, ring):
        self.loop, self.ring = loop, ring
        self.nodes = {node: Seen() for node in ring.ours}
        self.events = {kind: [] for kind in KINDS}   # of (node, event), in order of arrival
        self.answers = {}   # (node, token): reply
        loop.turns.append(self.connect)

    def connect(self):
        for node, seen in self.nodes.items():
            if seen.port is None and self.ring.can_answer(node):
                seen.port = Port.open(self.ring, node, self.loop, functools.partial(self.handle, node),
                                      functools.partial(self.gone, node))
                if seen.port:
                    seen.port.host.observe(*KINDS)
                    self.ask(node, {'do': 'status'})

    def gone(self, node):
        self.nodes[node] = Seen()

    def ask(self, node, order):
        """The key under which `answers` will have the reply; None where the node is not there."""
        port = self.nodes[node].port
        return (node, port.host.request(order)) if port else None

    def handle(self, node, message):
        """@raise RingFailed where events are missing: what was measured by them, or is waited for, is not known"""
        if isinstance(message, Reply):
            answer = message.content
            self.answers[(node, message.token)] = answer
            if 'ring_size' in answer:
                self.note_status(self.nodes[node], answer)
        elif isinstance(message, ObservedLost):
            raise RingFailed('%d events of node %d came faster than they were read, and were left out' % (
                message.count, node))
        elif isinstance(message, Observed):
            # Its time is that of the wall clock, which may be set between two events.
            event = dict(message.content, time_ns=message.content['time_ns'] + time.monotonic_ns() - time.time_ns())
            self.events[event['kind']].append((node, event))
            self.note(self.nodes[node], event)

    @staticmethod
    def note_status(seen, row):
        if seen.state is None:   # else an event was faster, and is newer
            seen.state, seen.changed_ns = row['state'], time.monotonic_ns()
            seen.size = row['ring_size']
        seen.boot, seen.cpu_state = row['boot'], row['cpu']['state']

    @staticmethod
    def note(seen, event):
        if event['kind'] == 'state':
            seen.state = event['after']
        if event['kind'] in ('state', 'ring'):
            seen.size, seen.changed_ns = event['ring_size'], event['time_ns']
        if event['kind'] == 'cpu':
            seen.cpu_state = event['state']

    # ---- timestamps, in ns of CLOCK_MONOTONIC; None: not yet -------------------------------

    def all_are(self, state, nodes, size=None):
        """When the last of the nodes that have a daemon came to be so."""
        seen = [self.nodes[node] for node in nodes if node in self.nodes]
        so = all(each.state == state and size in (None, each.size) for each in seen)
        return max(each.changed_ns for each in seen) if so else None

    def whole(self, nodes=range(NODES)):
        return self.all_are('up', nodes, len(nodes))

    def is_new(self, node, since_ns):
        """Whether the daemon has been connected to since then."""
        seen = self.nodes[node]
        return seen.state is not None and seen.since_ns >= since_ns

    def first(self, kind, since_ns, wanted, nodes=None):
        """The first event of the kind since then."""
        for node, event in self.events[kind]:
            if event['time_ns'] >= since_ns and (nodes is None or node in nodes) and wanted(event):
                return event['time_ns']
        return None

    def forget(self):
        for events in self.events.values():
            events.clear()
        self.answers.clear()

    def text(self):
        return ', '.join('node%d %s of %d' % (node, seen.state or 'not there', seen.size)
                         for node, seen in self.nodes.items())
