"""Options that scripts/chaos and scripts/fault_table have in common."""
import argparse
import os
import secrets
import signal

from live_ring.ring import BUILT

SEEDS = 1000000   # small enough to be typed in again


def at_least(least, kind):
    """For add_argument(type=...): a number of that kind, `least` or more."""
    def read(text):
        value = kind(text)
        if value < least:
            raise argparse.ArgumentTypeError('%s: it has to be %s or more' % (text, least))
        return value
    read.__name__ = kind.__name__
    return read


def new_parser(description):
    result = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
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


def parse(parser):
    """The options given; from now on SIGTERM ends the program as Ctrl-C does."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    options = parser.parse_args()
    options.transport_given = options.transport is not None
    options.transport = options.transport or 'shm'
    options.programs = os.path.abspath(options.programs)
    ringd = os.path.join(options.programs, 'ringd')
    if not os.access(ringd, os.X_OK):
        parser.error('no program %s; run `make build` first, or say where it is by --programs' % ringd)
    return options
