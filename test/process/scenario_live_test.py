"""ringctl scenario run --live: exit codes, and that nothing it started is left behind."""

import os
import signal
import xml.etree.ElementTree

import ring_process
from ring_process import ScenarioTest

KILL = '''scenario: a node dies
nodes: 4
steps:
  - do: {send: {name: before, from: node0, to: node3, size: 64, count: 5}}
  - when: {taken: before, at_least: 5, at_most: 5}
    within: 20s
  - do: {kill: node3}
  - when: {node: living, is: up, ring_size: 3}
    within: 20s
  - do: {send: {name: late, from: node0, to: node3, size: 64}}
  - when: {results: late, are: no such node, at_least: 1}
    within: 20s
'''
SURPRISE = '''scenario: a surprise
nodes: 4
steps:
  - when: {node: node2, is: down}
    within: {sim: 1ms, live: 100ms}
'''
ENDLESS = '''scenario: nothing happens for long
nodes: 3
steps:
  - at: 1ms
    do: {freeze: node1}
  - at: 600s
never: [{node: node0, is: down}]
'''
BUSY = '''scenario: sends for an hour
nodes: 3
steps:
  - do: {send: {name: many, from: all, to: all, size: 512, every: 100us}}
  - at: 3600s
never: [{node: node0, is: down}]
'''
FOLDS = '''scenario: the second line of plain nodes
nodes: 3
redundancy: foldback
steps:
  - do: {cut: node0 -> node1}
  - when: {node: all, is: folded, ring_size: 3}
    within: 20s
'''
TOO_FAST = '''scenario: a story of microseconds
nodes: 4
steps: [{after: 6us, do: {kill: node3}}]
never: [{node: node0, is: down}]
'''


