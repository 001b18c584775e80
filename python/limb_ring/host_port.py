"""The door between a node's network controller and the programs beside it (limb_ring/host_port.h)."""
import json
import numbers
import operator
import os
import time

from . import _client
from ._client import (EVENT_KINDS, JOINT_CHANNEL, CommandSet, Disconnected, HostPortError, HostPortTimeout, Interrupt, JointCommand, JointState,
                      Reply, Result, SensorReading)

LATEST = 9e9        # s, of a time that the library can have
MOST_KEPT = 65536   # as many as the library keeps for who does not receive() them

_NOT_SAID = object()   # None is something that can be said
_FORMATS = {1: JointState, 2: JointCommand, 3: SensorReading, 4: SensorReading, 5: CommandSet}   # by a packet's first byte


def payload_of(packet):
    """The JointState, JointCommand, CommandSet or SensorReading in a Packet; None where it holds none."""
    known = _FORMATS.get(packet.data[0]) if packet.channel == JOINT_CHANNEL else None
    try:
        return known and known.decode(packet.data)
    except ValueError:
        return None


_client.Packet.payload = property(payload_of)


def _byte(name, value, what):
    """A number of the C++ library that is a byte there. What it may be is for that to judge."""
    try:
        number = operator.index(value)
    except TypeError:
        number = -1
    if not 0 <= number <= 255:
        raise ValueError('%s: %s is needed, not %r' % (name, what, value))
    return number


