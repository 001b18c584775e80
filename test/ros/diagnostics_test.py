#!/usr/bin/python3
"""/diagnostics tells of every node and line; what went wrong is told for a while after it."""
import os
import unittest

import rospkg
import rospy
import rostest
import yaml
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from limb_ring.srv import ClearFaults, InjectFault

from ring_testing import Newest, Ring, kill_process, wait_for

OK, WARN, ERROR, STALE = (DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR, DiagnosticStatus.STALE)
PREFIX = 'limb_ring: '
ANALYZERS = os.path.join(rospkg.RosPack().get_path('limb_ring'), 'config', 'analyzers.yaml')


def service(name, kind):
    rospy.wait_for_service(name, 30)
    return rospy.ServiceProxy(name, kind)


def matches(analyzer, name):
    return name in analyzer.get('expected', []) or any(name.startswith(s) for s in analyzer.get('startswith', []))


class Diagnostics(unittest.TestCase):
    def setUp(self):
        self.ring = Ring()
        # An updater publishes each task once by itself as it is added: not the whole.
        self.newest = Newest('/diagnostics', DiagnosticArray)
        self.ring.wait_until_up()
        self.wait_until_well()

    def all(self):
        message = self.newest.wait(lambda m: len(m.status) > 1, 'diagnostics')
        return {status.name: status for status in message.status}

    def of(self, name):
        return self.all()[PREFIX + name]

    def wait_for(self, name, level, words=''):
        wait_for(lambda: self.of(name).level == level and words in self.of(name).message,
                 '%s to be at level %d, %s; it is: %s' % (name, level, words, self.of(name).message))
        return self.of(name)

    def wait_until_well(self):
        wait_for(lambda: all(s.level == OK for s in self.all().values()), 'all to be well')

    def test_every_node_and_line_is_told_of_with_its_figures(self):
        names = [node.name for node in self.ring.status.get().nodes]
        lines = ['line %s -> %s' % pair for pair in zip(names, names[1:] + names[:1])]
        self.assertEqual(set(self.all()), {PREFIX + name for name in names + lines + ['ring', 'promises']})
        knee = self.of('left_knee')
        values = {value.key: value.value for value in knee.values}
        self.assertEqual((values['state'], values['CPU state']), ('up', 'running'))
        self.assertGreater(float(values['round trip p50 (us)']), 0)
        self.assertEqual(knee.hardware_id, self.ring.status.get().ring)
        line = {value.key: value.value for value in self.of('line left_hip -> left_hip_yaw').values}
        self.assertEqual(int(line['crc_errors']), 0)

    def test_the_rings_promises_are_judged_at_every_node(self):
        values = {value.key: value.value for value in self.of('promises').values}
        self.assertEqual((values['nodes watched'], values['broken'], values['last broken']), ('16', '0', 'none'))
        self.assertGreater(int(values['sends']), 0)

    def test_a_hung_cpu_is_an_error_of_its_node_and_of_no_line(self):
        fault = service('inject_fault', InjectFault)(fault='hang left_knee')
        self.assertTrue(fault.success, fault.message)
        self.wait_for('left_knee', ERROR, 'its CPU hangs')
        self.assertEqual(self.of('line left_hip_yaw -> left_knee').level, OK)
        self.assertTrue(service('clear_faults', ClearFaults)(id='').success)
        self.wait_until_well()

    def test_a_broken_line_is_an_error_and_a_warning_for_a_while_after(self):
        fault = service('inject_fault', InjectFault)(fault='cut left_hip -> left_hip_yaw')
        self.assertTrue(fault.success, fault.message)
        self.wait_for('line left_hip -> left_hip_yaw', ERROR, 'broken')
        self.wait_for('head', WARN, 'open_chain')
        self.wait_for('ring', WARN, '16 of 16 nodes work, open chain: line left_hip -> left_hip_yaw broken')
        self.assertTrue(service('clear_faults', ClearFaults)(id='').success)
        self.wait_for('line left_hip -> left_hip_yaw', WARN, 'lately')
        self.wait_until_well()

    def test_a_node_that_went_is_an_error_and_one_that_came_back_a_warning(self):
        kill_process(self.ring.node('right_elbow').pid)
        self.wait_for('right_elbow', WARN, 'was restarted')
        self.ring.wait_until_up()
        self.wait_until_well()

    def test_what_the_shipped_analyzers_look_for_is_there_and_all_is_looked_for(self):
        with open(ANALYZERS) as file:
            analyzers = yaml.safe_load(file)['analyzers']
        names = set(self.all())
        for analyzer in analyzers.values():
            found = [name for name in names if matches(analyzer, name)]
            self.assertLessEqual(set(analyzer.get('expected', [])), names, analyzer['path'])
            self.assertEqual(len(found), analyzer.get('num_items', len(found)), analyzer['path'])
        self.assertEqual([name for name in names if not any(matches(a, name) for a in analyzers.values())], [])


if __name__ == '__main__':
    rospy.init_node('diagnostics_test')
    rostest.rosrun('limb_ring', 'diagnostics', Diagnostics)
