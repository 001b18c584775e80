"""ringctl up and down."""

import fcntl
import os
import signal
import subprocess
import tempfile

import ring_process
from ring_process import RingTest, plain_nodes, program


class UpDown(RingTest):
    def up(self, *arguments):
        done = self.ctl('--ring', self.ring, 'up', *arguments, '--detach', '--timeout', 60)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_of_all_rings_and_of_one_is_not_asked_for_together(self):
        self.start_ring(plain_nodes(2))
        for arguments in (['down', '--all', '--ring', self.ring], ['down', self.ring, '--ring', 'other'],
                          ['status', '--rings', '--ring', self.ring], ['traffic', 'show', '-r', 'file', '--ring', self.ring]):
            self.assertEqual(self.ctl(*arguments).returncode, 2, arguments)
        self.assertTrue(self.row(0))

    def test_under_nohup_outlives_its_terminal(self):
        up = self.start('up', [program('ringctl'), 'up', '--nodes', '2', '--ring', self.ring],
                        preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        self.wait_closed([0, 1])
        up.send_signal(signal.SIGHUP)
        self.assertEqual(self.ctl('ping', '1', '--from', '0', '-c', 3, '-i', '500ms').returncode, 0)
        self.assertIsNone(up.poll())
        up.send_signal(signal.SIGTERM)
        self.assertEqual(self.wait_exit(up), 0)

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

    def test_what_it_has_read_is_what_every_daemon_and_cpu_runs_until_the_next_one(self):
        def config_with(boot):
            return self.write_ring(plain_nodes(3), timeouts={'cpu_boot': boot})

        def boot_of(node):
            return self.port(node).ask({'do': 'config'})['cpu_boot_ms']

        self.assertEqual(self.ctl('up', config_with('3s'), '--detach', '--timeout', '60').returncode, 0)
        config_with('4s')
        for fault in (['kill'], ['start'], ['power_cycle']):
            self.assertEqual(self.ctl('fault', *fault, 'node1').returncode, 0, fault)
        self.assertEqual([boot_of(node) for node in range(3)], [3000] * 3)
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)
        self.assertEqual(self.ctl('up', config_with('4s'), '--detach', '--timeout', '60').returncode, 0)
        self.assertEqual([boot_of(node) for node in range(3)], [4000] * 3)
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)

    def test_logs_say_what_was_wrong_after_the_ring_is_down_until_it_is_started_again(self):
        logs = os.path.join(os.path.dirname(self.ring_folder()), '.logs', self.ring)
        for _ in range(2):
            self.assertEqual(self.ctl('up', '--nodes', '2', '--ring', self.ring, '--detach').returncode, 0)
            self.assertFalse(os.path.exists(logs))
            self.assertEqual(self.ctl('down', self.ring).returncode, 0)
            self.assertFalse(os.path.exists(self.ring_folder()))
            self.assertEqual(sorted(os.listdir(logs)), ['0.log', '1.log'])
        self.assertEqual(self.ctl('status', '--rings').stdout, 'no ring is running\n')

    def test_log_shows_what_a_node_printed_while_it_runs_and_after_it_has_ended(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = {'command': [self.script('talks', 'echo "my gear is stuck"\nexec %s\n'
                                                   % program('limb_firmware'))]}
        config = self.write_ring(nodes)
        foreground = self.start('up', [program('ringctl'), 'up', config])
        self.wait_closed([0, 1])
        kept_nowhere = self.ctl('log', 'node1')
        self.assertEqual(kept_nowhere.returncode, 1)
        self.assertIn("'ringctl up --detach' keeps it", kept_nowhere.stderr)
        foreground.send_signal(signal.SIGTERM)
        self.wait_exit(foreground)
        self.assertEqual(self.ctl('up', config, '--detach', '--timeout', '60').returncode, 0)
        self.wait('printed', lambda: 'my gear is stuck' in self.ctl('log', 'node1').stdout)
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)
        for node in 'node1', '1':
            after = self.ctl('log', node)  # the only ring that has left logs
            self.assertEqual(after.returncode, 0, after.stderr)
            self.assertIn('my gear is stuck', after.stdout)
        unknown = self.ctl('--ring', self.ring, 'log', 'node2')
        self.assertEqual(unknown.returncode, 2)
        self.assertIn("did you mean", unknown.stderr)
        self.assertEqual(self.ctl('--ring', 'other', 'log', 'node1').returncode, 3)

    def test_log_follows_until_the_ring_ends_and_status_names_it(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = {'command': [self.script('cpu', '[ ! -e "%s/broken" ] || { echo "no calibration"; exit 3; }\n'
                                                   'exec %s\n' % (self.folder, program('limb_firmware')))]}
        done = self.ctl('up', self.write_ring(nodes), '--detach', '--timeout', '60')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.wait_cpu(1, 'running')
        self.write('broken', '')
        self.assertEqual(self.ctl('fault', 'crash', 'node1').returncode, 0)
        self.wait('status names it', lambda: "'ringctl log node1' shows what it printed" in self.ctl('status').stdout)
        follow = self.start('log', [program('ringctl'), 'log', '-f', 'node1'])
        self.wait('shown', lambda: 'no calibration' in self.log_of(follow))
        os.kill(self.answered(0)['pid'], signal.SIGKILL)
        self.wait('status names the daemon', lambda: "the daemon of node0 has ended; 'ringctl log node0'"
                  in self.ctl('status').stdout)
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)
        self.assertEqual(self.wait_exit(follow), 0)
        self.assertIn('has ended', self.log_of(follow))

    def test_a_program_that_is_not_there_is_named_before_anything_is_started(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = {'command': ['limb_firmwar']}
        done = self.ctl('up', self.write_ring(nodes), '--detach')
        self.assertEqual(done.returncode, 2)
        self.assertIn("the CPU of node node1: no program 'limb_firmwar'", done.stderr)
        self.assertFalse(os.path.exists(self.ring_folder()))

    def test_of_two_at_once_one_starts_the_ring(self):
        command = [ring_process.program('ringctl'), '--ring', self.ring, 'up', '--nodes', '3', '--timeout', '60']
        ups = [self.start('up', command) for _ in range(4)]
        self.wait('all but one have ended', lambda: sum(up.poll() is None for up in ups) == 1)
        winner = next(up for up in ups if up.poll() is None)
        self.wait('said so', lambda: ' is closed: ' in self.log_of(winner))
        for up in ups:
            if up is not winner:
                self.assertEqual(up.returncode, 1)
                # Nobody is named in the moment between the winner's lock and its pid in it.
                self.assertRegex(self.log_of(up), r'is being started already, by (pid %d \(ringctl\)|another process)\n'
                                                  r'|is running already' % winner.pid)
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)
        self.assertEqual(self.wait_exit(winner), 0)
        self.assertFalse(os.path.exists(self.ring_folder()))

    def test_one_that_fails_leaves_no_folder_unless_something_was_in_it(self):
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = {'command': [self.script('ends_at_once', 'exit 7\n')]}
        config = self.write_ring(nodes)
        for more in ['--detach'], []:
            failed = self.ctl('up', config, '--timeout', 2, *more)
            self.assertEqual(failed.returncode, 1)
            self.assertIn('not closed within 2 s (--timeout); ', failed.stderr)
            self.assertIn('exit 7', failed.stderr)
            self.assertFalse(os.path.exists(self.ring_folder()))
        self.assertEqual(self.ctl('up', config, '--timeout', 2, '--record').returncode, 1)
        self.assertIn('1.record', os.listdir(self.ring_folder()))
        self.assertEqual(self.ctl('up', config, '--timeout', 2).returncode, 1)
        left = os.listdir(self.ring_folder())
        self.assertIn('1.boot', left)
        self.assertNotIn('up.lock', left)

    def test_down_does_not_touch_a_ring_that_is_being_started(self):
        os.makedirs(self.ring_folder(), 0o700)
        with open(os.path.join(self.ring_folder(), 'up.lock'), 'w') as lock:
            fcntl.lockf(lock, fcntl.LOCK_EX)
            down = self.ctl('down', self.ring)
            self.assertEqual(down.returncode, 1, down.stderr)
            self.assertIn('ring %s is being started, by ' % self.ring, down.stderr)
            self.assertEqual(os.listdir(self.ring_folder()), ['up.lock'])
        self.assertEqual(self.ctl('down', self.ring).returncode, 3)
        self.assertFalse(os.path.exists(self.ring_folder()))

    def test_a_timeout_that_would_not_count_is_refused(self):
        done = self.ctl('--ring', self.ring, 'up', '--nodes', 2, '--timeout', 5, '--respawn')
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn('--timeout does not go with --respawn', done.stderr)

    def test_down_ends_frozen_daemons_too(self):
        self.up('--nodes', 3)
        os.kill(self.answered(1)['pid'], signal.SIGSTOP)
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)
        self.assertFalse(os.path.exists(self.ring_folder()))

    def test_nothing_is_left_of_one_that_is_ended_while_it_starts(self):
        config = self.write_ring(plain_nodes(2) + [{'id': 2, 'name': 'node2', 'cpu': {'command': ['sleep', '1000']}}])
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            up = self.start('up', [ring_process.program('ringctl'), 'up', config, '--detach', '--timeout', '300'])
            pids = [self.answered(node)['pid'] for node in range(2)]
            up.send_signal(number)
            self.assertEqual(self.wait_exit(up), 1)
            self.assertTrue(all(ring_process.is_gone(pid) for pid in pids))
            self.assertFalse(os.path.exists(self.ring_folder()))

    def test_in_the_foreground_until_a_signal(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            up = self.start('up', [ring_process.program('ringctl'), '--ring', self.ring, 'up', '--nodes', '3'])
            self.wait('said so', lambda: ' is closed: ' in self.log_of(up))
            pids = [self.answered(node)['pid'] for node in range(3)]
            up.send_signal(number)
            self.assertEqual(self.wait_exit(up), 0)
            self.assertTrue(all(ring_process.is_gone(pid) for pid in pids))
            self.assertFalse(os.path.exists(self.ring_folder()))

    def test_recordings_stay_when_a_ring_in_the_foreground_is_ended(self):
        up = self.start('up', [ring_process.program('ringctl'), '--ring', self.ring, 'up', '--nodes', '2', '--record'])
        self.wait('said so', lambda: ' is closed: ' in self.log_of(up))
        up.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(up), 0)
        self.assertIn('1.record', os.listdir(self.ring_folder()))

    def test_daemons_die_with_a_foreground_up_that_is_killed(self):
        up = self.start('up', [ring_process.program('ringctl'), '--ring', self.ring, 'up', '--nodes', '3'])
        self.wait('said so', lambda: ' is closed: ' in self.log_of(up))
        pids = [self.answered(node)['pid'] for node in range(3)]
        up.kill()
        self.wait('daemons gone', lambda: all(ring_process.is_gone(pid) for pid in pids))

    def test_cpu_program_that_does_not_exist_fails_and_leaves_nothing(self):
        nodes = plain_nodes(3)
        nodes[2]['cpu'] = {'command': ['no_such_program']}
        up = self.ctl('up', self.write_ring(nodes), '--detach', '--timeout', 5)
        self.assertEqual(up.returncode, 2)
        self.assertIn('no_such_program', up.stderr)
        self.assertIn('node2', up.stderr)
        self.assertEqual(self.ctl('--ring', self.ring, 'status').returncode, 3)
        self.assertEqual(list(self.launcher.daemons_left()), [])

    def refusal_on_a_disk_of(self, size, *arguments):
        """What ringctl says that cannot do it, where the folders of rings and temporary files have so little room."""
        folder = tempfile.mkdtemp(prefix='small_disk_')
        self.addCleanup(os.rmdir, folder)
        script = 'mount -t tmpfs -o mode=700,size="$1" tmpfs "$2" || exit 77; shift 2; exec "$@"'
        done = subprocess.run(['unshare', '--mount', '--map-root-user', 'sh', '-c', script, 'sh', size, folder,
                               ring_process.program('ringctl'), *arguments],
                              env=dict(os.environ, XDG_RUNTIME_DIR=folder, TMPDIR=folder), text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60)
        if done.returncode not in (0, 1) or done.stderr.startswith('unshare:'):
            self.skipTest('no disk of our own can be mounted here: ' + done.stderr)
        self.assertEqual(done.returncode, 1)
        return done.stderr

    def up_on_a_disk_of(self, size):
        return self.refusal_on_a_disk_of(size, '--ring', self.ring, 'up', '--nodes', '3', '--detach')

    def test_a_disk_that_is_too_full_for_the_logs_is_named(self):
        self.assertRegex(self.up_on_a_disk_of('8k'), r'cannot write .*/[12]\.log: No space left on device')

    def test_a_daemon_can_say_that_the_disk_is_full(self):
        # The last log and the first daemon's lock ask for the same room, and either may be first.
        for _ in range(10):
            said = self.up_on_a_disk_of('16k')
            self.assertRegex(said, r'cannot write .*/[012]\.(lock|log): No space left on device')
            if '.lock' in said:
                return
        self.fail('no daemon has said it: ' + said)

    def test_a_live_scenario_names_the_full_disk(self):
        scenario = os.path.join(os.path.dirname(ring_process.__file__), '../scenarios/03-two-nodes-dead.yaml')
        said = self.refusal_on_a_disk_of('4k', 'scenario', 'run', '--live', scenario)
        self.assertRegex(said, r'/ring.yaml: not all could be written: No space left on device')

    def test_what_could_not_be_printed_is_an_error(self):
        for command in (('ringctl', 'fault', '--help'), ('ringctl', 'help'), ('ringd', '--options'), ('ringd', '--help'),
                        ('limb_firmware', '--help'),
                        ('ring_sim', 'run', '--nodes', '2')):
            with self.subTest(command), open('/dev/full', 'w') as full:
                done = subprocess.run([ring_process.program(command[0]), *command[1:]], stdout=full, text=True,
                                      stderr=subprocess.PIPE, timeout=60)
                self.assertEqual(done.returncode, 1)
                self.assertEqual(done.stderr, command[0] + ': standard output: not all could be written: '
                                 'No space left on device\n')

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

    def test_all_rings_are_listed_and_ended(self):
        self.assertEqual(self.ctl_json('status', '--rings'), [])
        self.assertIn('no ring is running', self.ctl('status', '--rings').stdout)
        first, second = self.ring, self.ring + 'b'
        self.up('--nodes', 2)
        self.ring = second
        self.up('--nodes', 3, '--clock', 'virtual')
        os.kill(self.ctl_json('--ring', first, 'status')['nodes'][1]['pid'], signal.SIGSTOP)   # it is listed, too
        live, virtual = self.ctl_json('status', '--rings')
        self.assertEqual(live, {'ring': first, 'nodes': 2, 'clock': 'live'})
        self.assertLessEqual({'ring': second, 'nodes': 3, 'clock': 'virtual', 'pace': 1.0}.items(), virtual.items())
        self.assertEqual(self.ctl('down', '--all', second).returncode, 2)
        self.assertEqual(self.ctl('down', '--all').returncode, 0)
        self.assertEqual(self.ctl_json('status', '--rings'), [])
        self.assertIn('no ring is running', self.ctl('down', '--all').stdout)

    def test_all_folders_of_dead_rings_are_removed_except_recordings(self):
        for ring, more in (('left', []), ('recorded', ['--record'])):
            self.assertEqual(self.ctl('--ring', ring, 'up', '--nodes', 2, '--detach', *more).returncode, 0)
            for row in self.ctl_json('--ring', ring, 'status')['nodes']:
                os.kill(row['pid'], signal.SIGKILL)
        self.wait('they are dead', lambda: self.ctl_json('status', '--rings') == [])
        self.assertIn('no ring is running', self.ctl('down', '--all').stdout)
        self.assertEqual(sorted(os.listdir(os.path.dirname(self.ring_folder()))), ['.logs', 'recorded'])

    def test_all_rings_are_ended_even_if_somebody_ends_one_meanwhile(self):
        nodes = plain_nodes(2)
        nodes[0]['cpu'] = {'command': [self.script('stubborn', "trap '' TERM\nwhile :; do sleep 1; done\n")]}
        self.start_ring(nodes)   # it takes its time to end
        for ring in ('s', 't'):
            self.assertEqual(self.ctl('up', '--nodes', 2, '--ring', ring, '--detach').returncode, 0)
        down = self.start('down', [ring_process.program('ringctl'), 'down', '--all'])
        self.wait('it to begin', lambda: self.row(1) is None)
        self.ctl('down', 's')
        self.assertEqual(self.wait_exit(down), 0, self.log_of(down))
        self.assertEqual(self.ctl_json('status', '--rings'), [])

    def up_respawning(self, *arguments):
        up = self.start('up', [ring_process.program('ringctl'), '--ring', self.ring, 'up', '--respawn',
                               *(str(argument) for argument in arguments)])
        self.wait('said so', lambda: 'is closed' in self.log_of(up))
        return up

    def test_respawning_starts_a_daemon_again_that_dies_and_says_so(self):
        up = self.up_respawning('--nodes', 3)
        before = self.answered(1)['pid']
        os.kill(before, signal.SIGKILL)
        self.wait('another daemon', lambda: (self.row(1) or {'pid': before})['pid'] != before)
        self.wait_closed(range(3))
        self.assertIn('node 1 (node1) ended: signal 9 (Killed)', self.log_of(up))
        self.assertIn('node 1 (node1) is started again', self.log_of(up))
        up.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(up), 0)
        self.assertEqual(list(self.launcher.daemons_left()), [])

    def test_respawning_runs_the_file_as_it_was_read_though_it_was_edited_meanwhile(self):
        for clock in 'machine', 'virtual':
            with self.subTest(clock=clock):
                self.ring += 's'
                config = self.write_ring(plain_nodes(3), timeouts={'cpu_boot': '3s'})
                up = self.up_respawning(config, '--clock', clock)
                self.write_ring(plain_nodes(3), timeouts={'cpu_boot': '4s'})
                before = self.answered(1)['pid']
                os.kill(before, signal.SIGKILL)
                self.wait('another daemon', lambda: (self.row(1) or {'pid': before})['pid'] != before)
                self.wait_closed(range(3))
                self.assertEqual([self.port(node).ask({'do': 'config'})['cpu_boot_ms'] for node in range(3)], [3000] * 3)
                up.send_signal(signal.SIGINT)
                self.assertEqual(self.wait_exit(up), 0)

    def test_respawning_does_not_restart_a_node_that_was_killed_on_purpose(self):
        up = self.up_respawning('--nodes', 4)
        killed = self.ctl('--ring', self.ring, 'fault', 'kill', 'node2')
        self.assertEqual(killed.returncode, 0, killed.stdout + killed.stderr)
        self.wait('said so', lambda: "node 2 (node2) was killed on purpose; 'ringctl fault start node2'" in
                  self.log_of(up))
        faults = self.ctl_json('--ring', self.ring, 'fault', 'list')['faults']
        self.assertEqual([fault['id'] for fault in faults], ['node2.kill'])
        self.assertEqual(self.ctl('--ring', self.ring, 'fault', 'start', 'node2').returncode, 0)
        self.wait_closed(range(4))
        self.assertNotIn('is started again', self.log_of(up))
        started = self.answered(2)['pid']
        up.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(up), 0)
        self.assertTrue(ring_process.is_gone(started))
        self.assertFalse(os.path.exists(self.ring_folder()))

    def test_a_kill_that_cannot_be_noted_is_not_done(self):
        up = self.up_respawning('--nodes', 3)
        os.mkdir(os.path.join(self.ring_folder(), '1.fault'))  # nobody can write there
        killed = self.ctl('--ring', self.ring, 'fault', 'kill', 'node1')
        self.assertEqual(killed.returncode, 1)
        self.assertIn('1.fault: Is a directory', killed.stderr)
        self.assertTrue(self.is_closed(range(3)))
        up.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(up), 0)

    def test_respawning_does_not_restart_a_ring_that_was_taken_down(self):
        up = self.up_respawning('--nodes', 3)
        os.kill(self.answered(1)['pid'], signal.SIGSTOP)  # one has to be killed
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)
        self.wait('said so', lambda: 'was taken down' in self.log_of(up))
        self.assertIsNone(up.poll())
        self.assertNotIn('is started again', self.log_of(up))
        self.up('--nodes', 3)  # by somebody else, who keeps it
        up.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(up), 0)
        self.assertTrue(self.is_closed(range(3)))
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)

    def test_respawning_ends_with_the_ring_if_its_starter_was_killed(self):
        script = self.script('launch', '%s --ring %s up --respawn --nodes 3 & echo $!; wait\n'
                             % (ring_process.program('ringctl'), self.ring))
        starter = self.start('launch', [script])
        self.wait_closed(range(3))
        up = int(self.log_of(starter).split()[0])
        starter.kill()
        starter.wait()
        self.assertTrue(self.is_closed(range(3)), 'the ring goes on')
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)
        self.wait('its end', lambda: ring_process.is_gone(up))

    def test_a_node_started_again_by_hand_is_taken_down_with_the_rest(self):
        up = self.up_respawning('--nodes', 3)
        for act in ('kill', 'start'):
            self.assertEqual(self.ctl('--ring', self.ring, 'fault', act, 'node2').returncode, 0)
        self.wait_closed(range(3))
        os.kill(self.answered(1)['pid'], signal.SIGSTOP)  # takes its time to end
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)
        self.wait('said so', lambda: 'was taken down' in self.log_of(up))
        self.assertNotIn('is started again', self.log_of(up))

    def test_respawning_ends_if_a_daemon_cannot_start(self):
        up = [ring_process.program('ringctl'), '--ring', self.ring, 'up', '--respawn', '--nodes', '3']
        os.makedirs(self.ring_folder(), 0o700)
        os.chmod(os.path.dirname(self.ring_folder()), 0o700)
        with open(self.socket_of(1, 'link'), 'w') as file:
            file.write('in the way')
        ended = self.start('up', up)
        self.assertEqual(self.wait_exit(ended), 1)
        self.assertIn(self.socket_of(1, 'link'), self.log_of(ended))
        self.assertEqual(list(self.launcher.daemons_left()), [])

    def test_a_number_of_nodes_beside_a_file_must_be_its_own(self):
        config = self.write_ring(plain_nodes(3))
        up = self.ctl('up', config, '--nodes', 5, '--detach')
        self.assertEqual(up.returncode, 2)
        self.assertIn('--nodes is 5, but ' + config + ' has 3 nodes', up.stderr)
        self.up(config, '--nodes', 3)
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)

    def test_ring_of_64_nodes(self):
        self.up(self.write_ring(plain_nodes(64)))
        self.assertEqual(self.ctl_json('ping', '--from', 0, '--to', 63, '--count', 50)['delivered'], 50)
        self.assertEqual(self.ctl_json('ping', '--from', 'node63', '--to', 'node0')['delivered'], 10)
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)


if __name__ == '__main__':
    ring_process.main()
