#!/usr/bin/python3
"""What happens at the nodes comes as typed events."""
import threading
import time
import unittest

import rospy
import rostest
from limb_ring.msg import RingEvent
from limb_ring.srv import ClearFaults, InjectFault, ResetNode, SendInterrupt

from ring_testing import Ring, kill_process, service, wait_for


class Events(unittest.TestCase):
    def setUp(self):
        self.ring = Ring()
        self.ring.wait_until_up()
        self.lock, self.seen = threading.Lock(), []
        rospy.Subscriber('ring_events', RingEvent, self.take, queue_size=1000)
        self.ring.wait_until_events_heard()
        self.wait_until_subscribed()

    def wait_until_subscribed(self):
        # rospy counts a connection before it is made: only an event that comes shows that events come.
        send = service('send_interrupt', SendInterrupt)

        def probe():
            self.assertTrue(send(node='left_ankle', factor=2, force=False).success)
            return self.all(RingEvent.INTERRUPT, 'left_ankle')
        wait_for(probe, 'an event of left_ankle')

    def take(self, event):
        with self.lock:
            self.seen.append(event)

    def all(self, kind, node):
        with self.lock:
            return [event for event in self.seen if event.kind == kind and event.node == node]

    def wait_for(self, kind, node, condition=lambda event: True):
        return wait_for(lambda: [e for e in self.all(kind, node) if condition(e)],
                        'event %d of %s' % (kind, node))[0]

    def test_a_break_is_located_and_healed_once(self):
        fault = service('inject_fault', InjectFault)(fault='cut left_hip -> left_hip_yaw')
        self.assertTrue(fault.success, fault.message)
        located = self.wait_for(RingEvent.LOCATED_FAULT, 'left_hip')
        self.assertEqual(located.other_node, 'left_hip_yaw')
        self.assertLess(abs(located.header.stamp.to_sec() - time.time()), 60)
        self.wait_for(RingEvent.LINK_DOWN, 'left_hip_yaw')
        self.wait_for(RingEvent.NODE_STATE, 'head', lambda e: e.text.endswith('-> open_chain'))
        self.assertTrue(service('clear_faults', ClearFaults)(id='').success)
        self.assertEqual(self.wait_for(RingEvent.HEALED, 'left_hip').other_node, 'left_hip_yaw')
        self.wait_for(RingEvent.LINK_UP, 'left_hip_yaw', lambda e: e.other_node == 'left_hip')
        self.ring.wait_until_up()
        self.assertEqual(len(self.all(RingEvent.LOCATED_FAULT, 'left_hip')), 1)
        self.assertEqual(len(self.all(RingEvent.HEALED, 'left_hip')), 1)

    def test_a_second_break_is_located_too(self):
        for line in ('left_hip -> left_hip_yaw', 'right_hip -> right_hip_yaw'):
            fault = service('inject_fault', InjectFault)(fault='cut ' + line)
            self.assertTrue(fault.success, fault.message)
            self.wait_for(RingEvent.LOCATED_FAULT, line.split()[0])
        self.assertTrue(service('clear_faults', ClearFaults)(id='').success)
        for node in ('left_hip', 'right_hip'):
            self.wait_for(RingEvent.HEALED, node)
        self.ring.wait_until_up()

    def test_a_node_that_dies_and_comes_back_is_reported(self):
        before = self.ring.node('right_elbow')
        kill_process(before.pid)
        self.wait_for(RingEvent.NODE_STATE, 'right_elbow', lambda e: e.text == 'up -> down')
        back = self.wait_for(RingEvent.NODE_STATE, 'right_elbow', lambda e: e.text.startswith('down -> '))
        self.assertLess(abs(back.header.stamp.to_sec() - time.time()), 60)
        self.wait_for(RingEvent.NODE_STATE, 'right_elbow', lambda e: e.text.endswith('-> up'))
        self.wait_for(RingEvent.CPU_STATE, 'right_elbow', lambda e: e.text == 'running')
        self.ring.wait_until_up()

    def test_a_reset_tells_who_ordered_it_and_what_the_cpu_did(self):
        answer = service('reset_node', ResetNode)(node='left_elbow', timeout=rospy.Duration(10))
        self.assertTrue(answer.success, answer.message)
        reset = self.wait_for(RingEvent.RESET, 'left_elbow')
        self.assertEqual((reset.other_node, reset.value), ('body', 0))
        self.wait_for(RingEvent.CPU_STATE, 'left_elbow',
                      lambda e: e.text == 'running' and e.value == answer.boots)

    def test_another_interrupt_is_reported_with_its_factor(self):
        self.assertTrue(service('send_interrupt', SendInterrupt)(node='head', factor=2, force=False).success)
        interrupt = self.wait_for(RingEvent.INTERRUPT, 'head')
        self.assertEqual((interrupt.other_node, interrupt.value), ('body', 2))


if __name__ == '__main__':
    rospy.init_node('events_test')
    rostest.rosrun('limb_ring', 'events', Events)
