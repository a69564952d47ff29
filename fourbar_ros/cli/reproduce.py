"""``fourbar reproduce``: the two source documents computed again, number by number."""
from __future__ import annotations

import argparse

from fourbar_ros.cli.bag import BAD

EPILOG = """\
verdicts:
{verdicts}

examples:
  fourbar reproduce
  fourbar reproduce --html report.html      one page with the figures; needs matplotlib

exit codes: 0 good; 1 an error; 2 bad arguments; 3 done, but a number differs without a known reason
"""


def add(verbs):
    """Add the verb."""
    from fourbar_ros.reproduction.verdicts import VERDICTS
    verdicts = '\n'.join(f'  {name:<21}{meaning}' for name, meaning in VERDICTS.items())
    verb = verbs.add_parser(
        'reproduce', help='recompute the examples, equations, tables and figures of the lecture slides and the paper',
        description='Compute again everything the lecture slides (set 7) and the paper of Hayes, Hninn and Irani '
                    'print: printed value, ours, difference, verdict.',
        epilog=EPILOG.format(verdicts=verdicts), formatter_class=argparse.RawDescriptionHelpFormatter)
    verb.add_argument('--html', metavar='FILE', help='also write one self-contained page with the figures')
    verb.set_defaults(run=_reproduce)


def _reproduce(arguments):
    from fourbar_ros.reproduction.reproduce import count, print_tables, reproduce
    from fourbar_ros.reproduction.verdicts import DIFFERS
    sections = reproduce()
    if arguments.html:              # first: what cannot be written is said before the tables
        from fourbar_ros.reproduction.figures import write_page
        write_page(sections, arguments.html)
    print_tables(sections)
    if arguments.html:
        print(arguments.html)
    return BAD if DIFFERS in count(sections) else 0
