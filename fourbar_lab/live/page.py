# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The page of a scene as one HTML file: styles, scripts and data stand in it."""
from collections.abc import Callable
from decimal import Decimal
import json
from pathlib import Path
import re
from typing import Any

from fourbar_lab.export.statements import filled
from fourbar_lab.live.answers import (
    Answer,
    extrema_answer,
    INTEGERS,
    run_answer,
    structure_of,
)
from fourbar_ros.errors import FourBarError
from fourbar_ros.scene.files import nested
from fourbar_ros.scene.parameters import of_name
from fourbar_ros.scene.scene import load, Scene
from fourbar_ros.scene.units import UNITS

RUN = 5.0           # [s]
SCRIPTS = 'engine', 'picture', 'curves', 'panel', 'draw', 'page'
NOT_IN_FILE = re.compile(r'^import .*\n|^export (?=class|const|function|async)|^//.*\n', re.M)


def page(name: str | None, scene: Scene | None, can_ask: bool = False, can_save: bool = False,
         second: Scene | None = None) -> str:
    """
    Return the page of a scene as HTML, None: of nothing; ``can_ask``: a server answers it.

    ``second``: a scene that is drawn in pale behind it.

    Browsers load no modules from files, so that all scripts are one.
    """
    name, values = name or 'drawing', scene.values if scene else {}
    structure = structure_of(scene or load('paper'))
    answered = None if can_ask else scene       # what a server would say of it is in the file
    data = {'name': name, 'canAsk': can_ask, 'canSave': can_save, 'integers': INTEGERS,
            'units': {si: {unit: str(Decimal(size)) for unit, size in sizes.items()}
                      for si, sizes in UNITS.items()},
            'withUnit': {name: values[name] for name in scene.with_unit} if scene else {},
            'second': second and structure_of(second),
            'run': _tried(run_answer, answered, RUN) if answered and answered.dynamics else None,
            'extrema': _tried(extrema_answer, answered, [*structure['quantities']], 0.0)
            if answered else None,
            'scene': nested({name: value for name, value in values.items()
                             if value == value and value != of_name(name).default}),
            'structure': structure}
    return filled(_text('page.html'), {
        'TITLE': name.replace('&', '&amp;').replace('<', '&lt;'),
        'CONNECT': "'self'" if can_ask else "'none'",
        'PAGE_CSS': _text('page.css'), 'PICTURE_CSS': _text('picture.css'),
        'DATA': as_json(data).replace('<', '\\u003c'),
        'SCRIPT': '\n'.join(NOT_IN_FILE.sub('', _text(f'js/{script}.js')) for script in SCRIPTS)})


def _tried(answer: Callable[..., Answer], *asked: Any) -> Answer:
    """Return an answer that a page without a server has with it; {problem}: why there is none."""
    try:
        return answer(*asked)
    except FourBarError as error:
        return {'problem': str(error)}


def as_json(answer: Any) -> str:
    return json.dumps(answer, allow_nan=False, separators=(',', ':'))


def _text(file: str) -> str:
    return (Path(__file__).parent / file).read_text(encoding='utf-8')
