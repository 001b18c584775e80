"""ringctl traffic judge: a ring's promises judged from outside, and recordings that save themselves."""

import glob
import json
import mmap
import os
import re
import resource
import shutil
import signal
import struct
import zlib

import ring_process
from ring_process import RingTest, plain_nodes, program
from limb_ring import Observed

TAKEN = 2   # Observation::Kind


class WatchingTest(RingTest):
    def watch(self, *arguments):
        return self.start('watch', [program('ringctl'), 'traffic', 'judge', *arguments])

    def is_watched(self, node):
        return os.path.exists(os.path.join(self.ring_folder(), '%d.watch' % node))

    @staticmethod
    def size_of(file):
        try:
            return os.path.getsize(file)
        except FileNotFoundError:   # it is being made
            return None

    def end(self, watch):
        watch.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(watch), 0, self.log_of(watch))
        return self.log_of(watch)


class Watching(WatchingTest):
    def test_finds_nothing_while_nodes_die_and_come_back(self):
        daemons = self.start_ring(plain_nodes(4))
        watch = self.watch()
        self.wait('all watched', lambda: all(self.is_watched(node) for node in range(4)))
        self.send_delivered(0, 2)
        self.send_delivered(1, 255)
        daemons[3].kill()
        self.wait('a ring of three', lambda: self.answered(0)['ring_size'] == 3)
        self.send_delivered(0, 2)
        os.remove(os.path.join(self.ring_folder(), '3.watch'))  # of the dead one
        self.ringd(os.path.join(self.folder, 'ring.yaml'), 3)
        self.wait('a ring of four', lambda: self.row(3) and self.answered(0)['ring_size'] == 4)
        self.wait('the new one is watched', lambda: self.is_watched(3))
        self.send_delivered(0, 3)
        said = self.end(watch)
        self.assertIn('every promise was kept', said)
        self.assertIn('200 sends', said)

    def test_goes_on_if_the_file_of_a_node_is_truncated(self):
        daemons = self.start_ring(plain_nodes(3))
        watch = self.watch()
        self.wait('all watched', lambda: all(self.is_watched(node) for node in range(3)))
        self.send_delivered(0, 2)
        file = os.path.join(self.ring_folder(), '1.watch')
        size = os.path.getsize(file)
        os.truncate(file, 0)
        self.wait('it is made again', lambda: self.size_of(file) == size)
        self.send_delivered(0, 2)
        self.assertEqual([daemon.poll() for daemon in daemons.values()], [None] * 3)
        self.assertIn('every promise was kept', self.end(watch))

    def test_finds_nothing_if_a_cpu_babbled_before_it_started(self):
        self.start_ring(plain_nodes(3))
        self.assertEqual(self.ctl('fault', 'babble', 'node1').returncode, 0)
        hits = self.babbled_at(1)
        watch = self.watch()
        self.wait('all watched', lambda: all(self.is_watched(node) for node in range(3)))
        self.wait('a thousand packets more', lambda: self.babbled_at(1) > hits + 1000)
        self.assertEqual(self.ctl('fault', 'clear').returncode, 0)
        self.send_delivered(1, 2)
        self.assertIn('every promise was kept', self.end(watch))

    def babbled_at(self, node):
        fault, = self.answered(node)['faults']
        return fault['hits']

    def test_ends_by_itself_and_costs_nothing_afterwards(self):
        self.start_ring(plain_nodes(2))
        done = self.ctl('traffic', 'judge', self.ring, '--for', 0.3, '--json')
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)
        self.assertEqual((told['broken'], told['not_judged']), (0, 0))
        self.wait('no file is left', lambda: not self.is_watched(0) and not self.is_watched(1))

    def test_ends_with_the_ring(self):
        self.start_ring(plain_nodes(2))
        watch = self.watch()
        self.wait('all watched', lambda: self.is_watched(0) and self.is_watched(1))
        self.assertEqual(self.ctl('down').returncode, 0)
        self.assertEqual(self.wait_exit(watch), 0)
        self.assertIn('was taken down', self.log_of(watch))
        self.assertIn('every promise was kept', self.log_of(watch))

    def test_claims_nothing_about_nodes_that_it_could_not_watch(self):
        self.start_ring(plain_nodes(8))
        for limit in 10, 12:  # of them one for each node, and for what a program needs
            def few_descriptors():
                resource.setrlimit(resource.RLIMIT_NOFILE, (limit, limit))
            done = self.ctl('traffic', 'judge', '--for', 0.5, preexec_fn=few_descriptors)
            self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
            self.assertIn('Too many open files', done.stderr)
            self.assertNotIn('was kept', done.stdout)
            self.assertNotIn('was taken down', done.stderr)
            self.assertRegex(done.stdout, 'nodes? not watched, and not judged')

    def test_without_a_ring_it_says_so(self):
        self.assertEqual(self.ctl('traffic', 'judge', 'no_such_ring').returncode, 3)

    def test_a_node_that_cannot_be_watched_is_named_and_no_ring_that_is_missing(self):
        self.start_ring(plain_nodes(2))
        os.mkdir(os.path.join(self.ring_folder(), '1.watch'))   # where its file would be
        done = self.ctl('traffic', 'judge', '--for', '30')
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn('node 1: cannot make', done.stderr)

    def test_one_that_starts_after_the_runtime_folder_was_removed_sees_what_others_see(self):
        self.start_ring(plain_nodes(2))
        others = [self.port(node) for node in range(2)]
        for other in others:
            other.observe_text('{"promises": true}')
            other.next_of(Observed)
        shutil.rmtree(self.ring_folder())
        self.wait('the folder is made again', lambda: self.is_closed(range(2)))
        for other in others:
            self.assertTrue(os.path.exists(other.next_of(Observed).content['path']))
        watch = self.watch('--for', '3s')
        self.assertEqual(self.wait_exit(watch), 0, self.log_of(watch))
        self.assertIn('every promise was kept', self.log_of(watch))

    def test_recordings_are_judged_as_well(self):
        self.start_ring(plain_nodes(3), recorder={'enabled': True, 'size': 1048576})
        self.send_delivered(0, 2)
        saved = os.path.join(self.folder, 'saved')
        self.assertEqual(self.ctl('record', 'save', saved).returncode, 0)
        done = self.run_program('ringctl', 'record', 'check', saved)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn('promises: all kept; 50 sends', done.stdout)


