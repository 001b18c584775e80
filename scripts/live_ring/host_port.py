"""The host port's messages, written once more from their description (daemon/client/frame.h,
host_message.h) so that the tests do not lean on the code they test."""

import json
import os
import socket
import struct
import time

GREETING, SEND, INTERRUPT, PULL, REQUEST, OBSERVE, ALIVE, CREDIT = range(1, 9)
WELCOME, REFUSED, PACKET, PULLED, RESULT, REPLY, OBSERVED, OBSERVED_LOST, \
    CAPTURED, CAPTURE_COUNTS = range(0x81, 0x8B)
OUTCOMES = ['delivered', 'refused', 'no such node', 'lost', 'unconfirmed', 'rejected', 'cancelled']
MAGIC, VERSION = 0x4C524850, 3
TOOL, CPU = 0, 1
BROADCAST = 0xFF


def frame(kind, body=b''):
    return struct.pack('>IB', len(body) + 1, kind) + body


def text(value):
    return struct.pack('>H', len(value)) + value.encode()


def greeting(ring, role=TOOL, restarted_by_owner=False, alive_period_ms=0, version=VERSION):
    return frame(GREETING, struct.pack('>IHBBII', MAGIC, version, role, restarted_by_owner,
                                       os.getpid(), alive_period_ms) + text(ring))


class HostPort:
    """A tool or CPU at a node. Messages are (kind, value) in order of arrival."""

    def __init__(self, connection):
        self.connection = connection
        self.buffer = b''
        self.messages = []
        self.token = 0

    @classmethod
    def connect(cls, path, ring, role=TOOL, credit=64, timeout=10, **options):
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        connection.settimeout(timeout)
        try:
            connection.connect(path)
            connection.sendall(greeting(ring, role, **options))
            port = cls(connection)
            kind, value = port.receive(timeout)
        except (OSError, TimeoutError):
            connection.close()
            raise
        if kind != WELCOME:
            connection.close()
            raise ConnectionRefusedError(value)
        if role == CPU:
            port.give_credit(credit)
        return port

    def close(self):
        self.connection.close()

    # ---- out ------------------------------------------------------------------------------

    def _order(self, kind, body):
        self.token += 1
        self.connection.sendall(frame(kind, struct.pack('>I', self.token) + body))
        return self.token

    def send(self, to, data, priority=2, channel=0):
        return self._order(SEND, struct.pack('>BBB', to, priority, channel) + data)

    def interrupt(self, to, factor, force=False):
        return self._order(INTERRUPT, struct.pack('>BBB', to, factor, force))

    def pull(self, number):
        return self._order(PULL, struct.pack('>B', number))

    def request(self, order):
        return self.request_text(json.dumps(order).encode())

    def request_text(self, text):
        return self._order(REQUEST, text)

    def give_credit(self, count):
        self.connection.sendall(frame(CREDIT, struct.pack('>H', count)))

    def observe(self, *kinds):
        self.connection.sendall(frame(OBSERVE, json.dumps({'kinds': kinds}).encode()))

    def observe_packets(self, **wish):
        self.connection.sendall(frame(OBSERVE, json.dumps({'packets': wish}).encode()))

    def end_observing(self):
        self.connection.sendall(frame(OBSERVE, b'{"packets": null}'))

    # ---- in -------------------------------------------------------------------------------

    def receive(self, timeout=30):
        """The next message. @raise ConnectionError at the end, TimeoutError"""
        if self.messages:
            return self.messages.pop(0)
        return self._read(timeout)

    def received(self, kind):
        """All messages of a kind that are here by now, without waiting."""
        try:
            while True:
                self.messages.append(self._read(0.001))
        except TimeoutError:
            pass
        found = [value for what, value in self.messages if what == kind]
        self.messages = [message for message in self.messages if message[0] != kind]
        return found

    def result(self, token=None, timeout=30):
        """The next Result, or that of a token: {'token', 'outcome', 'tries', 'reason'}."""
        return self._find(lambda kind, value: kind == RESULT and token in (None, value['token']),
                          timeout)[1]

    def next_of(self, kind, timeout=30):
        return self._find(lambda found, _: found == kind, timeout)[1]

    def ask(self, order, timeout=30):
        return self.reply_to(self.request(order), timeout)

    def reply_to(self, token, timeout=30):
        return self._find(lambda kind, value: kind == REPLY and value[0] == token, timeout)[1][1]

    def _find(self, wanted, timeout):
        for i, message in enumerate(self.messages):
            if wanted(*message):
                return self.messages.pop(i)
        deadline = time.monotonic() + timeout
        while True:
            message = self._read(deadline - time.monotonic())
            if wanted(*message):
                return message
            self.messages.append(message)

    def _read(self, timeout):
        deadline = time.monotonic() + timeout
        while True:
            if len(self.buffer) >= 4:
                end = 4 + struct.unpack_from('>I', self.buffer)[0]
                if len(self.buffer) >= end:
                    kind, body = self.buffer[4], self.buffer[5:end]
                    self.buffer = self.buffer[end:]
                    if kind == PACKET:
                        self.give_credit(1)
                    return kind, decode(kind, body)
            self._fill(deadline - time.monotonic())

    def _fill(self, timeout):
        if timeout <= 0:
            raise TimeoutError('no message came')
        self.connection.settimeout(timeout)
        try:
            data = self.connection.recv(65536)
        except socket.timeout:
            raise TimeoutError('no message came')
        if not data:
            raise ConnectionError('the daemon closed the connection')
        self.buffer += data


def decode(kind, body):
    if kind == PACKET:
        source, destination, priority, channel = body[:4]
        return {'source': source, 'destination': destination, 'priority': priority,
                'channel': channel, 'data': body[4:]}
    if kind == PULLED:
        return {'action': ['notify', 'stop'][body[0]], 'source': body[1], 'factor': body[2]}
    if kind == RESULT:
        token, outcome, tries, _ = struct.unpack_from('>IBHQ', body)
        return {'token': token, 'outcome': OUTCOMES[outcome], 'tries': tries,
                'why': body[15], 'reason': body[16:].decode()}
    if kind == REPLY:
        return struct.unpack_from('>I', body)[0], json.loads(body[4:].decode())
    if kind == OBSERVED:
        return json.loads(body.decode())
    if kind == OBSERVED_LOST:
        return struct.unpack('>Q', body)[0]
    if kind == CAPTURED:
        return captured(body)
    if kind == CAPTURE_COUNTS:
        return dict(zip(COUNTS, struct.unpack('>6Q', body)))
    return body.decode(errors='replace')


COUNTS = ['seen', 'filtered', 'sampled_out', 'limited', 'lost', 'given']
FLAGS = ['crc_bad', 'aborted', 'truncated', 'embedded', 'retry', 'own', 'input']


def captured(body):
    time_ns, steady_ns, lost = struct.unpack_from('>QQI', body)
    version, flags, line_from, line_to, span = struct.unpack_from('>BBBBI', body, 20)
    assert version == 1
    seen = {name: bool(flags >> bit & 1) for bit, name in enumerate(FLAGS)}
    seen.update(time_ns=time_ns, steady_ns=steady_ns, lost_before=lost, span=span,
                line=(line_from, line_to), bytes=body[32:])
    return seen
