"""ringctl traffic and status --watch: the traffic of a ring, as its users see it."""

import json
import os
import pty
import select
import signal
import struct
import subprocess
import termios
import time

import ring_process
from ring_process import GUARD, RingTest, plain_nodes, process_state, program
from limb_ring import Result


class Looking(RingTest):
    def sends(self, source, to, data=b'look', priority=2):
        port = self.port(source)
        port.send(to, data, priority=priority)
        self.assertEqual(port.next_of(Result).outcome, 'delivered')
        port.close()

    def dump_until_done(self, *arguments):
        """A dump that ends by itself, beside packets that go on until it has."""
        dump = self.start('dump', [program('ringctl'), 'traffic', 'show'] + [str(a) for a in arguments])
        self.wait('the end of the dump', lambda: self.sends(1, 2) or dump.poll() is not None)
        self.assertEqual(dump.returncode, 0, self.log_of(dump))
        return self.log_of(dump)

    def capture(self, *arguments):
        path = os.path.join(self.folder, '%d.pcapng' % len(self.processes))
        self.dump_until_done('-w', path, *arguments)
        return path

    def rows(self, *arguments):
        done = self.ctl('traffic', 'show', '--json', *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return [json.loads(line) for line in done.stdout.splitlines()]


class Dump(Looking):
    def test_shows_every_packet_once_as_it_comes_into_the_supervisor(self):
        self.start_ring(plain_nodes(3))
        lines = self.dump_until_done('--kind', 'data', '-n', 3).splitlines()
        self.assertEqual(len(lines), 4, lines)
        for line in lines[:3]:
            for word in ('node2 -> node0', 'DATP', 'node1 -> node2', 'p2 user', '[  4]  6c 6f 6f 6b'):
                self.assertIn(word, line)
        self.assertIn('3 packets shown', lines[3])
        self.assertIn('0 lost', lines[3])

    def test_of_a_folded_ring_shows_each_packet_once_on_the_line_it_came_on(self):
        self.start_ring(plain_nodes(4), redundancy='foldback')
        self.assertEqual(self.ctl('fault', 'cut', 'node0:node1').returncode, 0)
        self.wait('folded', lambda: {self.answered(i)['state'] for i in range(4)} == {'folded'})
        for node, line in (('node1', 'node2 -> node1'), ('node2', 'node1 -> node2')):
            packets = self.dump_until_done(node, '--kind', 'data', '-n', 3, '--json').splitlines()[:3]
            numbers = [json.loads(packet)['sequence'] for packet in packets]
            self.assertEqual(numbers, [(numbers[0] + i) % 8 for i in range(3)])  # three bits: 0 comes after 7
            text = self.dump_until_done(node, '--kind', 'data', '-n', 1)
            self.assertIn(line, text)

    def test_ends_with_ctrl_c_and_says_what_it_saw(self):
        self.start_ring(plain_nodes(3))
        dump = self.start('dump', [program('ringctl'), 'traffic', 'show', 'node2', '-t', 'd', '-d'])
        self.wait('a beacon', lambda: 'beacon, boot' in self.log_of(dump))
        dump.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(dump), 0)
        self.assertIn(' shown of ', self.log_of(dump).splitlines()[-1])

    def test_of_all_goes_on_without_those_that_are_dead(self):
        self.start_ring(plain_nodes(4))
        self.assertEqual(self.ctl('fault', 'kill', 'node3').returncode, 0)
        said = self.dump_until_done('all', '--kind', 'data', '-n', 4)
        self.assertIn('node 3 (node3) is left out: ', said)
        self.assertIn('4 packets shown', said)
        self.assertEqual(self.ctl('traffic', 'show', 'node3').returncode, 3)
        self.assertIn('all: every node is meant', self.ctl('traffic', 'show', 'all', 'node1').stderr)

    def test_a_file_reads_back_as_what_was_seen(self):
        self.start_ring(plain_nodes(3))
        path = self.capture('node2', '--at', 'in,out', '--kind', 'data', '-n', 6)
        rows = self.rows('-r', path)
        self.assertEqual(len(rows), 6)
        self.assertEqual({(r['source'], r['destination'], r['data']) for r in rows},
                         {('node1', 'node2', '6c 6f 6f 6b')})
        self.assertEqual({tuple(r['line']) for r in rows}, {('node1', 'node2'), ('node2', 'node0')})
        self.assertEqual([r['time_ns'] for r in rows], sorted(r['time_ns'] for r in rows))
        self.assertEqual(len(self.rows('-r', path, '--at', 'out')), 3)
        self.assertEqual(self.rows('-r', path, '--from', 'node0'), [])
        text = self.ctl('traffic', 'show', '-r', path, '-t', 'z', '-n', 1).stdout
        self.assertTrue(text.startswith('(000.000000000)  node1 -> node2'), text)

    def test_events_are_shown_and_written(self):
        daemons = self.start_ring(plain_nodes(3))
        path = os.path.join(self.folder, 'events.pcapng')
        writer = self.start('writer', [program('ringctl'), 'traffic', 'show', 'node0', '-w', path])
        shower = self.start('shower', [program('ringctl'), 'traffic', 'show', 'node0', '-e'])
        self.wait('a packet', lambda: 'DATP' in self.log_of(shower))
        self.wait('it in the file', lambda: os.path.exists(path) and os.path.getsize(path) > 1000)
        daemons[1].kill()
        self.wait('the lost neighbour', lambda: '* node0: output' in self.log_of(shower))
        self.wait('it in the file', lambda: any('event' in row for row in self.rows('-e', '-r', path)))
        for process in (writer, shower):
            process.send_signal(signal.SIGINT)
            self.assertEqual(self.wait_exit(process), 0)

    def test_of_other_peoples_files_says_that_nothing_is_ours_and_reads_standard_input(self):
        def block(kind, body):
            return struct.pack('<II', kind, len(body) + 12) + body + struct.pack('<I', len(body) + 12)

        foreign = (block(0x0A0D0D0A, struct.pack('<IHHq', 0x1A2B3C4D, 1, 0, -1)) +
                   block(1, struct.pack('<HHIHHB3x', 1, 0, 65535, 9, 1, 0xA0)) +
                   block(6, struct.pack('<IIIII', 0, 0, 1, 4, 4) + b'abcd'))
        path = os.path.join(self.folder, 'foreign.pcapng')
        with open(path, 'wb') as file:
            file.write(foreign)
        with open(path, 'rb') as file:
            done = self.ctl('traffic', 'show', '-r', '-', stdin=file)
        self.assertEqual(done.returncode, 2)
        self.assertIn('standard input: no packet of this protocol; skipped 1 of 1', done.stderr)

    def test_ends_silently_if_nobody_reads_its_output(self):
        self.start_ring(plain_nodes(2))
        dump = subprocess.Popen([program('ringctl'), '--ring', self.ring, 'traffic', 'show', 'all'], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, env=self.environment)
        self.processes.append(('dump', dump))
        dump.log = os.devnull
        dump.stdout.readline()
        dump.stdout.close()
        self.wait_exit(dump)
        self.assertEqual(dump.stderr.read(), b'')
        dump.stderr.close()

    def test_counts_are_printed_even_if_the_daemon_dies_or_the_file_is_damaged(self):
        daemons = self.start_ring(plain_nodes(3))
        path = os.path.join(self.folder, 'dies.pcapng')
        dump = self.start('dump', [program('ringctl'), 'traffic', 'show', 'node0', '-n', '100000', '-w', path])
        self.wait('some packets', lambda: os.path.exists(path) and os.path.getsize(path) > 2000)
        daemons[0].kill()
        self.assertEqual(self.wait_exit(dump), 3)
        said = self.log_of(dump).splitlines()
        self.assertRegex(said[-2], r'^ringctl: [1-9]\d* packets shown of [1-9]')
        self.assertIn('no daemon is left', said[-1])
        with open(path, 'ab') as file:
            file.write(b'\6\0\0\0' + b'\7\0\0\0' * 2)  # a block of 7 bytes
        done = self.ctl('traffic', 'show', '-r', path)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertRegex(done.stderr.splitlines()[-2], r'^ringctl: [1-9]\d* packets shown of ')

    def test_of_a_fifo_says_what_it_waits_for_and_ends_with_ctrl_c(self):
        fifo = os.path.join(self.folder, 'fifo')
        os.mkfifo(fifo)
        dump = self.start('dump', [program('ringctl'), 'traffic', 'show', '-r', fifo])
        self.wait('it says so', lambda: fifo + ' is a FIFO: waiting for' in self.log_of(dump))
        dump.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(dump), -signal.SIGINT)

    def test_wrong_arguments_and_files_are_named(self):
        self.start_ring(plain_nodes(2))
        bad = os.path.join(self.folder, 'bad.pcapng')
        with open(bad, 'w') as file:
            file.write('this is text')
        for arguments, words in ((['nobody'], ['nobody', '0 (node0)']),
                                 (['--from', 'nobody'], ['nobody', 'node1']),
                                 (['--kind', 'rain'], ['rain', 'interrupt']),
                                 (['-t', 'x'], ['-t']),
                                 (['-r', bad], [bad, 'pcapng']),
                                 (['-r', bad + '2'], [bad + '2', 'No such file']),
                                 (['-w', '/nowhere/x'], ['/nowhere/x'])):
            done = self.ctl('traffic', 'show', *arguments)
            self.assertEqual(done.returncode, 2, arguments)
            for word in words:
                self.assertIn(word, done.stderr)
        self.assertEqual(self.ctl('--ring', 'none', 'traffic', 'show').returncode, 3)


