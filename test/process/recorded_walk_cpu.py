#!/usr/bin/python3
"""The CPU of a body that walks as a humanoid did: sends each row of a recording, as joint commands, at its own time.

Usage: recorded_walk_cpu.py WALKING.CSV RING.YAML   (ring and node from the environment, as ringd sets them)
"""
import csv
import os
import sys

import yaml

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'scripts'))
from live_ring import built  # noqa: E402,F401
from limb_ring import HostPort, HostPortError, JointCommand  # noqa: E402

VALID = 0.2    # s
BEGINS = 0.5   # s after the start


def limbs_of(path):
    """Names of the joints of each node that has some."""
    with open(path) as file:
        nodes = yaml.safe_load(file)['nodes']
    return {node['id']: [joint['name'] for joint in node['joints']] for node in nodes if node.get('joints')}


def command(row, joints, sequence, stamp_ns):
    targets = [JointCommand.Joint(position=float(row['pos.' + name]), velocity=float(row['vel.' + name])) for name in joints]
    return JointCommand(targets, sequence=sequence & 0xFFFF, stamp_ns=stamp_ns, valid_for=VALID)


def main():
    recording, config = sys.argv[1:]
    limbs = limbs_of(config)
    with open(recording) as file, HostPort.connect(role='cpu') as port:
        for sequence, row in enumerate(csv.DictReader(file)):
            port.sleep_until(BEGINS + float(row['t_s']))
            while port.receive(0) is not None:
                pass
            for node, joints in limbs.items():
                port.send(node, command(row, joints, sequence, port.stamp_ns()), priority=0)
        while port.connected:
            port.receive(1.0)


if __name__ == '__main__':
    try:
        main()
    except HostPortError as problem:   # the ring has gone
        sys.exit('recorded_walk_cpu: %s' % problem)
