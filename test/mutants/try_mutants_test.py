#!/usr/bin/env python3
"""What try_mutants may change, and that a seed says which."""
import pathlib
import re
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
import core_mutants
from source_copy import SOURCES, folder_of_copies
from switched_line import switched


class TryMutants(unittest.TestCase):
    module = core_mutants

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

    def test_a_comment_behind_an_equivalent_one_does_not_matter(self):
        name = next(m.name for m in self.module.all_mutants(1) if '//' in m.name[1])
        paragraph = '%s\n- %s  // as it was before\n+ %s\nNobody asks.\n' % (name[0], name[1].split('//')[0], name[2])
        self.assertIn(name, self.equivalents_in(paragraph))

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
        kinds = {m.kind for m in self.module.all_mutants(1)}
        self.assertEqual(kinds, {'comparison', 'and, or', 'plus, minus', 'true, false', 'condition', 'number', 'statement'})

    def test_declarations_and_returns_are_not_removed(self):
        for mutant in self.module.all_mutants(1):
            if mutant.new.strip() == '(void)0;':
                self.assertNotRegex(mutant.old.strip(), r'^(return|using|const |static )')

    def test_no_text_is_changed(self):
        for mutant in self.module.all_mutants(1):
            self.assertEqual(re.findall('"[^"]*"', mutant.old.split('//')[0]), re.findall('"[^"]*"', mutant.new)
                             if mutant.new.strip() != '(void)0;' else re.findall('"[^"]*"', mutant.old.split('//')[0]))


class Copies(unittest.TestCase):
    def test_lie_where_roslaunch_does_not_look(self):
        try:
            from roslib.packages import _find_resource   # what roslaunch asks for a file of a package
        except ImportError:
            self.skipTest('no ROS here')
        with tempfile.TemporaryDirectory() as name:
            package = pathlib.Path(name)
            for folder in package, package / folder_of_copies('planted').relative_to(SOURCES) / 'sources':
                (folder / 'launch').mkdir(parents=True)
                (folder / 'launch' / 'ring.launch').touch()
            self.assertEqual(len(_find_resource(name, 'ring.launch')), 1)


class SwitchedLine(unittest.TestCase):
    def test_a_condition_is_one_or_the_other(self):
        self.assertEqual(switched('  if (a == b) return;', '  if (a != b) return;', 7),
                         '  if ((limb_ring::mutant == 7 ? (bool(a != b)) : (bool(a == b)))) return;')

    def test_a_statement_is_done_or_not(self):
        self.assertEqual(switched('  f(a, b);', '  (void)0;', 7),
                         '{ if (limb_ring::mutant == 7) { (void)0; } else { f(a, b); } }')

    def test_a_function_in_a_line_has_one_of_two_bodies(self):
        self.assertEqual(switched('  bool f() const { return a && b; }', '  bool f() const { return a || b; }', 7),
                         '  bool f() const { if (limb_ring::mutant == 7) { return a || b; } else { return a && b; } }')

    def test_a_variable_has_one_of_two_values(self):
        self.assertEqual(switched('  const int n = a + 1;', '  const int n = a - 1;', 7),
                         '  const int n = (limb_ring::mutant == 7 ? (a - 1) : (a + 1));')

    def test_a_number_is_one_or_the_other_wherever_it_stands(self):
        self.assertEqual(switched('  NodeId id{0};', '  NodeId id{1};', 7), 
                         '  NodeId id{static_cast<std::uint8_t>(limb_ring::mutant == 7 ? 1 : 0)};')
        self.assertEqual(switched('  return a == 0 &&', '  return a == 1 &&', 7),
                         '  return a == (limb_ring::mutant == 7 ? 1 : 0) &&')

    def test_a_constant_is_one_or_the_other_when_the_program_runs(self):
        self.assertEqual(switched('constexpr int kMost = 3;', 'constexpr int kMost = 4;', 7),
                         'inline const int kMost = (limb_ring::mutant == 7 ? 4 : 3);')
        self.assertEqual(switched('  static constexpr int kMost = 3;', '  static constexpr int kMost = 4;', 7),
                         '  static inline const int kMost = (limb_ring::mutant == 7 ? 4 : 3);')

    def test_a_part_of_a_statement_is_one_or_the_other_in_its_place(self):
        self.assertEqual(switched('  for (int i = 0; i < n; ++i) f();', '  for (int i = 0; i <= n; ++i) f();', 7),
                         '  for (int i = 0; (limb_ring::mutant == 7 ? (i <= n) : (i < n)); ++i) f();')
        self.assertEqual(switched('  return a && f(b == c) &&', '  return a && f(b != c) &&', 7),
                         '  return a && f((limb_ring::mutant == 7 ? (b != c) : (b == c))) &&')

    def test_what_binds_with_another_line_and_declarations_are_left_alone(self):
        for old, new in (('  return a && b &&', '  return a || b &&'), ('  return a &&', '  return a ||'),
                         ('constexpr int kBoth = a + b;', 'constexpr int kBoth = a - b;'),
                         ('  if (auto a = f()) return;', '  if (!(auto a = f())) return;')):
            self.assertIsNone(switched(old, new, 7), old)


if __name__ == '__main__':
    unittest.main()
