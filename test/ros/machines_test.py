#!/usr/bin/python3
"""A ring on two hosts, started by roslaunch with its machine tags over ssh, and ended by Ctrl-C. Both hosts are this
machine, each with a loopback address and a runtime folder of its own; the SSH server is the test's."""
import os
import signal
import subprocess
import sys
import unittest
import xml.etree.ElementTree

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(HERE, '..', 'process'))
import ring_process  # noqa: E402
from hosts_process import HostsTest  # noqa: E402
from limb_ring.launcher import free_udp_ports  # noqa: E402
from limb_ring.processes import parent_of  # noqa: E402
from own_ssh import SSHD, SshServer, free_port  # noqa: E402

SETUP = os.path.join(ring_process.PROGRAMS, '..', '..', 'setup.sh')


def skip(reason):
    print('skipped: ' + reason)  # ctest shows it so
    sys.exit(0)


class Machines(HostsTest):
    def setUp(self):
        super().setUp()
        self.set_up_hosts('waist', 'head')
        self.addresses = ['127.0.0.1', '127.0.0.2']
        self.config = self.write_robot()
        self.ssh = SshServer(self.folder, self.addresses)
        self.addCleanup(self.ssh.stop)
        self.machines = self.write_machines()
        port = free_port(['127.0.0.1'])
        # As another user of this name roslaunch goes to a loopback address by ssh, too.
        self.environment.update(HOME=self.ssh.home, LOGNAME='somebody_else', ROS_HOME=self.folder, ROS_IP='127.0.0.1',
                                ROS_MASTER_URI='http://127.0.0.1:%d' % port)
        self.here = self.script('here.sh', '. %s\nexec "$@"\n' % SETUP)
        self.roslaunch = self.launcher.start('roslaunch', [
            self.here, 'roslaunch', '-p', str(port), 'limb_ring', 'ring.launch', 'config:=' + self.config,
            'machines:=' + self.machines])
        self.addCleanup(self.end_roslaunch)

    def write_robot(self):
        firmware = {'command': ['limb_firmware'], 'alive_period': '500ms'}
        nodes = [{'id': 0, 'name': 'waist0', 'host': 'waist', 'cpu': 'attached'},
                 {'id': 1, 'name': 'waist1', 'host': 'waist', 'cpu': firmware, 'joints': [{'name': 'waist_yaw'}]},
                 {'id': 2, 'name': 'head0', 'host': 'head', 'cpu': firmware, 'joints': [{'name': 'neck_yaw'}]}]
        hosts = [{'name': name, 'address': address} for name, address in zip(self.hosts, self.addresses)]
        return self.write_ring(nodes, hosts=hosts, links={'port': free_udp_ports(600)}, timeouts={'silence': '500ms'})

    def write_machines(self):
        """What ringctl prints, with the port and for each host its own surroundings."""
        printed = self.on('waist', 'hosts', 'launch', self.config, '--user', self.ssh.user)
        file = xml.etree.ElementTree.ElementTree(xml.etree.ElementTree.fromstring(printed))
        for machine in file.iter('machine'):
            host = machine.get('name')
            machine.set('ssh-port', str(self.ssh.port))
            machine.set('env-loader', self.script('env_%s.sh' % host, '''
                export XDG_RUNTIME_DIR=%s ROS_HOME=%s ROS_IP=%s
                . %s
                exec "$@"
                ''' % (self.hosts[host].runtime, self.hosts[host].folder, machine.get('address'), SETUP)))
        path = os.path.join(self.folder, 'machines.launch')
        file.write(path)
        return path

    def end_roslaunch(self):
        """Whatever the test has come to: killed, it would leave all behind that it has started."""
        if self.roslaunch.poll() is None:
            self.roslaunch.send_signal(signal.SIGINT)
            self.roslaunch.wait(ring_process.GUARD)

    def ros(self, *command):
        done = subprocess.run([self.here] + list(command), env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=ring_process.GUARD)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout

    def processes_at(self, host):
        """Of everything that was started there, but for our own children, which end what we leave behind: pid and command
        line."""
        mark = ('XDG_RUNTIME_DIR=' + self.hosts[host].runtime).encode()
        found = {}
        for pid in filter(str.isdigit, os.listdir('/proc')):
            try:
                with open('/proc/%s/environ' % pid, 'rb') as environ, open('/proc/%s/cmdline' % pid, 'rb') as line:
                    if mark in environ.read().split(b'\0') and parent_of(int(pid)) != os.getpid():
                        found[int(pid)] = line.read().replace(b'\0', b' ').decode()
            except OSError:
                continue  # it has ended, or is not ours
        return found

    def said(self):
        with open(self.roslaunch.log) as log:
            return log.read()

    def joints(self):
        states = self.ros('rostopic', 'echo', '-n', '1', '/joint_states')
        return {name for name in ('waist_yaw', 'neck_yaw') if name in states}

    def is_running(self, host):
        """All its processes are there and its nodes up; fails at once where roslaunch has ended."""
        self.assertIsNone(self.roslaunch.poll(), self.said())
        done = subprocess.run([ring_process.program('ringctl'), 'wait', 'up', '--timeout', '1'],
                              env=self.hosts[host].environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return done.returncode == 0

    def test_all_is_started_over_ssh_works_and_ends_by_one_ctrl_c(self):
        for host in self.hosts:
            self.wait('the ring up, seen from %s' % host, lambda: self.is_running(host))
        self.wait('the joints of both hosts', lambda: self.joints() == {'waist_yaw', 'neck_yaw'})
        self.assertIn('success: True', self.ros('rosservice', 'call', '/ring_bridge/stop', '{}'))
        self.wait('the stop as state', lambda: 'data: True' in self.ros('rostopic', 'echo', '-n', '1', '/stopped'))
        for host, what in (('waist', ['ringctl up', 'ringd', 'limb_firmware', 'ring_bridge']),
                           ('head', ['ringctl up', 'ringd', 'limb_firmware'])):
            for program in what:
                self.assertTrue([line for line in self.processes_at(host).values() if program in line],
                                '%s at %s' % (program, host))
        self.roslaunch.send_signal(signal.SIGINT)
        self.assertEqual(self.roslaunch.wait(ring_process.GUARD), 0, self.said())
        for host in self.hosts:
            self.wait('all ended at %s' % host, lambda: not self.processes_at(host))


if __name__ == '__main__':
    if not SSHD:
        skip('no sshd (apt-get install openssh-server)')
    try:
        import paramiko  # noqa: F401
    except ImportError:
        skip('roslaunch needs python3-paramiko for ssh')
    unittest.main(verbosity=2)
