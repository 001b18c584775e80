"""A node all of whose places for clients are taken."""

import os
import resource
import socket
import subprocess
import sys

import ring_process
from ring_process import RingTest, plain_nodes
from limb_ring import HostPortError

# Half of the 2 places and the 8 that are kept, for clients that say they only ask, and observe.
HOLD = '''
import socket, struct, sys
def frame(kind, body):
    return struct.pack('>IB', 1 + len(body), kind) + body
asks_only, all = 8, []
for _ in range(5):
    client = socket.socket(socket.AF_UNIX)
    client.connect(sys.argv[1])
    client.sendall(frame(1, struct.pack('>IHBBIIH', 0x4C524850, 3, 0, asks_only, 0, 0, 0)))
    assert client.recv(5)[4] == 0x81, 'not welcome'
    client.sendall(frame(6, b'{"kinds": ["state"]}'))
    all.append(client)
print('held', flush=True)
sys.stdin.read()
'''


class FullPort(RingTest):
    def fill(self, node):
        """Takes its two places, with clients that are not idle."""
        for _ in range(2):
            self.port(node).observe('state')

    def fill_kept_places(self, node):
        """Takes all places there are, also those that are kept for who only asks, for two processes: one that holds
        more than half of them makes room for others."""
        for _ in range(2):
            holder = subprocess.Popen([sys.executable, '-c', HOLD, self.socket_of(node)], stdin=subprocess.PIPE,
                                      stdout=subprocess.PIPE)
            self.addCleanup(holder.communicate)  # it ends with its input
            self.assertEqual(holder.stdout.readline(), b'held\n')

    def test_can_still_be_asked_and_stopped(self):
        self.start_ring(plain_nodes(3), limits={'clients': 2})
        for node in range(3):
            self.fill(node)
        status = self.ctl('--ring', self.ring, 'status')
        self.assertEqual(status.returncode, 0, status.stderr)
        self.assertNotIn('down', status.stdout)
        self.assertEqual(self.ctl('--ring', self.ring, 'wait', 'up').returncode, 0)
        stop = self.ctl('--ring', self.ring, 'stop')
        self.assertIn("the stop ended 'delivered'", stop.stdout, stop.stderr)

    def test_without_descriptors_says_so_and_accepts_clients_once_there_are_some(self):
        daemon = self.start_ring(plain_nodes(2))[1]
        limits = resource.prlimit(daemon.pid, resource.RLIMIT_NOFILE)
        descriptors = len(os.listdir('/proc/%d/fd' % daemon.pid))
        resource.prlimit(daemon.pid, resource.RLIMIT_NOFILE, (descriptors, limits[1]))
        for _ in range(20):
            client = socket.socket(socket.AF_UNIX)
            self.addCleanup(client.close)
            client.connect(self.socket_of(1))
        said = 'warning [%s/node1] no more tools or CPUs can connect: Too many open files' % self.ring
        self.wait('a word of it', lambda: said in self.log_of(daemon))
        resource.prlimit(daemon.pid, resource.RLIMIT_NOFILE, limits)
        self.assertEqual(self.port(1, timeout=ring_process.GUARD).ask({'do': 'status'})['id'], 1)

    def test_can_be_asked_from_python(self):
        self.start_ring(plain_nodes(2), limits={'clients': 2})
        self.fill(0)
        with self.assertRaisesRegex(HostPortError, 'has 2 clients already'):
            self.port(0)
        self.assertEqual(self.port(0, asks_only=True).ask({'do': 'status'})['id'], 0)

    def test_others_are_told_the_limit(self):
        self.start_ring(plain_nodes(2), limits={'clients': 2})
        self.fill(0)
        ping = self.ctl('--ring', self.ring, 'ping', '--from', 0, 1)
        self.assertEqual(ping.returncode, 3)
        self.assertIn('has 2 clients already (limits.clients)', ping.stderr)

    def test_takes_its_cpu_all_the_same(self):
        nodes = plain_nodes(2)
        nodes[0]['cpu'] = 'attached'
        self.start_ring(nodes, limits={'clients': 2})
        self.fill(0)
        self.port(0, role='cpu')

    def test_a_ring_of_which_no_daemon_can_be_asked_is_said_to_run(self):
        self.start_ring(plain_nodes(2), limits={'clients': 2})
        for node in range(2):
            self.fill_kept_places(node)
        for command in 'status', 'stop':
            done = self.ctl('--ring', self.ring, command)
            self.assertEqual(done.returncode, 3)
            self.assertRegex(done.stderr, 'ring %s runs, but no daemon of it answers: .* has 2 clients already'
                             % self.ring)

    def test_a_node_that_cannot_be_asked_is_not_shown_as_down(self):
        self.start_ring(plain_nodes(2), limits={'clients': 2})
        self.fill_kept_places(0)
        status = self.ctl('--ring', self.ring, 'status')
        self.assertEqual(status.returncode, 0, status.stderr)
        self.assertRegex(status.stdout, 'node0 +unanswered')
        self.assertRegex(status.stdout, r'no answer from node0: .*node 0 \(node0\) has 2 clients already')
        self.assertIn('1 of 2 nodes up; no answer from 1 node', status.stdout)
        wait = self.ctl('--ring', self.ring, 'wait', 'up', '--timeout', 0)
        self.assertEqual(wait.returncode, 1)
        self.assertIn('node 0 (node0): it has not answered: ', wait.stderr)
        top = self.ctl('--ring', self.ring, 'status', '--watch', '--once')
        self.assertRegex(top.stdout, 'node0 +unanswered', top.stderr)

    def test_a_stop_is_sent_from_another_node(self):
        self.start_ring(plain_nodes(2), limits={'clients': 2})
        self.fill_kept_places(0)
        stop = self.ctl('--ring', self.ring, 'stop')
        self.assertIn("the stop ended 'delivered'", stop.stdout, stop.stderr)


if __name__ == '__main__':
    ring_process.main()
