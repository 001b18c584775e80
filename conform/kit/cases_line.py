"""Cases about the two ends of a line: protocol.md section 6."""

import struct

from . import wire
from .case import case
from .play import DOWN, FAR, OWN, UP, Failed, Lenient, is_beacon
from .wire import Packet

DATA = bytes(range(20))
SILENCE = wire.TIMES['silence'] / 1000


# ---- the sending end --------------------------------------------------------------------------

def first_connect(p):
    """Of a fresh node, to its successor, which does not answer."""
    p.restart()
    p.policy = lambda node, header: None
    p.wait('it asks its successor', lambda: p.asked, 3.0)
    return p.asked[0]


for section, title, expected, what, value in (
        ('6.5', 'the version is 3', '3', lambda h, d: h.version, 3),
        ('6.5', 'a connect has the hash of the ring', 'FNV-1a of the ring\'s name', lambda h, d: h.ring, None),
        ('6.7', 'a connect has a random number', 'the upper half of the session is not 0', lambda h, d: h.session >> 32 != 0, True),
        ('6.7', 'a connect has half a session', 'the lower half of the session is 0', lambda h, d: h.session & 0xFFFFFFFF, 0),
        ('6.5', 'a connect has no sequence', '0', lambda h, d: h.sequence, 0),
        ('6.5', 'a connect names who asks', 'the id of the node', lambda h, d: h.sender, OWN),
        ('6.5', 'a connect refuses nothing', 'refusal 0', lambda h, d: h.refusal, 0),
        ('6.13', 'a connect has 82 bytes', '26 and 56', lambda h, d: len(d), 82)):
    @case(section, title, 'nothing', expected, '3 s', start=True)
    def _(p, what=what, value=value):
        _, _, header, datagram = p.connect_kept = p.connect_kept or first_connect(p)
        p.expect('it', what(header, datagram), p.ring if value is None else value)


@case('6.13', 'a connect has the seven hashes', 'nothing', 'those of the ring\'s file', '3 s', start=True)
def _(p):
    _, _, _, datagram = p.connect_kept = p.connect_kept or first_connect(p)
    parts = ('nodes', 'redundancy', 'timeouts', 'lines', 'joints', 'pins', 'supervisor')
    theirs, ours = (struct.unpack('>7Q', one) for one in (datagram[26:82].ljust(56, b'\0'), p.config.agreement))
    p.expect('hashes that differ', [part for part, one, other in zip(parts, theirs, ours) if one != other], [])


@case('6.9', 'at first only the configured successor is asked', 'nothing answers for 150 ms', 'connects to node down only', start=True)
def _(p):
    first_connect(p)
    p.pump(limit=0.15)
    others = [node for _, node, _, _ in p.asked if node != DOWN]
    if others:
        raise Failed('node %d was asked, too' % others[0])


@case('6.7', 'a connect is repeated', 'the first is not answered', 'one more', '0.5 s', line='udp', start=True)
def _(p):
    first_connect(p)
    p.wait('it is repeated', lambda: len(p.asked) > 1, 0.5)


@case('6.7', 'a connect is repeated with the same number', 'the first is not answered for 180 ms', 'the same session', line='udp', start=True)
def _(p):
    first_connect(p)
    p.pump(limit=0.18)
    p.expect('the numbers of its connects to node down', len({h.session for _, node, h, _ in p.asked if node == DOWN}), 1)


@case('6.7', 'the sending end says idle at once', 'its connect is accepted', 'an `idle`', start=True)
def _(p):
    p.needs_joins()
    p.restart()
    p.wait('a slice', lambda: p.slices, 3.0)
    p.expect('its kind', wire.SLICE_NAMES.get(p.slices[0][2][1]), 'idle')


