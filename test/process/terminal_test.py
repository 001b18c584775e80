"""ringctl as people at a terminal use it: ping, send, wait, what is wrong in plain words, 80 columns."""

import fcntl
import json
import os
import pty
import re
import select
import signal
import struct
import subprocess
import termios
import time

import ring_process
from ring_process import GUARD, RingTest, plain_nodes, program

CLI_INTERNALS = ('FAILED', 'TEXT', 'UINT', 'INT in', 'CLI::', '{')


def catches(process, number):
    """The program has set its handler for that signal."""
    with open('/proc/%d/status' % process.pid) as status:
        caught, = re.findall(r'^SigCgt:\s*(\w+)', status.read(), re.MULTILINE)
    return int(caught, 16) >> number - 1 & 1


class Ping(RingTest):
    def test_tells_of_each_packet_and_of_all_at_the_end(self):
        self.start_ring(plain_nodes(3))
        done = self.ctl('ping', 'node2', '--from', 'node0', '-c', 3, '-i', '1ms')
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = done.stdout.splitlines()
        self.assertEqual(lines[0], 'PING 2 (node2) from 0 (node0): 512 bytes of data')
        for number in (1, 2, 3):
            self.assertRegex(lines[number], r'^512 bytes to 2 \(node2\): seq=%d time=[0-9.]+ us$' % number)
        self.assertEqual(lines[5], '--- node2 ping statistics ---')
        self.assertRegex(lines[6], r'^3 sent, 3 delivered, [0-9.]+ s$')
        self.assertRegex(lines[7], r'^round trip min/p50/p99/max = ([0-9.]+/){3}[0-9.]+ us$')

    def test_prints_its_statistics_at_ctrl_c(self):
        self.start_ring(plain_nodes(2))
        for more in ([], ['-q'], ['--json', '-c', '1000000']):
            ping = self.start('ping', [program('ringctl'), 'ping', 'node1', '--from', 'node0', '-i', '1ms'] + more)
            before = self.counters(0)['sent_data']
            self.wait('some packets', lambda: self.counters(0)['sent_data'] > before + 20)
            ping.send_signal(signal.SIGINT)
            self.assertEqual(self.wait_exit(ping), 1 if '--json' in more else 0)  # not all of the million
            said = self.log_of(ping)
            if '--json' in more:
                self.assertGreater(json.loads(said)['delivered'], 10)
            else:
                self.assertRegex(said, r'--- node1 ping statistics ---\n\d+ sent, \d+ delivered')
            self.assertEqual('seq=' in said, more == [])

    def test_says_how_a_packet_ended_that_was_not_delivered(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = 'attached'  # absent: refuses
        self.start_ring(nodes, timeouts={'refused': '20ms', 'queue': '20ms'})
        done = self.ctl('ping', 'node1', '--from', 'node0', '-c', 1)
        self.assertEqual(done.returncode, 1)
        self.assertIn('1 (node1): seq=1 refused', done.stdout)
        self.assertIn('1 sent, 0 delivered, 1 refused', done.stdout)

    def test_sends_nothing_more_to_a_daemon_that_has_ended(self):
        daemons = self.start_ring(plain_nodes(2))
        ping = self.start('ping', [program('ringctl'), 'ping', 'node1', '--from', 'node0', '-i', '1s'])
        self.wait('a packet', lambda: 'seq=1' in self.log_of(ping))
        daemons[0].kill()
        self.assertEqual(self.wait_exit(ping), 3)
        sent, delivered = re.search(r'(\d+) sent, (\d+) delivered, [0-9.]+ s\n', self.log_of(ping)).groups()
        self.assertEqual(sent, delivered)

    def test_ends_after_its_time(self):
        self.start_ring(plain_nodes(2))
        self.assertEqual(self.ctl('ping', 'node1', '-q', '-w', '50ms', '-i', '1ms').returncode, 0)

    def test_ends_after_its_time_even_if_its_daemon_is_frozen(self):
        daemons = self.start_ring(plain_nodes(2))
        ping = self.start('ping', [program('ringctl'), 'ping', 'node1', '--from', 'node0', '-q', '-w', '5s', '-i', '1ms'])
        before = self.counters(0)['sent_data']
        self.wait('some packets', lambda: self.counters(0)['sent_data'] > before + 100)
        daemons[0].send_signal(signal.SIGSTOP)
        self.assertEqual(self.wait_exit(ping), 3, self.log_of(ping))
        self.assertRegex(self.log_of(ping), r'sent, \d+ delivered, 1 not ended')
        self.assertIn('node 0 (node0) of ring %s: no result' % self.ring, self.log_of(ping))

    def test_ends_if_its_daemon_is_frozen(self):
        daemons = self.start_ring(plain_nodes(2))
        for command in (['ping', 'node1', '--from', 'node0', '-q', '-i', '1ms'],
                        ['send', '--from', 'node0', '--to', 'node1', '--data', 'x', '-c', '100000', '-i', '1ms']):
            with self.subTest(command=command[0]):
                sender = self.start(command[0], [program('ringctl')] + command)
                before = self.counters(0)['sent_data']
                self.wait('some packets', lambda: self.counters(0)['sent_data'] > before + 100)
                daemons[0].send_signal(signal.SIGSTOP)
                self.assertEqual(self.wait_exit(sender), 3, self.log_of(sender))
                self.assertIn('node 0 (node0) of ring %s: no result within 2 s: its daemon is frozen' % self.ring,
                              self.log_of(sender))
                daemons[0].send_signal(signal.SIGCONT)
                self.wait_closed([0, 1])


class Send(RingTest):
    def test_at_an_interval_until_all_are_sent_or_ctrl_c(self):
        self.start_ring(plain_nodes(2))
        arguments = ['send', '--from', '0', '--to', '1', '--data', 'x', '--interval', '1ms']
        self.assertEqual(self.ctl(*arguments, '--count', 20).stdout, '20 delivered\n')
        send = self.start('send', [program('ringctl')] + arguments + ['--count', '1e6'])
        before = self.counters(0)['sent_data']
        self.wait('some packets', lambda: self.counters(0)['sent_data'] > before + 5)
        send.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(send), 1)
        self.assertRegex(self.log_of(send), r'\d+ delivered')

    def test_channels_have_names(self):
        self.start_ring(plain_nodes(2))
        log = os.path.join(self.folder, 'all.pcapng')
        dump = self.start('dump', [program('ringctl'), 'traffic', 'show', 'node1', '-w', log, '-n', '1', '--channel', 'joint'])
        self.wait('captured', lambda: self.ctl('send', '--from', 0, '--to', 1, '--channel', 'joint', '--data', 'hi !')
                  .returncode == 0 and dump.poll() is not None)
        self.assertRegex(self.ctl('traffic', 'show', '-r', log, '-a').stdout, r" joint .*68 69 20 21  'hi !'")


