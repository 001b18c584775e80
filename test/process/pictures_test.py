"""Pictures as pages, one file of HTML with SVG inside that loads nothing; and timelines that ui.perfetto.dev loads without
complaint."""

import json
import os
import re
import unittest

import ring_process
from ring_process import CONFIG, RingTest, plain_nodes

SCENARIOS = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', 'scenarios')
BREAK = os.path.join(SCENARIOS, '01-broken-wire-in-the-left-leg.yaml')
DEAD = os.path.join(SCENARIOS, '03-two-nodes-dead.yaml')


class Pictures(RingTest):
    def setUp(self):
        super().setUp()
        self.path = os.path.join(self.folder, 'page.html')

    def page(self):
        with open(self.path, encoding='utf-8') as file:
            text = file.read()
        self.assertTrue(text.endswith('</body></html>\n'))
        self.assertNotRegex(text, r'src=|href=|<script|@import|url\(')
        return text

    def test_a_simulated_plan_has_a_histogram_and_a_bound_for_each_stream(self):
        config = os.path.join(CONFIG, 'leg8.yaml')
        done = self.run_program('ring_sim', 'plan', config, '--simulate', '200ms', '--html', self.path)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = self.page()
        streams = len(re.findall('<figure', page))
        self.assertGreater(streams, 8)
        self.assertEqual(len(re.findall('class="bound"', page)), len(re.findall('within its bound', page)))
        self.assertNotIn('beyond its bound', page)
        self.assertEqual(len(re.findall('<svg', page)) + page.count('no message'), streams)

    def test_a_plan_that_measures_nothing_has_no_picture(self):
        done = self.run_program('ring_sim', 'plan', os.path.join(CONFIG, 'leg8.yaml'), '--html', self.path)
        self.assertEqual(done.returncode, 2)
        self.assertIn('--html goes with --simulate', done.stderr)
        self.assertFalse(os.path.exists(self.path))

    def ping(self, *more):
        return self.ctl('--ring', self.ring, 'ping', 'node2', '--from', 'node0', '-c', '50', '-f', '-q', *more)

    def test_a_ping_has_a_histogram_of_its_round_trips_beside_the_bound_that_is_given(self):
        self.start_ring(plain_nodes(4))
        for bound, verdict in (('1000s', '✓ within its bound'), ('1us', '✕ 50 beyond its bound'), (None, 'no bound')):
            done = self.ping('--html', self.path, *(['--bound', bound] if bound else []))
            self.assertEqual(done.returncode, 0, done.stderr)
            page = self.page()
            self.assertIn('50 messages, median', page)
            self.assertIn(verdict, page)
            self.assertEqual(len(re.findall('class="bound"', page)), 1 if bound else 0)
            counts = re.findall(r'<title>(\d+) of [\d.]+ (?:to [\d.]+ us|us and more)<', page)
            self.assertEqual(sum(map(int, counts)), 50)

    def test_a_bound_without_a_page_is_refused_and_so_is_a_page_that_cannot_be_written(self):
        done = self.ping('--bound', '1ms')
        self.assertEqual(done.returncode, 2)
        self.assertIn('--bound goes with --html', done.stderr)
        done = self.ping('--html', os.path.join(self.folder, 'none', 'page.html'))
        self.assertEqual(done.returncode, 2)
        self.assertIn('--html', done.stderr)

    def test_a_ping_of_no_ring_leaves_the_file_as_it_was(self):
        self.write('page.html', 'old')
        self.assertNotEqual(self.ping('--html', self.path).returncode, 0)
        with open(self.path) as file:
            self.assertEqual(file.read(), 'old')

    def test_a_scenario_has_a_row_of_states_for_each_node_and_its_report(self):
        done = self.ctl('scenario', 'run', DEAD, '--html', self.path)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = self.page()
        self.assertEqual(len(re.findall('class="row"', page)), 16)
        self.assertRegex(page, r'class="state off"[^>]*><title>[^<]*: down, [\d.]+ to [\d.]+ ms')
        self.assertRegex(page, r'class="interrupt"[^>]*><title>[^<]*: killed')
        self.assertIn(done.stdout.splitlines()[0], page)

    def test_a_page_of_a_scenario_goes_with_no_capture_and_with_one_scenario_only(self):
        for more, why in ((['--capture', 'x.pcapng'], 'excludes'), (['--perfetto', 'x.json'], 'excludes'), ([DEAD], 'one scenario at a time'),
                          (['--live'], 'only under the virtual clock')):
            done = self.ctl('scenario', 'run', BREAK, '--html', self.path, *more)
            self.assertEqual(done.returncode, 2, more)
            self.assertIn(why, done.stderr)
        self.assertFalse(os.path.exists(self.path))


class Digits(str):
    """A number of a JSON file, as it is written."""


class Track:
    """Slices of one track, as Perfetto's trace processor stacks them (slice_tracker.cc): what is only partly inside another one is
    dropped, with an error."""

    def __init__(self):
        self.open = []

    def begin(self, begin, lasts, name):
        while self.open and self.open[-1] <= begin:
            self.open.pop()
        if self.open and begin + lasts > self.open[-1]:
            return '%s at %d ns is shown nowhere: it lasts %d ns longer than what it is in' % (name, begin, begin + lasts - self.open[-1])
        self.open.append(begin + lasts)
        return None


def nanoseconds(number):
    """Both ways in which it reads a time: `ts` by its digits, `dur` by its value (json_utils.cc, CoerceToTs)."""
    whole, _, behind = number.partition('.')
    return int(whole + (behind + '000')[:3]), int(float(number) * 1000)