@case('6.7', 'slices are in the session that was accepted', 'its connect is accepted', 'that session', line='udp', start=True)
def _(p):
    p.restart()
    p.pump(lambda: p.first_slices is not None, 3.0)
    if p.first_slices is None:
        p.needs_joins()
        raise Failed('no slice')
    p.expect('the session', p.first_slices.session, p.offers.get(DOWN))


@case('6.7', 'sequences begin at 1', 'its connect is accepted', 'sequence 1', line='udp', start=True)
def _(p):
    p.needs_joins()
    p.restart()
    p.wait('a slice', lambda: p.slices, 3.0)
    p.expect('the sequence', p.slices[0][1].sequence, 1)


@case('6.7', 'sequences count up by one', 'some packets', 'each one more', line='udp')
def _(p):
    p.exchange(*(p.source().packet(UP, data=DATA) for _ in range(5)))
    sequences = [header.sequence for _, header, _ in p.slices]
    p.expect('the steps', {two - one for one, two in zip(sequences, sequences[1:])}, {1})


@case('6.5', 'a datagram with a slice names who sends it', 'a packet', 'the id of the node', line='udp')
def _(p):
    p.exchange(p.source().packet(UP, data=DATA))
    p.expect('the sender', {header.sender for _, header, _ in p.slices}, {OWN})


@case('6.2', 'each slice is as the table says', 'packets of all sizes', 'magic, kind and size of each fit')
def _(p):
    source = p.source()
    p.exchange(*(source.packet(UP, data=bytes(n)) for n in (1, 2, 3, 4, 100, 511, 512)), source.interrupt(UP, 2))
    fits = {wire.START: lambda n: 4 <= n <= 516 and n % 4 == 0, wire.MORE: lambda n: 4 <= n <= 512 and n % 4 == 0,
            wire.END: lambda n: 8 <= n <= 520, wire.WHOLE: lambda n: 13 <= n <= 524, wire.INTERRUPT: lambda n: n == 12,
            wire.ABORT: lambda n: n == 0, wire.IDLE: lambda n: n == 0, wire.FOLD: lambda n: n == 3}
    for _, _, framed in p.slices:
        size = len(framed) - 4
        if framed[0] != 0xA7 or framed[1] not in fits or int.from_bytes(framed[2:4], 'big') != size or not fits[framed[1]](size):
            raise Failed('%s' % framed[:8].hex())


@case('6.10', 'the sending end gives signs of life', 'a fresh node, of whose lines only that out of it is up', 'no 150 ms without a slice', start=True)
def _(p):
    p.needs_joins()
    p.restart()
    p.wait('a slice', lambda: p.slices, 3.0)
    begun = p.now()
    p.pump(limit=0.5)
    times = [begun] + [at for at, _, _ in p.slices if at >= begun]
    gap = max(two - one for one, two in zip(times, times[1:] + [p.now()]))
    if gap > 0.15:
        raise Failed('nothing for %.0f ms' % (1000 * gap))


@case('6.10', 'a neighbour that falls silent is asked again', 'no `alive` any more', 'a connect', '2 s')
def _(p):
    p.clean = False
    p.alives = False
    begun = p.now()
    p.wait('it asks again', lambda: [one for one in p.asked if one[0] >= begun], 2.0)


@case('6.10', 'a neighbour is not given up before its time', 'no `alive` for 180 ms', 'no connect')
def _(p):
    p.pump(limit=0.12)
    p.alives = False
    begun = p.now()
    p.pump(limit=0.18)
    if [one for one in p.asked if one[0] >= begun]:
        raise Failed('it asks again already')


@case('6.7', 'a session that is not known any more is begun anew', '`refuse`, unknown_session', 'a connect with another number', '1 s', line='udp')
def _(p):
    p.clean = False
    old, begun = p.output_session, p.now()
    p.header(('listens', DOWN), wire.REFUSE, old, refusal=wire.UNKNOWN_SESSION)
    p.output_session = None
    asked = lambda: [one for one in p.asked if one[0] >= begun and one[1] == DOWN]
    p.wait('it asks again', asked)
    if asked()[0][2].session >> 32 == old >> 32:
        raise Failed('the number is the old one')


