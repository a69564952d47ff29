# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A study: a scene, what varies in it, and what is computed, kept and ranked.

Read from YAML and checked as a whole before anything is computed. In the checks ``entry`` is the
name of an entry in the study, ``given`` its value in YAML; InvalidParameter names the entry and
says what is allowed.
"""
from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from itertools import product
from math import isfinite, prod
from pathlib import Path
from typing import Any, NamedTuple

from fourbar_lab.studies.measures import CLASS, limits, Measure, Measures, merged
from fourbar_lab.studies.variation import (
    LONGEST,
    METHODS,
    TOLERANCES,
    unit_points,
    Variation,
    variation,
    WHOLE,
    Yaml,
)
from fourbar_ros.errors import FourBarError, InvalidParameter, nearest
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.files import find, read_values
from fourbar_ros.scene.parameters import ParameterValues
from fourbar_ros.scene.scene import from_values, Scene
import numpy as np
import yaml

KEYS = ('scene', 'vary', 'method', 'rows', 'seed', 'acceleration', 'quantities', 'constraints',
        'objectives', 'curves', 'keep', 'chunk')
KEEP = ('feasible', 'all')
SENSES = ('minimize', 'maximize')
# Rows that are computed, kept and lost together: seconds of work.
CHUNK = 8192
LARGEST, MOST_ROWS, MOST_SAMPLES = 2**20, 2**44, 4096
# Designs of which one at least must be possible.
TRIED = 1000
# Lengths of these make every type: each link the longest or the shortest, sums equal or not.
RATIOS = (1.0, 3.0, 4.0)


class StudyError(FourBarError, ValueError):
    """A study cannot be run, continued or read; the message gives the reason."""


class Bound(NamedTuple):
    """A constraint: a measure between two values, or one of some texts."""

    measure: Measure
    least: float
    most: float
    texts: tuple[str, ...] = ()


class Objective(NamedTuple):
    """What is to be small, or large."""

    measure: Measure
    sense: str


class Curve(NamedTuple):
    """A point of the scene whose path is kept, and at how many inputs."""

    point: str
    samples: int


@dataclass(frozen=True)
class Study:
    """
    A checked study.

    Parameters
    ----------
    values : dict
        Every parameter of the scene, checked.
    vary : tuple of Variation
    method, rows, seed
        The design of the study, see :mod:`fourbar_lab.studies.variation`.
    acceleration : float
        Acceleration of the input, beside the rate ``drive.speed``.
    measures : tuple of Measure
        All columns that are computed, those of constraints and objectives included.
    bounds : tuple of Bound
    objectives : tuple of Objective
    curves : tuple of Curve
    keeps_all : bool
        Keep rows that do not fulfil the constraints too.
    chunk : int
        Rows that are computed together.

    """

    values: ParameterValues
    vary: tuple[Variation, ...]
    method: str
    rows: int
    seed: int
    acceleration: float
    measures: tuple[Measure, ...]
    bounds: tuple[Bound, ...]
    objectives: tuple[Objective, ...]
    curves: tuple[Curve, ...]
    keeps_all: bool
    chunk: int

    @property
    def chunks(self) -> int:
        """Return how many chunks there are."""
        return -(-self.rows // self.chunk)

    def rows_of(self, chunk: int) -> tuple[int, int]:
        """Return (first, after last) row of a chunk."""
        return chunk * self.chunk, min((chunk + 1) * self.chunk, self.rows)

    def drawn(self, start: int, stop: int) -> dict[str, Array]:
        """Return {parameter: its values} in some rows."""
        points = unit_points(self.method, (start, stop), self.seed,
                             tuple(one.of_grid for one in self.vary), self.rows)
        return {one.name: one.at(p) for one, p in zip(self.vary, points.T)}

    def scene_values(self, row: int) -> ParameterValues:
        """Return all parameters of one row."""
        drawn = self.drawn(row, row + 1)
        return {**self.values, **{name: column[0].item() for name, column in drawn.items()}}


class _Loader(yaml.SafeLoader):
    """YAML in which a key that is given twice is an error, not the last one."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        given: set[str] = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                continue                        # a list is no key: the base class says so
            if key.value in given:
                raise yaml.MarkedYAMLError(problem=f'{key.value} is given twice',
                                           problem_mark=key.start_mark)
            given.add(key.value)
        return super().construct_mapping(node, deep)


def read(path: str | Path) -> Study:
    """
    Return the :class:`Study` of a YAML file.

    Raises
    ------
    StudyError
        The file cannot be read, or an entry is wrong; the message names it.

    """
    path = Path(path)
    try:
        document = yaml.load(path.read_text(encoding='utf-8'), _Loader)
    except OSError as error:
        raise StudyError(f'{path}: {error.strerror}') from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise StudyError(f'{path}: no YAML: {" ".join(str(error).split())}') from None
    try:
        return from_document(document, path.parent)
    except InvalidParameter as error:
        raise StudyError(f'{path}: {error}') from None


