#!/usr/bin/python3
"""Writes the pages of docs/reference that programs, launch files and docstrings know better, and all that tells of the
fields of control messages as daemon/wire/control_message.h lists them: tables of docs/protocol.md, the dissector, sizes.

usage: generate_reference.py --programs FOLDER [--check]
  --programs  folder with the programs; the Python package must be found by PYTHONPATH
  --check     writes nothing; ends with 1 where a page is not what would be written
"""
import argparse
import collections
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
    errors = re.findall(r'\{Of::\w+, "(\w+)", true\}', source('daemon', 'ring', 'ring_client.cpp'))
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


# ---- control messages -----------------------------------------------------------------------------

MESSAGES = os.path.join('daemon', 'wire', 'control_message.h')
SIZES = {'std::uint8_t': 1, 'std::uint16_t': 2, 'std::uint32_t': 4, 'std::uint64_t': 8, 'bool': 1, 'NodeId': 1,
         'CpuState': 1, 'LinkState': 1, 'FoldWordKind': 1}
TYPES = {'hello': 1, 'beacon': 2}
Field = collections.namedtuple('Field', 'at size type name title value')


def read(path):
    with open(os.path.join(ROOT, path), encoding='utf-8') as file:
        return file.read()


def columns(row):
    """What stands between the commas of a row, texts joined and without quotes."""
    cells = re.findall(r'\s*(?:"[^"]*"\s*)+|[^,]+', row)
    return [''.join(re.findall(r'"([^"]*)"', cell)) if '"' in cell else cell.strip() for cell in cells if cell.strip()]


def fields_of(name, at=0, prefix=''):
    """The fields of a list of MESSAGES, those of a struct in it one by one. @param at: offset of the first"""
    lines = re.search(r'#define LIMB_RING_%s\(X\)((?:[^\n]*\\\n)*[^\n]*)\n' % name, read(MESSAGES)).group(1)
    fields = []
    for row in re.split(r'\bX\(', lines.replace('\\\n', ' '))[1:]:
        kind, member, _, title, value, *_ = columns(row.strip()[:-1]) + ['', '']
        if kind in SIZES:
            fields.append(Field(at, SIZES[kind], kind, prefix + member, title, value))
        else:
            fields += fields_of(re.sub(r'(?<=[a-z])(?=[A-Z])', '_', kind).upper(), at, prefix + member + '_')
        at = fields[-1].at + fields[-1].size
    return fields


def end_of(fields):
    return fields[-1].at + fields[-1].size


def messages():
    """Per control message, its parts: all but the first are there if they say something."""
    hello, beacon = fields_of('HELLO', 1), fields_of('BEACON', 1)
    return {'hello': [hello], 'beacon': [beacon, fields_of('BEACON_LATCHED', end_of(beacon))]}


def field_table(fields, kind=None):
    rows = ['| 0 | 1 | type | %d |' % kind] if kind else []
    rows += ['| %d | %d | %s | %s |' % (one.at, one.size, one.title, one.value) for one in fields]
    return '\n| offset | bytes | field | value |\n|---|---|---|---|\n' + '\n'.join(rows) + '\n\n'


def states_of(name):
    body = re.search(r'enum class %s[^{;]*\{(.*?)\}' % name, read(MESSAGES), re.DOTALL).group(1)
    return re.findall(r'\w+', re.sub(r'//.*', '', body))


def snake(name):
    return re.sub(r'(?<=[a-z])(?=[A-Z])', '_', name).lower() + 's'


def filter_of(message, field):
    """The name of a field in the dissector, without its unit. What all messages have belongs to none of them."""
    name = re.sub(r'_[mn]s$', '', field.name)
    return name if name == 'boot' else message + '.' + name


def dissected(message, field):
    unit = re.search(r'_([mn]s)$', field.name)
    unit = ' (node)' if field.type == 'NodeId' else ' (%s)' % unit.group(1) if unit else ''
    kind = {'std::uint16_t': 'uint16', 'std::uint32_t': 'uint32', 'std::uint64_t': 'uint64', 'bool': 'bool'}.get(field.type, 'uint8')
    words = ', base.DEC, %s' % snake(field.type) if field.type.endswith('State') else ''
    label = field.title[0].upper() + field.title[1:] + unit
    return 'field("%s", ProtoField.%s, "%s"%s)\n' % (filter_of(message, field), kind, label, words)


