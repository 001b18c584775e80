"""A node of the ring written from docs/protocol.md alone, with nothing of the project's code: small and slow, but a node.
Its CPU takes all, and its pins are only noted. It passes packets on only when they are whole, and it knows no bypass, no
open chain and no refusals of others. known_failures.yaml says what the conformance kit finds."""

import collections
import select
import struct
import threading
import time
import zlib

from foreign_fold import Fold, NoFold
from foreign_links import ABORT, END, INTERRUPT, MORE, START, WHOLE, slice_of

SOP, EOP, ALL, UNTAKEN = 0xFB, 0xFD, 0xFF, 0xFF
HELLO, BEACON = 1, 2
OVERHEAD = 12  # bytes of a DATP that are no data
CONTROL_PRI = 1 << 2  # channel 1, priority 0
TRY_TIMEOUT, BEACON_PERIOD, TICK = 1.0, 0.1, 0.01
FREE_BUFFERS = 32
WIRED = (0, 1, 2)  # pins: reset, stop, sync

Outstanding = collections.namedtuple('Outstanding', 'packet token due')


class Page:
    """What is remembered of a source. (protocol.md section 4.10)"""

    def __init__(self, incarnation, boot=0):
        self.incarnation, self.boot, self.verdicts = incarnation, boot, {}


def boot_number(last):
    """Of the clock, its two low bits the next after those of the last one. (protocol.md section 4.8)"""
    return max((time.time_ns() | 3) + 1 + (last + 1 & 3), last + 1) if last else time.time_ns()


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