def seconds(name, value):
    """The value itself, where it is a number; which one it may be is for others to judge."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise TypeError('%s: a number of seconds is needed, not %r' % (name, value))
    return value


def _text(name, value):
    if not isinstance(value, str):
        raise TypeError('%s: a text is needed, not %r' % (name, value))
    return value


def _node(value):
    if isinstance(value, bool) or not isinstance(value, (str, numbers.Integral)):
        raise TypeError("node: a node's name or id is needed, not %r" % (value,))
    return str(value)


def _id(value):
    return _byte('to', value, 'the id of a node, 0 to 254, or BROADCAST')


class HostPort:
    """A tool or CPU at a node: `with HostPort.connect(ring='robot', node='knee') as port:`. For one thread. Times are in
    seconds. Every wait has a deadline, lets other threads run, and ends by Ctrl-C, also where a virtual ring is paused;
    what has come meanwhile stays for the next call. A program in lockstep that goes on after that still has to wait for
    its turn, which the next call does first."""

    def __init__(self, port):
        self._port = port
        self._kept = []   # what next_of() has passed over, interrupts first

    @classmethod
    def connect(cls, ring='', node='', role='tool', timeout=2.0, alive_period=0.0, restarted_by_owner=False,
                results_may_wait=False, lockstep=True, runtime='', asks_only=False):
        """
        @param ring its name; '': LIMB_RING_RING, else the only ring running
        @param node id or name; '': LIMB_RING_NODE
        @param role 'tool', or 'cpu': the node's CPU, which gets packets and interrupts
        @param timeout how long to go on trying while the daemon is not there yet; one that is has 2 s at least to answer
        @param alive_period role cpu: promises to call something here at least so often; 0: no promise
        @param restarted_by_owner role cpu, not a child of ringd: somebody starts it again when a reset has killed it
        @param results_may_wait a Result may come 20 ms late, with the next packet: for who sends at a fixed rate and waits
            for none; it spares a wake-up per send
        @param lockstep role cpu, on a virtual ring: its time goes on only while this program waits in a call of this
        @param runtime folder in the place of XDG_RUNTIME_DIR
        @param asks_only it asks for something and goes: there is a place for it where `limits.clients` are taken
        @raise HostPortError what went wrong, and what would be right; HostPortTimeout where the daemon is not there"""
        return cls(_client.Port(_text('ring', ring), _node(node), _text('role', role), seconds('timeout', timeout),
                                seconds('alive_period', alive_period), restarted_by_owner, results_may_wait, lockstep,
                                _text('runtime', os.fspath(runtime)), asks_only))

    @property
    def id(self):
        """Of the node this port belongs to."""
        return self._port.id

    @property
    def name(self):
        """The node's."""
        return self._port.name

    @property
    def ring(self):
        """The ring's name."""
        return self._port.ring

    @property
    def connected(self):
        """False once Disconnected is to be received, or was, and after close()."""
        return self._port.connected

    def fileno(self):
        """For select and event loops; what is buffered already does not show: receive(0) until None first."""
        return self._port.fileno()

    def close(self):
        """Ends the connection, as the end of the program does. Sends that have not left the node by then are dropped:
        wait() for their results first."""
        self._port.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    # ---- the ring's clock -----------------------------------------------------------------

    @property
    def in_lockstep(self):
        """On a virtual ring, as connect() was told: its waits, next_of() and find() too, are of the ring's time."""
        return self._port.in_lockstep

    def now(self):
        """CLOCK_MONOTONIC; on a virtual ring the time since its start. s"""
        return self.now_ns() / 1e9

    def now_ns(self):
        """now() in ns"""
        return self._port.now_ns()

    def stamp_ns(self):
        """The same instant for stamps of payloads: since 1970; on a virtual ring since its start. ns"""
        return self._port.stamp_ns()

    def age_ns(self, stamp_ns):
        """How long ago a stamp was given; negative: how far ahead it is. What was stamped on this host keeps its age when
        the host's wall clock is set: compare ages, or now_ns() - age_ns(stamp), never stamps with stamp_ns(). ns"""
        return self._port.age_ns(stamp_ns)

    def sleep_until(self, time_s):
        """Returns at that time of now(), or when the connection has ended. Messages stay for receive()."""
        if not abs(seconds('time_s', time_s)) <= LATEST:   # nor is it one where it is NaN
            raise ValueError('time_s: a time of now() is needed, not %r' % time_s)
        self._port.sleep_until(round(time_s * 1e9))

    # ---- out: each returns the token of its Result ----------------------------------------

    def send(self, to, data, priority=2, channel=None):
        """
        @param to id of a node, or BROADCAST
        @param data 1 to 512 bytes; or a JointState, JointCommand, CommandSet or SensorReading, which has stamp_ns() where it was
                    given no stamp
        @param channel default: 2 for one of these, else 0"""
        typed = hasattr(data, 'encode') and not isinstance(data, str)
        if isinstance(data, (int, str)):   # bytes(5) would be five zeros
            raise TypeError('data: bytes are needed, not %r' % data)
        content = self._encoded(data) if typed else bytes(data)
        if channel is None:
            channel = JOINT_CHANNEL if typed else 0
        return self._port.send(_id(to), content, _byte('priority', priority, '0 (highest) to 3'),
                               _byte('channel', channel, '0 to 63'))

    def _encoded(self, data):
        return data.encode() if getattr(data, 'stamp_given', True) else data.encode(self.stamp_ns())

    def interrupt(self, to, factor, force=False):
        """Pulls pin `factor`, 0 to 7, of a node. A broadcast that would reset all needs `force`."""
        return self._port.interrupt(_id(to), _byte('factor', factor, '0 to 7'), force)

    def pull(self, number):
        """Pulls this node's interrupt input, 0 to 7."""
        return self._port.pull(_byte('number', number, '0 to 7'))

    def request(self, order):
        """Asks the daemon; the answer is a Reply with this token. @param order {'do': ...}, see requests.md"""
        return self._port.request(json.dumps(order))

    def request_text(self, text):
        """The same, in JSON."""
        return self._port.request(text)

    def observe(self, *kinds, packets=_NOT_SAID, promises=_NOT_SAID):
        """From now on these kinds of events come as Observed. `packets={...}`: packets on the lines as CapturedPacket;
        `packets=None`: none any more. What the daemon refuses in it comes as an Observed with 'error'."""
        for kind in kinds:
            if kind not in EVENT_KINDS:
                raise ValueError('observe: there is no kind of event %r; there are %s' % (kind, ', '.join(EVENT_KINDS)))
        order = {} if packets is not _NOT_SAID and not kinds else {'kinds': kinds}
        if packets is not _NOT_SAID:
            if packets is not None and not isinstance(packets, dict):
                raise TypeError("packets: a dict is needed, such as {'kinds': ['interrupt']}, or None, not %r" % (packets,))
            order['packets'] = packets
        if promises is not _NOT_SAID:
            if not isinstance(promises, bool):
                raise TypeError('promises: True or False is needed, not %r' % (promises,))
            order['promises'] = promises
        self._port.observe(json.dumps(order))

    def observe_text(self, text):
        """The same, in JSON; all that is wrong in it comes as an Observed with 'error'."""
        self._port.observe(text)

    def alive(self):
        """Says that the CPU is alive, as any call does that sends, receives or waits."""
        self._port.alive()

    def tell_stopped(self, stopped):
        """A CPU says that it is stopped, its joints in their safe state since an emergency stop, or no longer. The node
        shows it (`ringctl status`) and tells the others. The mode bit `stopped` of a JointState says the same."""
        self._port.tell_stopped(bool(stopped))

    # ---- in -------------------------------------------------------------------------------

    def receive(self, timeout):
        """The next message: Packet, Interrupt, Result, Reply, Observed, ObservedLost, CapturedPacket, CaptureCounts or
        Disconnected; None where none came, or after Disconnected. Interrupts come first."""
        seconds('timeout', timeout)
        if not self._kept:
            return self._port.receive(timeout, self._keep)
        if self.connected and not isinstance(self._kept[0], Interrupt):
            newer = self._port.receive(0, self._keep)   # it may be an interrupt
            if newer is not None:
                self._keep(newer)
        return self._kept.pop(0)

    def wait(self, token, timeout=30.0):
        """The Result of a token; other messages stay for receive(). @raise HostPortTimeout, HostPortError"""
        kept = self._take(lambda message: isinstance(message, Result) and message.token == token)
        return kept or self._port.wait(token, seconds('timeout', timeout), self._keep)

    def ask(self, order, timeout=30.0):
        """Asks the daemon and waits: a dict. @raise HostPortError with the daemon's words; HostPortTimeout"""
        return self.answer(self.request(order), timeout)

    def answer(self, token, timeout=30.0):
        """The answer to a request(): a dict. @raise as ask()"""
        kept = self._take(lambda message: isinstance(message, Reply) and message.token == token)
        answer = kept.content if kept else json.loads(self._port.reply(token, seconds('timeout', timeout), self._keep))
        if 'error' in answer:
            raise HostPortError(answer['error'])
        return answer

    def next_of(self, kind, timeout=30.0):
        """The next message of a class; others stay for receive(). @raise HostPortTimeout; HostPortError at the end, or
        where 65536 messages have stayed"""
        return self.find(lambda message: isinstance(message, kind), timeout, 'no %s came' % kind.__name__)

    def find(self, wanted, timeout=30.0, missing='it did not come'):
        """The next message for which wanted(message); others stay for receive(). @raise as next_of()"""
        if not seconds('timeout', timeout) >= 0:   # nor is it a number where it is NaN, which would never be over
            raise ValueError('timeout: 0 s or more is needed, not %r' % timeout)
        kept = self._take(wanted)
        clock = self.now if self._port.in_lockstep else time.monotonic   # that of receive()
        deadline = clock() + timeout
        while kept is None:
            self._refuse_more()
            message = self._port.receive(max(0.0, deadline - clock()), self._keep)
            if message is not None:
                self._keep(message)   # first of all: wanted() may raise
                if wanted(message):
                    self._kept.remove(message)
                    return message
            if isinstance(message, Disconnected) or message is None and not self.connected:
                raise HostPortError('%s; the connection has ended' % missing)
            if message is None and clock() >= deadline:
                raise HostPortTimeout('%s within %g s' % (missing, timeout))
        return kept

    def received(self, kind):
        """All messages of a class that are here by now; others stay for receive(). @raise HostPortError as next_of()"""
        while len(self._kept) < MOST_KEPT:
            message = self._port.receive(0, self._keep)
            if message is None:
                break
            self._keep(message)
        found = [message for message in self._kept if isinstance(message, kind)]
        if not found:
            self._refuse_more()
        self._kept = [message for message in self._kept if not isinstance(message, kind)]
        return found

    def _keep(self, message):
        place = len(self._kept)
        if isinstance(message, Interrupt):
            place = next((index for index, kept in enumerate(self._kept) if not isinstance(kept, Interrupt)), place)
        self._kept.insert(place, message)

    def _refuse_more(self):
        if len(self._kept) >= MOST_KEPT:
            raise HostPortError('%d messages were left without receive()' % len(self._kept))

    def _take(self, wanted):
        for index, message in enumerate(self._kept):
            if wanted(message):
                return self._kept.pop(index)
        return None
