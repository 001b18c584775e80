"""Rings on several hosts for tests: here each host is a loopback address and a runtime folder of its own."""

import json
import os
import signal
import subprocess

import ring_process
from ring_process import RingTest, free_udp_ports
from limb_ring.launcher import Launcher


class HostsTest(RingTest):
    """`self.config` is the ring's file."""

    def set_up_hosts(self, *names, **sections):
        """Each host has two nodes, in the order of the names: waist0, waist1, head0 ..."""
        self.hosts = {name: Launcher(ring_process.PROGRAMS, prefix='host_') for name in names}
        for host in self.hosts.values():
            self.addCleanup(host.remove)
            self.addCleanup(host.end)
        nodes = [{'name': '%s%d' % (name, i), 'host': name} for name in names for i in range(2)]
        for i, node in enumerate(nodes):
            node['id'] = i
            node['cpu'] = {'command': ['limb_firmware'], 'alive_period': '500ms'}
        self.names = [node['name'] for node in nodes]
        hosts = [{'name': name, 'address': '127.0.0.%d' % (i + 1)} for i, name in enumerate(names)]
        timeouts = dict(sections.pop('timeouts', {}), silence='500ms')
        self.config = self.write_ring(nodes, hosts=hosts, links={'port': free_udp_ports(600)}, timeouts=timeouts,
                                      **sections)

    def on(self, host, *arguments, code=0):
        """Runs ringctl there, which is to end so. @return what it printed, both outputs"""
        done = self.ctl(*arguments, env=self.hosts[host].environment, stderr=subprocess.STDOUT)
        self.assertEqual(done.returncode, code, done.stdout)
        return done.stdout

    def json_on(self, host, *arguments, code=0):
        return json.loads(self.on(host, *arguments, '--json', code=code))

    def up(self, *hosts):
        for host in hosts:
            self.on(host, 'up', self.config, '--host', host, '--detach', '--timeout', 30)

    def up_all(self):
        self.up(*self.hosts)
        for host in self.hosts:
            self.on(host, 'wait', 'up', '--timeout', 30)

    def states(self, host):
        return {row['name']: row['state'] for row in self.json_on(host, 'status')['nodes']}

    def kill(self, host):
        """All processes of its ring, as a power cut would."""
        for pid in list(self.hosts[host].daemons_left()):
            os.kill(pid, signal.SIGKILL)
        self.wait('%s gone' % host, lambda: not list(self.hosts[host].daemons_left()))
