"""A ring on a virtual clock, as its users meet it: as a live one, but for its times."""

import os
import signal

import ring_process
from ring_process import plain_nodes
from virtual_process import VirtualTest


class Virtual(VirtualTest):
    def test_tools_and_cpus_work_as_on_a_live_ring(self):
        self.up(self.limbs())
        rows = self.ctl_json('--ring', self.ring, 'status')['nodes']
        self.assertEqual({row['pid'] for row in rows}, {rows[0]['pid']})
        self.assertEqual([row['state'] for row in rows], ['up'] * 4)
        self.assertIn('delivered', self.ring_ctl('send', '--from', '0', '--to', '2', '--data', 'hello'))
        self.ring_ctl('sync', '--from', '0')
        for what in ('stop', 'resume'):
            self.ring_ctl(what)
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
        self.wait('an open chain', lambda: all(self.row(node)['state'] == 'open_chain' for node in range(4)))
        self.assertEqual(self.row(0)['broken_line']['before'], 1)
        self.ring_ctl('fault', 'clear')
        self.wait_closed(range(4))

    def test_a_hung_cpu_is_found_and_reset(self):
        self.up(self.limbs(), supervisor={'policy': 'auto', 'grace': '1s', 'backoff': '100ms'})
        before = self.wait_cpu(1, 'running')
        os.kill(before['pid'], signal.SIGSTOP)
        self.wait('it to run again', lambda: self.row(1)['cpu']['boots'] > before['boots'])
        self.assertGreaterEqual(self.row(0)['supervisor']['watched'][0]['hangs'], 1)

    def test_its_time_goes_on_at_the_pace_asked_for(self):
        self.up(plain_nodes(3), '--pace', '50')
        start = self.row(0)['uptime_s']
        self.wait('more time than a live ring would have had', lambda: self.row(0)['uptime_s'] > start + 2 * ring_process.GUARD)

    def test_wrong_use_is_told(self):
        config = self.up(plain_nodes(3))
        again = self.ctl('up', config, '--clock', 'virtual', '--detach')
        self.assertEqual(again.returncode, 1)
        self.assertIn('running already', again.stderr)
        daemon = self.run_ringd('--config', config, '--node', '1')
        self.assertEqual(daemon.returncode, 1)
        self.assertIn('held by pid', daemon.stderr)
        for arguments, word in ((['--pace', '0'], 'pace'), (['--clock', 'lunar'], 'virtual'),
                                (['--clock', 'virtual', '--pace', '0'], '0.001'), (['--pace', '2'], 'clock'),
                                (['--clock', 'virtual', '--transport', 'udp'], 'transport')):
            done = self.ctl('up', config, *arguments)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertIn(word, done.stderr)


if __name__ == '__main__':
    ring_process.main()
