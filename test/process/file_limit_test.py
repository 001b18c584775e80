"""Programs whose files may not get longer than some size (ulimit -f): the signal that the kernel sends does not end them."""

import os
import resource
import signal

import ring_process
from ring_process import RingTest, plain_nodes


def limited_to(size):
    """As a shell's ulimit -f: programs are started with the usual signals."""
    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
    return limit


class FileLimit(RingTest):
    def test_a_recording_that_cannot_be_saved_is_reported(self):
        self.start_ring(plain_nodes(2), recorder={'enabled': True, 'size': 1048576})
        full = self.ctl('record', 'save', os.path.join(self.folder, 'saved'), preexec_fn=limited_to(1000))
        self.assertEqual(full.returncode, 1, full.stderr)
        self.assertIn('saved/0.record: File too large', full.stderr)

    def test_a_recorder_without_room_for_its_file_ends_the_daemon_with_the_reason(self):
        config = self.write_ring(plain_nodes(2), recorder={'enabled': True, 'size': 1048576})
        daemon = self.run_program('ringd', '--config', config, '--node', 0, preexec_fn=limited_to(100000))
        self.assertEqual(daemon.returncode, 1, daemon.stderr)
        self.assertRegex(daemon.stderr, 'ringd: no room for .*0.record.new: File too large')

    def test_a_line_without_room_for_its_queue_ends_the_daemon_with_the_reason(self):
        config = self.write_ring(plain_nodes(2))
        up = self.ctl('up', config, '--detach', '--timeout', 60, preexec_fn=limited_to(4096))
        self.assertEqual(up.returncode, 1, up.stderr)
        self.assertIn('cannot make the queue of a line: File too large', up.stderr)

    def test_a_log_without_room_for_last_words_is_reported(self):
        up = self.ctl('up', self.write_ring(plain_nodes(2)), '--detach', preexec_fn=limited_to(1000))
        self.assertEqual(up.returncode, 1, up.stderr)
        self.assertRegex(up.stderr, r'cannot write .*\.log: File too large')

    def test_programs_that_are_started_get_the_signal_as_ever(self):
        script = self.script('cpu', 'grep SigIgn /proc/self/status > %s/ignored\nexec %s\n'
                             % (self.folder, ring_process.program('limb_firmware')))
        nodes = plain_nodes(2)
        nodes[1]['cpu'] = {'command': [script]}
        self.start_ring(nodes)
        self.wait_cpu(1, 'running')
        with open(os.path.join(self.folder, 'ignored')) as file:
            self.assertEqual(int(file.read().split()[1], 16) & 1 << (signal.SIGXFSZ - 1), 0)


if __name__ == '__main__':
    ring_process.main()
