"""A ring of real daemons in a folder of its own, ended with all it started."""
import json
import os
import resource
import signal
import subprocess

from live_ring import built  # noqa: F401
from limb_ring.launcher import Launcher, free_udp_ports, plain_nodes

NODES = 16
SUPERVISOR = 0
SUPERVISION = {'node': SUPERVISOR, 'policy': 'auto', 'grace': '1s', 'tries': 10, 'backoff': '100ms'}
NOTIFY = 3        # the factor that interrupts of the traffic have
SILENCE_MS = 250  # as config/humanoid16.yaml: a desktop that compiles lets a process wait for 100 ms
END_TIMEOUT = 10  # s
PROGRAM_TIMEOUT = 300   # s; a replay of all nodes takes a few
RECORDER_BYTES = 4 << 20  # of each node: a minute
KEY = 'ring.key'
MIXED = ('udp', 'shm', 'unix')   # the lines of --transport mixed, in turn


def name_of(node):
    return 'node%d' % (node % NODES)


def line_of(node):
    """The line out of that node, as `fault` takes it."""
    return '%s -> %s' % (name_of(node), name_of(node + 1))


class RingFailed(Exception):
    """The ring did what it must not."""


class LiveRing:
    """Nodes with a CPU of the caller's (attached) but for `child_nodes`, whose CPU ringd starts."""

    def __init__(self, options, child_nodes, child_command, records=False, foreign=()):
        """@param options of command_line.parse()
        @param child_command makes a CPU's command of the ring's folder
        @param records the nodes' flight recorders are on
        @param foreign nodes that are tiny_node_udp, the node in C, without a daemon"""
        self.records = records
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))   # CPUs are crashed on purpose
        self.launcher = Launcher(options.programs)
        self.launcher.environment['PYTHONDONTWRITEBYTECODE'] = '1'
        self.folder, self.redundancy = self.launcher.folder, options.redundancy
        self.transports = MIXED if options.transport == 'mixed' else (options.transport,)
        self.foreign = list(foreign)
        self.nodes = list(range(NODES))
        self.ours = [node for node in self.nodes if node not in self.foreign]   # those with a daemon
        self.child_nodes = [node for node in child_nodes if node in self.ours]
        self.name = 'live%d_%d' % (options.seed, os.getpid())
        self.links = {'key': self._key()} if options.keyed else {}
        self.config = self._write(child_command)
        self.daemons, self.killed, self.frozen = {}, set(), set()
        self.starts = {node: 0 for node in self.nodes}

    def _write(self, child_command):
        nodes = plain_nodes(NODES)
        first = free_udp_ports(NODES) if 'udp' in self.transports else 0
        for node in nodes:
            child = node['id'] in self.child_nodes
            node['cpu'] = {'command': child_command(self.folder), 'alive_period': '200ms'} if child else 'attached'
            if node['id'] in self.foreign:
                node['controller'] = 'foreign'
            node['pins'] = {str(NOTIFY): 'notify'}
            node['link'] = {'transport': self.transport_into(node['id'])}
            if node['link']['transport'] == 'udp':
                node['link']['port'] = first + node['id']
        ring = {'ring': self.name, 'redundancy': self.redundancy, 'nodes': nodes,
                'timeouts': {'silence': '%dms' % SILENCE_MS, 'cpu_boot': '30s'},
                'recorder': {'enabled': self.records, 'size': RECORDER_BYTES},
                'supervisor': SUPERVISION, 'links': self.links}
        return self.launcher.write('ring.yaml', json.dumps(ring))   # which is YAML too

    def _key(self):
        """Makes one. @return its file, beside the ring's"""
        self._program('ringctl', 'hosts', 'key', os.path.join(self.folder, KEY))
        return KEY

    def transport_into(self, node):
        """Of the line into that node."""
        return self.transports[node % NODES % len(self.transports)]

    @property
    def runtime(self):
        return self.launcher.runtime

    # ---- processes ------------------------------------------------------------------------

    def start(self):
        for node in self.nodes:
            self.start_node(node)

    def start_node(self, node):
        # In a session of its own: Ctrl-C is for the caller, who ends the ring.
        start = self._start_foreign if node in self.foreign else self._start_daemon
        self.daemons[node] = start(node, start_new_session=True)
        self.killed.discard(node)
        self.starts[node] += 1

    def _start_daemon(self, node, **options):
        return self.launcher.ringd(self.config, node, **options)

    def _start_foreign(self, node, **options):
        told = self._program('ringctl', 'check', self.config, '--foreign', str(node)).split()
        return self.launcher.start('tiny_%d' % node, [self.launcher.program('tiny_node_udp'), *told], **options)

    def logs_of(self, node):
        """Of each of its starts."""
        names = ('ringd_%s' % node, 'tiny_%d' % node)
        return [process.log for what, process in self.launcher.started if what in names]

    def kill(self, node):
        self.killed.add(node)
        self.daemons[node].kill()

    def gone(self, node):
        self.daemons[node].wait(END_TIMEOUT)

    def freeze(self, node):
        self.frozen.add(node)
        self.daemons[node].send_signal(signal.SIGSTOP)

    def thaw(self, node):
        self.daemons[node].send_signal(signal.SIGCONT)
        self.frozen.discard(node)

    def can_answer(self, node):
        return node in self.ours and node not in self.killed and node not in self.frozen

    def check(self):
        """@raise RingFailed where a daemon has ended that was not killed"""
        for node, daemon in self.daemons.items():
            if node not in self.killed and daemon.poll() is not None:
                raise RingFailed('%s of node %d (pid %d) has ended by itself with %d; its last lines:\n%s' % (
                    'tiny_node_udp' if node in self.foreign else 'ringd', node, daemon.pid,
                    daemon.returncode, self.last_lines(node)))

    def last_lines(self, node, count=20):
        with open(self.daemons[node].log, errors='replace') as log:
            return ''.join(log.readlines()[-count:])

    def save_recordings(self, folder):
        """All that the nodes have recorded, as files for `ringctl record check`. @return what ringctl says"""
        return self._program('ringctl', '--ring', self.name, 'record', 'save', folder)

    def replay(self, folder):
        """@raise RingFailed where a core does something else than was recorded of it"""
        return self._program('ringctl', 'record', 'check', folder)

    def _program(self, name, *arguments):
        done = subprocess.run([self.launcher.program(name), *arguments], env=self.launcher.environment,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                              timeout=PROGRAM_TIMEOUT)
        if done.returncode != 0:
            raise RingFailed('%s %s ended with %d:\n%s' % (name, ' '.join(arguments), done.returncode, done.stdout))
        return done.stdout

    def stop(self):
        for node in list(self.frozen):
            self.thaw(node)
        self.launcher.end(END_TIMEOUT)
        self.launcher.remove()
