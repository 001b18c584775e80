"""An SSH server of this user alone, in a folder of its own: keys that nobody else has, ports that are free."""
import getpass
import os
import shutil
import socket
import subprocess
import time

SSHD = shutil.which('sshd', path='/usr/sbin:/usr/local/sbin:' + os.environ.get('PATH', ''))


def free_port(addresses):
    """A TCP port that is free at all of them at this moment."""
    while True:
        probes = [socket.socket() for _ in addresses]
        try:
            probes[0].bind((addresses[0], 0))
            port = probes[0].getsockname()[1]
            for probe, address in zip(probes[1:], addresses[1:]):
                probe.bind((address, port))
            return port
        except OSError:
            continue
        finally:
            for probe in probes:
                probe.close()


class SshServer:
    """Runs until stop(). `home` is a home folder with a key that it takes, and with its own key among the known hosts."""

    def __init__(self, folder, addresses):
        self.user, self.addresses = getpass.getuser(), addresses
        self.home = os.path.join(folder, 'home')
        self._folder = os.path.join(folder, 'sshd')
        ssh = os.path.join(self.home, '.ssh')
        for path in (self._folder, self.home, ssh):
            os.mkdir(path, 0o700)
        self._key(os.path.join(self._folder, 'host_key'))
        self._key(os.path.join(ssh, 'id_ed25519'))
        self.port = free_port(addresses)
        with open(os.path.join(self._folder, 'host_key.pub')) as file:
            key = ' '.join(file.read().split()[:2])
        with open(os.path.join(ssh, 'known_hosts'), 'w') as file:
            for address in addresses:  # roslaunch looks for the address alone, paramiko for it with the port
                file.write('%s %s\n[%s]:%d %s\n' % (address, key, address, self.port, key))
        self._start(os.path.join(ssh, 'id_ed25519.pub'))

    @staticmethod
    def _key(path):
        subprocess.run(['ssh-keygen', '-q', '-t', 'ed25519', '-N', '', '-f', path], check=True)

    def _start(self, accepted):
        config = os.path.join(self._folder, 'sshd_config')
        with open(config, 'w') as file:
            file.write('Port %d\n' % self.port)
            file.writelines('ListenAddress %s\n' % address for address in self.addresses)
            file.write('HostKey %s\nAuthorizedKeysFile %s\nPidFile none\nUsePAM no\nStrictModes no\n'
                       'PasswordAuthentication no\nPermitRootLogin prohibit-password\n'
                       % (os.path.join(self._folder, 'host_key'), accepted))
        if os.getuid() == 0:
            os.makedirs('/run/sshd', 0o755, exist_ok=True)  # where it gives up its rights; a package's boot script makes it
        self.log = os.path.join(self._folder, 'log')
        self._process = subprocess.Popen([SSHD, '-D', '-f', config, '-E', self.log], stdin=subprocess.DEVNULL)
        deadline = time.monotonic() + 30
        while not self._answers():
            if self._process.poll() is not None or time.monotonic() > deadline:
                raise AssertionError('sshd: ' + open(self.log).read())
            time.sleep(0.02)

    def _answers(self):
        try:
            with socket.create_connection((self.addresses[-1], self.port), timeout=5) as connection:
                return connection.recv(4) == b'SSH-'
        except OSError:
            return False

    def stop(self):
        self._process.terminate()
        self._process.wait(30)
