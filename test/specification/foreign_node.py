"""A node of the ring written from docs/protocol.md alone, with nothing of the project's code: small and slow, but a node.
Its CPU takes all, and its pins are only noted. It passes packets on only when they are whole, and it knows no bypass, open
chain or fold."""

import collections
import os
import select
import socket
import struct
import threading
import time
import zlib

VERSION, SOP, EOP, ALL, UNTAKEN = 1, 0xFB, 0xFD, 0xFF, 0xFF
START, MORE, END, WHOLE, INTERRUPT, ABORT, IDLE = 1, 2, 3, 4, 5, 6, 7
CONNECT, ACCEPT, REFUSE, SLICES, ALIVE, BYE = 1, 2, 3, 4, 5, 6
NO_REFUSAL, BUSY, REPLACED, WRONG_RING, NOT_IN_RING, UNKNOWN_SESSION = 0, 1, 2, 3, 4, 5
HELLO, BEACON = 1, 2
CONTROL_PRI = 1 << 2  # channel 1, priority 0
TRY_TIMEOUT, BEACON_PERIOD, TICK = 1.0, 0.1, 0.01
FREE_BUFFERS = 32

LinkHeader = collections.namedtuple('LinkHeader', 'magic version type ring session sequence sender refusal')
LINK_HEADER = struct.Struct('>HBBQQIBB')
Outstanding = collections.namedtuple('Outstanding', 'packet token due')


def ring_hash(name):
    """FNV-1a, 64 bits. (protocol.md section 6.5)"""
    value = 0xCBF29CE484222325
    for byte in name.encode():
        value = (value ^ byte) * 0x100000001B3 % 2 ** 64
    return value


def crc(data):
    return struct.pack('>I', zlib.crc32(data))


def change(delta, after):
    """What XORing `delta` into a byte does to the CRC. (protocol.md section 3.7)"""
    value = delta
    for _ in range(8 * (after + 1)):
        value = value >> 1 ^ (0xEDB88320 if value & 1 else 0)
    return value


def with_hop_and_fbc(packet, hop, fbc):
    """By the patch rule: a wrong CRC stays wrong."""
    patched = (int.from_bytes(packet[-4:], 'big') ^ change(packet[2] ^ hop, len(packet) - 7) ^
               change(packet[-7] ^ fbc, 2))
    out = bytearray(packet)
    out[2], out[-7], out[-4:] = hop, fbc, struct.pack('>I', patched)
    return bytes(out)


def slice_of(kind, data=b''):
    return struct.pack('>BBH', 0xA7, kind, len(data)) + data


class UnixInput:
    """Listens for the upstream neighbour. (protocol.md section 6.6)"""

    def __init__(self, node, path):
        self.node, self.path, self.stream, self.pending, self.buffer = node, path, None, [], b''
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
            data = self.stream.recv(65536)
            if not data:
                self.stream = None
                return
            self.buffer = self.node.take_slices(self.buffer + data)
        else:
            self.greet(which)

    def greet(self, guest):
        self.pending.remove(guest)
        data = guest.recv(LINK_HEADER.size, socket.MSG_WAITALL)
        if len(data) != LINK_HEADER.size:
            return guest.close()
        connect = LinkHeader._make(LINK_HEADER.unpack(data))
        refusal = self.node.judge(connect)
        if refusal != NO_REFUSAL:
            guest.sendall(self.node.link_header(REFUSE, refusal=refusal))
            return guest.close()
        if self.stream:
            self.stream.sendall(self.node.link_header(REFUSE, refusal=REPLACED))
            self.stream.close()
        guest.sendall(self.node.link_header(ACCEPT, connect.session))
        self.stream, self.buffer, self.node.input_from = guest, b'', connect.sender

    def tick(self):
        if self.stream:
            try:
                self.stream.sendall(self.node.link_header(ALIVE))
            except OSError:
                self.stream = None

    def close(self):
        os.unlink(self.path)
        for each in self.sockets():
            each.close()