def dissector_part():
    text = ''.join('local %s = {[0] = %s}\n' % (snake(name), ', '.join('"%s"' % state for state in states_of(name)))
                   for name in ('CpuState', 'LinkState'))
    text += 'local control_types = {%s}\n' % ', '.join('[%d] = "%s"' % (TYPES[name], name) for name in TYPES)
    text += 'field("control", ProtoField.uint8, "Control message", base.DEC, control_types)\n'
    lists = sizes = ''
    declared = []
    for name, parts in messages().items():
        all_fields = sum(parts, [])
        declared += [line for line in (dissected(name, one) for one in all_fields) if line not in declared]
        lists += '  [%d] = {\n%s  },\n' % (TYPES[name], ''.join(
            '    {"%s", %d},\n' % (filter_of(name, one), one.size) for one in all_fields))
        sizes += '%s[%d] = {%s}' % (', ' if sizes else '', TYPES[name],
                                    ', '.join('[%d] = true' % end_of(part) for part in parts))
    return '%slocal control_fields = {\n%s}\nlocal control_sizes = {%s}\n' % (text + ''.join(declared), lists, sizes)


def told_parts():
    """Per file and name of the part in it, what stands there."""
    parts, fold = messages(), fields_of('FOLD_WORD')
    (hello,), (short, latched) = parts['hello'], parts['beacon']
    page = os.path.join('docs', 'protocol.md')
    return {(page, 'hello'): field_table(hello, TYPES['hello']),
            (page, 'beacon'): field_table(short, TYPES['beacon']),
            (page, 'beacon, latched'): field_table(latched),
            (page, 'fold word'): field_table(fold + fields_of('FOLD_CHECK', end_of(fold))),
            (os.path.join('wireshark', 'limb_ring.lua'), 'control messages'): dissector_part(),
            (os.path.join('tiny_node', 'src', 'tiny_node.c'), 'sizes'):
                '  HELLO_SIZE = %d,\n  BEACON_SIZE = %d,\n  BEACON_WITH_LATCH = %d,\n' % tuple(
                    map(end_of, (hello, short, latched))),
            (os.path.join('conform', 'kit', 'wire.py'), 'sizes'):
                'HELLO_SIZE, BEACON_SIZES = %d, (%d, %d)\n' % tuple(map(end_of, (hello, short, latched)))}


def with_part(text, name, part):
    """The text with what stands between '(name), written by docs/generate_reference.py' and 'end of it' replaced."""
    between = re.compile(r'(\(%s\), written by docs/generate_reference\.py[^\n]*\n)(.*?)([^\n]*end of it\b)' % name, re.DOTALL)
    if not between.search(text):
        raise ValueError('"(%s), written by docs/generate_reference.py" and "end of it" are not there' % name)
    return between.sub(lambda found: found.group(1) + part + found.group(3), text)


def told_files():
    """Files of which a part is written, as they should be."""
    texts = {}
    for (path, name), part in told_parts().items():
        texts[path] = with_part(texts.get(path) or read(path), name, part)
    return texts


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument('--programs', required=True)
    arguments.add_argument('--check', action='store_true')
    options = arguments.parse_args()
    pages = {'commands.md': commands_page(options.programs), 'launch.md': launch_page(), 'python.md': python_page(),
             'status.md': status_page(options.programs), 'counters.md': counters_page()}
    files = {os.path.join('docs', 'reference', name): text for name, text in pages.items()}
    files.update(told_files())
    stale = []
    for name, text in files.items():
        path = os.path.join(ROOT, name)
        if options.check:
            old = open(path, encoding='utf-8').read() if os.path.exists(path) else ''
            stale += [name] if old != text else []
        else:
            with open(path, 'w', encoding='utf-8') as page:
                page.write(text)
    if stale:
        print('%s: not as the programs and sources say it now; `make docs` writes it' % ', '.join(stale), file=sys.stderr)
    return 1 if stale else 0


if __name__ == '__main__':
    sys.exit(main())
