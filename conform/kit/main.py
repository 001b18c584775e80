"""The command line, and the run."""

import argparse
import json
import os
import random
import shutil
import struct
import sys
import tempfile
import time

from . import bench as benches
from . import cases_line, cases_packets, cases_sending  # noqa: F401: they fill the table
from . import report
from .case import CASES, chosen
from .play import NAMES, ORDER, OWN, Failed, Lenient, NotApplicable, NotRun, Play, config_of
from .report import FAILED, LENIENT, NOT_APPLICABLE, NOT_RUN, PASSED, Result

OK, NOT_CONFORM, USAGE, NO_NODE = 0, 1, 2, 3
TRIES = 4  # of a case while the kit itself is not scheduled
PROFILES = ('minimal', 'full')


def new_parser():
    parser = argparse.ArgumentParser(
        prog='ringctl conform', formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Is this node as docs/protocol.md says? Plays all its neighbours, and gives a verdict for each rule.',
        epilog='PROGRAM is started for the kit. In its arguments {ring} is the ring\'s file, {name} the ring\'s name, {node} the '
               'node\'s id,\n{port} links.port, {ids} all ids in ring order, {agreement} the 56 bytes of protocol.md section 6.13 as '
               'hexadecimal digits.\n\nExit codes: 0 no case has failed, 1 one has, 2 wrong usage, 3 there is no node.')
    parser.add_argument('--usage', action='help', help='print this, and end')
    parser.add_argument('--list', action='store_true', help='print all cases, and end')
    parser.add_argument('--only', action='append', default=[], metavar='SECTION', help='cases of this section, or one by its number: 4.10, 2.2-1')
    parser.add_argument('--profile', choices=PROFILES, default='minimal', help='what the node claims to be (protocol.md section 12); default: minimal')
    parser.add_argument('--strict', action='store_true', help='what is lenient has failed')
    parser.add_argument('--expect', metavar='FILE', help='YAML: numbers of cases that are known to fail, and why')
    parser.add_argument('--line', choices=('udp', 'unix', 'shm'), default='udp', help='default: udp')
    parser.add_argument('--address', metavar='HOST', help='the node runs already, at this address')
    parser.add_argument('--port', type=int, help='links.port; default: free ones')
    parser.add_argument('--name', help='the ring\'s name; default: drawn')
    parser.add_argument('--library', metavar='FILE', help='the node is a shared library (tiny_node/examples/library_node.c)')
    parser.add_argument('--cpu', metavar='COMMAND', help='the CPU in the ring\'s file, for ringd: a program that sends packets back')
    parser.add_argument('--json', metavar='FILE', help='write the results as JSON')
    parser.add_argument('--junit', metavar='FILE', help='... as JUnit XML')
    parser.add_argument('--html', metavar='FILE', help='... as a page')
    parser.add_argument('--captures', metavar='FOLDER', help='write a capture (pcapng) of each failure there')
    parser.add_argument('--quiet', action='store_true', help='print only what has not passed, without packets')
    parser.add_argument('program', nargs='*', help='behind --')
    return parser


