"""Results as text, JSON, JUnit, HTML, and captures (docs/reference/captures.md)."""

import collections
import html
import json
import os
import struct
import time
from xml.sax.saxutils import quoteattr

from . import wire
from .play import DOWN, NAMES, ORDER, OWN, UP

PASSED, LENIENT, FAILED, NOT_APPLICABLE, NOT_RUN = 'passed', 'lenient', 'failed', 'not applicable', 'not run'
VERDICTS = (PASSED, LENIENT, FAILED, NOT_APPLICABLE, NOT_RUN)

Result = collections.namedtuple('Result', 'case verdict why log seconds expected')


# ---- in words -----------------------------------------------------------------------------------

def datagram_in_words(place, datagram):
    if not datagram:
        return 'the end of the connection'
    if len(datagram) < wire.HEADER.size or datagram[:2] != b'LR':
        return '%d bytes that are no link header' % len(datagram)
    header = wire.Header._make(wire.HEADER.unpack_from(datagram))
    name = wire.HEADER_NAMES.get(header.type, 'type %d' % header.type)
    if header.type != wire.SLICES:
        refusal = ', refusal %d' % header.refusal if header.refusal else ''
        return '%s, session %x%s' % (name, header.session, refusal)
    framed = datagram[wire.HEADER.size:]
    if len(framed) < 4:
        return 'sequence %d: %s' % (header.sequence, framed.hex())
    kind, data = wire.SLICE_NAMES.get(framed[1], 'kind %d' % framed[1]), framed[4:]
    if framed[1] in (wire.WHOLE, wire.INTERRUPT) and len(data) >= 12:
        return 'sequence %d: %s, %s' % (header.sequence, kind, wire.Packet(data).in_words())
    return 'sequence %d: %s %s' % (header.sequence, kind, data[:24].hex())


def is_sign_of_life(datagram):
    return len(datagram) >= 26 and (datagram[3] == wire.ALIVE or
                                    datagram[3] == wire.SLICES and datagram[26:30] == wire.slice_of(wire.IDLE))


def log_in_words(log, most=40):
    """The last of what was said, without signs of life."""
    spoken = [one for one in log if not is_sign_of_life(one[3])]
    if not spoken:
        return []
    begun = spoken[0][0]
    lines = ['%8.1f ms  %-13s %-7s %s' % (1000 * (at - begun), way, NAMES[ORDER.index(place[1])], datagram_in_words(place, one))
             for at, way, place, one in spoken]
    left = len(lines) - most
    return (['(%d before)' % left] if left > 0 else []) + lines[-most:]


def result_lines(result, words=True):
    case = result.case
    out = ['%-8s %-14s %s' % (case.number, result.verdict, case.title)]
    if result.verdict in (FAILED, LENIENT):
        out += ['    protocol.md section %s' % case.section, '    sent:     %s' % case.sent,
                '    expected: %s, within %s' % (case.expected, case.by), '    seen:     %s' % result.why]
        if words:
            out += ['    ' + line for line in log_in_words(result.log)]
    elif result.verdict != PASSED:
        out.append('    %s' % result.why)
    return out


def counts(results):
    return collections.Counter(one.verdict for one in results)


def summary(results, seconds):
    numbers = counts(results)
    return '%d cases in %.1f s: %s' % (len(results), seconds, ', '.join(
        '%d %s' % (numbers[verdict], verdict) for verdict in VERDICTS if numbers[verdict]))


# ---- files ----------------------------------------------------------------------------------------

def as_dict(result):
    case = result.case
    return {'number': case.number, 'section': case.section, 'title': case.title, 'sent': case.sent, 'expected': case.expected,
            'by': case.by, 'profile': case.profile, 'verdict': result.verdict, 'why': result.why,
            'known_failure': result.expected, 'seconds': round(result.seconds, 3),
            'log': log_in_words(result.log) if result.verdict in (FAILED, LENIENT) else []}


def write_json(path, results, about):
    with open(path, 'w', encoding='utf-8') as out:
        json.dump(dict(about, verdicts=counts(results), cases=[as_dict(one) for one in results]), out, indent=1)