class Replay(Looking):
    def test_counts_and_the_node_are_printed_if_its_daemon_dies(self):
        daemons = self.start_ring(plain_nodes(3))
        path = self.capture('node0', '--kind', 'data', '-n', 20)
        before = self.counters(1)['ended_delivered']
        replay = self.start('replay', [program('ringctl'), 'traffic', 'again', path, '--loop', '1000000'])
        self.wait('some to arrive', lambda: self.counters(1)['ended_delivered'] > before + 20)
        daemons[1].kill()
        self.assertEqual(self.wait_exit(replay), 3)
        said = self.log_of(replay)
        self.assertRegex(said, r'sent [1-9]\d*, .*delivered [1-9]')
        self.assertIn('node 1 (node1) of ring %s: ' % self.ring, said.splitlines()[-1])

    def test_sends_again_what_was_captured(self):
        self.start_ring(plain_nodes(3))
        path = self.capture('node0', '--kind', 'data,control', '-n', 20)
        data = sum(row.get('channel') == 0 for row in self.rows('-r', path))
        before = self.counters(1)['ended_delivered']
        report = self.ctl_json('traffic', 'again', path, '--speed', 5, '--loop', 2)
        self.assertEqual(report['sent'], 2 * data)
        self.assertEqual(report['outcomes'], {'delivered': 2 * data})
        self.assertEqual(report['left_out']['control'], 20 - data)
        self.assertEqual(self.counters(1)['ended_delivered'] - before, 2 * data)

    def test_says_why_something_was_not_delivered(self):
        nodes = plain_nodes(3)
        nodes[0]['cpu'] = 'attached'
        self.start_ring(nodes, timeouts={'refused': '50ms'})
        path = os.path.join(self.folder, 'refused.pcapng')
        dump = self.start('dump', [program('ringctl'), 'traffic', 'show', 'node0', '--kind', 'data', '-n', '1', '-w', path])
        port = self.port(2)
        self.wait('the end of the dump', lambda: port.wait(port.send(0, b'x'), GUARD) and dump.poll() is not None)
        report = self.ctl_json('traffic', 'again', path, code=1)
        self.assertEqual(report['outcomes'], {'refused': 1})
        self.assertEqual(report['reasons'], {'probably no CPU is there (by its last beacon)': 1})
        self.assertIn('\n  1: probably no CPU is there', self.ctl('traffic', 'again', path).stdout)

    def test_of_a_file_of_all_lines_takes_each_packet_once(self):
        self.start_ring(plain_nodes(3))
        path = self.capture('all', '--at', 'in,out', '--kind', 'data', '-n', 18)
        report = self.ctl_json('traffic', 'again', path)
        self.assertEqual(report['sent'] + report['left_out']['on_other_lines'], 18)
        self.assertLessEqual(report['sent'], 4)

    def test_needs_a_ring_that_has_the_sources_and_something_to_send(self):
        self.start_ring(plain_nodes(3))
        path = self.capture('node0', '--kind', 'data', '-n', 1)
        control = self.capture('node0', '--kind', 'control', '-n', 1)
        self.assertEqual(self.ctl('traffic', 'again', control).returncode, 1)
        self.assertEqual(self.ctl('--ring', 'none', 'traffic', 'again', path).returncode, 3)


