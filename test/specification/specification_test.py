#!/usr/bin/env python3
"""docs/protocol.md is the specification of the ring: what is cited of it exists, and what the code counts, waits for
and sends stands in it."""
import importlib.util
import os
import re
import struct
import unittest
import zlib

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SPECIFICATION = os.path.join("docs", "protocol.md")
# Number the sections themselves, and cite them without the page's name.
OWN_PAGES = {SPECIFICATION, os.path.join("docs", "glossary.md")}
THIS_FILE = os.path.join("test", "specification", "specification_test.py")
TEXTS = (".h", ".cpp", ".py", ".md", ".cmake", ".txt", ".yaml", ".launch", ".lua", ".msg", ".srv", ".test", "")

NUMBER = r"\d{1,2}(?:\.\d{1,2})*"
NUMBERS = NUMBER + r"(?:(?:, | and | or | to )" + NUMBER + r")*"
COMMENT = re.compile(r"^\s*(?:///?<?|//!|#|\*|--)\s?", re.MULTILINE)
CITED = re.compile(r"protocol\.md\)?,? sections? (" + NUMBERS + r")\b")
BARE = re.compile(r"(?<!protocol\.md )(?<!protocol\.md\) )\b[Ss]ections? \d")


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return file.read()


def files():
    """All texts of the project, relative to its root."""
    for top in sorted(os.listdir(ROOT)):
        if top.startswith((".", "build")):
            continue
        if os.path.isfile(os.path.join(ROOT, top)):
            yield top
        for folder, below, names in os.walk(os.path.join(ROOT, top)):
            below[:] = [name for name in below if name != "node_modules"]  # those of others
            for name in sorted(names):
                if os.path.splitext(name)[1] in TEXTS:
                    yield os.path.relpath(os.path.join(folder, name), ROOT)


def texts():
    for path in files():
        if path == THIS_FILE:
            continue  # it cites sections that are not there, to test itself
        try:
            yield path, read(path)
        except UnicodeDecodeError:
            pass  # a picture, a recording


def running(text):
    """The text without line ends and marks of comments, so that a citation may go over a line's end."""
    return " ".join(COMMENT.sub("", text).split())


def sections_in(citations):
    return re.findall(NUMBER, citations)


def headings(page):
    return re.findall(r"^#{2,4} (" + NUMBER + r")\.? \S", page, re.MULTILINE)


def section(page, number):
    """From the heading of a section to the next heading of any kind."""
    found = re.search(r"^#+ " + re.escape(number) + r"\.? .*?(?=^#|\Z)", page, re.MULTILINE | re.DOTALL)
    return found.group(0) if found else ""


def rows(text):
    """First cells of the rows of its tables that are a `name`."""
    return re.findall(r"^\| `(\w+)` \|", text, re.MULTILINE)


def enumerators(name):
    """Of an enum class somewhere in the daemon's headers."""
    for path, text in texts():
        if not path.startswith("daemon") or not path.endswith(".h"):
            continue
        found = re.search(r"enum class " + name + r"[^{;]*\{(.*?)\}", text, re.DOTALL)
        if found:
            body = re.sub(r"//.*", "", found.group(1))
            return re.findall(r"(\w+)\s*(?:=\s*\d+)?\s*(?:,|$)", body.strip())
    raise AssertionError("no 'enum class %s' in daemon/: if it has a new name, this test needs it" % name)


class Citations(unittest.TestCase):
    def test_every_section_that_is_cited_exists(self):
        there = set(headings(read(SPECIFICATION)))
        wrong = ["%s cites section %s" % (path, number)
                 for path, text in texts()
                 for citations in CITED.findall(running(text))
                 for number in sections_in(citations) if number not in there]
        self.assertEqual(wrong, [])

    def test_sections_are_cited_with_the_name_of_the_page(self):
        wrong = ["%s: '...%s...'" % (path, text[max(0, found.start() - 30):found.end() + 10])
                 for path, text in ((path, running(text)) for path, text in texts()
                                    if path not in OWN_PAGES)
                 for found in BARE.finditer(text)]
        self.assertEqual(wrong, [])

    def test_the_pages_own_references_exist(self):
        there = set(headings(read(SPECIFICATION)))
        reference = re.compile(r"\((\d{1,2}\.\d{1,2}(?:, \d{1,2}\.\d{1,2})*)\)")
        for path in OWN_PAGES:
            cited = {number for found in reference.findall(read(path)) for number in found.split(", ")}
            self.assertEqual(cited - there, set(), path)
            self.assertGreater(len(cited), 10, path)

    def test_no_two_sections_have_one_number(self):
        numbers = headings(read(SPECIFICATION))
        self.assertEqual(len(numbers), len(set(numbers)))
        self.assertGreater(len(numbers), 50)

    def test_a_citation_is_found_also_over_the_end_of_a_line(self):
        text = running("/// a (protocol.md\n/// section 8.4) b\n# protocol.md sections 3, 4.10 and 77\n")
        self.assertEqual([sections_in(found) for found in CITED.findall(text)], [["8.4"], ["3", "4.10", "77"]])
        self.assertIsNone(BARE.search(text))
        self.assertIsNotNone(BARE.search("as Section 5 says"))


