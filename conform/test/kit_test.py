#!/usr/bin/env python3
"""The kit's command line and reports, on a node in C that is a library."""

import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

import wrong_nodes_test as nodes

KIT = os.path.join(nodes.ROOT, 'conform', 'conform')
COMPILER = os.environ.get('CONFORM_COMPILER', 'cc')
WRONG = 'HOP is not incremented'


class Kit(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory(prefix='kit_test_')
        cls.addClassCleanup(cls.place.cleanup)
        for name in nodes.FILES:
            problem = nodes.run_compiler(COMPILER, '-c', os.path.join(nodes.SOURCES, name), '-o', nodes.right_object(name, cls.place.name))
            assert not problem, problem
        kinds = (None, [kind for kind in nodes.KINDS if kind.name == WRONG][0])
        cls.right, cls.wrong = (nodes.build(kind, COMPILER, cls.place.name, i)[0] for i, kind in enumerate(kinds))

    def path(self, name):
        return os.path.join(self.place.name, name)

    def kit(self, *arguments, code=0):
        run = subprocess.run([sys.executable, KIT, *arguments], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, code, run.stdout + run.stderr)
        return run.stdout + run.stderr

    def test_the_right_node_passes_all(self):
        self.assertNotIn('failed', self.kit('--library', self.right, '--profile', 'full', '--strict'))

    def test_there_are_at_least_120_cases_and_each_cites_an_existing_section(self):
        with open(os.path.join(nodes.ROOT, 'docs', 'protocol.md'), encoding='utf-8') as page:
            there = set(re.findall(r'^#{2,4} (\d+(?:\.\d+)*)\.? ', page.read(), re.M))
        numbers = re.findall(r'^(\d+\.\d+)-\d+ ', self.kit('--list'), re.M)
        self.assertGreaterEqual(len(numbers), 120)
        self.assertEqual(set(numbers) - there, set())

    def test_a_wrong_node_fails_with_section_and_packets_in_words(self):
        out = self.kit('--library', self.wrong, '--only', '2.2', code=1)
        self.assertIn('protocol.md section 2.2', out)
        self.assertIn('HOP is 1, 2 expected', out)
        self.assertRegex(out, r'from the node +down +sequence \d+: whole, DATP from node 30')

    def test_only_runs_a_section_or_a_case(self):
        self.assertIn('1 cases', self.kit('--library', self.right, '--only', '2.2-1'))
        self.assertRegex(self.kit('--library', self.right, '--only', '4.10'), r'^3\d cases')

    def test_a_case_that_does_not_exist_is_reported(self):
        self.assertIn('no case of 99; --list prints all', self.kit('--library', self.right, '--only', '99', code=2))

    def test_known_failures_do_not_count(self):
        known = self.path('known.yaml')
        with open(known, 'w', encoding='utf-8') as out:
            out.write('2.2-1: HOP is on our list\n2.2-2: and of INTPs\n')
        out = self.kit('--library', self.wrong, '--expect', known)
        self.assertIn('2.2-1 is known to fail: HOP is on our list', out)

    def test_a_known_failure_of_an_unknown_case_is_reported(self):
        known = self.path('bad.yaml')
        with open(known, 'w', encoding='utf-8') as out:
            out.write('2.2-999: it is not there\n')
        self.assertIn('2.2-999: no such case; --list prints all', self.kit('--library', self.wrong, '--expect', known, code=2))

    def test_reports_and_captures_are_written(self):
        captures = self.path('captures')
        self.kit('--library', self.wrong, '--json', self.path('r.json'), '--junit', self.path('r.xml'), '--html', self.path('r.html'),
                 '--captures', captures, code=1)
        with open(self.path('r.json'), encoding='utf-8') as file:
            results = json.load(file)
        failed = [case['number'] for case in results['cases'] if case['verdict'] == 'failed']
        self.assertEqual(failed, ['2.2-1', '2.2-2'])
        self.assertEqual(len(xml.parse(self.path('r.xml')).getroot().findall('.//failure')), 2)
        with open(self.path('r.html'), encoding='utf-8') as file:
            self.assertIn('HOP is 1, 2 expected', file.read())
        self.assertEqual(sorted(os.listdir(captures)), ['2.2-1.pcapng', '2.2-2.pcapng'])

    def test_a_node_must_be_named(self):
        self.assertIn('say which node', self.kit(code=2))

    def test_a_program_that_is_not_there_is_reported(self):
        self.assertIn('/no/such/node: No such file or directory', self.kit('--', '/no/such/node', code=2))

    def test_a_program_that_ends_is_not_a_node(self):
        self.assertIn('the program has ended, with 1', self.kit('--', 'false', code=3))


if __name__ == '__main__':
    unittest.main(verbosity=2)
