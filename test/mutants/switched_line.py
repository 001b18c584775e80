"""One line of C++ that does what it did, or what a mutant of it does: by a number when the program runs.

So that many mutants are compiled at once. Only lines of a few plain forms can be written so; whether the compiler takes
it, it says."""
import re

FUNCTION = re.compile(r'^(.*\) (?:const )?(?:noexcept )?(?:override )?\{ )(.*;)( \})$')
WORD = re.compile(r'(?<![\w.\'"])(\d+|true|false)(?![\w.\'"])')
VALUE = re.compile(r'^(\s*(?:const |static )*[\w:<>*&, ]+ \w+ = )([^{}]*)(;)$')
NO_STATEMENT = re.compile(r'^\s*(case\b|default\b|else\b|\}|break;|continue;|public:|private:|using\b|static_assert|for \(|while \(|if \(|'
                          r'switch\b|template\b|constexpr\b|static constexpr\b|const\b|auto\b|static\b)')


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


def switched(old, new, number):
    """@param old, new lines without their comments. @return one for both, or None where it has another form"""
    mark = 'limb_ring::mutant == %d' % number
    in_place = word_in_place(old, new, mark)
    if in_place:
        return None if 'constexpr' in old else in_place
    if not balanced(old.replace('} else', '', 1)) and condition_of(old) is None:
        return None
    before, after = condition_of(old), condition_of(new)
    if before and after and old[:before[0]] == new[:after[0]] and old[before[1]:] == new[after[1]:]:
        inside = old[slice(*before)] + new[slice(*after)]
        if ';' in inside or re.search(r'\b(auto|const) |[^=!<>]=[^=]', inside):
            return None
        return either(old[:before[0]], mark, new[slice(*after)], old[slice(*before)], old[before[1]:])
    for form in (FUNCTION, VALUE):
        a, b = form.match(old), form.match(new)
        if not a or not b or a.group(1) != b.group(1):
            continue
        if form is VALUE and 'constexpr' not in old:
            return either(a.group(1), mark, b.group(2), a.group(2), ';')
        if form is FUNCTION and 'constexpr' not in old:
            return '%sif (%s) { %s } else { %s }%s' % (a.group(1), mark, b.group(2), a.group(2), a.group(3))
    if not balanced(old) or not old.endswith(';') or '{' in old and 'return {' not in old:
        return None
    if NO_STATEMENT.match(old) and not old.lstrip().startswith(('if (', 'while (')):
        return None
    return '{ if (%s) { %s } else { %s } }' % (mark, new.strip(), old.strip())
