"""What the daemons hold on to: descriptors and memory, of each of their processes."""
import os

FD_MARGIN = 2            # of a client that comes or goes in this very moment
MEMORY_MARGIN_MB = 4     # what an allocator may keep of a burst


def descriptors(pid):
    return len(os.listdir('/proc/%d/fd' % pid))


def memory_kb(pid):
    with open('/proc/%d/status' % pid) as status:
        return next(int(line.split()[1]) for line in status if line.startswith('VmRSS'))


def footprint(pid):
    """(descriptors, resident kB); None of a process that has ended: its memory is given back before it is reaped."""
    try:
        return descriptors(pid), memory_kb(pid)
    except (FileNotFoundError, ProcessLookupError, StopIteration):
        return None


class Footprint:
    """To be asked while the ring is whole and all connections stand."""

    def __init__(self, ring, memory_margin_mb):
        self.ring, self.memory_margin_mb = ring, memory_margin_mb
        self.first = {}      # (node, incarnation): (fds, kB)
        self.grown_fds = self.grown_kb = 0

    def measure(self):
        """Measures new processes for the first time; says what has grown too much in the others.

        A daemon that has ended is not measured: LiveRing reports it.
        """
        problems = []
        for node, incarnation in self.ring.starts.items():
            pid = self.ring.daemons[node].pid
            now = footprint(pid)
            if now is None:
                continue
            fds, memory = self.first.setdefault((node, incarnation), now)
            self.grown_fds = max(self.grown_fds, now[0] - fds)
            self.grown_kb = max(self.grown_kb, now[1] - memory)
            if now[0] > fds + FD_MARGIN:
                problems.append('node %d (pid %d) has %d descriptors, %d at first' % (node, pid, now[0], fds))
            if now[1] > memory + 1024 * self.memory_margin_mb:
                problems.append('node %d (pid %d) has %d kB resident, %d at first' % (node, pid, now[1], memory))
        return problems
