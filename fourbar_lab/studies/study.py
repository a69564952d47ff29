# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A study: a scene, its variations, and the measures to compute, keep and rank.

Read from YAML and checked as a whole before anything is computed. In the checks ``entry`` is the
name of an entry in the study, ``value`` what YAML gives for it; InvalidParameter names the entry
and says what is allowed.
"""
from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from itertools import product
from math import isfinite, prod
from pathlib import Path
from typing import Any

from fourbar_lab.studies.measures import CLASS, Measure, Measures
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
from fourbar_ros.scene.scene import from_values, Scene
from fourbar_ros.scene.settings import ParameterValues
import numpy as np
import yaml

KEYS = ('scene', 'vary', 'method', 'rows', 'seed', 'acceleration', 'quantities', 'constraints',
        'objectives', 'curves', 'keep', 'chunk')
KEEP = ('feasible', 'all')
SENSES = ('minimize', 'maximize')
# Rows that are computed, kept and lost together: seconds of work.
CHUNK = 8192
LARGEST_CHUNK, MOST_ROWS, MOST_SAMPLES = 2**20, 2**44, 4096
# First designs; at least one must be possible.
TRIED = 1000
# Lengths of these make every type: each link the longest or the shortest, sums equal or not.
RATIOS = (1.0, 3.0, 4.0)


class StudyError(FourBarError, ValueError):
    """A study cannot be run, continued or read; the message gives the reason."""


@dataclass(frozen=True)
class Bound:
    """A constraint: a measure between two values; of a text, which parts it must have one of."""

    measure: Measure
    least: float
    most: float
    texts: tuple[str, ...] = ()

    def allows(self, value: float | str) -> bool:
        """Return whether a value of the measure fulfils it; infinities and NaN never do."""
        if isinstance(value, str):
            return any(text in value for text in self.texts)
        return isfinite(value) and self.least <= value <= self.most


@dataclass(frozen=True)
class Objective:
    """A measure by which designs are ranked; ``sense`` is one of :data:`SENSES`."""

    measure: Measure
    sense: str


@dataclass(frozen=True)
class Curve:
    """A point of the scene whose path is kept, and at how many inputs."""

    point: str
    samples: int


@dataclass(frozen=True)
class Study:
    """A checked study."""

    values: ParameterValues             # every parameter of the scene
    vary: tuple[Variation, ...]
    method: str                         # how designs are drawn, see variation.py
    rows: int                           # how many designs
    seed: int
    acceleration: float                 # of the input, whose rate is drive.speed
    measures: tuple[Measure, ...]       # all columns, of constraints and objectives too
    bounds: tuple[Bound, ...]
    objectives: tuple[Objective, ...]
    curves: tuple[Curve, ...]
    keeps_all: bool                     # keep rows that do not fulfil the constraints too
    chunk: int                          # rows that are computed together

    @property
    def chunks(self) -> int:
        """Return how many chunks there are."""
        return -(-self.rows // self.chunk)

    def rows_of(self, chunk: int) -> tuple[int, int]:
        """Return (first, after last) row of a chunk."""
        return chunk * self.chunk, min((chunk + 1) * self.chunk, self.rows)

    def drawn(self, start: int, stop: int) -> dict[str, Array]:
        """Return {parameter that varies: its values in rows start to stop - 1, shape (n,)}."""
        points = unit_points(self.method, (start, stop), self.seed,
                             tuple(one.of_grid for one in self.vary), self.rows)
        return {one.name: one.at(p) for one, p in zip(self.vary, points.T)}

    def scene_values(self, row: int) -> ParameterValues:
        """Return all parameters of the scene that one row is."""
        drawn = self.drawn(row, row + 1)
        return {**self.values, **{name: column[0].item() for name, column in drawn.items()}}


class _Loader(yaml.SafeLoader):
    """YAML in which a key that is given twice is an error, not the last one."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """Return the dict of a mapping; an error if a key occurs twice."""
        seen: set[str] = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                continue                        # a list is no key: the base class says so
            if key.value in seen:
                raise yaml.MarkedYAMLError(problem=f'{key.value} is given twice',
                                           problem_mark=key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep)


def read(path: str | Path) -> Study:
    """Return the :class:`Study` of a YAML file; StudyError if an entry or the file is wrong."""
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
    names = document.get('quantities', [])
    if not isinstance(names, list):
        raise InvalidParameter('quantities', names, 'must be a list, as [shaking_force, swing]')
    asked = [measure for name in names for measure in measures.named('quantities', str(name))]
    columns = tuple(dict.fromkeys([*asked, *(bound.measure for bound in bounds),
                                   *(objective.measure for objective in objectives)]))
    if not columns and not curves:
        raise InvalidParameter('quantities', None, 'must be given (or constraints, objectives or '
                                                   'curves): what is to be computed?')
    rows = _rows(document.get('rows'), method, vary)
    study = Study(
        values=dict(scene.values), vary=vary, method=method, rows=rows,
        seed=integer_of('seed', document.get('seed', 0), 0, 2**63 - 1),
        acceleration=number_of('acceleration', document.get('acceleration', 0.0)),
        measures=columns, bounds=bounds, objectives=objectives, curves=curves,
        keeps_all=choice_of('keep', document.get('keep', KEEP[0]), KEEP) == 'all',
        chunk=integer_of('chunk', document.get('chunk', CHUNK), 1, LARGEST_CHUNK))
    _require_a_design(study)
    return study


def _require_a_design(study: Study) -> None:
    """Refuse a study if none of its first designs can be built: its ranges are wrong."""
    first_error = None
    tried = min(study.rows, TRIED)
    drawn = {name: column.tolist() for name, column in study.drawn(0, tried).items()}
    for row in zip(*drawn.values()):
        try:
            from_values({**study.values, **dict(zip(drawn, row))})
            return
        except InvalidParameter as error:
            first_error = first_error or error
    raise InvalidParameter('vary', None, f'none of the first {tried} designs can be built: '
                                         f'{first_error}')


def _scene(value: Yaml, folder: Path) -> Scene:
    """Return the scene of a file, looked for beside the study first, then among the shipped."""
    if not isinstance(value, str):
        raise InvalidParameter('scene', value, 'must be a scene: a file or the name of one, as '
                                               'paper')
    beside = folder / value
    return from_values(read_values(beside if beside.is_file() else find(value)))


def _vary(value: Yaml, scene: Scene) -> tuple[Variation, ...]:
    """Return the variations of a mapping {parameter: {KIND: VALUES}}."""
    if not isinstance(value, dict) or not value:
        raise InvalidParameter('vary', value, 'must be a mapping of parameters of the scene, as '
                                              '{linkage.a1: {range: [0.2, 0.6]}}')
    for name in value:
        if str(name).startswith('cylinder.') and scene.values['linkage.input'] != 'cylinder':
            raise InvalidParameter(f'vary.{name}', None, 'acts only with linkage.input cylinder')
    return tuple([variation(name, how, scene.values.get(name)) for name, how in value.items()])


def _rows(value: Yaml, method: str, vary: tuple[Variation, ...]) -> int:
    """Return the number of rows: the product of the levels of a grid, else as given."""
    if method == 'grid':
        for one in vary:
            if one.kind in TOLERANCES:
                raise InvalidParameter(f'vary.{one.name}', one.kind,
                                       'a grid takes ranges and lists only')
        count = prod(one.levels for one in vary)
        if value is not None and value != count:
            raise InvalidParameter('rows', value, f'a grid has the product of its levels, {count}')
        if count > MOST_ROWS:
            raise InvalidParameter('vary', None, f'a grid of {count} rows is too large')
        return count
    if value is None:
        raise InvalidParameter('rows', None, f'must be given: how many designs {method} draws')
    rows = integer_of('rows', value, 1, MOST_ROWS)
    if method == 'latin_hypercube' and rows > WHOLE:
        raise InvalidParameter('rows', rows, 'a Latin hypercube is drawn whole, so at most '
                                             f'{WHOLE}; sobol has no such limit')
    if method == 'sobol' and rows > LONGEST:
        raise InvalidParameter('rows', rows, f'a sequence of Sobol has at most {LONGEST}; random '
                                             'has no such limit')
    return rows


def _bounds(value: Yaml, measures: Measures, scene: Scene) -> tuple[Bound, ...]:
    """Return the constraints of a mapping {measure: {least: VALUE, most: VALUE} or types}."""
    return tuple([_bound(f'constraints.{name}', measures.one('constraints', name), limits, scene)
                  for name, limits in mapping_of('constraints', value,
                                                 'a mapping, as {swing: {least: 0.5}}').items()])


def _bound(entry: str, measure: Measure, value: Yaml, scene: Scene) -> Bound:
    """Return a constraint; one that no design can fulfil is refused."""
    if measure.part == CLASS:
        return Bound(measure, -np.inf, np.inf, _types(entry, value, scene))
    if not isinstance(value, dict) or not value or not set(value) <= {'least', 'most'}:
        raise InvalidParameter(entry, value, 'must be {least: VALUE}, {most: VALUE} or both')
    least, most = (number_of(f'{entry}.{side}', value[side]) if side in value else unbounded
                   for side, unbounded in (('least', -np.inf), ('most', np.inf)))
    if least > most:
        raise InvalidParameter(entry, value, 'least is more than most: no design can fulfil it')
    low, high = measure.limits
    if least > high or most < low:
        raise InvalidParameter(entry, value, f'no design can fulfil it: {measure.name} lies in '
                                             f'[{low:g}, {high:.6g}] {measure.unit}'.rstrip())
    return Bound(measure, least, most)


def _types(entry: str, value: Yaml, scene: Scene) -> tuple[str, ...]:
    """Return the types that are allowed, each a part of the name of one that exists."""
    asked = value if isinstance(value, list) else [value]
    texts = [text for text in asked if isinstance(text, str)]
    if not texts or len(texts) < len(asked):
        raise InvalidParameter(entry, value, 'must be a type or a list of types, as '
                                             '[crank-rocker]')
    known = _known_types(scene)
    for text in texts:
        if not any(text in name for name in known):
            raise InvalidParameter(entry, text, f'no type of a {scene.linkage.TITLE}'
                                                f'{nearest(text, known)}')
    return tuple(texts)


def _known_types(scene: Scene) -> list[str]:
    """Return the names of all types of the scene's kind, from a few ratios of its lengths."""
    names = scene.linkage.length_names if scene.values['linkage.kind'] in KINDS else ()
    types = [scene.linkage.classification]
    for lengths in product(RATIOS, repeat=len(names)):
        with suppress(InvalidParameter):
            other = from_values({**scene.values, **{f'linkage.{name}': length
                                                    for name, length in zip(names, lengths)}})
            types.append(other.linkage.classification)
    return list(dict.fromkeys(types))


