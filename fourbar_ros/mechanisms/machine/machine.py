# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A machine: every planar linkage that is one driven link and dyads (Assur groups of class II).

Positions go forward, dyad by dyad, forces backward; each dyad is solved in closed form.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from dataclasses import fields as fields_of
from functools import cached_property, partial
from math import nan, pi, remainder
from typing import Any, ClassVar, TYPE_CHECKING

from fourbar_ros.errors import FourBarError, InvalidParameter, Toggle
from fourbar_ros.mechanics.bodies import Applied, Body, Gravity, NOT_APPLIED
from fourbar_ros.mechanisms import checks
from fourbar_ros.mechanisms.curves import LinkMotion
from fourbar_ros.mechanisms.evaluation import Constants
from fourbar_ros.mechanisms.geometry import cached_by_lengths
from fourbar_ros.mechanisms.machine import description, ranges, structure
from fourbar_ros.mechanisms.machine.description import Cylinder, Dyad
from fourbar_ros.mechanisms.machine.margins import PairRange
from fourbar_ros.mechanisms.machine.ranges import Limit, RangeEnds
from fourbar_ros.mechanisms.machine.solve.frames import driven_link, hangings, Poses
from fourbar_ros.mechanisms.machine.solve.loads import loads_of
from fourbar_ros.mechanisms.machine.solve.motion import motion_of
from fourbar_ros.mechanisms.machine.solve.pairs import shaped
from fourbar_ros.mechanisms.machine.structure import CYLINDER, DyadLengths, Layout, OF_ONE_MODE
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import CRANK, CROSSED, GROUND, NamedFields, OPEN, SLIDE
from fourbar_ros.numerics.number_types import NumberType, REAL, Scalar

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.machine.seen_from_link import SeenFromLink

DRIVERS = (CRANK, SLIDE, CYLINDER)
NO_BODY = Body(0.0)


