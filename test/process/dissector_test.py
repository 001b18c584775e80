"""The Wireshark dissector, on captures of scenarios under the virtual clock, whose packets are known."""

import glob
import os
import shutil
import subprocess
import unittest

import ring_process
from ring_process import RingTest

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
LUA = os.path.join(SOURCE, 'wireshark', 'limb_ring.lua')

STORY = """
scenario: something of everything
nodes: 4
steps:
  - at: 1ms
    do: {send: {name: stream, from: node0, to: node2, size: 500, priority: 1}}
  - after: 1us
    do: {send: {name: stop, from: node3, to: node1, interrupt: 5}}
  - at: 2ms
    do: {corrupt: {line: node1 -> node2, packets: 1}}
  - after: 1us
    do: {send: {name: noisy, from: node1, to: node3, size: 20, priority: 3}}
  - at: 10ms
    do: {truncate: {line: node1 -> node2, packets: 1}}
  - after: 1us
    do: {send: {name: torn, from: node1, to: node3, size: 300}}
  - at: 30ms
    do: {kill: node3}
  - at: 100ms
    do: {start: node3}
  - when: {node: node3, is: up, ring_size: 4}
    within: 300ms
  - at: 400ms
"""


@unittest.skipUnless(shutil.which('tshark'), 'tshark is not installed')
class Dissector(RingTest):
    def setUp(self):
        super().setUp()
        self.environment['HOME'] = self.folder  # not the dissector that this user has installed
        self.capture = os.path.join(self.folder, 'story.pcapng')
        story = os.path.join(self.folder, 'story.yaml')
        with open(story, 'w') as file:
            file.write(STORY)
        done = self.ctl('scenario', 'run', story, '--capture', self.capture)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def shark(self, *arguments, scripts=(LUA,)):
        done = subprocess.run(['tshark', *('-Xlua_script:' + script for script in scripts), '-r', self.capture] +
                              list(arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True, env=self.environment, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.splitlines()

    def values(self, display_filter, *fields):
        """The fields of all packets that pass a display filter, a tuple each."""
        wanted = [word for field in fields for word in ('-e', 'limbring.' + field)]
        return [tuple(line.split('\t'))
                for line in self.shark('-Y', display_filter, '-T', 'fields', *wanted)]

    def test_it_dissects_every_packet(self):
        everything = '\n'.join(self.shark('-V'))
        self.assertIn('Ring network of articulated robots', everything)
        self.assertNotIn('Lua Error', everything)

    def test_one_that_is_loaded_already_is_not_an_error(self):
        other = os.path.join(self.folder, 'installed.lua')
        shutil.copy(LUA, other)
        self.assertIn('Ring network of articulated robots', '\n'.join(self.shark('-V', scripts=(other, LUA))))

    def test_install_dissector_explains_itself_and_installs_nothing_then(self):
        script = os.path.join(SOURCE, 'scripts', 'install_dissector')
        for option, code in (('--help', 0), ('--frob', 2)):
            done = subprocess.run([script, option], env=self.environment, stdout=subprocess.PIPE, timeout=60,
                                  universal_newlines=True)
            self.assertEqual(done.returncode, code)
            self.assertIn('usage: install_dissector', done.stdout)
        self.assertEqual(glob.glob(os.path.join(self.folder, '**', 'limb_ring.lua'), recursive=True), [])

    def test_a_data_packet_has_all_its_fields(self):
        seen = self.values('limbring.sid == 0 && limbring.channel == 0',
                           'kind', 'incarnation', 'try', 'hop', 'did', 'pri', 'fbc', 'crc.status')
        self.assertEqual([row[:3] for row in seen], [('0', '0', '0')] * 4)
        self.assertEqual([row[3] for row in seen], ['0', '1', '2', '3'])
        self.assertEqual({row[4:6] for row in seen}, {('2', '1')})
        self.assertEqual([row[6] == '255' for row in seen], [True, True, False, False])
        self.assertEqual({row[7] for row in seen}, {'1'})

    def test_an_interrupt_inside_a_data_packet_is_shown_as_such(self):
        seen = self.values('limbring.kind == 1 && limbring.capture.embedded == 1',
                           'sid', 'did', 'int', 'carrier.sid')
        self.assertTrue(seen)
        self.assertEqual(set(seen), {('3', '1', '5', '0')})

    def test_a_damaged_packet_and_its_retry_are_marked(self):
        damaged = self.values('limbring.expert.crc', 'sid', 'crc.status', 'capture.crc_bad')
        self.assertTrue(damaged)
        self.assertEqual({row[:2] for row in damaged}, {('1', '0')})
        retries = self.values('limbring.expert.retry && limbring.sid == 1', 'try')
        self.assertIn(('1',), retries)

    def test_a_torn_packet_is_shown_as_far_as_it_came(self):
        torn = self.values('limbring.expert.cut', 'sid', 'hop')
        self.assertTrue(torn)
        self.assertEqual({row[0] for row in torn}, {'1'})

    def test_beacons_and_events_are_in_words(self):
        beacons = self.values('limbring.control == 2', 'boot', 'beacon.cpu_state', 'beacon.input')
        self.assertTrue(beacons)
        self.assertTrue(all(int(boot) > 0 and state and line for boot, state, line in beacons))
        self.assertIn(('killed',), self.values('limbring.event', 'event'))

    def test_a_packet_shows_the_incarnation_of_its_source(self):
        told = self.values('limbring.control && limbring.sid == 3', 'boot', 'incarnation')
        self.assertEqual(len({int(boot) & 3 for boot, _ in told}), 2, told)  # before and after its restart
        self.assertTrue(all(int(boot) & 3 == int(incarnation) for boot, incarnation in told))

    def test_every_line_has_its_name(self):
        seen = {line for line in self.shark('-T', 'fields', '-e', 'frame.interface_name')}
        for line in ('node0 -> node1', 'node3 -> node0', 'node2 -> node0'):
            self.assertIn(line, seen)


if __name__ == '__main__':
    ring_process.main()
