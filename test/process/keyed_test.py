"""Keyed UDP lines: nodes with one key are a ring; a node without it, or with another one, is refused by name."""

import json
import os
import resource
import signal
import stat

import ring_process
from ring_process import RingTest, free_udp_ports, plain_nodes


class Keyed(RingTest):
    def setUp(self):
        super().setUp()
        self.links = {'transport': 'udp', 'port': free_udp_ports(3)}
        self.key = self.keygen('ring.key')

    def keygen(self, name):
        path = os.path.join(os.path.dirname(self.write('beside.yaml', '')), name)
        made = self.ctl('hosts', 'key', path)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertIn("in a ring's file in the same folder: links: {key: %s}; elsewhere" % name, made.stdout)
        return path

    def file(self, name, nodes=3, **links):
        path = self.write_ring(plain_nodes(nodes), links={**self.links, **links}, timeouts={'silence': '500ms'})
        with open(path) as ring:
            return self.write(name, ring.read())

    def ring_with_a_stray_node(self, **links_of_node_2):
        keyed, other = self.file('keyed.yaml', key='ring.key'), self.file('other.yaml', **links_of_node_2)
        self.daemons = [self.ringd(keyed if node < 2 else other, node) for node in range(3)]
        self.wait('the two are a ring', lambda: all((self.row(n) or {}).get('ring_size') == 2 for n in (0, 1)))

    def refusals(self, node):
        return [refusal['text'] for refusal in (self.row(node) or {}).get('refusals', [])]

    def test_a_ring_with_a_key(self):
        keyed = self.file('keyed.yaml', key='ring.key', rate='unlimited')
        for node in range(3):
            self.ringd(keyed, node)
        self.wait_closed(range(3))
        self.assertEqual(self.ctl_json('ping', '--ring', self.ring, '--from', 0, '--to', 1, '--count', 500,
                                       '--size', 512, '-f')['delivered'], 500)
        for node in range(3):
            for bad in ('forged', 'replayed', 'truncated', 'stale'):
                self.assertEqual(self.counters(node)['input_datagrams_' + bad], 0)

    def test_a_node_of_a_keyed_ring_is_killed_and_back(self):
        keyed = self.file('keyed.yaml', key=self.key)  # an absolute path, too
        daemons = [self.ringd(keyed, node) for node in range(3)]
        self.wait_closed(range(3))
        daemons[1].kill()
        self.wait('bypassed', lambda: all((self.row(n) or {}).get('ring_size') == 2 for n in (0, 2)))
        self.ringd(keyed, 1)
        self.wait_closed(range(3))

    def test_a_node_without_the_key_is_refused_by_name(self):
        self.ring_with_a_stray_node()
        said = 'node node2 is refused by node node0: it has no key, and the lines here are keyed'
        self.wait('said', lambda: any(said in text for text in self.refusals(0)))
        self.wait('and by the other', lambda: any('and this node has no key' in text for text in self.refusals(2)))
        self.assertGreater(self.counters(0)['input_other_key'], 0)
        self.assertIn('it has no key', self.ctl('status', '--ring', self.ring).stdout)

    def test_a_node_with_another_key_is_refused_by_name(self):
        self.keygen('other.key')
        self.ring_with_a_stray_node(key='other.key')
        self.wait('said', lambda: any('is refused by node node0: it has another key' in text
                                      for text in self.refusals(0)))
        self.wait('and by the other', lambda: self.counters(2)['output_other_key'] > 0)

    def test_keys_that_keep_nobody_out_are_refused_at_the_start(self):
        keyed = self.file('keyed.yaml', key='ring.key')
        os.chmod(self.key, 0o644)
        self.assert_not_started(keyed, 'others may use it', 'chmod 600 ' + self.key)
        os.chmod(self.key, 0o600)
        with open(self.key, 'w') as key:
            key.write('secret\n')
        self.assert_not_started(keyed, 'holds no key')
        os.remove(self.key)
        self.assert_not_started(keyed, 'No such file', 'ringctl hosts key')

    def test_a_ring_without_udp_lines_needs_no_key_file(self):
        os.remove(self.key)
        local = self.file('local.yaml', transport='shm', key='ring.key')
        for node in range(3):
            self.ringd(local, node)
        self.wait_closed(range(3))

    def assert_not_started(self, config, *words):
        ended = self.run_ringd('--config', config, '--node', '0')
        self.assertEqual(ended.returncode, 2, ended.stderr)
        for word in ('links.key', *words):
            self.assertIn(word, ended.stderr)

    def test_keygen_makes_a_file_for_its_owner_and_overwrites_none(self):
        self.assertEqual(stat.S_IMODE(os.stat(self.key).st_mode), 0o600)
        with open(self.key) as key:
            text = key.read()
        self.assertRegex(text, '^[0-9a-f]{64}\n$')
        again = self.ctl('hosts', 'key', self.key)
        self.assertEqual(again.returncode, 1)
        self.assertIn('left as it is', again.stderr)
        with open(self.key) as key:
            self.assertEqual(key.read(), text)

    def test_a_key_that_cannot_be_written_whole_leaves_no_file_behind(self):
        def full_disk():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))

        path = os.path.join(self.folder, 'full.key')
        full = self.ctl('hosts', 'key', path, preexec_fn=full_disk)
        self.assertEqual(full.returncode, 1)
        self.assertIn('File too large', full.stderr)
        self.assertFalse(os.path.exists(path))

    def test_beyond_this_host_there_is_a_key_or_the_word_insecure(self):
        ring = {'ring': self.ring, 'nodes': plain_nodes(2), 'links': {**self.links, 'address': '192.0.2.1'}}
        ended = self.run_ringd('--config', self.write('open.yaml', json.dumps(ring)), '--node', '0')
        self.assertEqual(ended.returncode, 2)
        for word in ('has no key', 'ringctl hosts key', 'insecure: true'):
            self.assertIn(word, ended.stderr)


if __name__ == '__main__':
    ring_process.main()
