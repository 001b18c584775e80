"""Settings of the manual: `make docs` builds it as HTML. Readable as Markdown on a forge, too."""
import html
import os
import re
import shutil

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
highlight_language = 'text'   # of blocks that name none: commands of a shell, mostly
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


# What `make playground` has built. Without it the pages that embed it say nothing of it.
_PLAYGROUND = os.environ.get('PLAYGROUND') or os.path.join(_HERE, '..', 'build', 'playground', 'page')


def _embed(name, text):
    """The playground for <!-- playground #ADDRESS: TITLE -->, below its title; it is loaded when somebody opens that."""
    def frame(match):
        if not os.path.isdir(_PLAYGROUND):
            return ''
        page = html.escape('../' * name.count('/') + 'playground/index.html' + match.group(1))
        title = html.escape(match.group(2))
        return ('<details><summary>%s</summary><p><a href="%s">In a tab of its own</a>. It needs a web server: '
                'browsers load no modules from files.</p><iframe src="%s" title="%s" loading="lazy" '
                'style="width: 100%%; height: 44rem; border: 1px solid"></iframe></details>\n' % (title, page, page, title))
    return re.sub(r'<!-- playground (#\S*): (.*?) -->\n', frame, text)


def setup(app):
    def read(_, name, source):
        source[0] = _embed(name, _unlink(name, source[0]))

    def finished(app, problem):
        if problem is None and app.builder.format == 'html' and os.path.isdir(_PLAYGROUND):
            shutil.copytree(_PLAYGROUND, os.path.join(app.outdir, 'playground'), dirs_exist_ok=True)
    app.connect('source-read', read)
    app.connect('build-finished', finished)
