#!/usr/bin/env python3
"""What try_mutants may change, and that a seed says which."""
import importlib.machinery
import importlib.util
import pathlib
import tempfile
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
        first, again, other = ([m.name for m in self.module.all_mutants(seed)] for seed in (7, 7, 8))
        self.assertEqual(first, again)
        self.assertNotEqual(first[:50], other[:50])
        self.assertEqual(sorted(first), sorted(other))

    def test_each_changes_the_code_of_one_line(self):
        for mutant in self.module.all_mutants(1):
            lines = (self.module.SOURCES / mutant.file).read_text(encoding='utf-8').splitlines()
            self.assertEqual(lines[mutant.line - 1], mutant.old)
            self.assertNotEqual(mutant.old.split('//')[0].rstrip(), mutant.new)

    def test_no_two_have_the_same_name(self):
        names = [mutant.name for mutant in self.module.all_mutants(1)]
        self.assertEqual(len(names), len(set(names)))

    def test_those_that_are_equivalent_are_still_there(self):
        self.module.equivalents(self.module.EQUIVALENT, self.module.all_mutants(1))

    def equivalents_in(self, text):
        with tempfile.NamedTemporaryFile('w', suffix='.txt') as file:
            file.write(text)
            file.flush()
            return self.module.equivalents(pathlib.Path(file.name), self.module.all_mutants(1))

    def test_an_equivalent_one_is_a_paragraph(self):
        name = self.module.all_mutants(1)[0].name
        paragraph = '%s\n- %s\n+ %s\nNobody asks.\n' % name
        self.assertEqual(self.equivalents_in('# a comment\n\n' + paragraph), {name})

    def test_an_equivalent_one_that_is_gone_is_an_error(self):
        with self.assertRaisesRegex(ValueError, 'no such change'):
            self.equivalents_in('daemon/core/blocks.cpp\n- a == b;\n+ a != b;\nNobody asks.\n')

    def test_an_equivalent_one_without_a_reason_is_an_error(self):
        with self.assertRaisesRegex(ValueError, 'why it is equivalent'):
            self.equivalents_in('%s\n- %s\n+ %s\n' % self.module.all_mutants(1)[0].name)

    def test_every_kind_is_among_them(self):
        changes = [(m.old.strip(), m.new.strip()) for m in self.module.all_mutants(1)]
        self.assertTrue(any(new == '(void)0;' for _, new in changes))
        self.assertTrue(any('if (!(' in new and 'if (!(' not in old for old, new in changes))
        self.assertTrue(any(old.count('&&') > new.count('&&') for old, new in changes))
        self.assertTrue(any('= 3;' in old and '= 4;' in new for old, new in changes))

    def test_declarations_and_returns_are_not_removed(self):
        for mutant in self.module.all_mutants(1):
            if mutant.new.strip() == '(void)0;':
                self.assertNotRegex(mutant.old.strip(), r'^(return|using|const |static )')


if __name__ == '__main__':
    unittest.main()
