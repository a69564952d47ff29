# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A study: a scene, its variations, and the measures to compute, keep and rank.

Read from YAML and checked as a whole before anything is computed. In the checks ``entry`` is the
name of an entry in the study, ``value`` its value in YAML; InvalidParameter names the entry and
says what is allowed.
"""
from dataclasses import dataclass
from math import inf, isfinite, prod
from pathlib import Path
import warnings

from fourbar_lab.studies import variation
from fourbar_lab.studies.measures import CLASS, Measure, Measures
from fourbar_lab.studies.variation import METHODS, MOST_ROWS, TOLERANCES, Variation, Yaml
from fourbar_ros.errors import FourBarError, InvalidParameter, nearest, SceneWarning
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.files import document_of, PlainYaml
from fourbar_ros.scene.linkage import in_other_units
from fourbar_ros.scene.parameters import as_number, with_unit
from fourbar_ros.scene.scene import from_values, load, Scene
from fourbar_ros.scene.settings import ParameterValues
import numpy as np

KEYS = ('scene', 'vary', 'method', 'rows', 'seed', 'acceleration', 'quantities', 'constraints',
        'objectives', 'keep', 'chunk')
KEEP = ('feasible', 'all')
SENSES = ('minimize', 'maximize')
# Rows that are computed, kept and lost together: seconds of work.
CHUNK = 8192
LARGEST_CHUNK = 2**20
TRIED = 1000        # first designs; at least one must be possible


class StudyError(FourBarError, ValueError):
    """A study cannot be run, continued or read; the message gives the reason."""


@dataclass(frozen=True)
class Bound:
    """A constraint: a measure between two values, or a text that contains one of some texts."""

    measure: Measure
    least: float
    most: float
    texts: tuple[str, ...] = ()

    def allows(self, value: float | str) -> bool:
        """Return whether a value of the measure fulfils it; infinities and NaN never do."""
        if isinstance(value, str):
            return any(text in value for text in self.texts)
        return isfinite(value) and self.least <= value <= self.most

    def allows_each(self, columns: dict[str, Array]) -> Array:
        """Return which of n designs fulfil it, shape (n,), from {measure: values, shape (n,)}."""
        return np.array([self.allows(value) for value in columns[self.measure.name].tolist()])


@dataclass(frozen=True)
class Study:
    """A study whose entries were checked."""

    values: ParameterValues             # every parameter of the scene
    vary: tuple[Variation, ...]
    method: str                         # how designs are drawn, see variation.py
    rows: int                           # how many designs
    seed: int
    acceleration: float                 # of the input, whose rate is drive.speed
    measures: tuple[Measure, ...]       # all columns, of constraints and objectives too
    bounds: tuple[Bound, ...]
    objectives: dict[str, str]          # {measure: one of SENSES}
    keeps_all: bool                     # keep rows that do not fulfil the constraints too
    chunk: int                          # rows that are computed together

    @property
    def chunks(self) -> int:
        return -(-self.rows // self.chunk)

    def rows_of(self, chunk: int) -> range:
        return range(chunk * self.chunk, min((chunk + 1) * self.chunk, self.rows))

    def drawn(self, start: int, stop: int) -> dict[str, Array]:
        """Return {parameter that varies: its values in rows start to stop - 1, shape (n,)}."""
        points = variation.unit_points(self.method, (start, stop), self.seed,
                                       tuple(varied.of_grid for varied in self.vary))
        return {varied.name: varied.quantiles(p) for varied, p in zip(self.vary, points.T)}


def read(path: str | Path) -> Study:
    """Return the :class:`Study` of a YAML file; a FourBarError if it is wrong."""
    path = Path(path)
    try:
        return from_document(document_of(path, PlainYaml)[1], path.parent)
    except InvalidParameter as error:
        raise StudyError(f'{path}: {error}') from None


def from_document(document: Yaml, folder: Path = Path()) -> Study:
    """Return the :class:`Study` of a mapping from YAML; ``folder`` is where its scene may be."""
    document = mapping_of('study', document, KEYS)
    name = document.get('scene')
    if not isinstance(name, str):
        raise InvalidParameter('scene', name, 'must be a scene: a file or the name of one, as '
                                              'paper')
    # a file beside the study goes before a shipped scene; it may be named FILE:NODE
    beside = str(folder / name)
    is_there = Path(beside).is_file() or Path(beside.rpartition(':')[0]).is_file()
    scene = load(beside if is_there else name)
    vary = tuple([variation.variation(name, entry, scene.values)
                  for name, entry in mapping_of('vary', document.get('vary')).items()])
    if not vary:
        raise InvalidParameter('vary', None, 'must name a parameter of the scene, as '
                                             '{linkage.a1: {range: [0.2, 0.6]}}')
    method = choice_of('method', document.get('method', 'sobol'), METHODS)
    measures = Measures(scene)
    bounds = tuple([_bound(measures.single('constraints', name), limits) for name, limits
                    in mapping_of('constraints', document.get('constraints', {})).items()])
    ranked = {measures.single('objectives', name): sense for name, sense
              in mapping_of('objectives', document.get('objectives', {})).items()}
    for measure in ranked:
        if measure.part == CLASS:
            raise InvalidParameter('objectives', CLASS, 'is text and cannot be minimized')
    objectives = {measure.name: choice_of(f'objectives.{measure.name}', sense, SENSES)
                  for measure, sense in ranked.items()}
    names = document.get('quantities', [])
    if not isinstance(names, list):
        raise InvalidParameter('quantities', names, 'must be a list, as [shaking_force, swing]')
    asked = [measure for name in names for measure in measures.named('quantities', str(name))]
    columns = tuple(dict.fromkeys([*asked, *(bound.measure for bound in bounds), *ranked]))
    if not columns:
        raise InvalidParameter('quantities', None, 'must be given (or constraints or objectives): '
                                                   'what is to be computed?')
    rows, levels = document.get('rows'), prod(varied.levels for varied in vary)
    if method != 'grid':
        rows = integer_of('rows', rows, 1, MOST_ROWS[method])
    elif any(varied.kind in TOLERANCES for varied in vary):
        raise InvalidParameter('method', method, 'takes ranges and lists only')
    elif rows not in (None, levels) or levels > MOST_ROWS[method]:
        raise InvalidParameter('rows', rows, f'a grid has the product of its levels, {levels}, '
                                             f'at most {MOST_ROWS[method]}')
    unit = scene.linkage.input_coordinate.units[2]
    study = Study(
        values=dict(scene.values), vary=vary, method=method,
        rows=levels if method == 'grid' else rows,
        seed=integer_of('seed', document.get('seed', 0), 0, 2**63 - 1),
        acceleration=finite('acceleration', as_number(
            'acceleration', document.get('acceleration', 0.0), unit)),
        measures=columns, bounds=bounds, objectives=objectives,
        keeps_all=choice_of('keep', document.get('keep', KEEP[0]), KEEP) == 'all',
        chunk=integer_of('chunk', document.get('chunk', CHUNK), 1, LARGEST_CHUNK))
    tried = min(study.rows, TRIED)
    try:
        first_scene(study, study.drawn(0, tried))
    except InvalidParameter as error:
        raise InvalidParameter('vary', None, f'none of the first {tried} designs can be built: '
                                             f'{error}') from None
    typed = with_unit({varied.name: document['vary'][varied.name][varied.kind] for varied in vary})
    for line in in_other_units([(varied.name, value, varied.unit) for varied in vary
                                if varied.name not in typed for value in varied.values],
                               scene.linkage):
        warnings.warn(f'vary: {line}', SceneWarning, stacklevel=3)
    return study


def first_scene(study: Study, drawn: dict[str, Array]) -> Scene:
    """Return the scene of the first design that can be built, or raise why the first cannot."""
    errors = []
    for row in zip(*(column.tolist() for column in drawn.values())):
        try:
            return from_values({**study.values, **dict(zip(drawn, row))})
        except InvalidParameter as error:
            errors.append(error)
    raise errors[0]


def _bound(measure: Measure, value: Yaml) -> Bound:
    entry = f'constraints.{measure.name}'
    if measure.part == CLASS:
        texts = value if isinstance(value, list) else [value]
        if not texts or not all(isinstance(text, str) for text in texts):
            raise InvalidParameter(entry, value, 'must be a type or a list of types, as '
                                                 '[crank-rocker]')
        return Bound(measure, -inf, inf, tuple(map(str, texts)))
    limits = mapping_of(entry, value, ('least', 'most'))
    sides = {side: finite(f'{entry}.{side}', as_number(f'{entry}.{side}', limit, measure.unit))
             for side, limit in limits.items()}
    least, most = sides.get('least', -inf), sides.get('most', inf)
    if least > most or not sides:
        raise InvalidParameter(entry, value, 'must be {least: VALUE, most: VALUE} or one of them, '
                                             'least not more than most')
    return Bound(measure, least, most)


def mapping_of(entry: str, value: Yaml, keys: tuple[str, ...] = ()) -> dict[str, Yaml]:
    """Return a mapping; its keys must be some of ``keys``, if there are any."""
    if not isinstance(value, dict):
        allowed = f' of {", ".join(keys)}' if keys else ''
        raise InvalidParameter(entry, value, f'must be a mapping{allowed}')
    for key in value if keys else ():
        if key not in keys:
            raise InvalidParameter(f'{entry}.{key}', None, f'unknown{nearest(str(key), keys)}' if (
                key != 'levels') else 'stands in a range: vary: {linkage.a1: {range: [0.2, 0.6], '
                                      'levels: 5}}')
    return {str(key): below for key, below in value.items()}


def choice_of(entry: str, value: Yaml, choices: tuple[str, ...]) -> str:
    if value not in choices:
        raise InvalidParameter(entry, value, f'must be one of {", ".join(choices)}')
    return str(value)


def integer_of(entry: str, value: Yaml, low: int, high: int) -> int:
    """Return an integer within limits; 1e7 is a float in YAML."""
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise InvalidParameter(entry, value, f'must be an integer from {low} to {high}')
    return value
