#!/usr/bin/env python3
"""The node in Python as a program, for the conformance kit. Its CPU sends each packet of channel 0 back.

usage: foreign_program.py NAME NODE PORT IDS AGREEMENT"""

import os
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import foreign_node
from foreign_links import Line


def main(name, node, port, ids, agreement):
    node, port, order = int(node), int(port), [int(each) for each in ids.split(',')]
    successor = order[(order.index(node) + 1) % len(order)]
    foreign_node.TRY_TIMEOUT = 0.1  # s, as in a ring with default times
    made = foreign_node.Node(Line(name, node, order, ('127.0.0.1', port + node), ('127.0.0.1', port + successor), bytes.fromhex(agreement)))
    made.start()
    sent_back = 0
    while made.is_alive():
        time.sleep(0.001)
        with made.lock:
            for source, priority, channel, data in made.received[sent_back:]:
                if channel == 0:
                    made.send(source, data, priority)
            sent_back = len(made.received)


if __name__ == '__main__':
    main(*sys.argv[1:])