def from_document(document: Yaml, folder: Path = Path()) -> Study:
    """
    Return the :class:`Study` of a mapping as YAML gives it.

    ``folder``: from where a scene's file is looked for. InvalidParameter if an entry is wrong.
    """
    if not isinstance(document, dict):
        raise InvalidParameter('study', document, f'must be a mapping of {", ".join(KEYS)}')
    for key in document:
        if key not in KEYS:
            raise InvalidParameter(str(key), None, f'unknown entry{nearest(str(key), KEYS)}')
    scene = _scene(document.get('scene'), folder)
    vary = _vary(document.get('vary'), scene)
    method = choice_of('method', document.get('method', 'sobol'), METHODS)
    measures = Measures(scene)
    bounds = _bounds(document.get('constraints', {}), measures, scene)
    objectives = _objectives(document.get('objectives', {}), measures)
    curves = _curves(document.get('curves', {}), scene)
    asked = [measure for name in list_of('quantities', document.get('quantities', []))
             for measure in measures.named('quantities', str(name))]
    columns = merged([*asked, *(bound.measure for bound in bounds),
                      *(objective.measure for objective in objectives)])
    if not columns and not curves:
        raise InvalidParameter('quantities', None, 'must be given (or constraints, objectives or '
                                                   'curves): what is to be computed?')
    rows = _rows(document.get('rows'), method, vary)
    study = Study(dict(scene.values), vary, method, rows,
                  integer_of('seed', document.get('seed', 0), 0, 2**63 - 1),
                  number_of('acceleration', document.get('acceleration', 0.0)), columns, bounds,
                  objectives, curves,
                  choice_of('keep', document.get('keep', KEEP[0]), KEEP) == 'all',
                  integer_of('chunk', document.get('chunk', CHUNK), 1, LARGEST))
    _require_a_design(study)
    return study


def _require_a_design(study: Study) -> None:
    """Refuse a study of which none of the first designs can be built."""
    first = None
    tried = min(study.rows, TRIED)
    drawn = {name: column.tolist() for name, column in study.drawn(0, tried).items()}
    for row in zip(*drawn.values()):
        try:
            from_values({**study.values, **dict(zip(drawn, row))})
            return
        except InvalidParameter as error:
            first = first or error
    raise InvalidParameter('vary', None, f'none of the first {tried} designs can be built: '
                                         f'{first}')


def _scene(given: Yaml, folder: Path) -> Scene:
    if not isinstance(given, str):
        raise InvalidParameter('scene', given, 'must be a scene: a file or the name of one, as '
                                               'paper')
    beside = folder / given
    return from_values(read_values(beside if beside.is_file() else find(given)))


def _vary(given: Yaml, scene: Scene) -> tuple[Variation, ...]:
    if not isinstance(given, dict) or not given:
        raise InvalidParameter('vary', given, 'must be a mapping of parameters of the scene, as '
                                              '{linkage.a1: {range: [0.2, 0.6]}}')
    for name in given:
        if str(name).startswith('cylinder.') and scene.values['linkage.input'] != 'cylinder':
            raise InvalidParameter(f'vary.{name}', None, 'acts only with linkage.input cylinder')
    return tuple([variation(name, how, scene.values.get(name)) for name, how in given.items()])


def _rows(given: Yaml, method: str, vary: tuple[Variation, ...]) -> int:
    """Return the number of rows, checked against the method."""
    if method == 'grid':
        for one in vary:
            if one.kind in TOLERANCES:
                raise InvalidParameter(f'vary.{one.name}', one.kind,
                                       'a grid takes ranges and lists only')
        count = prod(one.levels for one in vary)
        if given is not None and given != count:
            raise InvalidParameter('rows', given, f'a grid has the product of its levels, {count}')
        if count > MOST_ROWS:
            raise InvalidParameter('vary', None, f'a grid of {count} rows is too large')
        return count
    if given is None:
        raise InvalidParameter('rows', None, f'must be given: how many designs {method} draws')
    rows = integer_of('rows', given, 1, MOST_ROWS)
    if method == 'latin_hypercube' and rows > WHOLE:
        raise InvalidParameter('rows', rows, 'a Latin hypercube is drawn whole, so at most '
                                             f'{WHOLE}; sobol has no such limit')
    if method == 'sobol' and rows > LONGEST:
        raise InvalidParameter('rows', rows, f'a sequence of Sobol has at most {LONGEST}; random '
                                             'has no such limit')
    return rows


def _bounds(given: Yaml, measures: Measures, scene: Scene) -> tuple[Bound, ...]:
    if not isinstance(given, dict):
        raise InvalidParameter('constraints', given, 'must be a mapping, as '
                                                     '{swing: {least: 0.5}}')
    return tuple([_bound(f'constraints.{name}', measures.one('constraints', name), how, scene)
                  for name, how in given.items()])


