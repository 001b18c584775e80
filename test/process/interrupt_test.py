"""Interrupt packets pull real pins."""

import math
import os
import re
import signal
import time

import ring_process
from ring_process import RingTest, plain_nodes
from limb_ring import Interrupt, Observed


def fields(interrupt):
    return interrupt.action, interrupt.source, interrupt.factor


class Pins(RingTest):
    def test_input_that_is_pulled_interrupts_its_destination(self):
        nodes = plain_nodes(3)
        nodes[0]['inputs'] = {'3': {'to': 'node2', 'factor': 4}}
        nodes[2].update(cpu='attached', pins={'4': 'notify'})
        self.start_ring(nodes)
        cpu = self.port(2, role='cpu')
        self.assertEqual(self.ctl_json('interrupt', '--from', 'node0', '--input', 3)['delivered'], 1)
        self.assertEqual(fields(cpu.next_of(Interrupt)), ('notify', 0, 4))
        unwired = self.ctl_json('interrupt', '--from', 'node0', '--input', 5, code=1)['results'][0]
        self.assertEqual(unwired['outcome'], 'rejected')
        self.assertNotEqual(unwired['reason'], '')

    def test_stop_reaches_every_cpu_of_the_ring(self):
        nodes = plain_nodes(3)
        for node in nodes:
            node['cpu'] = 'attached'
        self.start_ring(nodes)
        cpus = [self.port(node, role='cpu') for node in range(3)]
        observers = [self.port(node) for node in range(3)]
        for observer in observers:
            observer.observe('pin')
        self.assertEqual(self.ctl_json('stop', '--from', 1)['outcome'], 'delivered')
        for observer in observers:
            seen = observer.next_of(Observed).content
            self.assertEqual((seen['kind'], seen['factor'], seen['source']), ('pin', 1, 1))
        for cpu in cpus:  # the sender's too
            self.assertEqual(fields(cpu.next_of(Interrupt)), ('stop', 1, 1))
        self.ctl_json('stop', 'node2', '--from', 0)
        self.assertEqual(cpus[2].next_of(Interrupt).source, 0)

    def test_pin_wired_to_nothing_refuses(self):
        self.start_ring(plain_nodes(2))
        sent = self.ctl_json('interrupt', '--from', 0, '--to', 1, 7, code=1)['results'][0]
        self.assertEqual(sent['outcome'], 'refused')
        self.assertEqual(self.counters(1)['refused_unwired'], 1)

    def test_broadcast_reset_needs_force(self):
        self.start_ring(plain_nodes(3))
        boots = [self.answered(node)['cpu']['boots'] for node in range(3)]
        sent = self.ctl_json('interrupt', '--from', 0, '--to', 'all', 0, code=1)['results'][0]
        self.assertEqual(sent['outcome'], 'rejected')
        self.assertIn('force', sent['reason'])
        self.assertEqual([self.answered(node)['cpu']['boots'] for node in range(3)], boots)
        self.ctl_json('interrupt', '--from', 0, '--to', 'all', 0, '--force')
        self.assertEqual([self.answered(node)['cpu']['boots'] for node in range(3)],
                         [boots[0], boots[1] + 1, boots[2] + 1])

    def test_signal_pin_signals_the_cpu(self):
        nodes = plain_nodes(2)
        nodes[1].update(cpu='attached', pins={'5': {'signal': 'USR1'}})
        self.start_ring(nodes)
        cpu = self.start('cpu', [ring_process.program('echo_cpu'), self.ring, '1'])
        self.wait_cpu(1, 'running')
        self.ctl_json('interrupt', '--from', 0, '--to', 1, 5)
        self.assertEqual(self.wait_exit(cpu), -signal.SIGUSR1)
        self.wait_cpu(1, 'absent')

    def test_a_node_that_is_called_without_end_has_each_counted_and_few_in_its_log(self):
        nodes = plain_nodes(2)
        nodes[1]['pins'] = {'5': {'exec': ['false']}, '6': {'exec': ['no_such_command']}, '7': 'notify'}
        daemons = self.start_ring(nodes)
        caller = self.port(0)
        before = time.monotonic()
        for _ in range(300):
            for pin in (5, 6, 7):
                caller.wait(caller.interrupt(1, pin))
        counters = self.counters(1)
        self.assertEqual(counters['pins_pulled'], 900)
        self.assertGreaterEqual(counters['pin_commands_refused'], 300)
        self.assertGreater(counters['pin_commands_failed'], 0)
        spoken = [line for line in self.log_of(daemons[1]).splitlines() if 'INT' in line or 'of a pin' in line]
        # Of each pin 20 lines a second, and 10 of commands.
        self.assertLessEqual(len(spoken), (3 * 20 + 10) * (math.ceil(time.monotonic() - before) + 1))
        time_passes = time.monotonic() + 1
        self.wait('the next second', lambda: time.monotonic() > time_passes)
        caller.wait(caller.interrupt(1, 6))
        self.wait('the others told of', lambda: re.search(r'INT6 .*; \d+ more since the last such line', self.log_of(daemons[1])))

    def test_exec_pin_runs_its_command(self):
        mark = os.path.join(self.folder, 'mark')
        nodes = plain_nodes(2)
        nodes[1]['pins'] = {'6': {'exec': ['sh', '-c', 'echo "$LIMB_RING_NODE" > ' + mark]},
                            '7': {'exec': ['no_such_command']}, '5': {'exec': ['false']}}
        daemons = self.start_ring(nodes)
        self.ctl_json('interrupt', '--from', 0, '--to', 1, 6)
        self.wait('the command ran', lambda: os.path.exists(mark) and os.path.getsize(mark))
        with open(mark) as file:
            self.assertEqual(file.read().strip(), '1')
        self.ctl_json('interrupt', '--from', 0, '--to', 1, 7)
        self.wait('the reason is in the log', lambda: 'no_such_command' in self.log_of(daemons[1]))
        self.assertEqual(self.counters(1)['pin_commands_refused'], 1)
        self.ctl_json('interrupt', '--from', 0, '--to', 1, 5)
        self.wait('the failure is counted', lambda: self.counters(1)['pin_commands_failed'] == 1)
        self.assertEqual(self.counters(1)['pin_commands_timed_out'], 0)
        self.assertTrue(self.is_closed([0, 1]))

    def test_each_interrupt_pulls_once(self):
        nodes = plain_nodes(3)
        nodes[2].update(cpu='attached', pins={'3': 'notify'})
        self.start_ring(nodes)
        cpu = self.port(2, role='cpu')
        sender = self.port(0)
        tokens = [sender.interrupt(2, 3) for _ in range(40)]
        self.assertEqual([sender.wait(t).outcome for t in tokens], ['delivered'] * 40)
        for _ in range(40):
            self.assertEqual(cpu.next_of(Interrupt).factor, 3)
        self.assertEqual(self.counters(2)['pins_pulled'], 40)


