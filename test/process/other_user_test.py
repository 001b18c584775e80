"""A ring of another user: ringctl says that permission is denied, and changes nothing. It also ignores what another user
has put where our rings would be."""

import fcntl
import os
import struct
import subprocess

import ring_process
from ring_process import GUARD, RingTest, plain_nodes, program

NOBODY = 65534
F_OFD_SETLK = 37


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
        for command in (['status', '--rings'], ['down', '--all'], ['record', 'save', '/nowhere']):
            self.assertIn('Permission denied', self.ctl_of_nobody(*command).stderr, command)
        self._all_run(self.daemons)
        self.assertTrue(self.is_closed(self.daemons))

    def test_whose_runtime_folder_cannot_be_entered(self):
        self.assert_denied()

    def test_whose_runtime_folder_can_be_entered_but_not_the_ring(self):
        for folder in (self.folder, self.runtime):
            os.chmod(folder, 0o755)
        self.assert_denied()


class FolderOfOtherUser(RingTest):
    """Without XDG_RUNTIME_DIR the folder of all rings has a name that others can foresee, and make before us."""

    def setUp(self):
        super().setUp()
        if os.geteuid() != 0:
            self.skipTest('only root can become another user')
        del self.environment['XDG_RUNTIME_DIR']
        self.environment['TMPDIR'] = self.folder
        self.rings = os.path.join(self.folder, 'limb_ring-%d' % os.geteuid())

    def forge(self, ring, program, pid, note=None):
        """Leaves what reads as a node of a ring that `pid` holds, or held last, and gives it to nobody."""
        folder = os.path.join(self.rings, ring)
        os.makedirs(folder)
        lock = open(os.path.join(folder, '0.lock'), 'w')
        self.addCleanup(lock.close)
        lock.write('%d\n' % pid + '\0'.join((program, '/', os.path.join(self.folder, 'started'), '')))
        lock.flush()
        if note:
            with open(os.path.join(folder, '0.fault'), 'w') as file:
                file.write('1000 %s node0\n' % note)
        for path in (self.rings, folder):
            os.chown(path, NOBODY, NOBODY)
        return lock

    def assert_foreign(self, *command):
        done = self.ctl(*command)
        self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        self.assertIn('belongs to user %d, not to this one' % NOBODY, done.stderr)

    def test_names_a_process_that_is_not_signalled(self):
        victim = self.start('victim', ['/bin/sleep', '60'])
        lock = self.forge('forged', os.path.realpath('/bin/sleep'), victim.pid)
        fcntl.fcntl(lock, F_OFD_SETLK, struct.pack('hhqqi4x', fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0))
        self.assert_foreign('down', 'forged')
        self.assertEqual(self.ctl('down', '--all').returncode, 0)
        self.assertIsNone(victim.poll())

    def test_names_a_program_that_is_not_started(self):
        self.forge('forged', '/usr/bin/touch', 1, note='kill')
        self.assert_foreign('--ring', 'forged', 'fault', 'start', '0')
        self.assertFalse(os.path.exists(os.path.join(self.folder, 'started')))

    def test_links_to_a_folder_that_is_not_tidied(self):
        ours = os.path.join(self.folder, 'ours')
        os.mkdir(ours, 0o700)
        for name in ('0.lock', 'mail.log'):
            open(os.path.join(ours, name), 'w').close()
        os.mkdir(self.rings)
        os.symlink(ours, os.path.join(self.rings, 'linked'))
        os.chown(self.rings, NOBODY, NOBODY)
        self.ctl('down', 'linked')
        self.assertEqual(self.ctl('down', '--all').returncode, 0)
        self.assertEqual(sorted(os.listdir(ours)), ['0.lock', 'mail.log'])


if __name__ == '__main__':
    ring_process.main()
