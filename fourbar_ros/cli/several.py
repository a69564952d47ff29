"""``fourbar bag info`` and ``recompute``: one bag in full, several in a table or as lines of JSON."""
from __future__ import annotations

from contextlib import contextmanager
from functools import partial


def info(arguments):
    """Run ``fourbar bag info``."""
    from fourbar_ros.bag import as_json
    from fourbar_ros.bag.info import info as work
    from fourbar_ros.cli.bag import print_info

    def row(found):
        seconds = (found.end - found.start) * 1e-9 if found.start is not None else 0.0
        return (found.state, f'{seconds:.3f}', f'{found.size / 1e6:.3f}', str(found.parts),
                str(sum(topic.messages for topic in found.topics)), str(found.missing), found.damage or found.ended)
    return _run(arguments, partial(work, check=arguments.check), 'reading', as_json.of_info, print_info,
                ('state', 's>', 'MB>', 'parts>', 'messages>', 'missing>', 'damage, end'), row,
                lambda found: found.is_sound)


def recompute(arguments):
    """Run ``fourbar bag recompute``."""
    from fourbar_ros.bag import as_json
    from fourbar_ros.bag.recompute import compare as work
    from fourbar_ros.cli.bag import print_recomputed
    tolerance = arguments.tolerance

    def row(found):
        return (str(found.inputs), str(found.compared), f'{found.largest:g}',
                '; '.join(found.problems(tolerance)) or ('good, cut' if found.cut else 'good'))
    return _run(arguments, partial(work, node=arguments.node), 'recomputing',
                lambda bag, found: as_json.of_recomputed(bag, found, tolerance), print_recomputed,
                ('inputs>', 'outputs compared>', 'largest difference>', 'verdict'), row,
                lambda found: not found.problems(tolerance))


def _run(arguments, work, text, to_json, to_text, columns, to_row, is_good):
    """Work on all bags of the arguments, print what was found, return the exit code."""
    from fourbar_ros.bag.many import bags_below, each
    from fourbar_ros.cli.bag import BAD, progress
    bags = bags_below(arguments.bags)
    if len(bags) == 1:
        with progress(bags[0], text) as step:
            found = [work(bags[0], progress=step)]
    else:
        with _bar(text, len(bags)) as step:
            found = each(work, bags, arguments.jobs, step)
    if arguments.json:
        _print_json(bags, found, to_json)
    elif len(bags) == 1:
        to_text(bags[0], found[0], arguments)
    else:
        _print_table(bags, found, columns, to_row)
    if any(isinstance(one, Exception) for one in found):
        return 1
    return 0 if all(map(is_good, found)) else BAD


def _print_json(bags, found, to_json):
    from fourbar_ros.bag import as_json
    for bag, one in zip(bags, found):
        print(as_json.line(as_json.of_error(bag, one) if isinstance(one, Exception) else to_json(bag, one)))


def _print_table(bags, found, columns, to_row):
    from fourbar_ros.report.tables import make_console, plain_table
    table = plain_table('', ('bag', *columns))
    for bag, one in zip(bags, found):
        table.add_row(str(bag), *(('', ) * (len(columns) - 1) + (f'error: {one}',) if isinstance(one, Exception)
                                  else to_row(one)))
    make_console().print(table)


@contextmanager
def _bar(text, count):
    """Show a bar on the terminal; gives the function to call with the number of bags done."""
    from rich.console import Console
    from rich.progress import Progress
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(f'{text} {count} bags', total=count)
        yield lambda done: bar.update(task, completed=done)
