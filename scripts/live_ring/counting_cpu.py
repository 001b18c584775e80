#!/usr/bin/python3
"""The CPU of a node that ringd starts, resets and may see crash: notes every packet in a file.

Usage: counting_cpu.py FOLDER   (ring and node from the environment, as ringd sets them)
"""
import os
import struct
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
from live_ring import built, payload  # noqa: E402,F401
from limb_ring import Disconnected, HostPort, HostPortError, Packet  # noqa: E402

SPEAKS_EVERY = 0.1   # s
NOTE = struct.Struct('>BIBB')   # source, number, destination, priority
DAMAGED = NOTE.pack(0, 0, 0, 0xFF)


def path_of(folder, node):
    return os.path.join(folder, 'cpu_%s.packets' % node)


def note_of(packet):
    known = payload.read(packet.data)
    return NOTE.pack(*known, packet.destination, packet.priority) if known else DAMAGED


def main():
    port = HostPort.connect(role='cpu')
    notes = os.open(path_of(sys.argv[1], os.environ['LIMB_RING_NODE']), os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o600)
    while True:
        message = port.receive(SPEAKS_EVERY)
        port.alive()
        if isinstance(message, Packet):
            os.write(notes, note_of(message))
        elif isinstance(message, Disconnected):
            raise HostPortError(message.reason)


if __name__ == '__main__':
    try:
        main()
    except (OSError, HostPortError) as problem:   # the daemon has gone
        sys.exit('counting_cpu: %s' % problem)
