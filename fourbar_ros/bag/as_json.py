# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What info, recompute and diff find, as JSON.

The keys are documented in docs/recording.md and stay.
"""
from __future__ import annotations

from collections.abc import Sequence
import json
from math import isfinite
from pathlib import Path
from typing import Any, TYPE_CHECKING

if TYPE_CHECKING:      # what is printed comes from them
    from fourbar_ros.bag.diff import TopicDiff
    from fourbar_ros.bag.difference import Recomputed
    from fourbar_ros.bag.info import Info


def line(found: dict[str, Any]) -> str:
    """Return a dict as one line of JSON; what is not finite is text: "inf", "nan"."""
    return json.dumps(_plain(found), allow_nan=False)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return str(value) if isinstance(value, float) and not isfinite(value) else value


def of_error(bag: str | Path, error: BaseException) -> dict[str, Any]:
    """Return the dict of a bag that could not be read."""
    return {'bag': str(bag), 'error': str(error)}


def of_info(bag: str | Path, info: Info) -> dict[str, Any]:
    """Return the dict of an Info."""
    return {'bag': str(bag), 'sound': info.is_sound, 'state': info.state, 'size': info.size,
            'parts': info.parts,
            'start': info.start, 'end': info.end,
            'messages': sum(topic.messages for topic in info.topics),
            'missing': info.missing, 'dropped': info.dropped, 'ended': info.ended,
            'lost': info.lost,
            'damage': info.damage, 'about': info.about,
            'topics': [{'topic': topic.topic, 'type': topic.type, 'messages': topic.messages,
                        'missing': topic.missing} for topic in info.topics]}


def of_recomputed(bag: str | Path, found: Recomputed, tolerance: float,
                  accept_rounding: bool = False) -> dict[str, Any]:
    """Return the dict of a Recomputed."""
    problems = found.problems(tolerance, accept_rounding)
    return {'bag': str(bag), 'good': not problems, 'problems': problems,
            'by_rounding': found.is_rounding, 'verdict': found.verdict(),
            'largest': found.largest, 'tolerance': tolerance, 'cut': found.cut,
            'inputs': found.inputs,
            'compared': found.compared, 'unmatched': found.unmatched, 'missing': found.missing,
            'doubled': found.doubled, 'silent': found.silent, 'uncertain': found.uncertain,
            'driven': found.driven,
            'differences': [difference._asdict() for difference in found.differences]}


def of_diff(first: str | Path, second: str | Path, topics: Sequence[TopicDiff], tolerance: float
            ) -> dict[str, Any]:
    """Return the dict of a list of TopicDiff."""
    return {'first': str(first), 'second': str(second), 'tolerance': tolerance,
            'same': all(topic.is_same(tolerance) for topic in topics),
            'topics': [{'topic': topic.topic, 'same': topic.is_same(tolerance),
                        'messages': topic.messages,
                        'only_first': topic.only_first, 'only_second': topic.only_second,
                        'largest': topic.largest} for topic in topics]}
