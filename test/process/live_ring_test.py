"""scripts/chaos and what it stands on: each promise can be seen broken, and nothing is left behind."""

import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import types
import unittest
import unittest.mock

import ring_process
from ring_process import GUARD, STEP

from live_ring import faults, footprint, payload, report
from live_ring.loop import Loop
from live_ring.promises import Promises
from live_ring.ring import RingFailed
from live_ring.traffic import Send, Traffic
from live_ring.virtual_chaos import VirtualChaos
from live_ring.watch import Watch

SCRIPTS = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'scripts')

ALL = 0xFF


def data(source, number):
    return payload.make(source, number, random.Random(number))


def live_of(redundancy):
    return types.SimpleNamespace(ring=types.SimpleNamespace(redundancy=redundancy))


class BrokenPromises(unittest.TestCase):
    def setUp(self):
        self.promises = Promises(range(3))

    def arrive(self, node, source, number, to=None, priority=2, packet=None):
        self.promises.message(node, types.SimpleNamespace(
            source=source, destination=node if to is None else to, priority=priority,
            data=packet or data(source, number)))

    def end(self, number, outcome, interrupt=False):
        self.promises.ended(Send(0, number, 1, interrupt, incarnation=1), outcome, can_be_owed=True)

    def assert_told(self, words):
        self.promises.settle()
        self.assertEqual(len(self.promises.problems), 1, self.promises.problems)
        self.assertIn(words, self.promises.problems[0])

    def assert_kept(self):
        self.promises.settle()
        self.assertEqual(self.promises.problems, [])

    def test_what_arrives_once_in_order_and_is_confirmed_is_right(self):
        for number in (1, 2):
            self.arrive(1, 0, number)
            self.end(number, 'delivered')
        self.arrive(1, 0, 1 + 2, priority=1)
        self.end(3, 'lost')
        self.assert_kept()

    def test_priorities_and_broadcasts_may_overtake(self):
        self.arrive(1, 0, 3, priority=0)
        self.arrive(1, 0, 2, priority=3)
        self.arrive(1, 0, 1, to=ALL, priority=0)
        self.assert_kept()

    def test_a_packet_that_comes_twice(self):
        self.arrive(1, 0, 1)
        self.arrive(1, 0, 1)
        self.assert_told('twice')

    def test_a_packet_out_of_order(self):
        self.arrive(1, 0, 2)
        self.arrive(1, 0, 1)
        self.assert_told('after 2')

    def test_a_damaged_packet(self):
        whole = data(0, 1)
        self.arrive(1, 0, 1, packet=whole[:5] + bytes([whole[5] ^ 1]) + whole[6:])
        self.assert_told('damaged')

    def test_a_packet_of_another_source(self):
        self.arrive(1, 2, 1, packet=data(0, 1))
        self.assert_told('damaged')

    def test_delivered_and_never_come(self):
        self.end(1, 'delivered')
        self.assert_told('never came')

    def test_delivered_to_a_program_that_has_gone_is_not_expected(self):
        self.end(1, 'delivered')
        self.promises.connection_lost(1)
        self.assert_kept()

    def test_refused_and_come_all_the_same(self):
        self.end(1, 'refused')
        self.arrive(1, 0, 1)
        self.assert_told('said not to have arrived')

    def test_come_and_refused_all_the_same(self):
        self.arrive(1, 0, 1)
        self.end(1, 'refused')
        self.assert_told('has it')

    def test_a_pin_pulled_more_often_than_asked_for(self):
        self.end(1, 'delivered', interrupt=True)
        self.promises.pin(1, 0)
        self.promises.pin(1, 0)
        self.assert_told('2 times, with 1')