FIELDS = {'M': {'name', 'args'}, 'X': {'name', 'ts', 'dur', 'args'}, 'i': {'name', 'ts', 's'},
          's': {'name', 'cat', 'id', 'ts'}, 't': {'name', 'cat', 'id', 'ts'}, 'f': {'name', 'cat', 'id', 'ts', 'bp'}}


def complaints(path):
    """What ui.perfetto.dev would complain of, or leave out, in a file of Chrome's trace events."""
    with open(path, encoding='utf-8') as file:
        trace = json.load(file, parse_float=Digits, parse_int=Digits)
    found, timed, names = [], [], {}
    if list(trace)[-1] != 'traceEvents' or trace['displayTimeUnit'] not in ('ms', 'ns'):
        found.append('the file: %s' % list(trace))
    for place, event in enumerate(trace['traceEvents']):
        kind, missing = event.get('ph'), FIELDS.get(event.get('ph'), {'ph'}) - set(event)
        if missing or not isinstance(event['name'], str):
            found.append('%s: without %s' % (event, missing))
            continue
        for number in ('pid', 'tid', 'id', 'ts', 'dur'):
            if number in event and not re.fullmatch(r'\d+' if number in ('pid', 'tid', 'id') else r'\d+(\.\d+)?', event[number]):
                found.append('%s: %s' % (event, number))
        for number in ('pid', 'tid'):
            if not 0 < int(event.get(number, 1)) < 2 ** 32:
                found.append('%s: %s is no number of 32 bits' % (event, number))
        if event['name'] == 'thread_name':
            names.setdefault(event['tid'], []).append(event['args']['name'])
        if event.get('tid') == event['pid']:
            found.append('%s: would be called a main thread' % event)
        for number in ('ts', 'dur'):
            if number in event and len(set(nanoseconds(event[number]))) != 1:
                found.append('%s: %s is two times of whole nanoseconds' % (event, number))
        if kind != 'M':
            timed.append((nanoseconds(event['ts'])[0], place, event))
    found += ['track %s has the names %s' % (track, all_of) for track, all_of in names.items() if len(all_of) != 1]
    return found + complaints_of_times(timed, names)


def complaints_of_times(timed, names):
    found, tracks, flows = [], {}, {}
    for time, _, event in sorted(timed, key=lambda one: one[:2]):
        track = tracks.setdefault((event['pid'], event['tid']), Track())
        if event['tid'] not in names:
            found.append('%s: a track without a name' % event)
        if event['ph'] in 'Xi':
            found.append(track.begin(time, nanoseconds(event['dur'])[1] if event['ph'] == 'X' else 0, event['name']))
            continue
        if not track.open or track.open[-1] < time:
            found.append('%s: an arrow at no slice' % event)
        if (event['ph'] == 's') != (event['id'] not in flows):
            found.append('%s: an arrow that begins twice, or has not begun' % event)
        if flows.get(event['id']) == 'f':
            found.append('%s: an arrow that has ended' % event)
        flows[event['id']] = event['ph']
    found += ['arrow %s does not end' % one for one, last in flows.items() if last != 'f']
    return [one for one in found if one]


class Timelines(RingTest):
    def assert_loads(self, path):
        self.assertEqual(complaints(path)[:5], [])

    def test_timelines_of_all_cases_of_the_paper_load_without_complaint(self):
        path = os.path.join(self.folder, 'case.json')
        for case, nodes in (('alone', 16), ('simultaneous', 16), ('adversarial', 16), ('saturated', 5), ('request', 16), ('delivery', 64),
                            ('interrupt', 16), ('interrupt_bound', 5), ('random', 7)):
            done = self.run_program('ring_sim', 'run', '--case', case, '--nodes', nodes, '--perfetto', path)
            self.assertEqual(done.returncode, 0, done.stderr)
            with self.subTest(case):
                self.assert_loads(path)

    def test_timelines_of_scenarios_load_without_complaint(self):
        path = os.path.join(self.folder, 'scenario.json')
        for scenario in (BREAK, DEAD, os.path.join(SCENARIOS, '20-truncated-packet-is-not-delivered-in-part.yaml'),
                         os.path.join(SCENARIOS, '37-fold-back-around-a-broken-wire.yaml')):
            done = self.ctl('scenario', 'run', scenario, '--perfetto', path)
            self.assertEqual(done.returncode, 0, done.stderr)
            with self.subTest(scenario):
                self.assert_loads(path)

    def test_the_timeline_of_a_live_capture_loads_without_complaint(self):
        self.start_ring(plain_nodes(4))
        capture, path = os.path.join(self.folder, 'live.pcapng'), os.path.join(self.folder, 'live.json')
        shown = self.start('show', [ring_process.program('ringctl'), '--ring', self.ring, 'traffic', 'show', 'all', '--at', 'in,out', '-w', capture,
                                    '--count', '400'])
        self.wait('the capture has begun', lambda: os.path.exists(capture) and os.path.getsize(capture) > 0)
        self.start('ping', [ring_process.program('ringctl'), '--ring', self.ring, 'ping', 'node2', '--from', 'node0', '-f', '-q', '-c', '2000'])
        self.assertEqual(self.wait_exit(shown), 0)
        done = self.ctl('traffic', 'why', capture, '--perfetto', path)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_loads(path)


if __name__ == '__main__':
    ring_process.main()
