#!/usr/bin/python3
"""Runs what the manual shows, as it stands there, and compares what it prints with what stands below.

usage: run_manual.py --programs FOLDER PAGE [PAGE ...]

All pages run one after the other in one shell, in one empty folder, as a reader would who follows them. In a page

    ```console              commands behind '$ ', each followed by what it prints; a line '...' stands for any lines.
    $ ringctl status        Times, dates, pids, ports and hashes are not compared, nor how wide a table is.
    ```
    <!-- file: NAME -->     the block that follows is saved under that name
    <!-- not run: WHY -->   the block that follows is not run, for that reason

Rings of the manual are live ones, and a busy machine may pause a process for longer than a link may be silent by default.
So each ring that a page starts takes a link that is silent for PATIENCE for a whole one.

Every block is one of these, or `text`, which shows and is not run. Exit code 0: all commands ended with 0 (or with the code
that '[exit code N]' in their last line says) and printed what the page says.
"""
import argparse
import difflib
import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading

LONGEST_S = 300   # of one command
PATIENCE = '10s'
FENCE = re.compile(r'^(`{3,})(.*)$')
NOTE = re.compile(r'^<!-- (file|not run): (.*?) -->$')
EXIT_CODE = re.compile(r'^\[exit code (\d+)\]$')

VARIES = [
    (r'\b\d{4}-\d\d-\d\d[ T]\d\d:\d\d:\d\d(\.\d+)?', 'DATE'),
    (r'\bpid \d+', 'pid N'),
    (r'\bprocess(es)? \d+', 'process N'),
    (r'\bport \d+', 'port N'),
    (r'\b[0-9a-f]{16}\b', 'HASH'),
    (r'(?<![\w.])-?\d+(\.\d+)?( ?)(ns|us|ms|s|min|h)\b', 'TIME'),
    (r'(?<![\w.])\d+\.\d+(?![\w.])', 'X.X'),
    (r'(?<=  )\d{4,}(?=  |$)', 'X.X'),   # a time in a table, of a busy machine
    (r'\s+', ' '),
]


class Wrong(Exception):
    """What a page says is not so."""


class Block:
    def __init__(self, page, line, language, note, lines):
        self.page, self.line, self.language, self.note, self.lines = page, line, language, note, lines

    def where(self, offset=0):
        return '%s:%d' % (self.page, self.line + offset)


def blocks_of(path):
    with open(path, encoding='utf-8') as page:
        lines = page.read().split('\n')
    note, at = None, 0
    while at < len(lines):
        fence, comment = FENCE.match(lines[at]), NOTE.match(lines[at])
        if comment:
            note = comment.groups()
        elif fence:
            end = next((i for i in range(at + 1, len(lines)) if lines[i].rstrip() == fence.group(1)), None)
            if end is None:
                raise Wrong('%s:%d: this block has no end' % (path, at + 1))
            yield Block(path, at + 1, fence.group(2).strip(), note, lines[at + 1:end])
            note, at = None, end
        elif lines[at].strip():
            note = None
        at += 1


def commands_of(block):
    """(line in the block, command, expected lines, expected exit code)"""
    found = []
    for number, line in enumerate(block.lines, 1):
        if line.startswith('$ '):
            found.append([number, line[2:], [], 0])
        elif not found:
            raise Wrong('%s: a line of output without a command' % block.where(number))
        elif line.startswith('> ') and not found[-1][2]:
            found[-1][1] += '\n' + line[2:]
        elif EXIT_CODE.match(line):
            found[-1][3] = int(EXIT_CODE.match(line).group(1))
        else:
            found[-1][2].append(line)
    return found


def is_progress(line):
    """What ringctl says while it waits for long, on a busy machine alone."""
    return line.startswith('ringctl: ') and line.endswith(' ...')


def plain(line):
    for pattern, word in VARIES:
        line = re.sub(pattern, word, line)
    return line.strip()


def fits(expected, seen):
    """Whether the lines seen are the lines expected, of which '...' stands for any."""
    if not expected:
        return not seen
    if expected[0] == '...':
        return any(fits(expected[1:], seen[i:]) for i in range(len(seen) + 1))
    return bool(seen) and expected[0] == seen[0] and fits(expected[1:], seen[1:])


class Shell:
    """One bash, as the reader's terminal."""

    def __init__(self, folder, environment):
        self._file = open(os.path.join(folder, '.output'), 'w+', encoding='utf-8', errors='replace')
        self._bash = subprocess.Popen(['bash', '--norc', '--noprofile'], cwd=os.path.join(folder, 'home'), text=True,
                                      stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._file, env=environment,
                                      start_new_session=True)
        self._bash.stdin.write('exec 3>&1 1>&2\n')

    def run(self, command):
        """@return (exit code, lines printed)"""
        begin = os.path.getsize(self._file.name)
        guard = threading.Timer(LONGEST_S, self._bash.kill)
        guard.start()
        self._bash.stdin.write('%s\necho "END $?" >&3\n' % command)
        self._bash.stdin.flush()
        end = self._bash.stdout.readline()
        guard.cancel()
        if not end.startswith('END '):
            raise Wrong('did not end within %d s, or ended the shell' % LONGEST_S)
        self._file.seek(begin)
        return int(end[4:]), self._file.read().rstrip('\n').split('\n')

    def close(self):
        self._bash.stdin.close()
        try:
            self._bash.wait(30)
        except subprocess.TimeoutExpired:
            self._bash.kill()


