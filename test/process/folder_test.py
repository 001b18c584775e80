"""The ring's folder: private, possible, tidy."""

import fcntl
import os
import shutil
import signal
import stat

import ring_process
from ring_process import RingTest, plain_nodes, program


class Folder(RingTest):
    @staticmethod
    def read(path):
        with open(path) as file:
            return file.read()

    def make_ring_folder(self):
        for folder in (os.path.dirname(self.ring_folder()), self.ring_folder()):
            os.makedirs(folder, 0o700, exist_ok=True)

    def assert_cannot_run(self, *expected):
        config = self.write_ring(plain_nodes(2))
        ended = self.run_ringd('--config', config, '--node', 0)
        self.assertEqual(ended.returncode, 1, ended.stderr)
        for part in expected:
            self.assertIn(part, ended.stderr)

    def test_is_private(self):
        self.start_ring(plain_nodes(2))
        for folder in (os.path.dirname(self.ring_folder()), self.ring_folder()):
            self.assertEqual(stat.S_IMODE(os.stat(folder).st_mode), 0o700)
        self.assertEqual(stat.S_IMODE(os.stat(self.socket_of(0)).st_mode), 0o600)

    def test_whose_plain_files_a_cleaner_has_removed_is_still_the_folder_of_a_ring_for_every_command(self):
        daemons = self.start_ring(plain_nodes(2))
        for node in daemons:
            os.kill(daemons[node].pid, signal.SIGSTOP)  # they would make the files again
        for file in os.listdir(self.ring_folder()):
            if stat.S_ISREG(os.lstat(os.path.join(self.ring_folder(), file)).st_mode):
                os.remove(os.path.join(self.ring_folder(), file))
        self.assertIn(self.ring, self.ctl('status', '--rings').stdout)
        again = self.ctl('up', os.path.join(self.folder, 'ring.yaml'), '--detach')
        self.assertEqual(again.returncode, 1, again.stderr)
        self.assertIn('is running already', again.stderr)
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)
        for node in daemons:
            self.wait_exit(daemons[node])

    def test_is_locked_as_cleaners_of_temporary_files_respect_it(self):
        self.start_ring(plain_nodes(2))
        folder = os.open(self.ring_folder(), os.O_RDONLY)
        with self.assertRaises(BlockingIOError):
            fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
        os.close(folder)

    def test_open_to_others_is_refused(self):
        self.make_ring_folder()
        os.chmod(self.ring_folder(), 0o755)
        self.assert_cannot_run(self.ring_folder(), '0700')

    def test_link_in_its_place_is_refused(self):
        os.makedirs(os.path.join(self.folder, 'elsewhere'), 0o700)
        os.makedirs(os.path.dirname(self.ring_folder()), 0o700)
        os.symlink(os.path.join(self.folder, 'elsewhere'), self.ring_folder())
        self.assert_cannot_run(self.ring_folder(), 'symbolic link')

    def test_that_cannot_be_made_is_named(self):
        self.environment['XDG_RUNTIME_DIR'] = self.write('a_file', '')
        self.assert_cannot_run('a_file')
        self.environment['XDG_RUNTIME_DIR'] = os.path.join(self.folder, 'missing')
        self.assert_cannot_run('missing', 'XDG_RUNTIME_DIR has to name a folder')

    def test_too_long_for_a_socket_is_refused(self):
        deep = os.path.join(self.folder, 'd' * 60)
        os.makedirs(deep, 0o700)
        self.environment['XDG_RUNTIME_DIR'] = deep
        self.ring = 'r' * 32
        self.assert_cannot_run('107', deep)
        up = self.ctl('up', os.path.join(self.folder, 'ring.yaml'), '--detach')
        self.assertEqual(up.returncode, 2)
        self.assertIn('107', up.stderr)

    def test_something_else_at_a_sockets_place_is_not_removed(self):
        for kind in ('host', 'link'):
            with self.subTest(kind=kind):
                self.ring += 's'
                self.make_ring_folder()
                with open(self.socket_of(0, kind), 'w') as file:
                    file.write('precious')
                self.assert_cannot_run(self.socket_of(0, kind))
                self.assertTrue(os.path.isfile(self.socket_of(0, kind)))

    def test_a_fifo_among_its_files_is_named_and_keeps_nobody_waiting(self):
        self.start_ring(plain_nodes(2))
        fifos = [os.path.join(self.ring_folder(), name) for name in ('1.fault', '9.lock')]
        for fifo in fifos:
            os.mkfifo(fifo)
        for command in (['status', '--rings'], ['status'], ['fault', 'list'], ['down']):
            with self.subTest(command=command):
                done = self.ctl(*command)
                self.assertEqual(done.returncode, 0, done.stderr)
                for fifo in fifos:
                    self.assertIn('%s is a FIFO, not a regular file' % fifo, done.stderr)
        self.assertFalse(os.path.exists(self.ring_folder()))

    def test_a_fifo_in_place_of_a_log_is_named_and_keeps_nobody_waiting(self):
        self.make_ring_folder()
        log = os.path.join(self.ring_folder(), '1.log')
        os.mkfifo(log)
        config = self.write_ring(plain_nodes(2))
        up = self.ctl('up', config, '--detach')
        self.assertEqual(up.returncode, 1)
        self.assertIn('cannot write %s: it is a FIFO, not a regular file; remove it' % log, up.stderr)
        os.remove(log)
        self.assertEqual(self.ctl('up', config, '--detach').returncode, 0)
        self.assertEqual(self.ctl('fault', 'kill', '1').returncode, 0)
        os.remove(log)
        os.mkfifo(log)
        start = self.ctl('fault', 'start', '1')
        self.assertEqual(start.returncode, 1)
        self.assertIn('is a FIFO, not a regular file; remove it', start.stderr)
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)

    def test_is_not_filled_by_a_cpu_that_writes_all_the_time(self):
        # In one write: what came behind a new beginning would stay in the log.
        in_one_write = 'dd bs=6000000 iflag=fullblock status=none'
        script = self.script('talks', 'head -c 6000000 /dev/zero | tr "\\0" x | %s\nexec %s\n' %
                             (in_one_write, program('limb_firmware')))
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = {'command': [script]}
        for clock in 'machine', 'virtual':
            with self.subTest(clock=clock):
                self.ring += 's'
                done = self.ctl('up', self.write_ring(nodes), '--clock', clock, '--detach', '--timeout', 60)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                log = os.path.join(self.ring_folder(), '1.log' if clock == 'machine' else 'ring.log')
                self.wait('a new beginning', lambda: 'more than 4 MiB, and begins again' in self.read(log))
                self.assertLess(os.path.getsize(log), 10000)
                self.assertEqual(self.ctl('down', self.ring).returncode, 0)

    def test_its_log_stays_small_while_a_cpu_writes_as_fast_as_it_can(self):
        script = self.script('talks', 'for i in $(seq 100); do head -c 4000000 /dev/zero; sleep 0.01; done\n'
                             'exec %s\n' % program('limb_firmware'))
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = {'command': [script]}
        config = self.write_ring(nodes, timeouts={'cpu_boot': '60s'})
        up = self.start('up', [program('ringctl'), 'up', config, '--detach', '--timeout', '60'])
        log = os.path.join(self.ring_folder(), '1.log')
        longest = 0
        while up.poll() is None:  # the CPU has booted then
            longest = max(longest, os.path.exists(log) and os.path.getsize(log))
        self.assertEqual(up.returncode, 0, self.log_of(up))
        self.assertEqual(self.ctl('down', self.ring).returncode, 0)
        self.assertLess(longest, 60000000, 'of 400 million bytes')

    def test_without_a_runtime_folder_is_a_private_one_below_the_temporary_folder(self):
        del self.environment['XDG_RUNTIME_DIR']
        self.environment['TMPDIR'] = self.folder
        config = self.write_ring(plain_nodes(2))
        for node in range(2):
            self.ringd(config, node)
        folder = os.path.join(self.folder, 'limb_ring-%d' % os.geteuid())
        self.wait('the ring closed', lambda: self.ctl('--ring', self.ring, 'wait', 'up').returncode == 0)
        self.assertEqual(stat.S_IMODE(os.stat(folder).st_mode), 0o700)

    def test_daemon_without_standard_descriptors_leaves_its_lock_file_alone(self):
        config = self.write_ring(plain_nodes(2))
        shell = self.script('closed', 'exec %s --config %s --node "$1" <&- >&- 2>&-' % (program('ringd'), config))
        daemons = [self.start('closed', [shell, str(node)]) for node in range(2)]
        self.wait_closed(range(2))
        with open(os.path.join(self.ring_folder(), '0.lock')) as lock:
            self.assertEqual(lock.readline(), '%d\n' % daemons[0].pid)
        for fd in range(3):
            self.assertEqual(os.readlink('/proc/%d/fd/%d' % (daemons[0].pid, fd)), '/dev/null')

    def pids(self):
        return [row['pid'] for row in self.ctl_json('--ring', self.ring, 'status')['nodes']]

    def test_removed_under_a_ring_is_made_again_and_nobody_starts_a_second_one(self):
        self.start_ring(plain_nodes(3), redundancy='foldback')
        before = self.pids()
        shutil.rmtree(os.path.dirname(self.ring_folder()))
        self.wait('folder made again', lambda: all(os.path.exists(self.socket_of(node, kind)) for node in range(3)
                                                   for kind in ('host', 'link', 'link2', 'lock')))
        self.wait_closed(range(3))   # a socket's file is there just before it listens
        self.assertEqual(self.pids(), before)
        up = self.ctl('up', os.path.join(self.folder, 'ring.yaml'), '--detach')
        self.assertEqual(up.returncode, 1)
        self.assertIn('is running already', up.stderr)
        # New connections find the new sockets: of tools above, of neighbours here.
        self.assertEqual(self.ctl('--ring', self.ring, 'fault', 'power_cycle', 'all').returncode, 0)
        self.wait_closed(range(3))

    def test_a_name_that_is_removed_is_made_again(self):
        self.start_ring(plain_nodes(2))
        os.unlink(self.socket_of('node1'))
        self.wait('the name made again', lambda: os.path.exists(self.socket_of('node1')))
        self.wait('the node found by it', lambda: self.row('node1'))

    def test_a_lines_socket_that_is_removed_is_made_again(self):
        self.start_ring(plain_nodes(2), redundancy='foldback')
        for kind in 'link', 'link2':
            os.unlink(self.socket_of(1, kind))
            self.wait('the socket made again', lambda: os.path.exists(self.socket_of(1, kind)))
        # A neighbour that is started anew finds it.
        self.assertEqual(self.ctl('--ring', self.ring, 'fault', 'power_cycle', 'node0').returncode, 0)
        self.wait_closed(range(2))

    def test_removed_and_taken_by_another_daemon_ends_the_first_which_leaves_its_files_alone(self):
        config = self.write_ring(plain_nodes(2))
        first = self.ringd(config, 0)
        self.wait('first listens', lambda: os.path.exists(self.socket_of(0)))
        first.send_signal(signal.SIGSTOP)
        shutil.rmtree(self.ring_folder())
        second = self.ringd(config, 0)
        self.wait('second listens', lambda: os.path.exists(self.socket_of(0)))
        first.send_signal(signal.SIGCONT)
        self.assertEqual(self.wait_exit(first), 1)
        self.assertIn('held by pid %d' % second.pid, self.log_of(first))
        self.ringd(config, 1)
        self.wait_closed([0, 1])
        self.assertEqual(self.answered(0)['pid'], second.pid)


if __name__ == '__main__':
    ring_process.main()
