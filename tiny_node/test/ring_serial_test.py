#!/usr/bin/env python3
"""ring_serial between a pseudo-terminal and UDP: also if bytes of the serial line are lost, doubled or wrong."""

import os
import pty
import random
import select
import signal
import socket
import struct
import subprocess
import sys
import tty
import unittest
import zlib

PROGRAM = os.path.join(os.environ['RING_TEST_PROGRAMS'], 'ring_serial')
NODE, OTHER, BOOT = 1, 2, 0xFFFF
WAIT = 20.0   # s; reached only if something is wrong
QUIET = 0.3   # s, for what must not come


def cobs(data):
    out, run = b'', b''
    for byte in data + b'\0':
        if byte:
            run += bytes([byte])
        if not byte or len(run) == 254:
            out, run = out + bytes([len(run) + 1]) + run, b''
    return out


def uncobs(frame):
    out = b''
    while frame:
        code, frame = frame[0], frame[1:]
        out, frame = out + frame[:code - 1], frame[code - 1:]
        if code != 255 and frame:
            out += b'\0'
    return out


def framed(place, datagram):
    covered = struct.pack('>H', place) + datagram
    return cobs(covered + struct.pack('>I', zlib.crc32(covered))) + b'\0'


class Serial(unittest.TestCase):
    def setUp(self):
        self.board, device = pty.openpty()
        tty.setraw(self.board)
        self.peer, self.stranger = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
        self.port = self.free_port()
        self.peer.bind(('127.0.0.1', self.port + OTHER))
        self.process = subprocess.Popen([PROGRAM, os.ttyname(device), str(NODE), str(self.port)], stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end)
        self.device, self.buffer = device, b''
        self.until_it_runs()

    @staticmethod
    def free_port():
        for _ in range(100):
            port = random.randrange(33000, 60000)
            try:
                with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as two:
                    one.bind(('127.0.0.1', port + NODE))
                    two.bind(('127.0.0.1', port + OTHER))
                return port
            except OSError:
                continue
        raise AssertionError('no free ports')

    def until_it_runs(self):
        """It answers for the boot number; what came before it has opened the device is lost."""
        for _ in range(int(WAIT / QUIET)):
            self.write(framed(BOOT, b''))
            if self.frame(QUIET):
                break
        else:
            self.fail('no answer')
        while self.frame(QUIET):
            pass

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        self.counts = self.process.communicate()[1]
        for one in (self.peer, self.stranger):
            one.close()
        os.close(self.board)
        os.close(self.device)

    def write(self, data):
        while data:
            data = data[os.write(self.board, data):]

    def frame(self, wait=WAIT):
        """The next frame that the board gets, as place and datagram."""
        while b'\0' not in self.buffer:
            if not select.select([self.board], [], [], wait)[0]:
                return None
            self.buffer += os.read(self.board, 65536)
        one, self.buffer = self.buffer.split(b'\0', 1)
        data = uncobs(one)
        self.assertEqual(struct.pack('>I', zlib.crc32(data[:-4])), data[-4:])
        return struct.unpack('>H', data[:2])[0], data[2:-4]

    def datagram(self, which, wait=WAIT):
        return which.recv(2048) if select.select([which], [], [], wait)[0] else None

    def test_datagrams_go_both_ways(self):
        for size in (0, 1, 26, 30, 253, 254, 255, 508, 554):
            for data in (bytes(size), bytes(i % 255 + 1 for i in range(size)), os.urandom(size)):
                self.write(framed(OTHER, data))
                self.assertEqual(self.datagram(self.peer), data)
                self.stranger.sendto(data, ('127.0.0.1', self.port + NODE))
                place, came = self.frame()
                self.assertEqual(came, data)
                self.write(framed(place, b'back'))
                self.assertEqual(self.datagram(self.stranger), b'back')

    def test_what_is_for_nobody_goes_nowhere(self):
        self.write(framed(3000, b'lost') + framed(OTHER, b'next'))
        self.assertEqual(self.datagram(self.peer), b'next')

    def test_a_boot_number_is_given_and_each_is_another(self):
        numbers = set()
        for _ in range(5):
            self.write(framed(BOOT, b''))
            place, number = self.frame()
            self.assertEqual((place, len(number)), (BOOT, 8))
            numbers.add(number)
        self.assertEqual(len(numbers), 5)

    def test_after_noise_the_next_frame_is_found(self):
        seed = random.randrange(10 ** 6)
        draw = random.Random(seed)
        for count in range(300):
            good, bad = b'good %d' % count, bytearray(framed(OTHER, draw.randbytes(draw.randrange(1, 400))))
            for _ in range(draw.randrange(1, 4)):
                at = draw.randrange(len(bad))
                kind = draw.randrange(3)
                if kind == 0:
                    del bad[at]
                elif kind == 1:
                    bad.insert(at, bad[at])
                else:
                    bad[at] ^= 1 << draw.randrange(8)
                if not bad:
                    break
            # Two zeros: the first may be that of the damaged frame.
            self.write(bytes(bad) + b'\0' + framed(OTHER, good))
            came = self.datagram(self.peer)
            while came is not None and came != good:
                self.assertFalse(came.startswith(b'good'), 'seed %d' % seed)
                came = self.datagram(self.peer)
            self.assertEqual(came, good, 'seed %d' % seed)

    def test_what_was_lost_is_counted(self):
        self.write(b'noise\0' + framed(OTHER, b'good'))
        self.assertEqual(self.datagram(self.peer), b'good')
        self.process.send_signal(signal.SIGUSR1)
        line = self.process.stderr.readline()
        self.assertIn('damaged frames 1,', line)

    def test_wrong_usage_is_reported(self):
        for arguments, words in (([], '3 or 4 arguments'), (['/dev/null', '1', '17000', '17'], 'BAUD is 9600'),
                                 (['/no/such', '1', '17000'], '/no/such: No such file')):
            run = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False)
            self.assertIn(words, run.stderr)
            self.assertNotEqual(run.returncode, 0)


if __name__ == '__main__':
    unittest.main(verbosity=2, argv=sys.argv)
