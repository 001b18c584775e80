"""ringctl scenario run --virtual: scenarios on a virtual ring whose CPUs are real programs, in lockstep."""

import glob
import json
import os
import re
import signal
import subprocess
import sys

import ring_process
from ring_process import ScenarioTest

CPUS = os.environ.get('RING_TEST_CPUS', '')   # where the CPUs of these tests are
SCENARIOS = os.path.join(ring_process.CONFIG, '..', 'test', 'scenarios')

STREAMS = '''steps:
  - do: {send: {name: report, from: [one, three], to: two, size: 64, every: 1ms, count: 200}}
  - at: 50ms
    do: {hang: {nodes: two, for: 30ms}}
  - at: 60ms
    do: {drop: one -> two once_in=5 for=20ms}
  - at: 100ms
    do: {crash: three}
  - at: 120ms
    do: {reset: two}
  - when: {cpu: two, is: running, boots: 2}
    within: 300ms
  - when: {cpu: three, is: running, boots: 2}
    within: 200ms
  - at: 400ms
'''
# What CPUs of one ring do with files that they share, by the words of racing_cpu.
RACES = {
    'it is read before it is written': (
        'remove map at 2 put map ready', 'at 2 expect map ready'),
    'the last one wins': (
        'at 2 put speed half', 'at 2 put speed zero', 'at 3 expect speed zero'),
    'the first one leads': (
        'remove leader at 2 create leader zero at 3 expect leader zero', 'at 2 create leader one'),
    'what was set is cleared': (
        'at 2 put alarm on at 3 expect alarm on', 'at 2 remove alarm'),
    'lines of a log': (
        'remove log at 2 add log a', 'at 2 add log b', 'at 2 add log c at 3 expect log abc'),
    'a chain of three': (
        'remove pose remove goal at 2 put pose here', 'at 2 copy pose goal', 'at 2 expect goal here'),
    'the job goes to the other one': (
        'remove mine put job one at 2 move job mine at 3 expect mine one', 'at 2 move job theirs'),
    'a value and its sum': (
        'put value one at 2 put value two', 'put sum one at 2 put sum two', 'at 2 same value sum'),
    'a token is handed on before it is there': (
        'remove home remove door put token here at 2 move token door', 'at 2 move door home', 'at 3 expect home here'),
    'it is saved after it was cleaned up': (
        'remove saved put map here at 2 copy map saved at 3 expect saved here', 'at 2 remove map'),
}
NOTHING = 'steps: [{at: 1ms}]\nnever: [{node: one, is: down}]\n'


