"""Cases about Transmit and the node's states: protocol.md sections 3.8, 3.9, 4 and 8."""

from . import wire
from .case import case
from .play import FAR, OWN, UP, DOWN, Failed, NotRun, is_beacon, is_hello
from .wire import ALL, UNTAKEN, Packet

TRY = wire.TIMES['send'] / 1000      # s, the time-out of a try
EARLY = 0.8                          # of it: a timer may be coarse
LATE = 5 * TRY + 0.2
SYNC = 2


def is_own_data(packet):
    return not packet.control and not packet.interrupt


def started(p, returns=None):
    """A fresh node whose lines both come up. @return its first packet"""
    p.restart()
    if returns is not None:
        p.returns = returns
    begun = p.now()
    try:
        p.connect()
        p.pump(lambda: p.own_since(begun), 3.0)
    except Failed:
        p.needs_joins()
        raise
    if not p.own_since(begun):
        p.needs_joins()
    return p.wait_own('first packet', since=begun, limit=0.1).packet


# ---- the hello (protocol.md sections 3.8 and 4.8) ----------------------------------------------

for section, title, expected, what, value in (
        ('4.8', 'the first packet is a hello', 'the data of a hello', is_hello, True),
        ('3.8', 'a hello has 10 bytes', '10 bytes of data', lambda h: len(h.data), 10),
        ('3.8', 'a hello goes to all', 'DID 255', lambda h: h.destination, ALL),
        ('3.8', 'a hello has channel 1, priority 0', 'PRI 4', lambda h: h.last, 4),
        ('3.8', 'a node that starts remembers nothing', '`remembers` 0', lambda h: h.data[9], 0),
        ('4.8', 'its number is the first', 'number 0', lambda h: h.sequence, 0),
        ('4.3', 'its first try is try 0', 'try 0', lambda h: h.attempt, 0),
        ('3.4', 'its HOP is 0', 'HOP 0', lambda h: h.hop, 0),
        ('3.5', 'its FBC is 255', 'FBC 255', lambda h: h.fbc, UNTAKEN),
        ('3.7', 'its CRC is right', 'a right CRC', lambda h: h.right, True),
        ('3.3', 'it shows its incarnation', 'bits 7 and 6 of Code are the two low bits of the boot number',
         lambda h: h.incarnation == h.data[8] & 3, True)):
    @case(section, title, 'both lines of a fresh node come up', expected, start=True)
    def _(p, what=what, value=value):
        hello = p.hello_kept or started(p)
        p.hello_kept = hello
        p.expect('it', what(hello), value)


@case('4.8', 'nothing goes before the hello is home', 'its hello is not given back for 60 ms', 'nothing else comes', start=True)
def _(p):
    started(p, returns=lambda packet: [])
    p.pump(limit=0.06)
    others = [one.packet for one in p.own if not is_hello(one.packet)]
    if others:
        raise Failed('it sends %s' % others[0].in_words())


@case('4.3', 'a hello that does not come home is repeated', 'it is not given back', 'the same number, try 1', '%g s' % LATE, start=True)
def _(p):
    first = started(p, returns=lambda packet: [])
    retry = p.wait_own('retry', lambda packet: packet.attempt == 1, since=0, limit=LATE).packet
    p.expect('the number', retry.sequence, first.sequence)


@case('4.3', 'there are three retries, and no fourth', 'its hello is not given back', 'tries 0, 1, 2, 3', '1 s', start=True)
def _(p):
    first = started(p, returns=lambda packet: [])
    p.wait_own('third retry', lambda packet: packet.attempt == 3, since=0, limit=LATE + 0.5)
    p.pump(limit=2 * TRY)
    p.expect('the tries of its number', [one.packet.attempt for one in p.own if one.packet.sequence == first.sequence], [0, 1, 2, 3])


@case('4.8', 'a hello that was lost is said again', 'no try of it is given back', 'a hello with the next number', '2 s', start=True)
def _(p):
    first = started(p, returns=lambda packet: [])
    again = p.wait_own('hello with another number', lambda packet: packet.sequence != first.sequence, since=0, limit=2.0).packet
    p.expect('it is a hello', is_hello(again), True)
    p.expect('the number', again.sequence, (first.sequence + 1) % 8)


@case('4.8', 'a hello that nobody took is home all the same', 'it comes home with FBC 255', 'it sends a beacon', start=True)
def _(p):
    p.needs_joins()
    started(p, returns=lambda packet: [p.home(packet, UNTAKEN if is_hello(packet) else None)])
    p.wait_own('beacon', is_beacon, since=0, limit=2.0)