for title, change in (('of another ring', dict(ring=77)), ('of another session', dict(session=0x99999999_00000001))):
    @case('6.7', 'an accept %s is ignored' % title, 'it, for the connect of a fresh node', 'no slice in it', line='udp', start=True)
    def _(p, change=change):
        p.restart()
        p.policy = lambda node, header: None
        p.wait('it asks its successor', lambda: p.asked, 3.0)
        session = change.get('session', p.asked[0][2].session | 5)
        p.offers[DOWN] = session
        p.header(('listens', DOWN), wire.ACCEPT, session, ring=change.get('ring'))
        p.pump(limit=0.15)
        if p.slices:
            raise Failed('it sends slices in it')


@case('6.9', 'a successor that is busy is alive', 'its successor refuses as busy for 0.6 s', 'nobody else is asked', start=True)
def _(p):
    p.needs_joins()
    p.restart()
    p.policy = lambda node, header: wire.BUSY if node == DOWN else None
    p.wait('it asks its successor', lambda: p.asked, 3.0)
    p.pump(limit=0.6)
    others = [node for _, node, _, _ in p.asked if node != DOWN]
    if others:
        raise Failed('node %d was asked, too' % others[0])


@case('6.9', 'a successor that is busy is asked again', 'its successor refuses as busy for 0.3 s, then accepts', 'it takes that up', '2 s', start=True)
def _(p):
    p.needs_joins()
    p.restart()
    begun = p.now()
    p.policy = lambda node, header: None if node != DOWN else wire.BUSY if p.now() < begun + 0.3 else 'accept'
    p.wait('a slice', lambda: p.slices, 3.0)


@case('6.9', 'the next one is asked as well', 'its successor does not answer', 'node far is asked within 0.7 s of the first connect', '0.7 s', profile='full', start=True)
def _(p):
    p.restart()
    p.policy = lambda node, header: None
    p.wait('it asks its successor', lambda: p.asked, 3.0)
    p.wait('it asks node far', lambda: [one for one in p.asked if one[1] == FAR], 0.7)


@case('6.9', 'a dead successor is bypassed', 'its successor does not answer', 'it asks node far, and sends to it', '3 s', profile='full', start=True)
def _(p):
    bypassed(p)


def bypassed(p):
    p.needs_joins()
    p.restart()
    p.policy = lambda node, header: 'accept' if node == FAR else None
    p.wait('it sends to node far', lambda: p.slices and p.output_node == FAR, 3.0)


@case('6.9', 'a successor that is back is taken', 'its successor answers after it was bypassed', 'it sends to it', '3 s', profile='full', start=True)
def _(p):
    bypassed(p)
    p.policy = lambda node, header: 'accept' if node in (FAR, DOWN) else None
    p.wait('it sends to node down', lambda: p.output_node == DOWN, 3.0)


@case('4.9', 'orphans of a bypassed node end here', 'a DATP of node down, which the node bypasses', 'it is not passed on', '4 s', profile='full', start=True)
def _(p):
    bypassed(p)
    p.connect()
    p.wait_own('beacon', is_beacon, since=0, limit=3.0)
    p.passes_not(Packet.build(DOWN, UP, data=DATA), 'its source is bypassed')


# ---- the receiving end --------------------------------------------------------------------------

def answer_of(p, **how):
    answer = p.ask(**how)
    if answer is None:
        raise Failed('no answer')
    return answer


for title, expected, what, value in (
        ('an accept has the number of the connect', 'the same upper half of the session', lambda p, a: a.session >> 32, 0x4242),
        ('an accept has a random number of its own', 'the lower half of the session is not 0', lambda p, a: a.session & 0xFFFFFFFF != 0, True),
        ('an accept names who accepts', 'the id of the node', lambda p, a: a.sender, OWN),
        ('an accept has the hash of the ring', 'FNV-1a of the ring\'s name', lambda p, a: a.ring == p.ring, True)):
    @case('6.7', title, 'a connect of node up', expected, line='udp')
    def _(p, what=what, value=value):
        p.expect('it', what(p, answer_of(p, number=0x4242)), value)


