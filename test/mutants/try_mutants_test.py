#!/usr/bin/env python3
"""What try_mutants may change, and that a seed says which."""
import importlib.machinery
import importlib.util
import pathlib
import unittest


def load():
    path = pathlib.Path(__file__).with_name('try_mutants')
    loader = importlib.machinery.SourceFileLoader('try_mutants', str(path))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader('try_mutants', loader))
    loader.exec_module(module)
    return module


class TryMutants(unittest.TestCase):
    def setUp(self):
        self.module = load()

    def test_a_seed_says_which(self):
        first, again, other = (self.module.all_mutants(seed) for seed in (7, 7, 8))
        self.assertEqual(first, again)
        self.assertNotEqual(first[:50], other[:50])
        self.assertEqual(sorted(first), sorted(other))

    def test_each_changes_the_code_of_one_line(self):
        for name, number, old, new in self.module.all_mutants(1):
            lines = (self.module.SOURCES / name).read_text(encoding='utf-8').splitlines()
            self.assertEqual(lines[number - 1], old)
            self.assertNotEqual(old.split('//')[0].rstrip(), new)

    def test_every_kind_is_among_them(self):
        changes = [(old.strip(), new.strip()) for _, _, old, new in self.module.all_mutants(1)]
        self.assertTrue(any(new == '(void)0;' for _, new in changes))
        self.assertTrue(any('if (!(' in new and 'if (!(' not in old for old, new in changes))
        self.assertTrue(any(old.count('&&') > new.count('&&') for old, new in changes))
        self.assertTrue(any('= 3;' in old and '= 4;' in new for old, new in changes))

    def test_declarations_and_returns_are_not_removed(self):
        for _, _, old, new in self.module.all_mutants(1):
            if new.strip() == '(void)0;':
                self.assertNotRegex(old.strip(), r'^(return|using|const |static )')


if __name__ == '__main__':
    unittest.main()
