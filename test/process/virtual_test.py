"""A ring on a virtual clock, as its users meet it: as a live one, but for its times."""

import os
import signal
import socket

import ring_process
from host_port_wire import greeting
from ring_process import plain_nodes
from virtual_process import VirtualTest


class Virtual(VirtualTest):
    def test_tools_and_cpus_work_as_on_a_live_ring(self):
        self.up(self.limbs())
        rows = self.ctl_json('--ring', self.ring, 'status')['nodes']
        self.assertEqual({row['pid'] for row in rows}, {rows[0]['pid']})
        self.assertEqual([row['state'] for row in rows], ['up'] * 4)
        self.assertIn('delivered', self.ring_ctl('send', '--from', '0', '--to', '2', '--data', 'hello'))
        self.ring_ctl('clock', 'sync', '--from', '0')
        self.ring_ctl('wait', 'up', '--timeout', 60)  # a stop reaches the CPUs that have booted
        self.ring_ctl('stop')
        self.assertRegex(self.ring_ctl('status'), r'(?m)^ *1 .* stopped ')
        self.ring_ctl('resume')
        self.ring_ctl('wait', 'up', '--timeout', 60)
        before = self.wait_cpu(1, 'running')
        self.ring_ctl('reset', 'node1')
        after = self.wait_cpu(1, 'running')
        self.assertGreater(after['boots'], before['boots'])
        self.assertNotEqual(after['pid'], before['pid'])
        self.ring_ctl('down')
        self.assertFalse(os.path.exists(self.ring_folder()))

    def test_a_round_trip_takes_what_the_lines_take(self):
        self.up(plain_nodes(4))
        ping = self.ctl_json('--ring', self.ring, 'ping', 'node2', '--from', '0', '-c', '100', '-f', '-q')
        # protocol.md: T + N d, of 524 bytes at 8 ns each, and 512 ns at each of 4 nodes
        self.assertEqual((ping['round_trip_us']['min'], ping['round_trip_us']['max']), (6.24, 6.24))

    def test_a_cut_line_is_an_open_chain_and_mended(self):
        self.up(plain_nodes(4))
        self.ring_ctl('fault', 'cut', 'node1->node2')
        self.wait('an open chain', lambda: all(self.answered(node)['state'] == 'open_chain' for node in range(4)))
        self.assertEqual(self.answered(0)['broken_line']['before'], 1)
        self.ring_ctl('fault', 'clear')
        self.wait_closed(range(4))

    def test_a_ring_whose_time_is_over_leaves_no_folder(self):
        config = self.write_ring(plain_nodes(2))
        done = self.ctl('up', config, '--clock', 'virtual', '--pace', 'max', '--for', '1')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertFalse(os.path.exists(self.ring_folder()))

    def test_a_hung_cpu_is_found_and_reset(self):
        self.up(self.limbs(), supervisor={'policy': 'auto', 'grace': '1s', 'backoff': '100ms'})
        before = self.wait_cpu(1, 'running')
        os.kill(before['pid'], signal.SIGSTOP)
        self.wait('it to run again', lambda: self.answered(1)['cpu']['boots'] > before['boots'])
        self.assertGreaterEqual(self.answered(0)['supervisor']['watched'][0]['hangs'], 1)

    def test_status_list_and_top_tell_the_clock(self):
        self.up(self.limbs(), '--pace', '2')
        self.assertRegex(self.ring_ctl('status').splitlines()[0], r'4 of 4 nodes up; virtual clock at \d+\.\d{3} s, pace 2')
        clock = self.ctl_json('--ring', self.ring, 'status')['clock']
        self.assertEqual((clock['pace'], clock['paused']), (2, False))
        self.assertGreater(clock['now_s'], 0)
        for figure in ('late_s', 'lost_s'):
            self.assertGreaterEqual(clock[figure], 0)
        row = [row for row in self.ctl_json('status', '--rings') if row['ring'] == self.ring][0]
        self.assertEqual((row['nodes'], row['clock'], row['pace']), (4, 'virtual', 2))
        self.assertGreaterEqual(row['now_s'], clock['now_s'])
        top = self.ctl_json('--ring', self.ring, 'status', '--watch', '--once', '--interval', '0.2')
        self.assertGreater(top['clock']['now_s'], row['now_s'])
        self.ring_ctl('clock', 'pause')
        self.assertIn('virtual clock stands at', self.ring_ctl('status', '--watch', '--once', '--interval', '0.1'))
        self.ring_ctl('clock', 'run')

    def test_rates_are_of_the_rings_time_and_its_lines_have_a_load(self):
        self.up(plain_nodes(3), '--pace', '20', timeouts={'beacon': '10ms'})
        row = self.ctl_json('--ring', self.ring, 'status', '--watch', '--once', '--interval', '0.5')['nodes'][1]
        # Three nodes' beacons, a hundred in a second of the ring's time; twenty times as many in one of ours.
        self.assertTrue(250 < row['packets_per_second'] < 350, row)
        self.assertGreater(row['bytes_per_second'], 250 * 20)
        self.assertGreater(row['load'], 0)

    def test_a_ring_that_folds_back_goes_on_around_a_cut_line_and_beside_dead_nodes(self):
        self.up(plain_nodes(6), redundancy='foldback')
        self.ring_ctl('fault', 'cut', 'node2:node3')
        self.wait('folded', lambda: all(self.answered(node)['state'] == 'folded' for node in range(6)))
        ping = self.ctl_json('--ring', self.ring, 'ping', 'node3', '--from', 'node2', '-c', '20', '-f', '-q')
        self.assertEqual(ping['delivered'], 20)
        self.ring_ctl('fault', 'power_cycle', 'node4')
        self.wait('folded again', lambda: all(self.answered(node)['state'] == 'folded' for node in range(6)))
        self.ring_ctl('fault', 'kill', 'node5')
        self.wait('five', lambda: all(self.answered(node)['ring_size'] == 5 for node in range(5)))
        self.ring_ctl('fault', 'clear')
        self.wait_closed(range(6))

    def test_its_time_goes_on_at_the_pace_asked_for(self):
        self.up(plain_nodes(3), '--pace', '50')
        start = self.answered(0)['uptime_s']
        self.wait('more time than a live ring would have had',
                  lambda: self.answered(0)['uptime_s'] > start + 2 * ring_process.GUARD)

    def test_a_client_of_another_version_is_refused_by_nodes_and_by_the_ring(self):
        self.up(plain_nodes(3))
        for port, whose in (('1', 'node 1 (node1)'), ('255', 'ring ' + self.ring)):
            connection = socket.socket(socket.AF_UNIX)
            self.addCleanup(connection.close)
            connection.connect(self.socket_of(port))
            connection.settimeout(ring_process.GUARD)
            connection.sendall(greeting(self.ring, version=2))
            answer = connection.recv(4096)
            self.assertIn((whose + ' speaks version 3 of the host port, this client version 2').encode(), answer)

    def test_a_replay_says_that_the_clock_stands(self):
        self.up(plain_nodes(3))
        path = os.path.join(self.folder, 'some.pcapng')
        dump = self.start('dump', [ring_process.program('ringctl'), 'traffic', 'show', '--kind', 'data', '-n', '1', '-w', path])
        port = self.port(0)
        self.wait('the dump', lambda: port.wait(port.send(1, b'again')) and dump.poll() is not None)
        self.ctl('clock', 'pause')
        replay = self.start('replay', [ring_process.program('ringctl'), 'traffic', 'again', path])
        self.wait('it to be said', lambda: 'ringctl clock run' in self.log_of(replay))
        self.ctl('clock', 'run')
        self.assertEqual(self.wait_exit(replay), 0)

    def test_wrong_usage_is_reported(self):
        config = self.up(plain_nodes(3))
        again = self.ctl('up', config, '--clock', 'virtual', '--detach')
        self.assertEqual(again.returncode, 1)
        self.assertIn('running already', again.stderr)
        daemon = self.run_ringd('--config', config, '--node', '1')
        self.assertEqual(daemon.returncode, 1)
        self.assertIn('held by pid', daemon.stderr)
        for arguments, word in ((['--pace', '0'], 'pace'), (['--clock', 'lunar'], 'virtual'),
                                (['--clock', 'virtual', '--pace', '0'], '0.001'), (['--pace', '2'], 'clock'),
                                (['--clock', 'virtual', '--transport', 'udp'], 'transport'),
                                (['--clock', 'virtual', '--pace', '-1'], 'pace'), (['--clock', 'virtual', '--pace', 'nan'], 'pace'),
                                (['--clock', 'machine', '--pace', '2'], 'virtual'), (['--clock', 'machine', '--for', '1s'], 'virtual'),
                                (['--for', '1s'], 'clock'), (['--clock', 'virtual', '--for', '0'], 'for')):
            done = self.ctl('up', config, *arguments)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertIn(word, done.stderr)


if __name__ == '__main__':
    ring_process.main()
