"""``fourbar reproduce``: the two source documents computed again, number by number."""
from __future__ import annotations

import argparse

from .bag import BAD

EPILOG = """\
verdicts:
  agrees               to the last printed digit
  read off a drawing   as near as a drawing can be read
  rounded on the way   computed from rounded numbers
  misprint             wrong; the reason is given, and for equations the correction was checked
  not given            cannot be computed from what the document says

examples:
  fourbar reproduce
  fourbar reproduce --html report.html      one page with the figures; needs matplotlib

exit codes: 0 good; 1 an error; 2 bad arguments; 3 done, but a number differs without a known reason
"""


def add(verbs):
    """Add the verb."""
    verb = verbs.add_parser(
        'reproduce', help='recompute the examples, equations, tables and figures of the lecture slides and the paper',
        description='Compute again everything the lecture slides (set 7) and the paper of Hayes, Hninn and Irani '
                    'print: printed value, ours, difference, verdict.',
        epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    verb.add_argument('--html', metavar='FILE', help='also write one self-contained page with the figures')
    verb.set_defaults(run=_reproduce)


def _reproduce(arguments):
    from ..reproduce import DIFFERS, count, print_tables, reproduce
    sections = reproduce()
    print_tables(sections)
    if arguments.html:
        from ..figures import write_page
        write_page(sections, arguments.html)
        print(arguments.html)
    return BAD if DIFFERS in count(sections) else 0