class ScenarioLive(ScenarioTest):
    def play(self, *files, more=()):
        paths = [self.write('%d.yaml' % i, text) for i, text in enumerate(files)]
        return self.ctl('scenario', 'run', '--live', *paths, *more)

    def started(self):
        return self.started_by_runs('ringd', 'scenario_cpu')

    def assert_clean(self):
        self.assertEqual(self.started(), [])
        self.assertEqual(os.listdir(self.temporary), [])

    def start_endless(self, *first):
        """A run that has a frozen node and goes on for minutes. @param first arguments before that scenario"""
        run = self.start('run', [ring_process.program('ringctl'), 'scenario', 'run', '--live', *first,
                                 self.write('endless.yaml', ENDLESS)])
        self.wait('a frozen node', lambda: 'T' in [ring_process.process_state(pid) for pid in self.started()])
        return run

    def test_as_expected_over_unix_and_udp(self):
        for transport in ('unix', 'shm', 'udp'):
            done = self.play(KILL, more=['--transport', transport])
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertIn('a node dies (live, seed 1)', done.stdout)
            self.assertIn('end: all as expected', done.stdout)
            self.assert_clean()

    def test_plain_nodes_fold_back_if_the_scenario_says_so(self):
        done = self.play(FOLDS)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_an_unmet_expectation(self):
        junit = os.path.join(self.folder, 'out.xml')
        done = self.play(KILL, SURPRISE, more=['--junit', junit])
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn('seen instead: node2 is up, in a ring of 4', done.stdout)
        suite = xml.etree.ElementTree.parse(junit).getroot().find('testsuite')
        self.assertEqual((suite.get('tests'), suite.get('failures')), ('2', '1'))
        self.assert_clean()

    def test_what_only_the_virtual_clock_can_do_is_reported_before_anything_starts(self):
        done = self.play(KILL, TOO_FAST)
        self.assertEqual((done.returncode, done.stdout), (2, ''))
        self.assertIn('only under the virtual clock (--sim):\n  after: 6us', done.stderr)
        listed = self.ctl('scenario', 'list', self.folder).stdout.splitlines()
        self.assertRegex(listed[1], r'^0.yaml +sim(, virtual)?, live +a node dies$')
        self.assertRegex(listed[2], r'^1.yaml +sim(, virtual| only) +a story of microseconds$')

    def test_a_running_ring_of_the_user_is_not_touched(self):
        up = self.ctl('--ring', self.ring, 'up', '--nodes', 4, '--detach', '--timeout', 60)
        self.assertEqual(up.returncode, 0, up.stderr)
        boots = [self.answered(node)['boot'] for node in range(4)]
        self.assertEqual(self.play(KILL).returncode, 0)
        self.assertEqual([self.answered(node)['boot'] for node in range(4)], boots)
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)

    def test_interrupted_by_the_user(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            run = self.start_endless()
            run.send_signal(number)
            self.assertEqual(self.wait_exit(run), 1)
            self.assertIn('interrupted', self.log_of(run))
            self.assert_clean()

    def test_an_interrupted_run_reports_the_scenarios_that_it_has_run(self):
        junit = os.path.join(self.folder, 'out.xml')
        run = self.start_endless('--junit', junit, self.write('first.yaml', SURPRISE))
        run.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(run), 1)
        self.assertEqual(self.outcomes(junit), ['failure', 'error'])

    @staticmethod
    def outcomes(junit):
        suite = xml.etree.ElementTree.parse(junit).getroot().find('testsuite')
        cases = [[child.tag for child in case if child.tag != 'system-out'] for case in suite]
        outcomes = [case[0] if case else 'passed' for case in cases]
        for name, outcome in (('failures', 'failure'), ('errors', 'error'), ('skipped', 'skipped')):
            assert int(suite.get(name)) == outcomes.count(outcome), suite.attrib
        return outcomes

    def test_an_interrupted_run_under_the_virtual_clock_is_not_passed(self):
        junit = os.path.join(self.folder, 'out.xml')
        files = [self.write('%d.yaml' % i, text) for i, text in enumerate((KILL, BUSY, KILL))]
        for number in (signal.SIGINT, signal.SIGTERM):
            run = self.start('run', [ring_process.program('ringctl'), 'scenario', 'run', *files, '--junit', junit])
            self.wait('the first has run', lambda: 'a node dies' in self.log_of(run))
            run.send_signal(number)
            self.assertEqual(self.wait_exit(run), 1)
            self.assertEqual(self.outcomes(junit), ['passed', 'error', 'skipped'])

    def test_killed_itself(self):
        run = self.start_endless()
        run.kill()
        self.wait('all gone', lambda: not self.started())

    def test_files_left_by_a_killed_run_are_removed_by_the_next(self):
        killed, living = self.start_endless(), self.start_endless()
        self.wait('both rings are up', lambda: len([pid for pid in self.started()
                                                    if ring_process.process_state(pid) == 'T']) == 2)
        killed.kill()
        self.wait_exit(killed)
        self.assertEqual(len(os.listdir(self.temporary)), 2)
        self.assertEqual(self.play(KILL).returncode, 0)
        self.assertEqual(len(os.listdir(self.temporary)), 1)
        living.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(living), 1)
        self.assertIn('interrupted', self.log_of(living))
        self.assert_clean()

    def test_a_daemon_that_somebody_else_ends(self):
        run = self.start_endless()
        living = [pid for pid in self.started() if ring_process.process_state(pid) != 'T']
        daemons = [pid for pid in living if self._comm(pid) == 'ringd']
        os.kill(daemons[0], signal.SIGKILL)
        self.assertEqual(self.wait_exit(run), 1)
        # That a daemon has gone, or where it was node 0's what the file never wants to see: whichever is seen first.
        self.assertRegex(self.log_of(run), 'every daemon runs|seen instead: node0 is down')
        self.assert_clean()

    @staticmethod
    def _comm(pid):
        with open('/proc/%d/comm' % pid) as comm:
            return comm.read().strip()


if __name__ == '__main__':
    ring_process.main()
