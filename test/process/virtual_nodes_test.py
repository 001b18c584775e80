"""Faults of whole nodes on a virtual ring: the words, answers and files of a live one, done to nodes in the simulation."""

import os
import shutil
import signal

import ring_process
from fault_process import FaultTest
from limb_ring import HostPortError
from ring_process import is_gone, plain_nodes
from virtual_process import VirtualTest


class Nodes(VirtualTest, FaultTest):
    def test_a_killed_node_is_gone_when_answered_is_listed_and_started_again(self):
        self.up(plain_nodes(4))
        port = self.port(2)
        boot = self.answered(2)['boot']
        self.assertEqual(self.begin('kill', 'node2'), ['node2.kill'])
        self.assertIsNone(self.row(2))
        with self.assertRaises(HostPortError):
            port.ask({'do': 'status'})
        self.wait_closed([0, 1, 3])
        self.assertEqual(self.listed()['node2.kill']['fault'], 'kill node2')
        status = self.ctl('status').stdout
        self.assertRegex(status, r'(?m)^ *2 +node2 +down ')
        self.assertIn('fault on purpose node2.kill: kill node2', status)
        self.assertEqual(self.ctl_json('status', '--rings')[0]['nodes'], 3)
        for word in ('freeze', 'thaw', 'kill', 'power_cycle', 'hang'):
            self.assertIn('node node2 of ring %s has no daemon on this host that runs' % self.ring,
                          self.fault(word, 'node2', code=3), word)
        self.fault('start', 'node2')
        self.wait_closed(range(4))
        self.assertEqual(self.listed(), {})
        self.assertGreater(self.answered(2)['boot'], boot)
        self.assertIn('runs already', self.fault('start', 'node2', code=1))

    def test_a_process_that_somebody_has_stopped_goes_on_by_the_command_that_is_named(self):
        self.up(plain_nodes(3))
        self.begin('kill', 'node1')
        self.begin('freeze', 'node2')
        pid = self.answered(0)['pid']
        self.stop_process(pid)
        self.assertIn("'ringctl fault clear' thaws them", self.ctl('ping', 'node1', '-c', 1).stderr)
        self.assertIn('3 nodes up', self.fault('clear'))
        self.assertEqual(self.listed(), {})
        self.stop_process(pid)
        self.assertIn('node2 is frozen', self.fault('drop', 'node2:node0', code=1))   # its name is known all the same
        self.assertEqual(self.fault('thaw', 'node2'), 'done: thaw node2\n')
        self.wait_closed(range(3))

    def test_killing_all_nodes_kills_those_that_live(self):
        self.up(plain_nodes(3))
        self.begin('kill', 'node2')
        said = self.fault('kill', 'all', code=3)
        self.assertIn('node node2 of ring %s has no daemon' % self.ring, said)
        self.assertEqual(sorted(self.listed()), ['node0.kill', 'node1.kill', 'node2.kill'])

    def test_clearing_says_that_the_clock_stands(self):
        self.up(plain_nodes(3))
        self.begin('kill', 'node2')
        self.assertEqual(self.ctl('clock', 'pause').returncode, 0)
        said = self.ctl('fault', 'clear', '--timeout', 1)
        self.assertEqual(said.returncode, 1)
        self.assertIn('the virtual clock of ring %s stands' % self.ring, said.stderr)
        self.assertNotIn('{', said.stderr)

    def test_its_cpu_dies_with_it_and_another_one_boots(self):
        self.up(self.limbs())
        cpu = self.wait_cpu(1, 'running')['pid']
        self.begin('kill', 'node1')
        self.assertTrue(is_gone(cpu))
        self.fault('start', 'node1')
        row = self.wait_cpu(1, 'running')
        self.assertEqual(row['boots'], 1, 'as of a daemon that has just started')
        self.assertNotEqual(row['pid'], cpu)

    def test_an_attached_cpu_outlives_its_node_and_may_come_again(self):
        nodes = plain_nodes(3)
        nodes[1]['cpu'] = 'attached'
        self.up(nodes)
        cpu = self.port(1, role='cpu')
        self.wait_cpu(1, 'running')
        self.begin('kill', 'node1')
        with self.assertRaises(HostPortError):
            cpu.ask({'do': 'status'})
        self.fault('start', 'node1')
        self.assertEqual(self.answered(1)['cpu']['state'], 'absent')
        again = self.port(1, role='cpu')
        self.wait_cpu(1, 'running')
        port = self.port(0)
        self.assertEqual(port.wait(port.send(1, b'x')).outcome, 'delivered')
        self.assertEqual(again.receive(ring_process.GUARD).data, b'x')

    def test_a_frozen_node_answers_nobody_is_shown_as_frozen_and_goes_on_when_thawed(self):
        self.up(self.limbs())
        cpu = self.wait_cpu(1, 'running')
        port = self.port(1)
        before = self.answered(1)
        self.assertEqual(self.begin('freeze', 'node1'), ['node1.freeze'])
        asked = port.request({'do': 'status'})
        self.wait_closed([0, 2, 3])
        self.assertRegex(self.ctl('status').stdout, r'(?m)^ *1 +node1 +frozen ')
        self.assertIn('is frozen', self.fault('cut', 'node1:node2', code=1))
        self.assertIn('is frozen', self.fault('power_cycle', 'node1', code=1))
        self.assertEqual(list(self.listed()), ['node1.freeze'])
        self.assertIn('delivered', self.ctl('send', '--from', '0', '--to', '2', '--data', 'x').stdout)
        self.fault('thaw', 'node1')
        self.assertEqual(port.answer(asked)['name'], 'node1')
        self.wait_closed(range(4))
        self.assertEqual(self.listed(), {})
        self.assertEqual(self.wait_cpu(1, 'running')['pid'], cpu['pid'])
        self.assertGreater(self.answered(1)['boot'], before['boot'], 'it has joined again')

    def test_a_freeze_for_a_time_is_of_the_rings_time_and_over_when_answered(self):
        self.up(plain_nodes(3), '--pace', '100')
        boot, start = self.answered(2)['boot'], self.answered(0)['uptime_s']
        self.assertEqual(self.fault('freeze', 'node2', '--for', '20s'), 'done: freeze node2 for=20s\n')
        self.assertGreaterEqual(self.answered(0)['uptime_s'] - start, 20)
        self.wait_closed(range(3))
        self.assertGreater(self.answered(2)['boot'], boot)

    def test_a_frozen_node_may_be_killed_and_started(self):
        self.up(plain_nodes(3))
        self.begin('freeze', 'node1')
        self.begin('kill', 'node1')
        self.assertEqual(list(self.listed()), ['node1.kill'])
        self.fault('remove', 'node1.kill')
        self.wait_closed(range(3))

    def test_a_power_cycle_gives_a_new_boot_number_a_new_cpu_and_ends_faults(self):
        self.up(self.limbs())
        cpu, boot = self.wait_cpu(1, 'running')['pid'], self.answered(1)['boot']
        self.begin('drop', 'node1:node2', '--once-in', 1000)
        self.begin('cut', 'node1:node2')
        self.fault('power_cycle', 'node1')
        self.assertGreater(self.answered(1)['boot'], boot)
        self.assertTrue(is_gone(cpu))
        self.assertEqual(self.listed(), {})
        self.wait_closed(range(4))
        self.assertNotEqual(self.wait_cpu(1, 'running')['pid'], cpu)
        self.assertEqual(self.ping(0, 2)['delivered'], 20)
        boots = [self.answered(i)['boot'] for i in range(4)]
        self.fault('power_cycle', 'all')
        self.wait_closed(range(4))
        for i in range(4):
            self.assertGreater(self.answered(i)['boot'], boots[i])

    def test_a_request_to_the_node_itself_cycles_its_power_too(self):
        self.up(plain_nodes(3))
        boot = self.answered(1)['boot']
        with self.assertRaises(HostPortError):
            self.port(1).ask({'do': 'fault', 'fault': 'power_cycle node1'})
        self.wait('it is back', lambda: (self.row(1) or {'boot': 0})['boot'] > boot)

    def test_clear_ends_everything(self):
        self.up(self.limbs())
        self.wait_cpu(2, 'running')
        self.begin('kill', 'node1')
        self.begin('freeze', 'node2')
        self.begin('drop', 'node3:node0', '--once-in', 1000)
        self.assertEqual(sorted(self.listed()), ['node1.kill', 'node2.freeze', 'node3.1'])
        self.fault('clear')
        self.assertEqual(self.listed(), {})
        self.wait_closed(range(4))

    def test_clear_waits_no_longer_than_its_timeout(self):
        self.up(plain_nodes(3))
        self.ring_ctl('fault', 'kill', 'node1')
        self.ring_ctl('clock', 'pause')
        done = self.ctl('--ring', self.ring, 'fault', 'clear', '--timeout', '0.3')
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn('has not joined the ring within 300 ms', done.stderr)

    def test_all_are_killed_and_the_ring_can_be_taken_down(self):
        config = self.up(plain_nodes(3))
        pid = self.answered(0)['pid']
        self.begin('kill', 'all')
        self.assertEqual(self.ctl('status').returncode, 3)
        self.assertEqual(self.ctl_json('status', '--rings')[0]['nodes'], 0)
        again = self.ctl('up', config, '--clock', 'virtual', '--detach')
        self.assertIn('running already', again.stderr)
        self.assertEqual(self.ctl('--ring', self.ring, 'down').returncode, 0)
        self.wait('its end', lambda: is_gone(pid))   # it lets go of its locks a little before
        self.assertFalse(os.path.exists(self.ring_folder()))

    def test_a_ring_with_a_frozen_and_a_killed_node_goes_down_at_once(self):
        self.up(self.limbs())
        pid = self.answered(0)['pid']
        self.begin('freeze', 'node1')
        self.begin('kill', 'node2')
        self.assertEqual(self.ctl('--ring', self.ring, 'down').returncode, 0)
        self.wait('its end', lambda: is_gone(pid))   # as above

    def test_nothing_of_a_ring_that_was_killed_itself_is_left(self):
        config = self.up(plain_nodes(3))
        pid = self.answered(0)['pid']
        self.begin('kill', 'node1')
        os.kill(pid, signal.SIGKILL)
        self.wait('it is gone', lambda: is_gone(pid))
        self.up_again(config)
        self.wait_closed(range(3))
        self.assertEqual(self.listed(), {})

    def test_a_ring_whose_folder_was_removed_can_be_asked_again(self):
        self.up(plain_nodes(3))
        shutil.rmtree(self.ring_folder())
        self.wait('its own port', lambda: os.path.exists(self.socket_of(255)))
        self.wait_closed(range(3))
        self.begin('kill', 'node1')
        self.wait_closed([0, 2])
        shutil.rmtree(self.ring_folder())
        self.wait('its own port', lambda: os.path.exists(self.socket_of(255)))
        self.wait('the others', lambda: self.row(0) and self.row(2))
        self.assertEqual(self.ctl('fault', 'start', 'node1').returncode, 0)
        self.wait_closed(range(3))

    def test_the_rings_own_port_refuses_requests_to_nodes(self):
        self.up(plain_nodes(3))
        port = self.port(255)
        self.assertEqual(port.wait(port.send(1, b'x')).outcome, 'rejected')
        self.assert_refused('a node', port, {'do': 'status'})
        self.assert_refused('fault is missing', port, {'do': 'fault'})
        self.assertFalse(port.ask({'do': 'clock'})['paused'])
        self.assert_refused('begun at the node', port, {'do': 'fault', 'fault': 'hang node1'})
        self.assert_refused('is not a node of the ring', port, {'do': 'fault', 'fault': 'kill node7'})
        with self.assertRaisesRegex(HostPortError, 'no CPU'):
            self.port(255, role='cpu')


