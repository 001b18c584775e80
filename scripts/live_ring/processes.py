"""What the kernel says of processes, and signals to them."""
import os


def process_state(pid):
    """'T' stopped, 'Z' ended but not waited for ...; '' where there is none."""
    try:
        with open('/proc/%d/stat' % pid) as stat:
            return stat.read().rsplit(')', 1)[1].split()[0]
    except OSError:
        return ''


def is_gone(pid):
    return process_state(pid) in ('', 'Z', 'X')


def session_members(session):
    """Processes of a session, its leader among them."""
    members = []
    for entry in os.listdir('/proc'):
        try:
            if entry.isdigit() and os.getsid(int(entry)) == session:
                members.append(int(entry))
        except OSError:
            pass
    return members


def send_signal(pid, sign):
    """Nothing happens where the process is gone."""
    try:
        os.kill(pid, sign)
    except ProcessLookupError:
        pass
