#!/usr/bin/env python3
"""scripts/large_ring, on small rings."""
import os
import re
import subprocess
import sys
import unittest

PROGRAMS = os.environ['RING_TEST_PROGRAMS']
SCRIPT = os.path.join(os.path.dirname(__file__), '..', '..', 'scripts', 'large_ring')


def measure(*arguments):
    return subprocess.run([sys.executable, SCRIPT, '--programs', PROGRAMS, *arguments], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, check=False)


class LargeRing(unittest.TestCase):
    def test_it_says_how_long_each_ring_took_to_close(self):
        done = measure('--nodes', '6', '--hosts', '3', '--rounds', '2')
        self.assertEqual(done.returncode, 0, done.stderr)
        for what in ('`ringctl up --nodes 6`', '`ringctl up FILE`', 'killed with its 2 nodes', 'of that host',
                     'lap p99, ms', 'lap over 3 hosts p99, ms'):
            row = re.search(re.escape(what) + r' +([0-9.]+) +([0-9.]+) +([0-9.]+)$', done.stdout, re.MULTILINE)
            self.assertTrue(row, done.stdout)
            median, least, most = map(float, row.groups())
            self.assertTrue(0 < least <= median <= most, done.stdout)

    def test_wrong_arguments_are_named(self):
        done = measure('--nodes', '3')
        self.assertEqual(done.returncode, 2)
        self.assertIn('--nodes is 4 to 254', done.stderr)


if __name__ == '__main__':
    unittest.main()