class Dump(RingTest):
    def test_log_is_named_by_date(self):
        self.start_ring(plain_nodes(2))
        done = self.ctl('traffic', 'show', '-l', '-n', 1, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        name = re.search(r'writing (traffic-[-0-9]+_\d{6}\.pcapng)', done.stderr).group(1)
        self.assertGreater(os.path.getsize(os.path.join(self.folder, name)), 0)


class Wait(RingTest):
    def test_for_the_whole_ring(self):
        daemons = self.start_ring(plain_nodes(3))
        self.assertEqual(self.ctl('wait', 'up').returncode, 0)
        daemons[1].kill()
        self.wait_exit(daemons[1])
        done = self.ctl('wait', 'up', '--timeout', 0)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r'node \d \(node\d\): it')

    def test_for_one_node(self):
        daemons = self.start_ring(plain_nodes(3))
        self.assertEqual(self.ctl('wait', 'node1', 'up').returncode, 0)
        waiting = self.start('wait', [program('ringctl'), 'wait', 'node1', 'down', '--timeout', '60s'])
        daemons[1].kill()
        self.assertEqual(self.wait_exit(waiting), 0)
        self.assertEqual(self.ctl('wait', '2', 'frozen', '--timeout', '1ms').returncode, 1)

    def test_for_a_ring_that_is_yet_to_come(self):
        waiting = self.start('wait', [program('ringctl'), '--ring', self.ring, 'wait', 'up', '--timeout', '60s'])
        self.start_ring(plain_nodes(2))
        self.assertEqual(self.wait_exit(waiting), 0)

    def test_refuses_what_it_cannot_wait_for(self):
        self.start_ring(plain_nodes(2))
        for arguments, said in ((('node1',), 'for which state of node1?'), (('nod1', 'up'), "did you mean 'node1'?"),
                                (('node1', 'upp'), "did you mean 'up'?")):
            done = self.ctl('wait', *arguments)
            self.assertEqual(done.returncode, 2)
            self.assertIn(said, done.stderr)


