#!/usr/bin/python3
"""Faults on purpose through the bridge's services: they take effect, are listed and end."""
import os
import signal
import subprocess
import threading
import unittest
import xmlrpc.client

import rospy
import rostest
from limb_ring.processes import parent_of
from limb_ring.srv import ClearFaults, InjectFault, ListFaults, ResetNode, Resume, SendInterrupt, Stop

from ring_testing import Ring, is_alive, process_state, service, wait_for


def pids():
    return [int(entry) for entry in os.listdir('/proc') if entry.isdigit()]


class Faults(unittest.TestCase):
    def setUp(self):
        self.ring = Ring()
        self.inject = service('inject_fault', InjectFault)
        self.clear = service('clear_faults', ClearFaults)
        self.list = service('list_faults', ListFaults)
        self.ring.wait_until_up()

    def begin(self, words):
        answer = self.inject(fault=words)
        self.assertTrue(answer.success, answer.message)
        return answer

    def test_a_hung_cpu_is_stopped_listed_and_goes_on(self):
        pid = self.ring.node('left_knee').cpu_pid
        answer = self.begin('hang left_knee')
        self.assertEqual(process_state(pid), 'T')
        self.assertEqual(answer.message, 'hang left_knee')
        listed = self.list()
        self.assertEqual((listed.ids, listed.faults), ([answer.id], ['hang left_knee']))
        self.assertTrue(self.clear(id=answer.id).success)
        self.assertNotEqual(process_state(pid), 'T')
        self.assertEqual(self.list().ids, [])
        self.ring.wait_until_up()

    def test_a_cut_line_opens_the_chain_until_it_is_cleared(self):
        self.begin('cut left_hip -> left_hip_yaw')
        self.ring.wait_for_node('left_hip_yaw', lambda n: n.state == 'open_chain', 'to know of the break')
        self.ring.wait_for_node('body', lambda n: n.state == 'open_chain', 'to know of the break')
        stopped = service('stop', Stop)(node='all').message   # reaches both sides of the break
        self.assertNotIn('not reached', stopped)
        self.assertNotIn('not known', stopped)
        resumed = service('resume', Resume)(node='all')
        self.assertFalse(resumed.success)
        self.assertRegex(resumed.message, "^left_hip_yaw: the resume ended 'unconfirmed', .* it was not reached")
        for node in self.ring.status.get().nodes:   # no way leads to the first of the chain
            self.ring.wait_for_node(node.name, lambda n: n.stopped == (n.name == 'left_hip_yaw'),
                                    'to go on, but for left_hip_yaw')
        self.assertTrue(self.clear(id='').success)
        self.ring.wait_until_up()
        self.assertTrue(service('resume', Resume)(node='all').success)

    def test_a_power_cycle_brings_the_node_back_with_another_cpu(self):
        before = self.ring.node('right_elbow')
        self.begin('power_cycle right_elbow')
        self.assertFalse(is_alive(before.cpu_pid))
        after = self.ring.wait_for_node('right_elbow', lambda n: n.cpu_pid not in (0, before.cpu_pid) and
                                        n.cpu_state == 'running', 'its new CPU')
        self.assertEqual(after.pid, before.pid)
        self.ring.wait_until_up()

    def test_nodes_are_killed_frozen_and_come_again(self):
        killed = self.begin('kill right_elbow')
        self.ring.wait_for_node('right_elbow', lambda n: n.state == 'down', 'not to be heard')
        frozen = self.begin('freeze left_ankle')
        self.ring.wait_for_node('left_ankle', lambda n: n.state == 'down', 'not to be heard')
        self.assertEqual(sorted(self.list().ids), sorted([killed.id, frozen.id]))
        self.assertIn('is frozen', self.inject(fault='hang left_ankle').message)
        os.kill(self.ring.node('left_knee').pid, signal.SIGSTOP)   # by nobody that the ring knows
        wait_for(lambda: not self.list().success, 'it to stand still')
        listed = self.list()
        self.assertIn('the faults at left_knee are not known: node left_knee is frozen', listed.message)
        self.assertEqual(sorted(listed.ids), sorted([killed.id, frozen.id]))
        self.begin('thaw left_knee')
        self.assertTrue(self.clear(id=killed.id).success)
        self.begin('thaw left_ankle')
        self.assertEqual(self.list().ids, [])
        self.ring.wait_until_up()

    def test_a_bridge_whose_daemon_is_gone_keeps_its_clock(self):
        before = self.ring.status.get().header.stamp
        killed = self.begin('kill body')
        gone = self.ring.status.wait(lambda status: not status.connected, 'to notice it')
        self.assertLess(abs((gone.header.stamp - before).to_sec()), 3600)
        self.assertTrue(self.clear(id=killed.id).success)
        self.ring.wait_until_up()

    def test_what_commands_the_robot_is_not_delayed_by_nodes_that_are_frozen_for_a_time(self):
        nodes = ['right_elbow', 'left_ankle', 'left_elbow', 'right_ankle']   # more than calls are served at a time
        freezes = [threading.Thread(target=self.inject, kwargs={'fault': 'freeze %s for=300s' % node}) for node in nodes]
        for freeze in freezes:
            freeze.start()
        wait_for(lambda: sum(self.ring.node(node).state == 'down' for node in nodes) == 3, 'three nodes not to be heard')
        for answer in [service('stop', Stop)(node='left_knee'), service('resume', Resume)(node='left_knee'),
                       service('send_interrupt', SendInterrupt)(node='left_knee', factor=2)]:
            self.assertTrue(answer.success, answer.message)
        self.assertTrue(all(freeze.is_alive() for freeze in freezes))
        ring = rospy.get_param('ring_bridge/ring')
        while any(freeze.is_alive() for freeze in freezes):   # the fourth begins when the first has ended
            subprocess.call(['rosrun', 'limb_ring', 'ringctl', '--ring', ring, 'fault', 'clear'])
        self.ring.wait_until_up()

    def test_daemons_that_the_bridge_has_started_leave_no_zombies(self):
        uri = rospy.get_master().lookupNode(rospy.resolve_name('ring_bridge'))[2]
        bridge = xmlrpc.client.ServerProxy(uri).getPid('fault_test')[2]
        for _ in range(3):
            killed = self.begin('kill right_elbow')
            self.assertTrue(self.clear(id=killed.id).success)
        self.ring.wait_until_up()
        states = [process_state(pid) for pid in pids() if parent_of(pid) == bridge]
        self.assertLessEqual(states.count('Z'), 1, states)

    def test_a_drawn_seed_is_reported(self):
        answer = self.begin('corrupt left_hip -> left_hip_yaw once_in=1000')
        self.assertIn(' seed=', answer.message)
        self.assertTrue(self.clear(id='').success)
        wait_for(lambda: not self.list().ids, 'no faults')

    def test_what_is_impossible_says_why(self):
        self.assertIn("did you mean 'left_knee'", self.inject(fault='hang left_kneee').message)
        self.assertIn('a line from one node to the next', self.inject(fault='cut head:left_knee').message)
        self.assertIn('this bridge', self.inject(fault='hang body').message)
        self.assertIn('any more', self.clear(id='left_knee.99').message)
        self.assertFalse(self.inject(fault='').success)

    def test_what_is_too_long_is_shown_by_its_beginning(self):
        word = 'x' * 100000
        for answer in [self.inject(fault=word), self.clear(id=word), service('stop', Stop)(node=word),
                       service('reset_node', ResetNode)(node=word)]:
            self.assertFalse(answer.success)
            self.assertIn("'" + 60 * 'x' + "...'", answer.message)


if __name__ == '__main__':
    rospy.init_node('fault_test')
    rostest.rosrun('limb_ring', 'fault', Faults)