def _bound(entry: str, measure: Measure, how: Yaml, scene: Scene) -> Bound:
    if measure.part == CLASS:
        return Bound(measure, -np.inf, np.inf, _types(entry, how, scene))
    if not isinstance(how, dict) or not how or not set(how) <= {'least', 'most'}:
        raise InvalidParameter(entry, how, 'must be {least: VALUE}, {most: VALUE} or both')
    least, most = (number_of(f'{entry}.{side}', how.get(side, unbounded), unbounded)
                   for side, unbounded in (('least', -np.inf), ('most', np.inf)))
    if least > most:
        raise InvalidParameter(entry, how, 'least is more than most: no design can fulfil it')
    low, high = limits(measure)
    if least > high or most < low:
        raise InvalidParameter(entry, how, f'no design can fulfil it: {measure.name} lies in '
                                           f'[{low:g}, {high:.6g}] {measure.unit}'.rstrip())
    return Bound(measure, least, most)


def _types(entry: str, given: Yaml, scene: Scene) -> tuple[str, ...]:
    """Return the types that are allowed, each a part of the name of one that exists."""
    asked = [given] if isinstance(given, str) else given if isinstance(given, list) else []
    texts = [text for text in asked if isinstance(text, str)]
    if not texts or len(texts) < len(asked):
        raise InvalidParameter(entry, given, 'must be a type or a list of types, as '
                                             '[crank-rocker]')
    known = _known_types(scene)
    for text in texts:
        if not any(text in name for name in known):
            raise InvalidParameter(entry, text, f'no type of a {scene.linkage.TITLE}'
                                                f'{nearest(text, known)}')
    return tuple(texts)


def _known_types(scene: Scene) -> list[str]:
    """Return the names of all types of the scene's kind: those of a few ratios of its lengths."""
    names = scene.linkage.length_names if scene.values['linkage.kind'] in KINDS else ()
    found = {scene.linkage.classification: None}
    for lengths in product(RATIOS, repeat=len(names)):
        with suppress(InvalidParameter):
            other = from_values({**scene.values, **{f'linkage.{name}': length
                                                    for name, length in zip(names, lengths)}})
            found[other.linkage.classification] = None
    return list(found)


def _objectives(given: Yaml, measures: Measures) -> tuple[Objective, ...]:
    if not isinstance(given, dict):
        raise InvalidParameter('objectives', given, 'must be a mapping, as '
                                                    '{shaking_force.max: minimize}')
    found = []
    for name, sense in given.items():
        measure = measures.one('objectives', str(name))
        if measure.part == CLASS:
            raise InvalidParameter('objectives', name, 'is text and cannot be minimized')
        found.append(Objective(measure, choice_of(f'objectives.{name}', sense, SENSES)))
    return tuple(found)


def _curves(given: Yaml, scene: Scene) -> tuple[Curve, ...]:
    if not isinstance(given, dict):
        raise InvalidParameter('curves', given, 'must be {NAME OF A POINT: SAMPLES}')
    for name in given:
        if name not in scene.points:
            has = f'has {", ".join(scene.points)}' if scene.points else 'has none'
            raise InvalidParameter(f'curves.{name}', None, f'no point of the scene, which {has}')
    return tuple([Curve(name, integer_of(f'curves.{name}', samples, 1, MOST_SAMPLES))
                  for name, samples in given.items()])


def list_of(entry: str, given: Yaml) -> list[Yaml]:
    """Return a list."""
    if not isinstance(given, list):
        raise InvalidParameter(entry, given, 'must be a list, as [shaking_force, swing]')
    return given


def choice_of(entry: str, given: Yaml, choices: tuple[str, ...]) -> str:
    """Return one of some texts."""
    if given not in choices:
        raise InvalidParameter(entry, given, f'must be one of {", ".join(choices)}')
    return str(given)


def integer_of(entry: str, given: Yaml, low: int, high: int) -> int:
    """Return an integer within limits; 1e7 may be a float or a text in YAML."""
    if isinstance(given, float) and given.is_integer():      # 1e7 is a float in YAML 1.2
        given = int(given)
    if isinstance(given, str) and given.replace('e', '', 1).replace('.', '', 1).isdigit():
        return integer_of(entry, float(given), low, high)      # and a text in YAML 1.1
    if isinstance(given, bool) or not isinstance(given, int) or not low <= given <= high:
        raise InvalidParameter(entry, given, f'must be an integer from {low} to {high}')
    return given


def number_of(entry: str, given: Yaml, unbounded: float = 0.0) -> float:
    """Return a finite number; ``unbounded`` itself, an infinity, passes."""
    if given is unbounded:
        return unbounded
    if isinstance(given, bool) or not isinstance(given, (int, float)) or not isfinite(given):
        raise InvalidParameter(entry, given, 'must be a finite number')
    return float(given)