class UnixOutput:
    """Connects to the downstream neighbour."""

    def __init__(self, node, path):
        self.node, self.path, self.stream, self.accepted = node, path, None, False

    def up(self):
        return self.accepted

    def sockets(self):
        return [self.stream] if self.stream else []

    def read(self, _):
        data = self.stream.recv(LINK_HEADER.size, socket.MSG_WAITALL)
        kind = LinkHeader._make(LINK_HEADER.unpack(data)).type if len(data) == LINK_HEADER.size else REFUSE
        if kind == REFUSE:
            self.stream, self.accepted = None, False
        elif kind == ACCEPT:
            self.accepted = True
            self.write(slice_of(IDLE))

    def write(self, data):
        if self.accepted:
            self.stream.sendall(data)

    def tick(self):
        if self.stream:
            return self.write(slice_of(IDLE))
        stream = socket.socket(socket.AF_UNIX)
        try:
            stream.connect(self.path)
            stream.sendall(self.node.link_header(CONNECT, self.node.random_number() << 32))
            self.stream = stream
        except OSError:
            stream.close()

    def close(self):
        if self.stream:
            self.stream.close()


class UdpInput:
    """Offers sessions, and takes slices in one. (protocol.md section 6.7)"""

    def __init__(self, node, address):
        self.node, self.offers, self.session, self.next = node, {}, None, 1
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
        if header.magic != 0x4C52 or header.version != 1:
            return
        if header.type == CONNECT:
            self.connect(header, address)
        elif header.ring != self.node.ring:
            return
        elif header.type == SLICES:
            self.slices(header, data[LINK_HEADER.size:], address)
        elif header.type == BYE and self.session == (header.sender, header.session):
            self.session = None

    def connect(self, header, address):
        refusal = self.node.judge(header)
        if refusal != NO_REFUSAL:
            return self.socket.sendto(self.node.link_header(REFUSE, header.session, refusal=refusal), address)
        number = header.session >> 32
        if self.session and self.session[0] == header.sender and self.session[1] >> 32 == number:
            offer = self.session[1]
        else:
            offer = self.offers.get(header.sender, 0)
            if offer >> 32 != number:
                offer = self.offers[header.sender] = number << 32 | self.node.random_number()
        self.socket.sendto(self.node.link_header(ACCEPT, offer), address)

    def slices(self, header, data, address):
        if self.session != (header.sender, header.session):
            if self.offers.get(header.sender) != header.session:
                return self.socket.sendto(
                    self.node.link_header(REFUSE, header.session, refusal=UNKNOWN_SESSION), address)
            del self.offers[header.sender]
            self.session, self.next, self.address = (header.sender, header.session), 1, address
            self.node.input_from = header.sender
        missing = (header.sequence - self.next) % 2 ** 32
        if missing >= 2 ** 31:
            return
        if missing:
            self.node.break_off()
        self.next = (header.sequence + 1) % 2 ** 32
        self.node.take_slices(data)

    def tick(self):
        if self.session:
            self.socket.sendto(self.node.link_header(ALIVE, self.session[1]), self.address)

    def close(self):
        self.socket.close()


class UdpOutput:
    def __init__(self, node, address):
        self.node, self.number, self.session, self.sequence = node, node.random_number(), None, 1
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
            self.number, self.session = self.node.random_number(), None
        elif header.type == ACCEPT and self.session is None and header.ring == self.node.ring:
            self.session, self.sequence = header.session, 1
            self.write(slice_of(IDLE))

    def write(self, data):
        while self.session is not None and data:
            size = 4 + struct.unpack_from('>H', data, 2)[0]
            header = self.node.link_header(SLICES, self.session, self.sequence)
            self.sequence = (self.sequence + 1) % 2 ** 32
            self.socket.send(header + data[:size])
            data = data[size:]

    def tick(self):
        try:
            if self.session is None:
                self.socket.send(self.node.link_header(CONNECT, self.number << 32))
            else:
                self.write(slice_of(IDLE))
        except OSError:
            self.session = None

    def close(self):
        self.socket.close()


