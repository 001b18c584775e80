"""Plays all nodes of a ring but the one under test: the line into it, the line out of it, and what comes home."""

import collections
import itertools

from . import wire
from .wire import ALL, Packet

UP, OWN, DOWN, FAR = 2, 9, 5, 30
ORDER = [UP, OWN, DOWN, FAR]
NAMES = ['up', 'tested', 'down', 'far']
WAIT = 1.0      # s; what a node does at once comes within this, however busy the machine is
MOST_GAP = 0.1  # s; a kit that itself was not scheduled for so long proves nothing
MOST_HOPELESS = 3
SETTLED = 0.13  # s: longer than a time-out of a try
TICK = 0.04     # s, of the signs of life
BOOT = 0x1880000000000000


class Failed(Exception):
    """The node does something else than the section says."""


class Lenient(Exception):
    """The node works, though not as written."""


class NotApplicable(Exception):
    """The node does not have an optional part."""


class NotRun(Exception):
    """The kit cannot try it here."""


Own = collections.namedtuple('Own', 'at packet')
Config = collections.namedtuple('Config', 'ring own order agreement')


def config_of(ring):
    return Config(ring, OWN, ORDER, wire.agreement(ORDER, NAMES))


class Source:
    """A node that is played: its boot number, and its numbers per (DID, kind)."""

    def __init__(self, play, node, boot):
        self.play, self.node, self.boot, self.numbers = play, node, boot, collections.Counter()

    def packet(self, destination, last=0, data=b'x', interrupt=False, **fields):
        """The next one; of the fields of Packet.build those that are named."""
        if 'sequence' not in fields:
            # Those of unicasts begin at 1: no number of a hello is theirs.
            fields['sequence'] = (self.numbers[destination, interrupt] + (destination != ALL or interrupt)) % 8
            self.numbers[destination, interrupt] += 1
        fields.setdefault('incarnation', self.boot & 3)
        return Packet.build(self.node, destination, last, b'' if interrupt else data, interrupt, **fields)

    def interrupt(self, destination, factor, **fields):
        return self.packet(destination, factor, interrupt=True, **fields)

    def control(self, data, **fields):
        return self.packet(ALL, wire.CONTROL, data, **fields)

    def hello(self, boot=None, remembers=0):
        self.boot = self.boot if boot is None else boot
        self.numbers.clear()
        return self.control(wire.hello(self.boot, remembers))