@case('6.8', 'its predecessor is accepted', 'a connect of node up, which is connected already: a restart', '`accept`')
def _(p):
    p.expect('the answer', answer_of(p).type, wire.ACCEPT)


@case('6.7', 'the same connect has the same answer', 'it twice', 'the same session', line='udp')
def _(p):
    p.expect('the second session', answer_of(p, number=0x777).session, answer_of(p, number=0x777).session)


@case('6.7', 'a connect alone changes nothing', 'a connect that is not taken up, then a packet in the old session', 'it is passed on', line='udp')
def _(p):
    answer_of(p)
    p.passes(p.source().packet(UP, data=DATA))


def refused(section, title, sent, how, refusal, line=None):
    @case(section, title, sent, '`refuse`, %d' % refusal, line=line)
    def _(p):
        answer = answer_of(p, **how)
        if answer.type == wire.REFUSE and answer.refusal != refusal:
            raise Lenient('it refuses, for another reason: %d, %d expected' % (answer.refusal, refusal))
        p.expect('the answer', p.say(answer), 'refuse, refusal %d' % refusal)


refused('6.8', 'another version is refused', 'a connect of version 2', dict(version=2), wire.WRONG_VERSION)
refused('6.8', 'another ring is refused', 'a connect with another hash', dict(ring=12345), wire.WRONG_RING)
refused('6.8', 'a node that is not in the list is refused', 'a connect of node 77', dict(sender=77), wire.NOT_IN_RING)
refused('6.8', 'a farther node is refused while a nearer one is there', 'a connect of node far', dict(node=FAR), wire.BUSY)
refused('6.8', 'a connect without hashes is judged by its header', '26 bytes of version 2', dict(version=2, more=b''), wire.WRONG_VERSION, 'udp')

for part, name in enumerate(('nodes', 'redundancy', 'timeouts', 'lines', 'joints', 'pins', 'supervisor')):
    @case('6.13', 'another ring file is refused: %s' % name, 'a connect whose hash %d differs' % part, '`refuse`, 9')
    def _(p, part=part):
        answer = answer_of(p, more=differs(p, part))
        p.expect('the answer', p.say(answer), 'refuse, refusal %d' % wire.OTHER_RING_FILE)


def differs(p, *parts):
    out = bytearray(p.config.agreement)
    for part in parts:
        out[8 * part + 3] ^= 0x20
    return bytes(out)


@case('6.13', 'the refusal says which parts differ', 'a connect whose hashes 1, 4 and 6 differ', 'sequence 0x52')
def _(p):
    p.expect('the sequence', answer_of(p, more=differs(p, 1, 4, 6)).sequence, 0x52)


@case('6.7', 'what stands behind the hashes is ignored', 'a connect with 4 bytes more', '`accept`', line='udp')
def _(p):
    p.expect('the answer', p.say(answer_of(p, more=p.config.agreement + b'more')), 'accept, refusal 0')


@case('6.5', 'a connect that is too short is ignored', '26 and 40 bytes', 'no answer', line='udp')
def _(p):
    before = len(p.answers)
    p.header(('asks', UP), wire.CONNECT, 0x1234 << 32, more=p.config.agreement[:40])
    p.pump(limit=0.15)
    answers = [one for one in p.answers[before:] if one.type != wire.ALIVE]
    if answers:
        raise Failed(p.say(answers[0]))


@case('6.14', 'a keyed connect is refused', 'connect_keyed to a node without a key', '`refuse`, 11 (no_key)', profile='full', line='udp')
def _(p):
    answer = p.ask(kind=wire.CONNECT_KEYED, more=p.config.agreement + bytes(32))
    if answer is None:
        raise Lenient('it is not answered: who asks does not learn why')
    p.expect('the answer', p.say(answer), 'refuse, refusal %d' % wire.NO_KEY)


