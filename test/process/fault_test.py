"""Faults on living nodes and CPUs: each takes effect before it is answered, is listed, is removed, and the ring
is whole again."""

import json
import os
import re
import signal
import socket
import subprocess

import ring_process
from fault_process import QUICK, FaultTest
from ring_process import is_gone, plain_nodes, process_state

SOURCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')


class Nodes(FaultTest):
    def test_a_killed_node_is_gone_when_answered_is_listed_and_started_again(self):
        daemons = self.start_ring(plain_nodes(4))
        self.assertEqual(self.begin('kill', 'node2'), ['node2.kill'])
        self.assertTrue(is_gone(daemons[2].pid))
        self.wait_closed([0, 1, 3])
        self.assertEqual(self.listed()['node2.kill']['fault'], 'kill node2')
        self.assertIn('fault on purpose node2.kill: kill node2', self.ctl('status').stdout)
        for word in ('kill', 'freeze', 'thaw', 'power_cycle', 'hang', 'reset'):
            self.assertIn('node node2 of ring %s has no daemon on this host that runs' % self.ring,
                          self.fault(word, 'node2', code=3), word)
        self.fault('start', 'node2')
        self.wait_closed(range(4))
        self.assertEqual(self.listed(), {})
        self.assertIn('runs already', self.fault('start', 'node2', code=1))

    def test_a_node_whose_lock_file_was_removed_is_killed_and_started_again_all_the_same(self):
        daemons = self.start_ring(plain_nodes(3))
        daemons[1].send_signal(signal.SIGSTOP)  # it would make the file again within a second
        self.wait('node 1 stopped', lambda: process_state(daemons[1].pid) == 'T')
        os.remove(os.path.join(self.ring_folder(), '1.lock'))
        self.assertEqual(self.begin('kill', 'node1'), ['node1.kill'])
        self.assertTrue(is_gone(daemons[1].pid))
        self.wait_closed([0, 2])
        self.fault('start', 'node1')
        self.wait_closed(range(3))
        self.assertEqual(self.listed(), {})

    def test_a_node_that_cannot_be_started_is_told_at_once_with_its_last_words(self):
        self.start_ring(plain_nodes(3))
        self.begin('kill', 'node2')
        config = os.path.join(self.folder, 'ring.yaml')
        os.rename(config, config + '.moved')
        said = self.fault('start', 'node2', code=1)
        self.assertIn('node node2 cannot be started: exit 2', said)
        self.assertIn(config + ': there is no such file', said)
        self.assertIn('cannot be started', self.ctl('fault', 'clear').stderr)
        os.rename(config + '.moved', config)
        self.fault('start', 'node2')
        self.wait_closed(range(3))

    def test_a_process_of_somebody_else_in_the_place_of_a_killed_node_is_seen_and_the_kill_is_not_forgotten(self):
        daemons = self.start_ring(self.udp_nodes(3), timeouts=QUICK)
        self.begin('kill', 'node1')
        self.assertTrue(is_gone(daemons[1].pid))
        other = self.launcher.runtime + '_other'
        os.mkdir(other, 0o700)
        stands_in = self.start('foreign', ['env', 'XDG_RUNTIME_DIR=' + other, ring_process.program('ringd'), '--config',
                                           os.path.join(self.folder, 'ring.yaml'), '--node', '1'])
        self.wait('a ring of three', lambda: self.answered(0)['ring_size'] == 3)
        self.wait('it is seen', lambda: self.ctl_json('status')['nodes'][1]['state'] == 'up')
        self.assertIn('cannot be started', self.fault('start', 'node1', code=1))
        self.assertEqual(self.listed()['node1.kill']['fault'], 'kill node1')
        stands_in.kill()
        stands_in.wait()
        self.fault('start', 'node1')
        self.wait_closed(range(3))
        self.assertEqual(self.listed(), {})

    def test_a_ring_of_which_all_nodes_were_killed_is_brought_back(self):
        self.start_ring(plain_nodes(3))
        self.begin('kill', 'all')
        self.assertEqual(sorted(self.listed()), ['node0.kill', 'node1.kill', 'node2.kill'])
        self.assertIn('3 nodes killed on purpose', self.ctl('status').stderr)
        self.assertIn('node0 of ring %s has no daemon' % self.ring, self.fault('cut', 'node0:node1', code=3))
        self.fault('remove', 'node1.kill')
        self.assertEqual(sorted(self.listed()), ['node0.kill', 'node2.kill'])
        self.assertIn('3 nodes up', self.fault('clear'))
        self.assertEqual(self.listed(), {})
        self.begin('kill', 'all')
        self.fault('start', 'all')
        self.wait_closed(range(3))
        self.begin('kill', 'all')
        self.assertEqual(self.ctl('down').stdout, 'ring %s is down\n' % self.ring)
        self.assertFalse(os.path.exists(self.ring_folder()))

    def test_a_node_started_again_ends_with_the_ring_in_the_foreground(self):
        up = self.start('up', [ring_process.program('ringctl'), '--ring', self.ring, 'up', '--nodes', '3'])
        self.wait('the ring announced', lambda: 'is closed' in self.log_of(up))
        self.begin('kill', 'node1')
        self.fault('start', 'node1')
        pid = self.answered(1)['pid']
        up.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(up), 0)
        self.wait('the end of node 1', lambda: is_gone(pid))

    def test_a_frozen_node_is_shown_as_frozen_and_goes_on_when_thawed(self):
        daemons = self.start_ring(plain_nodes(4), timeouts=QUICK)
        self.begin('freeze', 'node2')
        self.assertEqual(process_state(daemons[2].pid), 'T')
        self.wait_closed([0, 1, 3])
        self.assertRegex(self.ctl('status').stdout, r'(?m)^ *2 +node2 +frozen ')
        self.assertIn('is frozen', self.fault('cut', 'node2:node3', code=1))
        self.assertEqual(list(self.listed()), ['node2.freeze'])
        self.fault('thaw', 'node2')
        self.assertNotEqual(process_state(daemons[2].pid), 'T')
        self.wait_closed(range(4))
        self.assertEqual(self.listed(), {})
        boot = self.answered(2)['boot']
        self.assertEqual(self.fault('freeze', 'node2', '--for', '500ms'), 'done: freeze node2 for=500ms\n')
        self.wait_closed(range(4))
        self.wait('bypassed meanwhile', lambda: self.answered(2)['boot'] > boot)

    def test_a_thawed_node_can_be_asked_at_once_even_if_many_have_asked_it_in_vain(self):
        daemons = self.start_ring(plain_nodes(3), timeouts=QUICK)
        for thaw in (['thaw', 'node2'], ['clear']):
            os.kill(daemons[2].pid, signal.SIGSTOP)
            self.wait('node 2 to stand still', lambda: process_state(daemons[2].pid) == 'T')
            with self.assertRaises(BlockingIOError):   # what waits at its door is limited
                for _ in range(10000):
                    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as in_vain:
                        in_vain.setblocking(False)
                        in_vain.connect(os.path.join(self.ring_folder(), '2.host'))
            self.fault(*thaw)
            self.assertIn('has no faults on purpose', self.fault('list'))
            self.wait_closed(range(3))

    def test_unknown_faults_are_not_reported_as_no_faults(self):
        daemons = self.start_ring(plain_nodes(3), timeouts=QUICK)
        os.kill(daemons[2].pid, signal.SIGSTOP)
        self.wait('node 2 to stand still', lambda: process_state(daemons[2].pid) == 'T')
        self.assertEqual(self.fault('list', code=1),
                         'ringctl: the faults at node2 are not known: node node2 is frozen: its daemon does not answer; '
                         'thaw it first\n')
        self.begin('delay', 'node0:node1', '--delay', '1ms')
        listed = self.ctl('fault', 'list')
        self.assertEqual(listed.returncode, 1)
        self.assertIn('node0.1', listed.stdout)
        self.assertIn('the faults at node2 are not known', listed.stderr)
        known = json.loads(self.ctl('fault', 'list', '--json').stdout)
        self.assertEqual([fault['id'] for fault in known['faults']], ['node0.1'])
        self.assertEqual(len(known['unknown']), 1)
        self.fault('clear')
        self.assertIn('has no faults on purpose', self.fault('list'))

    def test_ctrl_c_thaws_nodes_that_are_frozen_for_a_time(self):
        daemons = self.start_ring(plain_nodes(4), timeouts=QUICK)
        freezes = self.start('freeze', [ring_process.program('ringctl'), 'fault', 'freeze', 'node1', 'node2',
                                        '--for', '300s'])
        self.wait('both stopped', lambda: [process_state(daemons[i].pid) for i in (1, 2)] == ['T', 'T'])
        freezes.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(freezes), 1)
        self.assertIn('thawed before its time', self.log_of(freezes))
        self.assertEqual(self.listed(), {})
        self.wait_closed(range(4))

    def test_a_node_that_is_killed_while_it_is_frozen_for_a_time_stays_down(self):
        daemons = self.start_ring(plain_nodes(3), timeouts=QUICK)
        freeze = self.start('freeze', [ring_process.program('ringctl'), 'fault', 'freeze', 'node1', '--for', '300s'])
        self.wait('stopped', lambda: process_state(daemons[1].pid) == 'T')
        self.begin('kill', 'node1')
        self.assertEqual(self.wait_exit(freeze), 0)   # it waits no longer, and has not started the node
        self.assertEqual(list(self.listed()), ['node1.kill'])

    def test_a_power_cycle_gives_a_new_boot_number_a_new_cpu_and_the_same_pid(self):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = {'command': ['limb_firmware']}
        daemons = self.start_ring(nodes)
        cpu, boot = self.wait_cpu(1, 'running')['pid'], self.answered(1)['boot']
        self.fault('power_cycle', 'node1')
        row = self.answered(1)
        self.assertGreater(row['boot'], boot)
        self.assertEqual((row['pid'], daemons[1].poll()), (daemons[1].pid, None))
        self.assertTrue(is_gone(cpu))
        self.wait_closed(range(3))
        self.assertNotEqual(self.wait_cpu(1, 'running')['pid'], cpu)
        self.assertEqual(self.ping(0, 1)['delivered'], 20)

    def test_a_daemon_that_is_cycled_while_packets_pass_is_scheduled_as_before(self):
        daemons = self.start_ring(plain_nodes(3))
        pid = daemons[1].pid
        flood = self.start('ping', [ring_process.program('ringctl'), '--ring', self.ring, 'ping', 'node2',
                                    '--from', 'node0', '-c', '1000000', '-f', '-q'])
        self.wait('SCHED_BATCH', lambda: os.sched_getscheduler(pid) == os.SCHED_BATCH)
        self.fault('power_cycle', 'node1')
        flood.kill()
        self.wait_closed(range(3))
        self.wait('SCHED_OTHER', lambda: os.sched_getscheduler(pid) == os.SCHED_OTHER)

    def test_a_power_cycle_is_waited_for_no_longer_than_the_daemon_lives(self):
        self.start_ring(plain_nodes(3))
        os.remove(os.path.join(self.folder, 'ring.yaml'))   # it starts anew, and ends
        self.assertIn('the daemon of node node1 has ended', self.fault('power_cycle', 'node1', code=1))

    def test_a_power_cycle_of_all_over_udp_closes_the_ring_again(self):
        self.start_ring(self.udp_nodes(4), timeouts=QUICK)
        boots = [self.answered(i)['boot'] for i in range(4)]
        self.fault('power_cycle', 'all')
        self.wait_closed(range(4))
        for i in range(4):
            self.assertGreater(self.answered(i)['boot'], boots[i])

    def test_clear_ends_everything(self):
        self.start_ring(plain_nodes(5), timeouts=QUICK)
        self.begin('kill', 'node1')
        self.begin('freeze', 'node2')
        self.begin('drop', 'node3:node4', '--once-in', 1000)
        self.begin('not_reading', 'node4')
        self.assertEqual(sorted(self.listed()), ['node1.kill', 'node2.freeze', 'node3.1', 'node4.1'])
        self.fault('clear')
        self.assertEqual(self.listed(), {})
        self.wait_closed(range(5))


