"""Bytes on a line, as docs/protocol.md has them: packets, slices, link headers."""

import collections
import struct
import zlib

SOP, EOP, ALL, UNTAKEN = 0xFB, 0xFD, 0xFF, 0xFF
START, MORE, END, WHOLE, INTERRUPT, ABORT, IDLE, FOLD = range(1, 9)
CONNECT, ACCEPT, REFUSE, SLICES, ALIVE, BYE, CONNECT_MEMORY, CONNECT_KEYED = range(1, 9)
BUSY, REPLACED, WRONG_RING, NOT_IN_RING, UNKNOWN_SESSION, CLOSING, WRONG_VERSION = range(1, 8)
OTHER_RING_FILE, NO_KEY = 9, 11
HELLO, BEACON = 1, 2
# (sizes), written by docs/generate_reference.py
HELLO_SIZE, BEACON_SIZES = 10, (26, 40)
# end of it
CONTROL = 1 << 2  # PRI of channel 1, priority 0
VERSION = 3
SLICE_NAMES = {START: 'start', MORE: 'more', END: 'end', WHOLE: 'whole', INTERRUPT: 'interrupt', ABORT: 'abort',
               IDLE: 'idle', FOLD: 'fold'}
HEADER_NAMES = {CONNECT: 'connect', ACCEPT: 'accept', REFUSE: 'refuse', SLICES: 'slices', ALIVE: 'alive', BYE: 'bye',
                CONNECT_MEMORY: 'connect_memory', CONNECT_KEYED: 'connect_keyed'}

# In ms; protocol.md section 7.4. Those of the agreement (6.13) first, in its order.
TIMES = {'send': 100, 'stall': 50, 'idle': 50, 'silence': 250, 'first_successor': 200, 'break_grace': 200,
         'fold_permission': 200, 'beacon': 100}

Header = collections.namedtuple('Header', 'magic version type ring session sequence sender refusal')
HEADER = struct.Struct('>HBBQQIBB')
MAGIC = 0x4C52
AGREEMENT_SIZE = 56


def text_hash(text):
    """FNV-1a, 64 bits. (protocol.md section 6.5)"""
    value = 0xCBF29CE484222325
    for byte in text.encode():
        value = (value ^ byte) * 0x100000001B3 % 2 ** 64
    return value


def agreement(order, names):
    """Of a ring without joints on lines as fast as the host; the first node watches. (protocol.md section 6.13)"""
    def each(words):
        return ''.join('%d%s\n' % (node, words(name)) for node, name in zip(order, names))
    texts = (each(lambda name: ' ' + name), 'none\n', ''.join('%d\n' % time for time in TIMES.values()),
             each(lambda _: ' 0 0'), each(lambda _: ''), each(lambda _: ' reset stop sync' + ' none' * 5), '%d\n' % order[0])
    return struct.pack('>7Q', *map(text_hash, texts))


def crc(data):
    return struct.pack('>I', zlib.crc32(data))


_CHANGES = {}


def change(delta, after):
    """What XORing `delta` into a byte with `after` more behind it does to the CRC. (protocol.md section 3.7)"""
    if (delta, after) not in _CHANGES:
        value = delta
        for _ in range(8 * (after + 1)):
            value = value >> 1 ^ (0xEDB88320 if value & 1 else 0)
        _CHANGES[delta, after] = value
    return _CHANGES[delta, after]


class Packet(bytes):
    """A whole DATP or INTP, right or wrong."""

    code = property(lambda self: self[0])
    incarnation = property(lambda self: self[0] >> 6)
    interrupt = property(lambda self: bool(self[0] >> 5 & 1))
    attempt = property(lambda self: self[0] >> 3 & 3)
    sequence = property(lambda self: self[0] & 7)
    hop = property(lambda self: self[2])
    source = property(lambda self: self[3])
    data = property(lambda self: self[4:-8])
    fbc = property(lambda self: self[-7])
    destination = property(lambda self: self[-6])
    last = property(lambda self: self[-5])
    control = property(lambda self: not self.interrupt and self.last >> 2 == 1)
    right = property(lambda self: crc(self[:-4]) == self[-4:])

    @classmethod
    def build(cls, source, destination, last=0, data=b'', interrupt=False, incarnation=0, attempt=0, sequence=0, hop=0,
              fbc=UNTAKEN, sop=SOP, eop=EOP):
        code = incarnation << 6 | interrupt << 5 | attempt << 3 | sequence
        covered = bytes([code, sop, hop, source]) + data + bytes([eop, fbc, destination, last])
        return cls(covered + crc(covered))

    def patched(self, hop=None, fbc=None):
        """By the patch rule: what is wrong stays wrong. (protocol.md section 3.7)"""
        hop, fbc = self.hop if hop is None else hop, self.fbc if fbc is None else fbc
        value = (int.from_bytes(self[-4:], 'big') ^ change(self.hop ^ hop, len(self) - 7) ^ change(self.fbc ^ fbc, 2))
        out = bytearray(self)
        out[2], out[-7], out[-4:] = hop, fbc, struct.pack('>I', value)
        return Packet(out)

    def damaged(self):
        """One bit of the data, or of the DID where there are none."""
        out = bytearray(self)
        out[4 if len(self) > 12 else -6] ^= 0x10
        return Packet(out)

    def but_for_the_relay(self):
        """What a relay must not change."""
        return self[:2] + self[3:-7] + self[-6:-4]

    def in_words(self):
        kind = 'INTP' if self.interrupt else 'hello' if self.control and self.data[:1] == b'\x01' else (
            'beacon' if self.control and self.data[:1] == b'\x02' else 'DATP')
        what = 'INT %d' % self.last if self.interrupt else 'channel %d priority %d, %d bytes' % (
            self.last >> 2, self.last & 3, len(self.data))
        to = 'all' if self.destination == ALL else 'node %d' % self.destination
        return '%s from node %d to %s: incarnation %d, try %d, number %d, HOP %d, FBC %d, %s%s' % (
            kind, self.source, to, self.incarnation, self.attempt, self.sequence, self.hop, self.fbc, what,
            '' if self.right else ', CRC wrong')


def hello(boot, remembers=0):
    return struct.pack('>BQB', HELLO, boot, remembers)


def beacon(boot, tail=b'', broken=None, input_state=1):
    """@param broken: (before, behind) of a break that is known"""
    before, behind = broken or (0, 0)
    return struct.pack('>BQIBIBBBBBBBB', BEACON, boot, 1, 3, 12, input_state, 0, 1, 0, broken is not None, before, behind, 1) + tail


def slice_of(kind, data=b''):
    return struct.pack('>BBH', 0xA7, kind, len(data)) + data


def slices_of(packet):
    """As one slice."""
    return [(INTERRUPT if packet.interrupt else WHOLE, bytes(packet))]


class Assembler:
    """Slices of one line into packets; an abort gives None."""

    def __init__(self):
        self.open = None

    def take(self, kind, data):
        """@return the packets that are whole now"""
        if kind in (WHOLE, INTERRUPT):
            return [Packet(data)]
        if kind == START:
            self.open = data
        elif kind == ABORT:
            self.open = None
        elif kind in (MORE, END) and self.open is not None:
            self.open += data
            if kind == END:
                done, self.open = Packet(self.open), None
                return [done]
        return []
