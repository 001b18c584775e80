"""Wrong configurations and arguments: refused with what, where, and what would be right."""

import os

import ring_process
from ring_process import RingTest, plain_nodes

GOOD = 'ring: wrong\nnodes:\n  - {id: 0, name: a}\n  - {id: 1, name: b}\n'


class WrongFile(RingTest):
    def assert_refused(self, text, *expected):
        path = self.write('wrong.yaml', text)
        ended = self.run_ringd('--config', path, '--node', '0')
        self.assertEqual(ended.returncode, 2, ended.stderr)
        for part in expected:
            self.assertIn(part.replace('FILE', path), ended.stderr)
        self.assertFalse(os.path.exists(self.ring_folder('wrong')))

    def test_broken_yaml_names_file_and_line(self):
        self.assert_refused('ring: [wrong\nnodes:\n', 'FILE:')
        self.assert_refused('ring: wrong\n\tnodes: []\n', 'FILE:2')
        self.assert_refused('', 'FILE')
        self.assert_refused('- a list\n', 'FILE')
        self.assert_refused(GOOD + 'ring: twice\n', 'FILE:5', 'ring')
        self.assert_refused(GOOD + '---\nring: second\n', 'FILE')
        self.assert_refused('ring: \0wrong\n', 'FILE')
        self.assert_refused('a: &a [*a, *a]\n', 'FILE')

    def test_unknown_entries_are_named_with_what_is_allowed(self):
        self.assert_refused(GOOD + 'limit: {}\n', 'FILE:5', 'limit', 'limits')
        self.assert_refused(GOOD.replace('name: b', 'nmae: b'), 'FILE:4', 'nmae', 'name')
        self.assert_refused(GOOD + 'timeouts: {sendd: 1s}\n', 'FILE:5', 'sendd')

    def test_wrong_values_are_named_with_what_is_allowed(self):
        self.assert_refused(GOOD.replace('id: 1', 'id: 255'), 'FILE:4', '255', '0 to 254')
        self.assert_refused(GOOD.replace('id: 1', 'id: 0'), 'FILE:4', '0')
        self.assert_refused(GOOD.replace('name: b', 'name: a'), 'FILE:4', 'a')
        self.assert_refused(GOOD + 'timeouts: {send: 100}\n', 'FILE:5', '100', 'ms')
        self.assert_refused(GOOD + 'timeouts: {send: -5ms}\n', 'FILE:5', '-5ms')
        self.assert_refused(GOOD + 'links: {transport: carrier_pigeon}\n', 'FILE:5', 'carrier_pigeon', 'udp')
        self.assert_refused(GOOD + 'links: {rate: 1e99}\n', 'FILE:5', '1e99')
        self.assert_refused(GOOD + 'limits: {clients: none}\n', 'FILE:5', 'none', '1 to 1024')
        self.assert_refused(GOOD.replace('ring: wrong', 'ring: a/b'), 'FILE:1', 'a/b', 'letters')
        self.assert_refused(GOOD.replace('name: b', 'name: b, pins: {9: reset}'), 'FILE:4', '9')
        self.assert_refused('ring: wrong\nnodes: [{id: 0}]\n', 'FILE:2', '2 to 255')

    def test_files_that_cannot_be_read(self):
        for path in (os.path.join(self.folder, 'none.yaml'), self.folder, ''):
            ended = self.run_ringd('--config', path, '--node', '0')
            self.assertEqual(ended.returncode, 2, ended.stderr)
            self.assertNotEqual(ended.stderr, '')

    def test_a_ring_whose_file_has_a_name_that_is_not_utf_8_is_seen_by_all_tools(self):
        folder = os.fsencode(self.folder) + b'/\xff'
        os.mkdir(folder)
        with open(folder + b'/ring.yaml', 'w') as file:
            file.write(GOOD)
        up = self.ctl('up', os.fsdecode(folder) + '/ring.yaml', '--detach')
        self.assertEqual(up.returncode, 0, up.stderr)
        self.assertTrue(self.ctl_json('status')['path'].endswith('/\ufffd/ring.yaml'))
        self.assertEqual(self.ctl('ping', 'b', '-c', '1').returncode, 0)

    def test_ringctl_up_refuses_the_same(self):
        path = self.write('wrong.yaml', GOOD + 'limit: {}\n')
        up = self.ctl('up', path, '--detach')
        self.assertEqual(up.returncode, 2)
        self.assertIn(path + ':5', up.stderr)


