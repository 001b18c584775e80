"""The time of a virtual ring, steered from outside: at another pace, paused, by steps; and a ring that follows a clock."""

import os
import re
import signal

import ring_process
from ring_process import RingTest, plain_nodes

LEG = os.path.join(ring_process.CONFIG, 'leg8.yaml')
MS = 10 ** 6   # ns


class Clock(RingTest):
    def up(self, config, *more):
        done = self.ctl('up', config, '--clock', 'virtual', '--detach', '--timeout', 60, *more)
        self.addCleanup(self.ctl, 'down', self.ring)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def clock(self, *words):
        """What the clock says after `ringctl clock WORDS`."""
        return self.ctl_json('--ring', self.ring, 'clock', *words)

    def refused(self, code, *words):
        done = self.ctl(*words)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stderr

    def test_stands_goes_by_steps_and_goes_on(self):
        self.up(self.write_ring(plain_nodes(3)))
        stands = self.clock('pause')
        self.assertTrue(stands['paused'])
        self.assertEqual(self.clock('pause')['now_ns'], stands['now_ns'])
        self.assertEqual(self.answered(1)['state'], 'up', 'it answers all the same')
        for step, length in (('1ms', MS), ('1500us', 1500000), ('2', 2000 * MS), ('1ns', 1)):
            before = self.clock('pause')['now_ns']
            after = self.clock('step', step)
            self.assertEqual((after['now_ns'] - before, after['paused']), (length, True))
        self.assertIn('ring %s stands at ' % self.ring, self.ctl('clock', 'step', '1ms', self.ring).stdout)
        self.assertRegex(self.ctl('clock', 'run', self.ring).stdout, r' goes on from [0-9.]+ s, pace 1\n$')
        gone_on = self.clock('pause')
        self.assertGreater(gone_on['now_ns'], stands['now_ns'])

    def test_what_is_sent_while_it_stands_goes_with_a_step(self):
        self.up(self.write_ring(plain_nodes(3)))
        self.clock('pause')
        send = self.start('send', [ring_process.program('ringctl'), '--ring', self.ring, 'send', '--from', '0', '--to', '1',
                                   '--data', 'x'])
        self.wait('its result', lambda: self.clock('step', '1ms') and send.poll() is not None)
        self.assertEqual(send.wait(), 0, self.log_of(send))

    def begin(self, *words):
        return self.start(words[0], [ring_process.program('ringctl'), '--ring', self.ring, *words])

    def test_what_waits_while_it_stands_says_why(self):
        self.up(self.write_ring(plain_nodes(4)))
        self.clock('pause')
        stands = "the virtual clock of ring %s stands; 'ringctl clock run' lets it go on" % self.ring
        stop = self.begin('stop')
        for waiting in [self.begin('send', '--from', '0', '--to', '2', '--data', 'x'), stop,
                        self.begin('ping', '2', '--from', '0', '-c', '1'), self.begin('traffic', 'show', '0', '-n', '1'),
                        self.begin('fault', 'freeze', 'node3', '--for', '1s')]:
            self.wait('a hint of ' + str(waiting.args), lambda: 'waiting: ' + stands in self.log_of(waiting))
        self.assertIn('ringctl: ' + stands + ', and what was asked for may happen then',
                      self.refused(4, '--ring', self.ring, 'resume', 'node1'))
        self.assertEqual(self.wait_exit(stop), 4)
        self.clock('run')
        self.wait('the stop', lambda: self.answered(1)['cpu']['stop']['pulled'] == 1)

    def test_a_step_says_until_when_it_goes(self):
        self.up(self.write_ring(plain_nodes(3)))
        until = self.clock('pause')['now_ns'] / 1e9 + 10000
        step = self.begin('clock', 'step', '10000s')
        self.wait('it to say so',
                  lambda: "waiting until %.9f s of the ring's time" % until in self.log_of(step))
        self.clock('pause')
        self.assertEqual(self.wait_exit(step), 0)

    def test_a_step_that_is_interrupted_stands_where_it_is(self):
        self.up(self.write_ring(plain_nodes(3)))
        begun = self.clock('pause')['now_ns']
        step = self.begin('clock', 'step', '10000s')
        self.wait('it to go on', lambda: self.ring_now() > begun)
        step.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_exit(step), 1)
        self.assertRegex(self.log_of(step), r'ring %s stands at .*\n.*interrupted before' % self.ring)
        stood = self.ring_now()
        self.assertEqual(self.clock('pause')['now_ns'], stood)

    def ring_now(self):
        return self.port(255).ask({'do': 'clock'})['now_ns']

    def test_changes_its_pace(self):
        self.up(self.write_ring(plain_nodes(3)))
        self.assertEqual(self.clock('pace', '0.25')['pace'], 0.25)
        for pace in ('0.25', '1', '20', 'max'):
            told = ', pace %s\n' % pace
            self.assertTrue(self.ctl('clock', 'pace', pace, self.ring).stdout.endswith(told), pace)
            self.assertIn(told[:-1], self.ctl('status').stdout.splitlines()[0], 'in the same form')
        self.assertEqual(self.clock('pace', 'max')['pace'], 'max')
        before = self.clock('pace', 'max')['now_ns']
        self.wait('a minute of its time', lambda: self.clock('pace', 'max')['now_ns'] > before + 60000 * MS)

    def test_wrong_words_and_a_live_ring_are_refused(self):
        self.assertIn("'0' is not a number, 0.001 to 1000", self.refused(2, 'clock', 'pace', '0'))
        self.assertIn('is not a time', self.refused(2, 'clock', 'step', '0'))
        self.refused(2, 'clock', 'pace')
        self.refused(2, 'clock', 'step')
        self.refused(3, 'clock', 'pause', 'no_such_ring')
        done = self.ctl('up', self.write_ring(plain_nodes(3)), '--detach')
        self.addCleanup(self.ctl, 'down', self.ring)
        self.assertEqual(done.returncode, 0, done.stderr)
        for words in (('pause',), ('run',), ('step', '1ms'), ('pace', '2')):
            self.assertIn('--clock virtual', self.refused(1, '--ring', self.ring, 'clock', *words))

    def test_stopped_and_stepped_it_leaves_the_same_trace(self):
        def run(steer):
            ring = self.start('ring', [ring_process.program('ringd'), '--config', LEG, '--ring', self.ring,
                                       '--clock', 'virtual', '--pace', '4', '--for', '4'])
            if steer:
                self.wait('the ring', lambda: self.ctl('--ring', self.ring, 'clock', 'pause').returncode == 0)
                for step in ('1ms', '7us', '123456ns'):
                    self.clock('step', step)
                self.clock('pace', 'max')
                self.clock('run')
            self.assertEqual(self.wait_exit(ring), 0)
            self.assertNotIn('not repeatable', self.log_of(ring))
            return re.search(r'trace hash (\S+) of 4\.0', self.log_of(ring)).group(1)
        self.assertEqual(run(False), run(True))

    def test_a_ring_that_follows_goes_as_far_as_it_is_allowed(self):
        ring = self.start('ring', [ring_process.program('ringd'), '--config', LEG, '--ring', self.ring, '--clock', 'follow'])
        self.wait('the ring', lambda: self.ctl('--ring', self.ring, 'clock', 'pause').returncode == 0)
        self.clock('run')
        with self.port(0) as port:
            self.assertEqual(port.ask({'do': 'clock'})['now_ns'], 0, 'nobody has allowed any time')
            allowed = port.ask({'do': 'allow', 'until_ns': 300 * MS, 'outer_zero_ns': -5})
            self.assertEqual((allowed['allowed_ns'], allowed['outer_zero_ns'], allowed['pace']), (300 * MS, -5, 'max'))
            self.wait('that time', lambda: port.ask({'do': 'clock'})['now_ns'] == 300 * MS)
            self.assertEqual(port.ask({'do': 'clock'})['now_ns'], 300 * MS, 'and no further')
            for wrong in ({}, {'until_ns': -1, 'outer_zero_ns': 0}, {'until_ns': 1}, {'until_ns': 1, 'outer_zero_ns': 'x'}):
                with self.assertRaises(ring_process.HostPortError):
                    port.ask(dict(wrong, do='allow'))
        ring.send_signal(signal.SIGTERM)
        self.assertEqual(self.wait_exit(ring), 0)
        self.assertNotIn('not repeatable', self.log_of(ring))

    def test_a_run_that_went_on_without_a_controller_says_so(self):
        ring = self.start('ring', [ring_process.program('ringd'), '--config', LEG, '--ring', self.ring, '--clock', 'virtual'])
        self.wait('the ring', lambda: self.ctl('--ring', self.ring, 'clock', 'pause').returncode == 0)
        with self.port(0) as port:
            with self.assertRaisesRegex(ring_process.HostPortError, 'whom'):
                port.ask({'do': 'went_on_without'})
            port.ask({'do': 'went_on_without', 'whom': 'the controller /legs'})
        ring.send_signal(signal.SIGTERM)
        self.assertEqual(self.wait_exit(ring), 0)
        self.assertIn('not repeatable: time went on without the controller /legs', self.log_of(ring))

    def test_a_ring_that_follows_none_says_so(self):
        self.up(self.write_ring(plain_nodes(3)))
        with self.port(0) as port, self.assertRaisesRegex(ring_process.HostPortError, '--clock follow'):
            port.ask({'do': 'allow', 'until_ns': 1, 'outer_zero_ns': 0})


if __name__ == '__main__':
    ring_process.main()
