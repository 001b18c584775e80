"""A ring on several hosts: `hosts:` in its file, `ringctl up --host`, and every tool from every host."""

import json

import ring_process
from hosts_process import HostsTest


class TwoHosts(HostsTest):
    def setUp(self):
        super().setUp()
        self.set_up_hosts('waist', 'head')

    def test_each_starts_its_own_nodes_and_sees_all(self):
        self.assertIn('the 2 nodes of host waist are up',
                      self.on('waist', 'up', self.config, '--host', 'waist', '--detach', '--timeout', 30))
        self.assertEqual(self.states('waist')['head0'], 'down')
        self.up('head')
        for host in self.hosts:
            self.on(host, 'wait', 'up', '--timeout', 30)
            self.assertEqual(self.states(host), dict.fromkeys(self.names, 'up'))

    def test_lines_within_a_host_are_local_and_those_between_hosts_udp(self):
        self.up_all()
        before = self.datagrams_in()
        self.on('waist', 'ping', 'head1', '--from', 'waist0', '-c', 100, '-f', '-q')
        after = self.datagrams_in()
        self.assertEqual({name: after[name] - before[name] >= 100 for name in self.names},
                         {'waist0': True, 'waist1': False, 'head0': True, 'head1': False})

    def datagrams_in(self):
        return {row['name']: row['counters']['input_datagrams'] for host in self.hosts
                for row in self.json_on(host, 'status')['nodes'] if row['name'].startswith(host)}

    def test_host_killed_whole_is_bypassed_and_back(self):
        self.up_all()
        self.kill('head')
        self.on('waist', 'wait', 'head0', 'down', '--timeout', 30)
        self.wait('a ring of two', lambda: [row.get('ring_size') for row in self.json_on('waist', 'status')['nodes']]
                  == [2, 2, None, None])
        self.on('waist', 'ping', 'waist1', '--from', 'waist0', '-c', 10, '-f', '-q')
        self.up('head')
        for host in self.hosts:
            self.on(host, 'wait', 'up', '--timeout', 30)

    def test_bypass_leads_to_the_second_node_of_another_host_and_back(self):
        self.up_all()
        pid = self.json_on('head', 'status')['nodes'][2]['pid']
        self.on('head', 'fault', 'kill', 'head0')
        self.assertTrue(ring_process.is_gone(pid))
        for sender, to in (('waist1', 'head1'), ('waist0', 'waist1')):
            self.wait('a ring of three', lambda: self.json_on('waist', 'status')['nodes'][1]['ring_size'] == 3)
            self.on('waist', 'ping', to, '--from', sender, '-c', 10, '-f', '-q')
        self.on('head', 'fault', 'start', 'head0')
        self.on('waist', 'wait', 'up', '--timeout', 30)


class ThreeHostsFoldedBack(HostsTest):
    def setUp(self):
        super().setUp()
        self.set_up_hosts('waist', 'head', 'arm', redundancy='foldback')

    def test_cut_line_between_two_hosts_is_survived(self):
        self.up_all()
        self.on('waist', 'fault', 'cut', 'waist1:head0')
        for host in self.hosts:
            self.wait('folded', lambda: 'folded' in self.states(host).values())
        self.on('waist', 'send', '--from', 'waist1', '--to', 'head0', '--data', 'hello')
        self.on('head', 'send', '--from', 'head0', '--to', 'waist1', '--data', 'hello')
        self.on('waist', 'fault', 'heal', 'waist1:head0')
        for host in self.hosts:
            self.on(host, 'wait', 'up', '--timeout', 30)


class WrongUse(HostsTest):
    def setUp(self):
        super().setUp()
        self.set_up_hosts('waist', 'head')

    def refusal(self, *arguments):
        text = self.on('waist', 'up', *arguments, '--detach', code=2)
        self.assertEqual(list(self.hosts['waist'].daemons_left()), [])
        return text

    def test_hosts_are_named_that_there_are(self):
        self.assertIn("unknown host 'haed', did you mean 'head'?", self.refusal(self.config, '--host', 'haed'))
        self.assertIn('several hosts', self.refusal(self.config))
        self.assertIn('--host NAME', self.refusal(self.config))
        self.assertIn('has no `hosts`', self.refusal('--nodes', 3, '--host', 'waist'))
        self.assertIn('leave --host out', self.refusal(self.config, '--host', 'waist', '--clock', 'virtual'))

    def changed(self, *replaced):
        """The file with other words in the place of some."""
        with open(self.config) as file:
            text = file.read()
        for before, after in replaced:
            self.assertIn(before, text)
            text = text.replace(before, after)
        return self.write('changed.yaml', text)

    def test_address_that_is_not_of_this_machine(self):
        config = self.changed(('127.0.0.1', '203.0.113.1'), ('127.0.0.2', '203.0.113.2'),
                              ('"port"', '"insecure": true, "port"'))
        self.assertIn("host 'waist' has the address 203.0.113.1, which no interface of this machine has",
                      self.refusal(config, '--host', 'waist'))
        self.assertIn('no host of', self.refusal(config))
        daemon = self.run_ringd('--config', config, '--node', 'waist0')
        self.assertEqual(daemon.returncode, 1)
        self.assertIn('203.0.113.1', daemon.stderr)

    def test_host_without_nodes(self):
        config = self.changed(('"host": "head"', '"host": "waist"'))
        self.assertIn("host 'head' has no nodes", self.refusal(config, '--host', 'head'))

    def test_all_of_it_on_one_machine(self):
        self.on('waist', 'up', self.config, '--host', 'all', '--detach', '--timeout', 30)
        rows = self.json_on('waist', 'status')['nodes']
        self.assertEqual([row['counters']['input_datagrams'] for row in rows], [0] * 4)
        self.on('waist', 'down')

    def port_of_node_0(self):
        with open(self.config) as file:
            return json.load(file)['links']['port']

    def test_port_of_a_second_line_that_is_taken_is_named(self):
        port = self.port_of_node_0()
        fold = ('"links"', '"redundancy": "foldback", "links"')
        self.on('waist', 'up', self.changed(fold), '--host', 'waist', '--detach', '--timeout', 30)
        other = self.changed(fold, ('"port": %d' % port, '"port": %d' % (port + 256)))
        text = self.on('head', '--ring', 'other', 'up', other, '--host', 'waist', '--detach', '--timeout', 30, code=1)
        self.assertIn('cannot use udp 127.0.0.1:%d' % (port + 256), text)


if __name__ == '__main__':
    ring_process.main()
