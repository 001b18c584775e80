"""Rings of limb_ring from Python: host ports, whole rings, and what is inside packets. The ROS messages of the package are
limb_ring.msg and limb_ring.srv beside it.

    with limb_ring.Ring('leg8.yaml') as ring:
        ring.fault('hang', 'left_knee')
        ring.reset('left_knee', timeout=2)
        ring.wait('left_knee', 'running', timeout=5)
"""
import importlib

# Loaded as soon as one of them is asked for: limb_ring.msg is for every ROS node that hears of a ring, and needs no
# client library.
_NAMES_IN = {
    '_client': ['BROADCAST', 'JOINT_CHANNEL', 'MAX_PAYLOAD', 'TOPIC_CHANNEL', 'USER_CHANNEL', 'Announcement',
                'CapturedPacket', 'CaptureCounts', 'Disconnected', 'Fragmenter', 'HostPortError', 'HostPortTimeout',
                'Interrupt', 'JointCommand', 'JointState', 'Observed', 'ObservedLost', 'Packet', 'Reassembler', 'Reply',
                'Result', 'SensorReading'],
    'host_port': ['HostPort', 'payload_of'],   # Packet gets its `payload` there
    'ring': ['Ring', 'RingError', 'RingTimeout', 'find_config'],
}
__all__ = [name for names in _NAMES_IN.values() for name in names]


def __getattr__(name):
    if name not in __all__:
        raise AttributeError('limb_ring has no %s' % name)
    for module, names in _NAMES_IN.items():
        loaded = importlib.import_module('.' + module, __name__)
        globals().update((each, getattr(loaded, each)) for each in names)
    return globals()[name]


def __dir__():
    return sorted({*globals(), *__all__})