class SavedByThemselves(WatchingTest):
    def up(self, when, **more):
        self.saves = os.path.join(self.folder, 'saves')
        config = self.write_ring(plain_nodes(3), recorder=dict(
            {'enabled': True, 'size': 1048576, 'save': when, 'folder': 'saves'}, **more))
        done = self.ctl('up', config, '--detach', '--timeout', 60)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.addCleanup(self.ctl, 'down', self.ring)
        log = os.path.join(self.ring_folder(), 'keep.log')
        self.wait('it is kept', lambda: os.path.exists(log) and 'when something goes wrong' in self.read(log))
        return log

    def keeper(self):
        """The pid of the keeper of recordings."""
        for command in glob.glob('/proc/[0-9]*/cmdline'):
            try:
                words = self.read(command).split('\0')
            except OSError:
                continue   # it has ended
            if 'keep' in words and self.ring in words:
                return int(command.split('/')[2])
        self.fail('no keeper is there')

    def stop_keeper(self):
        keeper = self.keeper()
        os.kill(keeper, signal.SIGSTOP)
        self.wait('it stands still', lambda: 'State:\tT' in self.read('/proc/%d/status' % keeper))
        return keeper

    def let_look(self, keeper):
        """It sleeps once after each look."""
        def sleeps():
            return int(re.search(r'^voluntary_ctxt_switches:\s*(\d+)', self.read('/proc/%d/status' % keeper), re.M).group(1))
        before = sleeps()
        self.wait('the keeper looks some times', lambda: sleeps() > before + 5)

    def saved(self):
        return sorted(os.listdir(self.saves)) if os.path.isdir(self.saves) else []

    def replay(self, folder):
        done = self.run_program('ringctl', 'record', 'check', folder)
        self.assertEqual(done.returncode, 0, done.stdout)

    def read(self, log):
        with open(log, errors='replace') as file:   # other tests give programs bytes that are no text
            return file.read()

    def test_when_a_daemon_crashes_but_not_when_one_is_ended(self):
        log = self.up(['crash'])
        keeper = self.stop_keeper()   # so that it looks only when node 2 is back
        for fault in 'kill', 'start':
            done = self.ctl('fault', fault, 'node2')
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        os.kill(keeper, signal.SIGCONT)
        self.let_look(keeper)
        self.wait('the ring is closed', lambda: self.is_closed(range(3)))
        os.kill(self.answered(1)['pid'], signal.SIGKILL)
        self.wait('saved', lambda: 'recordings are saved in' in self.read(log))
        saved, = self.saved()
        self.assertRegex(saved, '^%s-.*-crash$' % self.ring)
        self.assertIn('node 1 (node1) has crashed', self.read(log))
        self.assertIn('1.record', os.listdir(os.path.join(self.saves, saved)))
        self.replay(os.path.join(self.saves, saved))

    def falsify_what_was_taken(self, node, data):
        """In what the node lets see, its CPU gets other data (judge/promise.h)."""
        with open(os.path.join(self.ring_folder(), '%d.watch' % node), 'r+b') as file:
            seen = mmap.mmap(file.fileno(), 0)
            content = struct.pack('<I', zlib.crc32(data))
            self.wait('it is taken', lambda: seen.find(content) != -1)   # delivered is before that
            at = seen.find(content)
            self.assertEqual(seen[at + 14], TAKEN)
            seen[at] ^= 1
            seen.close()

    def test_when_a_promise_is_broken(self):
        log = self.up(['promise'])
        self.wait('it is watched', lambda: all(self.is_watched(node) for node in range(3)))
        self.let_look(self.keeper())   # at all of them, before it judges what they send
        keeper = self.stop_keeper()
        self.send_delivered(0, 2, count=1)
        self.falsify_what_was_taken(2, b'packet 0')
        os.kill(keeper, signal.SIGCONT)
        self.wait('saved', lambda: 'recordings are saved in' in self.read(log))
        saved, = self.saved()
        self.assertRegex(saved, '-promise$')
        self.assertIn('promise broken: ', self.read(log))
        self.replay(os.path.join(self.saves, saved))

    def test_when_a_break_is_located(self):
        log = self.up(['break'], keep=1)
        self.assertEqual(self.ctl('fault', 'cut', 'node0:node1').returncode, 0)
        self.wait('saved', lambda: 'the line from node 0 to 1 is broken' in self.read(log))
        saved, = self.saved()
        self.assertRegex(saved, '-break$')

    def test_a_crash_soon_after_another_save(self):
        log = self.up(['break', 'crash'])
        self.assertEqual(self.ctl('fault', 'cut', 'node0:node1').returncode, 0)
        self.wait('saved', lambda: 'recordings are saved in' in self.read(log))
        os.kill(self.answered(2)['pid'], signal.SIGKILL)
        self.wait('saved again', lambda: self.read(log).count('recordings are saved in') == 2)
        self.assertEqual([name.rsplit('-', 1)[1] for name in self.saved()], ['break', 'crash'])

    def test_a_crash_before_the_keeper_looks(self):
        daemons = self.start_ring(plain_nodes(3), recorder={'enabled': True, 'size': 1048576})
        daemons[2].kill()
        daemons[2].wait()
        self.saves = os.path.join(self.folder, 'saves')
        keeper = self.start('keep', [program('ringctl'), '--ring', self.ring, 'record', 'keep', self.saves])
        self.wait('a save', lambda: 'node 2 (node2) has crashed; recordings are saved in' in self.log_of(keeper))
        self.assertEqual(len(self.saved()), 1)

    def test_even_if_a_node_cannot_be_watched(self):
        daemons = self.start_ring(plain_nodes(3), recorder={'enabled': True, 'size': 1048576})
        os.mkdir(os.path.join(self.ring_folder(), '1.watch'))   # where its file would be
        self.saves = os.path.join(self.folder, 'saves')
        keeper = self.start('keep', [program('ringctl'), '--ring', self.ring, 'record', 'keep', self.saves])
        self.wait('it says so', lambda: 'not all promises are judged: node 1' in self.log_of(keeper))
        daemons[2].kill()
        self.wait('a save', lambda: len(self.saved()) == 1)

    def test_its_keeper_ends_with_the_ring_though_another_of_its_name_follows(self):
        self.up(['crash'])
        keeper = self.stop_keeper()   # so that it looks only when the other ring is there
        self.assertEqual(self.ctl('down').returncode, 0)
        config = self.write_ring(plain_nodes(3))
        done = self.ctl('up', config, '--detach', '--timeout', 60)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        os.kill(keeper, signal.SIGCONT)
        self.wait('it has ended', lambda: not os.path.exists('/proc/%d' % keeper))

    def test_and_the_oldest_are_removed(self):
        self.up(['crash'], keep=2)
        for i in range(3):
            os.makedirs(os.path.join(self.saves, '%s-2020-01-01_00000%d_000-crash' % (self.ring, i)))
        os.makedirs(os.path.join(self.saves, 'other-2020'))
        os.kill(self.answered(1)['pid'], signal.SIGKILL)
        left = '%s-2020-01-01_000002_000-crash' % self.ring
        self.wait('only the newest are left', lambda: len(self.saved()) == 3 and left in self.saved())
        self.assertIn('other-2020', self.saved())


if __name__ == '__main__':
    ring_process.main()