class FaultClear(RingTest):
    def test_returns_when_the_ring_is_whole_again(self):
        self.start_ring(plain_nodes(3), timeouts={'silence': '300ms', 'first_successor': '50ms', 'break_grace': '50ms', 'send': '100ms'})
        self.assertEqual(self.ctl('fault', 'cut', 'node0:node1').returncode, 0)
        self.wait('open', lambda: self.answered(2)['state'] == 'open_chain')
        done = self.ctl('fault', 'clear')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn('it is whole again: 3 nodes up', done.stdout)
        self.assertTrue(self.is_closed(range(3)))

    def test_or_says_what_it_still_lacks(self):
        daemons = self.start_ring(plain_nodes(3))
        daemons[2].kill()  # not by 'ringctl fault': nobody's to mend
        self.wait_closed([0, 1])
        done = self.ctl('fault', 'clear', '--timeout', '10ms')
        self.assertEqual(done.returncode, 1)
        self.assertIn('no faults are left', done.stdout)
        self.assertIn('not whole again: node 0 (node0): it knows a ring of 2 nodes, not 3', done.stderr)


class PlainWords(RingTest):
    def wrong(self, *arguments, code=2):
        done = self.ctl(*arguments)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        for inside in CLI_INTERNALS:
            self.assertNotIn(inside, done.stderr)
        return done.stderr

    def test_guesses_what_was_meant(self):
        self.start_ring(plain_nodes(2))
        self.assertIn("did you mean 'status'?", self.wrong('stauts'))
        self.assertIn("did you mean 'freeze'?", self.wrong('fault', 'freze', 'node1'))
        self.assertIn("did you mean 'node1'?", self.wrong('ping', 'noed1'))
        self.assertIn("did you mean 'node1'?", self.wrong('traffic', 'show', '--from', 'nod1'))
        self.assertIn("did you mean '--count'?", self.wrong('ping', 'node1', '--cuont', 3))

    def test_names_the_kinds_that_can_be_observed(self):
        self.start_ring(plain_nodes(2))
        self.assertIn('state, ring, link', self.wrong('traffic', 'events', 'node0', '--kinds', 'xx'))

    def test_of_values(self):
        self.start_ring(plain_nodes(2))
        self.assertIn("'x' is unknown; allowed: a, d, z", self.wrong('traffic', 'show', '-t', 'x'))
        self.assertIn("'1' is not allowed for 'for'; allowed: a time", self.wrong('fault', 'hang', 'node0', '--for', '1'))
        self.assertIn("'10MB/s' is not allowed for 'rate'", self.wrong('fault', 'rate', 'node0:node1', '--rate', '10MB/s'))

    def test_of_nothing_to_send(self):
        self.start_ring(plain_nodes(2))
        self.assertIn('nothing to send was given; --size, --data or --hex is needed', self.wrong('send', '--from', 0, '--to', 1))
        self.assertIn('only one thing', self.wrong('send', '--from', 0, '--to', 1, '--size', 4, '--data', 'x'))

    def test_numbers_as_people_write_them(self):
        self.start_ring(plain_nodes(2))
        for rate in ('1e9', '1G', '1Gbps', '100MBit/s'):
            done = self.ctl('fault', 'rate', 'node0:node1', '--rate', rate)
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.ctl('wait', 'up', '--timeout', '5e3ms').returncode, 0)

    def test_every_program_has_help_and_one_version(self):
        versions = set()
        for name in ('ringctl', 'ringd', 'ring_sim', 'limb_firmware'):
            for asked in (['--version'], ['help'], ['--help']):
                done = self.run_program(name, *asked)
                self.assertEqual((done.returncode, done.stderr), (0, ''), name)
                self.assertIn(name if asked == ['--version'] else '--version', done.stdout)
                versions.add(done.stdout.split()[1] if asked == ['--version'] else '')
        self.assertEqual(len(versions), 2)
        self.assertIn('--to', self.ctl('help', 'send').stdout)
        self.assertIn('A:B', self.ctl('help', 'fault', 'cut').stdout)

    def test_computing_commands_end_with_one_by_ctrl_c_as_their_help_says(self):
        plan = ['ring_sim', 'plan', os.path.join(ring_process.CONFIG, 'humanoid16.yaml'), '--simulate', '3600s']
        table = ['ring_sim', 'table']
        for command in (['compare_networks', '--nodes', '100'], plan, table):
            run = self.start(command[0], [program(command[0])] + command[1:])
            if command == table:   # it says what it is at when it is nearly over
                self.wait('it catches Ctrl-C', lambda: catches(run, signal.SIGINT))
            else:
                self.wait('it says what it is at', lambda: '...' in self.log_of(run))
            run.send_signal(signal.SIGINT)
            self.assertEqual(self.wait_exit(run), 1, command)
            self.assertIn(command[0] + ': interrupted', self.log_of(run))


