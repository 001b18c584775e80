"""The lines of a foreign node: handshakes of UNIX and UDP links, and slices. (protocol.md section 6)"""

import collections
import os
import socket
import struct

START, MORE, END, WHOLE, INTERRUPT, ABORT, IDLE, FOLD = 1, 2, 3, 4, 5, 6, 7, 8
CONNECT, ACCEPT, REFUSE, SLICES, ALIVE, BYE = 1, 2, 3, 4, 5, 6
NO_REFUSAL, BUSY, REPLACED, WRONG_RING, NOT_IN_RING, UNKNOWN_SESSION, WRONG_VERSION = 0, 1, 2, 3, 4, 5, 7
OTHER_RING_FILE, LAST_REFUSAL = 9, 12
VERSION = 3

LinkHeader = collections.namedtuple('LinkHeader', 'magic version type ring session sequence sender refusal')
LINK_HEADER = struct.Struct('>HBBQQIBB')


TIMEOUTS = {'send': 100, 'stall': 50, 'idle': 50, 'silence': 250, 'first_successor': 200, 'break_grace': 200,
            'fold_permission': 200, 'beacon': 100}  # protocol.md section 7.4
PARTS = 7
AGREEMENT = struct.Struct('>%dQ' % PARTS)


def text_hash(text):
    """FNV-1a, 64 bits. (protocol.md section 6.5)"""
    value = 0xCBF29CE484222325
    for byte in text.encode():
        value = (value ^ byte) * 0x100000001B3 % 2 ** 64
    return value


def agreement(names, redundancy='none', timeouts=TIMEOUTS):
    """Of a ring of nodes 0, 1, ... without joints, on lines as fast as the host, with the usual pins; node 0 watches.
    (protocol.md section 6.13)"""
    def each(words):
        return ''.join('%d%s\n' % (node, words(name)) for node, name in enumerate(names))
    return AGREEMENT.pack(*map(text_hash, (
        each(lambda name: ' ' + name), redundancy + '\n', ''.join('%d\n' % time for time in timeouts.values()),
        each(lambda _: ' 0 0'), each(lambda _: ''), each(lambda _: ' reset stop sync' + ' none' * 5), '0\n')))


def random_number():
    return int.from_bytes(os.urandom(4), 'big') or 1


def slice_of(kind, data=b''):
    return struct.pack('>BBH', 0xA7, kind, len(data)) + data


def fits(data):
    """Whether this is one slice. (protocol.md section 6.2)"""
    if len(data) < 4 or data[0] != 0xA7 or struct.unpack_from('>H', data, 2)[0] != len(data) - 4:
        return False
    size = len(data) - 4
    return {START: 4 <= size <= 516 and size % 4 == 0, MORE: 4 <= size <= 512 and size % 4 == 0, END: 8 <= size <= 520,
            WHOLE: 13 <= size <= 524, INTERRUPT: size == 12, ABORT: size == 0, IDLE: size == 0, FOLD: size == 3}.get(data[1], False)


def received(stream, size, flags=0):
    """Nothing where the other end has closed, also while something was on its way to it."""
    try:
        return stream.recv(size, flags)
    except OSError:
        return b''


def tell(stream, header):
    try:
        stream.sendall(header)
    except OSError:
        pass  # the other end has closed, which reading will show


class UnixInput:
    """Listens for the upstream neighbour. (protocol.md section 6.6)"""

    def __init__(self, line, path):
        self.line, self.path, self.stream, self.pending, self.buffer = line, path, None, [], b''
        self.door = socket.socket(socket.AF_UNIX)
        self.door.bind(path)
        os.chmod(path, 0o600)
        self.door.listen(8)

    def up(self):
        return self.stream is not None

    def sockets(self):
        return [self.door] + self.pending + ([self.stream] if self.stream else [])

    def read(self, which):
        if which is self.door:
            self.pending.append(self.door.accept()[0])
        elif which is self.stream:
            data = received(self.stream, 65536)
            if not data:
                return self.lose()
            self.buffer = self.line.take_slices(self.buffer + data)
        else:
            self.greet(which)

    def greet(self, connection):
        self.pending.remove(connection)
        data = received(connection, LINK_HEADER.size + AGREEMENT.size, socket.MSG_WAITALL)
        if len(data) < LINK_HEADER.size:
            return connection.close()
        connect = LinkHeader._make(LINK_HEADER.unpack_from(data))
        refusal = self.line.judge(connect, data[LINK_HEADER.size:])
        if refusal != NO_REFUSAL:
            tell(connection, self.line.refuse(refusal, data))
            return connection.close()
        if self.stream:
            tell(self.stream, self.line.header(REFUSE, refusal=REPLACED))
            self.stream.close()
        tell(connection, self.line.header(ACCEPT, connect.session))
        self.stream, self.buffer, self.line.sender = connection, b'', connect.sender

    def lose(self):
        self.stream.close()
        self.stream = None

    def tick(self):
        if self.stream:
            tell(self.stream, self.line.header(ALIVE))

    def close(self):
        os.unlink(self.path)
        for each in self.sockets():
            each.close()


