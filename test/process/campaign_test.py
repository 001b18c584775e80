"""scripts/campaign, with programs that are none: it takes turns, says what ran, and goes on where it was; and
scripts/soak_tables with a test that is none.
"""
import json
import os
import stat
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CAMPAIGN = os.path.join(ROOT, 'scripts', 'campaign')

# A shell, since a Python takes longer to begin on a busy machine than its turn lasts, and would be asked to end before.
RING_SIM = '''#!/bin/sh
trap 'kill $!; echo "{\\"seeds\\": 7, \\"goals\\": {\\"cut_off\\": {\\"seeds\\": 3, \\"times\\": 4}, \\"none_left\\": {\\"seeds\\": 0, \\"times\\": 0}}}"; exit 1' INT
if [ "$1" = cause ]; then
  shift
  echo "THE CAUSE of $*"
  exit 0
fi
case "$*" in *--shrink*) exit 1 ;; esac
all="$*"
%s || printf 'seed %%s: 4 nodes\\npromise broken: whole again\\nagain with: ring_sim soak --first %%s --seeds 1%%s\\n' "$3" "$3" "${all##*--json}" >&2
sleep 600 > /dev/null 2>&1 &
wait
'''


# As a target of libFuzzer ends.
TARGET = '''#!%s
print('#9 DONE cov: 12 ft: 13')
print('stat::number_of_executed_units: 9')
'''

TEST_MODEL = '''#!%s
import os, sys
parts = os.environ['MODEL_WORLD'] == 'parts'
print(os.environ['MODEL_SEEDS'] + ' histories of seeds from ' + os.environ['MODEL_FIRST'] + ' on, of which 1 fold back, 20 outputs compared, '
      + ('1' if parts else '0') + ' histories parted')
sys.exit(1 if parts else 0)
'''


def put_program(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    os.chmod(path, stat.S_IRWXU)


class CampaignTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.programs, self.folder = os.path.join(folder.name, 'programs'), os.path.join(folder.name, 'campaign')

    def put_ring_sim(self, fails):
        put_program(os.path.join(self.programs, 'ring_sim'), RING_SIM % ('false' if fails else 'true'))

    def campaign(self, hours, *more, only='soak'):
        return subprocess.run([sys.executable, CAMPAIGN, '--programs', self.programs, '--folder', self.folder, '--only', only,
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

    def test_a_failed_seed_is_on_the_page_with_its_cause_whatever_its_world(self):
        self.put_ring_sim(True)
        done = self.campaign(0.0015)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn('promise broken: whole again', self.page())
        for turn in self.turns():
            options = turn['command'][turn['command'].index('--json') + 1:]
            self.assertIn(' '.join(['THE CAUSE of', turn['command'][3], *options]) + '\n', self.page())

    def test_fuzzing_shares_its_turn_among_all_targets_and_the_page_says_how_much_ran(self):
        self.put_ring_sim(False)
        for target in ('slices', 'packets'):
            put_program(os.path.join(self.folder, 'fuzz', 'tests', 'fuzz_' + target), TARGET % sys.executable)
        done = self.campaign(0.0001, '--fuzz', os.path.join(self.folder, 'fuzz'), '--minutes', '0.1', only='fuzz')
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertEqual(self.turns()[0]['command'][5], '2', 'seconds: half of the least turn')
        self.assertIn('2 targets, 18 executions', self.page())

    def test_core_and_model_are_compared_in_each_world_and_what_parts_is_on_the_page(self):
        self.put_ring_sim(False)
        test_model = os.path.join(self.folder, 'test_model')
        put_program(test_model, TEST_MODEL % sys.executable)
        done = self.campaign(0.0002, '--test-model', test_model, '--minutes', '0.001', only='model')
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertEqual({turn['kind'] for turn in self.turns()}, {'model, ' + world for world in ('usual', 'wide', 'parts', 'storms')})
        self.assertIn('20 outputs compared', self.page())
        failed = [turn for turn in self.turns() if turn['failures']]
        self.assertEqual({turn['kind'] for turn in failed}, {'model, parts'})
        self.assertIn('1 histories parted', self.page())

    def test_a_build_without_fuzz_targets_is_refused(self):
        self.put_ring_sim(False)
        done = self.campaign(0.0001, '--fuzz', self.folder, only='fuzz')
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn('`make fuzz` builds them', done.stdout)


class ComparedTest(unittest.TestCase):
    def test_the_table_counts_the_histories_of_each_world_and_those_that_parted(self):
        with tempfile.TemporaryDirectory() as folder:
            test_model, page = os.path.join(folder, 'test_model'), os.path.join(folder, 'soak.md')
            put_program(test_model, TEST_MODEL % sys.executable)
            with open(page, 'w', encoding='utf-8') as file:
                file.write('<!-- compared: written by scripts/soak_tables -->\nTHE LAST ONE\n<!-- end of compared -->\n')
            done = subprocess.run([sys.executable, os.path.join(ROOT, 'scripts', 'soak_tables'), 'compared', '--test-model', test_model,
                                   '--seeds', '130', '--first', '7', '--page', page],
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300, check=False)
            self.assertEqual(done.returncode, 1, done.stdout)
            with open(page, encoding='utf-8') as file:
                text = file.read()
            self.assertIn('| `usual` | 130 | 7 | 2 | 40 | 0 |', text)
            self.assertIn('| `parts` | 130 | 267 | 2 | 40 | 2 |', text)
            self.assertIn('| all | 520 | | 8 | 160 | 2 |', text)
            self.assertNotIn('THE LAST ONE', text)


if __name__ == '__main__':
    unittest.main()