@case('6.10', 'the receiving end says that it is there', 'nothing for 0.5 s', 'an `alive` at least every 150 ms')
def _(p):
    begun, before = p.now(), len(p.answers)
    p.pump(limit=0.5)
    alive = [one for one in p.answers[before:] if one.type == wire.ALIVE]
    del begun
    if len(alive) < 4:
        raise Failed('%d in 0.5 s' % len(alive))


@case('6.7', 'an alive is in the session', 'nothing', 'the session of the line', line='udp')
def _(p):
    before = len(p.answers)
    p.pump(lambda: [one for one in p.answers[before:] if one.type == wire.ALIVE], 0.5)
    p.expect('the session', {one.session for one in p.answers[before:] if one.type == wire.ALIVE} - {p.input_session}, set())


@case('6.7', 'a new session takes the old one\'s place', 'a connect of node up, and a slice in its session', 'what comes in it is passed on', line='udp')
def _(p):
    p.connect()
    p.passes(p.source().packet(UP, data=DATA))


@case('6.7', 'a neighbour that is replaced is told so', 'the same', '`refuse`, 2 (replaced), in the old session', line='udp')
def _(p):
    old, before = p.input_session, len(p.answers)
    p.connect()
    told = lambda: [one for one in p.answers[before:] if one.type == wire.REFUSE and one.session == old]
    p.wait('a `refuse` in the old session', told, 0.5)
    p.expect('its reason', told()[0].refusal, wire.REPLACED)


@case('6.7', 'slices of no session are refused', 'an idle in a session that there is not', '`refuse`, 5 (unknown_session)', line='udp')
def _(p):
    before = len(p.answers)
    p.header(('asks', UP), wire.SLICES, 0x1_0000_0001, 1, more=wire.slice_of(wire.IDLE))
    told = lambda: [one for one in p.answers[before:] if one.type == wire.REFUSE]
    p.wait('a `refuse`', told, 0.5)
    p.expect('its reason', told()[0].refusal, wire.UNKNOWN_SESSION)


@case('6.7', 'slices of no session carry nothing', 'a packet in a session that there is not', 'it is not passed on', line='udp')
def _(p):
    sent = p.source().packet(UP, data=DATA)
    p.header(('asks', UP), wire.SLICES, 0x1_0000_0001, 1, more=wire.slice_of(wire.WHOLE, sent))
    p.passes_not(sent, 'its session does not exist', (wire.IDLE, b''))


@case('6.7', 'a session ends with bye', '`bye`, then an idle in the session', '`refuse`, 5', line='udp')
def _(p):
    p.clean = False
    session, before = p.input_session, len(p.answers)
    p.header(('asks', UP), wire.BYE, session)
    p.idles = False
    p.pump(limit=0.05)
    p.header(('asks', UP), wire.SLICES, session, p.input_sequence + 1, more=wire.slice_of(wire.IDLE))
    p.wait('a `refuse`', lambda: [one for one in p.answers[before:] if one.type == wire.REFUSE], 0.5)


@case('6.10', 'a neighbour that falls silent is lost', 'no slice for 0.6 s', '`refuse` in the session, or the end of the stream', '1 s')
def _(p):
    p.clean = False
    p.idles = False
    p.returns = lambda packet: []
    p.wait('it ends the session', lambda: p.input_session is None)


@case('6.10', 'a neighbour is not lost before its time', 'no slice for 180 ms', 'the line stays')
def _(p):
    p.returns = lambda packet: []
    p.slice(wire.IDLE)
    p.idles = False
    p.pump(limit=0.18)
    p.idles = True
    p.clean = False
    if p.input_session is None:
        raise Failed('it ended the session')


