"""A node's CPU: reset whatever state it is in, restarted, never left behind."""

import os
import signal
import subprocess
import sys

import ring_process
from ring_process import RingTest, is_gone, plain_nodes
from limb_ring import HostPortError, Packet

EXAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'examples')


def limb_at(node, count=3):
    nodes = plain_nodes(count)
    nodes[node]['cpu'] = {'command': ['limb_firmware']}
    return nodes


class Log(RingTest):
    def test_each_change_of_the_cpu_is_told_once(self):
        daemons = self.start_ring(limb_at(1))
        self.wait_cpu(1, 'running')
        self.wait('said so', lambda: 'CPU running' in self.log_of(daemons[1]))
        told = [line.split('] ')[1] for line in self.log_of(daemons[1]).splitlines() if '] CPU ' in line]
        self.assertEqual([line.split()[1] for line in told], ['booting', 'running'], told)


class Attached(RingTest):
    def test_a_cpu_that_has_ended_makes_room_even_if_a_process_that_it_forked_lives_on(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = 'attached'
        self.start_ring(nodes)
        holds, told = os.pipe()
        first = os.fork()
        if first == 0:
            try:
                port = self.port(1, role='cpu')   # named: it stays open
                if os.fork() == 0:
                    os.close(told)
                    os.read(holds, 1)   # until the test is over
                os._exit(0 if port.connected else 1)
            finally:
                os._exit(1)
        self.addCleanup(os.close, told)
        self.assertEqual(os.waitpid(first, 0)[1], 0)
        self.assertTrue(self.port(1, role='cpu').connected)


class Reset(RingTest):
    def hang(self, node):
        pid = self.wait_cpu(node, 'running')['pid']
        self.stop_process(pid)
        return pid

    def test_hung_cpu_is_reset_while_others_lose_nothing(self):
        self.start_ring(limb_at(1))
        old = self.hang(1)
        silent = self.wait_cpu(1, 'silent')
        ping = self.port(0)
        run = ping.request({'do': 'ping', 'to': 2, 'count': 3000, 'interval_us': 200})
        reset = self.ctl_json('reset', 'node1', '--from', 2, '--timeout', 30)
        self.assertTrue(reset['success'], reset)
        self.assertEqual(reset['boots'], silent['boots'] + 1)
        cpu = self.wait_cpu(1, 'running')
        self.assertNotEqual(cpu['pid'], old)
        self.assertEqual(cpu['boots'], silent['boots'] + 1)
        self.assertTrue(is_gone(old))
        done = ping.answer(run, timeout=ring_process.GUARD)
        self.assertEqual((done['sent'], done['delivered']), (3000, 3000))

    def test_interrupt_packet_alone_resets_a_hung_cpu(self):
        self.start_ring(limb_at(2))
        boots, old = self.wait_cpu(2, 'running')['boots'], self.hang(2)
        self.ctl_json('interrupt', '--from', 0, '--to', 'node2', 0)
        self.wait('a new CPU', lambda: self.answered(2)['cpu']['boots'] == boots + 1)
        self.assertNotEqual(self.answered(2)['cpu']['pid'], old)

    def test_reset_of_a_node_itself_goes_round(self):
        self.start_ring(limb_at(0))
        self.wait_cpu(0, 'running')
        self.assertTrue(self.ctl_json('reset', 0, '--from', 0, '--timeout', 30)['success'])

    def test_a_reset_is_not_judged_by_the_interrupt_of_an_earlier_one_that_has_timed_out(self):
        nodes = limb_at(1, count=4)
        nodes[3]['cpu'] = 'attached'
        daemons = self.start_ring(nodes)
        self.wait_cpu(1, 'running')
        daemons[3].kill()
        self.wait_closed(range(3))
        self.assertEqual(self.ctl('fault', 'delay', 'node0:node1', '--delay', '300ms').returncode, 0)
        port = self.port(0)
        late = port.ask({'do': 'reset', 'node': 'node3', 'timeout_ms': 1})
        self.assertEqual(late['effect'], 'unknown', late)
        reset = port.ask({'do': 'reset', 'node': 'node1', 'timeout_ms': 60000}, timeout=ring_process.GUARD)
        self.assertTrue(reset['success'], reset)

    def test_a_reset_of_a_node_without_a_cpu_says_so(self):
        self.start_ring(plain_nodes(2))
        self.assert_refused('node node1 has no CPU to reset', self.port(0), {'do': 'reset', 'node': 'node1'})
        for command in (['reset', 'node1'], ['fault', 'reset', 'node1']):
            done = self.ctl(*command)
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertRegex(done.stderr, 'no CPU')

    def test_an_example_that_is_given_something_else_than_ring_and_node_says_what_it_takes(self):
        for example in 'echo_cpu', 'joint_cpu':
            for program in ([ring_process.program(example)], [sys.executable, os.path.join(EXAMPLES, example + '.py')]):
                for words in (['--help'], [self.ring]):
                    done = subprocess.run(program + words, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                          universal_newlines=True, timeout=ring_process.GUARD)
                    self.assertEqual(done.returncode, 2)
                    self.assertRegex(done.stderr, r'^usage: %s(\.py)? \[RING NODE\]\n$' % example)

    def test_attached_cpu_that_nobody_restarts_is_reported_as_such(self):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = 'attached'
        self.start_ring(nodes)
        cpu = self.start('cpu', [ring_process.program('echo_cpu'), self.ring, '1'])
        self.wait_cpu(1, 'running')
        self.wait('beacon of the CPU', lambda: any(
            peer['id'] == 1 and peer['cpu_state'] == 'running' for peer in self.answered(0)['heard']))
        reset = self.ctl_json('reset', 1, '--from', 0, code=1)
        self.assertIn('nobody restarts it', reset['message'])
        self.assertEqual(self.wait_exit(cpu), -signal.SIGKILL)

    def test_reset_clears_what_waited_for_the_old_cpu(self):
        self.start_ring(limb_at(1), limits={'receive_buffers': 4})
        self.hang(1)
        port = self.port(0)
        taken = 0
        while port.wait(port.send(1, b'stale')).outcome == 'delivered':
            taken += 1
        self.assertIn(taken, range(4, 13))  # 4 in the buffers, and what the CPU had asked for before, at most 8
        self.assertEqual(self.answered(1)['waiting'], 4)
        self.assertTrue(self.ctl_json('reset', 1, '--from', 0, '--timeout', 30)['success'])
        row = self.answered(1)
        self.assertEqual(row['counters']['flushed_on_reset'], 4)
        self.assertEqual(row['waiting'], 0)


class Children(RingTest):
    def test_child_that_exits_is_restarted(self):
        self.start_ring(limb_at(1))
        first = self.wait_cpu(1, 'running')
        self.ctl_json('send', '--from', 0, '--to', 1, '--data', 'exit 7')
        cpu = self.wait('a second boot', lambda: (lambda c: c['boots'] == 2 and c)(self.answered(1)['cpu']))
        self.assertNotEqual(cpu['pid'], first['pid'])
        self.assertEqual(cpu['exits'], 1)
        self.assertIn('7', cpu['last_exit'])

    def test_child_that_must_not_be_restarted_stays_failed(self):
        nodes = limb_at(1)
        nodes[1]['cpu']['restart_on_exit'] = False
        self.start_ring(nodes)
        self.wait_cpu(1, 'running')
        self.ctl_json('send', '--from', 0, '--to', 1, '--data', 'exit 3')
        self.assertEqual(self.wait_cpu(1, 'failed')['boots'], 1)
        self.assertTrue(self.ctl_json('reset', 1, '--timeout', 30)['success'])

    def test_children_die_with_a_daemon_that_is_killed(self):
        for stopped in (False, True):
            with self.subTest(stopped=stopped):
                self.ring += 'k'
                daemons = self.start_ring(limb_at(1))
                pid = self.wait_cpu(1, 'running')['pid']
                if stopped:
                    self.stop_process(pid)
                daemons[1].kill()
                self.wait('CPU gone', lambda: is_gone(pid))

    def test_children_die_with_a_daemon_that_is_ended(self):
        daemons = self.start_ring(limb_at(1))
        pid = self.wait_cpu(1, 'running')['pid']
        self.stop_process(pid)
        daemons[1].terminate()
        self.assertEqual(self.wait_exit(daemons[1]), 0)
        self.assertTrue(is_gone(pid))

    def test_unknown_program_fails_with_the_reason_and_the_relay_goes_on(self):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = {'command': ['no_such_program', '--at', 'all']}
        self.start_ring(nodes)
        cpu = self.wait_cpu(1, 'failed')
        self.assertIn("no program 'no_such_program'", cpu['last_exit'])
        self.assertEqual(self.ctl_json('ping', '--from', 0, '--to', 2)['delivered'], 10)
        reset = self.ctl_json('reset', 1, '--timeout', 0.5, code=1)
        self.assertFalse(reset['success'])

    def test_program_that_never_attaches_counts_as_failed_boots(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = {'command': ['sleep', '1000']}
        self.start_ring(nodes, timeouts={'cpu_boot': '50ms'})
        self.wait('two failed boots', lambda: self.answered(1)['cpu']['failed_boots'] >= 2)
        self.assertIn('did not attach', self.answered(1)['cpu']['last_exit'])


class Presence(RingTest):
    def test_absent_cpu_refuses(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = 'attached'
        self.start_ring(nodes, timeouts={'refused': '50ms'})
        self.assertEqual(self.answered(1)['cpu']['state'], 'absent')
        sent = self.ctl_json('send', '--from', 0, '--to', 1, '--size', 8, code=1)
        self.assertEqual(sent['results'][0]['outcome'], 'refused')
        self.assertGreater(self.counters(1)['refused_cpu_absent'], 1)

    def test_node_without_cpu_reads_and_counts(self):
        self.start_ring(plain_nodes(2))
        before = self.answered(1)
        self.assertEqual(before['cpu']['state'], 'none')
        self.ctl_json('send', '--from', 0, '--to', 1, '--size', 512, '--count', 100)
        after = self.answered(1)
        self.assertEqual(after['received'] - before['received'], 100)
        self.assertEqual(after['waiting'], 0)

    def test_second_cpu_is_refused_and_the_first_goes_on(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = 'attached'
        self.start_ring(nodes)
        cpu = self.port(1, role='cpu')
        with self.assertRaises(HostPortError) as refused:
            self.port(1, role='cpu')
        self.assertIn('CPU', str(refused.exception))
        self.ctl_json('send', '--from', 0, '--to', 1, '--data', 'still here')
        self.assertEqual(cpu.next_of(Packet).data, b'still here')


if __name__ == '__main__':
    ring_process.main()
