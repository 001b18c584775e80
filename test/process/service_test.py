"""What `systemctl --user start limb-ring@RING` relies on: a ring is found by its name, and systemd is told once it is closed."""

import os
import socket
import subprocess

import ring_process
from ring_process import RingTest, plain_nodes


class Service(RingTest):
    def up(self, *arguments, **more):
        return subprocess.run([ring_process.program('ringctl'), 'up', *arguments, '--detach', '--timeout', '60'],
                              env={**self.environment, **more}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True, timeout=ring_process.GUARD * 2, check=False)

    def home_with(self, name):
        """A home with a ring's file of that name."""
        folder = os.path.join(self.folder, 'home', '.config', 'limb_ring')
        os.makedirs(folder)
        os.rename(self.write_ring(plain_nodes(2)), os.path.join(folder, name + '.yaml'))
        self.environment.pop('XDG_CONFIG_HOME', None)
        return os.path.join(self.folder, 'home')

    def test_a_ring_is_found_by_its_name(self):
        done = self.up('desk', HOME=self.home_with('desk'))
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn('closed: 2 nodes up', done.stdout)

    def test_a_file_of_ones_own_comes_before_one_of_that_name_that_came_with_limb_ring(self):
        done = self.up('leg8', HOME=self.home_with('leg8'))
        self.assertIn('closed: 2 nodes up', done.stdout)
        self.ctl('--ring', self.ring, 'down')
        done = self.up('leg8', HOME=self.folder)
        self.assertIn('closed: 8 nodes up', done.stdout)

    def test_an_unknown_name_is_refused_with_where_it_was_looked_for(self):
        done = self.up('lge8', HOME=self.folder)
        self.assertEqual(done.returncode, 2)
        for place in (os.path.join(self.folder, '.config/limb_ring'), '/etc/limb_ring', 'share/limb_ring/config'):
            self.assertIn(place, done.stdout)

    def test_systemd_is_told_once_the_ring_is_closed(self):
        path = os.path.join(self.folder, 'notify')
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
            manager.bind(path)
            manager.settimeout(ring_process.GUARD)
            done = self.up('desk', HOME=self.home_with('desk'), NOTIFY_SOCKET=path)
            self.assertEqual(done.returncode, 0, done.stdout)
            told = manager.recv(4096).decode()
        self.assertIn('READY=1\n', told)
        self.assertIn('STATUS=ring %s is closed: 2 nodes up' % self.ring, told)


if __name__ == '__main__':
    ring_process.main()
