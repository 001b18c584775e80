"""A node that runs another file of the ring is refused by its neighbours, and all who are asked say so."""

import json

import ring_process
from ring_process import PATIENT, RingTest, free_udp_ports, plain_nodes

QUICK = {'silence': '200ms'}  # PATIENT would take a killed node for alive for 5 s


class Agreement(RingTest):
    def edited(self, nodes, **timeouts):
        ring = {'ring': self.ring, 'nodes': nodes, 'links': self.links, 'timeouts': {**PATIENT, **QUICK, **timeouts}}
        return self.write('edited.yaml', json.dumps(ring))

    def restart_edited(self, transport, nodes, **timeouts):
        """Node 1 of a running ring comes back with an edited file."""
        self.links = {'transport': transport, 'port': free_udp_ports(3)}
        daemons = self.start_ring(plain_nodes(3), links=self.links, timeouts=QUICK)
        daemons[1].terminate()
        self.wait_exit(daemons[1])
        self.daemons = daemons
        return self.ringd(self.edited(nodes, **timeouts), 1)

    def refusals(self):
        return [refusal['text'] for node in (0, 2) for refusal in (self.row(node) or {}).get('refusals', [])]

    def check_refused(self, what):
        said = 'node node1 is refused by node node2: it runs another ring file: ' + what
        self.wait('said by node 2', lambda: said in self.refusals())
        self.wait('the others go on', lambda: all((self.row(node) or {}).get('ring_size') == 2 for node in (0, 2)))
        self.assertGreater(self.counters(2)['input_other_ring_file'], 0)
        self.wait('node 0 was refused, too', lambda: self.counters(0)['output_other_ring_file'] > 0)
        self.wait('in the log', lambda: 'node 1 (node1): it runs another ring file: ' + what in
                  self.log_of(self.daemons[2]))
        self.assertIn(said.split(':')[1], self.ctl('status', '--ring', self.ring).stdout)
        waited = self.ctl('wait', 'up', '--timeout', '0.5', '--ring', self.ring)
        self.assertEqual(waited.returncode, 1)
        self.assertIn('it runs another ring file: ' + what, waited.stderr)
        self.assertEqual(self.ctl_json('ping', '--ring', self.ring, '--from', 0, '--to', 2, '--count', 5)['delivered'], 5)

    def test_other_timeouts_on_unix_lines_until_the_file_is_put_right(self):
        edited = self.restart_edited('unix', plain_nodes(3), beacon='150ms')
        self.check_refused('timeouts differ')
        edited.terminate()
        self.wait_exit(edited)
        self.ringd(self.write_ring(plain_nodes(3), links=self.links, timeouts=QUICK), 1)
        self.wait_closed(range(3))
        self.wait('nobody is refused any more', lambda: not self.refusals())

    def test_another_order_of_nodes_on_udp_lines(self):
        nodes = plain_nodes(3)
        self.restart_edited('udp', [nodes[2], nodes[1], nodes[0]])
        self.wait('refused', lambda: any('it runs another ring file: nodes' in text for text in self.refusals()))

    def test_a_renamed_node_on_lines_through_shared_memory(self):
        nodes = plain_nodes(3)
        nodes[1] = {**nodes[1], 'name': 'neck'}
        self.restart_edited('shm', nodes)
        self.check_refused('nodes differ')

    def test_what_may_differ_from_host_to_host_hinders_nobody(self):
        self.links = {'transport': 'shm'}
        config = self.write_ring(plain_nodes(3), links=self.links, timeouts=QUICK)
        for node in (0, 1):
            self.ringd(config, node)
        ring = {'ring': self.ring, 'nodes': plain_nodes(3), 'links': self.links, 'limits': {'send_queue': 9},
                'timeouts': {**PATIENT, **QUICK, 'command': '1s'}, 'realtime': {'cores': [0]}}
        self.ringd(self.write('other.yaml', json.dumps(ring)), 2)
        self.wait_closed(range(3))


if __name__ == '__main__':
    ring_process.main()
