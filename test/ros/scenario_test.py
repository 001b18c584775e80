#!/usr/bin/python3
"""Scenarios by the service run_scenario."""
import unittest
from xml.etree import ElementTree

import rospy
import rostest
from limb_ring.srv import RunScenario

STORY = '''scenario: a node dies
nodes: 4
steps:
  - do: {kill: node3}
  - when: {node: living, is: up, ring_size: %d}
    within: {sim: 200ms, live: %s}
'''


class ScenarioService(unittest.TestCase):
    def run_scenario(self, **request):
        rospy.wait_for_service('run_scenario', 30)
        return rospy.ServiceProxy('run_scenario', RunScenario)(**request)

    def test_a_scenario_passes_simulated_and_live(self):
        for live in (False, True):
            answer = self.run_scenario(text=STORY % (3, '20s'), live=live, seed=7)
            self.assertTrue(answer.success, answer.report)
            self.assertEqual(answer.exit_code, 0)
            self.assertIn('(live, seed 7)' if live else '(seed 7)', answer.report)
            suite = ElementTree.fromstring(answer.junit).find('testsuite')
            self.assertEqual((suite.get('tests'), suite.get('failures')), ('1', '0'))

    def test_a_scenario_passes_with_real_programs_under_the_virtual_clock(self):
        answer = self.run_scenario(text=STORY % (3, '20s'), programs=True, seed=7)
        self.assertTrue(answer.success, answer.report)
        self.assertIn('(virtual, seed 7)', answer.report)
        self.assertIn('trace hash', answer.report)

    def test_an_expectation_that_is_not_met(self):
        answer = self.run_scenario(text=STORY % (2, '500ms'), live=True)
        self.assertFalse(answer.success)
        self.assertEqual(answer.exit_code, 1)
        self.assertIn('seen instead', answer.report)
        self.assertIn('<failure', answer.junit)

    def test_requests_that_are_wrong(self):
        for request in ({}, {'path': '/none.yaml', 'text': 'x'}, {'path': '/none.yaml'}, {'text': 'steps: []'},
                        {'text': STORY % (3, '1s'), 'live': True, 'programs': True}):
            answer = self.run_scenario(**request)
            self.assertEqual((answer.success, answer.exit_code), (False, 2))
            self.assertNotEqual(answer.report, '')


if __name__ == '__main__':
    rospy.init_node('scenario_service_test')
    rostest.rosrun('limb_ring', 'scenario_service', ScenarioService)