class Accounts(unittest.TestCase):
    def test_a_broken_line_concerns_those_whose_way_leads_over_it(self):
        cut = faults.Cut(live_of('none'), 15)   # from node 15 to node 0
        self.assertTrue(cut.concerns(14, 0))
        self.assertTrue(cut.concerns(15, 3))
        self.assertTrue(cut.concerns(3, 2))
        self.assertFalse(cut.concerns(0, 15))
        self.assertFalse(cut.concerns(2, 3))

    def test_a_broken_line_of_a_ring_that_folds_back_concerns_nobody(self):
        cut = faults.Cut(live_of('foldback'), 15)
        self.assertFalse(cut.concerns(14, 0))

    def test_a_dead_node_concerns_only_itself(self):
        dead = faults.Dead(None, 2)
        self.assertEqual([dead.concerns(*way) for way in ((2, 1), (1, 2), (1, 3))], [True, True, False])

    def test_lost_by_others_is_what_neither_was_confirmed_nor_came(self):
        ring = types.SimpleNamespace(nodes=range(4), ours=range(4), foreign=[], child_nodes=[])
        traffic = Traffic(Loop(), ring, seed=1, rate=1, targets=ring.nodes)
        dead = faults.Dead(None, 3)
        for number, (to, outcome) in enumerate([(1, 'lost'), (1, 'delivered'), (1, 'unconfirmed'), (3, 'lost')]):
            send = Send(0, number, to, False, incarnation=1)
            send.outcome = outcome
            traffic.recent.append(send)
        lost = traffic.lost(dead.concerns, 0, time.monotonic_ns())
        self.assertEqual([send.number for send in lost], [0, 2])
        traffic.promises.packet(1, 0, 2, 1, 0)
        self.assertEqual([send.number for send in traffic.lost(dead.concerns, 0, time.monotonic_ns())], [0])

    def test_percentiles_are_of_the_nearest_rank(self):
        self.assertEqual(report.percentile([3, 1, 2, 4], 50), 2)
        self.assertEqual(report.percentile([5], 50), 5)
        self.assertEqual(report.percentile(range(1, 101), 99), 99)


class MemoryAndDescriptors(unittest.TestCase):
    def setUp(self):
        self.process = subprocess.Popen(['sleep', '60'])
        self.addCleanup(self.process.wait)
        self.addCleanup(self.process.kill)
        ring = types.SimpleNamespace(starts={3: 1}, daemons={3: self.process})
        self.measured = footprint.Footprint(ring, footprint.MEMORY_MARGIN_MB)

    def test_what_lives_is_measured(self):
        self.assertEqual(self.measured.measure(), [])
        descriptors, memory = self.measured.first[3, 1]
        self.assertGreaterEqual(len(descriptors), 3)
        self.assertGreater(memory, 0)

    def test_what_comes_and_goes_is_no_growth_what_stays_is_and_is_named(self):
        ring = types.SimpleNamespace(starts={3: 1}, daemons={3: types.SimpleNamespace(pid=os.getpid())})
        own = footprint.Footprint(ring, footprint.MEMORY_MARGIN_MB)
        self.assertEqual(own.measure(), [])
        opened = [open('/dev/null') for _ in range(footprint.FD_MARGIN + 1)]
        self.addCleanup(lambda: [each.close() for each in opened])
        self.assertRegex(own.measure()[0], r'node 3 .* at first: 3 more /dev/null')
        self.assertEqual(own.measure(lambda: opened.pop().close()), [])

    def test_what_has_ended_is_not_and_is_no_growth(self):
        self.process.kill()
        os.waitid(os.P_PID, self.process.pid, os.WEXITED | os.WNOWAIT)   # a zombie: ended, not reaped yet
        self.assertEqual(self.measured.measure(), [])
        self.process.wait()
        self.assertEqual(self.measured.measure(), [])
        self.assertEqual(self.measured.first, {})


