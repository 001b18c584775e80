"""The firmware of a node with joints and sensors, but for what is yours (limb_ring/joint_node.h)."""
import os
import sys

from . import _client
from .host_port import _byte, _node, _text


class JointNode:
    """Keeps the rules of a CPU towards its robot: which commands are obeyed, when a joint goes to its safe state, stops,
    sample times, numbers and stamps. Yours are `step` and a function for each sensor:

        node = limb_ring.JointNode()
        node.run(lambda dt, goals: [goal.position for goal in goals])

    Joints turn (rad, rad/s, N m) or slide (m, m/s, N), as the ring's file says. Times are in seconds. For one thread."""

    def __init__(self, ring='', node='', at_once=False, runtime=''):
        """
        @param ring its name; '': LIMB_RING_RING, which ringd gives its CPUs
        @param node id or name; '': LIMB_RING_NODE
        @param at_once `step` is called when a goal changes, too, at that instant: for simulations
        @param runtime folder in the place of XDG_RUNTIME_DIR
        @raise HostPortError where the daemon is not there, does not answer, or has another CPU"""
        self._node = _client.JointNode(_text('ring', ring), _node(node), at_once, _text('runtime', runtime))

    @classmethod
    def of_arguments(cls, arguments=None):
        """By `PROGRAM [RING NODE]`: without them, as ringd tells its CPU. What roslaunch adds behind them plays no part.
        @param arguments default: sys.argv"""
        arguments = sys.argv if arguments is None else arguments
        if len(arguments) == 2:
            raise ValueError('usage: %s [RING NODE]' % os.path.basename(arguments[0]))
        return cls(*arguments[1:3])

    @property
    def name(self):
        """The node's."""
        return self._node.name

    @property
    def joints(self):
        """As the ring's file gives them, in the order of goals: name, slides, lower, upper, velocity, effort, initial,
        damps."""
        return self._node.setup_joints

    @property
    def sensors(self):
        """As the ring's file gives them: name, imu (False: force and torque), rate in Hz, topic ('': none)."""
        return self._node.setup_sensors

    @property
    def state_rate(self):
        """How often `step` is called. Hz"""
        return self._node.state_rate

    def now(self):
        """The ring's clock, as HostPort.now(). s"""
        return self._node.now_ns() / 1e9

    def sensor(self, name, measure):
        """
        @param name of a sensor of this node in the ring's file
        @param measure a function that returns two lists of three: m/s^2 and rad/s of an IMU, N and N m of a force sensor
        @raise ValueError naming the sensors, where this node has none of that name"""
        self._node.on_sensor(_text('name', name), measure)

    def on_packet(self, take):
        """A packet came that is not joint data: take(packet) returns whether it is for this CPU."""
        self._node.on_packet(take)

    def on_notify(self, take):
        """A pin with the action `notify` was pulled: take(interrupt)."""
        self._node.on_notify(take)

    def send(self, to, data, priority=2, channel=0):
        """A packet of your own: 1 to 512 bytes to the id of a node."""
        return self._node.send(_byte('to', to, 'the id of a node, 0 to 254'), bytes(data),
                               _byte('priority', priority, '0 (highest) to 3'), _byte('channel', channel, '0 to 63'))

    def at(self, time_s, call):
        """Calls it once, at that time of now()."""
        self._node.at(round(time_s * 1e9), call)

    def run(self, step=None):
        """Until end() or until the daemon is gone; what a function of yours raises ends it, too.
        @param step a function of dt, the s since its last call, and the goals of all joints: state ('commanded', 'hold' or
            'damp'), position, velocity and effort (None where not given), within the joint's limits. It returns what the
            joints do now: of each its position, or (position, velocity, effort). A node without joints needs none.
        @return what end() was given; 1 where the daemon is gone"""
        if step is not None:
            self._node.on_step(step)
        return self._node.run()

    def end(self, code=0):
        """Lets run() return that."""
        self._node.end(code)

    def summary(self):
        """What was sent, obeyed and refused, in one line for people."""
        return self._node.summary()
