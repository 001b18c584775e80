"""Where the node under test is: a process or an address over UDP, a process over UNIX lines, or a library on a virtual
clock. To the cases all are alike: datagrams of a UDP line go out and come in at a place, which is ('asks', id), the sending
end of that node's line, or ('listens', id), its receiving end. (protocol.md section 6)"""

import ctypes
import fcntl
import mmap
import os
import select
import shutil
import signal
import socket
import subprocess
import tempfile
import time

from . import wire

GRACE = 2.0  # s, for a program that is asked to end


class BenchError(Exception):
    """The node cannot be reached or started."""


class Process:
    """The program under test. `words`: its command line, with {placeholders}."""

    def __init__(self, words, values, folder):
        self.words, self.values, self.folder, self.process = words, values, folder, None
        self.log = os.path.join(folder, 'node.log')

    def start(self):
        words = [word.format(**self.values) if '{' in word else word for word in self.words]
        environment = dict(os.environ, XDG_RUNTIME_DIR=self.folder)
        with open(self.log, 'ab') as log:
            try:
                self.process = subprocess.Popen(words, stdout=log, stderr=log, stdin=subprocess.DEVNULL, env=environment,
                                                start_new_session=True)
            except OSError as problem:
                raise BenchError('%s: %s' % (words[0], problem.strerror)) from problem

    def ended(self):
        return self.process is not None and self.process.poll() is not None

    def last_words(self):
        with open(self.log, encoding='utf-8', errors='replace') as log:
            return log.read()[-1000:]

    def stop(self):
        if self.process is None:
            return
        try:
            os.killpg(self.process.pid, signal.SIGTERM)
            self.process.wait(GRACE)
        except (ProcessLookupError, subprocess.TimeoutExpired):
            pass
        try:
            os.killpg(self.process.pid, signal.SIGKILL)  # also what it has started
        except (ProcessLookupError, PermissionError):
            pass
        self.process.wait()
        self.process = None


class RealBench:
    """On the clock of this machine."""

    process = None

    def now(self):
        return time.monotonic()

    def can_start(self):
        return self.process is not None

    def start(self):
        self.poll(0)  # what the last one said at its end
        if self.process:
            self.process.start()

    def stop(self):
        if self.process:
            self.process.stop()

    def problem(self):
        if self.process and self.process.ended():
            return 'the program has ended, with %d: %s' % (self.process.process.returncode, self.process.last_words())
        return None


class UdpBench(RealBench):
    line = 'udp'

    def __init__(self, others, own, host, port, process=None):
        self.process, self.own, self.address = process, own, (host, port + own)
        self.sockets, self.heard = {}, {}
        for node in others:
            for place in (('asks', node), ('listens', node)):
                made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
                made.setblocking(False)
                if place[0] == 'listens':
                    try:
                        made.bind((host if host.startswith('127.') else '', port + node))
                    except OSError as problem:
                        raise BenchError('UDP port %d: %s; another one by --port' % (port + node, problem.strerror)) from problem
                self.sockets[made] = place
        self.of_place = {place: made for made, place in self.sockets.items()}

    def send(self, place, datagram):
        to = self.address if place[0] == 'asks' else self.heard.get(place)
        if to is not None:
            try:
                self.of_place[place].sendto(datagram, to)
            except OSError:
                pass  # nobody is there yet

    def poll(self, wait):
        """@return [(place, datagram)]; waits at most so many seconds for the first"""
        came = []
        for made in select.select(list(self.sockets), [], [], wait)[0]:
            try:
                while True:
                    datagram, address = made.recvfrom(2048)
                    self.heard[self.sockets[made]] = address
                    came.append((self.sockets[made], datagram))
            except OSError:
                pass  # read empty
        return came

    def close(self):
        self.stop()
        for made in self.sockets:
            made.close()


