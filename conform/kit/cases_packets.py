"""Cases about Relay and Receive: protocol.md sections 2, 3, 4.10 and 5."""

from . import wire
from .case import case
from .play import DOWN, FAR, OWN, UP, Failed
from .wire import ABORT, ALL, END, FOLD, IDLE, INTERRUPT, MORE, START, UNTAKEN, WHOLE, Packet

UNWIRED, SYNC = 7, 2
DATA = bytes(range(20))


# ---- Relay --------------------------------------------------------------------------------

@case('2.2', 'HOP of a DATP is one more', 'a DATP of node far with HOP 1', 'HOP 2')
def _(p):
    p.expect('HOP', p.passes(p.source().packet(UP, hop=1)).hop, 2)


@case('2.2', 'HOP of an INTP is one more', 'an INTP of node far with HOP 1', 'HOP 2')
def _(p):
    p.expect('HOP', p.passes(p.source().interrupt(UP, SYNC, hop=1)).hop, 2)


@case('2.2', 'the CRC of a DATP stays right', 'a right DATP', 'a right CRC')
def _(p):
    if not p.passes(p.source().packet(UP, data=DATA)).right:
        raise Failed('its CRC is wrong')


@case('2.2', 'the CRC of an INTP stays right', 'a right INTP', 'a right CRC')
def _(p):
    if not p.passes(p.source().interrupt(UP, SYNC)).right:
        raise Failed('its CRC is wrong')


def damaged(packet):
    def act(p):
        sent = packet(p.source()).damaged()
        came = p.passes(sent)
        wanted = sent.patched(came.hop, came.fbc)
        if came.right:
            raise Failed('its CRC is right now: it was computed anew')
        p.expect('the CRC', came[-4:].hex(), wanted[-4:].hex())
    return act


for kind, packet in (('DATP', lambda s: s.packet(UP, data=DATA)), ('INTP', lambda s: s.interrupt(UP, SYNC))):
    case('3.7', 'damage of %s stays damage' % ('a DATP' if kind == 'DATP' else 'an INTP'),
         'one with a wrong CRC', 'it is passed on, and its CRC is as wrong as before: patched, not computed anew')(damaged(packet))


def unchanged(packet):
    def act(p):
        sent = packet(p.source())
        came = p.passes(sent)
        if came.but_for_the_relay() != sent.but_for_the_relay():
            raise Failed('%s came out of %s' % (came.hex(), sent.hex()))
    return act


for size in (1, 2, 3, 4, 5, 511, 512):
    case('2.2', 'a DATP of %d bytes of data passes unchanged' % size, 'it', 'the same but for HOP, FBC and CRC')(
        unchanged(lambda s, size=size: s.packet(UP, data=bytes(i * 7 & 255 for i in range(size)))))
case('3.1', 'data may have any value', 'a DATP with all 256 values, SOP and EOP among them', 'the same data')(
    unchanged(lambda s: s.packet(UP, data=bytes(range(256)) + b'\xfb\xfd\xa7\xff')))
case('3.3', 'the tries of others are not touched', 'a third retry', 'the same Code')(
    unchanged(lambda s: s.packet(UP, attempt=3)))
case('3.6', 'the channels of others are not touched', 'a DATP of channel 63, priority 3', 'the same PRI')(
    unchanged(lambda s: s.packet(UP, 63 << 2 | 3)))
case('3.2', 'an INTP passes unchanged', 'an INTP of factor 5', 'the same but for HOP, FBC and CRC')(
    unchanged(lambda s: s.interrupt(UP, 5)))


@case('2.3', 'a source that is not in the list is relayed as any other', 'a DATP of node 77, which there is not', 'it is passed on')
def _(p):
    p.passes(Packet.build(77, UP, data=DATA))


@case('2.3', 'a source that is not in the list is answered as any other', 'a DATP of node 78 to the node', 'FBC 1 to 254')
def _(p):
    taken(p, p.fbc_of(Packet.build(78, OWN, data=DATA)))


def discarded(title, make, why, section='2.2'):
    @case(section, title, 'such a packet', 'it is not passed on; the next good one is')
    def _(p):
        sent = make(p.source())
        p.passes_not(sent, why)


