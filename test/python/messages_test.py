"""The package and the ROS messages of the same name live together."""
import limb_ring
from limb_ring.msg import NodeStatus, RingStatus
from limb_ring.srv import ResetNode


def test_both_are_there():
    assert RingStatus(nodes=[NodeStatus(name='knee')]).nodes[0].name == 'knee'
    assert ResetNode._request_class(node='knee').node == 'knee'
    assert limb_ring.HostPort.connect
