"""Packets that can be checked: source, number, random bytes, and a checksum of their own."""
import struct
import zlib

HEAD = struct.Struct('>BI')
CHECK = struct.Struct('>I')
SMALLEST, LARGEST = HEAD.size + CHECK.size, 512


def make(source, number, chance):
    filler = chance.randrange(LARGEST - SMALLEST + 1)
    body = HEAD.pack(source, number) + chance.getrandbits(8 * filler + 1).to_bytes(filler + 1, 'big')[1:]
    return body + CHECK.pack(zlib.crc32(body))


def read(data):
    """(source, number), or None: damaged."""
    if len(data) < SMALLEST or CHECK.unpack(data[-CHECK.size:])[0] != zlib.crc32(data[:-CHECK.size]):
        return None
    return HEAD.unpack_from(data)
