"""CPUs in lockstep with a virtual ring: the same programs, the same trace, whatever else the machine does."""

import os
import re
import signal
import subprocess
import sys

import ring_process
from ring_process import RingTest, plain_nodes

CPUS = os.environ.get('RING_TEST_CPUS', '')   # where the CPUs of these tests are
LEG = os.path.join(ring_process.CONFIG, 'leg8.yaml')


class Lockstep(RingTest):
    def run_for(self, seconds, config=LEG, prefix=(), pace='max', more=()):
        """Log of a virtual ring that has run for so many seconds of its time."""
        done = subprocess.run([*prefix, ring_process.program('ringd'), '--config', config, '--ring', self.ring,
                               '--clock', 'virtual', '--pace', pace, '--for', str(seconds), *more],
                              env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True, timeout=ring_process.GUARD)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout

    def trace_of(self, log):
        self.assertNotIn('not repeatable', log)
        return re.search(r'trace hash ([0-9a-f]{16}) of ', log).group(1)

    def compare_traces(self, *paths):
        return self.run_program('ring_sim', 'compare-traces', *paths)

    def test_the_same_trace_on_one_core_on_all_and_beside_busy_processes(self):
        first = self.trace_of(self.run_for(2))
        self.assertEqual(self.trace_of(self.run_for(2)), first)
        one_core = ('taskset', '-c', str(min(os.sched_getaffinity(0))))
        self.assertEqual(self.trace_of(self.run_for(2, prefix=one_core)), first, 'on one core')
        self.keep_cores_busy()
        self.assertEqual(self.trace_of(self.run_for(2)), first, 'beside busy processes')
        self.assertNotEqual(self.trace_of(self.run_for(2.2)), first)

    def test_sixteen_processes_that_all_talk_leave_one_trace_in_ten_runs(self):
        nodes = [dict(node, cpu={'command': [os.path.join(CPUS, 'talking_cpu')]}) for node in plain_nodes(16)]
        all_cores = sorted(os.sched_getaffinity(0))
        one_core = self.write_ring(nodes, realtime={'cores': all_cores[:1]})
        traces = [self.trace_of(self.run_for(0.2, one_core)) for _ in range(3)]
        free = self.write_ring(nodes, realtime={'cores': all_cores})
        traces += [self.trace_of(self.run_for(0.2, free)) for _ in range(3)]
        self.keep_cores_busy()
        traces += [self.trace_of(self.run_for(0.2, free)) for _ in range(4)]
        self.assertEqual(len(set(traces)), 1, traces)

    def test_the_ring_and_its_cpus_share_a_core_unless_the_configuration_names_others(self):
        all_cores = os.sched_getaffinity(0)
        for realtime, expected in ({}, 1), ({'cores': sorted(all_cores)}, len(all_cores)):
            config = self.write_ring([dict(node, cpu={'command': ['limb_firmware']}) for node in plain_nodes(2)],
                                     realtime=realtime)
            run = self.start('ring', [ring_process.program('ringd'), '--config', config, '--clock', 'virtual'])
            self.wait_closed(range(2))
            cpus = [node['cpu']['pid'] for node in self.ctl_json('--ring', self.ring, 'status')['nodes']]
            for pid in [run.pid, *cpus]:
                self.assertEqual(len(os.sched_getaffinity(pid)), expected)
            run.send_signal(signal.SIGTERM)
            self.assertEqual(self.wait_exit(run), 0)

    def test_a_program_that_sends_what_the_wall_clock_says_has_another_trace_each_time(self):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = {'command': [os.path.join(CPUS, 'wall_clock_cpu')]}
        config = self.write_ring(nodes)
        captures = [os.path.join(self.folder, 'a.pcapng'), os.path.join(self.folder, 'b.pcapng')]
        traces = [self.trace_of(self.run_for(1, config, more=('--capture', path))) for path in captures]
        self.assertNotEqual(*traces)
        done = self.compare_traces(*captures)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        same, *lines = done.stdout.splitlines()
        self.assertRegex(same, r'the first \d+ packets and events are the same, then they differ \(bytes from \d+\):')
        for path, line in zip(captures, lines):
            self.assertRegex(line, '^' + re.escape(path) + r'  \(000\.020\d+\)  node1 -> node2 +DATP +node1 -> node0 ')

    def test_a_capture_is_the_same_where_the_trace_is(self):
        captures = [os.path.join(self.folder, 'a.pcapng'), os.path.join(self.folder, 'b.pcapng')]
        for path in captures:
            self.run_for(0.5, more=('--capture', path))
        done = self.compare_traces(*captures)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r'^the same: [1-9]\d+ packets and events\n$')

    def test_compare_traces_says_what_it_cannot_read(self):
        for text, problem in (None, 'cannot be read'), ('no capture', 'no pcapng'):
            path = os.path.join(self.folder, 'x.pcapng') if text is None else self.write('y.pcapng', text)
            done = self.compare_traces(path, path)
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertIn(path, done.stderr)
            self.assertIn(problem, done.stderr)

    def test_a_cpu_that_loops_is_named_and_reset_and_the_ring_goes_on(self):
        nodes = plain_nodes(3)
        nodes[1].update(cpu={'command': ['limb_firmware', '--hang-after', '0.5s'], 'alive_period': '50ms'},
                        joints=[{'name': 'knee'}])
        nodes[2]['cpu'] = {'command': ['limb_firmware']}
        config = self.write_ring(nodes, timeouts={'beacon': '50ms'},
                                 supervisor={'policy': 'auto', 'grace': '100ms', 'backoff': '50ms'})
        logs = [self.run_for(1, config) for _ in range(2)]
        for log in logs:
            stuck = re.search(r"node1: its CPU \(limb_firmware, pid \d+\) is stuck at (\S+) s of the ring's time", log)
            # It booted at 20 ms.
            self.assertEqual(stuck.group(1), '0.520000000')
            self.assertIn('INT0 from node 0: reset', log)
            self.assertIn('boot 2', log)
            self.assertIn('not repeatable: a CPU was stuck', log)
        hashes = [re.search(r'trace hash (\S+)', log).group(1) for log in logs]
        self.assertEqual(hashes[0], hashes[1], 'it stuck, was found and reset at the same instants')

    def test_a_cpu_that_sleeps_in_its_loop_is_named_in_the_log_and_in_status(self):
        nodes = plain_nodes(3)
        sleeper = self.write('sleeper.py', '''
import time, limb_ring
with limb_ring.HostPort.connect(role='cpu') as port:
    while port.connected:
        time.sleep(0.02)
        port.receive(0.001)
''')
        nodes[1]['cpu'] = {'command': [sys.executable, sleeper]}
        nodes[2]['cpu'] = {'command': ['limb_firmware']}
        ring = self.start('ring', [ring_process.program('ringd'), '--config', self.write_ring(nodes), '--clock', 'virtual',
                                   '--pace', 'max'])
        told = r"its CPU \(python3[^)]*, pid \d+\) holds the ring's time: it slept for \d+ % of the last \d+ s"
        self.wait('the line in status', lambda: re.search('node1: ' + told, self.ctl('--ring', self.ring, 'status').stdout
                                                          .replace('\n', ' ')))
        self.assertEqual(len(re.findall('node1: ' + told, self.log_of(ring))), 1, 'logged once a minute')
        self.assertNotRegex(self.log_of(ring), 'node2: its CPU')

    def test_a_cpu_that_lets_no_time_pass_is_named_and_the_ring_goes_on(self):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = {'command': [os.path.join(CPUS, 'asking_cpu')]}
        config = self.write_ring(nodes)
        logs = [self.run_for(0.5, config) for _ in range(2)]
        named = re.findall(r"node1: its CPU \(asking_cpu, pid \d+\) lets no time pass at (\S+) s of the ring's time", logs[0])
        self.assertEqual(named, ['0.020000000'], logs[0])
        self.assertEqual(*map(self.trace_of, logs))

    def test_a_cpu_that_ends_does_so_at_an_instant_of_the_ring(self):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = {'command': [os.path.join(CPUS, 'short_lived_cpu')]}
        config = self.write_ring(nodes)
        logs = [self.run_for(2, config) for _ in range(3)]
        self.assertEqual(len({self.trace_of(log) for log in logs}), 1)
        self.assertIn('ended by itself: exit 3', logs[0])

    def test_a_cpu_that_sends_and_ends_leaves_one_trace_whichever_of_its_ends_is_seen_first(self):
        nodes = plain_nodes(3)
        traces = []
        for first in 'process', 'connection', 'either':
            nodes[1]['cpu'] = {'command': [os.path.join(CPUS, 'short_lived_cpu'), first]}
            log = self.run_for(0.6, self.write_ring(nodes))
            self.assertIn('ended by itself: exit 3', log)
            traces.append(self.trace_of(log))
        self.assertEqual(len(set(traces)), 1, traces)

    def test_what_others_do_to_a_cpu_makes_a_run_not_repeatable_and_looking_does_not(self):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = {'command': ['limb_firmware']}
        config = self.write_ring(nodes)
        for act, word in ((lambda pid: self.ctl_json('--ring', self.ring, 'status'), ''),
                          (lambda pid: self.ctl_json('--ring', self.ring, 'reset', 'node1'), 'changed something'),
                          (lambda pid: os.kill(pid, signal.SIGKILL), 'ended or was stopped while it waited'),
                          (lambda pid: os.kill(pid, signal.SIGSTOP), 'ended or was stopped while it waited')):
            run = self.start('ring', [ring_process.program('ringd'), '--config', config, '--ring', self.ring,
                                      '--clock', 'virtual'])
            act(self.wait_cpu(1, 'running')['pid'])
            if word.startswith('ended'):
                self.wait('it is missed', lambda: 'stopped by a signal' in self.log_of(run) or 'ended by itself' in self.log_of(run))
            run.send_signal(signal.SIGTERM)
            self.assertEqual(self.wait_exit(run), 0)
            self.assertIn(word, self.log_of(run))
            self.assertEqual('not repeatable' in self.log_of(run), word != '', self.log_of(run))

    def test_a_tool_that_sends_makes_a_run_not_repeatable(self):
        run = self.start('ring', [ring_process.program('ringd'), '--config', LEG, '--ring', self.ring,
                                  '--clock', 'virtual'])
        self.wait_closed(range(8))
        self.ctl_json('--ring', self.ring, 'send', '--from', '0', '--to', '2', '--data', 'x')
        run.send_signal(signal.SIGTERM)
        self.assertEqual(self.wait_exit(run), 0)
        self.assertIn('not repeatable: a program that the clock does not wait for', self.log_of(run))


if __name__ == '__main__':
    ring_process.main()
