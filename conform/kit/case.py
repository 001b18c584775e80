"""The table of cases."""

import collections

# number: SECTION-N. profile: minimal, or full for what a minimal node may leave out. line: udp, or None for any. start:
# the node has to be started for it.
Case = collections.namedtuple('Case', 'number section title sent expected by profile line start act')
CASES = []


def case(section, title, sent, expected, by='1 s', profile='minimal', line=None, start=False):
    """Decorator of a function that takes the Play."""
    def add(act):
        number = '%s-%d' % (section, 1 + sum(one.section == section for one in CASES))
        CASES.append(Case(number, section, title, sent, expected, by, profile, line, start, act))
        return act
    return add


def sections_first(number):
    """For sorting: 4.10-2 behind 4.9-1."""
    section, count = number.split('-')
    return [int(part) for part in section.split('.')] + [int(count)]


def chosen(only):
    """@param only section numbers or case numbers; empty: all"""
    fits = lambda one, word: one.number == word or one.section == word or one.section.startswith(word + '.')
    return sorted((one for one in CASES if not only or any(fits(one, word) for word in only)),
                  key=lambda one: sections_first(one.number))