class LargeCapture(RingTest):
    def test_what_reads_it_says_so_meanwhile(self):
        whole = os.path.join(self.folder, 'whole.pcapng')
        made = self.run_program('ring_sim', 'run', '--nodes', 2, '--outputs', '--capture', whole)
        self.assertEqual(made.returncode, 0, made.stderr)
        slow = os.path.join(self.folder, 'slow.pcapng')
        os.mkfifo(slow)
        with open(whole, 'rb') as file:
            packets = file.read()
        for command in ('why', 'again'):
            reads = self.start(command, [program('ringctl'), 'traffic', command, slow])
            with open(slow, 'wb', buffering=0) as file:
                file.write(packets)
                self.wait('progress', lambda: 'ringctl: reading %s ...\n' % slow in self.log_of(reads))
            self.wait_exit(reads)


class Top(Looking):
    def test_once_gives_rates_of_every_line(self):
        self.start_ring(plain_nodes(3))
        top = self.start('top', [program('ringctl'), 'status', '--watch', '--once', '--json', '--interval', '0.5'])
        self.wait('the end of top', lambda: self.sends(1, 2) or top.poll() is not None)
        nodes = json.loads(self.log_of(top))['nodes']
        self.assertEqual([node['state'] for node in nodes], ['up'] * 3)
        for node in nodes:
            self.assertGreater(node['packets_per_second'], 0)
            self.assertGreater(node['bytes_per_second'], 12 * node['packets_per_second'])
            self.assertIsNone(node['load'], 'the lines have no rate')

    def test_fits_a_terminal_and_shows_a_node_that_is_down(self):
        daemons = self.start_ring(plain_nodes(4))
        daemons[3].kill()
        self.wait_closed(range(3))
        lines = self.ctl('status', '--watch', '--once', '--interval', '0.1').stdout.splitlines()
        self.assertEqual(len(lines), 7)
        self.assertLessEqual(max(len(line) for line in lines), 80)
        self.assertIn('3 of 4 nodes up', lines[0])
        self.assertIn('down', lines[5])
        self.assertRegex(lines[6], r'^round trips of the last \d+ s$')

    def test_redraws_until_q_and_leaves_the_terminal_as_it_was(self):
        self.start_ring(plain_nodes(2))
        for ending in ('q', 'signal'):
            terminal, inside = pty.openpty()
            before = termios.tcgetattr(inside)
            top = subprocess.Popen([program('ringctl'), 'status', '--watch', '--interval', '0.1'], stdin=inside,
                                   stdout=inside, stderr=inside, env=self.environment,
                                   preexec_fn=os.setpgrp)  # as a shell starts it: it can be stopped
            self.processes.append(('top', top))
            top.log = os.devnull
            seen = self.read_until(terminal, lambda text: text.count('2 of 2 nodes up') >= 2)
            self.assertNotEqual(termios.tcgetattr(inside), before)
            self.assertEqual(termios.tcgetattr(inside)[6][termios.VSUSP], b'\0', 'Ctrl-Z is a key')
            os.write(terminal, b'\x1a')
            self.wait('it is stopped', lambda: process_state(top.pid) == 'T')
            self.assertEqual(termios.tcgetattr(inside), before)
            top.send_signal(signal.SIGCONT)
            self.wait('it goes on', lambda: termios.tcgetattr(inside) != before)
            os.write(terminal, b'q') if ending == 'q' else top.send_signal(signal.SIGINT)
            seen += self.read_until(terminal, lambda text: '\033[?1049l' in text)
            self.assertEqual(self.wait_exit(top), 0)
            self.assertEqual(termios.tcgetattr(inside), before)
            self.assertIn('\033[?25h', seen)
            os.close(terminal)
            os.close(inside)

    def test_the_first_picture_has_no_rates_since_nothing_was_read_before(self):
        self.start_ring(plain_nodes(2))
        terminal, inside = pty.openpty()
        top = subprocess.Popen([program('ringctl'), 'status', '--watch', '--interval', '3600'], stdin=inside, stdout=inside,
                               stderr=inside, env=dict(self.environment, NO_COLOR='1'))
        self.processes.append(('top', top))
        top.log = os.devnull
        seen = self.read_until(terminal, lambda text: 'q ends' in text)
        os.write(terminal, b'q')
        self.assertEqual(self.wait_exit(top), 0)
        for node in 0, 1:
            self.assertRegex(seen, r'node%d +up +none +%d +- +- +- ' % (node, 1 - node))
        os.close(terminal)
        os.close(inside)

    def read_until(self, terminal, enough):
        text, deadline = '', time.monotonic() + GUARD
        while not enough(text):
            ready, _, _ = select.select([terminal], [], [], max(0, deadline - time.monotonic()))
            self.assertTrue(ready, text)
            text += os.read(terminal, 65536).decode()
        return text

    def test_wants_a_terminal_unless_once(self):
        self.start_ring(plain_nodes(2))
        done = self.ctl('status', '--watch')
        self.assertEqual(done.returncode, 2)
        self.assertIn('--once', done.stderr)
        self.assertEqual(self.ctl('status', '--watch', '--json').returncode, 2)


if __name__ == '__main__':
    ring_process.main()