class WrongArguments(RingTest):
    def assert_usage(self, done, *expected):
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        for part in expected:
            self.assertIn(part, done.stderr)

    def test_of_ringd(self):
        path = self.write('good.yaml', GOOD)
        self.assert_usage(self.run_ringd(), '--config')
        self.assert_usage(self.run_ringd('--config', path), '--node')
        self.assert_usage(self.run_ringd('--config', path, '--node', 'nobody'), 'nobody', '0/a 1/b')
        self.assert_usage(self.run_ringd('--config', path, '--index', '2'), '0 to 1')
        self.assert_usage(self.run_ringd('--config', path, '--node', '0', '--nodes', '3'), '3', '2 nodes')
        self.assert_usage(self.run_ringd('--nodes', '1', '--index', '0'), '2')
        self.assert_usage(self.run_ringd('--nodes', '256', '--index', '0'), '255')
        self.assert_usage(self.run_ringd('--config', path, '--node', '0', '--ring', '../x'), '../x')
        self.assert_usage(self.run_ringd('--config', path, '--node', '0', '--transport', 'tcp'), 'tcp', 'udp')
        self.assert_usage(self.run_ringd('--frobnicate'), 'frobnicate')

    def test_of_ringctl(self):
        self.start_ring(plain_nodes(2))
        send = ['send', '--from', 0, '--to', 1]
        self.assert_usage(self.ctl(*send, '--size', 0), '1')
        self.assert_usage(self.ctl(*send, '--size', 513), '512')
        self.assert_usage(self.ctl(*send, '--data', 'x' * 513), '512')
        self.assert_usage(self.ctl(*send, '--data', ''), '512')
        self.assert_usage(self.ctl(*send))
        self.assert_usage(self.ctl(*send, '--size', 5, '--priority', 4), '3')
        self.assert_usage(self.ctl(*send, '--size', 5, '--priority', -1))
        self.assert_usage(self.ctl(*send, '--size', 5, '--channel', 1), 'channel')
        self.assert_usage(self.ctl('send', '--from', 0, '--to', 'nobody', '--size', 5), 'nobody', 'node1')
        self.assert_usage(self.ctl('send', '--from', 9, '--to', 1, '--size', 5), '9')
        self.assert_usage(self.ctl('interrupt', '--from', 0, '--to', 1, 8), '7')
        self.assert_usage(self.ctl('interrupt', '--from', 'nobody', '--input', 1), 'nobody')
        self.assert_usage(self.ctl('interrupt', '--from', 0, '--input', 'x'))
        self.assert_usage(self.ctl('ping', '--from', 0, '--to', 1, '--size', 513), '512')
        self.assert_usage(self.ctl('ping', '--from', 0, '--to', 1, '--count', 0))
        self.assert_usage(self.ctl('reset', 'nobody'), 'nobody')
        self.assert_usage(self.ctl('--ring', '../x', 'status'), '../x')
        self.assert_usage(self.ctl('traffic', 'show', '--json', '--ascii'), '--json')
        self.assert_usage(self.ctl('traffic', 'show', '--json', '--decode'), '--json')
        self.assert_usage(self.ctl('dance'))
        self.assert_usage(self.ctl())

    def test_smallest_and_largest_packets_pass(self):
        self.start_ring(plain_nodes(2))
        for size in (1, 2, 3, 4, 511, 512):
            self.assertEqual(self.ctl_json('ping', '--from', 0, '--to', 1, '--size', size)['delivered'], 10)

    def test_ring_that_is_not_there(self):
        gone = self.ctl('--ring', 'nowhere', 'status')
        self.assertEqual(gone.returncode, 3)
        self.assertIn('nowhere', gone.stderr)
        self.assertEqual(self.ctl('status').returncode, 3)

    def test_a_capture_over_the_rings_own_file_is_refused(self):
        path = self.write('good.yaml', GOOD)
        for command in (('ringd', '--config', path), ('ringctl', 'up', path)):
            ended = self.run_program(*command, '--clock', 'virtual', '--pace', 'max', '--for', '0.01', '--capture', path)
            self.assertEqual(ended.returncode, 2, ended.stderr)
            self.assertIn("--capture names the ring's file: %s would be lost" % path, ended.stderr)
        with open(path) as file:
            self.assertEqual(file.read(), GOOD)


if __name__ == '__main__':
    ring_process.main()
