"""What the kernel says of processes."""


def _fields(pid):
    """Of /proc/PID/stat, those behind the name: its state, its parent ...; none where there is no such process."""
    try:
        with open('/proc/%d/stat' % pid, errors='replace') as stat:
            return stat.read().rsplit(')', 1)[1].split()
    except OSError:
        return []


def process_state(pid):
    """'T' stopped, 'Z' ended but not waited for ...; '' where there is none."""
    return ''.join(_fields(pid)[:1])


def parent_of(pid):
    """Its pid; None where there is no such process."""
    fields = _fields(pid)
    return int(fields[1]) if fields else None


def is_gone(pid):
    return process_state(pid) in ('', 'Z', 'X')
