"""What is known of a reset, a stop and a send where the ring is open and nothing returns; stops latch and are shown."""

import os
import signal
import time

import ring_process
from ring_process import RingTest, plain_nodes


def limbs(count):
    nodes = plain_nodes(count)
    for node in nodes:
        node['cpu'] = {'command': ['limb_firmware']}
        node['joints'] = [{'name': 'joint%d' % node['id'], 'lower': -1, 'upper': 1, 'velocity': 1, 'effort': 1}]
    return nodes


class LimbRing(RingTest):
    def start_limbs(self):
        self.start_ring(limbs(4))
        for node in range(4):
            self.wait_cpu(node, 'running')

    def latched(self):
        return [self.answered(node)['cpu']['stop']['latched'] for node in range(4)]


class OpenChain(LimbRing):
    """node2, node3, node0, node1: the line from node1 to node2 is cut."""

    def setUp(self):
        super().setUp()
        self.start_limbs()
        self.assertEqual(self.ctl('fault', 'cut', 'node1:node2').returncode, 0)
        self.wait('an open chain', lambda: all(self.answered(node)['state'] == 'open_chain' for node in range(4)))

    def test_a_reset_down_the_chain_is_seen_by_a_beacon(self):
        boots = self.answered(1)['cpu']['boots']
        reset = self.ctl_json('reset', 'node1', '--from', 'node3', '--timeout', 30)
        self.assertEqual((reset['success'], reset['effect'], reset['outcome']), (True, 'seen', 'unconfirmed'))
        self.assertIn('done, seen by', reset['message'])
        self.assertEqual(self.answered(1)['cpu']['boots'], boots + 1)

    def test_a_reset_up_the_chain_reaches_nobody_and_says_so(self):
        reset = self.ctl_json('reset', 'node3', '--from', 'node0', code=1)
        self.assertEqual((reset['success'], reset['effect'], reset['reason_code']), (False, 'none', 'out_of_reach'))
        self.assertIn('not reached', reset['message'])
        self.assertIn('node2 reaches all others', reset['message'])

    def test_a_reset_of_the_first_node_of_the_chain_says_what_else_resets_it(self):
        reset = self.ctl_json('reset', 'node2', code=1)
        self.assertIn("'ringctl fault reset node2'", reset['message'])
        boots = self.answered(2)['cpu']['boots']
        self.assertEqual(self.ctl('fault', 'reset', 'node2').returncode, 0)
        self.wait('one boot more', lambda: self.answered(2)['cpu']['boots'] == boots + 1)

    def test_a_reset_from_anywhere_is_sent_from_where_it_arrives(self):
        self.assertTrue(self.ctl_json('reset', 'node3', '--timeout', 30)['success'])

    def test_status_counts_the_nodes_that_work(self):
        for command in (['status'], ['status', '--watch', '--once', '--interval', '0.1']):
            headline = self.ctl(*command).stdout.splitlines()[0]
            self.assertIn('4 of 4 nodes work, open chain: line node1 -> node2 broken', headline)

    def test_a_send_says_whether_it_may_have_arrived(self):
        may = self.ctl_json('send', '--from', 'node0', '--to', 'node1', '--data', 'x', code=4)['results'][0]
        self.assertEqual((may['outcome'], may['reason_code']), ('unconfirmed', 'open_chain'))
        self.assertIn('line node1 -> node2 is broken', may['reason'])
        never = self.ctl_json('send', '--from', 'node0', '--to', 'node3', '--data', 'x', code=1)['results'][0]
        self.assertEqual((never['outcome'], never['reason_code']), ('unconfirmed', 'out_of_reach'))

    def test_an_unconfirmed_stop_says_of_each_node_what_is_known(self):
        part = self.ctl('stop', '--from', 'node0')
        self.assertEqual(part.returncode, 1, part.stdout)
        self.assertIn("the stop ended 'unconfirmed': the ring is open", part.stdout)
        self.assertIn('2 of 4 stopped; not reached: node2, node3', part.stdout)
        whole = self.ctl_json('stop', '--from', 'node2')  # it is the first of the chain
        self.assertEqual([node['stop'] for node in whole['nodes']], ['stopped'] * 4)

    def test_a_stop_from_anywhere_reaches_all(self):
        stop = self.ctl_json('stop')
        self.assertEqual([node['stop'] for node in stop['nodes']], ['stopped'] * 4)
        self.assertEqual(stop['sent_from'], ['node0', 'node2'])
        self.assertEqual(self.latched(), [True] * 4)

    def test_a_stop_of_one_node_is_sent_from_where_it_arrives(self):
        stop = self.ctl('stop', 'node3')
        self.assertEqual(stop.returncode, 0, stop.stdout)
        self.assertIn('sent from node0, then node2\n1 of 1 stopped', stop.stdout)
        self.assertEqual(self.latched(), [False, False, False, True])

    def test_a_resume_is_sent_from_where_it_arrives_and_says_where_it_cannot(self):
        self.ctl_json('stop')
        resume = self.ctl('resume')
        self.assertEqual(resume.returncode, 1, resume.stdout)
        self.assertEqual(self.latched(), [False, False, True, False])  # no way leads to the first of the chain
        self.assertRegex(resume.stdout, "^node2: the resume ended 'unconfirmed': .* it was not reached .*; mend the line, or let "
                                        "its daemon restart its CPU: 'ringctl fault reset node2'\nresumed 3 of 4 nodes\n$")
        self.assertNotIn('restart', self.ctl('resume', 'node2', '--from', 'node0').stdout)  # the sender was not well chosen
        self.assertEqual(self.ctl('stop', 'node3').returncode, 0)
        self.assertEqual(self.ctl('resume', 'node3').stdout, 'resumed node3\n')
        self.assertEqual(self.ctl('fault', 'reset', 'node2').returncode, 0)
        self.wait('no stop is latched any more', lambda: self.latched() == [False] * 4)