class Node(threading.Thread):
    """One node. `listen` and `successor` are paths of UNIX sockets or (address, port) of UDP ones."""

    def __init__(self, ring, node, order, listen, successor):
        super().__init__(daemon=True)
        self.id, self.order, self.ring = node, order, ring_hash(ring)
        self.input_from, self.boot = 0, time.time_ns()
        self.received, self.pins, self.ended, self.peers = [], [], {}, {}
        self.joined, self.size, self.tokens, self.damaged_returns = False, 0, 0, 0
        self.numbers, self.memory = collections.Counter(), {}
        self.queue = {False: collections.deque(), True: collections.deque()}  # by kind: INTP or not
        self.out = {False: None, True: None}
        self.coming, self.beacon_due, self.hello_asked = None, 0, False
        self.lock, self.stopped = threading.RLock(), False
        unix = isinstance(listen, str)
        self.input = (UnixInput if unix else UdpInput)(self, listen)
        self.output = (UnixOutput if unix else UdpOutput)(self, successor)

    # ---- the event loop -------------------------------------------------------------------

    def run(self):
        ticked = 0
        while not self.stopped:
            readable = select.select(self.input.sockets() + self.output.sockets(), [], [], TICK)[0]
            with self.lock:
                for which in readable:
                    for end in (self.input, self.output):
                        if which in end.sockets():
                            end.read(which)
                if time.monotonic() - ticked >= TICK:
                    ticked = time.monotonic()
                    self.input.tick()
                    self.output.tick()
                self.transmit()
        self.input.close()
        self.output.close()

    def stop(self):
        self.stopped = True
        self.join()  # the thread

    # ---- links ----------------------------------------------------------------------------

    @staticmethod
    def random_number():
        return int.from_bytes(os.urandom(4), 'big') or 1

    def link_header(self, kind, session=0, sequence=0, refusal=NO_REFUSAL):
        return LINK_HEADER.pack(0x4C52, 1, kind, self.ring, session, sequence, self.id, refusal)

    def distance(self, node):
        return (self.order.index(self.id) - self.order.index(node)) % len(self.order) or len(self.order)

    def judge(self, connect):
        """protocol.md section 6.8"""
        if connect.ring != self.ring:
            return WRONG_RING
        if connect.sender not in self.order:
            return NOT_IN_RING
        if self.input.up() and self.distance(connect.sender) > self.distance(self.input_from):
            return BUSY
        return NO_REFUSAL

    def take_slices(self, data):
        """Returns what is not a whole slice yet."""
        while len(data) >= 4:
            magic, kind, size = struct.unpack_from('>BBH', data)
            assert magic == 0xA7
            if len(data) < 4 + size:
                break
            self.take_slice(kind, data[4:4 + size])
            data = data[4 + size:]
        return data

    def take_slice(self, kind, data):
        if kind == WHOLE:
            self.take(data, False)
        elif kind == INTERRUPT:
            self.take(data, True)
        elif kind == START:
            self.coming = data
        elif kind == ABORT:
            self.break_off()
        elif kind in (MORE, END) and self.coming is not None:
            self.coming += data
            if kind == END:
                packet, self.coming = self.coming, None
                self.take(packet, False)

    def break_off(self):
        self.coming = None  # passed on only as a whole: there is nothing to abort

    # ---- Relay and Receive ----------------------------------------------------------------

    def take(self, packet, interrupt):
        code, sop, hop, source = packet[:4]
        if code >> 6 != VERSION or bool(code >> 5 & 1) != interrupt or sop != SOP or source == ALL:
            return
        good = crc(packet[:-4]) == packet[-4:] and packet[-8] == EOP
        if source == self.id:
            if good:
                self.came_home(packet, interrupt)
            else:
                self.damaged_returns += 1
            return
        if hop + 1 >= len(self.order):
            return
        fbc = self.receive(packet, interrupt) if good else packet[-7]
        self.output.write(slice_of(INTERRUPT if interrupt else WHOLE, with_hop_and_fbc(packet, hop + 1, fbc)))

    def receive(self, packet, interrupt):
        """Returns the FBC with which it goes on. (protocol.md section 3.5)"""
        source, fbc, destination, last = packet[3], packet[-7], packet[-6], packet[-5]
        control = not interrupt and last >> 2 == 1
        if control:
            self.hear(source, packet[4:-8])
        if destination not in (self.id, ALL):
            return fbc
        if control:
            return min(fbc, 254)
        memory = (source, interrupt, destination == ALL)
        sequence = packet[0] & 7
        if self.memory.get(memory, (None,))[0] == sequence:
            return min(fbc, self.memory[memory][1])
        verdict = 1 if interrupt else FREE_BUFFERS if self.joined else 0
        self.memory[memory] = (sequence, verdict)
        if interrupt:
            self.pins.append((last & 7, source))
        elif self.joined:
            self.received.append((source, last & 3, last >> 2, packet[4:-8]))
        return min(fbc, verdict)

    def hear(self, source, data):
        if data[0] == HELLO and len(data) == 10 or data[0] == BEACON and len(data) == 26:
            boot = struct.unpack_from('>Q', data, 1)[0]
            if self.peers.get(source, boot if data[0] == BEACON else None) != boot:
                self.memory = {key: value for key, value in self.memory.items() if key[0] != source}
            self.peers[source] = boot

    # ---- Transmit -------------------------------------------------------------------------

    def send(self, destination, data, priority=2, channel=0):
        return self.ask(False, destination, channel << 2 | priority, data)

    def interrupt(self, destination, factor):
        return self.ask(True, destination, factor, b'')

    def ask(self, interrupt, destination, last, data):
        """Its outcome comes into `ended` under the token that is returned."""
        with self.lock:
            self.tokens += 1
            self.queue[interrupt].append((destination, last, data, self.tokens))
            return self.tokens

    def transmit(self):
        if not self.joined:
            if not self.hello_asked and self.input.up() and self.output.up():
                self.hello_asked = True
                self.queue[False].appendleft((ALL, CONTROL_PRI, struct.pack('>BQB', HELLO, self.boot, 0), 'hello'))
        elif time.monotonic() >= self.beacon_due:
            self.beacon_due = time.monotonic() + BEACON_PERIOD
            self.queue[False].append((ALL, CONTROL_PRI, self.beacon(), 'beacon'))
        for interrupt in (True, False):
            self.transmit_kind(interrupt)

    def transmit_kind(self, interrupt):
        out, queue = self.out[interrupt], self.queue[interrupt]
        if out and time.monotonic() >= out.due:
            self.failed(interrupt)
        elif not out and queue and (self.joined or queue[0][3] == 'hello'):
            destination, last, data, token = queue.popleft()
            sequence = self.numbers[destination, interrupt]
            self.numbers[destination, interrupt] = (sequence + 1) % 8
            code = VERSION << 6 | interrupt << 5 | sequence
            self.launch(interrupt, bytes([code, SOP, 0, self.id]) + data + bytes([EOP, UNTAKEN, destination, last]),
                        token)

    def launch(self, interrupt, covered, token):
        packet = covered + crc(covered)
        self.out[interrupt] = Outstanding(packet, token, time.monotonic() + TRY_TIMEOUT)
        self.output.write(slice_of(INTERRUPT if interrupt else WHOLE, packet))

    def failed(self, interrupt):
        out = self.out[interrupt]
        if out.packet[0] >> 3 & 3 == 3:
            return self.end(interrupt, 'lost')
        self.launch(interrupt, bytes([out.packet[0] + (1 << 3)]) + out.packet[1:-4], out.token)

    def beacon(self):
        return struct.pack('>BQIBIBBBBBBBB', BEACON, self.boot, 1, 3, 0, self.input.up(), self.input_from,
                           self.output.up(), self.order[(self.order.index(self.id) + 1) % len(self.order)], 0, 0, 0, 1)

    def came_home(self, packet, interrupt):
        out = self.out[interrupt]
        if out is None or with_hop_and_fbc(packet, 0, UNTAKEN) != out.packet:
            return
        self.size = packet[2] + 1
        fbc, repeated = packet[-7], out.packet[0] >> 3 & 3 > 0
        if 0 < fbc < UNTAKEN:
            self.end(interrupt, 'delivered')
        else:
            self.end(interrupt, 'lost' if repeated else 'refused' if fbc == 0 else 'no such node')

    def end(self, interrupt, outcome):
        token, self.out[interrupt] = self.out[interrupt].token, None
        if token == 'hello':
            self.joined, self.hello_asked = outcome != 'lost', False
        elif token != 'beacon':
            self.ended[token] = outcome
