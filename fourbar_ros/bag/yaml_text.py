# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Read YAML from foreign files safely: bounded in size, plain values; write plain YAML."""
from __future__ import annotations

from typing import Any

from fourbar_ros.errors import BagError
import yaml

DEEPEST = 100               # levels in a YAML text
LARGEST = 1 << 19           # values in a YAML text; the target of an alias counts each time
_LOADER = getattr(yaml, 'CSafeLoader', yaml.SafeLoader)
YamlMap = dict[str, Any]    # a mapping in YAML: metadata.yaml or a QoS profile
_DUMPER: Any = getattr(yaml, 'CSafeDumper', yaml.SafeDumper)


def loaded(text: str) -> Any:
    """
    Return the content of a YAML text: lists, dicts, texts and numbers.

    Raises BagError for anything else, and beyond LARGEST values or DEEPEST levels: by aliases of
    aliases ten lines can stand for 10^9 values.
    """
    try:
        depth = 0
        for event in yaml.parse(text, Loader=_LOADER):
            depth += (isinstance(event, yaml.CollectionStartEvent)
                      - isinstance(event, yaml.CollectionEndEvent))
            if depth > DEEPEST:
                raise BagError(f'YAML of more than {DEEPEST} levels')
        content = yaml.load(text, Loader=_LOADER)
    except (yaml.YAMLError, ValueError, TypeError, RecursionError) as error:
        raise BagError(f'no YAML: {" ".join(str(error).split())[:200]}') from None
    count, rest = 0, [content]
    while rest:
        value = rest.pop()
        count += 1
        if isinstance(value, (dict, list)):
            rest += value.values() if isinstance(value, dict) else value
        elif isinstance(value, str):
            count += len(value) // 64                   # a long text counts by its size
        if count + len(rest) > LARGEST:
            raise BagError(f'YAML of more than {LARGEST} values')
    return content


def dumped(value: Any) -> str:
    """Return a value as YAML."""
    return yaml.dump(value, Dumper=_NoAliases, sort_keys=False, width=2**30)


class _NoAliases(_DUMPER):      # type: ignore[misc] # C's where there is one

    def ignore_aliases(self, data: Any) -> bool:
        return True         # rosbag2 reads none: equal profiles are written out twice