class TwoParts(LimbRing):
    def test_stop_and_resume_reach_both_parts_of_a_folded_ring(self):
        self.start_ring(limbs(4), redundancy='foldback')
        for node in range(4):
            self.wait_cpu(node, 'running')
        for line in ('node0:node1', 'node1:node0', 'node2:node3', 'node3:node2'):
            self.assertEqual(self.ctl('fault', 'cut', line).returncode, 0)
        self.wait('two parts', lambda: all((self.answered(node)['state'], self.answered(node)['ring_size']) == ('folded', 2)
                                           for node in range(4)))
        stop = self.ctl_json('stop')
        self.assertEqual([node['stop'] for node in stop['nodes']], ['stopped'] * 4)
        self.assertEqual(self.ctl('resume').stdout, 'resumed 4 nodes\n')
        self.assertEqual(self.latched(), [False] * 4)


class Stop(LimbRing):
    def test_it_latches_and_is_shown_until_it_is_resumed(self):
        self.start_limbs()
        self.assertEqual(self.latched(), [False] * 4)
        self.assertIn('4 of 4 stopped', self.ctl('stop').stdout)
        self.assertEqual(self.latched(), [True] * 4)
        self.assertIn("stopped: all nodes; 'ringctl resume' ends it", self.ctl('status').stdout)
        top = self.ctl_json('status', '--watch', '--once', '--interval', '0.1')
        self.assertEqual([node['cpu'] for node in top['nodes']], ['stopped'] * 4)
        self.assertEqual(self.ctl('resume', 'node3').stdout, 'resumed node3\n')
        self.wait('node3 has resumed', lambda: self.latched() == [True, True, True, False])
        self.assertIn('stopped: node0, node1, node2;', self.ctl('status').stdout)
        self.assertEqual(self.ctl('resume').stdout, 'resumed 4 nodes\n')
        self.wait('all have resumed', lambda: self.latched() == [False] * 4)

    def test_a_resume_that_a_hung_cpu_reads_too_late_is_reported(self):
        self.start_limbs()
        self.ctl('stop')
        pid = self.answered(3)['cpu']['pid']
        self.stop_process(pid)
        late = self.ctl('resume', 'node3')
        self.assertEqual(late.returncode, 1, late.stdout)
        self.assertIn('node3: it is still stopped', late.stdout)
        rows = self.ctl_json('resume', code=1)['nodes']
        self.assertEqual([(row['name'], row['outcome'], row['stop_latched']) for row in rows],
                         [('node%d' % node, 'delivered', node == 3) for node in range(4)])
        time.sleep(1)   # as long as a resume is valid
        os.kill(pid, signal.SIGCONT)
        self.assertEqual(self.ctl('resume', 'node3').stdout, 'resumed node3\n')
        self.assertEqual(self.latched(), [False] * 4)

    def test_a_cpu_without_joints_is_resumed_too(self):
        nodes = limbs(4)
        del nodes[2]['joints']
        self.start_ring(nodes)
        for node in range(4):
            self.wait_cpu(node, 'running')
        self.assertIn('4 of 4 stopped', self.ctl('stop').stdout)
        self.assertEqual(self.ctl('resume').stdout, 'resumed 4 nodes\n')
        self.wait('all have resumed', lambda: self.latched() == [False] * 4)
        self.assertEqual(self.ctl('resume').stdout, 'resumed 3 nodes\n')  # those with joints, latched or not

    def test_a_node_that_it_did_not_reach_decides_the_exit_code(self):
        self.start_limbs()
        self.ctl('fault', 'freeze', 'node2')
        self.wait('node2 is bypassed', lambda: self.answered(0)['ring_size'] == 3)
        stop = self.ctl('stop')
        self.assertEqual(stop.returncode, 4, stop.stdout)
        self.assertIn('3 of 4 stopped; not known, the daemon does not answer: node2', stop.stdout)
        self.ctl('fault', 'thaw', 'node2')

    def test_a_cpu_that_hangs_is_not_known_to_be_stopped(self):
        self.start_limbs()
        self.stop_process(self.answered(3)['cpu']['pid'])
        stop = self.ctl('stop')
        self.assertEqual(stop.returncode, 4, stop.stdout)
        self.assertIn('3 of 4 stopped; told, but the CPU is silent and may not have stopped: node3', stop.stdout)

    def test_a_cpu_that_boots_is_not_known_to_be_stopped(self):
        nodes = limbs(4)
        nodes[3]['cpu'] = {'command': ['sleep', '1000']}  # it never says that it has booted
        self.start_ring(nodes)
        for node in range(3):
            self.wait_cpu(node, 'running')
        stop = self.ctl('stop')
        self.assertEqual(stop.returncode, 4, stop.stdout)
        self.assertIn('3 of 4 stopped; the CPU did not run, and comes up without the stop: node3', stop.stdout)

    def test_a_cpu_that_is_reset_has_nothing_latched(self):
        self.start_limbs()
        self.assertEqual(self.ctl('stop', 'node1').returncode, 0)
        self.assertEqual(self.latched(), [False, True, False, False])
        self.assertTrue(self.ctl_json('reset', 'node1', '--from', 0, '--timeout', 30)['success'])
        self.assertEqual(self.latched(), [False] * 4)

    def test_only_the_cpu_itself_says_that_it_has_stopped(self):
        self.start_limbs()
        self.assert_refused("only the node's CPU may|no request", self.port(0), {'do': 'stop_latched', 'latched': True})

    def test_a_cpu_that_never_latches_a_stop_says_so_and_the_next_one_may(self):
        nodes = limbs(4)
        nodes[3]['cpu'] = 'attached'
        self.start_ring(nodes)
        cpu = self.port(3, role='cpu')
        self.assert_refused('allowed: true, false, "never"', cpu, {'do': 'stop_latched', 'latched': 'no'})
        cpu.ask({'do': 'stop_latched', 'latched': 'never'})
        self.assertFalse(self.answered(3)['cpu']['stop']['latches'])
        stop = self.ctl('stop', 'node3')
        self.assertEqual(stop.returncode, 0, stop.stdout)
        self.assertIn('told, and never stops: node3', stop.stdout)
        cpu.close()
        self.wait('the CPU to be gone', lambda: self.answered(3)['cpu']['stop']['latches'])