class Sync(RingTest):
    def test_sync_gives_every_nodes_offset(self):
        self.start_ring(plain_nodes(4))
        sync = self.ctl_json('clock', 'sync', '--from', 2)
        self.assertEqual([row['id'] for row in sync['nodes']], [0, 1, 2, 3])
        self.assertEqual([row['hops'] for row in sync['nodes']], [2, 3, 0, 1])
        self.assertTrue(all(row['latched'] for row in sync['nodes']))

    def test_sync_measures_no_line_below_zero(self):
        self.start_ring(plain_nodes(4))
        for _ in range(20):
            for row in self.ctl_json('clock', 'sync')['nodes']:
                self.assertGreaterEqual(row['one_way_us'], 0, row)
        # Also where packets of others come in with what asks for it.
        self.start('ping', [ring_process.program('ringctl'), '--ring', self.ring, 'ping', 'node2', '--from', 'node1',
                            '-c', '100000', '-f', '-q'])
        port = self.port(0)
        for _ in range(1000):
            answer = port.ask({'do': 'sync'})
            self.assertGreaterEqual(answer['left_ns'], answer['clock_ns'])

    def test_sync_names_the_node_that_is_missing(self):
        daemons = self.start_ring(plain_nodes(4))
        daemons[3].kill()
        self.wait_closed([0, 1, 2])
        sync = self.ctl_json('clock', 'sync', '--from', 0, code=1)
        self.assertEqual([row['latched'] for row in sync['nodes']], [True, True, True, False])


if __name__ == '__main__':
    ring_process.main()