class Queue:
    """Slices through memory that both ends have mapped. (protocol.md section 6.12)"""

    HEAD, CAPACITY = 128, 4096
    WRITTEN, READ = 0, 8                                    # places of 8 bytes
    WAITS, BEAT_OF_SENDER, SLEEPS, BEAT_OF_RECEIVER = 2, 3, 18, 19  # places of 4 bytes

    def __init__(self, descriptors=None):
        if descriptors is None:
            self.memory = os.memfd_create('conform', os.MFD_ALLOW_SEALING)
            os.ftruncate(self.memory, self.HEAD + self.CAPACITY)
            fcntl.fcntl(self.memory, fcntl.F_ADD_SEALS, fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW)
            self.woken, self.wakes = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
        else:
            self.memory, given = descriptors
            # Anew: of what was handed over the other end could make us wait.
            self.woken, self.wakes = os.open('/proc/self/fd/%d' % given, os.O_RDONLY | os.O_NONBLOCK), None
            os.close(given)
        self.map = mmap.mmap(self.memory, os.fstat(self.memory).st_size)
        self.capacity = len(self.map) - self.HEAD
        self.words, self.halves = memoryview(self.map).cast('Q'), memoryview(self.map).cast('I')
        self.count, self.beat = 0, self.halves[self.BEAT_OF_SENDER]

    def write(self, data):
        for byte in data:
            self.map[self.HEAD + self.count % self.capacity] = byte
            self.count += 1
        self.words[self.WRITTEN] = self.count
        if self.halves[self.SLEEPS]:
            self.halves[self.SLEEPS] = 0
            try:
                os.write(self.wakes, b'\0')
            except OSError:
                pass  # it is full, or nobody reads

    def read(self):
        try:
            os.read(self.woken, 4096)
        except OSError:
            pass  # nobody has woken us
        written, out = self.words[self.WRITTEN], bytearray()
        while self.count < written:
            out.append(self.map[self.HEAD + self.count % self.capacity])
            self.count += 1
        self.words[self.READ] = self.count
        self.halves[self.SLEEPS] = 1
        return bytes(out)

    def room_is_waited_for(self):
        waits, self.halves[self.WAITS] = self.halves[self.WAITS], 0
        return bool(waits)

    def tick(self, place):
        self.halves[place] = (self.halves[place] + 1) % 2 ** 32

    def lives(self, place):
        """Whether the other end's beat has gone on since the last call."""
        before, self.beat = self.beat, self.halves[place]
        return before != self.beat

    def close(self):
        self.words.release()
        self.halves.release()
        self.map.close()
        os.close(self.memory)
        os.close(self.woken)
        if self.wakes is not None:
            os.close(self.wakes)


class Stream:
    """A connection of a UNIX line, put into the words of a UDP line: sessions and sequences are made up here."""

    def __init__(self, connection, session=None):
        self.connection, self.buffer, self.session, self.sequence = connection, b'', session, 0
        self.accepted = False
        self.queue, self.writes = None, False  # of a line through shared memory; whether we write into it
        connection.setblocking(False)

    def close(self):
        self.connection.close()
        if self.queue:
            self.queue.close()

    def header(self, kind, sequence=0):
        return wire.HEADER.pack(wire.MAGIC, wire.VERSION, kind, 0, self.session or 0, sequence, 0, 0)

    def framed(self, data):
        self.sequence += 1
        return self.header(wire.SLICES, self.sequence) + data

    def read_queue(self, came):
        if self.writes:
            if self.queue.lives(Queue.BEAT_OF_RECEIVER):
                came.append(self.header(wire.ALIVE))
            return
        data = self.queue.read()
        while len(data) >= 4:
            size = 4 + int.from_bytes(data[2:4], 'big')
            came.append(self.framed(data[:size]))
            data = data[size:]
        if self.queue.lives(Queue.BEAT_OF_SENDER):
            came.append(self.framed(wire.slice_of(wire.IDLE)))
        if self.queue.room_is_waited_for():
            self.connection.sendall(self.header(wire.ALIVE))

    def write_queue(self, datagram):
        """Signs of life are beats."""
        if datagram[3] == wire.ALIVE:
            self.queue.tick(Queue.BEAT_OF_RECEIVER)
        elif datagram[wire.HEADER.size:] == wire.slice_of(wire.IDLE):
            self.queue.tick(Queue.BEAT_OF_SENDER)
        else:
            self.queue.write(datagram[wire.HEADER.size:])

    def receive(self):
        data, descriptors, _, _ = socket.recv_fds(self.connection, 65536, 2)
        if len(descriptors) == 2:
            self.queue = Queue(descriptors)
        return data

    def read(self):
        """@return what came, as datagrams, and whether it is over"""
        over, came = False, []
        try:
            while True:
                data = self.receive()
                if not data:
                    over = True
                    break
                self.buffer += data
        except BlockingIOError:
            pass
        except OSError:
            over = True
        while self.take_one(came):
            pass
        return came, over

    def take_one(self, came):
        if self.accepted:
            size = 4 + int.from_bytes(self.buffer[2:4], 'big')
        else:
            connects = len(self.buffer) > 3 and self.buffer[3] in (wire.CONNECT, wire.CONNECT_MEMORY)
            size = wire.HEADER.size + (wire.AGREEMENT_SIZE if connects else 0)
        if len(self.buffer) < max(size, 4):
            return False
        one, self.buffer = self.buffer[:size], self.buffer[size:]
        came.append(self.framed(one) if self.accepted else one)
        return True


