"""Every node sends all the time: unicasts and broadcasts of random size and priority, and interrupts."""
import random
import re
import time
from collections import Counter

from live_ring import counting_cpu, payload
from live_ring.port import Port
from live_ring.promises import Promises
from live_ring.ring import NOTIFY
from limb_ring import BROADCAST, Interrupt, Packet, Result

WINDOW = 8               # sends of one node that have not ended
BROADCASTS_ONE_IN = 20
INTERRUPTS_ONE_IN = 20
SYNC = 2                 # the factor of interrupts to a foreign node, which says that it was pulled
PULLED = re.compile(r'node (\d+) has pulled pin %d\n' % SYNC)


class Send:
    __slots__ = ('source', 'number', 'to', 'interrupt', 'asked_ns', 'incarnation', 'outcome')

    def __init__(self, source, number, to, interrupt, incarnation):
        self.source, self.number, self.to, self.interrupt = source, number, to, interrupt
        self.asked_ns, self.incarnation, self.outcome = time.monotonic_ns(), incarnation, None


class Station:
    """The program at one node; where the CPU is ringd's child, a tool beside it."""

    def __init__(self, node, seed):
        self.node, self.port, self.incarnation, self.number = node, None, 0, 0
        self.under_way, self.due = {}, 0.0
        self.chance = random.Random('%d %d' % (seed, node))


