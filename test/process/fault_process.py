"""What the tests of faults share: `ringctl fault`, and rings that notice soon."""

from ring_process import RingTest, free_udp_ports, plain_nodes

QUICK = {'silence': '300ms', 'first_successor': '50ms', 'break_grace': '50ms', 'fold_permission': '50ms', 'send': '100ms'}


class FaultTest(RingTest):
    def fault(self, *arguments, code=0):
        done = self.ctl('fault', *arguments)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout if code == 0 else done.stderr

    def begin(self, *arguments):
        """Ids of the faults that last."""
        return [begun['id'] for begun in self.ctl_json('fault', *arguments)]

    def listed(self):
        return {fault['id']: fault for fault in self.ctl_json('fault', 'list')['faults']}

    def ping(self, source, target, count=20):
        return self.ctl_json('ping', '--from', source, '--to', target, '--count', count)

    def udp_nodes(self, count):
        first = free_udp_ports(count)
        return [dict(node, link={'transport': 'udp', 'port': first + node['id']}) for node in plain_nodes(count)]
