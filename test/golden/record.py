# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Record the golden file again, or some of its parts: ``python test/golden/record.py [PART ...]``.

Prints for each scene what changed: how many values, by how much at most, how many beyond the
tolerance of the part. Parts: motion, batch, extrema, c_text, simulated, studies, balances; with
ROS messages, node.
"""
import json
from math import isfinite
from pathlib import Path
import sys

FOLDER = Path(__file__).parent


def read(file):
    """Return {key: {column: values}} of a part."""
    return json.loads((FOLDER / f'{file}.json').read_text(encoding='utf-8'))


def write(file, found):
    """Write a part, a line for each column, so that a comparison of versions can be read."""
    lines = (',\n'.join(f'  {json.dumps(name)}: {json.dumps(column, separators=(",", ":"))}'
                        for name, column in columns.items()) for columns in found.values())
    text = ',\n'.join(f' {json.dumps(key)}: {{\n{part}\n }}' for key, part in zip(found, lines))
    (FOLDER / f'{file}.json').write_text(f'{{\n{text}\n}}\n', encoding='utf-8')


def changes(old, new, tolerances):
    """
    Yield (column, index or None, recorded, now, difference, whether it is too large).

    Values that are no numbers, and columns of other lengths, differ or not; so do floats without
    a tolerance, by their bits.
    """
    for name in [*old, *(name for name in new if name not in old)]:
        before, now = old.get(name), new.get(name)
        if before is None or now is None or len(before) != len(now):
            yield name, None, before, now, float('nan'), True
            continue
        allowed = tolerances.get(name, 0.0)
        for k, (one, other) in enumerate(zip(before, now)):
            if repr(one) != repr(other):
                limit = allowed[k] if isinstance(allowed, list) else allowed
                difference = (abs(one - other) if isinstance(one, float) and isinstance(
                    other, float) else float('nan'))
                yield name, k, one, other, difference, not (difference <= limit and limit > 0.0)


def failures(part, key, old, new):
    """Return a line for each value beyond its tolerance: column, input, both values."""
    place = old.get('input', ())
    found = []
    for name, k, one, other, difference, is_wrong in changes(old, new, part.tolerances(old, new)
                                                             if hasattr(part, 'tolerances')
                                                             else {}):
        if is_wrong:
            where = f' at {k}, input {place[k]!r}' if place and k is not None else f' at {k}'
            found.append(f'{key}: {name}{where if k is not None else ""}: recorded {one!r}, '
                         f'now {other!r}, difference {difference:.2g}')
    return found


def summary(part, key, old, new):
    """Return a line that tells what changed, empty if nothing did."""
    if old is None or new is None:
        return f'{key}: {"gone" if new is None else "new"}'
    tolerances = part.tolerances(old, new) if hasattr(part, 'tolerances') else {}
    found = list(changes(old, new, tolerances))
    if not found:
        return ''
    total = sum(map(len, new.values()))
    numbers = [(change[4], change[0]) for change in found if isfinite(change[4])]
    others = sorted({change[0] for change in found if not isfinite(change[4])})
    return (f'{key}: {len(found)} of {total} values changed'
            + (f', largest {max(numbers)[0]:.2g} ({max(numbers)[1]})' if numbers else '')
            + (f', not numbers or not as many: {", ".join(others)}' if others else '')
            + f'; {sum(wrong for *_, wrong in found)} beyond the tolerance')


def main(names):
    """Record these parts, all if none is named."""
    from golden.library import PARTS, PROBE, probe
    parts = dict(PARTS)
    if not names or {'node', 'messages'} & set(names):
        import conftest  # noqa: F401  a ROS domain and folders of its own
        from golden.node import PARTS as OF_ROS
        parts |= OF_ROS
    if unknown := set(names) - set(parts):
        sys.exit(f'{", ".join(unknown)}: no part; parts are {", ".join(parts)}')
    for name in names or parts:
        part = parts[name]
        found = {key: part.columns(key) for key in part.cases()}
        old = read(name) if (FOLDER / f'{name}.json').exists() else {}
        if name in ('motion', 'batch'):
            # tolerances compare with the old probe
            lines = [summary(part, key, old.get(key), found.get(key)) for key in {**old, **found}]
            was, now, is_batch = PROBE.read_text().split(), probe(), name == 'batch'
            was[is_batch] = now[is_batch]
            PROBE.write_text(' '.join(was) + '\n')
        else:
            # as they were after reading, numbers and texts alike
            again = json.loads(json.dumps(found))
            lines = [summary(part, key, old.get(key), again.get(key)) for key in {**old, **again}]
        write(name, found)
        lines = list(filter(None, lines))
        print(f'{name}: {len(lines)} of {len(found)} changed', *lines, sep='\n  ')


if __name__ == '__main__':
    sys.path.insert(0, str(FOLDER.parent))
    from golden.record import main as _main  # one module, not also __main__
    _main(sys.argv[1:])
