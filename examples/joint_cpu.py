#!/usr/bin/python3
"""joint_cpu.cpp in Python: the firmware of a node whose joints go where they are told, at 2 rad/s.
joint_cpu.py [RING NODE]; without, as a node's cpu: {command: [/PATH/joint_cpu.py]}, ringd tells it"""
import sys

import limb_ring


def main():
    node = limb_ring.JointNode.of_arguments()
    positions = [joint.initial for joint in node.joints]    # rad

    def step(dt, goals):
        for i, goal in enumerate(goals):
            if goal.position is not None:    # commanded, or held by its safe state
                positions[i] += max(-2.0 * dt, min(2.0 * dt, goal.position - positions[i]))
        return positions

    for sensor in node.sensors:    # lies still
        node.sensor(sensor.name, lambda g=9.81 if sensor.imu else 0.0: ([0.0, 0.0, g], [0.0, 0.0, 0.0]))
    return node.run(step)


if __name__ == '__main__':
    try:
        sys.exit(main())
    except limb_ring.HostPortError as problem:
        sys.exit('joint_cpu: %s' % problem)
    except ValueError as usage:
        print(usage, file=sys.stderr)
        sys.exit(2)
