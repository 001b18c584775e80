#!/usr/bin/python3
"""Writes the pages of docs/reference that programs, launch files and docstrings know better.

usage: generate_reference.py --programs FOLDER [--check]
  --programs  folder with the programs; the Python package must be found by PYTHONPATH
  --check     writes nothing; ends with 1 where a page is not what would be written
"""
import argparse
import inspect
import os
import re
import subprocess
import sys
import textwrap
import xml.etree.ElementTree as xml

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(HERE)
WRITTEN = '<!-- Written by docs/generate_reference.py; do not edit by hand. -->\n\n'
PROGRAMS = ('ringctl', 'ring_sim', 'compare_networks', 'ringd', 'limb_firmware')


def output_of(*words):
    environment = dict(os.environ, COLUMNS='80', NO_COLOR='1')
    return subprocess.run(words, stdout=subprocess.PIPE, text=True, check=True, timeout=30, env=environment).stdout.rstrip()


def block(text):
    return '```text\n%s\n```\n\n' % text


def subcommands_in(text):
    """What `complete` offers as first words: the subcommands, without options and `help`."""
    return [word for word in text.split() if re.fullmatch(r'[a-z][a-z-]*', word) and word != 'help']


def subcommands_of(program, words, level):
    """The help of each subcommand, and of theirs. Each fault's is left out: all are alike, and faults.md has them."""
    page = ''
    for subcommand in subcommands_in(output_of(program, 'complete', *words[1:], '')):
        text = output_of(program, *words[1:], subcommand, '--help')
        page += '%s %s %s\n\n%s' % ('#' * level, ' '.join(words), subcommand, block(text))
        if 'SUBCOMMAND' in text and subcommand != 'fault':
            page += subcommands_of(program, [*words, subcommand], level + 1)
    return page


def commands_page(programs):
    page = '# Commands\n\n' + WRITTEN + 'Every program prints this with `--help`, and each subcommand, too.\n\n'
    for name in PROGRAMS:
        program = os.path.join(programs, name)
        page += '## %s\n\n%s' % (name, block(output_of(program, '--help')))
        page += subcommands_of(program, [name], 3) if name in ('ringctl', 'ring_sim') else ''
    return page.rstrip() + '\n'


def cell(text):
    return ' '.join(text.split()).replace('|', '\\|').replace('<', '&lt;')


def launch_page():
    page = '# Launch files\n\n' + WRITTEN + '`roslaunch --ros-args limb_ring FILE` prints the same.\n\n'
    folder = os.path.join(ROOT, 'launch')
    for name in sorted(os.listdir(folder)):
        arguments = [arg for arg in xml.parse(os.path.join(folder, name)).getroot().findall('arg')
                     if arg.get('value') is None]
        page += '## %s\n\n' % name
        if not arguments:
            page += 'It takes no arguments.\n\n'
            continue
        page += '| argument | default | meaning |\n|---|---|---|\n'
        for arg in arguments:
            default = '`%s`' % cell(arg.get('default')) if arg.get('default') else 'required' if arg.get('default') is None else 'empty'
            page += '| `%s` | %s | %s |\n' % (arg.get('name'), default, cell(arg.get('doc', '')))
        page += '\n'
    return page.rstrip() + '\n'


def status_page(programs):
    return ('# A node\'s status row\n\n' + WRITTEN +
            '`ringctl status --json` prints a row of each node, and a daemon answers one to the request `status`\n'
            '([requests.md](requests.md)). `ringctl status --fields` prints this table. "or null", "or left out": where there\n'
            'is no value; who reads a row takes both for the same.\n\n'
            '| member | is | always there | meaning |\n|---|---|---|---|\n' +
            output_of(os.path.join(programs, 'ringctl'), 'status', '--fields') + '\n')


def rows_of(text):
    """Cells of the table in a section, without its heading."""
    lines = [line for line in text.splitlines() if line.startswith('| ')]
    return [[part.strip() for part in line.strip('|').split(' | ')] for line in lines[1:]]


def source(*path):
    with open(os.path.join(ROOT, *path), encoding='utf-8') as file:
        return file.read()


# The parts of protocol.md section 10: who counts, and what stands before the names in ringctl status.
COUNTERS_OF = (('10.1', 'controller', ''), ('10.2', 'input', 'input_'), ('10.3', 'output', 'output_'),
               ('10.4', 'faults', ''), ('10.5', 'host port', ''))


