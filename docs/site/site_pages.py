# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What the site has besides docs/: README and its like, public names, linked files, pages of scenes.

A hook of mkdocs. It fails where a page of measurements is stale. Links of the pages lead to files
of the tree; here to copies of them.
"""
from importlib import import_module
import os
from pathlib import Path
import re
import subprocess
import sys

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / 'docs'
PAGES = {ROOT / 'README.md': 'index.md',
         **{path: path.name for folder in (ROOT, ROOT / '.github')
            for path in folder.glob('[A-Z]*.md') if path.name != 'README.md'}}
LINK = re.compile(r'(?<=\]\()[^)\s#]+|(?<=src=")[^"#]+')
PICTURE = re.compile(r'!\[[^]]*\]\((gallery/\w+)\.svg\)')
WRITTEN = re.compile(r'make bench ARGS="(\w+)[^`]*`: [\d-]+, commit (\w+)')
FENCE = re.compile(r'^```.*?^```', re.S | re.M)
sys.path.insert(0, str(ROOT / 'test'))


def public():
    """Return the public packages, as the tests know them."""
    text = (ROOT / 'test' / 'test_fence.py').read_text(encoding='utf-8')
    return re.findall(r"'(fourbar_[\w.]+)'", re.search(r'PUBLIC = \((.*?)\)', text, re.S)[1])


def stale():
    """Return the measurements whose program has changed since their page was written."""
    found = []
    for page in sorted((DOCS / 'bench').glob('*.md')):
        for name, commit in WRITTEN.findall(page.read_text(encoding='utf-8')):
            changed = subprocess.run(['git', 'diff', '--quiet', commit, '--', f'bench/{name}.py'],
                                     cwd=ROOT, capture_output=True, check=False).returncode
            if changed == 1:            # 128: no git here, or not the whole history
                found.append(f'{page.relative_to(ROOT)}: make bench ARGS="{name} --write"')
    return found


def names():
    """Return the page of the public names."""
    sys.path.insert(0, str(ROOT))
    parts = ['# Public names', '', 'Everything else may move without notice.', '']
    for name in public():
        members = ', '.join(import_module(name).__all__)
        parts += [f'::: {name}', '    options:', f'      members: [{members}]', '']
    return '\n'.join(parts)


def source(path):
    """Return the true path of a page of the site."""
    given = {name: file for file, name in PAGES.items()}
    return given.get(path, DOCS / path)


def target(page, link):
    """Return the path in the site of what a page links to; None for an address."""
    if '://' in link or link.startswith(('mailto:', '/')):
        return None
    path = Path(os.path.normpath(source(page).parent / link))
    if path in PAGES:
        return PAGES[path]
    if path.is_relative_to(DOCS) and path.suffix != '.py':
        return path.relative_to(DOCS).as_posix()
    if not path.is_relative_to(ROOT) or not path.exists():
        return None                                     # mkdocs says that it is broken
    name = path.relative_to(ROOT).as_posix()
    return f'files/{name}' + ('/index.md' if path.is_dir() else '.txt')


def copy(path):
    """Return the text of a file, or the list of a folder."""
    if path.is_dir():
        return f'# {path.relative_to(ROOT)}\n\n' + ''.join(
            f'- `{entry.name}`\n' for entry in sorted(path.iterdir()) if entry.name[0] not in '._')
    return path.read_text(encoding='utf-8')


def on_files(files, config):
    """Add the pages and files that are not in docs/."""
    from fourbar_lab.live.page import page
    from fourbar_ros.scene.scene import load
    if old := stale():
        raise PluginError('measured by another program than that of today: ' + ', '.join(old))
    for path, name in PAGES.items():
        files.append(File.generated(config, name, content=path.read_text(encoding='utf-8')))
    files.append(File.generated(config, 'names.md', content=names()))
    for file in sorted((DOCS / 'gallery').glob('*.svg')):
        files.append(File.generated(config, f'gallery/{file.stem}.html',
                                    content=page(file.stem, load(file.stem))))
    made = set()
    for file in list(files.documentation_pages()):
        for match in LINK.finditer(FENCE.sub('', file.content_string)):
            name = target(file.src_uri, match[0])
            if name and name.startswith('files/') and name not in made:
                made.add(name)
                path = Path(os.path.normpath(source(file.src_uri).parent / match[0]))
                files.append(File.generated(config, name, content=copy(path)))
    return files


def on_page_markdown(markdown, page, config, files):
    """Turn the links of a page into those of the site."""
    here = page.file.src_uri
    if here == 'gallery.md':            # a click on a picture opens the page of its scene
        markdown = PICTURE.sub(r'[\g<0>](\1.html)', markdown)

    def link(match):
        place = target(here, match[0])
        return match[0] if place is None else os.path.relpath(place, Path(here).parent)

    parts, last = [], 0
    for fence in FENCE.finditer(markdown):
        parts += [LINK.sub(link, markdown[last:fence.start()]), fence[0]]
        last = fence.end()
    return ''.join([*parts, LINK.sub(link, markdown[last:])])
