"""The descriptors and the memory that each daemon process holds."""
import collections
import os
import time

FD_MARGIN = 2            # of a client that comes or goes in this very moment
MEMORY_MARGIN_MB = 4     # what an allocator may keep of a burst
GONE = 5.0               # s, until what comes and goes is gone


def descriptors(pid):
    """What each is open on."""
    folder = '/proc/%d/fd' % pid
    found = []
    for fd in os.listdir(folder):
        try:
            found.append(os.readlink(os.path.join(folder, fd)))
        except FileNotFoundError:   # closed since
            pass
    return sorted(found)


def memory_kb(pid):
    with open('/proc/%d/status' % pid) as status:
        return next(int(line.split()[1]) for line in status if line.startswith('VmRSS'))


def footprint(pid):
    """(descriptors, resident kB); None of a process that has ended: its memory is given back before it is reaped."""
    try:
        return descriptors(pid), memory_kb(pid)
    except (FileNotFoundError, ProcessLookupError, StopIteration):
        return None


def more_of(now, first):
    """What is in `now` more often than in `first`, numbers of sockets and pipes aside."""
    def kinds(names):
        return collections.Counter(name.split(':')[0] for name in names)
    return ', '.join('%d more %s' % (count, kind) for kind, count in (kinds(now) - kinds(first)).items())


class Footprint:
    """To be asked while the ring is whole and all connections stand."""

    def __init__(self, ring, memory_margin_mb):
        self.ring, self.memory_margin_mb = ring, memory_margin_mb
        self.first = {}      # (node, incarnation): (descriptors, kB)
        self.grown_fds = self.grown_kb = 0

    def measure(self, pause=None):
        """Measures new processes for the first time; says what has grown too much in the others.

        A daemon that has ended is not measured: LiveRing reports it. With `pause`, a function that lets some time pass, it
        is measured again for GONE seconds: a neighbour that is bypassed or comes back has two connections for a moment.
        """
        end = time.monotonic() + GONE
        problems, fds, kb = self.look()
        while problems and pause and time.monotonic() < end:
            pause()
            problems, fds, kb = self.look()
        self.grown_fds, self.grown_kb = max(self.grown_fds, fds), max(self.grown_kb, kb)
        return problems

    def look(self):
        """(problems, most descriptors more, most kB more)"""
        problems, most_fds, most_kb = [], 0, 0
        for node, incarnation in self.ring.starts.items():
            pid = self.ring.daemons[node].pid
            now = footprint(pid)
            if now is None:
                continue
            fds, memory = self.first.setdefault((node, incarnation), now)
            most_fds = max(most_fds, len(now[0]) - len(fds))
            most_kb = max(most_kb, now[1] - memory)
            if len(now[0]) > len(fds) + FD_MARGIN:
                problems.append('node %d (pid %d) has %d descriptors, %d at first: %s' % (
                    node, pid, len(now[0]), len(fds), more_of(now[0], fds)))
            if now[1] > memory + 1024 * self.memory_margin_mb:
                problems.append('node %d (pid %d) has %d kB resident, %d at first' % (node, pid, now[1], memory))
        return problems, most_fds, most_kb
