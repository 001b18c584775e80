"""Rings of real ringd processes for tests: each test has a folder, a ring name and processes of its
own, so that tests can run side by side. Conditions are waited for; nothing is timed."""

import json
import os
import random
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import unittest

from host_port import HostPort

PROGRAMS = os.environ.get('RING_TEST_PROGRAMS', '')
CONFIG = os.environ.get('RING_TEST_CONFIG', '')
GUARD = 60.0  # seconds; reached only where something is wrong
STEP = 0.02
# On a busy machine a healthy daemon may not run for longer than the default silence of a link; a
# test that asserts that nothing was lost must not lose to that.
PATIENT = {'silence': '5s', 'stall': '5s', 'send': '1s'}


def program(name):
    return os.path.join(PROGRAMS, name)


def process_state(pid):
    """'T' stopped, 'Z' ended but not waited for ...; '' where there is none."""
    try:
        with open('/proc/%d/stat' % pid) as stat:
            return stat.read().rsplit(')', 1)[1].split()[0]
    except OSError:
        return ''


def is_gone(pid):
    return process_state(pid) in ('', 'Z', 'X')


def free_udp_ports(count):
    """First of `count` UDP ports in a row that nobody has at this moment."""
    while True:
        first = random.randrange(10000, 16000)
        probes = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(count)]
        try:
            for i, probe in enumerate(probes):
                probe.bind(('127.0.0.1', first + i))
            return first
        except OSError:
            continue
        finally:
            for probe in probes:
                probe.close()


def plain_nodes(count):
    return [{'id': i, 'name': 'node%d' % i} for i in range(count)]


class RingTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix='ring_')
        self.runtime = os.path.join(self.folder, 'run')
        os.mkdir(self.runtime, 0o700)
        self.ring = 'r%d' % random.randrange(10 ** 9)
        self.environment = {k: v for k, v in os.environ.items() if not k.startswith('LIMB_RING')}
        self.environment['XDG_RUNTIME_DIR'] = self.runtime
        self.processes = []   # (what, Popen, log path)
        self.addCleanup(self._clean_up)

    # ---- files ----------------------------------------------------------------------------

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, 'w') as file:
            file.write(text)
        return path

    def script(self, name, text):
        path = self.write(name, '#!/bin/sh\n' + text)
        os.chmod(path, 0o755)
        return path

    def write_ring(self, nodes, timeouts=None, **sections):
        """A ring's file; JSON is YAML too."""
        ring = dict(sections, ring=self.ring, nodes=nodes, timeouts=dict(PATIENT, **(timeouts or {})))
        return self.write('ring.yaml', json.dumps(ring, indent=1))

    def ring_folder(self, ring=None):
        return os.path.join(self.runtime, 'limb_ring', ring or self.ring)

    def socket_of(self, node, kind='host'):
        return os.path.join(self.ring_folder(), '%s.%s' % (node, kind))

    # ---- processes ------------------------------------------------------------------------

    def start(self, what, arguments, **options):
        log = os.path.join(self.folder, '%d_%s.log' % (len(self.processes), what))
        with open(log, 'wb') as output:
            process = subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=output,
                                       stderr=subprocess.STDOUT, env=self.environment, **options)
        process.log = log
        self.processes.append((what, process))
        return process

    def ringd(self, config, node, *more):
        return self.start('ringd_%s' % node,
                          [program('ringd'), '--config', config, '--node', str(node)] + list(more))

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

    def ctl(self, *arguments, **options):
        return subprocess.run([program('ringctl')] + [str(a) for a in arguments],
                              env=self.environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True, timeout=GUARD, **options)

    def ctl_json(self, *arguments, code=0):
        done = self.ctl(*arguments, '--json')
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return json.loads(done.stdout)

    def run_ringd(self, *arguments):
        """A ringd that is to end by itself."""
        return subprocess.run([program('ringd')] + [str(a) for a in arguments],
                              env=self.environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True, timeout=GUARD)

    def wait_exit(self, process):
        return process.wait(timeout=GUARD)

    # ---- what the ring says ---------------------------------------------------------------

    def port(self, node, **options):
        port = HostPort.connect(self.socket_of(node), self.ring, **options)
        self.addCleanup(port.close)
        return port

    def row(self, node):
        """A node's status row; None while its daemon does not answer."""
        try:
            port = HostPort.connect(self.socket_of(node), self.ring)
        except (OSError, ConnectionError):
            return None
        try:
            return port.ask({'do': 'status'}, timeout=2)
        except (OSError, ConnectionError, TimeoutError):
            return None
        finally:
            port.close()

    def counters(self, node):
        return self.row(node)['counters']

    def wait(self, what, condition):
        """Polls until condition() is true, and returns what it returned."""
        deadline = time.monotonic() + GUARD
        while time.monotonic() < deadline:
            value = condition()
            if value:
                return value
            time.sleep(STEP)
        self.fail('not within %g s: %s' % (GUARD, what))

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
        for _, process in self.processes:
            if process.poll() is None:
                process.kill()
        for _, process in self.processes:
            process.wait(timeout=GUARD)
        for pid in self._lock_holders():
            os.kill(pid, signal.SIGKILL)
        if self._failed():
            self._print_logs()
        shutil.rmtree(self.folder, ignore_errors=True)

    def _lock_holders(self):
        """Daemons that ringctl started for this test and nobody ended."""
        for folder, _, files in os.walk(self.runtime):
            for name in files:
                pid = self._ringd_of(os.path.join(folder, name)) if name.endswith('.lock') else None
                if pid:
                    yield pid

    def _ringd_of(self, lock):
        try:
            with open(lock) as file:
                pid = int(file.readline() or 0)
            with open('/proc/%d/environ' % pid) as file:
                ours = 'XDG_RUNTIME_DIR=' + self.runtime in file.read().split('\0')
        except (OSError, ValueError):
            return None
        return pid if ours else None

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


def main():
    unittest.main(verbosity=2)
