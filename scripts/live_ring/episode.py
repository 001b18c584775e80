"""One fault from its beginning until the ring is whole again, measured."""
import time

from live_ring.loop import NotInTime

HOLD = 0.3   # s that a fault lasts beyond what the ring does about it, with traffic


class Row:
    """Of one fault, or of what mended it. Times in ns."""

    def __init__(self, fault, until_ns):
        self.kind, self.does = fault.kind, fault.does
        self.detection = fault.detected_ns - fault.began()
        self.recovery = fault.recovered_ns - fault.began()
        traffic = fault.live.traffic
        self.lost = traffic.lost(fault.concerns, fault.requested_ns, until_ns)


def watch_it(fault):
    """@return whether all its timestamps are known"""
    live = fault.live
    fault.start()
    if fault.patience is None:
        live.wait('what the ring does about a %s at node %d' % (fault.kind, fault.node), fault.poll)
        return True
    try:
        live.loop.until('', fault.poll, fault.patience)
    except NotInTime:
        return False
    return True


def run(fault, hold=HOLD):
    """Rows of the fault and of its repair, where there is one; none where it could not be seen."""
    live = fault.live
    live.watch.forget()
    live.traffic.forget()
    parts = [fault] if watch_it(fault) else []
    live.loop.run_for(hold)
    mending = fault.repair()
    mended_ns = time.monotonic_ns()
    if mending:
        watch_it(mending)
        parts.append(mending)
    whole_ns = settle(live)
    ends = [mended_ns, whole_ns] if len(parts) == 2 else [whole_ns]
    return [Row(part, end) for part, end in zip(parts, ends)]


def settle(live):
    """When the ring was whole again; what was sent until then has ended and been read when this returns."""
    live.wait_whole()
    whole_ns = time.monotonic_ns()
    live.wait_ended(whole_ns)
    live.wait('delivered packets to be read', live.traffic.promises.nothing_owed)
    return whole_ns


def tally(rows):
    """{kind: [Row]}, in the order in which they came."""
    kinds = {}
    for row in rows:
        kinds.setdefault(row.kind, []).append(row)
    return kinds