class Node(threading.Thread):
    """One node. `second`: its second line, if the ring folds back."""

    relays, adds_hop = True, 1   # changed by tests of what others say of a node that is wrong

    def __init__(self, line, second=None, last_boot=0):
        super().__init__(daemon=True)
        self.id, self.order, self.boot = line.id, line.order, boot_number(last_boot)
        self.received, self.pins, self.ended, self.pages = [], [], {}, {}
        self.joined, self.size, self.tokens, self.damaged_returns = False, 0, 0, 0
        self.numbers = collections.Counter()
        self.queue = {False: collections.deque(), True: collections.deque()}  # by kind: INTP or not
        self.out = {False: None, True: None}
        self.coming, self.beacon_due, self.hello_asked = None, 0, False
        self.lock, self.stopped = threading.RLock(), False
        self.line, self.lines = line, [line] + ([second] if second else [])
        self.fold = Fold(self, line, second) if second else NoFold(self, line)

    # ---- the event loop -------------------------------------------------------------------

    def run(self):
        ticked = 0
        while not self.stopped:
            readable = select.select(sum((line.sockets() for line in self.lines), []), [], [], TICK)[0]
            with self.lock:
                for line in self.lines:
                    line.read(readable)
                if time.monotonic() - ticked >= TICK:
                    ticked = time.monotonic()
                    for line in self.lines:
                        line.tick()
                self.fold.poll(time.monotonic())
                self.transmit()
        for line in self.lines:
            line.close()

    def stop(self):
        self.stopped = True
        self.join()  # the thread

    def write(self, kind, packet):
        self.fold.write(slice_of(kind, packet))

    # ---- what comes in ----------------------------------------------------------------------

    def take_slice(self, kind, data):
        if kind in (WHOLE, START):
            self.break_off()
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
                if len(packet) > OVERHEAD:
                    self.take(packet, False)

    def break_off(self):
        """Passed on only as a whole: there is nothing to abort."""
        coming, self.coming = self.coming, None
        if coming and coming[3] == self.id:
            self.damaged_return(False)

    # ---- Relay and Receive ----------------------------------------------------------------

    def take(self, packet, interrupt):
        code, sop, hop, source = packet[:4]
        if bool(code >> 5 & 1) != interrupt or sop != SOP or source == ALL:
            return
        good = crc(packet[:-4]) == packet[-4:] and packet[-8] == EOP
        if source == self.id:
            if good:
                self.came_home(packet, interrupt)
            else:
                self.damaged_return(interrupt)
            return
        if self.fold.cut_off(source) or hop + 1 >= len(self.order):
            return
        fbc = self.receive(packet, interrupt) if good else packet[-7]
        if self.relays:
            self.write(INTERRUPT if interrupt else WHOLE, with_hop_and_fbc(packet, hop + self.adds_hop, fbc))

    def damaged_return(self, interrupt):
        self.damaged_returns += 1
        if self.out[interrupt]:
            self.failed(interrupt)

    def receive(self, packet, interrupt):
        """Returns the FBC with which it goes on. (protocol.md section 3.5)"""
        source, fbc, destination, last = packet[3], packet[-7], packet[-6], packet[-5]
        control = not interrupt and last >> 2 == 1
        if control and not self.hear(source, packet[4:-8]):
            return 0
        if destination not in (self.id, ALL):
            return fbc
        page = self.page_of(source, packet[0] >> 6)
        if page is None:
            return 0
        if control:
            return min(fbc, 254)
        place, sequence = (interrupt, destination == ALL), packet[0] & 7
        known, said, when = page.verdicts.get(place, (None, 0, 0))
        if known == sequence and (packet[0] >> 3 & 3 or time.monotonic() - when < TRY_TIMEOUT):
            return min(fbc, said)
        if not self.joined and packet[0] >> 3 & 3:
            return fbc  # it may have been taken before the start of this node
        verdict = last & 7 in WIRED if interrupt else FREE_BUFFERS if self.joined else 0
        page.verdicts[place] = (sequence, verdict, time.monotonic())
        if interrupt and verdict:
            self.pins.append((last & 7, source))
        elif not interrupt and self.joined:
            self.received.append((source, last & 3, last >> 2, packet[4:-8]))
        return min(fbc, verdict)

    def page_of(self, source, incarnation):
        """None for a packet of an earlier incarnation."""
        page = self.pages.get(source)
        ahead = (incarnation - page.incarnation) % 4 if page else 1
        if ahead in (1, 2):
            page = self.pages[source] = Page(incarnation)
        return None if ahead == 3 else page

    def hear(self, source, data):
        """Returns whether it is of no earlier incarnation."""
        if not (data[0] == HELLO and len(data) == 10 or data[0] == BEACON and len(data) in (26, 40)):
            return True
        boot = struct.unpack_from('>Q', data, 1)[0]
        page = self.pages.get(source, Page(boot & 3))
        if page.boot == boot:
            return True
        if 0 < page.boot - boot <= 1000:
            return False
        hello_missed = data[0] == BEACON and page.boot == 0 and page.incarnation == boot & 3
        self.pages[source] = page if hello_missed else Page(boot & 3)
        self.pages[source].boot = boot
        return True

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
            if not self.hello_asked and self.fold.closed():
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
            code = (self.boot & 3) << 6 | interrupt << 5 | sequence
            self.launch(interrupt, bytes([code, SOP, 0, self.id]) + data + bytes([EOP, UNTAKEN, destination, last]),
                        token)

    def launch(self, interrupt, covered, token):
        packet = covered + crc(covered)
        self.out[interrupt] = Outstanding(packet, token, time.monotonic() + TRY_TIMEOUT)
        self.write(INTERRUPT if interrupt else WHOLE, packet)

    def failed(self, interrupt):
        out = self.out[interrupt]
        if out.packet[0] >> 3 & 3 == 3:
            return self.end(interrupt, 'lost')
        self.launch(interrupt, bytes([out.packet[0] + (1 << 3)]) + out.packet[1:-4], out.token)

    def beacon(self):
        input_state, output_state = self.fold.link_states()
        return struct.pack('>BQIBIBBBBBBBB', BEACON, self.boot, 1, 3, 0, input_state, self.line.sender, output_state,
                           self.line.successor, 0, 0, 0, 1)

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
