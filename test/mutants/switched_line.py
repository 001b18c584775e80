"""One line of C++ and its mutants: a number chooses at run time which of them runs.

So that many mutants are compiled at once. Only lines of a few plain forms can be written so; whether the compiler takes
it, it says."""
import re

FUNCTION = re.compile(r'^(.*\) (?:const )?(?:noexcept )?(?:override )?\{ )(.*;)( \})$')
WORD = re.compile(r'(?<![\w.\'"])(\d+|true|false)(?![\w.\'"])')
VALUE = re.compile(r'^(\s*(?:const |static )*[\w:<>*&, ]+ \w+ = )([^{}]*)(;)$')
CONSTANT = re.compile(r'^(\s*)(static )?constexpr (?=[\w:<>]+ k\w+ = )')
NO_STATEMENT = re.compile(r'^\s*(case\b|default\b|else\b|\}|break;|continue;|public:|private:|using\b|static_assert|for \(|while \(|if \(|'
                          r'switch\b|template\b|constexpr\b|static constexpr\b|const\b|auto\b|static\b)')
CALL_OR_ASSIGNMENT = re.compile(r'^\s+[\w.\->\[\]]+(\(.*\)| = .*);$')
# What an expression that is part of another may begin behind, and end before.
BEGINS = re.compile(r'(?:[(,;?:]|&&|\|\||\breturn|(?<![=!<>+\-*/|&^])=(?!=))\s*$')
ENDS = re.compile(r'\s*(?:[),;?:]|&&|\|\|)')


def balanced(text):
    depth = 0
    for letter in text:
        depth += letter in '([{'
        depth -= letter in ')]}'
        if depth < 0:
            return False
    return depth == 0


def condition_of(code):
    """Where the condition of an if or while lies, that begins and ends in this line; None where there is none."""
    begin = re.match(r'^\s*(?:\} else )?(?:else )?(?:if|while) \(', code)
    if not begin:
        return None
    depth = 1
    for at in range(begin.end(), len(code)):
        depth += code[at] == '('
        depth -= code[at] == ')'
        if depth == 0:
            return begin.end(), at
    return None


def either(prefix, mark, new, old, suffix):
    return '%s(%s ? (%s) : (%s))%s' % (prefix, mark, new, old, suffix)


def word_in_place(old, new, mark):
    """Where one number, true or false becomes another one: an expression in its place."""
    first = next(at for at in range(len(old) + 1) if old[at:at + 1] != new[at:at + 1])
    for a in WORD.finditer(old):
        b = WORD.match(new, a.start())
        if b and a.start() <= first <= a.end() and old[:a.start()] + b.group() + old[a.end():] == new:
            value = '(%s ? %s : %s)' % (mark, b.group(), a.group())
            if old[:a.start()].endswith('{') and a.group().isdigit():
                value = 'static_cast<std::uint8_t>' + value  # braces do not narrow
            return old[:a.start()] + value + old[a.end():]
    return None


def part_in_place(old, new, mark):
    """Where a part of an expression becomes another one, in a line that may hold only a piece of a statement."""
    first = next(at for at in range(len(old) + 1) if old[at:at + 1] != new[at:at + 1])
    same = 0
    while old[len(old) - 1 - same] == new[len(new) - 1 - same] and same < min(len(old), len(new)) - first:
        same += 1
    logical = re.search(r'&&|\|\|', old[max(0, first - 1):len(old) - same + 1])
    for begin in range(first, 0, -1):
        opening = BEGINS.search(old[:begin])
        if not opening or old[begin] == ' ' or logical and opening.group().strip() in ('&&', '||'):
            continue
        for end in range(max(len(old) - same, begin), len(old)):
            closing = ENDS.match(old[end:])
            if not closing or logical and closing.group().strip() in ('&&', '||'):
                continue
            a, b = old[begin:end], new[begin:len(new) - (len(old) - end)]
            if a.strip() and b.strip() and balanced(a) and balanced(b) and not re.search(r'[?:;{}]|\bauto\b', a.replace('::', '')):
                return either(old[:begin], mark, b, a, old[end:])
    return None


def switched(old, new, number):
    """@param old, new lines without their comments. @return one for both, or None where it has another form"""
    mark = 'limb_ring::mutant == %d' % number
    in_place = word_in_place(old, new, mark)
    if in_place and 'constexpr' in old:
        in_place = CONSTANT.sub(lambda m: '%s%sinline const ' % (m.group(1), m.group(2) or ''), in_place)
        return None if 'constexpr' in in_place else in_place
    if in_place:
        return in_place
    whole = whole_in_place(old, new, mark)
    return whole or ('constexpr' not in old and not re.match(r'\s*if \(.*\bauto\b', old) and part_in_place(old, new, mark)) or None


def whole_in_place(old, new, mark):
    """A condition, value, function or statement, all in this line."""
    if not balanced(old.replace('} else', '', 1)) and condition_of(old) is None:
        return None
    before, after = condition_of(old), condition_of(new)
    if before and after and old[:before[0]] == new[:after[0]] and old[before[1]:] == new[after[1]:]:
        inside = old[slice(*before)] + new[slice(*after)]
        if ';' in inside or re.search(r'\b(auto|const) |[^=!<>]=[^=]', inside):
            return None
        return either(old[:before[0]], mark, 'bool(%s)' % new[slice(*after)], 'bool(%s)' % old[slice(*before)],
                      old[before[1]:])
    for form in (FUNCTION, VALUE):
        a, b = form.match(old), form.match(new)
        if not a or not b or a.group(1) != b.group(1):
            continue
        if form is VALUE and 'constexpr' not in old:
            return either(a.group(1), mark, b.group(2), a.group(2), ';')
        if form is FUNCTION and 'constexpr' not in old:
            return '%sif (%s) { %s } else { %s }%s' % (a.group(1), mark, b.group(2), a.group(2), a.group(3))
    if not balanced(old) or not old.endswith(';') or \
            '{' in old and 'return {' not in old and not CALL_OR_ASSIGNMENT.match(old):
        return None
    if NO_STATEMENT.match(old) and not old.lstrip().startswith(('if (', 'while (')):
        return None
    return '{ if (%s) { %s } else { %s } }' % (mark, new.strip(), old.strip())