@case('4.8', 'a hello that was refused is home all the same', 'it comes home with FBC 0', 'it sends a beacon', start=True)
def _(p):
    p.needs_joins()
    started(p, returns=lambda packet: [p.home(packet, 0 if is_hello(packet) else None)])
    p.wait_own('beacon', is_beacon, since=0, limit=2.0)


@case('4.8', 'a node that starts again has another boot number', 'it is started twice', 'two boot numbers', start=True)
def _(p):
    one = started(p).data[1:9]
    two = started(p).data[1:9]
    if one == two:
        raise Failed('both times %s' % one.hex())


# ---- while it joins (protocol.md sections 2.3 and 4.10) ------------------------------------------

def joining(p):
    started(p, returns=lambda packet: [])
    return p.source()


@case('4.8', 'while it joins it refuses DATPs', 'a first try to a node whose hello is out', 'FBC 0', start=True)
def _(p):
    p.expect('FBC', p.fbc_of(joining(p).packet(OWN)), 0)


@case('4.10', 'that refusal is a verdict', 'the same number again, as a retry', 'FBC 0', start=True)
def _(p):
    source = joining(p)
    sent = source.packet(OWN)
    p.exchange(sent)
    p.expect('FBC', p.fbc_of(source.packet(OWN, sequence=sent.sequence, attempt=1)), 0)


@case('4.10', 'while it joins a retry that it does not know is not answered', 'a retry to a node whose hello is out', 'FBC stays 255', start=True)
def _(p):
    p.expect('FBC', p.fbc_of(joining(p).packet(OWN, attempt=1)), UNTAKEN)


@case('4.10', 'while it joins a retry of an INTP that it does not know is not answered', 'it', 'FBC stays 255', start=True)
def _(p):
    p.expect('FBC', p.fbc_of(joining(p).interrupt(OWN, SYNC, attempt=1)), UNTAKEN)


@case('4.8', 'while it joins it takes INTPs', 'a first try of an INTP to a node whose hello is out', 'FBC 1', start=True)
def _(p):
    p.expect('FBC', p.fbc_of(joining(p).interrupt(OWN, SYNC)), 1)


@case('4.8', 'while it joins it takes hellos', 'a hello to a node whose hello is out', 'FBC 254', start=True)
def _(p):
    source = joining(p)
    p.expect('FBC', p.fbc_of(source.hello(source.boot + 1)), 254)


# ---- beacons (protocol.md sections 3.9 and 8.2) ----------------------------------------------------

def next_beacon(p, **how):
    return p.wait_own('beacon', is_beacon, **how)


@case('8.2', 'a node that has joined says beacons', 'a fresh node joins', 'a beacon', start=True)
def _(p):
    started(p)
    if not p.pump(lambda: p.own_since(0, is_beacon), 1.0):
        if len(p.own) != 1:
            p.needs_joins()
        raise Failed('none')


@case('8.2', 'beacons come in their period', 'nothing for 1 s', '7 to 14 of them, with a period of 100 to 125 ms')
def _(p):
    p.pump(limit=1.0)
    count = len({one.packet.sequence + 8 * i for i, one in enumerate(p.own) if is_beacon(one.packet) and one.packet.attempt == 0})
    if not 7 <= count <= 14:
        raise Failed('%d of them' % count)


for section, title, expected, what, value in (
        ('3.9', 'a beacon has %d or %d bytes' % wire.BEACON_SIZES, '%d or %d' % wire.BEACON_SIZES,
         lambda b: len(b.data) in wire.BEACON_SIZES, True),
        ('3.9', 'a beacon goes to all', 'DID 255', lambda b: b.destination, ALL),
        ('3.9', 'a beacon has channel 1, priority 0', 'PRI 4', lambda b: b.last, 4),
        ('3.9', 'CPU state is one of the list', '0 to 5', lambda b: b.data[13] <= 5, True),
        ('3.9', 'its input is up', 'input state 1', lambda b: b.data[18], 1),
        ('3.9', 'it names its upstream neighbour', 'node up', lambda b: b.data[19], UP),
        ('3.9', 'its output is up', 'output state 1', lambda b: b.data[20], 1),
        ('3.9', 'it names its downstream neighbour', 'node down', lambda b: b.data[21], DOWN),
        ('3.9', 'it knows no break', '*break known*, *before* and *behind* 0', lambda b: b.data[22:25], bytes(3)),
        ('3.9', 'CPU comes back is 0 or 1', '0 or 1', lambda b: b.data[25] <= 1, True),
        ('3.3', 'a beacon shows its incarnation', 'the two low bits of the boot number', lambda b: b.incarnation == b.data[8] & 3, True)):
    @case(section, title, 'nothing', expected, '0.5 s')
    def _(p, what=what, value=value):
        p.expect('it', what(next_beacon(p, limit=0.5).packet), value)


