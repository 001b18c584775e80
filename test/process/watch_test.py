"""ringctl watch: a ring's promises judged from outside, and recordings that save themselves."""

import glob
import json
import os
import re
import signal
import subprocess

import ring_process
from ring_process import GUARD, RingTest, plain_nodes, program
from limb_ring import Result


class Watching(RingTest):
    def watch(self, *arguments):
        return self.start('watch', [program('ringctl'), 'watch', *arguments])

    def send(self, source, to, count=50):
        port = self.port(source)
        for i in range(count):
            port.send(to, b'watched %d' % i)
            self.assertEqual(port.next_of(Result).outcome, 'delivered')
        port.close()

    def is_watched(self, node):
        return os.path.exists(os.path.join(self.ring_folder(), '%d.watch' % node))

    def end(self, watch):
        watch.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(watch), 0, self.log_of(watch))
        return self.log_of(watch)

    def test_finds_nothing_while_nodes_die_and_come_back(self):
        daemons = self.start_ring(plain_nodes(4))
        watch = self.watch()
        self.wait('all watched', lambda: all(self.is_watched(node) for node in range(4)))
        self.send(0, 2)
        self.send(1, 255)
        daemons[3].kill()
        self.wait('a ring of three', lambda: self.row(0)['ring_size'] == 3)
        self.send(0, 2)
        os.remove(os.path.join(self.ring_folder(), '3.watch'))  # of the dead one
        self.ringd(os.path.join(self.folder, 'ring.yaml'), 3)
        self.wait('a ring of four', lambda: self.row(3) and self.row(0)['ring_size'] == 4)
        self.wait('the new one is watched', lambda: self.is_watched(3))
        self.send(0, 3)
        said = self.end(watch)
        self.assertIn('every promise was kept', said)
        self.assertIn('200 sends', said)

    def test_ends_by_itself_and_costs_nothing_afterwards(self):
        self.start_ring(plain_nodes(2))
        done = self.ctl('watch', self.ring, '--for', 0.3, '--json')
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)
        self.assertEqual((told['broken'], told['not_judged']), (0, 0))
        self.wait('no file is left', lambda: not self.is_watched(0) and not self.is_watched(1))

    def test_without_a_ring_it_says_so(self):
        self.assertEqual(self.ctl('watch', 'no_such_ring').returncode, 3)

    def test_recordings_are_judged_as_well(self):
        self.start_ring(plain_nodes(3), recorder={'enabled': True, 'size': 1048576})
        self.send(0, 2)
        saved = os.path.join(self.folder, 'saved')
        self.assertEqual(self.ctl('record', 'save', saved).returncode, 0)
        done = subprocess.run([program('ring_sim'), 'replay', saved], env=self.environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, universal_newlines=True, timeout=GUARD)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn('promises: all kept; 50 sends', done.stdout)


class SavedByThemselves(RingTest):
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

    def keeper_waits(self):
        """How often the keeper of recordings has slept: once after each look."""
        for status in glob.glob('/proc/[0-9]*/status'):
            try:
                with open(os.path.join(os.path.dirname(status), 'cmdline')) as file:
                    words = file.read().split('\0')
                if 'keep' in words and self.ring in words:
                    with open(status) as file:
                        return int(re.search(r'^voluntary_ctxt_switches:\s*(\d+)', file.read(), re.M).group(1))
            except OSError:
                pass   # it has ended
        self.fail('no keeper is there')

    def saved(self):
        return sorted(os.listdir(self.saves)) if os.path.isdir(self.saves) else []

    def replay(self, folder):
        done = subprocess.run([program('ring_sim'), 'replay', folder], env=self.environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, universal_newlines=True, timeout=GUARD)
        self.assertEqual(done.returncode, 0, done.stdout)

    def read(self, log):
        with open(log) as file:
            return file.read()

    def test_when_a_daemon_crashes_but_not_when_one_is_ended(self):
        log = self.up(['crash'])
        self.wait('a node is seen to be killed on purpose', lambda: self.ctl(
            'fault', 'kill', 'node2').returncode == 0)
        looked = self.keeper_waits() + 3
        self.wait('the keeper has seen that', lambda: self.keeper_waits() >= looked)
        self.wait('and back', lambda: self.ctl('fault', 'start', 'node2').returncode == 0 and self.is_closed(range(3)))
        os.kill(self.row(1)['pid'], signal.SIGKILL)
        self.wait('saved', lambda: 'recordings are saved in' in self.read(log))
        saved, = self.saved()
        self.assertRegex(saved, '^%s-.*-crash$' % self.ring)
        self.assertIn('node 1 (node1) has crashed', self.read(log))
        self.assertIn('1.record', os.listdir(os.path.join(self.saves, saved)))
        self.replay(os.path.join(self.saves, saved))

    def test_when_a_break_is_located(self):
        log = self.up(['break'], keep=1)
        self.assertEqual(self.ctl('fault', 'cut', 'node0:node1').returncode, 0)
        self.wait('saved', lambda: 'the line from node 0 to 1 is broken' in self.read(log))
        saved, = self.saved()
        self.assertRegex(saved, '-break$')

    def test_and_the_oldest_go(self):
        self.up(['crash'], keep=2)
        for i in range(3):
            os.makedirs(os.path.join(self.saves, '%s-2020-01-01_00000%d_000-crash' % (self.ring, i)))
        os.makedirs(os.path.join(self.saves, 'other-2020'))
        os.kill(self.row(1)['pid'], signal.SIGKILL)
        left = '%s-2020-01-01_000002_000-crash' % self.ring
        self.wait('only the newest are left', lambda: len(self.saved()) == 3 and left in self.saved())
        self.assertIn('other-2020', self.saved())


if __name__ == '__main__':
    ring_process.main()
