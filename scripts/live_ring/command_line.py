"""What both programs are told."""
import argparse
import os
import secrets
import signal

from live_ring.ring import BUILT

SEEDS = 1000000   # small enough to be typed in again


def at_least(least, kind):
    def read(text):
        value = kind(text)
        if value < least:
            raise argparse.ArgumentTypeError('%s: it has to be %s or more' % (text, least))
        return value
    read.__name__ = kind.__name__
    return read


def parser(text):
    result = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    result.add_argument('--seed', type=at_least(0, int), default=secrets.randbelow(SEEDS), help='default: drawn')
    result.add_argument('--transport', choices=('unix', 'shm', 'udp'), help='default: shm')
    result.add_argument('--redundancy', choices=('none', 'foldback'), default='none', help='default: none')
    result.add_argument('--programs', default=os.environ.get('RING_TEST_PROGRAMS') or BUILT, metavar='FOLDER',
                        help='where ringd is; default: the build beside this script')
    return result


def interrupt_no_more():
    """While everything is being ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)


def parse(options):
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    told = options.parse_args()
    told.transport_given = told.transport is not None
    told.transport = told.transport or 'shm'
    told.programs = os.path.abspath(told.programs)
    ringd = os.path.join(told.programs, 'ringd')
    if not os.access(ringd, os.X_OK):
        options.error('no program %s; run `make build` first, or say where it is by --programs' % ringd)
    return told
