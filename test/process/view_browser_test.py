"""The page of `ringctl view`: its parts by node's test runner, all of it in a browser. Each is skipped where what it
needs is missing: node; chromium, and playwright-core, which 'npm ci --prefix test/web' installs."""

import os
import subprocess
import unittest

import ring_process
from ring_process import plain_nodes
from view_process import CHROMIUM, NODE, WEB, ViewTest, has_playwright


class Page(ViewTest):
    @unittest.skipUnless(NODE, 'node is not installed')
    def test_its_parts_do_what_their_tests_say(self):
        done = subprocess.run([NODE, '--test', os.path.join(WEB, 'model_test.mjs')], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True, timeout=ring_process.GUARD)
        self.assertEqual(done.returncode, 0, done.stdout)

    def in_browser(self, *steps):
        environment = dict(os.environ, CHROMIUM=CHROMIUM, GUARD_MS=str(int(1000 * ring_process.GUARD)))
        done = subprocess.run([NODE, os.path.join(WEB, 'in_browser.mjs'), self.address, *steps], env=environment,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                              timeout=3 * ring_process.GUARD)
        self.assertEqual(done.returncode, 0, done.stdout)

    @unittest.skipUnless(CHROMIUM and has_playwright(), 'chromium or playwright-core is not installed')
    def test_a_browser_cuts_a_wire_sees_the_break_and_mends_it(self):
        self.start_ring(plain_nodes(5))
        self.view('--control')
        self.in_browser('cut_and_mend')

    @unittest.skipUnless(CHROMIUM and has_playwright(), 'chromium or playwright-core is not installed')
    def test_a_browser_without_control_has_no_buttons_that_change_anything(self):
        self.start_ring(plain_nodes(5))
        self.view()
        self.in_browser('read_only')

    @unittest.skipUnless(CHROMIUM and has_playwright(), 'chromium or playwright-core is not installed')
    def test_on_a_phone_what_is_chosen_comes_into_view(self):
        self.start_ring(plain_nodes(5))
        self.view()
        self.in_browser('phone')


if __name__ == '__main__':
    ring_process.main()
