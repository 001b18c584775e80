"""ringctl up and down."""

import os
import signal

import ring_process
from ring_process import RingTest, plain_nodes


class UpDown(RingTest):
    def up(self, *arguments):
        done = self.ctl('--ring', self.ring, 'up', *arguments, '--detach', '--timeout', 60)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_detached_twice(self):
        for _ in range(2):
            self.up('--nodes', 3)
            self.assertTrue(self.is_closed(range(3)))
            again = self.ctl('--ring', self.ring, 'up', '--nodes', 3, '--detach')
            self.assertEqual(again.returncode, 1)
            self.assertIn('running already', again.stderr)
            self.assertTrue(self.is_closed(range(3)))
            self.assertEqual(self.ctl('down', self.ring).returncode, 0)
            self.assertFalse(os.path.exists(self.ring_folder()))
        self.assertEqual(self.ctl('down', self.ring).returncode, 3)

    def test_down_ends_frozen_daemons_too(self):
        self.up('--nodes', 3)
        os.kill(self.row(1)['pid'], signal.SIGSTOP)
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)
        self.assertFalse(os.path.exists(self.ring_folder()))

    def test_in_the_foreground_until_a_signal(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            up = self.start('up', [ring_process.program('ringctl'), '--ring', self.ring, 'up', '--nodes', '3'])
            self.wait('said so', lambda: 'closed' in self.log_of(up))
            pids = [self.row(node)['pid'] for node in range(3)]
            up.send_signal(number)
            self.assertEqual(self.wait_exit(up), 0)
            self.assertTrue(all(ring_process.is_gone(pid) for pid in pids))

    def test_daemons_die_with_a_foreground_up_that_is_killed(self):
        up = self.start('up', [ring_process.program('ringctl'), '--ring', self.ring, 'up', '--nodes', '3'])
        self.wait('said so', lambda: 'closed' in self.log_of(up))
        pids = [self.row(node)['pid'] for node in range(3)]
        up.kill()
        self.wait('daemons gone', lambda: all(ring_process.is_gone(pid) for pid in pids))

    def test_cpu_program_that_does_not_exist_fails_and_leaves_nothing(self):
        nodes = plain_nodes(3)
        nodes[2]['cpu'] = {'command': ['no_such_program']}
        up = self.ctl('up', self.write_ring(nodes), '--detach', '--timeout', 5)
        self.assertEqual(up.returncode, 1)
        self.assertIn('no_such_program', up.stderr)
        self.assertIn('node2', up.stderr)
        self.assertEqual(self.ctl('--ring', self.ring, 'status').returncode, 3)
        self.assertEqual(list(self._lock_holders()), [])

    def test_two_rings_at_once_have_to_be_named(self):
        first, second = self.ring, self.ring + 'b'
        self.up('--nodes', 2)
        self.assertEqual(self.ctl_json('status')['ring'], first)
        self.ring = second
        self.up('--nodes', 3)
        unnamed = self.ctl('status')
        self.assertEqual(unnamed.returncode, 2)
        self.assertIn(first + ', ' + second, unnamed.stderr)
        self.assertEqual(len(self.ctl_json('--ring', second, 'status')['nodes']), 3)
        self.assertEqual(self.ctl('down', second).returncode, 0)
        self.assertEqual(self.ctl('down').returncode, 0)

    def test_ring_of_64_nodes(self):
        self.up(self.write_ring(plain_nodes(64)))
        self.assertEqual(self.ctl_json('ping', '--from', 0, '--to', 63, '--count', 50)['delivered'], 50)
        self.assertEqual(self.ctl_json('ping', '--from', 'node63', '--to', 'node0')['delivered'], 10)
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)


if __name__ == '__main__':
    ring_process.main()