class UnixOutput:
    """Connects to the downstream neighbour."""

    def __init__(self, line, path):
        self.line, self.path, self.stream, self.accepted, self.cut = line, path, None, False, False

    def up(self):
        return self.accepted

    def sockets(self):
        return [self.stream] if self.stream else []

    def read(self, _):
        data = received(self.stream, LINK_HEADER.size, socket.MSG_WAITALL)
        kind = LinkHeader._make(LINK_HEADER.unpack(data)).type if len(data) == LINK_HEADER.size else REFUSE
        if kind == REFUSE:
            self.lose()
        elif kind == ACCEPT:
            self.accepted = True
            self.write(slice_of(IDLE))

    def write(self, data):
        if self.accepted:
            try:
                self.stream.sendall(data)
            except OSError:
                self.lose()

    def lose(self):
        self.stream.close()
        self.stream, self.accepted = None, False

    def tick(self):
        if self.cut and self.stream:
            self.lose()
        if self.cut:
            return
        if self.stream:
            return self.write(slice_of(IDLE))
        stream = socket.socket(socket.AF_UNIX)
        try:
            stream.connect(self.path)
            stream.sendall(self.line.connect(random_number()))
            self.stream = stream
        except OSError:
            stream.close()

    def close(self):
        if self.stream:
            self.stream.close()


class UdpInput:
    """Offers sessions, and takes slices in one. (protocol.md section 6.7)"""

    def __init__(self, line, address):
        self.line, self.offers, self.session, self.next = line, {}, None, 1
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(address)

    def up(self):
        return self.session is not None

    def sockets(self):
        return [self.socket]

    def read(self, _):
        data, address = self.socket.recvfrom(2048)
        if len(data) < LINK_HEADER.size:
            return
        header = LinkHeader._make(LINK_HEADER.unpack_from(data))
        if header.magic != 0x4C52 or header.refusal > LAST_REFUSAL or (header.version != VERSION and header.type != CONNECT):
            return
        if header.type == CONNECT:
            self.connect(header, data, address)
        elif header.ring != self.line.ring:
            return
        elif header.type == SLICES:
            self.slices(header, data[LINK_HEADER.size:], address)
        elif header.type == BYE and self.session == (header.sender, header.session):
            self.session = None

    def connect(self, header, data, address):
        refusal = self.line.judge(header, data[LINK_HEADER.size:])
        if refusal != NO_REFUSAL:
            return self.socket.sendto(self.line.refuse(refusal, data, header.session), address)
        number = header.session >> 32
        if self.session and self.session[0] == header.sender and self.session[1] >> 32 == number:
            offer = self.session[1]
        else:
            offer = self.offers.get(header.sender, 0)
            if offer >> 32 != number:
                offer = self.offers[header.sender] = number << 32 | random_number()
        self.socket.sendto(self.line.header(ACCEPT, offer), address)

    def slices(self, header, data, address):
        if self.session != (header.sender, header.session):
            if self.offers.get(header.sender) != header.session:
                return self.socket.sendto(
                    self.line.header(REFUSE, header.session, refusal=UNKNOWN_SESSION), address)
            del self.offers[header.sender]
            if self.session:
                self.socket.sendto(self.line.header(REFUSE, self.session[1], refusal=REPLACED), self.address)
                self.line.gap()
            self.session, self.next, self.address = (header.sender, header.session), 1, address
            self.line.sender = header.sender
        missing = (header.sequence - self.next) % 2 ** 32
        if missing >= 2 ** 31:
            return
        if missing:
            self.line.gap()
        self.next = (header.sequence + 1) % 2 ** 32
        if not fits(data):
            return self.line.gap()
        self.line.take_slices(data)

    def tick(self):
        if self.session:
            self.socket.sendto(self.line.header(ALIVE, self.session[1]), self.address)

    def close(self):
        self.socket.close()


