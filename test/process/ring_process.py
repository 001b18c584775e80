"""Rings of real ringd processes for tests: each test has a folder, a ring name and processes of its
own, so that tests can run side by side. Conditions are waited for; nothing is timed."""

import json
import mmap
import os
import random
import signal
import subprocess
import sys
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'scripts'))
from live_ring import built  # noqa: E402,F401
from limb_ring import HostPort, HostPortError, _client  # noqa: E402
from limb_ring.launcher import Launcher, free_udp_ports, plain_nodes  # noqa: E402,F401
from limb_ring.processes import is_gone, process_state  # noqa: E402,F401

PROGRAMS = os.environ.get('RING_TEST_PROGRAMS', '')
CONFIG = os.environ.get('RING_TEST_CONFIG', '')
# Seconds; reached only where something is wrong, or in a slow build.
GUARD = 60.0 * float(os.environ.get('RING_TEST_PATIENCE', 1))
STEP = 0.02
# On a busy machine a healthy daemon may not run for longer than the default silence of a link; a
# test that asserts that nothing was lost must not lose to that.
PATIENT = {'silence': '5s', 'stall': '5s', 'send': '1s'}


def program(name):
    return os.path.join(PROGRAMS, name)


class RingTest(unittest.TestCase):
    def setUp(self):
        self.launcher = Launcher(PROGRAMS, prefix='ring_')
        self.folder, self.environment = self.launcher.folder, self.launcher.environment
        # Of CPUs in Python, whatever shell this was started from.
        library = os.path.dirname(os.path.dirname(_client.__file__))
        self.environment['PYTHONPATH'] = os.pathsep.join([library, *filter(None, [os.environ.get('PYTHONPATH')])])
        self.ring = 'r%d' % random.randrange(10 ** 9)
        self.addCleanup(self._clean_up)

    @property
    def runtime(self):
        """Where the rings of this test have their folders."""
        return self.launcher.runtime

    @runtime.setter
    def runtime(self, folder):
        self.launcher.runtime = folder

    @property
    def processes(self):
        return self.launcher.started

    # ---- files ----------------------------------------------------------------------------

    def write(self, name, text):
        return self.launcher.write(name, text)

    def shift_clock(self, environment, variable):
        """Lets shifted_wall_clock.cpp shift a clock of programs with that environment.
        @return 8 bytes: by how many ns, in the order of the host"""
        path = self.write('shift', '\0' * 8)
        with open(path, 'r+b') as file:
            shift = mmap.mmap(file.fileno(), 8)
        self.addCleanup(shift.close)
        environment.update({'LD_PRELOAD': os.environ['SHIFTED_WALL_CLOCK'], variable: path})
        return shift

    def script(self, name, text):
        path = self.write(name, '#!/bin/sh\n' + text)
        os.chmod(path, 0o755)
        return path

    def write_ring(self, nodes, timeouts=None, **sections):
        """A ring's file; JSON is YAML too."""
        ring = dict(sections, ring=self.ring, nodes=nodes, timeouts=dict(PATIENT, **(timeouts or {})))
        return self.write('ring.yaml', json.dumps(ring, indent=1))

    def ring_folder(self, ring=None):
        return self.launcher.ring_folder(ring or self.ring)

    def socket_of(self, node, kind='host'):
        return self.launcher.socket_of(self.ring, node, kind)

    # ---- processes ------------------------------------------------------------------------

    def start(self, what, arguments, **options):
        return self.launcher.start(what, arguments, **options)

    def keep_cores_busy(self):
        """Something computes on each core until the test ends."""
        for _ in range(os.cpu_count()):
            self.start('busy', [sys.executable, '-c', 'while True: pass'])

    def ringd(self, config, node, *more):
        return self.launcher.ringd(config, node, *more)

    def start_ring(self, nodes, **sections):
        """All daemons of a ring, which is closed when this returns: {id: process}."""
        config = self.write_ring(nodes, **sections)
        daemons = {node['id']: self.ringd(config, node['id']) for node in nodes}
        self.wait('ring closed', lambda: self._all_run(daemons) and self.is_closed(daemons))
        return daemons

    def _all_run(self, daemons):
        for node, process in daemons.items():
            self.assertIsNone(process.poll(), 'ringd of node %s has ended' % node)
        return True

    def run_program(self, name, *arguments, **options):
        """One that ends by itself. `options` are those of subprocess.run(), where not the usual ones."""
        usual = dict(env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                     universal_newlines=True, timeout=GUARD)
        return subprocess.run([program(name)] + [str(a) for a in arguments], **dict(usual, **options))

    def ctl(self, *arguments, **options):
        return self.run_program('ringctl', *arguments, **options)

    def ctl_json(self, *arguments, code=0):
        done = self.ctl(*arguments, '--json')
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return json.loads(done.stdout)

    def run_ringd(self, *arguments):
        return self.run_program('ringd', *arguments)

    def wait_exit(self, process):
        return process.wait(timeout=GUARD)

    # ---- what the ring says ---------------------------------------------------------------

    def port(self, node, **options):
        port = HostPort.connect(ring=self.ring, node=node, runtime=self.runtime, **options)
        self.addCleanup(port.close)
        return port

    def send_delivered(self, source, to, count=50):
        """So many packets (b'packet 0', ...), each of which is delivered before the next one."""
        with HostPort.connect(ring=self.ring, node=source, runtime=self.runtime) as port:
            for i in range(count):
                self.assertEqual(port.wait(port.send(to, b'packet %d' % i), GUARD).outcome, 'delivered')

    def assert_refused(self, words, port, order):
        """The daemon says no, in these words."""
        with self.assertRaisesRegex(HostPortError, words) as refused:
            port.ask(order)
        self.assertNotIsInstance(refused.exception, TimeoutError)

    def row(self, node):
        """A node's status row; None while its daemon does not answer."""
        try:
            with HostPort.connect(ring=self.ring, node=node, runtime=self.runtime, timeout=0, asks_only=True) as port:
                return port.ask({'do': 'status'}, timeout=2)
        except HostPortError:
            return None

    def answered(self, node):
        """A node's status row, once its daemon answers: on a busy machine it may take longer than row() waits, and one whose
        clients are all it takes answers once it has seen the last one go."""
        return self.wait('node %s to answer' % node, lambda: self.row(node))

    def counters(self, node):
        return self.answered(node)['counters']

    def wait(self, what, condition):
        """Polls until condition() is true, and returns what it returned."""
        deadline = time.monotonic() + GUARD
        while time.monotonic() < deadline:
            value = condition()
            if value:
                return value
            time.sleep(STEP)
        self.fail('not within %g s: %s' % (GUARD, what))

    def stop_process(self, pid):
        """By SIGSTOP; it has stopped when this returns."""
        os.kill(pid, signal.SIGSTOP)
        self.wait('process %d stopped' % pid, lambda: process_state(pid) == 'T')

    def is_closed(self, nodes):
        rows = [self.row(node) for node in nodes]
        return all(row and row['state'] == 'up' and row['ring_size'] == len(rows) for row in rows)

    def wait_closed(self, nodes):
        nodes = list(nodes)
        self.wait('ring of %s closed' % nodes, lambda: self.is_closed(nodes))

    def wait_cpu(self, node, state):
        """Waits until the node's CPU is in this state; returns its part of the row."""
        def cpu():
            row = self.row(node)
            return row and row['cpu']['state'] == state and row['cpu']
        return self.wait('CPU of node %s %s' % (node, state), cpu)

    def log_of(self, process):
        with open(process.log, errors='replace') as log:
            return log.read()

    # ---- the end --------------------------------------------------------------------------

    def _clean_up(self):
        self.launcher.end()
        if self._failed():
            self._print_logs()
        self.launcher.remove()

    def _failed(self):
        outcome = self._outcome
        if hasattr(outcome, 'errors'):  # up to Python 3.10
            return any(error for _, error in outcome.errors)
        bad = outcome.result.failures + outcome.result.errors
        return any(self in (test, getattr(test, 'test_case', None)) for test, _ in bad)

    def _print_logs(self):
        for what, process in self.processes:
            print('--- %s (pid %d, exit %s)\n%s' % (what, process.pid, process.returncode,
                                                    self.log_of(process)[-6000:]), flush=True)


class ScenarioTest(RingTest):
    """Of runs that have private folders: these lie in the test's own, and what is started is known by it."""

    def setUp(self):
        super().setUp()
        self.temporary = os.path.join(self.folder, 'tmp')
        os.mkdir(self.temporary)
        self.environment['TMPDIR'] = self.temporary

    def started_by_runs(self, *programs):
        """Pids of these programs that a run has started."""
        mark = ('TMPDIR=' + self.temporary).encode()
        pids = []
        for entry in os.listdir('/proc'):
            try:
                with open('/proc/%s/environ' % entry, 'rb') as environ, open('/proc/%s/comm' % entry) as comm:
                    if mark in environ.read().split(b'\0') and comm.read().strip() in programs:
                        pids.append(int(entry))
            except (OSError, ValueError):
                continue
        return [pid for pid in pids if not is_gone(pid)]


def main():
    unittest.main(verbosity=2)
