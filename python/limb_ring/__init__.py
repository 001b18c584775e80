"""Rings of limb_ring from Python: host ports, whole rings, and what is inside packets. The ROS messages of the package are
limb_ring.msg and limb_ring.srv beside it.

    with limb_ring.Ring('leg8.yaml') as ring:
        ring.fault('hang', 'left_knee')
        ring.reset('left_knee', timeout=2)
        ring.wait('left_knee', 'running', timeout=5)
"""
import glob
import importlib
import importlib.machinery
import os
import sys

# Loaded as soon as one of them is asked for: limb_ring.msg is for every ROS node that hears of a ring, and needs no
# client library.
_NAMES_IN = {
    '_client': ['BROADCAST', 'JOINT_CHANNEL', 'MAX_PAYLOAD', 'TOPIC_CHANNEL', 'USER_CHANNEL', 'Announcement',
                'CapturedPacket', 'CaptureCounts', 'CommandSet', 'Disconnected', 'EVENT_KINDS', 'Fragmenter', 'HostPortError', 'HostPortTimeout',
                'Interrupt', 'JointCommand', 'JointState', 'Observed', 'ObservedLost', 'Packet', 'Reassembler', 'Reply',
                'Result', 'SensorReading'],
    'joint_node': ['JointNode'],
    'host_port': ['HostPort', 'payload_of'],   # Packet gets its `payload` there
    'ring': ['Ring', 'RingError', 'RingTimeout', 'find_config'],
}
__all__ = [name for names in _NAMES_IN.values() for name in names]


def _built_for():
    """The Pythons whose _client is here, as the names of its files say: 'cpython-311-x86_64-linux-gnu'."""
    files = glob.glob(os.path.join(glob.escape(os.path.dirname(__file__)), '_client.*'))
    return {os.path.basename(file).split('.')[1]: '.' + os.path.basename(file).split('.', 1)[1] for file in files}


def _load(module):
    try:
        return importlib.import_module('.' + module, __name__)
    except ImportError as problem:
        built = _built_for()
        if not built or set(built.values()) & set(importlib.machinery.EXTENSION_SUFFIXES):
            raise
        raise ImportError('limb_ring in %s was built for %s, this is Python %d.%d (%s): use that Python, or build '
                          'limb_ring with -DPYTHON_EXECUTABLE=%s'
                          % (os.path.dirname(__file__), ', '.join(sorted(built)), sys.version_info[0],
                             sys.version_info[1], sys.executable, sys.executable)) from problem


def __getattr__(name):
    if name not in __all__:
        raise AttributeError('limb_ring has no %s' % name)
    for module, names in _NAMES_IN.items():
        loaded = _load(module)
        globals().update((each, getattr(loaded, each)) for each in names)
    return globals()[name]


def __dir__():
    return sorted({*globals(), *__all__})