class EightyColumns(RingTest):
    def shown(self, *arguments, **environment):
        """What stands on a terminal of 80 columns."""
        terminal, inside = pty.openpty()
        fcntl.ioctl(inside, termios.TIOCSWINSZ, struct.pack('HHHH', 24, 80, 0, 0))
        process = subprocess.Popen([program('ringctl')] + list(arguments), stdin=inside, stdout=inside, stderr=inside,
                                   env=dict(self.environment, **dict({'TERM': 'xterm'}, **environment)))
        os.close(inside)
        text, deadline = b'', time.monotonic() + GUARD
        while True:
            ready, _, _ = select.select([terminal], [], [], max(0, deadline - time.monotonic()))
            self.assertTrue(ready, text)
            try:
                more = os.read(terminal, 65536)
            except OSError:  # the other end is closed
                break
            if not more:
                break
            text += more
        os.close(terminal)
        self.assertEqual(process.wait(timeout=GUARD), 0, text)
        return text.decode().replace('\r\n', '\n')

    def test_are_enough_whatever_the_nodes_are_called(self):
        nodes = [{'id': 240 + i, 'name': 'a_joint_with_quite_a_long_name%02d' % i} for i in range(8)]
        self.start_ring(nodes)
        self.ctl('fault', 'cut', '240:241')
        self.wait('open', lambda: self.answered(243)['state'] == 'open_chain')
        for arguments in (('status',), ('status', '--watch', '--once', '--interval', '0.1')):
            plain = re.sub('\033\\[[0-9]*m', '', self.shown(*arguments))
            lines = plain.splitlines()
            self.assertLessEqual(max(len(line) for line in lines), 80, plain)
            self.assertIn('broken line', plain)
            rows = [line for line in lines if 'open_chain' in line]
            self.assertEqual(len(set(line.split('~')[1][:9] for line in rows)), 8, plain)
        for node in nodes:
            self.assertIn(node['name'], self.ctl('status').stdout)

    def test_have_colours_unless_nobody_wants_them(self):
        daemons = self.start_ring(plain_nodes(3))
        daemons[2].kill()
        self.wait_closed([0, 1])
        self.assertRegex(self.shown('status'), '\033\\[31m.*node2')
        self.assertNotIn('\033', self.shown('status', NO_COLOR='1'))
        self.assertNotIn('\033', self.ctl('status').stdout)

    def test_top_and_status_use_the_same_words(self):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = {'command': ['limb_firmware']}
        self.start_ring(nodes)
        self.wait_cpu(1, 'running')
        self.ctl('fault', 'hang', 'node1')
        os.kill(self.answered(2)['pid'], signal.SIGSTOP)
        self.wait('bypassed', lambda: self.answered(0)['ring_size'] == 2)
        status = self.ctl('status').stdout.splitlines()
        top = self.ctl('status', '--watch', '--once', '--interval', '0.1').stdout.splitlines()
        self.assertTrue(top[0].startswith(status[0]), (top[0], status[0]))
        for text in (status, top):
            self.assertRegex(text[3], 'node1 .* hung')
            self.assertRegex(text[4], 'node2 .*frozen')

    def test_top_waits_for_no_daemon_that_is_frozen(self):
        nodes = plain_nodes(20)
        daemons = self.start_ring(nodes)
        for node in range(2, 20):
            daemons[node].send_signal(signal.SIGSTOP)
        top = self.ctl('status', '--watch', '--once', '--interval', '0.1')  # two seconds for each of them, twice, would be too long
        self.assertEqual(top.returncode, 0, top.stderr)
        self.assertEqual(top.stdout.count('frozen'), 18)


if __name__ == '__main__':
    ring_process.main()
