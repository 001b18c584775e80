"""The recorded walk of a real humanoid, sent as joint commands in lockstep: the same trace every time."""

import os
import re
import subprocess
import sys

import ring_process
import yaml
from ring_process import RingTest

RECORDING = os.path.join(os.environ.get('LIMB_RING_DATA', ''), 'icub_walking', 'walking.csv')
ROWS, SECONDS = 1188, 13
CPU = os.path.join(os.path.dirname(os.path.realpath(__file__)), 'recorded_walk_cpu.py')


class RecordedWalk(RingTest):
    def robot(self):
        """The humanoid; its body's CPU plays the recording."""
        with open(os.path.join(ring_process.CONFIG, 'humanoid16.yaml')) as file:
            ring = yaml.safe_load(file)
        path = os.path.join(self.folder, 'walk.yaml')
        ring['nodes'][0]['cpu'] = {'command': [sys.executable, CPU, RECORDING, path]}
        return self.write('walk.yaml', yaml.safe_dump(ring, sort_keys=False))

    def walk(self, config):
        done = self.run_program('ringd', '--config', config, '--ring', self.ring, '--clock', 'virtual', '--pace', 'max',
                                '--for', SECONDS, stderr=subprocess.STDOUT, timeout=2 * ring_process.GUARD)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertNotIn('not repeatable', done.stdout)
        return done.stdout

    def test_leaves_the_same_trace_each_time(self):
        config = self.robot()
        logs = [self.walk(config) for _ in range(2)]
        obeyed = re.findall(r'commands: obeyed (\d+)', logs[0])
        self.assertEqual(obeyed.count(str(ROWS)), 14, 'every limb obeyed every row\n' + logs[0])
        hashes = [re.search(r'trace hash (\S+) of 13\.0', log).group(1) for log in logs]
        self.assertEqual(hashes[0], hashes[1])


if __name__ == '__main__':
    if not os.path.exists(RECORDING):
        print('skipped: %s is missing (set LIMB_RING_DATA)' % RECORDING)
        sys.exit(0)
    ring_process.main()