for title, datagram in (('of 10 bytes', bytes(10)), ('without the magic', b'XX' + bytes(30)), ('of type 0', None), ('of type 9', None),
                        ('with refusal 13', None), ('of 560 random bytes', bytes(i * 89 & 255 for i in range(560)))):
    @case('6.5', 'a datagram %s is ignored' % title, 'it', 'the ring goes on', line='udp')
    def _(p, title=title, datagram=datagram):
        if datagram is not None:
            p.raw(('asks', UP), datagram)
        else:
            kind = {'of type 0': 0, 'of type 9': 9}.get(title, wire.BYE)
            p.header(('asks', UP), kind, p.input_session, refusal=13 if kind == wire.BYE else 0)
        p.passes(p.source().packet(UP, data=DATA))


@case('6.7', 'a header of another ring is ignored', '`bye` of another ring in the session', 'the ring goes on', line='udp')
def _(p):
    p.source()
    p.header(('asks', UP), wire.BYE, p.input_session, ring=4711)
    p.passes(p.source().packet(UP, data=DATA))


@case('6.7', 'a doubled datagram counts once', 'a packet in a datagram that comes twice', 'it comes out once', line='udp')
def _(p):
    sent = p.source().packet(UP, data=DATA)
    p.give(sent)
    p.framed(wire.slice_of(wire.WHOLE, sent), sequence=p.input_sequence)
    p.expect('copies', sum(one.source == FAR for one in p.behind_marker()), 1)


@case('6.7', 'an overtaken datagram is discarded', 'a packet in a datagram with a sequence that has passed', 'it does not come out', line='udp')
def _(p):
    sent = p.source().packet(UP, data=DATA)
    p.slice(wire.IDLE)
    p.framed(wire.slice_of(wire.WHOLE, sent), sequence=p.input_sequence - 1)
    p.passes_not(sent, 'its datagram was overtaken', (wire.IDLE, b''))


@case('6.7', 'a datagram that is missing is no end', 'a sequence is left out', 'the next packet is passed on', line='udp')
def _(p):
    sent = p.source().packet(UP, data=DATA)
    p.input_sequence += 3
    p.passes(sent)


@case('6.7', 'a gap breaks a DATP off', 'start, a sequence is left out, end', 'it does not come out', line='udp')
def _(p):
    sent = p.source().packet(UP, data=DATA)
    p.slice(wire.START, sent[:8])
    p.input_sequence += 1
    p.passes_not(sent, 'a datagram within it is missing', (wire.END, sent[8:]))


for title, framed in (('another magic', b'\xa6\x07\x00\x00'), ('kind 0', b'\xa7\x00\x00\x00'), ('kind 9', b'\xa7\x09\x00\x00'),
                      ('an idle with bytes', b'\xa7\x07\x00\x02ab'), ('a size that does not fit', b'\xa7\x07\x00\x05'),
                      ('an INTP of 11 bytes', b'\xa7\x05\x00\x0b' + bytes(11)), ('no slice at all', b'')):
    @case('6.2', 'a slice with %s is a gap' % title, 'start, this, end', 'the DATP does not come out', line='udp')
    def _(p, framed=framed):
        sent = p.source().packet(UP, data=DATA)
        p.slice(wire.START, sent[:8])
        p.framed(framed)
        p.passes_not(sent, 'a slice within it was wrong', (wire.END, sent[8:]))


@case('6.3', 'a new line begins between packets', 'start, a new session, end', 'it does not come out', line='udp')
def _(p):
    sent = p.source().packet(UP, data=DATA)
    p.slice(wire.START, sent[:8])
    p.connect()
    p.passes_not(sent, 'its line was replaced', (wire.END, sent[8:]))


@case('6.6', 'garbage on a UNIX line ends it', 'four bytes that are no slice', 'the end of the connection', line='unix')
def _(p):
    p.clean = False
    p.framed(b'junk')
    p.wait('the connection ends', lambda: p.input_session is None)
