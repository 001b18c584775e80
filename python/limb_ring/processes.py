"""What the kernel says of processes."""


def process_state(pid):
    """'T' stopped, 'Z' ended but not waited for ...; '' where there is none."""
    try:
        with open('/proc/%d/stat' % pid, errors='replace') as stat:
            return stat.read().rsplit(')', 1)[1].split()[0]
    except OSError:
        return ''


def is_gone(pid):
    return process_state(pid) in ('', 'Z', 'X')