class Contents(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.page = read(SPECIFICATION)

    def counters(self, folder, pattern):
        return [name for path, text in texts()
                if path.startswith(folder) and path.endswith("counters.h")
                for name in re.findall(pattern, text)]

    def test_every_counter_of_the_network_controller_is_listed(self):
        counted = self.counters(os.path.join("daemon", "core"), r'X\((\w+), "')
        self.assertGreater(len(counted), 40)
        self.assertCountEqual(rows(section(self.page, "10.1")), counted)

    def test_every_counter_of_a_link_is_listed(self):
        counted = self.counters(os.path.join("daemon", "io"), r'X\((\w+), "')
        self.assertGreater(len(counted), 20)
        self.assertCountEqual(rows(section(self.page, "10.2")) + rows(section(self.page, "10.3")), counted)

    def test_every_counter_of_faults_on_purpose_is_listed(self):
        counted = re.findall(r'X\((\w+), "', read(os.path.join("daemon", "config", "line_faults.h")))
        self.assertGreater(len(counted), 8)
        self.assertCountEqual(rows(section(self.page, "10.4")), counted)

    def test_every_counter_that_status_puts_beside_these_is_listed(self):
        counted = re.findall(r'all\["(\w+)"\] = ', read(os.path.join("daemon", "node", "status.cpp")))
        self.assertGreater(len(counted), 6)
        self.assertCountEqual(rows(section(self.page, "10.5")), counted)

    def test_every_prefix_of_a_counter_is_explained(self):
        status = read(os.path.join("daemon", "node", "status.cpp"))
        prefixes = re.findall(r'into\(all, "(\w+_)"\)', status)
        self.assertEqual(len(prefixes), 4)
        for prefix in prefixes:
            self.assertIn("`%s...`" % prefix, section(self.page, "10"))

    def test_every_counter_that_tells_of_an_error_is_one_of_these(self):
        told = re.findall(r'\{Of::\w+, "(\w+)", ', read(os.path.join("daemon", "ring", "ring_client.cpp")))
        self.assertGreater(len(told), 20)
        counted = rows(section(self.page, "10.1")) + rows(section(self.page, "10.5"))
        for prefix, number in (("input_", "10.2"), ("output_", "10.3")):
            counted += [prefix + name for name in rows(section(self.page, number))]
        self.assertEqual(sorted(set(told) - set(counted)), [])

    def test_every_counter_of_the_bridge_is_listed(self):
        sources = "".join(text for path, text in texts() if path.startswith("ros_bridge") and path.endswith(".cpp"))
        counted = set(re.findall(r'counters_\.(?:add|set|lose|set_lost)\("(\w+)"[,)]', sources))
        self.assertGreater(len(counted), 15)
        page = read(os.path.join("docs", "reference", "ros.md")).split("## Counters of the bridge")[1].split("\n## ")[0]
        self.assertEqual([name for name in sorted(counted) if "`%s`" % name not in page], [])
        of_topics = set(re.findall(r'"_(received|dropped_\w+)"', sources))
        of_topics |= set(re.findall(r'(?<!\.)(?:count|lose)\("(\w+)"\)', sources))
        self.assertGreater(len(of_topics), 4)
        self.assertEqual([name for name in sorted(of_topics) if "`topic_NAME_%s`" % name not in page], [])

    def test_every_timeout_is_in_the_table_of_timers_with_its_default(self):
        options = re.search(r"^## `timeouts`\n(.*?)^## ", read(os.path.join("config", "OPTIONS.md")),
                            re.MULTILINE | re.DOTALL).group(1)
        defaults = dict(re.findall(r"^\| `(\w+)` \| `(\w+)` \|", options, re.MULTILINE))
        self.assertGreater(len(defaults), 10)
        timers = section(self.page, "7.4")
        self.assertEqual(dict(re.findall(r"`timeouts\.(\w+)` \((\w+)", timers)), defaults)

    def test_every_state_reason_and_code_is_listed(self):
        for name, where in [("NodeState", "8.1"), ("Reject", "4.6"), ("SliceKind", "6.2"), ("LinkHeaderType", "6.5"),
                            ("Refusal", "6.5"), ("FoldWordKind", "8.8")]:
            for word in enumerators(name):
                if (name, word) != ("Reject", "none"):
                    self.assertIn("`%s`" % word, section(self.page, where), name)

    def test_every_outcome_and_every_state_that_a_beacon_tells_is_listed(self):
        for name, where in [("Outcome", "4.6"), ("CpuState", "3.9"), ("LinkState", "3.9"), ("CpuVerdict", "8.13")]:
            for word in enumerators(name):
                self.assertRegex(section(self.page, where), r"\b%s\b" % word.replace("_", " "), name)


class ControlMessages(unittest.TestCase):
    """What daemon/wire/control_message.h lists stands in all that tells of it."""

    @classmethod
    def setUpClass(cls):
        path = os.path.join(ROOT, "docs", "generate_reference.py")
        spec = importlib.util.spec_from_file_location("generate_reference", path)
        cls.writer = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(cls.writer)
        cls.page = read(SPECIFICATION)
        cls.parts = sum(cls.writer.messages().values(), [])  # hello, beacon, what it has latched
        cls.sizes = [cls.writer.end_of(part) for part in cls.parts]

    def test_tables_dissector_and_sizes_are_as_the_lists_say(self):
        for path, text in self.writer.told_files().items():
            self.assertEqual(read(path), text, "%s: `make docs` writes it" % path)

    def test_sentences_about_sizes_are_as_the_lists_say(self):
        hello, short, long = self.sizes
        listed = [str(one.at) for one in sum(self.parts[1:], []) if one.type in ("bool", "CpuState", "LinkState")]
        beacon = " ".join(section(self.page, "3.9").split())
        self.assertIn("It has %d bytes." % hello, section(self.page, "3.8"))
        self.assertIn("It has %d bytes." % short, beacon)
        self.assertIn("it has %d more" % (long - short), beacon)
        self.assertIn("one of %d bytes whose bytes %d to %d say nothing" % (long, short, long - 1), beacon)
        self.assertIn("an unlisted value in bytes %s or %s, " % (", ".join(listed[:-1]), listed[-1]), beacon)

    def test_nodes_in_python_know_these_sizes(self):
        foreign, kit = os.path.join("test", "specification", "foreign_node.py"), os.path.join("conform", "kit", "wire.py")
        for path in (foreign, kit):
            packed = [struct.calcsize(layout) for layout in re.findall(r"'(>BQ\w+)', (?:HELLO|BEACON)", read(path))]
            self.assertCountEqual(packed, self.sizes[:2], path)
        self.assertIn("== HELLO and len(data) == %d or data[0] == BEACON and len(data) in (%d, %d)" % tuple(self.sizes),
                      read(foreign))

    def test_every_field_has_a_title_and_a_meaning(self):
        self.assertTrue(all(one.title and one.value for one in sum(self.parts, [])))
        self.assertEqual(self.writer.columns('bool, x, A{0}, "a, b" " (c)", "d", kNews'),
                         ["bool", "x", "A{0}", "a, b (c)", "d", "kNews"])


class Walks(unittest.TestCase):
    """The functions that a byte and a send pass, as CONTRIBUTING.md has them."""

    def test_every_function_of_a_walk_exists(self):
        walks = re.findall(r"```\n((?:link::Input|HostPort).*?)```", read("CONTRIBUTING.md"), re.DOTALL)
        self.assertEqual(len(walks), 2)
        sources = [text for path, text in texts() if path.startswith(("daemon", "include"))]
        named = {name for walk in walks for name in re.findall(r"\b([A-Z]\w+)::(\w+)", walk)}
        self.assertGreater(len(named), 25)
        self.assertEqual([name for name in sorted(named) if not any(self.has(text, *name) for text in sources)], [])

    @staticmethod
    def has(text, owner, function):
        """It defines the function, or it has the class and declares the function."""
        if re.search(r"\b%s::%s\(" % (owner, function), text):
            return True
        return bool(re.search(r"^(?:class|struct) %s\b[^;]*\{" % owner, text, re.MULTILINE) and
                    re.search(r"\b%s\(" % function, text))


class WorkedExample(unittest.TestCase):
    """The CRCs of section 11, by another CRC than the project's own."""

    def bytes_of(self, number):
        block = re.search(r"```\n(.*?)```", section(read(SPECIFICATION), number), re.DOTALL).group(1)
        return [bytes.fromhex(line.replace("|", " ")) for line in block.splitlines()]

    def check(self, packet):
        self.assertEqual(zlib.crc32(packet[:-4]), int.from_bytes(packet[-4:], "big"), packet.hex())

    def test_packets_have_good_crcs(self):
        for number in ("11.1", "11.2", "11.3", "11.6", "11.7"):
            [packet] = self.bytes_of(number)
            self.check(packet)

    def test_slices_hold_packets_with_good_crcs(self):
        [whole] = self.bytes_of("11.4")
        self.check(whole[4:])
        start, interrupt, end = self.bytes_of("11.5")
        self.check(interrupt[4:])
        self.check(start[4:] + end[4:])

    def test_the_patch_rule_as_written_gives_the_relayed_crc(self):
        def change(delta, after):
            crc = delta
            for _ in range(8 * (after + 1)):
                crc = crc >> 1 ^ (0xEDB88320 if crc & 1 else 0)
            return crc
        [sent], [relayed] = self.bytes_of("11.1"), self.bytes_of("11.2")
        crc = int.from_bytes(sent[-4:], "big")
        crc ^= change(sent[2] ^ relayed[2], len(sent) - 7) ^ change(sent[-7] ^ relayed[-7], 2)
        self.assertEqual(crc, int.from_bytes(relayed[-4:], "big"))


if __name__ == "__main__":
    unittest.main()
