"""The ring's supervisor: it finds a hung CPU by the beacons, and under policy auto has it reset."""

import os
import signal

import ring_process
from ring_process import RingTest, is_gone, plain_nodes, process_state
from limb_ring import Observed

# Short enough to wait for, long enough for a CPU that a busy machine lets wait.
ALIVE = '300ms'
QUICK = {'grace': '1s', 'tries': 2, 'backoff': '100ms'}


def watched_limbs(*nodes_with_limb, count=3):
    nodes = plain_nodes(count)
    for node in nodes_with_limb:
        nodes[node]['cpu'] = {'command': ['limb_firmware'], 'alive_period': ALIVE}
    return nodes


class Supervisor(RingTest):
    def watched(self, node, supervisor=0):
        row = self.row(supervisor)
        return next((cpu for cpu in row['supervisor']['watched'] if cpu['id'] == node), None) if row else None

    def wait_watched(self, node, what, condition, supervisor=0):
        def found():
            cpu = self.watched(node, supervisor)
            return cpu and condition(cpu) and cpu
        return self.wait(what, found)

    def wait_verdict(self, node, verdict, supervisor=0):
        return self.wait_watched(node, 'CPU of node %d %s' % (node, verdict),
                                 lambda cpu: cpu['verdict'] == verdict, supervisor)

    def hang(self, node):
        pid = self.wait_cpu(node, 'running')['pid']
        os.kill(pid, signal.SIGSTOP)
        self.wait('CPU stopped or killed', lambda: process_state(pid) == 'T' or is_gone(pid))
        return pid

    def next_finding(self, observer, verdict):
        """Of the supervisor; on a busy machine it may have found something else before."""
        while True:
            what = observer.next_of(Observed).content
            if what['verdict'] == verdict:
                return what

    def test_hung_cpu_is_reset_while_others_lose_nothing(self):
        daemons = self.start_ring(watched_limbs(1), supervisor=dict(QUICK, policy='auto'))
        boots = self.wait_cpu(1, 'running')['boots']
        self.wait_verdict(1, 'alive')
        ping = self.port(0)
        observer = self.port(0)
        observer.observe('watchdog')
        run = ping.request({'do': 'ping', 'to': 2, 'count': 3000, 'interval_us': 200})
        old = self.hang(1)
        cured = self.wait_watched(1, 'a confirmed reset', lambda cpu: cpu['confirmed'] == 1)
        self.assertEqual((cured['verdict'], cured['hangs'], cured['resets']), ('alive', 1, 1))
        self.assertIn('silent for', cured['reset_reason'])
        told = [self.next_finding(observer, 'hung') for _ in range(2)]
        self.assertEqual([what['id'] for what in told], [1, 1])
        self.assertRegex(told[1]['what'], 'reset 1 of 2 ordered')
        cpu = self.wait_cpu(1, 'running')
        self.assertEqual((cpu['boots'], cpu['resets'], cpu['last_reset']), (boots + 1, 1, 'INT0 from node 0'))
        self.assertTrue(is_gone(old))
        done = ping.answer(run, timeout=ring_process.GUARD)
        self.assertEqual((done['sent'], done['delivered']), (3000, 3000))
        log = self.log_of(daemons[0])
        for verdict in ('hung: silent for', 'hung: reset 1 of 2 ordered', 'alive: reset confirmed'):
            self.assertEqual(log.count('CPU of node 1 (node1) ' + verdict), 1, log)

    def test_supervisor_watches_its_own_cpu(self):
        self.start_ring(watched_limbs(0), supervisor=dict(QUICK, policy='auto'))
        self.wait_verdict(0, 'alive')
        self.hang(0)
        self.wait_watched(0, 'a confirmed reset', lambda cpu: cpu['confirmed'] == 1)

    def test_policy_report_shows_the_hung_cpu_and_leaves_it_alone(self):
        self.start_ring(watched_limbs(1, 2), supervisor=QUICK)
        for node in (1, 2):
            self.wait_verdict(node, 'alive')
        old = self.hang(1)
        self.wait_verdict(1, 'hung')
        text = self.ctl('status').stdout
        self.assertRegex(text, r'(?m)^ *1 +node1 +up .* hung ')
        self.assertRegex(text, r'supervisor node0, policy report:\n  node1: hung for .* 1 hang, 0 resets by it')
        rows = self.ctl_json('status')['nodes']
        self.assertEqual([row['cpu'].get('verdict') for row in rows], [None, 'hung', 'alive'])
        self.assertEqual(process_state(old), 'T')
        os.kill(old, signal.SIGCONT)
        self.wait_verdict(1, 'alive')

    def test_dead_node_is_no_hung_cpu(self):
        daemons = self.start_ring(watched_limbs(1, 2), supervisor=dict(QUICK, policy='auto', node='node2'))
        for node in (1, 2):
            self.wait_verdict(node, 'alive', supervisor=2)
        daemons[1].kill()
        cpu = self.wait_verdict(1, 'unreachable', supervisor=2)
        self.assertEqual((cpu['hangs'], cpu['resets']), (0, 0))
        self.assertNotIn('supervisor', self.answered(0))


if __name__ == '__main__':
    ring_process.main()