@case('3.9', 'beacons have the boot number of the hello', 'a fresh node joins', 'the same 8 bytes', start=True)
def _(p):
    p.needs_joins()
    hello = started(p)
    p.expect('the boot number', next_beacon(p, since=0, limit=2.0).packet.data[1:9].hex(), hello.data[1:9].hex())


@case('4.7', 'numbers count up by one', 'five beacons come home', 'each number one more, modulo 8')
def _(p):
    numbers = [next_beacon(p).packet.sequence for _ in range(5)]
    p.expect('the numbers', numbers, [(numbers[0] + i) % 8 for i in range(5)])


@case('4.1', 'one DATP is out at a time', 'no beacon is given back for 90 ms', 'no other DATP')
def _(p):
    p.returns = lambda packet: []
    first = next_beacon(p)
    p.pump(limit=0.09)
    others = p.own_since(first.at, lambda packet: packet.sequence != first.packet.sequence)
    if others:
        raise Failed('it sends %s' % others[0].packet.in_words())


def withheld(p, answer=lambda packet: []):
    """The retry of a beacon that comes home as said here."""
    state = {}

    def returns(packet):
        if is_beacon(packet) and not state and packet.attempt == 0:
            state['at'], state['packet'] = p.now(), packet
            return answer(packet)
        if state and is_beacon(packet) and packet.attempt == 1 and 'retry' not in state and packet.sequence == state['packet'].sequence:
            state['retry'], state['retried'] = packet, p.now()
        return [p.home(packet)]
    p.returns = returns
    p.pump(lambda: 'retry' in state, LATE)
    return state


@case('4.3', 'a beacon that does not come home is repeated', 'one is not given back', 'its retry: the same number, try 1', '%g s' % LATE)
def _(p):
    if 'retry' not in withheld(p):
        raise Failed('no retry')


@case('4.3', 'a retry does not come before its time-out', 'a beacon is not given back', 'its retry, 100 ms later')
def _(p):
    state = withheld(p)
    if 'retry' in state and state['retried'] - state['at'] < EARLY * TRY:
        raise Failed('after %.0f ms' % (1000 * (state['retried'] - state['at'])))


@case('4.3', 'a retry has the same data', 'a beacon is not given back', 'its retry says the same')
def _(p):
    state = withheld(p)
    if 'retry' in state:
        p.expect('the data', state['retry'].data.hex(), state['packet'].data.hex())


@case('4.3', 'a retry has a right CRC', 'a beacon is not given back', 'the CRC fits the new Code')
def _(p):
    state = withheld(p)
    if 'retry' in state:
        p.expect('its CRC is right', state['retry'].right, True)


@case('4.3', 'a retry begins with HOP 0 and FBC 255', 'a beacon is not given back', 'HOP 0, FBC 255')
def _(p):
    state = withheld(p)
    if 'retry' in state:
        p.expect('HOP and FBC', (state['retry'].hop, state['retry'].fbc), (0, UNTAKEN))


@case('4.3', 'a damaged return is a failed try', 'a beacon comes home with a wrong CRC', 'its retry', '%g s' % LATE)
def _(p):
    if 'retry' not in withheld(p, lambda packet: [p.home(packet).damaged()]):
        raise Failed('no retry: damage was taken for a return')


@case('4.3', 'a damaged return is repeated at once', 'a beacon comes home with a wrong CRC', 'its retry within 60 ms')
def _(p):
    state = withheld(p, lambda packet: [p.home(packet).damaged()])
    if 'retry' in state and state['retried'] - state['at'] > 0.06:
        raise Failed('after %.0f ms' % (1000 * (state['retried'] - state['at'])))


@case('2.6', 'a return that breaks off is a failed try', 'a beacon comes home as start and abort', 'its retry', '%g s' % LATE)
def _(p):
    def broken(packet):
        p.slice(wire.START, p.home(packet)[:12])
        p.slice(wire.ABORT)
        return []
    if 'retry' not in withheld(p, broken):
        raise Failed('no retry')


def other_data(packet):
    covered = packet[:8] + bytes([packet[8] ^ 1]) + packet[9:-4]
    return Packet(covered + wire.crc(covered))


