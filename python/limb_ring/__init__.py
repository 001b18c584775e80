"""Rings of limb_ring from Python: host ports, whole rings, and what is inside packets. The ROS messages of the package are
limb_ring.msg and limb_ring.srv beside it.

    with limb_ring.Ring('leg8.yaml') as ring:
        ring.fault('hang', 'left_knee')
        ring.reset('left_knee', timeout=2)
        ring.wait('left_knee', 'running', timeout=5)
"""
from ._client import (BROADCAST, JOINT_CHANNEL, MAX_PAYLOAD, TOPIC_CHANNEL, USER_CHANNEL, Announcement,  # noqa: F401
                      CapturedPacket, CaptureCounts, Disconnected, Fragmenter, HostPortError, HostPortTimeout, Interrupt,
                      JointCommand, JointState, Observed, ObservedLost, Packet, Reassembler, Reply, Result,
                      SensorReading)
from .host_port import HostPort, payload_of   # noqa: F401
from .ring import Ring, RingError, RingTimeout, find_config   # noqa: F401