def _objectives(value: Yaml, measures: Measures) -> tuple[Objective, ...]:
    """Return the objectives of a mapping {measure: minimize or maximize}."""
    objectives = []
    for name, sense in mapping_of('objectives', value,
                                  'a mapping, as {shaking_force.max: minimize}').items():
        measure = measures.one('objectives', str(name))
        if measure.part == CLASS:
            raise InvalidParameter('objectives', name, 'is text and cannot be minimized')
        objectives.append(Objective(measure, choice_of(f'objectives.{name}', sense, SENSES)))
    return tuple(objectives)


def _curves(value: Yaml, scene: Scene) -> tuple[Curve, ...]:
    """Return the curves of a mapping {point of the scene: samples}."""
    samples_of = mapping_of('curves', value, '{NAME OF A POINT: SAMPLES}')
    for name in samples_of:
        if name not in scene.points:
            has = f'has {", ".join(scene.points)}' if scene.points else 'has none'
            raise InvalidParameter(f'curves.{name}', None, f'no point of the scene, which {has}')
    return tuple([Curve(name, integer_of(f'curves.{name}', samples, 1, MOST_SAMPLES))
                  for name, samples in samples_of.items()])


def mapping_of(entry: str, value: Yaml, what: str) -> dict[str, Yaml]:
    """Return a mapping; ``what`` tells the user what it must be."""
    if not isinstance(value, dict):
        raise InvalidParameter(entry, value, f'must be {what}')
    return value


def choice_of(entry: str, value: Yaml, choices: tuple[str, ...]) -> str:
    """Return a value that must be one of some texts."""
    if value not in choices:
        raise InvalidParameter(entry, value, f'must be one of {", ".join(choices)}')
    return str(value)


def integer_of(entry: str, value: Yaml, low: int, high: int) -> int:
    """Return an integer within limits; 1e7 is a float in YAML 1.2, and a text in YAML 1.1."""
    if isinstance(value, str) and value.replace('e', '', 1).replace('.', '', 1).isdigit():
        value = float(value)
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise InvalidParameter(entry, value, f'must be an integer from {low} to {high}')
    return value


def number_of(entry: str, value: Yaml) -> float:
    """Return a finite number."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not isfinite(value):
        raise InvalidParameter(entry, value, 'must be a finite number')
    return float(value)