def other_code(packet):
    covered = bytes([packet[0] ^ 2]) + packet[1:-4]
    return Packet(covered + wire.crc(covered))


def other_destination(packet):
    return Packet.build(OWN, UP, packet.last, packet.data, incarnation=packet.incarnation, sequence=packet.sequence)


def as_retry(packet):
    covered = bytes([packet[0] | 8]) + packet[1:-4]
    return Packet(covered + wire.crc(covered))


for title, changed in (('other data', other_data), ('another number', other_code), ('another DID', other_destination),
                       ('a try that was not sent', as_retry)):
    @case('4.2', 'what comes home with %s does not match' % title, 'a beacon comes home so, with a right CRC', 'its retry: it is not confirmed', '%g s' % LATE)
    def _(p, changed=changed):
        if 'retry' not in withheld(p, lambda packet: [p.home(changed(packet))]):
            raise Failed('no retry: it was taken for a return')


@case('4.2', 'a return with any HOP matches', 'a beacon comes home with HOP 1', 'the next one, no retry')
def _(p):
    if 'retry' in withheld(p, lambda packet: [packet.patched(1, 254)]):
        raise Failed('it was repeated')


@case('4.2', 'what is home is not repeated', 'ten beacons come home', 'no retry')
def _(p):
    for _ in range(5):
        next_beacon(p)
    retries = [one for one in p.own if one.packet.attempt]
    if retries:
        raise Failed('%s' % retries[0].packet.in_words())


# ---- new numbers (protocol.md section 4.7) -----------------------------------------------------------

def used_up(p, about=False):
    """Broadcasts of the node come home untaken. @return boot number before, and its new hello"""
    before = [next_beacon(p) for _ in range(3)][-1].packet.data[1:9]
    p.returns = lambda packet: [p.home(packet, None if is_hello(packet) else UNTAKEN)]
    p.clean = False
    begun = p.now()
    p.pump(lambda: p.own_since(begun, is_hello), 3.0)
    hellos = p.own_since(begun, is_hello)
    if not hellos:
        raise (Failed if about else NotRun)('no new hello within 3 s')
    return int.from_bytes(before, 'big'), hellos[0].packet


@case('4.7', 'when its numbers are used up it says a new hello', 'its beacons come home with FBC 255', 'a hello', '3 s')
def _(p):
    used_up(p, about=True)


@case('4.7', 'not more than six packets without a verdict', 'its beacons come home with FBC 255', 'six numbers at most before the hello', '3 s')
def _(p):
    before = p.now()
    used_up(p)
    first = [one.packet.sequence for one in p.own_since(before, is_beacon)]
    if len(first) > 9:  # three of them came home taken
        raise Failed('%d beacons' % len(first))


@case('4.7', 'a new hello counts the boot number up by one', 'its beacons come home with FBC 255', 'boot number + 1', '3 s')
def _(p):
    before, new = used_up(p)
    p.expect('the boot number', int.from_bytes(new.data[1:9], 'big') - before, 1)


@case('4.7', 'a new hello remembers the others', 'its beacons come home with FBC 255', '`remembers` 1', '3 s')
def _(p):
    p.expect('`remembers`', used_up(p)[1].data[9], 1)


@case('4.7', 'a new hello begins at number 0', 'its beacons come home with FBC 255', 'number 0', '3 s')
def _(p):
    used_up(p)  # from here on the numbers are known: the next one would be 2
    p.behave()
    p.expect('the number', used_up(p)[1].sequence, 0)


# ---- sends of the CPU (protocol.md sections 4.4, 4.6 and 4.10) ------------------------------------------

def echo(p, returns, data=b'send', source=None):
    """The node's CPU sends this. `returns`: how its tries come home. @return its tries so far, as Own"""
    p.needs_echo()
    source = source or p.source()
    data += b' %d' % next(p.marks)
    tries = []

    def back(packet):
        if packet.data != data or not is_own_data(packet):
            return [p.home(packet)]
        tries.append((p.now(), packet))
        return returns(packet, len(tries))
    p.returns = back
    p.clean = False
    p.exchange(source.packet(OWN, data=data))
    p.wait('it sends', lambda: tries, 1.0)
    return tries


@case('4.7', 'the first number to a destination is 0', 'it sends to a node for the first time', 'number 0', start=True)
def _(p):
    p.needs_joins()
    started(p)
    next_beacon(p, since=0, limit=2.0)
    p.expect('the number', echo(p, lambda packet, n: [p.home(packet)])[0][1].sequence, 0)


