"""Flight recorders of a live ring: saved while it goes on, also of dead nodes, and replayed."""

import os
import re
import resource
import shutil
import signal

import ring_process
from ring_process import RingTest, plain_nodes


class Recorder(RingTest):
    def setUp(self):
        super().setUp()
        self.saved = os.path.join(self.folder, 'saved')

    def save(self, folder=None):
        done = self.ctl('record', 'save', folder or self.saved)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def replay(self, *arguments, code=0):
        done = self.run_program('ringctl', 'record', 'check', *arguments)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def test_of_living_dead_and_restarted_nodes_are_replayed(self):
        daemons = self.start_ring(plain_nodes(4), recorder={'enabled': True, 'size': 1048576}, redundancy='foldback')
        self.send_delivered(0, 2)
        daemons[3].kill()
        self.wait('a ring of three', lambda: self.answered(0)['ring_size'] == 3)
        self.send_delivered(0, 2)
        self.ringd(os.path.join(self.folder, 'ring.yaml'), 3)
        self.wait('a ring of four', lambda: self.row(3) and self.answered(0)['ring_size'] == 4)
        self.assertEqual(self.ctl('fault', 'cut', 'node0:node1').returncode, 0)
        self.wait('folded', lambda: {self.answered(i)['state'] for i in range(4)} == {'folded'})
        daemons[1].kill()
        daemons[1].wait()
        said = self.save()
        self.assertIn('5 recordings', said)
        date = r'\d{4}-\d\d-\d\d \d\d:\d\d:\d\d'
        self.assertRegex(said, 'of lives that have ended:\n  1.record: node1, begun %s\n'
                         '  3.record.former: node3, begun %s\n$' % (date, date))
        self.assertEqual(sorted(os.listdir(self.saved)),
                         ['0.record', '1.record', '2.record', '3.record', '3.record.former'])
        said = self.replay(self.saved)
        self.assertIn('5 lives of nodes', said)
        self.assertIn('all identical', said)
        self.assertIn('node 3 (node3, the life before)', said)

    def test_that_a_full_disk_cannot_take_leave_no_part_behind(self):
        def full_disk():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))

        self.start_ring(plain_nodes(2), recorder={'enabled': True, 'size': 1048576})
        full = self.ctl('record', 'save', self.saved, preexec_fn=full_disk)
        self.assertEqual(full.returncode, 1, full.stderr)
        self.assertIn('saved/0.record: File too large', full.stderr)
        self.assertIn('2 recordings', self.save())

    def test_that_are_cut_off_or_removed_under_a_node_are_made_again(self):
        daemons = self.start_ring(plain_nodes(3), recorder={'enabled': True, 'size': 1048576})
        recordings = [os.path.join(self.ring_folder(), '%d.record' % node) for node in (0, 1)]
        os.truncate(recordings[0], 0)
        os.remove(recordings[1])
        for recording in recordings:
            self.wait('it is made again', lambda: os.path.exists(recording) and os.path.getsize(recording) == 1048576)
        self.send_delivered(0, 1)
        self.assertEqual([daemon.poll() for daemon in daemons.values()], [None] * 3)
        self.assertIn('3 recordings', self.save())
        self.assertIn('all identical', self.replay(self.saved))

    def test_keep_says_at_once_that_it_cannot_save(self):
        self.start_ring(plain_nodes(2))
        done = self.ctl('--ring', self.ring, 'record', 'keep', self.saved)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('has no recordings', done.stderr)
        self.assertFalse(os.path.exists(self.saved))
        self.ring += 'r'
        self.start_ring(plain_nodes(2), recorder={'enabled': True})
        done = self.ctl('--ring', self.ring, 'record', 'keep', os.path.join(self.write('a_file', ''), 'saves'))
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn('cannot make the folder', done.stderr)

    def test_are_those_of_the_ring_that_the_environment_names(self):
        self.start_ring(plain_nodes(2), recorder={'enabled': True})
        first, self.ring = self.ring, self.ring + 'r'
        self.start_ring(plain_nodes(2), recorder={'enabled': True})
        named = dict(self.environment, LIMB_RING_RING=first)
        done = self.ctl('record', 'save', self.saved, env=named)
        self.assertIn('2 recordings of ring %s,' % first, done.stdout, done.stderr)
        for command in ('save', 'keep'):
            done = self.ctl('--ring', 'no/ring', 'record', command, self.saved + '2')
            self.assertEqual(done.returncode, 2, done.stderr)

    def test_that_could_not_be_saved_are_named_before_anything_is_started(self):
        place = os.path.join(self.write('a_file', ''), 'saves')
        config = self.write_ring(plain_nodes(2), recorder={'enabled': True, 'save': ['crash'], 'folder': place})
        up = self.ctl('up', config, '--detach')
        self.assertEqual(up.returncode, 2, up.stderr)
        self.assertIn("ring.yaml: entry 'recorder.folder': cannot make the folder %s: " % place, up.stderr)
        self.assertFalse(os.path.exists(self.ring_folder()))

    def test_are_a_capture_and_a_state_too(self):
        self.start_ring(plain_nodes(3), recorder={'enabled': True})
        self.send_delivered(1, 2, 3)
        self.save()
        state = self.replay(self.saved, '--until', '1e6', '--node', 'node2')
        self.assertIn('membership.ring_size 3', state)
        self.assertNotIn('node 1 (node1), what', state)
        records = self.replay(self.saved, '--node', '2', '--print')
        self.assertIn(b'packet 2'.hex(), records)
        capture = os.path.join(self.folder, 'lines.pcapng')
        self.replay(self.saved, '--capture', capture)
        trace = self.run_program('ringctl', 'traffic', 'why', capture, '-n', '1')
        self.assertEqual(trace.returncode, 0, trace.stderr)
        self.assertIn('came home', trace.stdout)

    def test_are_replayed_until_exactly_the_time_that_is_given(self):
        self.start_ring(plain_nodes(2), recorder={'enabled': True})
        self.send_delivered(0, 1, 300)  # of a fiftieth of the times a double, times 1e9, is too small
        self.save()

        def times(*until):
            return re.findall(r'(?m)^(\d+\.\d{9}) s  ', self.replay(self.saved, '--node', '1', '--print', *until))
        recorded = times()
        rounded_down = [at for at in recorded if int(float(at) * 1e9) != int(at.replace('.', ''))]
        for at in rounded_down[:5] + recorded[-1:]:
            self.assertEqual(times('--until', at)[-1], at)

    def test_that_were_changed_or_are_invalid_are_refused(self):
        self.start_ring(plain_nodes(2), recorder={'enabled': True})
        self.save()
        path = os.path.join(self.saved, '1.record')
        self.assertIn('1.record would be lost', self.replay(self.saved, '--capture', path, code=2))
        self.replay(self.saved)
        with open(path, 'r+b') as file:
            file.seek(os.path.getsize(path) // 2)
            byte = file.read(1)
            file.seek(-1, os.SEEK_CUR)
            file.write(bytes([byte[0] ^ 1]))
        self.assertIn('1.record: it was changed since it was saved', self.replay(self.saved, code=2))
        shutil.rmtree(self.saved)
        self.assertIn('no recordings are there', self.replay(self.saved, code=2))
        self.assertIn('--print goes with --node', self.replay(self.saved, '--print', code=2))
        self.assertIn('--node goes with --until', self.replay(self.saved, '--node', '2', code=2))

    def test_that_break_no_promise_have_no_cause(self):
        self.start_ring(plain_nodes(3), recorder={'enabled': True})
        self.send_delivered(1, 2, 3)
        self.save()
        done = self.run_program('ringctl', 'record', 'cause', self.saved)
        self.assertEqual((done.returncode, done.stdout), (1, ''), done.stderr)
        self.assertIn('breaks no promise: there is no cause to find', done.stderr)
        done = self.run_program('ringctl', 'record', 'cause', self.saved + '2')
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn('no recordings are there', done.stderr)
        done = self.run_program('ringctl', 'record', 'cause', self.saved, '--html', os.path.join(self.saved, 'no', 'page'))
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn('--html', done.stderr)

    def test_wrong_usage_is_reported(self):
        self.start_ring(plain_nodes(2))
        for words, ring in (('no ring has recordings', []), ('%s has no recordings' % self.ring, ['--ring', self.ring])):
            done = self.ctl(*ring, 'record', 'save', self.saved)
            self.assertEqual(done.returncode, 3)
            self.assertIn(words, done.stderr)
        done = self.ctl('up', '--nodes', 2, '--clock', 'virtual', '--record')
        self.assertEqual(done.returncode, 2)
        self.assertIn('repeats exactly by itself', done.stderr)


if __name__ == '__main__':
    ring_process.main()
