"""A ring on several hosts: `hosts:` in its file, `ringctl up --host`, and every tool from every host."""

import json
import os

import ring_process
from hosts_process import HostsTest


class TwoHosts(HostsTest):
    def setUp(self):
        super().setUp()
        self.set_up_hosts('waist', 'head')

    def test_each_starts_its_own_nodes_and_sees_all(self):
        self.assertIn('all nodes of host waist are up (2)',
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

    def test_up_says_why_a_part_with_another_file_is_not_in_the_ring(self):
        self.up('waist')
        with open(self.config, encoding='utf-8') as file:
            ring = json.load(file)
        ring['timeouts']['beacon'] = '150ms'
        edited = self.write('edited.yaml', json.dumps(ring))

        def told():  # where waist is too slow to answer, it is passed over instead
            said = self.on('head', 'up', edited, '--host', 'head', '--detach', '--timeout', 30)
            self.on('head', 'down')
            self.assertIn('all nodes of host head are up (2), 2 of 4 are in the ring; ', said)
            return 'it runs another ring file: timeouts differ\n' in said
        self.wait('told', told)

    def datagrams_in(self):
        return {row['name']: row['counters']['input_datagrams'] for host in self.hosts
                for row in self.json_on(host, 'status', '--all')['nodes'] if row['name'].startswith(host)}

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


class FromOneHostToTheOther(HostsTest):
    """By what comes over the ring: beacons and packets."""

    def setUp(self):
        super().setUp()
        self.set_up_hosts('waist', 'head')
        self.up_all()

    def row_at(self, host, name):
        return next(row for row in self.json_on(host, 'status')['nodes'] if row['name'] == name)

    def test_reset_is_seen_on_both(self):
        self.assertIn('the CPU has booted again', self.on('waist', 'reset', 'head1', '--timeout', 20))
        for host in self.hosts:
            self.wait('two boots', lambda: self.row_at(host, 'head1')['cpu']['boots'] == 2)

    def test_stop_and_resume_are_seen_on_both(self):
        self.assertIn('4 of 4 stopped', self.on('waist', 'stop'))
        for host in self.hosts:
            self.wait('stops', lambda: 'stopped: all nodes' in self.on(host, 'status'))
        self.on('head', 'resume', 'waist1')
        self.on('waist', 'resume')
        for host in self.hosts:
            self.wait('no stops', lambda: 'stopped: ' not in self.on(host, 'status'))
        self.assertIn('1 of 1 stopped', self.on('waist', 'stop', 'head0'))

    def test_sync_has_the_clocks_of_both(self):
        for _ in range(2):
            sync = self.json_on('head', 'clock', 'sync')
            self.assertEqual([node['latched'] for node in sync['nodes']], [True] * 4)
            self.assertEqual([node['hops'] for node in sync['nodes']], [2, 3, 0, 1])
        self.assertIn('sync delivered', self.on('waist', 'clock', 'sync'))

    def test_packets_and_interrupts_arrive(self):
        self.on('waist', 'interrupt', '--from', 'waist0', '--to', 'head1', 2)
        self.on('waist', 'send', '--from', 'waist1', '--to', 'all', '--data', 'hello')
        self.on('head', 'ping', 'waist1', '-c', 3, '-f')

    def test_a_command_that_only_another_host_can_do_names_that_host(self):
        for command in (('fault', 'kill', 'head0'), ('send', '--from', 'head0', '--to', 'waist0', '--data', 'x'),
                        ('traffic', 'show', 'head1', '-n', 1), ('interrupt', '--from', 'head0', '--input', 0), ('fault', 'cut', 'head1:waist0')):
            text = self.on('waist', *command, code=3)
            self.assertIn('is on host head (127.0.0.2), this is host waist', text)
            self.assertIn('--ssh', text)

    def test_a_command_for_another_host_is_run_there_over_ssh(self):
        """By a stand-in for ssh that goes to the folder of that host."""
        log = self.write('ssh.log', '')
        self.script('ssh', 'while [ $# -gt 2 ]; do echo "$1" >> %s; shift; done\n[ "$1" = 127.0.0.2 ] || exit 255\n'
                    'XDG_RUNTIME_DIR=%s exec sh -c "$2"\n' % (log, self.hosts['head'].runtime))
        self.hosts['waist'].environment['PATH'] = self.folder + ':' + os.environ['PATH']
        self.assertIn('delivered', self.on('waist', '--ssh', 'send', '--from', 'head0', '--to', 'waist0', '--data',
                                           "it's; a $(word)"))
        self.on('waist', 'fault', 'kill', 'head0', '--ssh')
        self.on('waist', 'wait', 'head0', 'down', '--timeout', 30)
        self.assertIn('head0.kill', self.on('waist', '--ssh', 'traffic', 'show', 'head0', '-n', 1, code=3) +
                      self.on('head', 'fault', 'list'))
        self.on('waist', '--ring', self.ring, '--ssh', 'fault', 'start', 'head0')
        self.on('waist', 'wait', 'up', '--timeout', 30)
        with open(log) as file:
            self.assertIn('BatchMode=yes', file.read())

    def test_ssh_that_cannot_connect(self):
        self.script('ssh', 'echo nobody is there >&2; exit 255\n')
        self.hosts['waist'].environment['PATH'] = self.folder + ':' + os.environ['PATH']
        self.assertIn('nobody is there', self.on('waist', '--ssh', 'fault', 'kill', 'head0', code=3))

    def test_top_shows_all(self):
        text = self.on('waist', 'status', '--watch', '--once', '--interval', '0.1')
        self.assertIn('4 of 4 nodes up', text)

    def test_list_says_which_host_this_is(self):
        self.assertIn('waist (of waist, head)', self.on('waist', 'status', '--rings'))
        self.assertEqual([(ring['host'], ring['nodes'], ring['clock']) for ring in self.json_on('head', 'status', '--rings')],
                         [('head', 2, 'live')])

    def test_each_ends_its_own_part(self):
        self.on('waist', 'down')
        self.on('head', 'wait', 'waist1', 'down', '--timeout', 30)
        self.assertEqual(self.states('head')['head0'], 'up')
        self.on('head', 'down')


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

    def test_a_wrong_host_is_refused_with_the_hosts_that_exist(self):
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

    def test_another_part_in_the_same_runtime_folder_is_refused_with_what_would_be_right(self):
        self.up('waist')
        self.assertIn('needs a runtime folder of its own (XDG_RUNTIME_DIR)',
                      self.on('waist', 'up', self.config, '--host', 'head', '--detach', code=1))
        self.assertIn("is running already; 'ringctl down",
                      self.on('waist', 'up', self.config, '--host', 'waist', '--detach', code=1))

    def test_host_without_nodes(self):
        config = self.changed(('"host": "head"', '"host": "waist"'))
        self.assertIn("host 'head' has no nodes", self.refusal(config, '--host', 'head'))

    def test_all_of_it_on_one_machine(self):
        self.on('waist', 'up', self.config, '--host', 'all', '--detach', '--timeout', 30)
        rows = self.json_on('waist', 'status', '--all')['nodes']
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
        # Both nodes meet one that has their port; which of them is the first to end is told.
        self.assertRegex(text, 'cannot use udp 127.0.0.1:(%d|%d)' % (port + 256, port + 257))


if __name__ == '__main__':
    ring_process.main()