@case('4.7', 'numbers are counted for each destination', 'it sends to far three times, then to down', 'the first number to down is 0', start=True)
def _(p):
    p.needs_joins()
    started(p)
    next_beacon(p, since=0, limit=2.0)
    for i in range(3):
        echo(p, lambda packet, n: [p.home(packet)], b'to far %d' % i)
    down = p.source(DOWN)
    p.expect('the number', echo(p, lambda packet, n: [p.home(packet)], b'to down', down)[0][1].sequence, 0)


@case('4.1', 'its DATP begins with HOP 0 and FBC 255', 'it sends', 'HOP 0, FBC 255')
def _(p):
    sent = echo(p, lambda packet, n: [p.home(packet)])[0][1]
    p.expect('HOP and FBC', (sent.hop, sent.fbc), (0, UNTAKEN))


@case('4.6', 'what is delivered goes once', 'its DATP comes home with FBC 32', 'nothing more')
def _(p):
    tries = echo(p, lambda packet, n: [p.home(packet)])
    p.pump(limit=2.5 * TRY)
    p.expect('packets', len(tries), 1)


@case('4.6', 'what nobody takes is not sent again', 'its DATP comes home with FBC 255', 'nothing more')
def _(p):
    tries = echo(p, lambda packet, n: [p.home(packet, UNTAKEN)])
    p.pump(limit=2.5 * TRY)
    p.expect('packets', len(tries), 1)


@case('4.4', 'what is refused goes again', 'its DATP comes home with FBC 0, once', 'it once more', '0.5 s')
def _(p):
    tries = echo(p, lambda packet, n: [p.home(packet, 0 if n == 1 else 32)])
    p.wait('it goes again', lambda: len(tries) > 1, 0.5)


@case('4.4', 'what is refused goes again as a new packet', 'its DATP comes home with FBC 0, once', 'the next number, try 0', '0.5 s')
def _(p):
    tries = echo(p, lambda packet, n: [p.home(packet, 0 if n == 1 else 32)])
    p.pump(lambda: len(tries) > 1, 0.5)
    if len(tries) > 1:
        p.expect('number and try', (tries[1][1].sequence, tries[1][1].attempt), ((tries[0][1].sequence + 1) % 8, 0))


@case('4.4', 'the wait after a refusal doubles', 'its DATP comes home with FBC 0 for 300 ms', '4 to 12 packets')
def _(p):
    tries = echo(p, lambda packet, n: [p.home(packet, 0)])
    p.pump(limit=0.3)
    count = len(tries)
    p.returns = lambda packet: [p.home(packet)]
    p.pump(limit=0.1)
    if not 4 <= count <= 12:
        raise Failed('%d packets' % count)


@case('4.4', 'a refused send ends', 'its DATP comes home with FBC 0 for ever', 'the last packet of it within 1.1 s of the first', '2 s')
def _(p):
    tries = echo(p, lambda packet, n: [p.home(packet, 0)])
    p.pump(limit=1.6)
    if tries[-1][0] - tries[0][0] > 1.25:
        raise Failed('one more %.2f s after the first' % (tries[-1][0] - tries[0][0]))


@case('4.3', 'a send that is lost has four tries', 'its DATP never comes home', 'tries 0, 1, 2, 3 of one number, then nothing', '1 s')
def _(p):
    tries = echo(p, lambda packet, n: [])
    p.pump(limit=7 * TRY)
    p.expect('the tries', [packet.attempt for _, packet in tries], [0, 1, 2, 3])


@case('4.3', 'all tries have one number', 'its DATP never comes home', 'the same number', '1 s')
def _(p):
    tries = echo(p, lambda packet, n: [])
    p.pump(limit=4 * TRY)
    p.expect('the numbers', len({packet.sequence for _, packet in tries}), 1)


@case('4.10', 'what is out to a node that has started again is not repeated', 'its DATP to far is out, far says hello', 'no retry')
def _(p):
    source = p.source()
    tries = echo(p, lambda packet, n: [], source=source)
    p.exchange(source.hello(source.boot + 16))
    p.pump(limit=2.5 * TRY)
    p.expect('packets', len(tries), 1)


@case('4.10', 'a hello that remembers changes nothing for what is out', 'its DATP to far is out, far says a hello with `remembers` 1, one boot later',
      'its retry')
def _(p):
    source = p.source()
    tries = echo(p, lambda packet, n: [], source=source)
    p.exchange(source.hello(source.boot + 1, remembers=1))
    p.wait('it is repeated', lambda: len(tries) > 1, LATE)


