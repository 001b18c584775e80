#!/usr/bin/python3
"""joint_cpu.cpp in Python: obeys joint commands, and sends the state of one joint to node 0 a hundred times a second.
joint_cpu.py [RING NODE]; what roslaunch adds behind them plays no part"""
import sys

import limb_ring
from limb_ring import Interrupt, JointCommand, JointState, Packet

PERIOD = 0.01      # s
SILENCE = 0.2e9    # ns without a command, then the joint holds still
STEP = 2.0 * PERIOD    # rad in a period: 2 rad/s


class Joint:
    def __init__(self):
        self.position = self.goal = 0.0    # rad
        # When the last command obeyed was given, and the one with the goal; when a stop came: ns of now(), which nobody sets.
        self.obeyed_ns = self.commanded_ns = self.stopped_ns = None
        self.sequence = self.refused = 0
        self.refused_one = False

    def obey(self, command, now, age):
        given = now - age
        late = abs(age) > command.valid_for_us * 1000
        stale = self.obeyed_ns is not None and given <= self.obeyed_ns
        held = self.stopped_ns is not None and not (command.resume and given > self.stopped_ns)
        if late or stale or held or len(command.joints) > 1:
            self.refused, self.refused_one = (self.refused + 1) & 0xFFFF, True
            return
        self.obeyed_ns, self.stopped_ns = given, None
        if command.joints and command.joints[0].position is not None:
            self.goal, self.commanded_ns = command.joints[0].position, given

    def stop(self, now):
        # What resumes says no goal, and the old one is given up.
        self.stopped_ns, self.commanded_ns = now, None

    def next_state(self, now, stamp):
        stopped = self.stopped_ns is not None
        commanded = not stopped and self.commanded_ns is not None and now - self.commanded_ns < SILENCE
        step = max(-STEP, min(STEP, self.goal - self.position)) if commanded else 0.0
        self.position += step
        state = JointState([JointState.Joint(self.position, step / PERIOD)], sequence=self.sequence, stamp_ns=stamp)
        state.mode.commanded, state.mode.safe, state.mode.hold = commanded, not commanded, not commanded
        state.mode.stopped, state.mode.command_refused = stopped, self.refused_one
        state.refused, self.refused_one = self.refused, False
        self.sequence = (self.sequence + 1) & 0xFFFF
        return state


def main():
    if len(sys.argv) == 2:
        print('usage: joint_cpu.py [RING NODE]', file=sys.stderr)
        sys.exit(2)
    ring, node = sys.argv[1:3] or ('', '')
    joint = Joint()
    with limb_ring.HostPort.connect(ring=ring, node=node, role='cpu', alive_period=0.1) as port:
        due = port.now()   # the ring's clock: it may be a virtual one
        while port.connected:
            message = port.receive(max(0.0, due - port.now()))
            if isinstance(message, Packet) and isinstance(message.payload, JointCommand):
                joint.obey(message.payload, port.now_ns(), port.age_ns(message.payload.stamp_ns))
            elif isinstance(message, Interrupt) and message.action == 'stop':
                joint.stop(port.now_ns())
            if port.now() >= due:
                due = max(due + PERIOD, port.now())   # what was missed, as in a hang, is not made up for
                port.send(0, joint.next_state(port.now_ns(), port.stamp_ns()), priority=0)


if __name__ == '__main__':
    try:
        main()
    except limb_ring.HostPortError as problem:
        sys.exit('joint_cpu: %s' % problem)