discarded('a DATP that has been everywhere ends here', lambda s: s.packet(UP, hop=3), 'HOP + 1 is the number of nodes', '4.9')
discarded('an INTP that has been everywhere ends here', lambda s: s.interrupt(UP, SYNC, hop=3), 'HOP + 1 is the number of nodes', '4.9')
discarded('a DATP with HOP 255 ends here', lambda s: s.packet(UP, hop=255), 'its HOP is beyond all', '4.9')
discarded('an own DATP is taken off the ring', lambda s: Packet.build(OWN, UP, data=DATA, hop=3), 'its SID is that of the node')
discarded('an own INTP is taken off the ring', lambda s: Packet.build(OWN, UP, SYNC, interrupt=True, hop=3), 'its SID is that of the node')
discarded('an own damaged DATP is taken off the ring', lambda s: Packet.build(OWN, UP, data=DATA, hop=3).damaged(), 'its SID is that of the node')
discarded('SID 255 is discarded', lambda s: Packet.build(255, UP, data=DATA), 'SID 255 is nobody')
discarded('a DATP without SOP is discarded', lambda s: s.packet(UP, sop=0xFA), 'it does not begin with SOP')
discarded('an INTP without SOP is discarded', lambda s: s.interrupt(UP, SYNC, sop=0xFA), 'it does not begin with SOP')


@case('2.2', 'a DATP in an INTP\'s slice is discarded', 'an `interrupt` with bit 5 of Code 0', 'it is not passed on')
def _(p):
    bad = Packet.build(FAR, UP, SYNC, interrupt=True)
    bad = Packet(bytes([bad[0] & 0xDF]) + bad[1:-4] + wire.crc(bytes([bad[0] & 0xDF]) + bad[1:-4]))
    p.passes_not(bad, 'its kind bit does not fit the slice', (INTERRUPT, bad))


@case('2.2', 'an INTP in a DATP\'s slice is discarded', 'a `whole` with bit 5 of Code 1', 'it is not passed on')
def _(p):
    good = Packet.build(FAR, UP, data=b'y')
    covered = bytes([good[0] | 0x20]) + good[1:-4]
    bad = Packet(covered + wire.crc(covered))
    p.passes_not(bad, 'its kind bit does not fit the slice', (WHOLE, bad))


@case('2.2', 'the highest HOP that may pass passes', 'a DATP with HOP N - 2', 'it is passed on')
def _(p):
    p.passes(p.source().packet(UP, hop=2))


@case('2.2', 'order is kept', 'ten DATPs, one behind the other', 'they come out in this order')
def _(p):
    source = p.source()
    sent = [source.packet(UP, data=b'%d' % i) for i in range(10)]
    p.expect('the order', [one.data for one in p.exchange(*sent) if one.source == FAR], [one.data for one in sent])


# ---- slices ---------------------------------------------------------------------------------

def cut(packet, *places):
    """`start`, `more`, `end` at these bytes of it."""
    ends = list(places) + [len(packet)]
    kinds = [START] + [MORE] * (len(places) - 1) + [END]
    return [(kind, packet[begin:end]) for kind, begin, end in zip(kinds, [0] + list(places), ends)]


for title, places in (('start and end', (12,)), ('a start of the header alone', (4,)), ('start, more and end', (8, 16)),
                      ('a more for each word', (4, 8, 12, 16, 20, 24))):
    @case('6.3', 'a DATP may come as %s' % title, 'one that is cut so', 'it comes out whole')
    def _(p, places=places):
        sent = p.source().packet(UP, data=DATA)
        p.expect('what comes out', p.passes(sent, *cut(sent, *places)).data, sent.data)


@case('6.3', 'the longest DATP may come in pieces', 'one of 512 bytes, as start, more and end', 'it comes out whole')
def _(p):
    sent = p.source().packet(UP, data=bytes(i & 255 for i in range(512)))
    p.expect('what comes out', p.passes(sent, *cut(sent, 4, 516)).data, sent.data)


for odd in (1, 2, 3):
    @case('6.3', 'the end may begin with %d odd bytes' % odd, 'a DATP of 8 + %d bytes of data, cut behind its words' % odd,
          'it comes out whole')
    def _(p, odd=odd):
        sent = p.source().packet(UP, data=DATA[:8 + odd])
        p.expect('what comes out', p.passes(sent, *cut(sent, 12)).data, sent.data)


