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
from sensor_msgs.msg import JointState

from ring_testing import Ring, kill_process, service, wait_for

OK, WARN, ERROR, STALE = (DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR, DiagnosticStatus.STALE)
PREFIX = 'limb_ring: '
ANALYZERS = os.path.join(rospkg.RosPack().get_path('limb_ring'), 'config', 'analyzers.yaml')


def matches(analyzer, name):
    return name in analyzer.get('expected', []) or any(name.startswith(s) for s in analyzer.get('startswith', []))


class Diagnostics(unittest.TestCase):
    def setUp(self):
        self.ring = Ring()
        self.told, self.since = [], 0
        subscriber = rospy.Subscriber('/diagnostics', DiagnosticArray, self.take)
        self.addCleanup(subscriber.unregister)
        self.ring.wait_until_up()
        self.wait_until_well()

    def take(self, message):
        self.told.append({status.name[len(PREFIX):]: status for status in message.status})

    def from_now_on(self):
        """What was told before does not count any more."""
        self.since = len(self.told)

    def all(self):
        return wait_for(lambda: self.told[-1:], 'diagnostics')[0]

    def wait_for_all(self, *expected):
        """All of these were told at once, be it that it is over by now: (name, levels, words). A machine that is busy
        enough loses packets, so that others warn of them meanwhile, and lets this test miss what lasts seconds."""
        def are_in(told):
            return all(told[name].level in levels and words in told[name].message for name, levels, words in expected)
        found = wait_for(lambda: [told for told in self.told[self.since:] if are_in(told)],
                         lambda: '%s; last told: %s' % (expected, [self.all()[name] for name, _, _ in expected]))
        return found[0]

    def wait_for(self, name, level, words=''):
        return self.wait_for_all((name, [level], words))[name]

    def wait_until_well(self):
        """Each for itself: all at once are only where nothing else is going on."""
        self.from_now_on()
        ill = set(self.all())

        def are_well():
            ill.difference_update(name for told in self.told[self.since:] for name in told if told[name].level == OK)
            return not ill
        wait_for(are_well, lambda: 'all to be well; these are not: %s' % [self.all()[name] for name in ill])

    def test_every_node_and_line_is_reported_with_its_figures(self):
        names = [node.name for node in self.ring.status.get().nodes]
        lines = ['line %s -> %s' % pair for pair in zip(names, names[1:] + names[:1])]
        self.assertEqual(set(self.all()), set(names + lines + ['ring', 'promises']))
        knee = self.wait_for('left_knee', OK)
        values = {value.key: value.value for value in knee.values}
        self.assertEqual((values['state'], values['CPU state']), ('up', 'running'))
        self.assertGreater(float(values['round trip p50 (us)']), 0)
        self.assertEqual(knee.hardware_id, self.ring.status.get().ring)
        line = {value.key: value.value for value in self.wait_for('line left_hip -> left_hip_yaw', OK).values}
        self.assertEqual(int(line['crc_errors']), 0)

    def test_the_rings_promises_are_judged_at_every_node(self):
        def told():
            return {value.key: value.value for value in self.all()['promises'].values}
        wait_for(lambda: told()['nodes watched'] == '16' and int(told()['sends']) > 0, 'sends to be judged at all nodes')
        self.assertEqual((told()['broken'], told()['last broken']), ('0', 'none'))

    def test_what_the_bridge_loses_is_a_warning_with_the_counters_name(self):
        commands = rospy.Publisher('joint_commands', JointState, queue_size=1)
        self.addCleanup(commands.unregister)
        self.from_now_on()

        def is_told():
            commands.publish(JointState(name=['left_knee_pitch']))   # without a value
            return [told for told in self.told[self.since:]
                    if told['ring'].level == WARN and 'commands_refused +' in told['ring'].message]
        wait_for(is_told, 'the warning')
        self.wait_until_well()

    def test_a_hung_cpu_is_an_error_of_its_node_and_of_no_line(self):
        fault = service('inject_fault', InjectFault)(fault='hang left_knee')
        self.assertTrue(fault.success, fault.message)
        self.wait_for_all(('left_knee', [ERROR], 'its CPU hangs'), ('line left_hip_yaw -> left_knee', [OK], ''))
        self.ring.status.wait(lambda status: status.message == 'CPU of left_knee hung', 'a sentence about it')
        self.assertTrue(service('clear_faults', ClearFaults)(id='').success)
        self.wait_until_well()

    def test_a_broken_line_is_an_error_and_a_warning_for_a_while_after(self):
        fault = service('inject_fault', InjectFault)(fault='cut left_hip -> left_hip_yaw')
        self.assertTrue(fault.success, fault.message)
        self.wait_for('line left_hip -> left_hip_yaw', ERROR, 'broken')
        self.wait_for('head', WARN, 'open_chain')
        words = '16 of 16 nodes work, open chain: line left_hip -> left_hip_yaw broken'
        self.wait_for('ring', WARN, words)
        self.ring.status.wait(lambda status: status.message == words, 'the same in ring_status')
        self.from_now_on()
        self.assertTrue(service('clear_faults', ClearFaults)(id='').success)
        self.wait_for('line left_hip -> left_hip_yaw', WARN, 'lately')
        self.wait_until_well()
        self.ring.status.wait(lambda status: status.message == '', 'nothing to be wrong')

    def test_a_node_that_is_gone_is_an_error_and_one_that_came_back_a_warning(self):
        kill_process(self.ring.node('right_elbow').pid)
        # On a busy machine it may be alone for longer than that is told.
        self.wait_for_all(('right_elbow', [WARN, ERROR], 'its daemon was restarted'))
        self.ring.wait_until_up()
        self.wait_until_well()

    def test_what_the_shipped_analyzers_expect_exists_and_everything_is_analyzed(self):
        with open(ANALYZERS) as file:
            analyzers = yaml.safe_load(file)['analyzers']
        names = {PREFIX + name for name in self.all()}
        for analyzer in analyzers.values():
            found = [name for name in names if matches(analyzer, name)]
            self.assertLessEqual(set(analyzer.get('expected', [])), names, analyzer['path'])
            self.assertEqual(len(found), analyzer.get('num_items', len(found)), analyzer['path'])
        self.assertEqual([name for name in names if not any(matches(a, name) for a in analyzers.values())], [])


if __name__ == '__main__':
    rospy.init_node('diagnostics_test')
    rostest.rosrun('limb_ring', 'diagnostics', Diagnostics)
