"""Options that scripts have in common: where the programs are, and what chaos and fault_table are asked for."""
import argparse
import os
import secrets
import signal

from live_ring import built

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


def add_programs(parser, what):
    """@param what is there, in words"""
    parser.add_argument('--programs', default=built.PROGRAMS, metavar='FOLDER',
                        help='where %s; default: the build beside this script' % what)


def folder_of_programs(parser, options, *names):
    """@return what --programs names, as an absolute path; ends the script where one of the programs is not there"""
    folder = os.path.abspath(options.programs)
    for name in names:
        program = os.path.join(folder, name)
        if not os.access(program, os.X_OK):
            parser.error('no program %s; run `make build` first, or say where it is by --programs' % program)
    return folder


def new_parser(description):
    result = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    result.add_argument('--seed', type=at_least(0, int), default=secrets.randbelow(SEEDS), help='default: drawn')
    result.add_argument('--transport', choices=('unix', 'shm', 'udp', 'mixed'),
                        help='mixed: lines of all three in turn; default: shm')
    result.add_argument('--keyed', action='store_true', help='UDP lines, with a key (links.key)')
    result.add_argument('--redundancy', choices=('none', 'foldback'), default='none', help='default: none')
    add_programs(result, 'ringd is')
    return result


def interrupt_no_more():
    """While everything is being ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)


def lines_in_words(options):
    return options.transport.upper() + (', keyed' if options.keyed else '')


def of_lines(options):
    """The options that say so again."""
    return '--transport ' + options.transport + (' --keyed' if options.keyed else '')


def parse(parser):
    """The options given; from now on SIGTERM ends the program as Ctrl-C does."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    options = parser.parse_args()
    options.transport_given = options.transport is not None
    options.transport = options.transport or ('udp' if options.keyed else 'shm')
    if options.keyed and options.transport not in ('udp', 'mixed'):
        parser.error('--keyed: %s lines have no key; leave it out, or --transport' % options.transport)
    options.programs = folder_of_programs(parser, options, 'ringd')
    return options
