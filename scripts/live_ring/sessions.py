"""All processes that roslaunch has started, found by their session, and signals to them."""
import os


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
