"""Rings of real daemons in a folder of their own: every program that is started here sees no other ring, has a log, and
ends with the launcher, daemons also where its process is killed. Ring stands on it, and so do the scripts and process tests
of limb_ring itself."""
import os
import random
import shutil
import signal
import socket
import subprocess
import tempfile
import time

from .processes import is_gone

KILLED = 60.0  # s that a killed process may take to be gone; a busy machine is slow
STEP = 0.02    # s


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
    """Nodes of a ring's file: node0, node1 ..."""
    return [{'id': i, 'name': 'node%d' % i} for i in range(count)]


class Launcher:
    def __init__(self, programs, prefix='limb_ring_'):
        """@param programs folder of ringd and the others"""
        self.programs = programs
        self.folder = tempfile.mkdtemp(prefix=prefix)
        self.runtime = os.path.join(self.folder, 'run')
        os.mkdir(self.runtime, 0o700)
        self.environment = {k: v for k, v in os.environ.items() if not k.startswith('LIMB_RING')}
        self.environment['XDG_RUNTIME_DIR'] = self.runtime
        self.started = []   # (what, process); process.log is the path of its output
        # However this process ends, also by SIGTERM or SIGKILL, its end of the pipe is closed then.
        self._guard = subprocess.Popen(['sh', '-c', 'read line; exec "$0" down --all', self.program('ringctl')],
                                       stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                       env=self.environment, start_new_session=True)

    def program(self, name):
        return os.path.join(self.programs, name)

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, 'w') as file:
            file.write(text)
        return path

    def ring_folder(self, ring):
        """Where the daemons of a ring have their sockets and locks."""
        return os.path.join(self.runtime, 'limb_ring', ring)

    def socket_of(self, ring, node, kind='host'):
        return os.path.join(self.ring_folder(ring), '%s.%s' % (node, kind))

    def start(self, what, arguments, **options):
        log = os.path.join(self.folder, '%d_%s.log' % (len(self.started), what))
        with open(log, 'wb') as output:
            process = subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT,
                                       env=self.environment, **options)
        process.log = log
        self.started.append((what, process))
        return process

    def ringd(self, config, node, *more, **options):
        return self.start('ringd_%s' % node, [self.program('ringd'), '--config', config, '--node', str(node), *more],
                          **options)

    def end(self, grace=0.0):
        """Ends all that was started here, and daemons that a program started for us.
        @param grace s between SIGTERM and SIGKILL; 0: SIGKILL at once"""
        processes = [process for _, process in self.started]
        if grace:
            for process in processes:
                if process.poll() is None:
                    process.terminate()
            deadline = time.monotonic() + grace
            while any(process.poll() is None for process in processes) and time.monotonic() < deadline:
                time.sleep(STEP)
        for process in processes:
            if process.poll() is None:
                process.kill()
        for process in processes:
            process.wait(timeout=KILLED)
        for pid in list(self.daemons_left()):
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                continue   # it has ended by itself, as daemons of a killed `ringctl up` do
            deadline = time.monotonic() + KILLED
            while not is_gone(pid) and time.monotonic() < deadline:
                time.sleep(STEP)
        self._guard.kill()
        self._guard.wait(timeout=KILLED)
        self._guard.stdin.close()

    def remove(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def daemons_left(self):
        """Pids of daemons in our folder: ringctl started them, and nobody ended them."""
        for folder, _, files in os.walk(self.runtime):
            for name in files:
                pid = self._holder_of(os.path.join(folder, name)) if name.endswith('.lock') else None
                if pid:
                    yield pid

    def _holder_of(self, lock):
        try:
            with open(lock, 'rb') as file:   # its paths, and variables, are any bytes
                pid = int(file.readline() or 0)
            with open('/proc/%d/environ' % pid, 'rb') as file:
                ours = b'XDG_RUNTIME_DIR=' + os.fsencode(self.runtime) in file.read().split(b'\0')
        except (OSError, ValueError):
            return None
        return pid if ours else None
