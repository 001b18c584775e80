"""Bytes of the host port, for tests of what the client library never sends: malformed, half and foreign messages. What
a connection does otherwise is for limb_ring.HostPort."""
import os
import struct

GREETING, SEND, REQUEST = 1, 2, 5
MAGIC, VERSION = 0x4C524850, 3


def frame(kind, body=b''):
    return struct.pack('>IB', len(body) + 1, kind) + body


def greeting(ring, version=VERSION):
    """Of a tool."""
    name = ring.encode()
    return frame(GREETING, struct.pack('>IHBBIIH', MAGIC, version, 0, 0, os.getpid(), 0, len(name)) + name)
