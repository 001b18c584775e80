"""A host port in an event loop: nothing here waits, but for the greeting."""
import struct

from live_ring import host_port
from live_ring.host_port import HostPort

GREETING_TIMEOUT = 5.0   # s
CREDIT = 64              # packets that the daemon may be ahead of us


class Port(HostPort):
    """Messages go to `handler(port, kind, value)`, the end of the connection to `ended(port)`."""

    @classmethod
    def open(cls, loop, path, ring, handler, ended, role=host_port.TOOL):
        """None where no daemon listens."""
        try:
            port = cls.connect(path, ring, role=role, credit=CREDIT, timeout=GREETING_TIMEOUT)
        except (OSError, TimeoutError):
            return None
        port.loop, port.handler, port.ended = loop, handler, ended
        loop.add(port.connection, port.read)
        port.take_frames()
        return port

    def read(self):
        try:
            data = self.connection.recv(1 << 16)
        except OSError:
            data = b''
        self.buffer += data
        self.take_frames()
        if not data:
            self.close()
            self.ended(self)

    def take_frames(self):
        while len(self.buffer) >= 4:
            end = 4 + struct.unpack_from('>I', self.buffer)[0]
            if len(self.buffer) < end:
                return
            kind, body = self.buffer[4], self.buffer[5:end]
            self.buffer = self.buffer[end:]
            if kind == host_port.PACKET:
                self._tell(self.give_credit, 1)
            self.handler(self, kind, host_port.decode(kind, body))

    def order(self, say, *arguments):
        """A send, interrupt or request: its token; None where the daemon has gone, which read() will see too."""
        return self._tell(say, *arguments)

    @staticmethod
    def _tell(say, *arguments):
        try:
            return say(*arguments)
        except OSError:
            return None

    def close(self):
        self.loop.remove(self.connection)
        super().close()
