"""What scripts/chaos does on a virtual ring with real programs: scenarios of random faults, drawn by seed, each played
twice. Every promise of the ring is judged at every event, and both runs have to have the same trace."""
import json
import os
import random
import subprocess
import time
from collections import Counter

from live_ring import drawn_scenario
from live_ring.ring import PROGRAM_TIMEOUT
from limb_ring.launcher import Launcher

DONE, NOT_DONE = 0, 1     # exit codes of ringctl
OUTCOMES = ('delivered', 'unconfirmed', 'no such node', 'lost', 'cancelled', 'refused', 'rejected')


class VirtualChaos:
    def __init__(self, options, say):
        self.options, self.say, self.started = options, say, time.monotonic()
        self.launcher = Launcher(options.programs)
        self.ring = self.launcher.write('ring.yaml', drawn_scenario.ring(options.redundancy))
        self.seeds = random.Random(options.seed)
        self.results, self.faults, self.problems = Counter(), Counter(), []

    def seconds(self):
        return time.monotonic() - self.started

    def run(self):
        """Until the time is over, but one scenario at least."""
        number = 0
        while not self.problems and (number == 0 or self.seconds() < self.options.minutes * 60):
            number += 1
            self.scenario(number, self.seeds.randrange(10 ** 6))

    def scenario(self, number, seed):
        drawn = drawn_scenario.DrawnScenario(seed)
        file = self.launcher.write('scenario.yaml', drawn.text(self.ring))
        first, second = self.play(file), self.play(file)
        sends = Counter({outcome: sum(send[outcome] for send in first['sends']) for outcome in OUTCOMES})
        self.results.update(sends)
        self.faults.update(drawn.kinds)
        self.say('%6.1f s  scenario %d: %s; %.1f s of the ring\'s time, %d sends have ended; trace hash %s' % (
            self.seconds(), number, ', '.join(drawn.kinds), first['lasted_ns'] / 1e9, sum(sends.values()), first['trace_hash']))
        self.problems += ['scenario %d: %s' % (number, problem) for problem in self.judge(drawn, first, second)]

    def play(self, file):
        command = [os.path.join(self.options.programs, 'ringctl'), 'scenario', 'run', '--virtual', file, '--json']
        try:
            done = subprocess.run(command, env=self.launcher.environment, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True,
                                  timeout=PROGRAM_TIMEOUT)
        except subprocess.TimeoutExpired as hangs:
            raise RuntimeError('it does not end: %s' % hangs)
        if done.returncode not in (DONE, NOT_DONE) or not done.stdout:
            raise RuntimeError('ringctl ended with %d: %s' % (done.returncode, done.stderr))
        return json.loads(done.stdout)[0]

    @staticmethod
    def judge(drawn, first, second):
        """What went wrong."""
        problems = [] if first['met'] else ['after %.6f s: expected: %s; seen: %s' % (
            first['lasted_ns'] / 1e9, first['expected'], first['seen'])]
        for line in first['log']:
            event = line.get('event')
            if event == 'cpu_ended' and line['node'] not in drawn.crashed or event == 'cpu_does_not_answer':
                problems.append('after %.6f s: %s, and nobody had told it to' % (line['at_ns'] / 1e9, line['what']))
        if first['trace_hash'] != second['trace_hash']:
            why = first['not_repeatable'] or second['not_repeatable'] or 'nothing is known why'
            problems.append('trace hash %s, and the second time %s (%s)' % (
                first['trace_hash'], second['trace_hash'], why))
        return problems

    def tally(self):
        self.say('\n%d sends: %s' % (sum(self.results.values()), ', '.join(
            '%d %s' % (count, outcome) for outcome, count in self.results.most_common() if count)))
        self.say('%d faults: %s' % (sum(self.faults.values()), ', '.join(
            '%d %s' % (count, kind) for kind, count in self.faults.most_common())))

    def stop(self):
        self.launcher.end()
        self.launcher.remove()
