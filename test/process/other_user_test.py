"""A ring of another user: ringctl says that permission is denied, and changes nothing."""

import os
import subprocess

import ring_process
from ring_process import GUARD, RingTest, plain_nodes, program

NOBODY = 65534


def become_nobody():
    os.setgroups([])
    os.setgid(NOBODY)
    os.setuid(NOBODY)


class OtherUsersRing(RingTest):
    def setUp(self):
        super().setUp()
        if os.geteuid() != 0:
            self.skipTest('only root can become another user')
        self.daemons = self.start_ring(plain_nodes(2))

    def ctl_of_nobody(self, *arguments):
        try:
            return subprocess.run([program('ringctl')] + list(arguments), env=self.environment, cwd='/',
                                  preexec_fn=become_nobody, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, universal_newlines=True, timeout=GUARD)
        except PermissionError:
            self.skipTest('user nobody may not run ' + program('ringctl'))

    def assert_denied(self):
        for command in (['status'], ['ping', '1', '-c', '1'], ['down']):
            for ring in ([], ['--ring', self.ring]):
                done = self.ctl_of_nobody(*ring, *command)
                self.assertEqual(done.returncode, 3, command + ring)
                self.assertIn('Permission denied', done.stderr, command + ring)
                self.assertNotIn('no ring', done.stderr, command + ring)
        self._all_run(self.daemons)
        self.assertTrue(self.is_closed(self.daemons))

    def test_whose_runtime_folder_cannot_be_entered(self):
        self.assert_denied()

    def test_whose_runtime_folder_can_be_entered_but_not_the_ring(self):
        for folder in (self.folder, self.runtime):
            os.chmod(folder, 0o755)
        self.assert_denied()


if __name__ == '__main__':
    ring_process.main()