@dataclass(frozen=True, repr=False)
class Machine(Mechanism):
    """
    One driven link and dyads, each between two points that move already.

    O1 = (0, 0): the driven crank turns about it; a driven slider moves along the x axis.

    Parameters
    ----------
    dyads : sequence of Dyad
        In order: each hangs on the ground, the driven link or dyads before it. Driven by a
        cylinder it may have none: a boom.
    input : str
        'crank': its angle; 'slide': the place of the slider; 'cylinder': the length of a cylinder
        that turns the crank.
    output : str, optional
        Name of the link that the machine is used for; not given: the last.
    cylinder : Cylinder, optional
        Given if the machine is driven by a cylinder.
    bodies : mapping {link: Body}, optional
        Links that are not named have no mass. Not given: no loads.
    gravity : tuple of 2 floats, or Base
        Field of gravity (x, y) [m/s^2], or the motion of the base.
    external : mapping {link: Applied}
        Forces and couples on links.
    stroke : tuple of 2 floats, optional
        Lowest and highest input, crank [rad], slide or cylinder [m]; of angles in any turn.
    elements : tuple
        Springs, dampers, forces over a position, of :mod:`fourbar_ros.mechanisms.elements`.
    friction : mapping {joint: JointFriction}
        By its name, as 'base' and 'd_first' of a dyad d; 'drive': a DriveFriction.
    carrier : str
        Link to which a driven crank is pinned, at the origin of that link, and from which its
        angle counts: the ground, or a link that moves. In dyads that takes the place of the
        ground, and one dyad has the ground among its links, as of a Cylinder on a moving link.
    joint_names : mapping {joint: name}
        Names of points of a scene or a drawing, which pictures show in place of letters, of 'base'
        and of 'd_first', 'd_inner' and 'd_second' of a dyad d. Joints at two points cannot have
        one name.

    Raises
    ------
    InvalidParameter
        Naming the dyad, the parameter, its value and the allowed values.

    Examples
    --------
    >>> from fourbar_ros.mechanisms.machine.description import Dyad, Point
    >>> four_bar = Machine([Dyad('d', 'RRR', Point('crank', 0.4), Point('ground', 1.0),
    ...                          ('coupler', 'rocker'), length_1=1.2, length_2=0.8)])
    >>> round(four_bar.motion(0.5, 25.0).omega_rocker, 6)
    2.390924

    """

    dyads: tuple[Dyad, ...]
    input: str = CRANK
    output: str | None = None
    cylinder: Cylinder | None = None
    bodies: Any = None
    gravity: Gravity = (0.0, 0.0)
    external: Any = field(default_factory=dict)
    stroke: tuple[float, float] | None = None
    elements: tuple[Any, ...] = ()
    friction: Any = ()
    carrier: str = GROUND
    joint_names: Mapping[str, str] = field(default_factory=dict, compare=False)

    base_layout: ClassVar[Layout]      # set when it is made; no field
    TITLE = 'machine of dyads'
    MARGIN_SIGNS = ()             # change points are not differences of lengths
    LEAVES_OUT_ZEROS = True       # most of their links have no mass or no offset
    TEXT = 'a driven link and dyads, any planar linkage of Assur groups of class II'

    @classmethod
    def from_points(cls, points: Mapping[str, Sequence[float]], links: Sequence[Sequence[str]],
                    ground: Sequence[str], *, slides: Mapping[str, float] | None = None,
                    modes: Mapping[str, int] | None = None, **options: Any) -> Machine:
        """
        Return a machine from the coordinates of its joints in one pose; modes are as drawn.

        Its frame has the axes of the drawing and its origin in the pivot of the crank. A dyad has
        the name of its inner pin, a link those of its points: 'BCE'; a block at C is 'Cblock'.

        Parameters
        ----------
        points : mapping {name: (x, y)}
            Joints, and other points of links [m].
        links : sequence of sequences of str
            Points of each link, those of the crank first: 'ABP', 'O2-A' or ('O2', 'A').
        ground : sequence of str
            Points that do not move.
        slides : mapping {pin: float}
            Pins of blocks that slide on the ground, in this direction from x [rad].
        modes : mapping {inner pin: int}
            Of dyads that lie flat in the drawing, within 0.02 rad.
        **options
            Fields of the machine, as ``bodies``.

        Raises
        ------
        InvalidParameter
            A point that is missing, links that form no dyads, a mode that cannot be read.

        """
        from fourbar_ros.mechanisms.machine.from_points import read_drawing
        return read_drawing(points, links, ground, slides, modes, **options).machine

    def __post_init__(self) -> None:
        if self.input not in DRIVERS:
            raise InvalidParameter('input', self.input, f'must be one of {", ".join(DRIVERS)}')
        dyads: Any = tuple(self.dyads) if isinstance(self.dyads, (tuple, list)) else None
        if not (dyads or dyads == () and self.input == CYLINDER) or not all(
                isinstance(dyad, Dyad) for dyad in dyads):
            raise InvalidParameter('dyads', self.dyads, 'must be one Dyad or more, in order')
        self._set(dyads=dyads, cylinder=description.checked_cylinder(self.cylinder, self.input))
        description.require_name('carrier', self.carrier)
        if self.carrier != GROUND and (self.input != CRANK
                                       or self.carrier == structure.CRANK_LINK):
            raise InvalidParameter('carrier', self.carrier, 'carries a driven crank, as another '
                                   'link; of a cylinder between moving links give cylinder.base')
        layout = description.layout_of(self.input, self.stages, self.output, self.carrier)
        self._set(base_layout=layout, output=layout.output, **structure.names_of(layout),
                  LENGTHS=tuple([length for length, _ in description.lengths_of(self.stages)]))
        by_link = description.by_link
        self._set(bodies=by_link('bodies', self.bodies, Body, self.BODIES, NO_BODY),
                  external=by_link('external', self.external or {}, Applied, self.EXTERNAL,
                                   NOT_APPLIED),
                  gravity=checks.checked_gravity(self.gravity), friction=checks.friction_of(self))
        self._require_closing()
        self._check_fit()
        if self.joint_names:
            from fourbar_ros.mechanisms.picture import outline_of, SAME  # few machines have names
            checks.check_joint_names(self.joint_names, outline_of(self, None).joints,
                                     SAME * self.input_unit)

    def _require_closing(self) -> None:
        name = self._ranges.stopped
        if name:
            dyad = next(dyad for dyad in self.stages if dyad.name == name)
            first, second = dyad.first.link, dyad.second.link
            rods = (f'; its rods are {dyad.length_1:g} and {dyad.length_2:g} m long'
                    if dyad.kind == 'RRR' else '')
            why = (f': it hangs on {first} alone, so no input moves its ends' if first == second
                   else '' if name == self.dyads[0].name else ' at which those before it do')
            raise InvalidParameter(f'dyads.{name}', None, f'cannot close at any input{why}{rods}')

    @cached_by_lengths
    def stages(self) -> tuple[Dyad, ...]:
        """Return all dyads; a cylinder is one whose slide is driven, and stands first."""
        if self.cylinder is None:
            return self.dyads
        base, pin, links, mode = self.cylinder
        return (Dyad(CYLINDER, 'RPR', pin, base, links, mode=mode), *self.dyads)

    @cached_by_lengths
    def dyad_lengths(self) -> tuple[DyadLengths, ...]:
        return tuple(shaped(REAL, self.base_layout, [dyad.lengths for dyad in self.stages]))

    @cached_by_lengths
    def layout(self) -> Layout:
        """Return the structure, with the pairs that lie flat nowhere, see :func:`.find_ranges`."""
        return self._ranges.layout or self.base_layout

    @property
    def lengths(self) -> tuple[float, ...]:
        """Return the lengths that are not zero [m]: of points, rods and offsets."""
        return tuple([value for _, value in description.lengths_of(self.stages)])

    def with_lengths(self, lengths: Sequence[float]) -> Machine:
        by_name = self.lengths_by_name(lengths)
        # a dyad that is made again checks its lengths; whether they close the ranges tell
        changed = self._with_stages([replace(description.with_lengths(dyad, by_name))
                                     for dyad in self.stages])
        changed._set(LENGTHS=tuple([
            length for length, _ in description.lengths_of(changed.stages)]))
        return changed

    def _with_stages(self, stages: Sequence[Dyad]) -> Machine:
        """Return a copy with other dyads, which are not checked."""
        # stages: as stages, the dyads and, if one drives, first the cylinder as a dyad.
        if self.cylinder is None:
            return self._copy(stages=tuple(stages), dyads=tuple(stages))
        first = stages[0]
        cylinder = self.cylinder._replace(base=first.second, pin=first.first, mode=first.mode)
        return self._copy(stages=tuple(stages), dyads=tuple(stages[1:]), cylinder=cylinder)

    @property
    def numbers_of_lengths(self) -> tuple[str, ...]:
        """Return the names of the lengths of its dyads, '' for a cosine or sine of an angle."""
        names: list[str] = []
        for dyad in self.stages:        # in the order of DyadLengths: p, q, sizes
            names += [f'{dyad.name}.{end}.{name}' for end in ('first', 'second')
                      for name in ('along', 'across')]
            for name in structure.DIMENSIONS[dyad.kind]:
                names += ('', '') if name in description.ANGLES else (f'{dyad.name}.{name}',)
        return tuple(names)

    @property
    def signs(self) -> tuple[float, ...]:
        return tuple([dyad.sign for dyad in self.stages])

    sign = signs     # type: ignore[assignment]  # one for each dyad

    @property
    def mode(self) -> int:  # type: ignore[override]  # set by those of the dyads
        """Return the modes of all dyads as one number: 1 + sum (mode - 1) 2^i, i from 0."""
        return 1 + sum((dyad.mode - 1) << i for i, dyad in enumerate(self.stages))

    def in_mode(self, mode: int) -> Machine:
        if mode == self.mode:
            return self
        if mode not in range(1, 1 + (1 << len(self.stages))):
            raise InvalidParameter('mode', mode, f'must be 1 to {1 << len(self.stages)}: '
                                   '1 + sum (mode - 1) 2^i of the modes of its dyads')
        modes = [1 + ((int(mode) - 1) >> i & 1) for i in range(len(self.stages))]
        return self._with_stages([replace(dyad, mode=its_mode)
                                  for dyad, its_mode in zip(self.stages, modes)])

    def crank_angle(self, motion: NamedFields) -> Scalar:
        angle: Scalar = motion.theta_crank if self.input != SLIDE else nan * motion.rate
        return angle

    @cached_by_lengths
    def _ranges(self) -> ranges.DyadRanges:
        """Return where all dyads close."""
        # Inputs of a slide are searched within twice the sum of all lengths, or twice the stroke.
        # An end of a range that is this bound means that no dyad limits the slide.
        size = sum(map(abs, self.lengths))
        stroke = () if self.stroke is None else checks.two_numbers('stroke', self.stroke,
                                                                   checks.STROKE)
        far = 2.0 * max([size, *map(abs, stroke)])
        closing = ranges.find_ranges(self.base_layout, self.dyad_lengths, self.signs, (-far, far),
                                     self.input_unit)
        if self.input == SLIDE and self.stroke is None and any(
                bound is not None and far in map(abs, (bound[0].x, bound[1].x))
                for bound in closing.limits):
            raise InvalidParameter('stroke', self.stroke, 'must be given: no dyad limits the '
                                                          'slide')
        return closing

    @cached_by_lengths
    def singular_inputs(self) -> list[complex]:
        real = [end.x for end in self._ends] + list(self.flat_inputs)
        return [*map(complex, real), *self._complex_toggles, *self._off_real(self._ranges.poles())]

    @cached_by_lengths
    def _complex_toggles(self) -> list[complex]:
        return self._off_real(self._ranges.toggles())

    def _off_real(self, inputs: Sequence[complex]) -> list[complex]:
        """Return complex inputs without those that are real ones, found a bit beside."""
        real = [(end.x, ranges.DOUBLE if end.is_flat else ranges.SAME) for end in self._ends]
        real += [(x, ranges.DOUBLE) for x in self.flat_inputs]
        return [z for z in inputs
                if all(abs(self.distance(z.real, x) + 1j * z.imag) > same * self.input_unit
                       for x, same in real)]

    @property
    def flat_inputs(self) -> tuple[float, ...]:
        return tuple(self._ranges.flats)

    @property
    def _has_odd_turns(self) -> bool:
        return self._ranges.turns == 2

    @property
    def flat_limits(self) -> tuple[float, ...]:
        return tuple([end.x for end in self._ends if end.is_flat])

    @property
    def closing_ranges(self) -> tuple[tuple[float, float], ...]:
        return tuple([(-pi, pi) if bound is None else (bound[0].x, bound[1].x)
                      for bound in self._ranges.limits])

    def without_stroke(self) -> Machine:
        """Return the same machine without a stroke, or with one ten times as long."""
        if self.input != SLIDE:
            return super().without_stroke()
        try:
            return replace(self, stroke=None)
        except InvalidParameter:        # no dyad limits the slide
            assert self.stroke is not None
            low, high = self.stroke
            reach = 4.5 * (high - low)      # on both sides
            return replace(self, stroke=(low - reach, high + reach))

    @property
    def limits(self) -> tuple[RangeEnds, ...]:
        """Return (low, high) of each range, with the dyads at toggles; None: full turns."""
        return self._ranges.limits

    @property
    def change_point_margin(self) -> float:
        """Return the distance of the nearest complex toggle from a range, over its size."""
        if self.flat_inputs or self.flat_limits:
            return 0.0
        return min([abs(z.imag) / self.input_unit for z in self._complex_toggles], default=1.0)

    @property
    def modes(self) -> dict[int, str]:
        """Return {mode: 'DYAD MODE, ...'}, its own alone: other ones are other machines."""
        return {self.mode: ', '.join(f'{dyad.name} {dyad.mode}' for dyad in self.stages
                                     if dyad.kind not in OF_ONE_MODE) or 'one'}

    def mode_beyond(self, limit: float) -> int:
        dyad = self._stage_at(limit)
        # of these they go on in x, not in its root
        return self.mode if self.stages[dyad].kind in OF_ONE_MODE else 1 + (
            (self.mode - 1) ^ (1 << dyad))

    @property
    def modes_passed(self) -> tuple[int, ...]:
        return tuple(sorted({self.mode, *[self.mode_beyond(end.x) for end in self._ends
                                          if end.dyad]}))

    def driven_otherwise(self) -> tuple[SeenFromLink, ...]:
        """Return the machine driven at a link on the ground, if its dyad alone stops the crank."""
        names = {end.dyad for end in self._ends}
        index = next((i for i, dyad in enumerate(self.stages) if {dyad.name} == names), None)
        if self.input != CRANK or self.layout.ground or index is None:
            return ()
        dyad = self.stages[index]
        ends = {dyad.first.link: dyad.first, dyad.second.link: dyad.second}
        # Only RRR between crank and ground turns the crank, if it hangs on neither at O1.
        if (dyad.kind != 'RRR' or set(ends) != {self.layout.driven, GROUND}
                or not all(end.along or end.across for end in ends.values())):
            return ()
        # Another pair of crank and ground that lies flat somewhere has its side by the turns of
        # the crank, which are not known where the other link is driven.
        if any(PairRange(stage, lengths).flats
               for i, (stage, lengths) in enumerate(zip(self.layout.stages, self.dyad_lengths))
               if i != index and stage.pair and {stage.first, stage.second} == {0, 1}):
            return ()
        from fourbar_ros.mechanisms.machine.seen_from_link import SeenFromLink  # torque alone
        return tuple([SeenFromLink(self.layout, self.dyad_lengths, self.signs, index, mode)
                      for mode in (CROSSED, OPEN)])

    @property
    def _ends(self) -> list[Limit]:
        return [end for bound in self.limits if bound for end in bound]

    def _stage_at(self, position: float) -> int:
        end = min(self._ends, key=lambda end: abs(self.distance(position, end.x)))
        return [dyad.name for dyad in self.stages].index(end.dyad)

    def _why_no_motion(self, position: float) -> FourBarError:
        """Return the error of all mechanisms, of a toggle with the name of its dyad."""
        error = super()._why_no_motion(position)
        name, unit = self.input_coordinate.position, self.input_coordinate.unit
        if isinstance(error, Toggle):       # at the end of a range, or where a pair lies flat
            lying_flat = next((dyad for x, dyad in self._ranges.flats.items()
                               if self.distance(position, x) == 0.0), None)
            return Toggle(name, position, unit,
                          lying_flat or self.stages[self._stage_at(position)].name)
        x, turns = position, [0.0]
        if not self.is_driven_by_slide:
            x, turns = remainder(position, 2.0 * pi), [-2.0 * pi, 0.0, 2.0 * pi]
        # Within a range all dyads close: one is so near to its toggle that floats cannot solve it.
        if self.is_in_stroke(position) and any(
                low <= x + turn <= high for low, high in self.closing_ranges for turn in turns):
            machine = self.layout, self.dyad_lengths, self.signs
            poses = Poses(hangings(REAL, *machine), driven_link(REAL, *machine, x))
            try:
                for unsolved in range(len(self.stages)):
                    poses.add(unsolved)
            except (ValueError, ZeroDivisionError):
                pass        # if none has it, it is the last
            return Toggle(name, position, unit, self.stages[unsolved].name)
        return error

    @property
    def structure(self) -> tuple[object, ...]:
        return type(self), self.layout

    @cached_property
    def constants(self) -> Constants:
        return Constants(tuple([dyad.lengths for dyad in self.stages]), self.signs, self.bodies,
                         self.gravity, self.external, self.elements,
                         tuple([friction for _, friction in self.friction]))

    def constants_of(self, lengths: Sequence[Scalar]) -> Constants:
        by_name = self.lengths_by_name(lengths)
        return self.constants._replace(lengths=tuple([
            description.with_lengths(dyad, by_name).lengths for dyad in self.stages]))

    @property
    def is_driven_by_slide(self) -> bool:
        return self.input != CRANK

    def motion_in(self, n: NumberType, constants: Constants, position: Scalar, rate: Scalar,
                  acceleration: Scalar) -> NamedFields:
        lengths = shaped(n, self.layout, constants.lengths)
        return self.MOTION._make(motion_of(n, self.layout, lengths, constants.sign, position, rate,
                                           acceleration))

    def joint_loads(self, n: NumberType, constants: Constants, motion: NamedFields,
                    reports: list[Any] | None = None) -> Any:
        return loads_of(n, self.layout, constants.lengths, constants.bodies, constants.gravity,
                        constants.external, motion,
                        self.friction_in(n, constants, 1.0, reports, motion.rate)
                        if self.friction else None)

    @property
    def classification(self) -> str:
        return ' + '.join(dyad.kind for dyad in self.dyads) or 'cylinder on a crank'

    def link_motions(self, motion: NamedFields, lengths: Any = None) -> dict[str, LinkMotion]:
        return {link.name: self.link_motion(motion, link.name) for link in self.LINKS}

    def link_motion(self, motion: NamedFields, link: str) -> LinkMotion:
        # the others of a large machine need not be made
        i = self.MOTION._fields.index(f'x_{self.link(link).name}')
        return LinkMotion(*tuple(motion)[i:i + 10]).at(motion.rate, motion.acceleration)

    def transmission_sine(self, motion: NamedFields) -> Scalar:
        """Return the product of the sines of all dyads: zero where one is in line."""
        fields = tuple(motion)
        product: Scalar = 1.0 + (fields[-1] - fields[-1])
        for sine in fields[len(fields) - len(self.stages):]:
            product = product * sine
        return product

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how to unpickle it: made again from its fields, as its types are made with it."""
        fields = {field.name: getattr(self, field.name) for field in fields_of(self)}
        for name in ('bodies', 'external'):
            fields[name] = fields[name] and fields[name]._asdict()
        return partial(Machine, **fields), ()