class Reasons(RingTest):
    def test_a_refusal_has_the_reason_that_its_destination_counted(self):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = 'attached'
        self.start_ring(nodes, timeouts={'refused': '50ms'})
        sent = self.ctl_json('send', '--from', 0, '--to', 1, '--size', 8, code=1)['results'][0]
        self.assertEqual((sent['outcome'], sent['reason_code']), ('refused', 'cpu_absent'))
        self.assertEqual(sent['reason'], 'at node1: no CPU is there (counted there)')
        to_all = self.ctl_json('send', '--from', 0, '--to', 'all', '--size', 8, code=1)['results'][0]
        self.assertEqual(to_all['reason_code'], 'cpu_absent')

    def test_a_client_is_told_what_its_daemon_infers(self):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = 'attached'
        self.start_ring(nodes, timeouts={'refused': '50ms'})
        self.wait('a beacon', lambda: any(peer['id'] == 1 for peer in self.answered(0)['heard']))
        port = self.port(0)
        self.assertEqual(port.wait(port.send(1, b'x')).reason, 'probably no CPU is there (by its last beacon)')
        ping = port.ask({'do': 'ping', 'to': 1, 'count': 2}, timeout=ring_process.GUARD)
        self.assertEqual(ping['reasons'], {'probably no CPU is there (by its last beacon)': 2})

    def test_a_pin_wired_to_nothing_is_named(self):
        self.start_ring(plain_nodes(2))
        sent = self.ctl_json('interrupt', '--from', 0, '--to', 1, 7, code=1)['results'][0]
        self.assertEqual((sent['outcome'], sent['reason_code']), ('refused', 'pin_unwired'))
        port = self.port(0)
        self.assertEqual(port.wait(port.interrupt(1, 7)).reason, 'pin INT7 of node1 is wired to nothing')

    def test_a_node_that_is_gone_is_no_such_node_for_a_reason(self):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = 'attached'  # a node without one cannot be reset
        daemons = self.start_ring(nodes)
        daemons[1].kill()
        self.wait_closed([0, 2])
        sent = self.ctl_json('send', '--from', 0, '--to', 1, '--size', 8, code=1)['results'][0]
        self.assertEqual((sent['outcome'], sent['reason_code']), ('no such node', 'node_missing'))
        for command, what in (('stop', 'the stop'), ('resume', 'node1: the resume'), ('reset', 'the interrupt')):
            self.assertRegex(self.ctl(command, 'node1').stdout, r"(?m)^%s ended 'no such node'( after [0-9.]+ us)?: \w" % what)

    def test_bad_arguments_say_which(self):
        self.start_ring(plain_nodes(2))
        port = self.port(0)
        self.assertIn('factors are 0 to 7', port.wait(port.interrupt(1, 9)).reason)
        forced = self.ctl_json('interrupt', '--from', 0, '--to', 'all', 0, code=1)['results'][0]
        self.assertEqual(forced['reason_code'], 'needs_force')


if __name__ == '__main__':
    ring_process.main()