class Cpus(FaultTest):
    def start_limb(self, **cpu):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = dict({'command': ['limb_firmware']}, **cpu)
        self.start_ring(nodes)
        return self.wait_cpu(1, 'running')

    def test_a_hung_cpu_is_stopped_shown_and_goes_on(self):
        pid = self.start_limb()['pid']
        self.assertEqual(self.begin('hang', 'node1'), ['node1.1'])
        self.assertEqual(process_state(pid), 'T')
        self.assertRegex(self.ctl('status').stdout, r'(?m)^ *1 +node1 +up .* hung ')
        self.assertEqual(self.listed()['node1.1']['fault'], 'hang node1')
        self.assertEqual(self.fault('resume', 'node1'), 'done: resume node1\n')
        self.assertNotEqual(process_state(pid), 'T')
        self.assertEqual(self.listed(), {})

    def test_a_hang_ends_with_its_time_or_with_a_reset(self):
        cpu = self.start_limb()
        self.begin('hang', 'node1', '--for', '100ms')
        self.wait('running again', lambda: process_state(cpu['pid']) != 'T')
        self.begin('hang', 'node1')
        self.fault('reset', 'node1')
        self.assertEqual(self.wait_cpu(1, 'running')['boots'], cpu['boots'] + 1)
        self.assertEqual(self.listed(), {})

    def test_a_cpu_that_does_not_boot_after_a_reset_is_told_as_soon_as_it_should_have(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = {'command': ['/bin/sleep', '1000']}
        self.start_ring(nodes, timeouts={'cpu_boot': '150ms'})
        self.assertEqual(self.port(1).ask({'do': 'config'})['cpu_boot_ms'], 150)
        self.assertIn('the CPU has not booted again: did not attach to the host port within 150 ms',
                      self.fault('reset', 'node1', code=1))

    def test_a_crashed_cpu_is_gone_even_if_it_hung(self):
        pid = self.start_limb()['pid']
        self.begin('hang', 'node1')
        self.fault('crash', 'node1')
        self.assertTrue(is_gone(pid))
        self.wait('its end told', lambda: 'signal 11' in self.answered(1)['cpu']['last_exit'])

    def test_an_attached_cpu_is_affected_too(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = 'attached'
        self.start_ring(nodes)
        firmware = self.start('cpu', [ring_process.program('limb_firmware'), '--ring', self.ring, '--node', '1',
                                      '--config', os.path.join(self.folder, 'ring.yaml')])
        self.wait_cpu(1, 'running')
        self.begin('hang', 'node1')
        self.assertEqual(process_state(firmware.pid), 'T')
        self.fault('clear')
        self.assertNotEqual(process_state(firmware.pid), 'T')
        self.begin('hang', 'node1')
        self.fault('power_cycle', 'node1')
        self.assertNotEqual(process_state(firmware.pid), 'T', 'nobody else would end it')

    def test_a_cpu_that_does_not_read_refuses_and_a_slow_one_takes_its_time(self):
        self.start_ring(plain_nodes(2), limits={'receive_buffers': 2}, timeouts={'refused': '50ms'})
        self.begin('not_reading', 'node1')
        port = self.port(0)
        outcomes = [port.wait(port.send(1, b'x')).outcome for _ in range(4)]
        self.assertEqual(outcomes, ['delivered', 'delivered', 'refused', 'refused'])
        self.fault('resume', 'node1')
        self.assertEqual(port.wait(port.send(1, b'x')).outcome, 'delivered')
        slow = self.begin('slow', 'node1', '--every', '10s')
        self.wait('full again', lambda: port.wait(port.send(1, b'x')).outcome == 'refused')
        self.fault('remove', slow[0])
        self.assertEqual(port.wait(port.send(1, b'x')).outcome, 'delivered')

    def test_a_babbling_cpu_is_counted_and_does_not_starve_the_others(self):
        self.start_ring(plain_nodes(3))
        babble = self.begin('babble', 'node1')
        self.wait('a hundred packets', lambda: self.listed()[babble[0]]['hits'] >= 100)
        self.assertEqual(self.ping(0, 2, 50)['delivered'], 50)
        self.fault('remove', babble[0])
        sent = self.counters(1)['sent_data']
        self.assertEqual(self.ping(0, 2, 200)['delivered'], 200)
        self.assertLess(self.counters(1)['sent_data'] - sent, 100, 'beacons alone')

    def test_what_a_mute_cpu_sends_is_discarded_and_counted_while_it_reads_and_until_it_is_over(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = 'attached'
        self.start_ring(nodes)
        cpu, tool = self.port(1, role='cpu'), self.port(1)
        mute = self.begin('mute', 'node1')
        result = cpu.wait(cpu.send(0, b'x'))
        self.assertEqual((result.outcome, result.reason), ('rejected', 'the CPU is mute, a fault on purpose'))
        self.assertEqual(cpu.wait(cpu.interrupt(0, 3)).outcome, 'rejected')
        self.assertEqual(self.listed()[mute[0]]['hits'], 2)
        self.assertEqual(tool.wait(tool.send(0, b'x')).outcome, 'delivered', 'that is not its CPU')
        other = self.port(0)
        self.assertEqual(other.wait(other.send(1, b'x')).outcome, 'delivered', 'it reads')
        self.fault('remove', mute[0])
        self.assertEqual(cpu.wait(cpu.send(0, b'x')).outcome, 'delivered')
        for end in (['resume', 'node1'], ['clear']):
            self.begin('mute', 'node1')
            self.assertEqual(cpu.wait(cpu.send(0, b'x')).outcome, 'rejected')
            self.fault(*end)
            self.assertEqual(cpu.wait(cpu.send(0, b'x')).outcome, 'delivered')

    def test_a_node_without_a_process_has_nothing_to_hang(self):
        self.start_ring(plain_nodes(2))
        self.assertIn('hang node1: no CPU is there', self.fault('hang', 'node1', code=1))
        self.begin('kill', 'node1')
        self.fault('hang', 'node1', code=3)


class Words(FaultTest):
    def test_help_has_one_line_for_every_fault(self):
        text = self.ctl('fault', '--help').stdout
        for word in ('cut heal drop corrupt truncate duplicate reorder delay rate stall flap kill start power_cycle '
                     'freeze thaw hang resume reset crash slow not_reading babble mute list remove clear').split():
            self.assertRegex(text, r'(?m)^  %s +\S' % re.escape(word))

    def test_help_of_a_fault_says_what_has_to_be_given(self):
        for word, option, needed in (('rate', 'rate', 'required'), ('flap', 'every', 'required'), ('slow', 'every', 'required'),
                                     ('delay', 'delay', '--delay or --jitter is required'),
                                     ('delay', 'jitter', '--delay or --jitter is required')):
            text = ' '.join(self.ctl('fault', word, '--help').stdout.split())
            self.assertRegex(text, r' --%s TEXT (?:(?! --|; ).)*(?:; (?!%s)(?:(?! --|; ).)*)*; %s --' % (option, needed, needed))
        for word in 'babble', 'drop', 'cut', 'hang':
            self.assertNotRegex(self.ctl('fault', word, '--help').stdout, r'; required')

    def test_wrong_words_are_refused_with_what_would_be_right(self):
        self.start_ring(plain_nodes(3))
        for arguments, what in (
                (('cut', 'node0:node2'), 'node0 -> node1'),
                (('cut', 'node0', '-'), "the shell has taken '>'"),
                (('drop', 'node0:nodf1'), "did you mean 'node1'"),
                (('drop', 'node0:node1', '--packets', 'few'), 'a whole number'),
                (('rate', 'node0:node1', '1Mbit/s'), "'1Mbit/s' is a word too many; allowed: --rate 1Mbit/s\n"),
                (('drop', 'node0 -> node1', 3), "'3' is a word too many; allowed: --packets 3\n"),
                (('hang', 'node0', '2s'), "'2s' is a word too many; allowed: --for 2s\n"),
                (('cut', 'node0:node1', 'node2'), "'node2' is a word too many; allowed: one line A:B, and options\n"),
                (('drop', 'node0:node1', '--after-packets', 5), 'drop needs --of; allowed: a node of the ring, whose data packets'),
                (('delay', 'node0:node1'), 'delay needs --delay or --jitter; allowed: a time'),
                (('cut', 'node0'), 'cut needs a line'),
                (('cut', 'node0:node1', 'node1:node2'), 'one line A:B'),
                (('stall', 'node0:node1', '--for', 3), 'a time such as'),
                (('stall', 'node0:node1', '--packets', 3), '--packets'),
                (('hang',), 'WHERE'),
                (('explode', 'node1'), "'ringctl fault explode' is unknown")):
            self.assertIn(what, self.fault(*arguments, code=2), arguments)
        self.assertIn('any more', self.fault('remove', 'node1.7', code=1))
        self.assertIn("unknown node 'node7'", self.fault('remove', 'node7.1', code=2))
        for no_id in ('seven', 'node1.x', 'node1.'):
            self.assertIn("can have the id '%s'" % no_id, self.fault('remove', no_id, code=2))
        self.assertIn('ID is empty', self.fault('remove', '', code=2))
        self.assertEqual(self.fault('list'), 'ring %s has no faults on purpose\n' % self.ring)

    def test_no_ring_is_exit_code_3(self):
        self.fault('list', code=3)


class Page(FaultTest):
    def test_the_example_works_as_it_is_pasted_and_has_all_faults_in_its_table(self):
        with open(os.path.join(SOURCE, 'docs', 'reference', 'faults.md'), encoding='utf-8') as file:
            page = file.read()
        example = re.search(r'^(?:    ringctl .*\n)+', page, re.MULTILINE).group(0)
        self.assertIn('ringctl up config/leg8.yaml --detach', example)
        done = subprocess.run(['sh', '-ec', example], cwd=SOURCE, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True, timeout=ring_process.GUARD,
                              env=dict(self.environment, PATH='%s:%s' % (ring_process.PROGRAMS, os.environ['PATH'])))
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertTrue(done.stdout.endswith('ring leg8 is down\n'), done.stdout)
        words = re.findall(r'^  ([a-z_]+) ', self.ctl('fault', '--help').stdout.split('Subcommands:')[1], re.MULTILINE)
        self.assertGreater(len(words), 20)
        listed = re.findall(r'`([a-z_]+)`', '\n'.join(re.findall(r'^\| (`.*?) \|', page, re.MULTILINE)))
        self.assertEqual([word for word in words if word not in listed + ['list', 'remove', 'clear']], [])


if __name__ == '__main__':
    ring_process.main()
