# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Read YAML of others within bounds and without objects; write plain YAML."""
from __future__ import annotations

from typing import Any

from fourbar_ros.errors import BagError
import yaml

DEEPEST = 100               # levels in a YAML text
LARGEST = 1 << 19           # values in a YAML text, those that aliases stand for counted each time
_LOADER = getattr(yaml, 'CSafeLoader', yaml.SafeLoader)
Told = dict[str, Any]      # what metadata.yaml or a QoS profile tells, by name
_DUMPER: Any = getattr(yaml, 'CSafeDumper', yaml.SafeDumper)


def loaded(text: str) -> Any:
    """
    Return the content of a YAML text: lists, dicts, texts and numbers.

    Raises BagError for anything else, and for aliases that stand for more than LARGEST values.
    """
    try:
        _check_depth(text)
        found = yaml.load(text, Loader=_LOADER)
    except (yaml.YAMLError, ValueError, TypeError, RecursionError) as error:
        raise BagError(f'no YAML: {" ".join(str(error).split())[:200]}') from None
    seen, rest = 0, [found]
    while rest:
        value = rest.pop()
        seen += 1
        if isinstance(value, (dict, list)):
            rest += value.values() if isinstance(value, dict) else value
        elif isinstance(value, str):
            seen += len(value) // 64
        if seen + len(rest) > LARGEST:
            raise BagError(f'YAML of more than {LARGEST} values')
    return found


def _check_depth(text: str) -> None:
    """Raise BagError for lists so deeply nested that the recursive loader would fail."""
    depth = 0
    for event in yaml.parse(text, Loader=_LOADER):
        depth += (isinstance(event, yaml.CollectionStartEvent)
                  - isinstance(event, yaml.CollectionEndEvent))
        if depth > DEEPEST:
            raise BagError(f'YAML of more than {DEEPEST} levels')


def dumped(value: Any) -> str:
    """Return a value as YAML."""
    return yaml.dump(value, Dumper=_NoAliases, sort_keys=False, width=2**30)


class _NoAliases(_DUMPER):      # type: ignore[misc] # C's where there is one

    def ignore_aliases(self, data: Any) -> bool:
        return True