def write_junit(path, results, about):
    numbers = counts(results)
    with open(path, 'w', encoding='utf-8') as out:
        out.write('<?xml version="1.0" encoding="UTF-8"?>\n<testsuite name=%s tests="%d" failures="%d" skipped="%d">\n' % (
            quoteattr('conform ' + about['node']), len(results), numbers[FAILED], numbers[NOT_RUN] + numbers[NOT_APPLICABLE]))
        for one in results:
            out.write(' <testcase classname=%s name=%s time="%.3f">' % (
                quoteattr('protocol.md.' + one.case.section), quoteattr(one.case.number + ' ' + one.case.title), one.seconds))
            if one.verdict == FAILED:
                out.write('<failure message=%s>%s</failure>' % (quoteattr(one.why), html.escape('\n'.join(log_in_words(one.log)))))
            elif one.verdict in (NOT_RUN, NOT_APPLICABLE):
                out.write('<skipped message=%s/>' % quoteattr(one.why))
            out.write('</testcase>\n')
        out.write('</testsuite>\n')


STYLE = ('body{font-family:sans-serif;margin:2em}td,th{text-align:left;vertical-align:top;padding:.2em .6em;border-bottom:1px solid #ddd}'
         'pre{margin:0;font-size:85%}.failed{background:#fdd}.lenient{background:#ffd}.passed{color:#060}')


def write_html(path, results, about):
    with open(path, 'w', encoding='utf-8') as out:
        out.write('<!doctype html><meta charset="utf-8"><title>Conformance</title><style>%s</style>\n<h1>%s</h1><p>%s</p>\n' % (
            STYLE, html.escape(about['node']), html.escape(summary(results, about['seconds']))))
        out.write('<table><tr><th>case<th>verdict<th>title<th>expected<th>seen</tr>\n')
        for one in results:
            words = ''.join('<br><pre>%s</pre>' % html.escape('\n'.join(log_in_words(one.log))) if one.verdict == FAILED else '')
            cells = (one.case.number, one.verdict, one.case.title, '%s; expected: %s' % (one.case.sent, one.case.expected), one.why)
            out.write('<tr class="%s">%s%s</tr>\n' % (one.verdict, ''.join('<td>' + html.escape(cell) for cell in cells), words))
        out.write('</table>\n')


# ---- captures ---------------------------------------------------------------------------------------

def block(kind, body):
    body += b'\0' * (-len(body) % 4)
    size = struct.pack('<I', len(body) + 12)
    return struct.pack('<I', kind) + size + body + size


def option(code, value):
    return struct.pack('<HH', code, len(value)) + value + b'\0' * (-len(value) % 4)


def packets_of(log):
    """Those on the two lines: when, from, to, seen at the node's input, packet."""
    lines = {'to the node': wire.Assembler(), 'from the node': wire.Assembler()}
    for at, way, place, datagram in log:
        if len(datagram) < 30 or datagram[3] != wire.SLICES:
            continue
        framed = datagram[wire.HEADER.size:]
        for packet in lines[way].take(framed[1], framed[4:]):
            if len(packet) >= 12:
                ends = (place[1], OWN) if way == 'to the node' else (OWN, place[1])
                yield at, ends, way == 'to the node', packet


def write_capture(path, result, ring):
    """pcapng, as `ringctl traffic show -r` and Wireshark read it."""
    names = ' '.join('%d=%s' % pair for pair in zip(ORDER, NAMES))
    clock = time.time() - result.log[-1][0] if result.log else 0
    with open(path, 'wb') as out:
        out.write(block(0x0A0D0D0A, struct.pack('<IHHII', 0x1A2B3C4D, 1, 0, 0xFFFFFFFF, 0xFFFFFFFF) +
                        option(1, ('ring %s; nodes %s' % (ring, names)).encode()) + option(4, b'limb_ring') + bytes(4)))
        interfaces = {}
        for at, ends, comes_in, packet in packets_of(result.log):
            if ends not in interfaces:
                interfaces[ends] = len(interfaces)
                name = ' -> '.join(NAMES[ORDER.index(node)] for node in ends)
                out.write(block(1, struct.pack('<HHI', 147, 0, 0) + option(2, name.encode()) + option(9, b'\x09') + bytes(4)))
            flags = (not packet.right) | bool(packet.attempt) << 4 | (packet.source == OWN) << 5 | comes_in << 6
            content = struct.pack('>BBBBIBBH', 1, flags, *ends, 0, 0, 0, 0) + packet
            stamp = int((at + clock) * 1e9)
            out.write(block(6, struct.pack('<IIIII', interfaces[ends], stamp >> 32, stamp & 0xFFFFFFFF, len(content), len(content)) +
                            content + b'\0' * (-len(content) % 4) +
                            option(2, struct.pack('<I', (1 if comes_in else 2) | (not packet.right) << 24)) + bytes(4)))


def capture_path(folder, case):
    return os.path.join(folder, case.number + '.pcapng')
