"""The playground: the simulator as WebAssembly gives the figures of the programs, and its page shows them. Skipped where what it
needs is missing: emscripten, the sources that it is built of, node; and for the page a browser."""

import functools
import http.server
import os
import subprocess
import threading
import unittest

import ring_process
from view_process import CHROMIUM, NODE, WEB, has_playwright

ROOT = os.path.realpath(os.path.join(WEB, '..', '..'))
BUILD = os.environ.get('PLAYGROUND_BUILD', os.path.join(ROOT, 'build', 'playground'))


class Quiet(http.server.SimpleHTTPRequestHandler):
    extensions_map = dict(http.server.SimpleHTTPRequestHandler.extensions_map, **{'.mjs': 'text/javascript', '.wasm': 'application/wasm'})

    def log_message(self, *_):
        pass


class Playground(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if not NODE:
            raise unittest.SkipTest('node is not installed')
        built = subprocess.run([os.path.join(ROOT, 'scripts', 'make_playground'), BUILD], stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, universal_newlines=True)
        if built.returncode == 77:
            raise unittest.SkipTest(built.stdout.strip())
        assert built.returncode == 0, built.stdout
        cls.page = os.path.join(BUILD, 'page')

    def node(self, *words, **environment):
        programs = os.path.dirname(ring_process.program('ring_sim'))
        done = subprocess.run([NODE, *words], env=dict(os.environ, PAGE=self.page, PROGRAMS=programs, **environment), stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True, timeout=10 * ring_process.GUARD)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_it_gives_the_figures_of_the_programs(self):
        self.node('--test', os.path.join(WEB, 'playground_test.mjs'))

    @unittest.skipUnless(CHROMIUM and has_playwright(), 'chromium or playwright-core is not installed')
    def test_a_browser_hangs_and_resets_a_cpu_cuts_a_wire_and_runs_case_and_scenario(self):
        server = http.server.ThreadingHTTPServer(('127.0.0.1', 0), functools.partial(Quiet, directory=self.page))
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        self.addCleanup(server.server_close)
        self.addCleanup(thread.join)
        self.addCleanup(server.shutdown)
        self.node(os.path.join(WEB, 'in_browser.mjs'), 'http://127.0.0.1:%d/#pace=1&load=0' % server.server_port, 'playground',
                  CHROMIUM=CHROMIUM, GUARD_MS=str(int(1000 * ring_process.GUARD)))


if __name__ == '__main__':
    ring_process.main()