class Program(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix='chaos_')
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def start(self, *arguments):
        return subprocess.Popen([sys.executable, os.path.join(SCRIPTS, 'chaos'), *arguments], stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                                env=dict(os.environ, TMPDIR=self.folder))

    def daemons(self):
        found = []
        for pid in filter(str.isdigit, os.listdir('/proc')):
            try:
                with open('/proc/%s/cmdline' % pid, errors='replace') as line:
                    words = line.read().split('\0')
            except OSError:
                continue
            if words[0].endswith('ringd') and any(word.startswith(self.folder) for word in words):
                found.append(int(pid))
        return found

    def wait_for_round(self, chaos):
        for line in chaos.stdout:
            if 'round 1:' in line:
                return
        self.fail('chaos has ended')

    def end(self, chaos):
        """What it said after the first round."""
        said = chaos.communicate(timeout=GUARD)[0]
        self.assertEqual(chaos.returncode, 1, said)
        self.assertEqual(os.listdir(self.folder), [])
        self.wait_none()
        return said

    def wait_none(self):
        deadline = time.monotonic() + GUARD
        while self.daemons() and time.monotonic() < deadline:
            time.sleep(STEP)
        self.assertEqual(self.daemons(), [])

    def test_an_interrupted_chaos_leaves_nothing_behind(self):
        chaos = self.start('--minutes', '5', '--seed', '1')
        self.wait_for_round(chaos)
        chaos.send_signal(signal.SIGINT)
        self.assertIn('chaos: interrupted', self.end(chaos))

    def test_a_daemon_that_ends_by_itself_is_told_with_the_seed(self):
        chaos = self.start('--minutes', '5', '--seed', '4')
        self.wait_for_round(chaos)
        os.kill(self.daemons()[0], signal.SIGTERM)
        said = self.end(chaos)
        self.assertRegex(said, r'FAILED after .* round [0-9]+.*ringd of node [0-9]+ .* has ended by itself')
        self.assertIn('--seed 4', said)

    def test_events_that_were_left_out_end_the_run(self):
        watch = Watch(types.SimpleNamespace(turns=[]), types.SimpleNamespace(ours=[0, 1]))
        lost = types.SimpleNamespace(count=3)
        with unittest.mock.patch('live_ring.watch.ObservedLost', types.SimpleNamespace):
            self.assertRaisesRegex(RingFailed, '3 events of node 1 ', watch.handle, 1, lost)

    def test_a_virtual_run_that_hangs_is_ended(self):
        hangs = os.path.join(self.folder, 'ringctl')
        with open(hangs, 'w') as script:
            script.write('#!/bin/sh\nexec tail -f /dev/null\n')
        os.chmod(hangs, 0o755)
        chaos = VirtualChaos(types.SimpleNamespace(programs=self.folder, redundancy='none', seed=1), None)
        self.addCleanup(chaos.stop)
        with unittest.mock.patch('live_ring.virtual_chaos.PROGRAM_TIMEOUT', 0.1):
            self.assertRaisesRegex(RuntimeError, 'it does not end: ', chaos.play, 'scenario.yaml')

    def test_wrong_arguments_are_named(self):
        for arguments, words in ((('--minutes', '0'), 'more than 0'), (('--seed', '-1'), '0 or more'),
                                 (('--keyed', '--transport', 'shm'), 'shm lines have no key'),
                                 (('--keyed', '--clock', 'virtual'), 'lines of a virtual ring are simulated'),
                                 (('--programs', '/nowhere'), 'no program /nowhere/ringd')):
            done = self.start(*arguments)
            said = done.communicate(timeout=GUARD)[0]
            self.assertEqual(done.returncode, 2, said)
            self.assertIn(words, said)

    def test_wrong_arguments_of_other_scripts_are_named_before_anything_is_started(self):
        for script, *arguments, words in (('demo_hosts', '--programs', '/nowhere', 'no program /nowhere/ringd;'),
                                          ('virtual_demo', '--programs', '/nowhere', 'no program /nowhere/ring_sim;'),
                                          ('virtual_demo', '--loop-at', '0', '--loop-at 0: it has to be 1 s after the start'),
                                          ('traces', '--programs', '/nowhere', 'no program /nowhere/ring_sim;')):
            with self.subTest(script, words=words):
                done = subprocess.run([sys.executable, os.path.join(SCRIPTS, script), *arguments], capture_output=True,
                                      text=True, timeout=GUARD, env={**os.environ, 'LIMB_RING_DEMO_ENTERED': '1'})
                self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
                self.assertIn(words, done.stderr)

    def test_without_a_build_it_says_what_to_do(self):
        # Not even the library that is to be found with a set-up shell.
        unset = {name: value for name, value in os.environ.items() if name != 'PYTHONPATH'}
        done = subprocess.run([sys.executable, '-s', os.path.join(SCRIPTS, 'chaos'), '--help'], capture_output=True, text=True,
                              timeout=GUARD, env={**unset, 'RING_TEST_PROGRAMS': '/nowhere/lib/limb_ring'})
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertIn('no Python library of limb_ring in /nowhere/lib/python3/dist-packages', done.stderr)
        self.assertIn('run `make build` first', done.stderr)


if __name__ == '__main__':
    ring_process.main()