class Play:
    def __init__(self, bench, config):
        self.bench, self.config, self.ring = bench, config, wire.text_hash(config.ring)
        self.numbers, self.marks, self.boots = itertools.count(0x11111111, 0x01010101), itertools.count(), itertools.count(BOOT, 17)
        self.echoes, self.clean, self.disturbed = None, False, False
        self.log = collections.deque(maxlen=4000)
        self.polled, self.out_mark = None, 0
        self.hello_kept = self.connect_kept = None
        self.hopeless = 0
        self.reset()

    def reset(self):
        self.input_session, self.input_sequence, self.input_sender = None, 0, UP
        self.output_session, self.output_node = None, None
        self.offers = {}
        self.assembler = wire.Assembler()
        self.asked, self.answers, self.slices, self.own, self.out = [], [], [], [], []
        self.ticked, self.first_slices = 0.0, None
        self.behave()

    def behave(self):
        """As right neighbours do; a case may change it."""
        self.policy = lambda node, header: 'accept' if node == DOWN else None
        self.returns = lambda packet: [self.home(packet)]
        self.idles = self.alives = True
        self.sources = {}

    # ---- time -----------------------------------------------------------------------------

    def now(self):
        return self.bench.now()

    def pump(self, condition=None, limit=WAIT):
        """Until the condition holds. @return whether it does within so many seconds"""
        end = self.now() + limit
        while condition is None or not condition():
            left = end - self.now()
            if left <= 0:
                return False
            self.turn(min(left, 0.01))
        return True

    def turn(self, wait):
        now = self.now()
        if self.polled is not None and now - self.polled > MOST_GAP:
            self.disturbed = True
        self.polled = now
        for place, datagram in self.bench.poll(wait):
            self.take(place, datagram)
        if self.now() - self.ticked >= TICK:
            self.ticked = self.now()
            self.tick()

    def tick(self):
        if self.idles and self.input_session is not None:
            self.slice(wire.IDLE)
        if self.alives and self.output_session is not None:
            self.header(('listens', self.output_node), wire.ALIVE, self.output_session)

    # ---- what goes out ----------------------------------------------------------------------

    def header(self, place, kind, session=0, sequence=0, refusal=0, more=b'', ring=None, version=wire.VERSION, sender=None):
        datagram = wire.HEADER.pack(wire.MAGIC, version, kind, self.ring if ring is None else ring, session, sequence,
                                    place[1] if sender is None else sender, refusal) + more
        self.raw(place, datagram)

    def raw(self, place, datagram):
        self.log.append((self.now(), 'to the node', place, datagram))
        self.bench.send(place, datagram)

    def slice(self, kind, data=b''):
        self.framed(wire.slice_of(kind, data))

    def framed(self, data, sequence=None):
        if sequence is None:
            self.input_sequence = sequence = (self.input_sequence + 1) % 2 ** 32
        self.header(('asks', self.input_sender), wire.SLICES, self.input_session or 0, sequence, more=data)

    def give(self, packet):
        for kind, data in wire.slices_of(packet):
            self.slice(kind, data)

    def ask(self, node=UP, number=None, **fields):
        """A connect, answered or not. @return the answer"""
        number = next(self.numbers) % 2 ** 32 if number is None else number
        before = len(self.answers)
        fields.setdefault('more', self.config.agreement)
        kind = fields.pop('kind', wire.CONNECT)
        if self.bench.line != 'udp':
            self.line_ended(('asks', node))  # a connect is a connection of its own, in place of the one before

        def answered():
            return [one for one in self.answers[before:] if one.type in (wire.ACCEPT, wire.REFUSE)]
        for _ in range(3):
            self.header(('asks', node), kind, number << 32, **fields)
            if self.pump(answered, WAIT / 3):
                return answered()[0]
        return None

    def connect(self, node=UP):
        """The line into the node."""
        answer = self.ask(node)
        if answer is None or answer.type != wire.ACCEPT:
            raise Failed('a connect of its predecessor is not accepted: %s' % self.say(answer))
        self.input_session, self.input_sequence, self.input_sender = answer.session, 0, node
        self.slice(wire.IDLE)

    # ---- what comes in ------------------------------------------------------------------------

    def take(self, place, datagram):
        self.log.append((self.now(), 'from the node', place, datagram))
        if not datagram:
            return self.line_ended(place)
        if len(datagram) < wire.HEADER.size:
            return
        header = wire.Header._make(wire.HEADER.unpack_from(datagram))
        if place[0] == 'asks':
            self.answers.append(header)
            if header.type == wire.REFUSE and header.session == self.input_session and place[1] == self.input_sender:
                self.input_session = None
        elif header.type in (wire.CONNECT, wire.CONNECT_MEMORY, wire.CONNECT_KEYED):
            self.is_asked(place[1], header, datagram)
        elif header.type == wire.SLICES and self.first_slices is None:
            self.first_slices = header
            self.take(place, datagram)
        elif header.type == wire.SLICES and header.session in (self.output_session, self.offers.get(place[1])):
            self.take_slice(place[1], header, datagram[wire.HEADER.size:])
        elif header.type == wire.BYE and header.session == self.output_session:
            self.output_session = None

    def line_ended(self, place):
        if place == ('asks', self.input_sender):
            self.input_session = None
        if place == ('listens', self.output_node):
            self.output_session = None

    def is_asked(self, node, header, datagram):
        self.asked.append((self.now(), node, header, datagram))
        answer = self.policy(node, header)
        if answer == 'accept':
            if self.offers.get(node, 0) >> 32 != header.session >> 32:
                self.offers[node] = header.session | (next(self.numbers) % 2 ** 32)
            self.header(('listens', node), wire.ACCEPT, self.offers[node])
            if self.bench.line == 'unix':
                self.line_begins(node, self.offers[node])
        elif answer is not None:
            self.header(('listens', node), wire.REFUSE, header.session, refusal=answer)

    def line_begins(self, node, session):
        self.output_session, self.output_node, self.assembler = session, node, wire.Assembler()

    def take_slice(self, node, header, framed):
        if header.session != self.output_session:
            self.line_begins(node, header.session)
        self.slices.append((self.now(), header, framed))
        kind, data = framed[1], framed[4:]
        for packet in self.assembler.take(kind, data):
            if len(packet) >= 12 and packet.source == OWN:
                if packet.hop >= len(ORDER) - 1:  # it has been home already
                    self.out.append(packet)
                    continue
                self.own.append(Own(self.now(), packet))
                for back in self.returns(packet) or []:
                    self.give(back)
            else:
                self.out.append(packet)

    @staticmethod
    def home(packet, fbc=None):
        """As three right relays give it back."""
        if fbc is None:
            fbc = 254 if packet.control else 1 if packet.interrupt else 32
        return packet.patched(len(ORDER) - 1, fbc)

    # ---- what cases ask for -------------------------------------------------------------------

    def source(self, node=FAR):
        """The node, just started anew, of which the node under test has heard."""
        if node not in self.sources:
            self.sources[node] = Source(self, node, next(self.boots))
            self.exchange(self.sources[node].hello())
        return self.sources[node]

    def exchange(self, *items):
        """Gives packets, or slices as (kind, data), and a marker behind them.
        @return the packets that the node has passed on before the marker"""
        for item in items:
            if isinstance(item, Packet):
                self.give(item)
            elif item is not None:
                self.slice(*item)
        return self.behind_marker()

    def behind_marker(self):
        mark = b'mark%d' % next(self.marks)
        first = len(self.out)
        begun = self.out_mark
        self.give(Packet.build(FAR, UP, 3 << 2, mark))

        def passed():
            return [i for i in range(first, len(self.out)) if self.out[i].data == mark]
        if not self.pump(passed):
            raise Failed('nothing is passed on any more: a good packet behind it does not come out within %g s' % WAIT)
        end = passed()[0]
        before = [one for one in self.out[begun:end] if not one.data.startswith(b'mark')]
        self.out_mark = end + 1
        return before

    def passes(self, packet, *slices):
        """The packet, as it leaves the node; given as one slice, or as these."""
        for one in self.exchange(*(slices or (packet,))):
            if one.source == packet.source and one.code == packet.code and one.interrupt == packet.interrupt:
                return one
        raise Failed('it is not passed on: %s' % packet.in_words())

    def passes_not(self, packet, why, *slices):
        for one in self.exchange(*(slices or (packet,))):
            if one.source == packet.source and one.code == packet.code:
                raise Failed('it is passed on, though %s: %s' % (why, one.in_words()))

    def fbc_of(self, packet):
        return self.passes(packet).fbc

    def expect(self, what, seen, wanted):
        if seen != wanted:
            raise Failed('%s is %s, %s expected' % (what, seen, wanted))

    def own_since(self, at, *conditions):
        return [one for one in self.own if one.at >= at and all(condition(one.packet) for condition in conditions)]

    def wait_own(self, what, *conditions, since=None, limit=WAIT):
        """The next packet of the node itself for which the conditions hold."""
        since = self.now() if since is None else since
        if not self.pump(lambda: self.own_since(since, *conditions), limit):
            raise Failed('no %s within %g s' % (what, limit))
        return self.own_since(since, *conditions)[0]

    def wait(self, what, condition, limit=WAIT):
        if not self.pump(condition, limit):
            raise Failed('%s, within %g s' % (what, limit))

    def needs_joins(self):
        if self.hopeless:
            raise NotRun('the node does not join at all')

    def needs_echo(self):
        if not self.echoes:
            raise NotApplicable('its CPU does not send packets of channel 0 back to their source')

    def count_echoes(self, data, *packets):
        """How often the CPU got these data."""
        begun = self.now()
        self.exchange(*packets)
        self.pump(limit=0.15)
        return len(self.own_since(begun, lambda p: not p.control and p.data == data and p.attempt == 0))

    @staticmethod
    def say(header):
        if header is None:
            return 'no answer'
        return '%s, refusal %d' % (wire.HEADER_NAMES.get(header.type, header.type), header.refusal)

    # ---- the node's life ------------------------------------------------------------------------

    def restart(self):
        """A fresh node; no line leads to it yet."""
        if not self.bench.can_start():
            raise NotRun('the kit did not start this node: give its program behind --')
        self.clean = False
        self.bench.stop()
        self.reset()
        self.out_mark = 0
        self.polled = None
        self.bench.start()

    def join(self, limit=3.0):
        """Both lines, and a beacon that has come home."""
        self.behave()
        end = self.now() + limit
        while True:
            problem = self.bench.problem()
            if problem:
                raise NotRun(problem)
            if self.input_session is None:
                try:
                    self.connect()
                except Failed:
                    if self.now() > end:
                        raise
                    continue
            begun = self.now()
            if self.pump(lambda: self.input_session is None or self.own_since(begun, is_beacon), 0.5) and (
                    self.input_session is not None and self.output_node == DOWN) and self.settles():
                break
            if self.now() > end:
                raise Failed('it does not join within %g s' % limit)
        self.clean = True

    def forget(self):
        self.behave()
        self.own, self.answers, self.asked = [], [], []
        self.out, self.out_mark, self.slices = [], 0, []
        self.disturbed, self.polled = False, None
        self.log.clear()

    def begin_fresh(self):
        """Before a case that starts the node itself."""
        self.forget()
        self.clean = False

    def begin(self):
        """Before each case: a node that has joined, and right neighbours."""
        self.forget()
        if self.bench.problem():
            if not self.bench.can_start():
                raise NotRun(self.bench.problem())
            self.restart()
        self.turn(0)
        if not self.clean or self.input_session is None or self.output_session is None or self.output_node != DOWN:
            self.join_somehow()

    def settles(self):
        """No new hello follows, as one does behind an open chain. (protocol.md section 8.4)"""
        begun = self.now()
        return not self.pump(lambda: self.own_since(begun, is_hello), SETTLED)

    def join_somehow(self):
        """Also by starting it again. What does not join is not tried: no rule is broken by that but those about joining."""
        if self.hopeless >= MOST_HOPELESS:
            raise NotRun('the node joins no more')
        try:
            try:
                self.join()
            except Failed:
                self.restart()
                self.join()
        except Failed as problem:
            self.hopeless += 1
            raise NotRun(str(problem)) from problem
        self.hopeless = 0

    def find_echo(self):
        self.echoes = True
        source = self.source()
        begun = self.now()
        self.exchange(source.packet(OWN, data=b'echo?', sequence=3))
        self.echoes = self.pump(lambda: self.own_since(begun, lambda p: p.data == b'echo?'), 0.5)


def is_hello(packet):
    return packet.control and packet.data[:1] == b'\x01'


def is_beacon(packet):
    return packet.control and packet.data[:1] == b'\x02'
