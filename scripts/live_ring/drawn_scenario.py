"""A scenario of random faults under traffic, by seed: what scripts/chaos plays on a virtual ring with real programs."""
import json
import random

from live_ring import disturbances, rounds
from live_ring.ring import NODES, NOTIFY, SUPERVISION, line_of, name_of
from limb_ring.launcher import plain_nodes

FIRMWARE = (3, 7, 11, 15)     # have limb_firmware; the others a CPU that takes packets
ROUNDS = 5
GUARD = '30s'                 # of the ring's time, until it is whole again

# Faults with their parameters: of a line, and of a CPU until `resume`.
OF_LINES = dict(disturbances.OF_LINES, **disturbances.OF_UDP_LINES, cut='', stall='')
OF_CPUS = dict(disturbances.OF_CHILD_CPUS, babble='every=1ms')
CURED = ('hang', 'crash', 'reset')     # by the supervisor, by the node, at once
OF_NODES = {'kill': 'start', 'freeze': 'thaw', 'suspend': 'thaw'}
STEPS = ('back=3600s', 'forward=3600s')    # of the wall clock, before a node starts anew


def ring(redundancy):
    """Its file; JSON is YAML too."""
    nodes = plain_nodes(NODES)
    for node in nodes:
        node['pins'] = {str(NOTIFY): 'notify'}
        if node['id'] in FIRMWARE:
            node['cpu'] = {'command': ['limb_firmware'], 'alive_period': '200ms'}
            node['joints'] = [{'name': 'joint%d' % node['id']}]
    return json.dumps({'ring': 'chaos', 'redundancy': redundancy, 'nodes': nodes,
                       'supervisor': SUPERVISION})


class DrawnScenario:
    """kinds: of its faults; crashed: nodes whose CPU it ends."""

    def __init__(self, seed):
        self.chance = random.Random(seed)
        self.kinds, self.crashed, self.steps = [], set(), []
        self.boots = [1] * NODES     # of each CPU since its node's start
        self.traffic()
        for _ in range(ROUNDS):
            self.round()
        self.steps.append({'after': '1s', 'when': self.whole(), 'within': '0s'})
        self.seed = 1 + self.chance.randrange(10 ** 6)

    def text(self, ring_file):
        return json.dumps({'scenario': 'random faults', 'ring': ring_file, 'seed': self.seed, 'steps': self.steps})

    @staticmethod
    def whole():
        return {'node': 'all', 'is': 'up', 'ring_size': NODES}

    def do(self, action, parameters):
        self.steps.append({'after': '%dms' % self.chance.randrange(10, 300), 'do': {action: parameters}})

    def traffic(self):
        for node in range(NODES):
            for nth in range(2):
                self.send('unicast%d' % nth, node, size=self.chance.randrange(1, 513))
            self.send('interrupt', node, interrupt=NOTIFY)
            if node % 4 == 0:
                self.send('broadcast', node, to='all', size=self.chance.randrange(1, 513))

    def send(self, what, node, **more):
        to = self.chance.choice([other for other in range(NODES) if other != node])
        send = dict({'name': '%s_%d' % (what, node), 'from': name_of(node), 'to': name_of(to),
                     'priority': self.chance.randrange(4), 'every': '%dms' % self.chance.randrange(50, 150)}, **more)
        if 'interrupt' in send:
            del send['priority']
        self.steps.append({'do': {'send': send}})

    def round(self):
        mends, cpus = [], []
        for node in self.chance.sample(range(NODES), rounds.how_many(self.chance)):
            mends += self.chance.choice([self.line, self.cpu, self.node])(node, cpus)
        self.chance.shuffle(mends)
        for action, parameters in mends:
            self.do(action, parameters)
        self.steps.append({'when': self.whole(), 'within': GUARD})
        # Only now: behind a broken line the supervisor cannot reach a CPU.
        self.steps += [{'when': {'cpu': name_of(node), 'is': 'running', 'boots': self.boots[node]}, 'within': GUARD}
                       for node in cpus]

    def line(self, node, _):
        kind = self.begin(sorted(OF_LINES))
        line = line_of(node)
        self.do(kind, ('%s %s' % (line, OF_LINES[kind])).strip())
        return [('heal', line)]

    def cpu(self, node, cpus):
        kind = self.begin(sorted(OF_CPUS) + sorted(CURED))
        self.do(kind, ('%s %s' % (name_of(node), OF_CPUS.get(kind, ''))).strip())
        cpus.append(node)
        self.boots[node] += kind in CURED
        if kind == 'crash':
            self.crashed.add(name_of(node))
        return [('resume', name_of(node))] if kind in OF_CPUS else []

    def node(self, node, cpus):
        kind = self.begin(sorted(OF_NODES) + ['power_cycle'])
        if kind == 'power_cycle':
            self.do('step_clock', '%s %s' % (name_of(node), self.chance.choice(STEPS)))
        self.do(kind, name_of(node))
        cpus.append(node)
        if kind not in ('freeze', 'suspend'):
            self.boots[node] = 1
        return [(OF_NODES[kind], name_of(node))] if kind in OF_NODES else []

    def begin(self, kinds):
        self.kinds.append(self.chance.choice(kinds))
        return self.kinds[-1]