class ScenarioVirtual(ScenarioTest):
    def scenario(self, steps, nodes, **sections):
        """File of a scenario on a ring of its own."""
        config = self.write('ring.yaml', json.dumps(dict(sections, ring=self.ring, nodes=nodes)))   # which is YAML too
        return self.write('story.yaml', 'scenario: a test\nring: %s\n%s' % (config, steps))

    def play(self, file, *more, prefix=(), code=0):
        """The report of a run, from its JSON."""
        done = subprocess.run([*prefix, ring_process.program('ringctl'), 'scenario', 'run', '--virtual', file, '--json', *more],
                              env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, universal_newlines=True, timeout=2 * ring_process.GUARD)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertEqual(os.listdir(self.temporary), [], 'nothing is left')
        return json.loads(done.stdout)[0]

    def test_a_log_that_cannot_be_written_is_an_error(self):
        file = self.scenario(NOTHING.replace('one', 'node0'), ring_process.plain_nodes(2))
        done = self.ctl('scenario', 'run', '--virtual', '--log', '/dev/full', file)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertEqual(done.stderr, 'ringctl: /dev/full: not all could be written: No space left on device\n')

    def sim(self, file):
        return self.ctl_json('scenario', 'run', '--sim', file)[0]

    @staticmethod
    def said(run):
        return '\n'.join('%.6f %s' % (line['at_ns'] / 1e6, line['what']) for line in run['log'])

    @staticmethod
    def events(run):
        return [(line['event'], line['node']) for line in run['log'] if 'event' in line]

    @staticmethod
    def results(run):
        """By send, how many ended how; not how long they took."""
        return {send['name']: {k: v for k, v in send.items() if k != 'worst_latency_ns'} for send in run['sends']}

    @classmethod
    def ended(cls, run):
        """The same; of what is sent without end, which results there were: how many is a matter of when the run ends."""
        results = cls.results(run)
        for line in run['log']:
            words = line['what']
            if words.startswith('do {send:') and 'every:' in words and 'count:' not in words:
                name = re.search('name: (\\w+)', words).group(1)
                results[name] = sorted(outcome for outcome, count in results[name].items() if count)
        return results

    # ---- as with models of CPUs -----------------------------------------------------------

    def test_every_scenario_ends_as_with_models_of_cpus(self):
        files = sorted(glob.glob(os.path.join(SCENARIOS, '*.yaml')))
        self.assertGreaterEqual(len(files), 40)
        refused = []
        for file in files:
            done = self.ctl('scenario', 'run', '--virtual', '--scenario-cpus', file, '--json')
            if done.returncode == 2:
                self.assertIn('not with real programs', done.stderr)
                refused.append(os.path.basename(file))
                continue
            with self.subTest(os.path.basename(file)):
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                run = json.loads(done.stdout)[0]
                self.assertEqual(run['not_repeatable'], '')
                self.assertEqual(self.ended(run), self.ended(self.sim(file)))
        self.assertEqual(refused, [])

    @staticmethod
    def nodes():
        """A ring whose ids are not their places."""
        return [{'id': 7, 'name': 'one'}, {'id': 3, 'name': 'two', 'inputs': {'0': {'to': 'three', 'factor': 3}}},
                {'id': 200, 'name': 'three', 'pins': {'3': 'notify'}}, {'id': 0, 'name': 'four'}]

    def test_nodes_are_known_by_name_whatever_their_ids(self):
        file = self.scenario('''steps:
  - do: {send: {name: there, from: one, to: three, size: 64, count: 3}}
  - do: {send: {name: pulled, from: two, input: 0}}
  - when: {taken: there, at_least: 3, at_most: 3}
    within: 1ms
  - when: {taken: pulled, at_least: 1, at_most: 1}
    within: 1ms
  - do: {cut: three -> four}
  - when: {located: three -> four}
    within: 500ms
  - do: {heal: three -> four}
  - when: {node: all, is: up, ring_size: 4}
    within: 500ms
''', self.nodes())
        run = self.play(file)
        self.assertEqual(self.results(run), self.results(self.sim(file)))

    def test_a_hung_cpu_takes_nothing_and_takes_it_when_it_goes_on(self):
        self.play(self.scenario('''steps:
  - do: {hang: two}
  - do: {send: {name: x, from: one, to: two, size: 64, count: 5}}
  - when: {results: x, are: delivered, at_least: 5}
    within: 1ms
  - after: 100ms
    when: {taken: x, at_most: 0}
    within: 0s
  - do: {resume: two}
  - when: {taken: x, at_least: 5, at_most: 5}
    within: 1ms
''', self.nodes()))

    def test_a_hung_cpu_that_is_made_slow_lets_time_go_on(self):
        file = self.write('story.yaml', """scenario: a hung CPU is slow
nodes: 2
steps:
  - do: {send: {name: s, from: all, to: all, size: 200, every: 7ms, count: 100}}
  - at: 21ms
    do: {hang: node1}
  - at: 177ms
    do: {slow: node1 every=20ms}
  - at: 677ms
    do: {resume: all}
  - when: {node: all, is: up, ring_size: 2}
    within: 1s
""")
        self.play(file, '--scenario-cpus')

    def test_the_supervisor_acts_in_all_three_ways(self):
        file = os.path.join(SCENARIOS, '40-supervisor-resets-a-hung-knee.yaml')
        for way in ('--sim', '--virtual', '--live'):
            done = self.ctl('scenario', 'run', way, file)
            self.assertEqual(done.returncode, 0, way + done.stdout + done.stderr)

    # ---- repeatable -----------------------------------------------------------------------

    def test_faults_of_what_is_not_there_are_judged_alike_in_all_three_ways(self):
        cpu_runs = '  - {when: {cpu: node1, is: running}, within: 700ms}\n'
        stories = {
            'a CPU crashes while it boots':
                '  - {at: 10ms, do: {reset: node1}}\n  - {after: 5ms, do: {crash: node1}}\n'
                '  - {after: 200ms}\n' + cpu_runs,
            'a CPU has crashed already':
                '  - {at: 10ms, do: {crash: node1}}\n  - {after: 5ms, do: {crash: node1}}\n'
                '  - {after: 5ms, do: {hang: node1}}\n'
                '  - {after: 200ms, do: {resume: node1}}\n' + cpu_runs,
            'a node is dead':
                '  - {at: 10ms, do: {kill: node1}}\n' +
                ''.join('  - {after: 5ms, do: {%s}}\n' % fault for fault in
                        ('hang: node1', 'crash: node1', 'reset: node1', 'resume: node1', 'not_reading: node1',
                         'slow: node1 every=1ms', 'babble: node1 every=1ms', 'drop: node1 -> node2 packets=1')) +
                '  - {after: 200ms, do: {start: node1}}\n'
                '  - {when: {node: all, is: up, ring_size: 3}, within: 700ms}\n' + cpu_runs,
            'a node is frozen':
                '  - {at: 10ms, do: {freeze: node1}}\n  - {after: 5ms, do: {hang: node1}}\n'
                '  - {after: 5ms, do: {drop: node1 -> node2 packets=1}}\n  - {after: 50ms, do: {thaw: node1}}\n'
                '  - {when: {cpu: node1, is: silent}, within: 1s}\n  - {do: {resume: node1}}\n' + cpu_runs,
        }
        for name, steps in stories.items():
            file = self.write('story.yaml', 'scenario: %s\nnodes: 3\nsteps:\n%s' % (name, steps))
            for way in ('--sim', '--virtual', '--live'):
                done = self.ctl('scenario', 'run', way, file)
                self.assertEqual(done.returncode, 0, way + done.stdout + done.stderr)

    def test_every_fault_of_a_node_or_a_cpu_changes_something_and_ends_on_all_stages(self):
        file, = glob.glob(os.path.join(SCENARIOS, '41-*.yaml'))
        with open(file) as story:
            played = re.findall(r'do: {(\w+):', story.read())
        words = re.findall(r'(?m)^  (\w+) +\S', self.ctl('fault', '--help').stdout.split('list  ')[0])
        of_lines = 'cut heal drop corrupt truncate duplicate reorder delay rate stall flap'.split()
        self.assertEqual(set(words) - set(of_lines) - set(played), {'step_clock'}, 'which cannot be done live')
        for way in ('--sim', '--virtual', '--live'):
            done = self.ctl('scenario', 'run', way, file)
            self.assertEqual(done.returncode, 0, way + done.stdout + done.stderr)

    def test_clocks_are_set_under_the_virtual_clock_only(self):
        file, = glob.glob(os.path.join(SCENARIOS, '42-*.yaml'))
        for way in ('--sim', '--virtual'):
            done = self.ctl('scenario', 'run', way, file)
            self.assertEqual(done.returncode, 0, way + done.stdout + done.stderr)
        done = self.ctl('scenario', 'run', '--live', file)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertIn('step_clock', done.stderr)
        self.assertIn('live, the clocks are those of the machine', done.stderr)

    def racing(self, steps):
        """A scenario of CPUs that share files, which fails if a CPU finds not what it expects. @param steps of each, as racing_cpu takes them"""
        shared = os.path.join(self.folder, 'shared')
        os.makedirs(shared, exist_ok=True)
        nodes = [{'id': id, 'name': 'node%d' % id, 'cpu': {'command': [os.path.join(CPUS, 'racing_cpu'), shared, *mine.split()]}}
                 for id, mine in enumerate(steps)]
        fails = ', '.join('{cpu: node%d, is: running, boots: 2}' % id for id in range(len(nodes)))
        return self.scenario('steps: [{at: 4s}]\nnever: [%s]\n' % fails, nodes)

    def test_a_race_of_two_programs_is_found_by_an_order_and_again_by_the_same_one(self):
        for name, steps in RACES.items():
            with self.subTest(name):
                file = self.racing(steps)
                done = self.ctl('scenario', 'run', '--virtual', file, '--orders', 50)
                self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
                order = int(re.search(r'again with --order (\d+)\n', done.stdout).group(1))
                self.assertLessEqual(order, 50)
                runs = [self.play(file, '--order', str(order), code=1) for _ in range(2)]
                self.assertEqual({run['order'] for run in runs}, {order})
                self.assertEqual(runs[0]['trace_hash'], runs[1]['trace_hash'])
                self.assertTrue(self.hidden_by_an_order(file), 'fails in every order, so it is not a race')

    def test_orders_end_with_the_last_one(self):
        done = self.ctl('scenario', 'run', '--virtual', self.racing(RACES['the last one wins']), '--order', 999_999, '--orders', 3)
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn('3: there are only 2 from --order 999999 on, up to 1000000', done.stderr)

    def hidden_by_an_order(self, file):
        return any(json.loads(self.ctl('scenario', 'run', '--virtual', file, '--json', '--order', order).stdout)[0]['met']
                   for order in range(1, 51))

    def test_the_same_trace_on_one_core_on_all_and_beside_busy_processes(self):
        nodes = self.nodes()
        nodes[0].update(cpu={'command': ['limb_firmware'], 'turnaround': '20us', 'jitter': '30us'}, joints=[{'name': 'knee'}])
        file = self.scenario(STREAMS, nodes)
        first = self.play(file)
        self.assertEqual(first['not_repeatable'], '')
        one_core = ('taskset', '-c', str(min(os.sched_getaffinity(0))))
        runs = [self.play(file), self.play(file, prefix=one_core)]
        self.keep_cores_busy()
        runs.append(self.play(file))
        for run in runs:
            self.assertEqual((run['trace_hash'], self.said(run)), (first['trace_hash'], self.said(first)))
        self.assertNotEqual(self.play(file, '--seed', '2')['trace_hash'], first['trace_hash'])

    # ---- own programs ---------------------------------------------------------------------

    def own(self, program, **cpu):
        nodes = self.nodes()
        path = os.path.join(CPUS, program)
        nodes[1]['cpu'] = dict(cpu, command=[path if os.path.exists(path) else program])
        return nodes

    def test_a_program_that_sticks_is_named_with_its_instant_and_reset(self):
        nodes = self.nodes()
        nodes[1].update(cpu={'command': ['limb_firmware', '--hang-after', '0.5s'], 'alive_period': '50ms'},
                        joints=[{'name': 'knee'}])
        file = self.scenario('''steps:
  - when: {cpu: two, is: silent, boots: 1}
    within: 1s
  - when: {cpu: two, is: running, boots: 2}
    within: 500ms
''', nodes, supervisor={'policy': 'auto', 'grace': '100ms', 'backoff': '50ms'}, timeouts={'beacon': '50ms'},
            virtual={'stall': '1s'})
        runs = [self.play(file) for _ in range(2)]
        for run in runs:
            self.assertRegex(self.said(run), r'two: its CPU, limb_firmware, does not answer')
            self.assertIn(('cpu_does_not_answer', 'two'), self.events(run))
            self.assertIn('a CPU was stuck', run['not_repeatable'])
        self.assertEqual(self.said(runs[0]), self.said(runs[1]))

    def test_a_program_that_ends_is_seen_at_its_instant(self):
        run = self.play(self.scenario('''steps:
  - when: {cpu: two, is: failed}
    within: 1s
  - when: {cpu: two, is: running, boots: 2}
    within: 200ms
''', self.own('short_lived_cpu')))
        self.assertIn('two: its CPU has ended: exit 3', self.said(run))
        self.assertIn(('cpu_ended', 'two'), self.events(run))

    def test_a_program_that_answers_late_misses_its_limit(self):
        steps = '''steps:
  - do: {send: {name: question, from: one, to: two, size: 16}}
  - when: {counter: received_data, of: one, at_least: 1}
    within: 1ms
'''
        nodes = self.own('echo_cpu')
        self.play(self.scenario(steps, nodes))
        nodes[1]['cpu']['turnaround'] = '2ms'
        run = self.play(self.scenario(steps, nodes), code=1)
        self.assertIn('within 1ms', run['expected'])

    # ---- the end --------------------------------------------------------------------------

    def started(self):
        return self.started_by_runs('scenario_cpu')

    def test_interrupted_or_killed_nothing_is_left(self):
        file = self.scenario('steps: [{at: 1ms, do: {hang: one}}, {after: 3600s}, {after: 3600s}]\nnever: [{node: one, is: down}]\n', self.nodes())
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            run = self.start('run', [ring_process.program('ringctl'), 'scenario', 'run', '--virtual', file])
            self.wait('a hung CPU', lambda: 'T' in [ring_process.process_state(pid) for pid in self.started()])
            run.send_signal(number)
            code = self.wait_exit(run)
            self.wait('all gone', lambda: not self.started())
            if number == signal.SIGKILL:
                continue
            self.assertEqual(code, 1)
            self.assertIn('interrupted', self.log_of(run))
            self.assertEqual(os.listdir(self.temporary), [])

    def test_an_interrupt_before_the_ring_is_there_is_reported(self):
        log, junit = os.path.join(self.folder, 'log'), os.path.join(self.folder, 'out.xml')
        os.mkfifo(log)   # whoever opens it waits for a reader: ringctl does so to see whether it can, and in the run
        run = self.start('run', [ring_process.program('ringctl'), 'scenario', 'run', '--virtual', '--log', log,
                                 '--junit', junit, self.scenario(NOTHING, self.nodes())])
        os.close(os.open(log, os.O_RDONLY))
        self.wait('the run has begun', lambda: os.listdir(self.temporary))
        run.send_signal(signal.SIGINT)
        reader = os.open(log, os.O_RDONLY | os.O_NONBLOCK)
        self.addCleanup(os.close, reader)
        self.assertEqual(self.wait_exit(run), 1)
        self.assertIn('interrupted', self.log_of(run))
        with open(junit) as report:
            self.assertIn('interrupted', report.read())
        self.assertEqual(os.listdir(self.temporary), [])

    # ---- wrong use ------------------------------------------------------------------------

    def test_wrong_usage_is_reported(self):
        file = self.scenario(NOTHING, self.nodes())
        for more, words in ((['--live'], '--live'), (['--sim'], '--sim'), (['--transport', 'udp'], '--live')):
            done = self.ctl('scenario', 'run', '--virtual', file, *more)
            self.assertEqual(done.returncode, 2, more)
            self.assertIn(words, done.stderr)
        done = self.ctl('scenario', 'run', '--scenario-cpus', file)
        self.assertEqual(done.returncode, 2)
        self.assertIn('--virtual', done.stderr)

    # ---- causes -----------------------------------------------------------------------------

    RACE = '''import os
import sys
sys.path[:0] = %r
from limb_ring import HostPort, Packet
FIRST, SECOND, WINDOW = %d, %d, %r
with HostPort.connect(role='cpu') as port:
    first_at = None
    while True:
        packet = port.receive(0.05)
        if not isinstance(packet, Packet):
            continue
        if packet.source == SECOND and first_at is not None and port.now() - first_at < WINDOW:
            os._exit(3)   # the planted race
        if packet.source == FIRST:
            first_at = port.now()
'''

    def race(self, first, second, apart):
        """A story of ten sends to `two` and two faults; its firmware ends if it hears `second` within 5 ms after `first`,
        and one pair of the sends is `apart` ms from each other."""
        nodes = ring_process.plain_nodes(4)
        numbers = {node['name']: node['id'] for node in nodes}
        firmware = self.write('race.py', self.RACE % (sys.path, numbers[first], numbers[second], 0.005))
        nodes[2]['cpu'] = {'command': [sys.executable, firmware], 'turnaround': '100us'}
        steps = [(20 + 20 * i, ('node0', 'node1', 'node3')[i % 3]) for i in range(8)] + [(200, first), (200 + apart, second)]
        text = 'steps:\n' + ''.join('  - at: %gms\n    do: {send: {name: s%d, from: %s, to: node2, size: 8}}\n'
                                   % (at, i, source) for i, (at, source) in enumerate(sorted(steps)))
        text += '  - at: 210ms\n    do: {drop: node0 -> node1 packets=1 for=5ms}\n  - at: 300ms\n'
        return self.scenario(text + 'never: [{cpu: node2, is: failed}]\n', nodes)

    def test_the_cause_of_a_race_in_firmware_is_the_planted_pair(self):
        file, page = self.race('node3', 'node0', 3), os.path.join(self.folder, 'cause.html')
        done = self.ctl('scenario', 'cause', '--virtual', file, '--html', page)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        needed = re.findall(r'^  event (\d+), at (\S+): (.*)', done.stdout, re.M)
        self.assertEqual([(at, re.search('from: (\\w+)', words).group(1)) for _, at, words in needed],
                         [('200ms', 'node3'), ('203ms', 'node0')], done.stdout)
        self.assertRegex(done.stdout, r'From event %s, at 203ms: .*\n      every future of 12 fails' % needed[1][0])
        self.assertIn('If events %s and %s change places, it does not fail.' % (needed[0][0], needed[1][0]), done.stdout)
        with open(page) as file:
            text = file.read()
        for number, _, words in needed:
            self.assertIn('needed: ' + words.replace('&', '&amp;').replace('>', '&gt;'), text)
        self.assertEqual(os.listdir(self.temporary), [], 'nothing is left')

    def test_a_story_that_holds_has_no_cause(self):
        done = self.ctl('scenario', 'cause', '--virtual', self.race('node3', 'node0', 6))
        self.assertEqual((done.returncode, done.stdout), (1, ''), done.stderr)
        self.assertIn('there is nothing to find', done.stderr)

    def test_a_program_that_is_not_there_is_reported_before_anything_starts(self):
        file = self.scenario(NOTHING, self.own('no_such_cpu'))
        done = self.ctl('scenario', 'run', '--virtual', file)
        self.assertEqual((done.returncode, done.stdout), (2, ''))
        self.assertRegex(done.stderr, "two: no program '.*no_such_cpu'")
        self.assertEqual(self.ctl('scenario', 'run', '--virtual', '--scenario-cpus', file).returncode, 0)

    def test_a_program_that_is_not_a_cpu_fails_the_start(self):
        nodes = self.nodes()
        nodes[2]['cpu'] = {'command': ['sleep', '1000']}
        file = self.scenario(NOTHING, nodes, timeouts={'cpu_boot': '2s'})
        run = self.play(file, code=1)
        self.assertIn('three: its CPU is failed: did not attach to the host port', run['seen'])


if __name__ == '__main__':
    ring_process.main()