def patient(text):
    """The same ring's file with another timeouts.silence; any other text as it is."""
    if not (re.search(r'^ring:', text, re.M) and re.search(r'^nodes:', text, re.M)) or 'silence: ' + PATIENCE in text:
        return text
    text = re.sub(r'^ +silence: .*\n', '', text, flags=re.M)
    if re.search(r'^timeouts: *(#.*)?$', text, re.M):
        return re.sub(r'^(timeouts: *(#.*)?)$', r'\1\n  silence: %s' % PATIENCE, text, count=1, flags=re.M)
    if re.search(r'^timeouts: *\{', text, re.M):
        return re.sub(r'^timeouts: *\{', 'timeouts: {silence: %s, ' % PATIENCE, text, count=1, flags=re.M)
    return text + '\ntimeouts: {silence: %s}\n' % PATIENCE


def save_patient_rings(programs, home):
    """The rings that come with limb_ring, where ringctl looks for them first."""
    ours = os.path.join(home, '.config', 'limb_ring')
    os.makedirs(ours)
    for path in glob.glob(os.path.join(programs, '..', '..', 'share', 'limb_ring', 'config', '*.yaml')):
        with open(path, encoding='utf-8') as ring, open(os.path.join(ours, os.path.basename(path)), 'w', encoding='utf-8') as copy:
            copy.write(patient(ring.read()))


def make_patient_what_starts(home, command):
    """A ring's file of the reader, of which `ringctl up` makes a ring."""
    started = re.match(r'ringctl up (\S+\.yaml)', command)
    path = os.path.join(home, started.group(1)) if started else ''
    if os.path.isfile(path):
        with open(path, 'r+', encoding='utf-8') as file:
            text = patient(file.read())
            file.seek(0)
            file.truncate()
            file.write(text)


def run_command(shell, block, line, command, expected, exit_code):
    code, seen = shell.run(command)
    wanted = [plain(text) for text in expected if text.strip()]
    got = [plain(text) for text in seen if text.strip() and not is_progress(text)]
    if code == exit_code and fits(wanted, got):
        return
    differences = '\n'.join(difflib.unified_diff(wanted, got, 'the page', 'seen', lineterm='', n=1))
    raise Wrong('%s: $ %s\nexit code %d, %d on the page\n%s\nall that was printed:\n%s' %
                (block.where(line), command, code, exit_code, differences, '\n'.join(seen)))


def run_block(shell, home, block):
    """@return what was done, in one word"""
    kind, text = block.note or (None, None)
    if kind == 'not run':
        return 'not run: ' + text
    if kind == 'file':
        path = os.path.join(home, text)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, 'w', encoding='utf-8') as file:
            file.write('\n'.join(block.lines) + '\n')
        return 'saved as ' + text
    if block.language == 'text' or block.language.startswith('{'):   # a directive of Sphinx
        return 'shown'
    if block.language != 'console':
        raise Wrong('%s: this block is neither `console` nor `text`, and has no "file:" or "not run:" above it' %
                    block.where())
    for command in commands_of(block):
        make_patient_what_starts(home, command[1])
        run_command(shell, block, *command)
    return 'run'


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument('--programs', required=True, help='folder with ringctl and the other programs')
    arguments.add_argument('pages', nargs='+')
    options = arguments.parse_args()
    folder = tempfile.mkdtemp(prefix='manual')
    home = os.path.join(folder, 'home')
    runtime = os.path.join(folder, 'run')
    os.mkdir(home)
    save_patient_rings(options.programs, home)
    os.mkdir(runtime, 0o700)
    environment = dict(os.environ, HOME=home, XDG_RUNTIME_DIR=runtime, NO_COLOR='1', COLUMNS='100',
                       PATH=os.path.abspath(options.programs) + ':' + os.environ['PATH'])
    shell = Shell(folder, environment)
    try:
        for page in options.pages:
            for block in blocks_of(page):
                print('%s: %s' % (block.where(), run_block(shell, home, block)), flush=True)
    except Wrong as problem:
        print('run_manual: %s' % problem, file=sys.stderr)
        return 1
    finally:
        try:
            shell.run('ringctl down --all > /dev/null 2>&1')
        except (Wrong, OSError):
            pass
        shell.close()
        shutil.rmtree(folder, ignore_errors=True)
    return 0


if __name__ == '__main__':
    sys.exit(main())