def free_port():
    """First of as many UDP ports as there are ids."""
    import socket
    for _ in range(100):
        first = random.randrange(33000, 60000)
        sockets = []
        try:
            for node in ORDER:
                sockets.append(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
                sockets[-1].bind(('127.0.0.1', first + node))
            return first
        except OSError:
            continue
        finally:
            for made in sockets:
                made.close()
    raise benches.BenchError('no free UDP ports')


def ring_file(folder, options, config, port):
    """YAML, of which JSON is a part."""
    nodes = [{'id': node, 'name': name} for node, name in zip(ORDER, NAMES)]
    if options.cpu:
        nodes[ORDER.index(OWN)]['cpu'] = {'command': options.cpu.split()}
    links = {'transport': options.line}
    if options.line == 'udp':
        links['port'] = port
    path = os.path.join(folder, 'ring.yaml')
    with open(path, 'w', encoding='utf-8') as out:
        json.dump({'ring': config.ring, 'nodes': nodes, 'links': links}, out, indent=1)
    return path


def make_bench(options, folder, config):
    if options.library:
        return benches.LibraryBench(os.path.abspath(options.library), config)
    port = options.port or (free_port() if options.line == 'udp' else 0)
    others = [node for node in ORDER if node != OWN]
    process = None
    if options.program:
        values = {'ring': ring_file(folder, options, config, port), 'name': config.ring, 'node': OWN, 'port': port,
                  'ids': ','.join(map(str, ORDER)), 'agreement': config.agreement.hex()}
        process = benches.Process(options.program, values, folder)
    if options.line != 'udp':
        return benches.UnixBench(others, OWN, os.path.join(folder, 'limb_ring', config.ring), process, options.line == 'shm')
    return benches.UdpBench(others, OWN, options.address or '127.0.0.1', port, process)


# ---- the run ------------------------------------------------------------------------------------

def verdict_of(play, case, options):
    """@return verdict, why"""
    if case.line and case.line != play.bench.line:
        return NOT_APPLICABLE, 'a rule of %s lines' % case.line.upper()
    if PROFILES.index(case.profile) > PROFILES.index(options.profile):
        return NOT_RUN, 'not of the profile %s' % options.profile
    why = ''
    for _ in range(TRIES):
        try:
            play.begin_fresh() if case.start else play.begin()
            case.act(play)
            verdict, why = PASSED, ''
        except Failed as problem:
            play.clean = False
            verdict, why = FAILED, str(problem)
        except (IndexError, struct.error) as problem:
            play.clean = False
            verdict, why = FAILED, 'what it sends is too short (%s)' % problem
        except Lenient as problem:
            verdict, why = FAILED if options.strict else LENIENT, str(problem)
        except NotApplicable as problem:
            verdict, why = NOT_APPLICABLE, str(problem)
        except NotRun as problem:
            verdict, why = NOT_RUN, str(problem)
        if verdict != FAILED or not play.disturbed:
            return verdict, why
    return NOT_RUN, 'the machine is too busy: the kit itself did not run for 0.1 s. Seen: ' + why


def progress(options, at, count, case):
    if sys.stderr.isatty():
        print('\r\033[K%3d/%d  %-8s %s' % (at, count, case.number, case.title[:80]), end='', file=sys.stderr, flush=True)
    elif not options.quiet and at % 25 == 0:
        print('%d of %d cases' % (at, count), file=sys.stderr, flush=True)


def run_cases(play, cases, options, known):
    results = []
    for at, case in enumerate(cases, 1):
        progress(options, at, len(cases), case)
        begun = time.monotonic()
        verdict, why = verdict_of(play, case, options)
        result = Result(case, verdict, why, list(play.log), time.monotonic() - begun, case.number in known)
        results.append(result)
        if verdict in (FAILED, LENIENT):
            if sys.stderr.isatty():
                print('\r\033[K', end='', file=sys.stderr)
            print('\n'.join(report.result_lines(result, not options.quiet)), flush=True)
        if verdict == FAILED and options.captures:
            os.makedirs(options.captures, exist_ok=True)
            report.write_capture(report.capture_path(options.captures, case), result, play.config.ring)
    if sys.stderr.isatty():
        print('\r\033[K', end='', file=sys.stderr)
    return results


def known_failures(path):
    if not path:
        return {}
    import yaml  # for this alone
    with open(path, encoding='utf-8') as file:
        try:
            known = yaml.safe_load(file) or {}
        except yaml.YAMLError as problem:
            raise ValueError('%s: %s' % (path, problem)) from problem
    if not isinstance(known, dict):
        raise ValueError('%s: a map is expected, such as "4.10-3: forgets verdicts"' % path)
    numbers = {case.number for case in CASES}
    for number in known:
        if number not in numbers:
            raise ValueError('%s: %s: no such case; --list prints all' % (path, number))
    return known


def print_list(cases):
    for case in cases:
        line = ' (%s)' % case.line.upper() if case.line else ''
        print('%-8s %-8s %s%s\n    sent: %s\n    expected: %s, within %s' % (case.number, case.profile, case.title, line, case.sent, case.expected, case.by))
    print('%d cases' % len(cases))


def write_reports(options, results, about):
    for path, write in ((options.json, report.write_json), (options.junit, report.write_junit), (options.html, report.write_html)):
        if path:
            write(path, results, about)


def print_end(results, seconds, known):
    others = [one for one in results if one.verdict == NOT_RUN and not one.why.startswith('not of the profile')]
    for one in others:
        print('\n'.join(report.result_lines(one)))
    print(report.summary(results, seconds))
    for one in results:
        if one.expected:
            print('%s is known to fail%s: %s' % (one.case.number, '' if one.verdict == FAILED else ', but is ' + one.verdict, known[one.case.number]))


def conform(options, folder):
    cases = chosen(options.only)
    if not cases:
        print('ringctl conform: no case of %s; --list prints all' % ', '.join(options.only), file=sys.stderr)
        return USAGE
    if options.list:
        print_list(cases)
        return OK
    if sum(map(bool, (options.program, options.address, options.library))) != 1:
        print('ringctl conform: say which node: -- PROGRAM ARGUMENT ..., or --address HOST, or --library FILE', file=sys.stderr)
        return USAGE
    known = known_failures(options.expect)
    config = config_of(options.name or 'conform%d' % random.randrange(10 ** 6))
    bench = make_bench(options, folder, config)
    begun = time.monotonic()
    try:
        play = Play(bench, config)
        bench.start()
        try:
            play.begin()
            play.find_echo()
        except (Failed, NotRun) as problem:
            print('ringctl conform: the node does not join: %s' % problem, file=sys.stderr)
            if not bench.can_start() or bench.problem():
                return NO_NODE
            play.echoes = False
        results = run_cases(play, cases, options, known)
    finally:
        bench.close()
    seconds = time.monotonic() - begun
    print_end(results, seconds, known)
    node = options.library or options.address or ' '.join(options.program)
    write_reports(options, results, {'node': node, 'line': options.line, 'profile': options.profile, 'seconds': seconds})
    return NOT_CONFORM if any(one.verdict == FAILED and not one.expected for one in results) else OK


def main(arguments=None):
    options = new_parser().parse_args(arguments)
    folder = tempfile.mkdtemp(prefix='conform_')
    try:
        return conform(options, folder)
    except (benches.BenchError, OSError, ValueError) as problem:
        print('ringctl conform: %s' % problem, file=sys.stderr)
        return USAGE
    except KeyboardInterrupt:
        return 130
    finally:
        shutil.rmtree(folder, ignore_errors=True)
