"""scripts/campaign, with a ring_sim that is none: it takes turns, says what ran, and goes on where it was."""
import json
import os
import stat
import subprocess
import sys
import tempfile
import unittest

CAMPAIGN = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), 'scripts', 'campaign')

RING_SIM = '''#!%s
import json, signal, sys
if sys.argv[1] == 'cause':
    print('THE CAUSE of ' + sys.argv[2])
    sys.exit(0)
if '--shrink' in sys.argv:
    sys.exit(1)
first = int(sys.argv[sys.argv.index('--first') + 1])
if %r and '--world' not in sys.argv and '--redundancy' not in sys.argv:
    sys.stderr.write('seed %%d: 4 nodes\\npromise broken: whole again\\nagain with: ring_sim soak --first %%d --seeds 1\\n' %% (first, first))
    sys.stderr.flush()
signal.sigwait([signal.SIGINT])
print(json.dumps({'seeds': 7, 'goals': {'cut_off': {'seeds': 3, 'times': 4}, 'none_left': {'seeds': 0, 'times': 0}}}))
sys.exit(1)
'''


class CampaignTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.programs, self.folder = os.path.join(folder.name, 'programs'), os.path.join(folder.name, 'campaign')
        os.mkdir(self.programs)

    def put_ring_sim(self, fails):
        path = os.path.join(self.programs, 'ring_sim')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(RING_SIM % (sys.executable, fails))
        os.chmod(path, stat.S_IRWXU)

    def campaign(self, hours, *more):
        return subprocess.run([sys.executable, CAMPAIGN, '--programs', self.programs, '--folder', self.folder, '--only', 'soak',
                               '--minutes', '0.005', '--hours', str(hours), *more],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300, check=False)

    def turns(self):
        with open(os.path.join(self.folder, 'state.json'), encoding='utf-8') as file:
            return json.load(file)['turns']

    def page(self):
        with open(os.path.join(self.folder, 'campaign.md'), encoding='utf-8') as file:
            return file.read()

    def test_each_world_has_a_turn_and_the_page_says_what_was_never_met(self):
        self.put_ring_sim(False)
        done = self.campaign(0.0008, '--seed', '5')
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn('Campaign of seed 5 on ', done.stdout)
        self.assertGreater(len({turn['kind'] for turn in self.turns()}), 1)
        self.assertIn('Nothing failed.', self.page())
        self.assertIn('1 of 2 were met. Never: `none_left`.', self.page())

    def test_it_resumes_where_it_stopped(self):
        self.put_ring_sim(False)
        self.campaign(0.0004)
        before = self.turns()
        self.assertEqual(self.campaign(0.0008).returncode, 0)
        self.assertEqual(self.turns()[:len(before)], before)
        self.assertGreater(len(self.turns()), len(before))
        seeds = [turn['command'][3] for turn in self.turns()]
        self.assertEqual(len(set(seeds)), len(seeds), 'a seed was drawn twice')

    def test_a_failed_seed_is_on_the_page_with_its_cause(self):
        self.put_ring_sim(True)
        done = self.campaign(0.0001)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn('promise broken: whole again', self.page())
        self.assertIn('THE CAUSE of ' + self.turns()[0]['command'][3], self.page())


if __name__ == '__main__':
    unittest.main()
