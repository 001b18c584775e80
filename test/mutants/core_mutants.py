"""The changes that try_mutants may make in the core, and those of them that no test can notice."""
import collections
import hashlib
import pathlib
import re

SOURCES = pathlib.Path(__file__).resolve().parents[2]
PARTS = ('daemon/core', 'daemon/wire')
EQUIVALENT = pathlib.Path(__file__).resolve().with_name('equivalent.txt')
SWAPS = (('comparison', (('==', '!='), ('!=', '=='), ('<=', '<'), ('>=', '>'), (' < ', ' <= '), (' > ', ' >= '))),
         ('and, or', (('&&', '||'), ('||', '&&'))),
         ('plus, minus', ((' + ', ' - '), (' - ', ' + '), ('++', '--'))),
         ('true, false', (('true', 'false'), ('false', 'true'))))
STATEMENT = re.compile(r'^\s+(?!return|using|break|case|default|static|const|else|do|if|for|while|switch|template|friend|#|//)'
                       r'[\w\->.:\[\]()*+]+(\s*(=|\+=|-=|\|=|&=)\s*.*|\(.*\)|\+\+|--)?;$')
NUMBER = re.compile(r'(?<![\w.\'"])(\d+)(?![\w.\'"])')


def mutants_of(path):
    """All changes to one file, as (line from 1, line before, line after, kind of change)."""
    for number, line in enumerate((SOURCES / path).read_text(encoding='utf-8').splitlines(), 1):
        code = line.split('//')[0].rstrip()
        if not code.strip() or code.lstrip().startswith(('#', '*', '/*')):
            continue
        changed = {}  # to their kinds
        texts = [m.span() for m in re.finditer(r'"[^"]*"', code)]

        def is_code(at):
            return not any(first <= at < last for first, last in texts)
        for kind, swaps in SWAPS:
            for old, new in swaps:
                for at in (m.start() for m in re.finditer(re.escape(old), code) if is_code(m.start())):
                    changed[code[:at] + new + code[at + len(old):]] = kind
        condition = re.search(r'\bif \((.*)\)( |$)', code)
        if condition and condition.group(1).count('(') == condition.group(1).count(')') and ';' not in condition.group(1):
            changed[code[:condition.start(1)] + '!(' + condition.group(1) + ')' + code[condition.end(1):]] = 'condition'
        for m in filter(lambda m: is_code(m.start()), NUMBER.finditer(code)):
            changed[code[:m.start()] + str(int(m.group()) + 1) + code[m.end():]] = 'number'
        if STATEMENT.match(code):
            changed[re.match(r'\s+', code).group() + '(void)0;'] = 'statement'
        for new in sorted(changed.keys() - {code}):
            yield number, line, new, changed[new]


class Mutant:
    """A change of one line. Its name stays the same however the lines around it move."""

    def __init__(self, file, line, old, new, kind, place):
        self.file, self.line, self.old, self.new, self.kind = file, line, old, new, kind
        # Where a file has the same line several times, those behind the first are called by their number.
        self.name = (file if place == 1 else '%s %d' % (file, place), old.strip(), new.strip())

    def __str__(self):
        return '%s:%d: %s -> %s' % (self.file, self.line, self.old.strip(), self.new.strip())


def all_mutants(seed):
    """In an order that the seed says, and that stays the same for the others where one line of the core is changed."""
    found = []
    met = collections.Counter()
    for part in PARTS:
        for path in sorted((SOURCES / part).rglob('*')):
            if path.suffix not in ('.h', '.cpp') or 'namespace limb_ring::capture ' in path.read_text(encoding='utf-8'):
                continue  # captures are for tools
            file = path.relative_to(SOURCES).as_posix()
            for line, old, new, kind in mutants_of(file):
                met[file, old.strip(), new.strip()] += 1
                found.append(Mutant(file, line, old, new, kind, met[file, old.strip(), new.strip()]))
    return sorted(found, key=lambda m: hashlib.sha256(repr((seed, m.name)).encode()).digest())


def equivalents(path, mutants):
    """The names in an equivalent.txt: paragraphs of a file, '- old line', '+ new line', and why. Comments at the end of a
    line do not matter.

    @raise ValueError what is wrong with it"""
    def code(name):
        return name[0], name[1].split('//')[0].strip(), name[2]
    possible = collections.defaultdict(set)
    for mutant in mutants:
        possible[code(mutant.name)].add(mutant.name)
    found = set()
    text = ''.join(line for line in path.read_text(encoding='utf-8').splitlines(keepends=True) if not line.startswith('#'))
    for paragraph in filter(None, (part.strip() for part in text.split('\n\n'))):
        lines = [line.strip() for line in paragraph.split('\n')]
        if len(lines) < 4 or not lines[1].startswith('- ') or not lines[2].startswith('+ '):
            raise ValueError('%s: should be a file, "- old line", "+ new line" and why it is equivalent:\n%s'
                             % (path, paragraph))
        entry = code((lines[0], lines[1][2:], lines[2][2:].strip()))
        if entry not in possible:
            raise ValueError('%s: no such change of the sources is possible any more; remove or mend:\n%s' % (path, paragraph))
        found |= possible[entry]
    return found