def counters_page():
    """One table out of two, which tests hold against the code: protocol.md section 10, and that of the bridge."""
    errors = re.findall(r'\{Of::\w+, "(\w+)", true\}', source('daemon', 'ring', 'status_rows.cpp'))
    specification = source('docs', 'protocol.md')
    page = ('# Counters\n\n' + WRITTEN +
            'Whatever is discarded is counted under a name. `ringctl status --json` shows the counters of each node that are\n'
            'not zero, with `--all` all of them, and the topic `ring_status` has them, too. They count from the start of the\n'
            'node\'s daemon, and those of `ring_bridge` from its own start. One that is **bold** counts damaged or lost packets:\n'
            '`ringctl status --watch` adds these up as `errors`. Numbers in brackets are sections of [protocol.md](../protocol.md).\n'
            'If the ring folds back, the second line has all names of `input` and `output` again, with `second_` before them.\n\n'
            '| counter | of | one count means |\n|---|---|---|\n')
    for section, who, prefix in COUNTERS_OF:
        for name, meaning in rows_of(re.search(r'\n### %s .*?(?=\n##)' % re.escape(section), specification, re.S).group()):
            name = prefix + name.strip('`')
            page += '| %s | %s | %s |\n' % ('**`%s`**' % name if name in errors else '`%s`' % name, who, meaning)
    bridge = re.search(r'\n## Counters of the bridge\n.*?(?=\n## |$)', source('docs', 'reference', 'ros.md'), re.S).group()
    return page + ''.join('| %s | `ring_bridge` | %s |\n' % (names, meaning) for names, meaning in rows_of(bridge))


def signature_of(thing):
    try:
        return re.sub(r'<object object at 0x[0-9a-f]+>', '...', str(inspect.signature(thing)))  # its address is another each time
    except (TypeError, ValueError):
        return ''


def prose(words):
    """A docstring as Markdown: paragraphs, what is indented as code, @param and @raise as a list."""
    text = ''
    for paragraph in words.split('\n\n'):
        if all(line.startswith('    ') for line in paragraph.splitlines()):
            text += '```python\n%s\n```\n\n' % textwrap.dedent(paragraph)
            continue
        first, *tags = re.split(r'\s*@(?=param |raise )', ' '.join(paragraph.split()).replace('*', '\\*').replace('<', '\\<'))
        text += first + '\n\n' if first else ''
        tags = [re.sub(r'^param (\S+)', r'`\1`:', tag) for tag in tags]
        text += ''.join('- %s\n' % re.sub('^raise ', 'raises ', tag) for tag in tags) + ('\n' if tags else '')
    return text


def words_of(thing):
    """Its own docstring, and of a bound function the signature before it."""
    words = inspect.cleandoc(vars(thing).get('__doc__') or '') if inspect.isclass(thing) else inspect.getdoc(thing) or ''
    signature = re.match(r'\w+(\(.*\)) -> (.*)(\n|$)', words)
    if not signature:
        return words, None
    arguments = re.sub(r'self: [\w.]+(, )?', '', signature.group(1))
    return words[signature.end():].strip(), re.sub(r'limb_ring\._client\.', '', '%s -> %s' % (arguments, signature.group(2)))


def described(name, thing, level):
    """A heading and the docstring of a class, of its public members, or of a function. Properties are a list."""
    if not callable(thing):
        return ''
    words, signature = words_of(thing)
    text = '%s `%s`\n\n' % ('#' * level, name + (signature or signature_of(thing))) + (prose(words) if words else '')
    if not inspect.isclass(thing):
        return text
    members = [(member, getattr(thing, member)) for member, value in sorted(vars(thing).items())
               if not member.startswith('_') and (inspect.getdoc(value) or isinstance(value, property))]
    properties = ['- `%s`%s\n' % (member, ': ' + prose(inspect.getdoc(value)).strip() if inspect.getdoc(value) else '')
                  for member, value in members if isinstance(value, property)]
    text += ''.join(properties) + ('\n' if properties else '')
    return text + ''.join(described('%s.%s' % (thing.__name__, member), value, level + 1) for member, value in members)


def python_page():
    import limb_ring
    page = '# Python\n\n' + WRITTEN + prose(inspect.getdoc(limb_ring))
    for name in sorted(limb_ring.__all__):
        page += described(name, getattr(limb_ring, name), 2)
    return page.rstrip() + '\n'


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument('--programs', required=True)
    arguments.add_argument('--check', action='store_true')
    options = arguments.parse_args()
    pages = {'commands.md': commands_page(options.programs), 'launch.md': launch_page(), 'python.md': python_page(),
             'status.md': status_page(options.programs), 'counters.md': counters_page()}
    stale = []
    for name, text in pages.items():
        path = os.path.join(HERE, 'reference', name)
        if options.check:
            old = open(path, encoding='utf-8').read() if os.path.exists(path) else ''
            stale += [name] if old != text else []
        else:
            with open(path, 'w', encoding='utf-8') as page:
                page.write(text)
    if stale:
        print('docs/reference: %s not as the programs say it now; `make docs` writes it' % ', '.join(stale), file=sys.stderr)
    return 1 if stale else 0


if __name__ == '__main__':
    sys.exit(main())
