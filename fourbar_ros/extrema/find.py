# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
All extrema of motion and loads over the input, for any linkage and mode.

Tests check that none is missed. ``certify`` proves it, or the result says that it is not proved.

The search is :mod:`fourbar_ros.extrema.path_search`. The ends of the input range count too:
toggles, where quantities are unbounded, as joint reactions are at the flat positions of change
points. Quantities that go on there are searched through them.
"""
from collections.abc import Callable, Collection, Iterable, Sequence
from functools import partial
from math import inf, isfinite, isnan, nan
from typing import Any, NamedTuple

from fourbar_ros.errors import in_words, InvalidParameter, MissingBodies
from fourbar_ros.extrema.input_paths import input_paths, InputPath, unresolved
from fourbar_ros.extrema.path_search import jumps_along, PathExtremum, search_path
from fourbar_ros.extrema.proof import NOT_PROVED, Proof, prove
from fourbar_ros.extrema.sampling import DifferenceSampler, Sampler
from fourbar_ros.mechanisms import quantities as table
from fourbar_ros.mechanisms.elements import UserForce
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NoLoads, Quantity
from fourbar_ros.mechanisms.pieces import Pieces
from fourbar_ros.mechanisms.quadrature import nodes
from fourbar_ros.mechanisms.quantities import Asked, Function, is_position, Named, OfDrive
from fourbar_ros.notebook import html_table
from fourbar_ros.numerics.arguments import finite, rate_of_input
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.roots import fold
import numpy as np

MINIMUM, MAXIMUM, CONSTANT = 'minimum', 'maximum', 'constant'
INTERIOR, LIMIT = 'interior', 'limit'
_KINDS = {-1: MINIMUM, 1: MAXIMUM, 0: CONSTANT}

SAMPLES = 256       # points of a full turn, at least

# A condition larger than this is that of a linkage that is nearly a change point.
TRUSTED = 1e6
# Values that differ by more than the error of this condition are told apart, whatever theirs is.
MOST_ALIKE = 1e3
# A rate of the output that is smaller than this, over its largest, only touches zero.
TOUCHES = 64.0 * EPS

MOST_LINES = 8      # of the repr of a list of extrema, between its rates and the count of the rest
SIDES = {0: '', 1: 'from above', -1: 'from below'}      # as the input is approached


class Extremum(NamedTuple):
    """
    One extremum of one quantity in one assembly mode.

    ``kind``: 'minimum', 'maximum', or 'constant': the same value over a whole range, from
    ``theta1`` on. ``theta1``: crank angle [rad], in [0, 2 pi), or to 4 pi of a change point that
    repeats after two turns. ``value``: in the quantity's unit; +-inf at an end where the quantity
    is unbounded. ``is_global``: no other minimum (maximum) of the quantity in this mode is lower
    (higher). Values within 4 eps of their condition, at most 1e-12 of them, count as equal.

    ``place``: 'interior'; 'limit': where the range of the input ends, at a toggle, an end of the
    stroke or one of ``within``, or where a load has a pole, at a flat position of a change point,
    or jumps, by friction that changes its direction or a force that steps, begins or ends.
    ``side``: +1 (-1): the input is approached from above (below); 0 in the interior.

    ``condition``, ``value_condition``: if each link length is wrong by a relative eps, the input
    moves by up to eps * condition [rad or m] and ``value`` by up to the relative eps *
    value_condition. NaN at ends, and of a change point, which linkages of other lengths are not.

    ``proof``: whether it is proved that no extremum inside the range is missing: '' if not asked,
    'interval bounds ...', or 'not proved: ...'. Of a constant whose rounding may hide extrema
    always 'not certain: ...', with the bound of its errors. ``slide``: the driven slide [m],
    ``theta1`` is then the crank's angle; NaN if the crank is driven.
    """

    quantity: str
    unit: str
    mode: int
    kind: str
    theta1: float
    value: float
    is_global: bool
    place: str = INTERIOR
    side: int = 0
    condition: float = nan
    value_condition: float = nan
    proof: str = ''
    slide: float = nan

    @property
    def input(self) -> float:
        """Return the driven joint there: ``theta1`` [rad], or the slide [m]."""
        return self.theta1 if isnan(self.slide) else self.slide


class ExtremaList(list[Extremum]):
    """A list of extrema that a prompt and a notebook show as a table, with rates and mode."""

    def __init__(self, extrema: Iterable[Extremum], title: str) -> None:
        super().__init__(extrema)
        self.title = title

    def _rows(self) -> list[tuple[str, ...]]:
        return [(each.quantity, each.kind, f'{each.value:.10g}', each.unit, f'{each.input:.10g}',
                 'rad' if isnan(each.slide) else 'm', SIDES[each.side],
                 'global' if each.is_global else '') for each in self]

    def __repr__(self) -> str:
        """Return rates and mode, and a line for each of the first eight."""
        if not self:
            return '[]'
        lines = [f'{quantity} {kind} {value} {unit} at {at} {of_input}'
                 + ''.join(f', {text}' for text in (side, share) if text)
                 for quantity, kind, value, unit, at, of_input, side, share
                 in self._rows()[:MOST_LINES]]
        more = len(self) - MOST_LINES
        return '\n'.join([f'{self.title}:', *lines, *[f'... and {more} more'] * (more > 0)])

    def _repr_html_(self) -> str:
        return f'<p>{self.title}</p>' + html_table(
            ('quantity', '', 'value', 'unit', 'input', '', '', ''), self._rows())


# Quantities that are asked for: names, Quantity or functions (motion, loads) -> value.
AskedQuantity = str | Named | Callable[..., Any]
AskedQuantities = AskedQuantity | Collection[AskedQuantity]


def find_extrema(linkage: Mechanism, quantities: AskedQuantities = (), rate: float = 1.0,
                 acceleration: float = 0.0, certify: bool = False, conditions: bool = True,
                 check: Callable[[], None] = lambda: None, seconds: float = 5.0,
                 progress: Callable[[float], None] = lambda share: None,
                 within: tuple[float, float] | None = None) -> ExtremaList:
    """
    Return all extrema over the input, in the mode of the linkage, by quantity, then by input.

    ``quantities``: names (see :func:`~fourbar_ros.mechanisms.quantities.by_name`), Quantity or
    functions (Motion, Loads) -> value, one or several. Functions are located to about 1e-10 rad by
    differences; their attributes ``unit`` and ``__name__`` are used. Empty: all rates,
    accelerations and loads for which the linkage has data; positions only by name.
    ``rate``, ``acceleration``: of the input, the same everywhere, [rad/s] and [rad/s^2], or [m/s]
    and [m/s^2] of a driven slide; at most 1e100 in size. ``within``: lowest and highest input [rad
    or m]; of angles at most a turn apart, so (-0.5, 0.5) goes through zero. The values at both
    count too, as 'limit'; what lies beyond the input range is left out. ``conditions``: also
    compute condition numbers, which takes a quarter of the time; else they are NaN.

    ``certify``: also prove that none is missing, see :mod:`fourbar_ros.extrema.proof`, with
    python-flint: tenths of a second for all quantities together, seconds for those of a machine.
    ``seconds``: time of a processor that a proof may take, for each quantity [s]; then it says so.
    ``check`` is called between the pieces of the work, during a proof every tenth of a second or
    so; an exception from it ends the search. So is ``progress``, with the share of a proof that is
    done. Raises InvalidParameter, and UnknownQuantity of a name.
    """
    if not isinstance(linkage, Mechanism):
        raise InvalidParameter('linkage', linkage, 'must be a mechanism: FourBar, SliderCrank, '
                                                   'InvertedSlider, ScotchYoke or Machine')
    rate, acceleration = map(rate_of_input, ('rate', 'acceleration'), (rate, acceleration))
    seconds = inf if seconds == inf else finite('seconds', seconds)
    named, unit = resolve(quantities, linkage), linkage.input_coordinate.unit
    title = f'mode {linkage.mode}'
    if not all(quantity.rate is not None if isinstance(quantity, OfDrive) else
               is_position(quantity)
               for quantity in named):      # else what is asked has no rate, or one of its own
        change = f' and {acceleration:g} {unit}/s^2' if acceleration else ''
        title = f'at {rate:g} {unit}/s{change}, {title}'
    others = [quantity for quantity in named if not isinstance(quantity, OfDrive)]
    if len(others) < len(named):
        find = partial(find_extrema, certify=certify, conditions=conditions, check=check,
                       seconds=seconds, progress=progress, within=within)
        every = list(find(linkage, others, rate, acceleration)) if others else []
        every += [extremum for quantity in named if isinstance(quantity, OfDrive)
                  for extremum in _of_drive(quantity, linkage, rate, find)]
        names = [quantity.name for quantity in named]
        return ExtremaList(sorted(every, key=lambda extremum: names.index(extremum.quantity)),
                           title)
    check()
    part = None if within is None else _checked_part(linkage, within)
    search = Search(linkage, others, (rate, acceleration), part)
    if not search.paths:
        raise InvalidParameter('within', within, 'the links close at none of these inputs, but in '
                               + in_words(linkage.input_ranges, linkage.input_coordinate.unit))
    extrema, proofs, refuted = search.extrema(conditions), [''] * len(others), set[int]()
    if certify:
        def tell(share: float) -> None:
            check()
            progress(share)
        extrema, proofs, refuted = search.proved(extrema, conditions, tell, seconds)
    return ExtremaList(
        (extremum for row, quantity in enumerate(others) if extrema[row]
         for extremum in _extrema(quantity, linkage, extrema[row], proofs[row], row in refuted,
                                  search.unresolved, partial(search.exact, row))), title)


class Search:
    """The search, and its proof, for some quantities of a mechanism at rate and acceleration."""

    # within: lowest and highest input, see input_paths; paths: those of the input; unresolved:
    # where their samples are not dense enough, in words.

    def __init__(self, linkage: Mechanism, quantities: Sequence[Asked],
                 rates: tuple[float, float], within: tuple[float, float] | None = None) -> None:
        self._linkage, self._quantities, self._rates = linkage, quantities, rates
        every_pieces, needs_loads = linkage.pieces, any(each.is_load for each in quantities)
        if needs_loads and (within is None or abs(sum(within)) > linkage.cycle):
            linkage.require_cycle()
        if linkage.friction and needs_loads:
            # few mechanisms have any
            from fourbar_ros.mechanisms.friction import locking_joints
            from fourbar_ros.mechanisms.pieces import with_friction
            if locked := linkage.locked_ranges(*rates, within):
                widest = max(locked, key=lambda bounds: bounds[1] - bounds[0])
                joints = ', '.join(locking_joints(linkage, widest, *rates))
                raise InvalidParameter(
                    'friction', joints, 'it locks the mechanism in '
                    f'{in_words(locked, linkage.input_coordinate.unit)}: loads have extrema only '
                    'between inputs without any such')
            every_pieces = with_friction(linkage, rates)
        of_users = any(isinstance(getattr(element, 'value', None), UserForce)
                       for element in linkage.elements)
        rough = [row for row, quantity in enumerate(quantities)
                 if isinstance(quantity, Function) and not quantity.is_smooth
                 or of_users and quantity.is_load]
        smooth = [row for row in range(len(quantities)) if row not in rough]
        self.unresolved = unresolved(linkage)
        # quantities that have poles at the same inputs, if any, are searched together: their
        # sampler, where they stand in the order asked, paths of the input
        self._groups = list[tuple[Sampler, list[int], list[InputPath]]]()
        for kind, every in ((Sampler, smooth), (DifferenceSampler, rough)):
            by_group: dict[tuple[Pieces | None, tuple[float, ...]], list[int]] = {}
            for pieces in (None, every_pieces) if every_pieces else (None,):
                rows = [row for row in every if not every_pieces
                        or quantities[row].is_load == (pieces is not None)]
                if linkage.flat_inputs and rows:
                    for row, poles in zip(rows, kind(linkage, [quantities[row] for row in rows],
                                                     rates).poles()):
                        by_group.setdefault((pieces, poles), []).append(row)
                elif rows:
                    by_group[pieces, ()] = rows
            for (pieces, poles), rows in by_group.items():
                sampler = kind(linkage, [quantities[row] for row in rows], rates, poles)
                paths = input_paths(linkage, SAMPLES, within, poles, pieces)
                if isinstance(sampler, DifferenceSampler) and (jumps := [
                        jump for path in paths for jump in jumps_along(sampler, path)]):
                    known = pieces or Pieces()
                    paths = input_paths(linkage, SAMPLES, within, poles, known._replace(
                        ends=(*known.ends, *jumps)))
                self._groups.append((sampler, rows, paths))
        self.paths = [path for *_, paths in self._groups for path in paths]

    def extrema(self, with_conditions: bool = True,
                more: Sequence[float] = ()) -> list[list[PathExtremum]]:
        """Return the extrema of each quantity; ``more``: further inputs to sample."""
        extrema: list[list[PathExtremum]] = [[] for _ in self._quantities]
        for sampler, rows, paths in self._groups:
            for path in paths:
                for extremum in search_path(sampler, path, with_conditions, more):
                    extrema[rows[extremum.quantity]].append(extremum)
        return extrema

    def exact(self, quantity: int, x: Sequence[float]) -> Array:
        """Return a quantity at inputs, in the unit of the input, as :meth:`.Sampler.exact`."""
        sampler, rows = next((sampler, rows) for sampler, rows, _ in self._groups
                             if quantity in rows)
        return sampler.exact(np.array(x), np.full(len(x), rows.index(quantity)))

    def proved(self, extrema: list[list[PathExtremum]], with_conditions: bool,
               check: Callable[[float], None], seconds: float
               ) -> tuple[list[list[PathExtremum]], list[str], set[int]]:
        """Return the extrema and the text of the proof of each quantity, and whose are refuted."""
        # Extrema that contradict their proof are searched once more: between the ends of the parts
        # in which the proof says that they are. extrema: results of the search of each quantity;
        # others as for prove.
        proofs = self.prove(extrema, check, seconds)
        texts = [proof.verdict(of_quantity) for proof, of_quantity in zip(proofs, extrema)]
        wrong = {row for row, proof in enumerate(proofs)
                 if texts[row].startswith(NOT_PROVED) and not proof.why_not}
        if wrong:
            ends = [end for row in wrong for part in proofs[row].parts
                    for end in (part.low, part.high)]
            again = self.extrema(with_conditions, ends)
            for row in sorted(wrong):
                text = proofs[row].verdict(again[row])
                if not text.startswith(NOT_PROVED):
                    extrema[row], texts[row] = again[row], text
                    wrong.remove(row)
        return extrema, texts, wrong

    def prove(self, extrema: list[list[PathExtremum]], check: Callable[[float], None],
              seconds: float) -> list[Proof]:
        """Return a proof of each quantity, see :func:`fourbar_ros.extrema.proof.prove`."""
        proofs: dict[int, Proof] = {}
        for sampler, rows, paths in self._groups:
            done, part = len(proofs) / len(extrema), len(rows) / len(extrema)

            def tell(share: float, done: float = done, part: float = part) -> None:
                check(done + part * share)
            proofs |= zip(rows, prove(self._linkage, sampler.quantities, self._rates, paths,
                                      [extrema[row] for row in rows], tell, seconds))
        return [proofs[row] for row in range(len(extrema))]


def _checked_part(linkage: Mechanism, within: Any) -> tuple[float, float]:
    """Return the two inputs of ``within`` as the mechanism counts them, or refuse them."""
    if not isinstance(within, Iterable) or len(ends := list(within)) != 2:
        raise InvalidParameter('within', within, 'must be two finite inputs')
    low, high = (finite('within', end, 'must be two finite inputs') for end in ends)
    if not low < high:
        raise InvalidParameter('within', within, 'must be two inputs, the lower one first')
    if high - low > linkage.cycle:
        raise InvalidParameter('within', within, 'must span a turn at most, two of a change point '
                                                 'that repeats after two')
    return linkage.checked_input('within', low), linkage.checked_input('within', high)


def _of_drive(quantity: OfDrive, linkage: Mechanism, rate: float,
              find: Callable[..., list[Extremum]]) -> list[Extremum]:
    """Return the extrema of a ratio of drive and output, by ``find`` as :func:`find_extrema`."""
    field, links, asked = quantity.quantity, quantity.links(linkage), [quantity.quantity]
    output = links.outputs[0].coordinate
    if quantity.is_inverse:             # where the output turns back, its rate is zero
        asked.append(Quantity(output.position, output.unit, '', False))
    every = find(links, asked, *quantity.rates(rate))
    extrema, turning = ([extremum._replace(quantity=quantity.name, unit=quantity.unit)
                         for extremum in every if extremum.quantity == name]
                        for name in (field.name, output.position))
    if not quantity.is_inverse:
        return extrema
    # one over a rate: infinite on both sides of interior extrema of the position, and where the
    # rate only touches zero; poles: (where, on which side, whether it is inf or -inf there)
    largest = max([abs(extremum.value) for extremum in extrema if isfinite(extremum.value)],
                  default=0.0)
    inverse = list[Extremum]()
    poles = [(extremum, side, sense if side < 0 else -sense) for extremum in turning
             if extremum.place == INTERIOR and extremum.kind != CONSTANT
             for side in (-1, 1) for sense in [1 if extremum.kind == MAXIMUM else -1]]
    for extremum in extrema:
        if extremum.kind == CONSTANT:
            inverse.append(extremum._replace(
                value=1.0 / extremum.value if extremum.value else nan))
        elif abs(extremum.value) <= TOUCHES * largest:
            poles += [(extremum, side, 1 if extremum.kind == MINIMUM else -1)
                      for side in ([extremum.side] if extremum.side else (-1, 1))]
        else:
            inverse.append(extremum._replace(value=1.0 / extremum.value + 0.0, kind=(
                MAXIMUM if extremum.kind == MINIMUM else MINIMUM)))
    inverse += [extremum._replace(kind=_KINDS[sense], value=sense * inf, place=LIMIT, side=side,
                                  value_condition=nan) for extremum, side, sense in poles]
    inverse.sort(key=lambda extremum: (extremum.input, extremum.side))
    for sense in (-1, 1):
        values = {i: sense * extremum.value for i, extremum in enumerate(inverse)
                  if extremum.kind in (_KINDS[sense], CONSTANT)}
        greatest = _greatest(values, relative_error(MOST_ALIKE)) if values else set()
        inverse = [extremum._replace(is_global=i in greatest)
                   if extremum.kind == _KINDS[sense] else extremum
                   for i, extremum in enumerate(inverse)]
    return inverse


def resolve(quantities: Any, linkage: Mechanism) -> list[Named]:
    """Return names, quantities and functions, one or several, as quantities; refuse others."""
    def is_quantity(entry: Any) -> bool:
        return isinstance(entry, (str, OfDrive)) or hasattr(entry, 'of') or callable(entry)

    if is_quantity(quantities):
        quantities = (quantities,)
    if not isinstance(quantities, Collection) or not all(map(is_quantity, quantities)):
        raise InvalidParameter('quantities', quantities, 'must be names of quantities, Quantity '
                               'or functions (motion, loads) -> value: one, or a list of them')
    if not len(quantities):
        return table.select((), linkage)
    fields = linkage.MOTION._fields + linkage.LOADS._fields
    for quantity in quantities:
        if isinstance(quantity, Quantity) and quantity.name not in fields:
            raise table.UnknownQuantity(quantity.name, fields)
    names = [quantity for quantity in quantities if isinstance(quantity, str)]
    named = iter(table.select(names, linkage) if names else ())
    every: list[Named] = [
        next(named) if isinstance(quantity, str) else
        quantity if hasattr(quantity, 'of') or isinstance(quantity, OfDrive) else
        Function(getattr(quantity, '__name__', 'quantity'), getattr(quantity, 'unit', ''), '',
                 quantity) for quantity in quantities]
    return [each._replace(is_load=_reads_loads(each.of, linkage))
            if isinstance(each, Function) and not each.is_load else each for each in every]


def _reads_loads(of: Callable[..., Any], linkage: Mechanism) -> bool:
    """Return whether a function (motion, loads) reads loads, which may repeat after more turns."""
    # at all samples, one by one if it is a function of plain numbers; no rate is zero
    x = nodes(linkage, SAMPLES)[0]
    motion = linkage.motion(x, 1.0, 1.0)
    columns = [np.broadcast_to(field, x.shape).tolist() for field in motion]
    for each in (motion, *map(linkage.MOTION._make, zip(*columns))):
        try:
            with np.errstate(all='ignore'):
                of(each, NoLoads())
        except MissingBodies:
            return True
        except Exception:       # it may raise anything: the search says what
            continue
        if each is motion:
            break
    return False


def _extrema(quantity: Asked, linkage: Mechanism, extrema: list[PathExtremum], proof: str,
             is_refuted: bool, unresolved: str,
             exact: Callable[[list[float]], Array]) -> list[Extremum]:
    """Return the extrema of a quantity as records for users, by input, the global ones marked."""
    # extrema: from the search; proof: says whether they are complete; is_refuted: the proof says
    # that they are not, so that only infinite ones are global; unresolved: where samples are not
    # dense enough; exact: see _most_extreme.
    extrema = sorted(extrema, key=lambda extremum: (extremum.x, extremum.side))
    name, symbol, mode, unit = quantity.name, quantity.unit, linkage.mode, linkage.input_unit
    is_slide = linkage.is_driven_by_slide
    lowest, low_in_doubt = _most_extreme(extrema, -1, exact)
    highest, high_in_doubt = _most_extreme(extrema, 1, exact)
    first, in_doubt = lowest | highest, low_in_doubt | high_in_doubt
    gap = (unresolved or 'extrema are missing'
           if unresolved or any(extremum.misses for extremum in extrema) else '')
    if is_refuted or gap:
        first = {i for i in first if not isfinite(extrema[i].value) or not extrema[i].sense}
    proofs = [f'not certain: constant within {extremum.spread:.1e} {symbol} at its samples, '
              'rounding errors may hide more'
              if not extremum.sense and extremum.noise else
              proof if proof and not is_refuted and not unresolved else f'not certain: {gap}'
              if gap else
              'not certain: rounding errors hide which is the most extreme' if i in in_doubt
              else proof for i, extremum in enumerate(extrema)]
    angles: list[float] = [extremum.x for extremum in extrema]
    if is_slide:        # the angles of the crank [rad]; NaN without one
        positions = unit * np.array(angles)
        # side: +1 at the lower end of a range, -1 at the upper one, 0 inside; a limit that was
        # rounded outwards has no pose: there the angle a few roundings inside serves
        inward = np.array([extremum.side for extremum in extrema]) * 4.0 * EPS * np.abs(positions)
        at_extrema, inside = (linkage.crank_angle(linkage.motion(position))
                              for position in (positions, positions + inward))
        angles = fold(np.where(np.isnan(at_extrema), inside, at_extrema)).tolist()
    return [Extremum(name, symbol, mode, _KINDS[extremum.sense], theta1, extremum.value,
                     i in first,
                     INTERIOR if not extremum.side or not extremum.sense else LIMIT,
                     extremum.side, unit * extremum.condition, extremum.value_condition, text,
                     unit * extremum.x if is_slide else nan)
            for i, (extremum, theta1, text) in enumerate(zip(extrema, angles, proofs))]


def _most_extreme(extrema: Sequence[PathExtremum], sense: int,
                  exact: Callable[[list[float]], Array]) -> tuple[set[int], set[int]]:
    """Return the indices of the lowest (``sense`` -1) or highest extrema, of those in doubt."""
    # Values are equal that differ by their last bits, or by what a rounding of the lengths changes
    # in them: by symmetry a radial engine has ten equal minima. Where errors may be larger than
    # that, exact decides: inputs -> the quantity from many digits, NaN where these are not known.
    values = {i: sense * extremum.value for i, extremum in enumerate(extrema)
              if extremum.sense != -sense and not isnan(extremum.value)}
    if not values:
        return set(), set()
    best = max(values, key=values.__getitem__)
    least = values[best] - _error(extrema[best])
    near = {i: value for i, value in values.items() if value + _error(extrema[i]) >= least}
    tolerance = relative_error(min(_condition(extrema[best]), MOST_ALIKE))
    greatest = _greatest(near, tolerance)
    if len(greatest) == len(near):
        return greatest, set()
    inner = [i for i in near if extrema[i].sense and not extrema[i].side and extrema[i].value]
    exactly = near | dict(zip(inner, (sense * exact([extrema[i].x for i in inner])).tolist()))
    if any(isnan(exactly[i]) or extrema[i].noise and not extrema[i].sense for i in near):
        return greatest, set(near)
    return _greatest(exactly, tolerance), set()


def relative_error(condition: float = 0.0) -> float:
    """Return the part of a value by which its last bits, and errors of lengths, may change it."""
    return 4.0 * EPS * (16.0 + condition)


def _greatest(values: dict[int, float], tolerance: float) -> set[int]:
    """Return the keys of the greatest values, and of those that are less by a part of them."""
    greatest = max(values.values())
    least = greatest - tolerance * abs(greatest) if isfinite(greatest) else greatest
    return {i for i, value in values.items() if value >= least}


def _error(extremum: PathExtremum) -> float:
    if not isfinite(extremum.value):
        return 0.0
    return max(extremum.noise, relative_error(_condition(extremum)) * abs(extremum.value))


def _condition(extremum: PathExtremum) -> float:
    """Return the condition of a value, 0 where it is not known or that of a change point."""
    return extremum.value_condition if extremum.value_condition < TRUSTED else 0.0
