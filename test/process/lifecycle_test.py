"""Daemons come, go, freeze, and the ring closes again by itself."""

import fcntl
import os
import select
import signal
import struct
import subprocess
import termios
import time

import ring_process
from ring_process import RingTest, plain_nodes
from limb_ring import Result


class Lifecycle(RingTest):
    def test_nodes_start_in_any_order_and_the_ring_closes(self):
        config = self.write_ring(plain_nodes(5))
        for node in (3, 0, 4):
            self.ringd(config, node)
        self.wait_closed([0, 3, 4])  # the others are bypassed
        for node in (1, 2):
            self.ringd(config, node)
        self.wait_closed(range(5))
        self.assertEqual(self.ctl_json('ping', '--from', 4, '--to', 3, '--count', 20)['delivered'], 20)

    def test_killed_node_is_bypassed_and_comes_back(self):
        daemons = self.start_ring(plain_nodes(4))
        boot = self.answered(2)['boot']
        daemons[2].kill()
        self.wait_closed([0, 1, 3])
        self.assertEqual(self.answered(1)['output']['to'], 3)
        self.ringd(os.path.join(self.folder, 'ring.yaml'), 2)
        self.wait_closed(range(4))
        self.assertGreater(self.answered(2)['boot'], boot)

    def test_sends_of_others_go_on_through_a_kill_with_one_result_each(self):
        daemons = self.start_ring(plain_nodes(4))
        port = self.port(0)
        tokens = [port.send(3, b'%d' % i) for i in range(32)]
        results = []
        for turn in range(400):  # 32 outstanding, one new for each that ended
            if turn == 100:
                daemons[1].kill()
            if turn == 300:
                self.ringd(os.path.join(self.folder, 'ring.yaml'), 1)
            results.append(port.next_of(Result))
            tokens.append(port.send(3, b'%d' % turn))
        self.wait_closed(range(4))
        results += [port.next_of(Result) for _ in range(32)]
        self.assertEqual(sorted(r.token for r in results), tokens)
        outcomes = {r.outcome for r in results}
        self.assertLessEqual(outcomes, {'delivered', 'lost', 'unconfirmed'})
        self.assertGreater(sum(r.outcome == 'delivered' for r in results), 300)
        self.assertEqual(port.wait(port.send(1, b'again')).outcome, 'delivered')

    def test_sends_to_a_dead_node_end_with_no_such_node(self):
        daemons = self.start_ring(plain_nodes(3))
        daemons[1].kill()
        self.wait_closed([0, 2])
        port = self.port(0)
        self.assertEqual(port.wait(port.send(1, b'hello')).outcome, 'no such node')
        self.assertEqual(port.wait(port.interrupt(1, 2)).outcome, 'no such node')

    def test_frozen_node_is_bypassed_and_comes_back_by_a_new_hello(self):
        daemons = self.start_ring(plain_nodes(4), timeouts={'silence': '200ms'})
        boot, hellos = self.answered(2)['boot'], self.counters(2)['hellos']
        daemons[2].send_signal(signal.SIGSTOP)
        self.wait_closed([0, 1, 3])
        self.assertEqual(self.ctl_json('ping', '--from', 0, '--to', 3, '--count', 50)['delivered'], 50)
        daemons[2].send_signal(signal.SIGCONT)
        self.wait_closed(range(4))
        self.assertGreater(self.answered(2)['boot'], boot)
        self.assertGreater(self.counters(2)['hellos'], hellos)
        self.assertEqual(self.ctl_json('ping', '--from', 0, '--to', 2, '--count', 50)['delivered'], 50)

    def test_all_killed_but_one_then_back(self):
        daemons = self.start_ring(plain_nodes(4))
        for node in (1, 2, 3):
            daemons[node].kill()
        self.wait('node 0 alone', lambda: self.answered(0)['state'] in ('alone', 'open_chain') or
                  self.answered(0)['ring_size'] == 1)
        for node in (3, 2, 1):
            self.ringd(os.path.join(self.folder, 'ring.yaml'), node)
        self.wait_closed(range(4))

    def test_signals_end_it_cleanly(self):
        self.addCleanup(signal.signal, signal.SIGHUP, signal.signal(signal.SIGHUP, signal.SIG_DFL))
        daemons = self.start_ring(plain_nodes(3))
        for node, number in enumerate((signal.SIGTERM, signal.SIGINT, signal.SIGHUP)):
            daemons[node].send_signal(number)
            self.assertEqual(self.wait_exit(daemons[node]), 0)
            left = [f for f in os.listdir(self.ring_folder()) if f.startswith((str(node), 'node%d' % node))]
            self.assertEqual(sorted(left), ['%d.boot' % node, '%d.lock' % node])  # its next process goes on from these

    def test_second_daemon_says_who_holds_the_node(self):
        daemons = self.start_ring(plain_nodes(2))
        second = self.run_ringd('--config', os.path.join(self.folder, 'ring.yaml'), '--node', 'node1')
        self.assertEqual(second.returncode, 1)
        self.assertIn('node 1 (node1)', second.stderr)
        self.assertIn('held by pid %d' % daemons[1].pid, second.stderr)
        self.assertTrue(self.is_closed([0, 1]))

    def test_log_that_nobody_reads_holds_nothing_up(self):
        config = self.write_ring(plain_nodes(2))
        unread = subprocess.Popen([ring_process.program('ringd'), '--config', config, '--node', '0'],
                                  env=self.environment, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.addCleanup(unread.stderr.close)
        self.addCleanup(unread.wait)
        self.addCleanup(unread.kill)
        self.ringd(config, 1)
        self.wait_closed([0, 1])
        port = self.port(1)
        pipe = unread.stderr.fileno()
        fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, 4096)
        full = waiting = 0
        while full < 40:  # turns of 0.05 s: some lines a second are let through, and for two seconds none had room
            held = struct.unpack('i', fcntl.ioctl(pipe, termios.FIONREAD, b'    '))[0]
            began = time.monotonic()
            while time.monotonic() < began + 0.05:
                self.assertEqual(port.wait(port.interrupt(0, 2)).outcome, 'delivered')
            full, waiting = (full + 1 if held == waiting > 0 else 0), held
        heard = b''
        while b'left out: standard error was not read' not in heard:  # it is told before the next line
            port.wait(port.interrupt(0, 2))
            if select.select([pipe], [], [], 0.01)[0]:
                heard += os.read(pipe, 4096)
        unread.terminate()
        self.assertEqual(self.wait_exit(unread), 0)

    def test_arguments_that_roslaunch_adds_are_passed_over(self):
        config = self.write_ring(plain_nodes(2))
        self.ringd(config, 0, '__name:=ringd_0', '__log:=' + self.folder + '/ros.log')
        self.ringd(config, 1)
        self.wait_closed([0, 1])


if __name__ == '__main__':
    ring_process.main()
