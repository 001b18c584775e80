#!/usr/bin/python3
"""echo_cpu.cpp in Python: echo_cpu.py [RING NODE]; what roslaunch adds behind them plays no part"""
import sys

import limb_ring


def main():
    if len(sys.argv) == 2:
        print('usage: echo_cpu.py [RING NODE]', file=sys.stderr)
        sys.exit(2)
    ring, node = sys.argv[1:3] or ('', '')
    with limb_ring.HostPort.connect(ring=ring, node=node, role='cpu', alive_period=0.5) as port:
        print('CPU of node %d (%s) of ring %s' % (port.id, port.name, port.ring), flush=True)
        while port.connected:
            message = port.receive(0.1)
            if isinstance(message, limb_ring.Packet):
                print('%d bytes from node %d' % (len(message.data), message.source), flush=True)
                port.send(message.source, message.data, message.priority, message.channel)
            elif isinstance(message, limb_ring.Result):
                print('sent back: ' + message.outcome, flush=True)
            elif isinstance(message, limb_ring.Interrupt):
                print('INT%d from node %d' % (message.factor, message.source), flush=True)
            elif isinstance(message, limb_ring.Disconnected):
                print('the ring is gone: ' + message.reason, flush=True)


if __name__ == '__main__':
    try:
        main()
    except limb_ring.HostPortError as problem:
        sys.exit('echo_cpu: %s' % problem)
