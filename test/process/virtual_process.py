"""What tests of a virtual ring have in common."""

from ring_process import RingTest, plain_nodes


class VirtualTest(RingTest):
    def up(self, nodes, *more, **sections):
        """A virtual ring that is closed; its file."""
        config = self.write_ring(nodes, **sections)
        self.addCleanup(self.ctl, 'down', self.ring)
        self.up_again(config, *more)
        return config

    def up_again(self, config, *more):
        done = self.ctl('up', config, '--clock', 'virtual', '--detach', '--timeout', 60, *more)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def ring_ctl(self, *arguments):
        done = self.ctl('--ring', self.ring, *arguments)
        self.assertEqual(done.returncode, 0, '%s\n%s' % (arguments, done.stdout + done.stderr))
        return done.stdout

    def limbs(self):
        """Four nodes: 1 has a joint, 2 echoes, the others have no CPU."""
        nodes = plain_nodes(4)
        nodes[1].update(cpu={'command': ['limb_firmware'], 'alive_period': '300ms'}, joints=[{'name': 'knee'}])
        nodes[2]['cpu'] = {'command': ['echo_cpu']}
        return nodes
