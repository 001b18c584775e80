"""A host port in an event loop: nothing here waits, but for the greeting."""
from live_ring import built  # noqa: F401
from limb_ring import Disconnected, HostPort, HostPortError


class Port:
    """Messages go to `handler(message)`, the end of the connection to `ended()`."""

    def __init__(self, host, loop, handler, ended):
        self.host, self.loop, self.handler, self.ended = host, loop, handler, ended
        self.descriptor = host.fileno()
        loop.add(self.descriptor, self.read)

    @classmethod
    def open(cls, ring, node, loop, handler, ended, role='tool'):
        """None where no daemon listens."""
        try:
            host = HostPort.connect(ring=ring.name, node=node, runtime=ring.runtime, role=role, timeout=0)
        except HostPortError:
            return None
        return cls(host, loop, handler, ended)

    def read(self):
        message = self.host.receive(0)
        while message is not None:
            if isinstance(message, Disconnected):
                return self.end()
            self.handler(message)
            message = self.host.receive(0)

    def end(self):
        self.loop.remove(self.descriptor)
        self.host.close()
        self.ended()