class Traffic:
    def __init__(self, loop, ring, seed, rate, targets):
        self.loop, self.ring, self.targets = loop, ring, targets
        self.stations = {node: Station(node, seed) for node in ring.ours}
        self.promises = Promises(ring.nodes)
        self.interval = len(ring.nodes) / rate   # s, of one node
        self.results, self.echoes = Counter(), Counter()
        self.recent = []      # sends since forget()
        self.read_up_to = {}     # of what child CPUs have noted
        self.to_foreign = {}     # (source, number): destination, priority
        self.on = True
        loop.turns.append(self.turn)
        loop.seldom.append(self.read_files)

    def turn(self):
        now = time.monotonic()
        for station in self.stations.values():
            if station.port is None:
                self.connect(station)
            elif self.on and now >= station.due and len(station.under_way) < WINDOW:
                station.due = now + self.interval * 2 * station.chance.random()
                self.send(station)

    # ---- connections ----------------------------------------------------------------------

    def is_cpu(self, node):
        return node in self.stations and node not in self.ring.child_nodes

    def connect(self, station):
        if not self.ring.can_answer(station.node):
            return
        role = 'cpu' if self.is_cpu(station.node) else 'tool'
        station.port = Port.open(self.ring, station.node, self.loop, lambda message: self.handle(station, message),
                                 lambda: self.gone(station), role)
        station.incarnation += station.port is not None

    def gone(self, station):
        station.port = None
        station.incarnation += 1
        self.promises.connection_lost(station.node)
        if station.under_way:   # before it says that the connection has ended, the library ends them all
            self.promises.broken('node %d was never told how %d sends ended', station.node, len(station.under_way))
        station.under_way.clear()

    # ---- out ------------------------------------------------------------------------------

    def send(self, station):
        to = station.chance.choice([node for node in self.targets if node != station.node])
        if station.chance.randrange(INTERRUPTS_ONE_IN) == 0:
            return self.order(station, to, True, station.port.host.interrupt, to, self.factor(to))
        if station.chance.randrange(BROADCASTS_ONE_IN) == 0:
            to = BROADCAST
        data = payload.make(station.node, station.number + 1, station.chance)
        priority = station.chance.randrange(4)
        if to == BROADCAST or to in self.ring.foreign:
            self.to_foreign[(station.node, station.number + 1)] = to, priority
        self.order(station, to, False, station.port.host.send, to, data, priority)

    def factor(self, to):
        return SYNC if to in self.ring.foreign else NOTIFY

    def order(self, station, to, interrupt, say, *arguments):
        station.number += not interrupt
        incarnation = self.stations[to].incarnation if to in self.stations else 0
        send = Send(station.node, station.number, to, interrupt, incarnation)
        station.under_way[say(*arguments)] = send
        self.recent.append(send)

    # ---- in -------------------------------------------------------------------------------

    def handle(self, station, message):
        if isinstance(message, Packet) and message.source in self.ring.foreign:
            self.echo(station, message)
        elif isinstance(message, Packet):
            self.promises.message(station.node, message)
        elif isinstance(message, Interrupt) and message.action == 'notify':
            self.promises.pin(station.node, message.source)
        elif isinstance(message, Result):
            send = station.under_way.pop(message.token, None)
            if send is None:
                return self.promises.broken('node %d was told a second time how send %d ended: %s', station.node,
                                            message.token, message.outcome)
            self.end(send, message.outcome)

    def echo(self, station, packet):
        """The CPU of a foreign node sends each packet back: that shows what it was given."""
        known = payload.read(packet.data)
        if known not in self.to_foreign or known[0] != station.node:
            return self.promises.broken('node %d was sent back a packet by node %d that it has not sent: %s', station.node,
                                        packet.source, known or 'damaged')
        self.given_to_foreign(packet.source, known)

    def given_to_foreign(self, node, known):
        self.echoes[node] += 1
        self.promises.packet(node, *known, *self.to_foreign[known])

    def end(self, send, outcome):
        send.outcome = outcome
        self.results[outcome] += 1
        there = not send.interrupt and send.to != BROADCAST and self.is_cpu(send.to)
        connected = there and self.stations[send.to].port and self.stations[send.to].incarnation == send.incarnation
        self.promises.ended(send, outcome, connected)

    def read_files(self):
        for node in self.ring.child_nodes:
            try:
                with open(counting_cpu.path_of(self.ring.folder, node), 'rb') as notes:
                    notes.seek(self.read_up_to.get(node, 0))
                    data = notes.read()
            except FileNotFoundError:
                continue
            whole = len(data) - len(data) % counting_cpu.NOTE.size
            self.read_up_to[node] = self.read_up_to.get(node, 0) + whole
            for offset in range(0, whole, counting_cpu.NOTE.size):
                self.note(node, data[offset:offset + counting_cpu.NOTE.size])

    def read_pulls(self):
        """Once, at the end: what foreign nodes say was pulled at them."""
        for node in self.ring.foreign:
            for log in self.ring.logs_of(node):
                with open(log, errors='replace') as said:
                    for source in PULLED.findall(said.read()):
                        self.promises.pin(node, int(source))

    def note(self, node, note):
        if note == counting_cpu.DAMAGED:
            return self.promises.broken('node %d was given a damaged packet', node)
        source, number, destination, priority = counting_cpu.NOTE.unpack(note)
        if source != node:
            return self.promises.packet(node, source, number, destination, priority)
        to, _ = self.to_foreign[(source, number)]   # it was sent back; by whom the note does not say of a broadcast
        if to != BROADCAST:
            self.given_to_foreign(to, (source, number))

    # ---- accounts -------------------------------------------------------------------------

    def all_connected(self):
        return all(station.port for station in self.stations.values())

    def under_way(self):
        return sum(len(station.under_way) for station in self.stations.values())

    def ended_before(self, time_ns):
        return all(send.asked_ns >= time_ns for station in self.stations.values()
                   for send in station.under_way.values())

    def lost(self, concerns, from_ns, to_ns):
        """Unicasts that were asked for in this time, that the fault did not concern, and that neither were confirmed
        nor arrived."""
        self.read_files()
        return [send for send in self.recent
                if from_ns <= send.asked_ns < to_ns and not send.interrupt and send.to != BROADCAST and
                not concerns(send.source, send.to) and send.outcome != 'delivered' and
                (send.source, send.number) not in self.promises.arrived[send.to]]

    def forget(self):
        self.recent = [send for send in self.recent if send.outcome is None]
