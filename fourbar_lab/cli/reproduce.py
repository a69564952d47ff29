# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar reproduce``: recompute the two source documents, number by number."""
from argparse import Namespace

from fourbar_ros.cli.common import add_output, add_verb, BAD, Verbs

EPILOG = """\
verdicts:
{verdicts}

examples:
  fourbar reproduce
  fourbar reproduce --html report.html      one page with the figures; requires matplotlib

exit codes: 0 good; 1 an error; 2 bad arguments; 3 done, but a number differs without a
known reason
"""


def add(verbs: Verbs) -> None:
    from fourbar_lab.reproduction.documents import VERDICTS
    verdicts = '\n'.join(f'  {name:<21}{meaning}' for name, meaning in VERDICTS.items())
    verb = add_verb(
        verbs, 'reproduce', 'recompute the examples, equations, tables and figures of the lecture '
                            'slides and the paper',
        'Recompute every number printed in the lecture slides (set 7) and in the paper of Hayes, '
        'Hninn and\nIrani: printed value, computed value, difference, verdict.',
        EPILOG.format(verdicts=verdicts))
    add_output(verb, '--html', metavar='FILE', suffix='.html',
               help='also write one self-contained page with the figures')
    verb.set_defaults(run=_reproduce)


def _reproduce(arguments: Namespace) -> int:
    from fourbar_lab.reproduction.documents import count, DIFFERS, print_tables
    from fourbar_lab.reproduction.paper import reproduce
    sections = reproduce()
    # first: a file that cannot be written is reported before the tables
    if arguments.html:
        from fourbar_lab.reproduction.page import write_report
        write_report(sections, arguments.html)
    print_tables(sections)
    if arguments.html:
        print(arguments.html)
    return BAD if DIFFERS in count(sections) else 0