class UnixBench(RealBench):
    line = 'unix'

    def __init__(self, others, own, folder, process, memory=False):
        """@param memory: the slices go through shared memory"""
        self.process, self.own, self.folder, self.memory = process, own, folder, memory
        os.makedirs(os.path.dirname(folder), 0o700, exist_ok=True)
        os.makedirs(folder, 0o700, exist_ok=True)
        self.doors, self.streams = {}, {}
        for node in others:
            door = socket.socket(socket.AF_UNIX)
            door.bind(os.path.join(folder, '%d.link' % node))
            os.chmod(os.path.join(folder, '%d.link' % node), 0o600)
            door.listen(8)
            door.setblocking(False)
            self.doors[door] = ('listens', node)

    def send(self, place, datagram):
        kind = datagram[3]
        stream = self.streams.get(place)
        if kind == wire.CONNECT and place[0] == 'asks':
            stream = self.connect(place)
        if stream is None:
            return
        session = wire.HEADER.unpack_from(datagram)[4] if len(datagram) >= wire.HEADER.size else 0
        if kind == wire.ACCEPT:
            stream.accepted, stream.session = True, session
        if stream.queue and kind in (wire.SLICES, wire.ALIVE):
            return stream.write_queue(datagram)
        if kind == wire.SLICES:
            datagram = datagram[wire.HEADER.size:]
        try:
            if kind == wire.CONNECT and stream.queue:
                datagram = datagram[:3] + bytes([wire.CONNECT_MEMORY]) + datagram[4:]
                socket.send_fds(stream.connection, [datagram], [stream.queue.memory, stream.queue.woken])
            else:
                stream.connection.sendall(datagram if kind != wire.BYE else b'')
        except OSError:
            pass  # the other end has closed, which reading will show
        if kind in (wire.BYE, wire.REFUSE):
            self.drop(place)

    def connect(self, place):
        self.drop(place)
        connection = socket.socket(socket.AF_UNIX)
        try:
            connection.connect(os.path.join(self.folder, '%d.link' % self.own))
        except OSError:
            connection.close()
            return None
        self.streams[place] = Stream(connection)
        if self.memory:
            self.streams[place].queue, self.streams[place].writes = Queue(), True
        return self.streams[place]

    def drop(self, place):
        if place in self.streams:
            self.streams.pop(place).close()

    def poll(self, wait):
        connections = {stream.connection: place for place, stream in self.streams.items()}
        events = [stream.queue.woken for stream in self.streams.values() if stream.queue and not stream.writes]
        came = []
        for ready in select.select(list(self.doors) + list(connections) + events, [], [], wait)[0]:
            if ready in events:
                continue
            if ready in self.doors:
                place = self.doors[ready]
                self.drop(place)
                self.streams[place] = Stream(ready.accept()[0])
                continue
            place = connections[ready]
            if place not in self.streams:
                continue
            stream = self.streams[place]
            datagrams, over = stream.read()
            came += [(place, one) for one in datagrams]
            if over and self.streams.get(place) is stream:
                self.drop(place)
                came.append((place, b''))  # the end of the connection
        for place, stream in self.streams.items():
            if stream.queue and (stream.accepted or stream.writes):
                heard = []
                stream.read_queue(heard)
                came += [(place, one) for one in heard]
        return came

    def close(self):
        self.stop()
        for place in list(self.streams):
            self.drop(place)
        for door, place in self.doors.items():
            door.close()
            os.unlink(os.path.join(self.folder, '%d.link' % place[1]))


class LibraryBench:
    """A shared library with the three functions of tiny_node/examples/library_node.c, on a clock that waits for nobody."""

    line = 'udp'
    STRANGERS = 256
    TURN = 0.001
    MOST_POLLS = 100  # in one instant: also what answers at once for ever lets time pass

    def __init__(self, path, config):
        self.path, self.config, self.time, self.came, self.polls = path, config, 1000.0, [], 0
        self.folder = tempfile.mkdtemp(prefix='conform_')
        self.starts, self.library = 0, None
        self.kept = ctypes.CFUNCTYPE(None, ctypes.c_uint32, ctypes.POINTER(ctypes.c_uint8), ctypes.c_size_t)(self.sent)

    def now(self):
        self.time += 1e-9  # no two instants are one
        return self.time

    def can_start(self):
        return True

    def problem(self):
        return None

    def sent(self, to, data, size):
        place = ('asks', to - self.STRANGERS) if to >= self.STRANGERS else ('listens', to)
        self.came.append((place, ctypes.string_at(data, size)))

    def start(self):
        """Each start has memory of its own, as a process has."""
        self.starts += 1
        copy = os.path.join(self.folder, 'node%d.so' % self.starts)
        shutil.copy(self.path, copy)
        self.library = ctypes.CDLL(copy)
        os.unlink(copy)
        self.library.library_node_begin(self.config.ring.encode(), self.config.own, bytes(self.config.order),
                                        len(self.config.order), self.config.agreement,
                                        ctypes.c_uint64(0x1880000000000000 + self.starts * 0x10001), self.milliseconds(), self.kept)

    def milliseconds(self):
        return ctypes.c_uint32(int(self.time * 1000) & 0xFFFFFFFF)

    def stop(self):
        self.library, self.came = None, []

    def send(self, place, datagram):
        if self.library is not None and (place[0] == 'asks' or place[1] != self.config.own):
            source = place[1] + (self.STRANGERS if place[0] == 'asks' else 0)
            self.library.library_node_came(self.milliseconds(), source, datagram, ctypes.c_size_t(len(datagram)))

    def poll(self, wait):
        self.polls = self.polls + 1 if self.came else 0
        if not self.came or self.polls > self.MOST_POLLS:
            self.polls = 0
            self.time += min(wait, self.TURN)
            if self.library is not None:
                self.library.library_node_passed(self.milliseconds())
        came, self.came = self.came, []
        return came

    def close(self):
        self.stop()
        shutil.rmtree(self.folder, ignore_errors=True)
