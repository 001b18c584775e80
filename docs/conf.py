"""Settings of the manual: `make docs` builds it as HTML. Readable as Markdown on a forge, too."""
import os
import re

_HERE = os.path.dirname(os.path.abspath(__file__))

with open(os.path.join(_HERE, '..', 'package.xml'), encoding='utf-8') as package:
    release = re.search(r'<version>(.*)</version>', package.read()).group(1)

project = 'limb_ring'
author = 'limb_ring maintainers'
copyright = author
version = release
extensions = ['myst_parser']
myst_enable_extensions = ['colon_fence']
myst_heading_anchors = 4
source_suffix = {'.md': 'markdown'}
exclude_patterns = ['_build']
html_theme = 'furo'
html_title = 'limb_ring ' + release
nitpicky = True


def _unlink(name, text):
    """The HTML stands alone: a link to a file outside of docs/ becomes its text."""
    def link(match):
        target = match.group(2).split('#')[0]
        path = os.path.normpath(os.path.join(_HERE, os.path.dirname(name), target))
        stays = not target or '://' in target or path.startswith(_HERE + os.sep)
        return match.group(0) if stays else match.group(1)
    return re.sub(r'\[([^\]]+)\]\(([^)\s]+)\)', link, text)


def setup(app):
    def read(_, name, source):
        source[0] = _unlink(name, source[0])
    app.connect('source-read', read)