def embedded(place, title):
    @case('5.2', 'an INTP %s is taken out' % title, 'it', 'both packets come out')
    def _(p):
        source = p.source()
        data, interrupt = source.packet(UP, data=DATA), source.interrupt(UP, SYNC)
        slices = cut(data, 8, 16)
        slices.insert(place, (INTERRUPT, interrupt))
        came = p.exchange(*slices)
        kinds = sorted(one.interrupt for one in came if one.source == FAR)
        p.expect('what comes out (INTP?)', kinds, [False, True])


embedded(1, 'behind the start of a DATP')
embedded(2, 'behind a more of a DATP')


@case('5.2', 'a DATP around an INTP comes out as it was', 'an INTP within it', 'the data of the DATP, unchanged')
def _(p):
    source = p.source()
    data, interrupt = source.packet(UP, data=DATA), source.interrupt(UP, SYNC)
    slices = cut(data, 8)
    p.expect('its data', p.passes(data, slices[0], (INTERRUPT, interrupt), slices[1]).data, data.data)


@case('5.2', 'two INTPs within a DATP keep their order', 'factors 3 and 4', 'factor 3, then factor 4')
def _(p):
    source = p.source()
    data, one, two = source.packet(UP, data=DATA), source.interrupt(UP, 3), source.interrupt(UP, 4)
    slices = cut(data, 8)
    came = p.exchange(slices[0], (INTERRUPT, one), (INTERRUPT, two), slices[1])
    p.expect('the factors', [each.last for each in came if each.interrupt], [3, 4])


