#!/usr/bin/env python3
"""docs/test_vectors.json against the node that was written from docs/protocol.md alone."""

import json
import os
import sys
import unittest
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)

from foreign_links import AGREEMENT, CONNECT, END, INTERRUPT, LINK_HEADER, SLICES, START, WHOLE, LinkHeader, Line, text_hash
from foreign_node import Node, change, with_hop_and_fbc

WORD = 4


class NoEnd:
    """An end of a line that leads nowhere; it keeps what the node writes."""

    def __init__(self, *_):
        self.written = []

    def write(self, framed):
        self.written.append(framed)

    def up(self):
        return True


class LineForTests(Line):
    def __init__(self, node, order):
        self.ring, self.id, self.order, self.agreement = 0, node, order, b''
        self.sender, self.successor = order[order.index(node) - 1], order[(order.index(node) + 1) % len(order)]
        self.on_slice, self.gap = lambda kind, data: None, lambda: None
        self.input, self.output = NoEnd(), NoEnd()


class TestVectors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open(os.path.join(HERE, '..', '..', 'docs', 'test_vectors.json'), encoding='utf-8') as file:
            cls.all = json.load(file)

    def test_hashes(self):
        for one in self.all['text_hashes']:
            self.assertEqual(text_hash(one['text']), int(one['fnv1a_64'], 16), one)
        for one in self.all['agreement']:
            hashes = [text_hash(text) for text in one['texts']]
            self.assertEqual(hashes, [int(each, 16) for each in one['hashes']])
            self.assertEqual(AGREEMENT.pack(*hashes).hex().upper(), one['behind_connect'])

    def test_crc(self):
        for one in self.all['crc']:
            self.assertEqual(zlib.crc32(bytes.fromhex(one['bytes'])), int(one['crc'], 16))
        for one in self.all['change']:
            self.assertEqual(change(int(one['delta'], 16), one['after']), int(one['change'], 16))
        good = [zlib.crc32(packet[:-4]) == int.from_bytes(packet[-4:], 'big') for packet in self.packets()]
        self.assertEqual(good, ['damaged' not in one['name'] for one in self.all['packets']])

    def packets(self):
        return [bytes.fromhex(one['packet']) for one in self.all['packets']]

    def test_slices_hold_the_packets(self):
        known = set(self.packets())
        for one in self.all['slices']:
            line, datp = bytes.fromhex(one['line']), b''
            while line:
                kind, size = line[1], int.from_bytes(line[2:4], 'big')
                content, line = line[4:4 + size], line[4 + size:]
                if kind in (WHOLE, INTERRUPT):
                    self.assertIn(content, known)
                datp = content if kind == START else datp + content if kind == END else datp
                if kind == END:
                    self.assertIn(datp, known)

    def test_sessions_of_the_join(self):
        sent = {}
        for one in self.all['join']['datagrams']:
            datagram = bytes.fromhex(one['datagram'])
            header = LinkHeader._make(LINK_HEADER.unpack_from(datagram))
            self.assertEqual(header.sender, one['from'])
            if header.type == CONNECT:
                self.assertEqual(len(datagram), LINK_HEADER.size + AGREEMENT.size)
            if header.type == SLICES:
                sent[one['from']] = sent.get(one['from'], 0) + 1
                self.assertEqual(header.sequence, sent[one['from']])
        self.assertGreater(min(sent.values()), 5)

    def test_exactly_once(self):
        vectors = self.all['exactly_once']
        for table in vectors['tables']:
            line = LineForTests(vectors['node'], [node['id'] for node in vectors['ring_file']['nodes']])
            node = Node(line)
            node.joined = table['joined']
            for step in table['steps']:
                if self.beyond_this_node(step, table):
                    continue
                self.check(node, line.output.written, step)

    @staticmethod
    def beyond_this_node(step, table):
        """It has no clock in its pages, and knows neither the retries of those who do not know of its start, nor which
        pins are wired."""
        return (step['at_ms'] >= 100 or 'wired' in step['why'] or 'the same verdict' in step['why'] and step['fbc'] == 0 or
                not table['joined'] and step['fbc'] == 255)

    def check(self, node, written, step):
        before, pins = len(node.received), len(node.pins)
        packet = bytes.fromhex(step['gets'])
        node.take(packet, len(packet) == 12)
        wanted = with_hop_and_fbc(packet, packet[2] + 1, step['fbc'])
        self.assertEqual(written[-1][WORD:].hex(), wanted.hex(), step['why'])
        self.assertEqual(len(node.received) - before, step['does'] == 'takes', step['why'])
        self.assertEqual(len(node.pins) - pins, step['does'] == 'pulls', step['why'])


if __name__ == '__main__':
    unittest.main()