class UdpOutput:
    def __init__(self, line, address):
        self.line, self.number, self.session, self.sequence = line, random_number(), None, 1
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(address)

    def up(self):
        return self.session is not None

    def sockets(self):
        return [self.socket]

    def read(self, _):
        try:
            header = LinkHeader._make(LINK_HEADER.unpack(self.socket.recv(2048)))
        except OSError:
            self.session = None  # port unreachable
            return
        if header.session >> 32 != self.number:
            return
        if header.type == REFUSE:
            self.number, self.session = random_number(), None
        elif header.type == ACCEPT and self.session is None and header.ring == self.line.ring:
            self.session, self.sequence = header.session, 1
            self.write(slice_of(IDLE))

    def write(self, data):
        while self.session is not None and data:
            size = 4 + struct.unpack_from('>H', data, 2)[0]
            header = self.line.header(SLICES, self.session, self.sequence)
            self.sequence = (self.sequence + 1) % 2 ** 32
            self.socket.send(header + data[:size])
            data = data[size:]

    def tick(self):
        try:
            if self.session is None:
                self.socket.send(self.line.connect(self.number))
            else:
                self.write(slice_of(IDLE))
        except OSError:
            self.session = None

    def close(self):
        self.socket.close()


class Line:
    """One of the lines of a node: where it comes in and where it goes out. `order` is that in which it runs."""

    def __init__(self, ring, node, order, listen, connect_to, agreement):
        self.ring, self.id, self.order = text_hash(ring), node, order
        self.agreement = agreement
        self.sender = order[order.index(node) - 1]
        self.successor = order[(order.index(node) + 1) % len(order)]
        self.on_slice, self.gap = lambda kind, data: None, lambda: None
        unix = isinstance(listen, str)
        self.input = (UnixInput if unix else UdpInput)(self, listen)
        self.output = (UnixOutput if unix else UdpOutput)(self, connect_to)

    def header(self, kind, session=0, sequence=0, refusal=NO_REFUSAL):
        return LINK_HEADER.pack(0x4C52, VERSION, kind, self.ring, session, sequence, self.id, refusal)

    def connect(self, number):
        return self.header(CONNECT, number << 32) + self.agreement

    def refuse(self, refusal, connect, session=0):
        """protocol.md section 6.13: which parts differ."""
        parts = 0
        if refusal == OTHER_RING_FILE:
            theirs = AGREEMENT.unpack_from(connect, LINK_HEADER.size)
            parts = sum(1 << i for i, ours in enumerate(AGREEMENT.unpack(self.agreement)) if ours != theirs[i])
        return self.header(REFUSE, session, parts, refusal)

    def distance(self, node):
        return (self.order.index(self.id) - self.order.index(node)) % len(self.order) or len(self.order)

    def judge(self, connect, agreement):
        """protocol.md section 6.8"""
        agreement = agreement[:AGREEMENT.size]  # what stands behind it is ignored
        if connect.version != VERSION:
            return WRONG_VERSION
        if connect.ring != self.ring:
            return WRONG_RING
        if agreement != self.agreement:
            return OTHER_RING_FILE
        if connect.sender not in self.order:
            return NOT_IN_RING
        if self.input.up() and self.distance(connect.sender) > self.distance(self.sender):
            return BUSY
        return NO_REFUSAL

    def take_slices(self, data):
        """Returns what is not a whole slice yet."""
        while len(data) >= 4:
            magic, kind, size = struct.unpack_from('>BBH', data)
            assert magic == 0xA7
            if len(data) < 4 + size:
                break
            self.on_slice(kind, data[4:4 + size])
            data = data[4 + size:]
        return data

    def read(self, readable):
        for which in readable:
            for end in (self.input, self.output):
                if which in end.sockets():
                    end.read(which)

    def tick(self):
        self.input.tick()
        self.output.tick()

    def sockets(self):
        return self.input.sockets() + self.output.sockets()

    def close(self):
        self.input.close()
        self.output.close()
