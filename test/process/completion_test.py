"""Completion of the names of running rings and their nodes: it waits for nobody, and prints nothing else."""

import os
import subprocess

import ring_process
from ring_process import RingTest, plain_nodes

SCRIPT = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'completion', 'limb_ring.bash')


class Names(RingTest):
    def up(self, ring, names):
        """A ring of nodes with these names."""
        nodes = [dict(node, name=name) for node, name in zip(plain_nodes(len(names)), names)]
        self.ring = ring
        self.assertEqual(self.ctl('up', self.write_ring(nodes), '--detach').returncode, 0)

    def complete(self, *words):
        """What ringctl says to the shell."""
        done = self.ctl('complete', *words)
        self.assertEqual((done.returncode, done.stderr), (0, ''))
        return done.stdout.split()

    def complete_in_bash(self, *words):
        """What bash has then; `words` are split as bash does it: at '=', too."""
        script = '. "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _limb_ring "$1"; printf "%s\\n" "${COMPREPLY[@]}"'
        done = subprocess.run(['bash', '-c', script, SCRIPT, ring_process.program('ringctl'), *words],
                              env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True, timeout=ring_process.GUARD)
        self.assertEqual(done.stderr, '')
        return done.stdout.split()

    def test_nodes_of_the_ring_that_was_named_if_several_run(self):
        self.up('arm', ['elbow', 'wrist'])
        self.up('leg', ['hip', 'knee'])
        self.assertEqual(self.complete('--ring', ''), ['arm', 'leg'])
        self.assertEqual(self.complete('ping', ''), [])
        self.assertEqual(self.complete('--ring', 'leg', 'ping', ''), ['hip', 'knee'])
        self.assertEqual(self.complete('send', '--ring=arm', '--to', 'w'), ['wrist'])
        self.assertEqual(self.complete('--ring', 'none', 'ping', ''), [])
        self.assertEqual(self.complete('--ring', '../leg', 'ping', ''), [])
        self.assertEqual(self.complete_in_bash('--ring', '=', 'l'), ['leg'])
        self.assertEqual(self.complete_in_bash('--ring', '='), ['arm', 'leg'])
        self.assertEqual(self.complete_in_bash('--ring', '=', 'leg', 'reset', 'k'), ['knee'])

    def test_nodes_that_are_frozen_or_killed_are_completed_without_asking_them(self):
        self.up('leg', ['hip', 'knee'])
        self.assertEqual(self.ctl('fault', 'freeze', 'all').returncode, 0)
        self.assertEqual(self.complete('fault', 'thaw', ''), ['hip', 'knee'])
        self.assertEqual(self.ctl('fault', 'thaw', 'all').returncode, 0)
        self.assertEqual(self.ctl('fault', 'kill', 'all').returncode, 0)
        self.assertEqual(self.complete('fault', 'start', ''), ['hip', 'knee'])


if __name__ == '__main__':
    ring_process.main()
