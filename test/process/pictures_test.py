"""Pictures as pages: one file of HTML with SVG inside, which loads nothing."""

import os
import re
import subprocess
import tempfile
import unittest

import ring_process

CONFIG = os.environ['RING_TEST_CONFIG']


class Pictures(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, 'page.html')

    def run_program(self, name, *words):
        return subprocess.run([ring_process.program(name), *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True, timeout=ring_process.GUARD)

    def page(self):
        with open(self.path, encoding='utf-8') as file:
            text = file.read()
        self.assertTrue(text.endswith('</body></html>\n'))
        self.assertNotRegex(text, r'src=|href=|<script|@import|url\(')
        return text

    def test_a_simulated_plan_has_a_histogram_and_a_bound_for_each_stream(self):
        config = os.path.join(CONFIG, 'leg8.yaml')
        done = self.run_program('ring_sim', 'plan', config, '--simulate', '200ms', '--html', self.path)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = self.page()
        streams = len(re.findall('<figure', page))
        self.assertGreater(streams, 8)
        self.assertEqual(len(re.findall('class="bound"', page)), len(re.findall('within its bound', page)))
        self.assertNotIn('beyond its bound', page)
        self.assertEqual(len(re.findall('<svg', page)) + page.count('no message'), streams)

    def test_a_plan_that_measures_nothing_has_no_picture(self):
        done = self.run_program('ring_sim', 'plan', os.path.join(CONFIG, 'leg8.yaml'), '--html', self.path)
        self.assertEqual(done.returncode, 2)
        self.assertIn('--html goes with --simulate', done.stderr)
        self.assertFalse(os.path.exists(self.path))


if __name__ == '__main__':
    ring_process.main()
