"""
Print CHANGELOG.md as the CHANGELOG.rst of REP 132, which bloom and catkin_pkg read.

The Markdown is the one that people write; scripts/release.sh writes the other one from it.
"""
from pathlib import Path
import re

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = 'fourbar_ros'
LINK = re.compile(r'\[([^\]]*)\]\([^)]*\)')


def inline(text):
    """Return a line of Markdown as reStructuredText, of links their text."""
    parts = re.split('(`[^`]*`)', LINK.sub(r'\1', text.replace('**', '')))
    return ''.join(f'`{part}`' if part[:1] == '`' else re.sub(r'([*|_\\<])', r'\\\1', part)
                   for part in parts).replace('````', '`` ``')


def as_rst(text):
    """Return the changelog; versions without a date are Forthcoming."""
    title = f'Changelog for package {PACKAGE}'
    lines = ['^' * len(title), title, '^' * len(title)]
    for section in re.split('^## ', text, flags=re.M)[1:]:
        head, _, body = section.partition('\n')
        head = head.strip() if re.fullmatch(r'[\d.]+ \(\d{4}-\d\d-\d\d\)', head.strip()) else (
            'Forthcoming')
        lines += ['', head, '-' * len(head)]
        about = ''                       # the heading under which an entry stands
        for line in body.splitlines():
            if heading := re.fullmatch(r'#+ (.*)|\*\*(.*)\*\*(?: \(.*\))?', line.strip()):
                about = f'{inline(heading[1] or heading[2])}: '
            elif line.startswith('- '):
                lines.append(f'* {about}{inline(line[2:])}')
    return '\n'.join(lines) + '\n'


if __name__ == '__main__':
    print(as_rst((ROOT / 'CHANGELOG.md').read_text(encoding='utf-8')), end='')
