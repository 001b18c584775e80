"""The runner of the manual notices what is not as the page says."""
import os
import subprocess
import sys
import tempfile
import unittest

RUNNER = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'run_manual.py')


def run(page):
    """@return (exit code, all that was printed) for a page of that text"""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'page.md')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(page)
        done = subprocess.run([sys.executable, RUNNER, '--programs', folder, path], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=200, check=False)
        return done.returncode, done.stdout


class RunManual(unittest.TestCase):
    def passes(self, page):
        code, printed = run(page)
        self.assertEqual(code, 0, printed)

    def fails(self, page, words):
        code, printed = run(page)
        self.assertEqual(code, 1, printed)
        self.assertIn(words, printed)

    def test_a_command_that_prints_what_the_page_says_passes(self):
        self.passes('```console\n$ echo hello\nhello\n```\n')

    def test_other_output_fails_with_both_versions(self):
        self.fails('```console\n$ echo hello\ngoodbye\n```\n', '-goodbye')

    def test_output_that_the_page_leaves_out_fails(self):
        self.fails('```console\n$ echo hello\n```\n', '+hello')

    def test_an_exit_code_that_the_page_does_not_tell_fails(self):
        self.fails('```console\n$ false\n```\n', 'exit code 1, 0 on the page')
        self.passes('```console\n$ false\n[exit code 1]\n```\n')

    def test_times_and_pids_may_differ_and_counts_may_not(self):
        self.passes('```console\n$ echo "back after 12.5 ms, pid 7"\nback after 3 us, pid 4711\n```\n')
        self.passes('```console\n$ echo "0  body  0   3741"\n0  body  0  121.3\n```\n')
        self.fails('```console\n$ echo "8 of 8 nodes"\n7 of 8 nodes\n```\n', '-7 of 8 nodes')

    def test_three_dots_stand_for_any_lines(self):
        self.passes('```console\n$ seq 4\n1\n...\n4\n```\n')
        self.fails('```console\n$ seq 4\n1\n...\n5\n```\n', '-5')

    def test_a_file_of_the_page_is_there_for_its_commands(self):
        self.passes('<!-- file: a/b.txt -->\n```yaml\nkey: 1\n```\n\n```console\n$ cat a/b.txt\nkey: 1\n```\n')

    def test_a_ring_that_a_page_starts_from_a_file_bears_a_busy_machine(self):
        page = ('<!-- file: arm.yaml -->\n```yaml\nring: arm\nnodes: 2\n```\n```console\n$ ringctl() { cat "$2"; }\n'
                '$ ringctl up arm.yaml\n...\n%s\n```\n')
        self.passes(page % 'timeouts: {silence: 10s}')
        self.fails(page.replace('nodes: 2', 'timeouts:\n  silence: 5ms\nnodes: 2') % 'timeouts: {silence: 10s}', 'silence: 10s')

    def test_a_block_that_is_not_run_needs_a_reason(self):
        self.fails('```\nmake demo\n```\n', 'neither')
        self.passes('<!-- not run: takes long -->\n```\nmake demo\n```\n')


if __name__ == '__main__':
    unittest.main()
