"""Every link of the pages leads to a file and a heading that are there, the README is short, and one version stands everywhere."""
import os
import re
import runpy
import tempfile
import unittest
from unittest import mock

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
LINK = re.compile(r'\]\(([^)\s]+)\)')
MOST_LINES_OF_README = 200


def read(name):
    with open(os.path.join(ROOT, name), encoding='utf-8') as file:
        return file.read()


def pages():
    listed = [os.path.relpath(os.path.join(folder, file), ROOT)
              for folder, folders, files in os.walk(os.path.join(ROOT, 'docs')) for file in files
              if '_build' not in folder and file.endswith('.md')]
    return sorted(listed) + ['README.md', 'CONTRIBUTING.md']


def without_code(text):
    return re.sub(r'`[^`\n]*`', '', re.sub(r'^```.*?^```', '', text, flags=re.S | re.M))


def anchors(text):
    """As a forge makes them of headings."""
    found = set()
    for heading in re.findall(r'^#+ +(.*)$', re.sub(r'^```.*?^```', '', text, flags=re.S | re.M), re.M):
        words = re.sub(r'\[([^\]]*)\]\([^)]*\)', r'\1', heading).lower()
        found.add(re.sub(r'[^\w\- ]', '', words).strip().replace(' ', '-'))
    return found


class Pages(unittest.TestCase):
    def test_links_lead_to_files_and_headings(self):
        wrong = []
        for page in pages():
            for link in LINK.findall(without_code(read(page))):
                if re.match(r'[a-z]+:', link):
                    continue
                path, _, anchor = link.partition('#')
                target = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
                if not os.path.exists(os.path.join(ROOT, target)):
                    wrong.append('%s: no %s' % (page, link))
                elif anchor and target.endswith('.md') and anchor not in anchors(read(target)):
                    wrong.append('%s: no heading %s' % (page, link))
        self.assertEqual(wrong, [])

    def test_readme_is_short(self):
        self.assertLessEqual(read('README.md').count('\n'), MOST_LINES_OF_README)

    def test_every_page_can_be_reached_from_the_index(self):
        seen, todo = set(), ['docs/index.md', 'README.md']
        while todo:
            page = todo.pop()
            if page in seen:
                continue
            seen.add(page)
            for link in LINK.findall(read(page)):
                target = os.path.normpath(os.path.join(os.path.dirname(page), link.partition('#')[0]))
                if target.endswith('.md') and os.path.exists(os.path.join(ROOT, target)):
                    todo.append(target)
        self.assertEqual([page for page in pages() if page not in seen], [])


class Playground(unittest.TestCase):
    MARK = 'Before.\n\n<!-- playground #show=case&pace=0.1: The "worst" case -->\n\nAfter.\n'

    def embedded(self, page, folder):
        with mock.patch.dict(os.environ, PLAYGROUND=folder):
            return runpy.run_path(os.path.join(ROOT, 'docs', 'conf.py'))['_embed'](page, self.MARK)

    def test_a_page_embeds_it_if_it_was_built(self):
        with tempfile.TemporaryDirectory() as built:
            text = self.embedded('tutorial/2_break_and_reset', built)
        self.assertIn('<iframe src="../playground/index.html#show=case&amp;pace=0.1" title="The &quot;worst&quot; case" loading="lazy"', text)
        self.assertRegex(text, r'(?s)^Before\.\n\n<details>.*</details>\n\nAfter\.\n$')

    def test_a_page_does_not_mention_it_if_it_was_not_built(self):
        self.assertEqual(self.embedded('index', os.path.join(ROOT, 'nowhere')), 'Before.\n\n\nAfter.\n')

    def test_each_page_that_embeds_it_does_so_in_a_line_of_its_own(self):
        marked = {page: len(re.findall('<!-- playground', read(page))) for page in pages()}
        self.assertGreaterEqual(sum(marked.values()), 4)
        for page, count in marked.items():
            self.assertEqual(len(re.findall(r'^<!-- playground #\S*: .* -->$', read(page), re.M)), count, page)


class Version(unittest.TestCase):
    def test_one_version_stands_everywhere(self):
        package = re.search(r'<version>(.*)</version>', read('package.xml')).group(1)
        said = {'debian/changelog': re.match(r'limb-ring \(([^)]*)\)', read('debian/changelog')).group(1),
                'CHANGELOG.rst': re.search(r'^(\d+\.\d+\.\d+) \(', read('CHANGELOG.rst'), re.M).group(1),
                'README.md': re.search(r'Version (\d+\.\d+\.\d+)', read('README.md')).group(1)}
        self.assertEqual({file: version for file, version in said.items() if version != package}, {}, 'not ' + package)

    def test_the_wire_version_of_the_code_is_that_of_the_specification(self):
        code = re.search(r'kLinkVersion = (\d+);', read('daemon/io/link_header.h')).group(1)
        self.assertIn('| 2 | 1 | version | %s |' % code, read('docs/protocol.md'))


if __name__ == '__main__':
    unittest.main()