class Respawn(VirtualTest):
    def up_respawning(self, config, *more):
        up = self.start('up', [ring_process.program('ringctl'), '--ring', self.ring, 'up', config, '--clock', 'virtual',
                               '--respawn', *more])
        self.wait('said so', lambda: 'is closed' in self.log_of(up))
        return up

    def test_a_virtual_ring_that_dies_is_started_again_whole(self):
        up = self.up_respawning(self.write_ring(self.limbs()))
        self.assertEqual(self.ctl('--ring', self.ring, 'fault', 'kill', 'node0').returncode, 0)
        before = self.answered(1)['pid']
        os.kill(before, signal.SIGKILL)
        self.wait('another one', lambda: (self.row(1) or {'pid': before})['pid'] != before)
        self.wait_closed(range(4))
        self.wait_cpu(1, 'running')
        self.assertIn('the virtual ring ended: signal 9 (Killed)', self.log_of(up))
        self.assertIn('the virtual ring is started again', self.log_of(up))
        up.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(up), 0)
        self.assertEqual(list(self.launcher.daemons_left()), [])

    def test_nodes_that_are_killed_or_all_that_is_taken_down_stay_so(self):
        up = self.up_respawning(self.write_ring(plain_nodes(3)))
        self.assertEqual(self.ctl('--ring', self.ring, 'fault', 'kill', 'node1').returncode, 0)
        self.wait_closed([0, 2])
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)
        self.wait('said so', lambda: 'was taken down' in self.log_of(up))
        self.assertIsNone(up.poll())
        self.assertNotIn('is started again', self.log_of(up))
        up.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(up), 0)

    def test_a_ring_that_is_to_end_by_itself_is_not_respawned(self):
        done = self.ctl('up', self.write_ring(plain_nodes(3)), '--clock', 'virtual', '--respawn', '--for', '1s')
        self.assertEqual(done.returncode, 2)
        self.assertIn('--for and --respawn', done.stderr)


if __name__ == '__main__':
    ring_process.main()
