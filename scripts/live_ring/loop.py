"""One loop for all connections, in one thread, so that what is checked has one order."""
import selectors
import time

STEP = 0.005   # s
SELDOM = 0.1   # s


class NotInTime(Exception):
    """What was waited for did not come."""


class Loop:
    def __init__(self):
        self.selector = selectors.DefaultSelector()
        self.turns = []    # called once a turn
        self.seldom = []   # called once in SELDOM: what costs more
        self.seldom_due = 0.0

    def add(self, connection, read):
        self.selector.register(connection, selectors.EVENT_READ, read)

    def remove(self, connection):
        self.selector.unregister(connection)

    def turn(self):
        for key, _ in self.selector.select(STEP):
            if key.fd in self.selector.get_map():   # not closed by one before it
                key.data()
        for each in self.turns:
            each()
        if time.monotonic() >= self.seldom_due:
            self.seldom_due = time.monotonic() + SELDOM
            for each in self.seldom:
                each()

    def until(self, what, condition, seconds):
        """Turns until condition() is true, and returns what it returned."""
        deadline = time.monotonic() + seconds
        while True:
            value = condition()
            if value:
                return value
            if time.monotonic() > deadline:
                raise NotInTime('not within %g s: %s' % (seconds, what() if callable(what) else what))
            self.turn()

    def run_for(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.turn()