@case('4.10', 'the start of a third node changes nothing for what is out', 'its DATP to far is out, down says hello', 'its retry')
def _(p):
    down = p.source(DOWN)
    tries = echo(p, lambda packet, n: [])
    p.exchange(down.hello(down.boot + 16))
    p.wait('it is repeated', lambda: len(tries) > 1, LATE)


@case('2.3', 'a packet to itself is no packet for others', 'its own DATP, which it has not sent', 'it goes nowhere, and the CPU gets nothing')
def _(p):
    p.needs_echo()
    p.expect('copies that came back', p.count_echoes(b'mine?', Packet.build(OWN, OWN, data=b'mine?', hop=3)), 0)


# ---- breaks (protocol.md sections 8.1 to 8.4) -------------------------------------------------------------

def lose_input(p):
    """The line into the node is closed; what it says from then on."""
    p.clean = False
    begun = p.now()
    p.header(('asks', UP), wire.BYE, p.input_session)
    p.input_session, p.idles = None, False
    return begun


@case('8.3', 'the node behind a break says so', 'the line into it ends', 'a beacon with *break known*, 200 ms later', '1 s')
def _(p):
    begun = lose_input(p)
    p.wait_own('beacon with a break', is_beacon, lambda b: b.data[22] == 1, since=begun, limit=1.0)


@case('8.3', 'a break has a grace', 'the line into it ends', 'no beacon with *break known* within 150 ms')
def _(p):
    begun = lose_input(p)
    p.pump(limit=0.15)
    if p.own_since(begun, is_beacon, lambda b: b.data[22] == 1):
        raise Failed('it says so already')


@case('8.3', 'a break is between its neighbour and itself', 'the line into it ends', '*break before* node up, *break behind* the node', '1 s')
def _(p):
    begun = lose_input(p)
    if p.pump(lambda: p.own_since(begun, is_beacon, lambda b: b.data[22] == 1), 1.0):
        broken = p.own_since(begun, is_beacon, lambda b: b.data[22] == 1)[0].packet
        p.expect('before and behind', (broken.data[23], broken.data[24]), (UP, OWN))


@case('3.9', 'an input that is lost is silent', 'the line into it ends', 'input state 2', '1 s')
def _(p):
    begun = lose_input(p)
    p.wait_own('beacon with input state 2', is_beacon, lambda b: b.data[18] == 2, since=begun, limit=1.0)


@case('8.3', 'a break is over when the line is back', 'the line into it ends for 400 ms', 'a beacon without a break', '3 s')
def _(p):
    lose_input(p)
    p.pump(limit=0.4)
    p.idles = True
    p.connect()
    begun = p.now()
    p.wait_own('beacon without a break', is_beacon, lambda b: b.data[22] == 0, since=begun, limit=3.0)


@case('8.4', 'an open chain ends when its beacon is home', 'the line into it ends for 400 ms, then all comes home', 'a new hello', '3 s', profile='full')
def _(p):
    lose_input(p)
    p.pump(limit=0.4)
    p.idles = True
    p.connect()
    p.wait_own('new hello', is_hello, limit=3.0)


@case('4.8', 'a node that has lost both its lines starts over', 'both its lines end, and come back', 'a hello', '3 s')
def _(p):
    p.clean = False
    start_over(p)


def start_over(p):
    p.clean = False
    before = int.from_bytes(next_beacon(p).packet.data[1:9], 'big')
    p.policy = lambda node, header: None
    p.header(('asks', UP), wire.BYE, p.input_session)
    p.header(('listens', DOWN), wire.REFUSE, p.output_session, refusal=wire.CLOSING)
    p.input_session = p.output_session = None
    p.pump(limit=0.03)
    p.behave()
    begun = p.now()
    p.connect()
    return before, p.wait_own('hello', is_hello, since=begun, limit=3.0).packet


@case('4.8', 'a node that starts over has the next boot number', 'both its lines end, and come back', 'a boot number that is higher', '3 s')
def _(p):
    before, hello = start_over(p)
    if int.from_bytes(hello.data[1:9], 'big') <= before:
        raise Failed('%x after %x' % (int.from_bytes(hello.data[1:9], 'big'), before))


@case('4.8', 'a node that starts over has forgotten the others', 'both its lines end, and come back', '`remembers` 0', '3 s')
def _(p):
    p.expect('`remembers`', start_over(p)[1].data[9], 0)