@case('5.2', 'no INTP within an INTP, and none within a word', 'DATPs and INTPs at once', 'each slice of the line out fits 6.2')
def _(p):
    source = p.source()
    for size in (1, 4, 7, 21):
        data, interrupt = source.packet(UP, data=bytes(size)), source.interrupt(UP, SYNC)
        slices = cut(data, 4 + size // 4 * 4)
        p.exchange(slices[0], (INTERRUPT, interrupt), slices[1])
    words_only(p)


def words_only(p):
    for _, _, framed in p.slices:
        kind, size = framed[1], len(framed) - 4
        if kind in (START, MORE) and size % 4:
            raise Failed('a `%s` of %d bytes: whole words only' % (wire.SLICE_NAMES[kind], size))


@case('6.3', 'idle within a DATP changes nothing', 'start, idle, end', 'the DATP comes out')
def _(p):
    sent = p.source().packet(UP, data=DATA)
    slices = cut(sent, 8)
    p.passes(sent, slices[0], (IDLE, b''), slices[1])


@case('6.3', 'a fold word is no packet', 'start, fold, end', 'the DATP comes out')
def _(p):
    sent = p.source().packet(UP, data=DATA)
    slices = cut(sent, 8)
    p.passes(sent, slices[0], (FOLD, bytes([1, FAR, 0xFF ^ 1 ^ FAR])), slices[1])


@case('2.6', 'a DATP that is aborted never comes out', 'start, abort, then a stray end', 'nothing of it as a whole')
def _(p):
    sent = p.source().packet(UP, data=DATA)
    slices = cut(sent, 8)
    p.passes_not(sent, 'it was aborted', slices[0], (ABORT, b''), slices[1])


@case('5.2', 'an INTP within an aborted DATP goes on', 'start, interrupt, abort', 'the INTP comes out')
def _(p):
    source = p.source()
    data, interrupt = source.packet(UP, data=DATA), source.interrupt(UP, SYNC)
    p.passes(interrupt, cut(data, 8)[0], (INTERRUPT, interrupt), (ABORT, b''))


for kind, content in ((MORE, b'abcd'), (END, b'abcdefgh'), (ABORT, b'')):
    @case('2.6', 'a stray %s does no harm' % wire.SLICE_NAMES[kind], 'it, while no DATP is open', 'the next packet passes')
    def _(p, kind=kind, content=content):
        sent = p.source().packet(UP, data=DATA)
        p.passes(sent, (kind, content), (WHOLE, sent))


@case('2.6', 'another DATP within a DATP breaks it off', 'start, then a whole, then the end of the first', 'the first never comes out')
def _(p):
    source = p.source()
    first, second = source.packet(UP, data=DATA), source.packet(UP, data=b'second')
    slices = cut(first, 8)
    p.passes_not(first, 'another one began inside it', slices[0], (WHOLE, second), slices[1])


@case('2.6', 'a DATP that breaks another one off passes itself', 'start of one, start and end of another', 'the other comes out')
def _(p):
    source = p.source()
    first, second = source.packet(UP, data=DATA), source.packet(UP, data=b'second one')
    p.passes(second, cut(first, 8)[0], *cut(second, 8))


@case('2.6', 'a DATP of more than 524 bytes never comes out', 'start of 516 bytes, more of 512, end', 'nothing of it as a whole')
def _(p):
    sent = p.source().packet(UP, data=DATA)
    p.passes_not(sent, 'it is too long', (START, sent[:4] + bytes(512)), (MORE, bytes(512)), (END, sent[4:]))


@case('2.6', 'a DATP without data never comes out', 'a start of 4 bytes and an end of 8', 'nothing of it')
def _(p):
    sent = p.source().packet(UP, data=b'')
    p.passes_not(sent, 'it has no data', (START, sent[:4]), (END, sent[4:]))


@case('2.6', 'a DATP whose rest does not come is given up', 'start; its end after four stall times (7.4)', 'it never comes out')
def _(p):
    sent = p.source().packet(UP, data=DATA)
    slices = cut(sent, 8)
    p.returns = lambda packet: []  # nothing else may break it off
    p.slice(*slices[0])
    p.pump(limit=4 * wire.TIMES['stall'] / 1000)
    p.passes_not(sent, 'its next slice did not come within the stall time', slices[1])


# ---- Receive ----------------------------------------------------------------------------------

def taken(p, fbc):
    if not 1 <= fbc <= 254:
        raise Failed('FBC is %d, 1 to 254 expected: it is taken' % fbc)


@case('3.5', 'a DATP to the node is answered', 'a DATP to it', 'FBC 1 to 254: the free buffers')
def _(p):
    taken(p, p.fbc_of(p.source().packet(OWN)))


@case('3.5', 'a broadcast is answered', 'a DATP to all', 'FBC 1 to 254')
def _(p):
    taken(p, p.fbc_of(p.source().packet(ALL)))


@case('3.5', 'FBC is the least of all answers', 'a broadcast with FBC 1 already', 'FBC 1')
def _(p):
    p.expect('FBC', p.fbc_of(p.source().packet(ALL, fbc=1)), 1)


@case('3.5', 'a refusal of another node stays', 'a broadcast with FBC 0 already', 'FBC 0')
def _(p):
    p.expect('FBC', p.fbc_of(p.source().packet(ALL, fbc=0)), 0)


@case('3.5', 'a node answers for nobody else', 'a DATP to node down', 'FBC stays 255')
def _(p):
    p.expect('FBC', p.fbc_of(p.source().packet(DOWN)), UNTAKEN)


@case('3.5', 'a node answers no INTP of others', 'an INTP to node down', 'FBC stays 255')
def _(p):
    p.expect('FBC', p.fbc_of(p.source().interrupt(DOWN, SYNC)), UNTAKEN)


@case('3.5', 'a pin that is wired is pulled', 'an INTP, factor 2 (sync)', 'FBC 1')
def _(p):
    p.expect('FBC', p.fbc_of(p.source().interrupt(OWN, SYNC)), 1)


@case('3.5', 'a pin that is wired to nothing refuses', 'an INTP, factor 7', 'FBC 0')
def _(p):
    p.expect('FBC', p.fbc_of(p.source().interrupt(OWN, UNWIRED)), 0)


@case('3.2', 'bits 7 to 3 of INT are ignored', 'an INTP with INT 0xF8 + 2', 'FBC 1: pin 2 is pulled')
def _(p):
    p.expect('FBC', p.fbc_of(p.source().interrupt(OWN, 0xF8 | SYNC)), 1)


@case('2.3', 'a damaged DATP is not answered', 'a DATP to the node with a wrong CRC', 'FBC stays 255')
def _(p):
    p.expect('FBC', p.fbc_of(p.source().packet(OWN, data=DATA).damaged()), UNTAKEN)


@case('2.3', 'a damaged INTP is not answered', 'an INTP to the node whose CRC is wrong', 'FBC stays 255')
def _(p):
    good = p.source().interrupt(OWN, SYNC)
    bad = Packet(good[:-1] + bytes([good[-1] ^ 1]))
    p.expect('FBC', p.fbc_of(bad), UNTAKEN)


@case('2.3', 'a DATP without EOP is not answered', 'a DATP to the node, its trailer begins with 0xFC', 'FBC stays 255')
def _(p):
    p.expect('FBC', p.fbc_of(p.source().packet(OWN, data=DATA, eop=0xFC)), UNTAKEN)


@case('2.3', 'the right copy of a damaged DATP is taken', 'it damaged, then its retry', 'FBC 1 to 254')
def _(p):
    source = p.source()
    sent = source.packet(OWN, data=DATA)
    p.exchange(sent.damaged())
    taken(p, p.fbc_of(source.packet(OWN, data=DATA, sequence=sent.sequence, attempt=1)))


@case('2.3', 'data arrive as they are', 'a DATP to a node whose CPU sends it back', 'the same data come back')
def _(p):
    p.needs_echo()
    data = bytes(range(256)) + bytes(200)
    p.expect('copies that came back', p.count_echoes(data, p.source().packet(OWN, data=data)), 1)


@case('2.3', 'a broadcast arrives', 'a DATP to all', 'its data come back')
def _(p):
    p.needs_echo()
    p.expect('copies that came back', p.count_echoes(b'to all', p.source().packet(ALL, data=b'to all')), 1)


@case('2.3', 'what is for others does not reach the CPU', 'a DATP to node down', 'nothing comes back')
def _(p):
    p.needs_echo()
    p.expect('copies that came back', p.count_echoes(b'not yours', p.source().packet(DOWN, data=b'not yours')), 0)


@case('4.9', 'what has been everywhere does not reach the CPU', 'a DATP to the node with HOP N - 1', 'nothing comes back')
def _(p):
    p.needs_echo()
    p.expect('copies that came back', p.count_echoes(b'late', p.source().packet(OWN, data=b'late', hop=3)), 0)


# ---- channel 1 ------------------------------------------------------------------------------

for title, make, section in (
        ('a hello', lambda s: s.hello(s.boot + 4), '3.8'),
        ('a beacon of 26 bytes', lambda s: s.control(wire.beacon(s.boot)), '3.9'),
        ('a beacon of 40 bytes', lambda s: s.control(wire.beacon(s.boot, bytes([1]) + bytes(13))), '3.9'),
        ('what is neither hello nor beacon', lambda s: s.control(b'\x03'), '3.5'),
        ('a beacon of 40 bytes whose last 14 say nothing', lambda s: s.control(wire.beacon(s.boot, bytes(14))), '3.9'),
        ('a hello of 11 bytes', lambda s: s.control(wire.hello(s.boot) + b'\0'), '3.8')):
    @case(section, '%s is taken' % title, 'it, on channel 1', 'FBC 254')
    def _(p, make=make):
        p.expect('FBC', p.fbc_of(make(p.source())), 254)


# ---- exactly once (protocol.md section 4.10) --------------------------------------------------

def again(source, packet, attempt=0, **fields):
    """The same number once more."""
    return Packet.build(source.node, packet.destination, packet.last, packet.data, packet.interrupt, packet.incarnation,
                        attempt, packet.sequence, **fields)


@case('4.10', 'the same number has the same verdict', 'a DATP to the node twice', 'FBC 1 to 254 again')
def _(p):
    source = p.source()
    sent = source.packet(OWN)
    p.exchange(sent)
    taken(p, p.fbc_of(again(source, sent)))


@case('4.10', 'a retry of what was taken has the same verdict', 'a DATP, then its retry', 'FBC 1 to 254 again')
def _(p):
    source = p.source()
    sent = source.packet(OWN)
    p.exchange(sent)
    taken(p, p.fbc_of(again(source, sent, 1)))


@case('4.10', 'a doubled DATP is delivered once', 'a DATP to the node twice', 'its data come back once')
def _(p):
    p.needs_echo()
    source = p.source()
    sent = source.packet(OWN, data=b'once')
    p.expect('copies that came back', p.count_echoes(b'once', sent, again(source, sent)), 1)


@case('4.10', 'a retry is delivered once', 'a DATP, then its three retries', 'its data come back once')
def _(p):
    p.needs_echo()
    source = p.source()
    sent = source.packet(OWN, data=b'tries')
    p.expect('copies that came back', p.count_echoes(b'tries', sent, *(again(source, sent, n) for n in (1, 2, 3))), 1)


@case('4.10', 'a doubled broadcast is delivered once', 'a DATP to all twice', 'its data come back once')
def _(p):
    p.needs_echo()
    source = p.source()
    sent = source.packet(ALL, data=b'all once')
    p.expect('copies that came back', p.count_echoes(b'all once', sent, again(source, sent)), 1)


@case('4.10', 'the next number is new', 'two DATPs with numbers 0 and 1', 'both come back')
def _(p):
    p.needs_echo()
    source = p.source()
    p.expect('copies that came back',
             p.count_echoes(b'both', source.packet(OWN, data=b'both'), source.packet(OWN, data=b'both')), 2)


@case('4.10', 'broadcasts have numbers of their own', 'number 0 to the node, number of the same to all', 'both come back')
def _(p):
    p.needs_echo()
    source = p.source()
    p.expect('copies that came back',
             p.count_echoes(b'own numbers', source.packet(OWN, data=b'own numbers', sequence=5),
                            source.packet(ALL, data=b'own numbers', sequence=5)), 2)


@case('4.10', 'a retry whose first try was lost is taken', 'a retry alone', 'its data come back')
def _(p):
    p.needs_echo()
    p.expect('copies that came back', p.count_echoes(b'retry', p.source().packet(OWN, data=b'retry', attempt=2)), 1)


@case('4.10', 'a first try of an old number is new', 'number 0, and after three time-outs of a try number 0 again, as a first try',
      'both come back')
def _(p):
    p.needs_echo()
    source = p.source()
    sent = source.packet(OWN, data=b'wrapped')
    first = p.count_echoes(b'wrapped', sent)
    p.pump(limit=0.3)
    p.expect('copies that came back', first + p.count_echoes(b'wrapped', again(source, sent)), 2)


@case('4.10', 'a retry is known however old its number is', 'number 0, and after three time-outs of a try its retry', 'one comes back')
def _(p):
    p.needs_echo()
    source = p.source()
    sent = source.packet(OWN, data=b'old retry')
    first = p.count_echoes(b'old retry', sent)
    p.pump(limit=0.3)
    p.expect('copies that came back', first + p.count_echoes(b'old retry', again(source, sent, 1)), 1)


@case('4.10', 'the same INTP again has the same verdict', 'an INTP, then its retry', 'FBC 1 again')
def _(p):
    source = p.source()
    sent = source.interrupt(OWN, SYNC)
    p.exchange(sent)
    p.expect('FBC', p.fbc_of(again(source, sent, 1)), 1)


@case('4.10', 'a refused INTP again is refused again', 'an INTP to an unwired pin, then its retry', 'FBC 0 again')
def _(p):
    source = p.source()
    sent = source.interrupt(OWN, UNWIRED)
    p.exchange(sent)
    p.expect('FBC', p.fbc_of(again(source, sent, 1)), 0)


@case('4.10', 'a number that was decided decides, not what the packet says', 'an INTP to an unwired pin, then the same number to a wired one',
      'FBC 0: the verdict on this number')
def _(p):
    source = p.source()
    sent = source.interrupt(OWN, UNWIRED)
    p.exchange(sent)
    p.expect('FBC', p.fbc_of(source.interrupt(OWN, SYNC, sequence=sent.sequence)), 0)


@case('4.10', 'INTPs have numbers of their own', 'a DATP and an INTP with the same number', 'FBC 0: the unwired pin')
def _(p):
    source = p.source()
    p.exchange(source.packet(OWN, sequence=6))
    p.expect('FBC', p.fbc_of(source.interrupt(OWN, UNWIRED, sequence=6)), 0)


@case('4.10', 'each source has numbers of its own', 'the same number of two sources', 'the unwired pin of the second: FBC 0')
def _(p):
    one, two = p.source(FAR), p.source(DOWN)
    p.exchange(one.interrupt(OWN, SYNC, sequence=4))
    p.expect('FBC', p.fbc_of(two.interrupt(OWN, UNWIRED, sequence=4)), 0)


for ahead in (1, 2):
    @case('4.10', 'an incarnation that is %d ahead is later' % ahead, 'number 0 to an unwired pin, then number 0 of that incarnation to a wired one',
          'FBC 1: a new page')
    def _(p, ahead=ahead):
        source = p.source()
        p.exchange(source.interrupt(OWN, UNWIRED, sequence=0))
        p.expect('FBC', p.fbc_of(source.interrupt(OWN, SYNC, sequence=0, incarnation=source.boot + ahead & 3)), 1)


@case('4.10', 'a DATP of an earlier incarnation is not taken', 'a DATP of the incarnation before', 'FBC 0')
def _(p):
    source = p.source()
    p.expect('FBC', p.fbc_of(source.packet(OWN, incarnation=source.boot - 1 & 3)), 0)


@case('4.10', 'an INTP of an earlier incarnation is not taken', 'an INTP of the incarnation before', 'FBC 0')
def _(p):
    source = p.source()
    p.expect('FBC', p.fbc_of(source.interrupt(OWN, SYNC, incarnation=source.boot - 1 & 3)), 0)


@case('4.10', 'an earlier incarnation reaches no CPU', 'a DATP of the incarnation before', 'nothing comes back')
def _(p):
    p.needs_echo()
    source = p.source()
    p.expect('copies that came back', p.count_echoes(b'stale', source.packet(OWN, data=b'stale', incarnation=source.boot - 1 & 3)), 0)


@case('4.10', 'a hello begins a new page', 'number 0 to an unwired pin, a hello with a higher boot number, number 0 to a wired one', 'FBC 1')
def _(p):
    source = p.source()
    p.exchange(source.interrupt(OWN, UNWIRED, sequence=0), source.hello(source.boot + 4))
    p.expect('FBC', p.fbc_of(source.interrupt(OWN, SYNC, sequence=0)), 1)


@case('4.10', 'a hello with a lower boot number is not heeded', 'a hello lower by 4', 'FBC 0')
def _(p):
    source = p.source()
    p.expect('FBC', p.fbc_of(source.control(wire.hello(source.boot - 4))), 0)


@case('4.10', 'a beacon with a lower boot number is not heeded', 'a beacon lower by 4', 'FBC 0')
def _(p):
    source = p.source()
    p.expect('FBC', p.fbc_of(source.control(wire.beacon(source.boot - 4))), 0)


@case('4.10', 'what is not heeded changes nothing', 'number 0 to an unwired pin, a hello lower by 4, number 0 to a wired pin', 'FBC 0: the page holds')
def _(p):
    source = p.source()
    p.exchange(source.interrupt(OWN, UNWIRED, sequence=0), source.control(wire.hello(source.boot - 4)))
    p.expect('FBC', p.fbc_of(source.interrupt(OWN, SYNC, sequence=0)), 0)


@case('4.10', 'a hello that is lower by more than 1000 is a clock that was set back', 'a hello lower by 1004', 'FBC 254')
def _(p):
    source = p.source()
    p.expect('FBC', p.fbc_of(source.hello(source.boot - 1004)), 254)


@case('4.10', 'a beacon with the same boot number keeps the page', 'number 0 to an unwired pin, a beacon, number 0 to a wired pin', 'FBC 0: the page holds')
def _(p):
    source = p.source()
    p.exchange(source.interrupt(OWN, UNWIRED, sequence=0), source.control(wire.beacon(source.boot)))
    p.expect('FBC', p.fbc_of(source.interrupt(OWN, SYNC, sequence=0)), 0)


@case('4.10', 'a beacon of a later boot number begins a new page',
      'number 0 to an unwired pin, a beacon whose boot number is one higher, number 0 of it to a wired pin', 'FBC 1')
def _(p):
    source = p.source()
    p.exchange(source.interrupt(OWN, UNWIRED, sequence=0))
    source.boot += 1
    p.exchange(source.control(wire.beacon(source.boot)))
    p.expect('FBC', p.fbc_of(source.interrupt(OWN, SYNC, sequence=0)), 1)


@case('4.10', 'a page that a packet began holds when its beacon comes',
      'number 0 of the next incarnation to an unwired pin, its beacon, number 0 to a wired pin', 'FBC 0: the page holds')
def _(p):
    source = p.source()
    source.boot += 1
    p.exchange(source.interrupt(OWN, UNWIRED, sequence=0), source.control(wire.beacon(source.boot)))
    p.expect('FBC', p.fbc_of(source.interrupt(OWN, SYNC, sequence=0)), 0)
