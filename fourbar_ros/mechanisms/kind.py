# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A kind: a machine of one dyad with names, classes and closed-form ranges of its own.

A kind has three moving links, crank O1-A, coupler (or block) and output. For each of its inputs a
:class:`DrivenMachine` says which machine it is: a link is the frame, another one turns or slides
in it and is driven, and the other two are the dyad between both. Driven at the crank the frame is
the ground; driven at A it is the crank, in which the coupler turns, and output and ground are the
dyad. Angles are those between two links, so they are read from the pose of the machine whichever
link is the frame. Links that the machine takes from their other joint on are *reversed*.

Lengths are scaled by a power of two, so that no square of one overflows.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any, ClassVar, NamedTuple, TYPE_CHECKING

from fourbar_ros.mechanics.bodies import applied_to, Bodies, External
from fourbar_ros.mechanisms.curves import FIXED, LinkMotion, point_of
from fourbar_ros.mechanisms.evaluation import Constants
from fourbar_ros.mechanisms.geometry import cached_by_lengths
from fourbar_ros.mechanisms.kinds import all_loads, DERIVED
from fourbar_ros.mechanisms.machine.solve.dyads import (
    crank_of_half,
    Direction,
    Driven,
    DyadMotion,
    ORIGIN,
)
from fourbar_ros.mechanisms.machine.solve.frames import hangings, Poses
from fourbar_ros.mechanisms.machine.solve.pairs import make_moves
from fourbar_ros.mechanisms.machine.structure import (
    DyadLengths,
    JOINTS,
    Layout,
    Pair,
    SLIDES,
    Stage,
)
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import (
    BETA,
    Coordinate,
    CRANK,
    GROUND,
    NamedFields,
    Ranges,
    record_type,
    SLIDE,
    THETA1,
    THETA2,
    THETA3,
    THETA4,
    TRAVEL,
)
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar

if TYPE_CHECKING:
    from fourbar_ros.mechanics.newton_euler import Needs

LINKS = ('crank', 'coupler', 'output')
FORCES = ('f41', 'f21', 'f32', 'f43')
# {coordinate: (a link, that from which its angle counts)}
ANGLES = {THETA1: ('crank', GROUND), BETA: ('coupler', GROUND), THETA4: ('output', GROUND),
          THETA2: ('coupler', 'crank'), THETA3: ('output', 'coupler')}
# {link: name of its length, from one of its joints to the other}
LENGTH_OF = {'crank': 'a1', 'coupler': 'a2', 'output': 'a3', GROUND: 'a4'}
ALONG: Direction = (1.0, 0.0, 0.0, 0.0)
UP: Direction = (0.0, 1.0, 0.0, 0.0)

Lengths = Sequence[Scalar]
Directions = Mapping[Coordinate, Direction]


class DrivenMachine(NamedTuple):
    """
    The machine that a kind is when one of its coordinates is driven.

    Parameters
    ----------
    links : tuple of 4 str
        The frame, the driven link, and both links of the dyad.
    dyad : str
        'RRR', 'RRP', 'RPR' or 'RPP'.
    numbers, ranges, singular : callable
        lengths -> the :class:`.DyadLengths` of the dyad, ``closing_ranges``, ``singular_inputs``.
    reactions : dict
        {'f41': (joint of the machine, sign of the force there), 'guide_force': ...}.
    sine : tuple of str and float
        Field of the motion, and its sign: sine of the transmission angle of the dyad.
    condition : callable
        (fabs, lengths, directions, slides) -> condition; {coordinate: direction of its link}.
    transmission : callable, optional
        (fabs, lengths, directions) -> sine and cosine of the transmission angle, if it is not
        that of the dyad.
    slides : tuple of Coordinate
        Slides of the dyad, in order.
    reversed : tuple of str
        Links that the machine takes from their other joint on.
    start : callable, optional
        lengths -> place in the frame where a driven slide is zero; None: the driven link turns.
    turn, sign : float
        -1.0 where the driven link is half a turn from the input, where the dyad has the sign of
        the other mode.
    first : int
        Link on which the first link of the dyad hangs: 1 the driven one, 0 the frame.

    """

    links: tuple[str, str, str, str]
    dyad: str
    numbers: Callable[[Lengths], DyadLengths]
    ranges: Callable[..., Ranges]
    singular: Callable[..., list[complex]]
    reactions: Mapping[str, tuple[str, float]]
    sine: tuple[str, float]
    condition: Callable[..., Scalar]
    transmission: Callable[..., tuple[Scalar, Scalar]] | None = None
    slides: tuple[Coordinate, ...] = ()
    reversed: tuple[str, ...] = ()
    start: Callable[[Lengths], tuple[Scalar, Scalar]] | None = None
    turn: float = 1.0
    sign: float = 1.0
    first: int = 1

    @property
    def layout(self) -> Layout:
        """Return the structure of the machine."""
        is_slide = self.start is not None
        is_pair = self.dyad == 'RRR' or self.dyad in ('RRP', 'RPR') and not is_slide
        stage = Stage('dyad', self.dyad, self.first, 1 - self.first, self.links[2:], 2,
                      Pair(0, is_slide) if is_pair else None)
        return Layout(SLIDE if is_slide else CRANK, self.links, (stage,), self.links[3])

    def pose(self, n: NumberType, lengths: Lengths, sign: Scalar,
             coordinates: Iterable[Coordinate], x: Scalar
             ) -> tuple[dict[Coordinate, Direction], dict[Coordinate, tuple[Scalar, ...]],
                        DyadMotion]:
        """
        Return the pose of the machine, its angles those between links of the kind.

        {coordinate: direction}, {coordinate: slide, first and second derivative}, and how the dyad
        moves. ``x``: the input, of a slide in the unit of the lengths.
        """
        layout, numbers = self.layout, [self.numbers(lengths)]
        if self.start:
            x_0, y_0 = self.start(lengths)
            driven = Driven(LinkMotion(x + x_0, y_0, 1.0, 0.0, 0.0, 0.0, *ALONG), (0.0, 0.0),
                            slide=(x, 1.0, 0.0))
        else:
            c, s = n.cos(0.5 * x), n.sin(0.5 * x)
            driven = crank_of_half(*((-s, c) if self.turn < 0.0 else (c, s)))
        poses, directions = Poses(hangings(layout, numbers), driven), {}
        moves, = make_moves(n, layout, numbers, [sign if self.sign > 0.0 else -sign])
        moved = moves(poses.hang(0))
        poses.add(0, moved)
        for coordinate in [each for each in coordinates if each in ANGLES]:
            c, s, turn, bend = poses.relation(*map(self.links.index, ANGLES[coordinate]))
            if len({*ANGLES[coordinate]}.intersection(self.reversed)) == 1:
                c, s = -c, -s
            directions[coordinate] = c, s, turn, bend
        return directions, {coordinate: moved.slides[3 * k:3 * k + 3]
                            for k, coordinate in enumerate(self.slides)}, moved

    def forces(self, n: NumberType, numbers: DyadLengths, lengths: Mapping[str, Scalar],
               links: Mapping[str, LinkMotion], needs: Mapping[str, Needs], sine: Scalar,
               slides: Sequence[Scalar], drive: Scalar) -> dict[str, Scalar]:
        """
        Return {field: reaction} at all joints of the machine.

        ``lengths``: of links; links and needs by name, those of the ground too, each about its own
        first joint.
        """
        from fourbar_ros.mechanics.newton_euler import Needs
        from fourbar_ros.mechanisms.machine.solve.loads import force_at_base, forces_of_dyads
        from fourbar_ros.numerics.vectors import Vector
        layout, directions, all_needs = self.layout, list[Vector](), list[Needs]()
        for name in self.links:
            direction, (force, moment) = Vector(links[name].cosine, links[name].sine), needs[name]
            if name in self.reversed:       # about its other joint, from where it points back
                moment = moment - lengths[name] * direction.cross(force)
                direction = -direction
            directions.append(direction)
            all_needs.append(Needs(force, moment))
        (frame, *moving), of_moving = directions, all_needs[1:]
        forces = forces_of_dyads(
            n, layout, [numbers], [LinkMotion(*ORIGIN, e.x, e.y, 0.0, 0.0) for e in moving],
            [slides], [sine], of_moving, drive)
        at_base = force_at_base(n, layout, of_moving[0], drive, frame)
        fields = [f'{joint}{ending}' for joint in JOINTS for ending in (
            '_x', '_y', '', *(('_normal', '_couple') if joint in SLIDES[self.dyad] else ()))]
        by_field = dict(zip(fields, forces))
        by_field.update(zip(('base_x', 'base_y', 'base', 'base_normal', 'base_couple'), at_base))
        return {name: -by_field[of] if sign < 0.0 else by_field[of]
                for name, (of, sign) in self.fields_of_loads().items()}

    def fields_of_loads(self) -> dict[str, tuple[str, float]]:
        """Return {field of the loads: (field of a joint of the machine, sign)}."""
        forces = [(name, *self.reactions[name]) for name in FORCES]
        return {**{f'{name}_{axis}': (f'{joint}_{axis}', sign)
                   for name, joint, sign in forces for axis in 'xy'},
                **{name: (joint, 1.0) for name, joint, _ in forces},
                **{name: of for name, of in self.reactions.items() if name not in FORCES}}


class Kind(Mechanism):
    """
    Base of the kinds, which state their fields and, for each input, a :class:`DrivenMachine`.

    ``PARTS`` are the coordinates in the order of the fields of a motion.
    """

    DRIVES: ClassVar[Mapping[str, DrivenMachine]]
    CLASSES: ClassVar[Mapping[tuple[int, ...], str]]    # {signs of the margins: classification}
    RATIOS: ClassVar[Mapping[str, Coordinate]]      # {field: coordinate, per unit of the input}
    # {'x': coordinate}: cos_x and sin_x are fields, the direction of a link
    DIRECTIONS: ClassVar[Mapping[str, Coordinate]]
    # which of these coupler and output have; '': it does not turn
    COUPLER: ClassVar[str] = 'b'
    OUTPUT: ClassVar[str] = 'y'
    FROM_HALF_A_TURN: ClassVar[Coordinate | None] = None        # it counts from there
    BODIES, EXTERNAL = Bodies, External

    @property
    def drive(self) -> DrivenMachine:
        """Return the machine that it is for its input."""
        return self.DRIVES[self.input]

    @cached_by_lengths
    def closing_ranges(self) -> Ranges:
        """Return the ranges (low, high) of the input in which the links close [rad or m]."""
        return self.drive.ranges(*self.lengths)

    @property
    def singular_inputs(self) -> list[complex]:
        """Return the complex inputs where the dyad is in line, or quantities have a pole."""
        return self.drive.singular(*self.lengths)

    @cached_by_lengths
    def classification(self) -> str:
        """Return the type by name: which links turn fully; 'change point' if a margin is zero."""
        if 0.0 in self.margins:
            return 'change point'
        return self.CLASSES[tuple([1 if margin > 0.0 else -1 for margin in self.margins])]

    @classmethod
    def motion_fields(cls) -> tuple[str, ...]:
        """Return the names of the fields of a motion."""
        return (*[name for coordinate in cls.PARTS for name in coordinate], 'transmission_angle',
                *cls.RATIOS, 'condition',
                *[f'{part}_{name}' for name in cls.DIRECTIONS for part in ('cos', 'sin')])

    @classmethod
    def load_fields(cls) -> tuple[str, ...]:
        """Return the names of the fields of loads."""
        drive, *_ = cls.DRIVES.values()
        return (*drive.fields_of_loads(), 'driving_torque',
                *['driving_force'] * (SLIDE in cls.INPUTS), 'shaking_force_x', 'shaking_force_y',
                'shaking_force', 'shaking_moment', *[row.name for row in DERIVED])

    # --- motion ---------------------------------------------------------------------------------

    def motion_formula(self, n: NumberType, constants: Constants) -> Function:
        """Return (position, rate, acceleration) -> fields of MOTION for a number type."""
        return partial(self._motion, n, constants)

    def _motion(self, n: NumberType, constants: Constants, position: Scalar, rate: Scalar,
                acceleration: Scalar) -> NamedFields:
        """Return pose, rates and accelerations."""
        drive, driven, unit = self.drive, self.input_coordinate, n.power_of_two(*constants.lengths)
        lengths = [length / unit for length in constants.lengths]
        per = 1.0 / unit if self.is_driven_by_slide else 1.0
        v, a = rate * per, acceleration * per
        directions, slides, moved = drive.pose(n, lengths, constants.sign, self.PARTS,
                                               position * per)
        square, fields, ratios = v * v, list[Scalar](), {driven: 1.0}
        for coordinate in self.PARTS:
            if coordinate == driven:
                fields += (position, rate, acceleration)
            elif coordinate in slides:
                s, d_s, dd_s = slides[coordinate]
                fields += (unit * s, unit * (d_s * v), unit * (d_s * a + dd_s * square))
                ratios[coordinate] = unit * d_s * per
            else:
                c, s, turn, bend = directions[coordinate]
                angle = (n.atan2(-s, -c) if coordinate == self.FROM_HALF_A_TURN
                         else n.atan2(s, c))
                fields += (angle, turn * v, turn * a + bend * square)
                ratios[coordinate] = turn * per
        sine, cosine = (drive.transmission(n.fabs, lengths, directions) if drive.transmission
                        else (n.fabs(moved.sine), moved.cosine))
        of_output = unit if self.outputs[0].coordinate.unit == 'm' else 1.0
        fields += (n.atan2(sine, cosine), *[ratios[each] for each in self.RATIOS.values()],
                   of_output * drive.condition(n.fabs, lengths, directions, slides))
        for coordinate in self.DIRECTIONS.values():
            fields += directions[coordinate][:2]
        return self.MOTION._make(fields)

    def link_motion(self, motion: NamedFields, link: str) -> LinkMotion:
        """Return the motion of a link by name, its first joint O1, A, and O4 or B."""
        return self._links(self.lengths, motion)[self.link(link).name]

    def _links(self, lengths: Lengths, motion: Any, per_unit: Scalar = 1.0,
               are_ratios: bool = False) -> dict[str, LinkMotion]:
        """
        Return the motion of the three links; ``lengths`` are ``per_unit`` times those in [m].

        ``are_ratios``: per unit of the input, without accelerations.
        """
        ratio_of = {coordinate: name for name, coordinate in self.RATIOS.items()}

        def rates(coordinate: Coordinate) -> tuple[Scalar, Scalar]:
            if not are_ratios:
                return getattr(motion, coordinate.rate), getattr(motion, coordinate.acceleration)
            if coordinate not in ratio_of:      # the input
                return 1.0, 0.0
            return getattr(motion, ratio_of[coordinate]), 0.0

        def turning(name: str) -> Direction:
            """Return direction, rate and acceleration of a link, by its name in DIRECTIONS."""
            return (getattr(motion, f'cos_{name}'), getattr(motion, f'sin_{name}'),
                    *rates(self.DIRECTIONS[name]))
        crank = LinkMotion(*ORIGIN, *turning('x'))
        coupler = LinkMotion(*point_of(crank, lengths[0]),
                             *(turning(self.COUPLER) if self.COUPLER else UP))
        of_name = dict(zip(self.length_names, lengths))
        if not self.OUTPUT:
            velocity, acceleration = rates(TRAVEL)
            output = LinkMotion(motion.slide * per_unit, of_name['offset'], velocity * per_unit,
                                0.0, acceleration * per_unit, 0.0, *ALONG)
        else:
            output = LinkMotion(of_name['a4'], 0.0, 0.0, 0.0, 0.0, 0.0, *turning(self.OUTPUT))
        return dict(zip(LINKS, (crank, coupler, output)))

    def transmission_sine(self, motion: Any) -> Scalar:
        """Return the sine of the dyad's transmission angle, but for its sign: zero at toggles."""
        field, _ = self.drive.sine
        sine: Scalar = getattr(motion, field) if field else 1.0 + (motion.cos_x - motion.cos_x)
        return sine

    # --- loads ----------------------------------------------------------------------------------

    def loads_formula(self, n: NumberType, constants: Constants) -> Function:
        """Return (fields of MOTION) -> fields of LOADS for constants of a number type."""
        return partial(all_loads, self, constants, partial(self._loads, n, constants))

    def _loads(self, n: NumberType, constants: Constants, m: Any) -> tuple[Scalar, ...]:
        """Return needs of the links, then the drive by virtual power, then all reactions."""
        # of linkages with masses alone
        from fourbar_ros.mechanics.newton_euler import Needs, needs_of
        from fourbar_ros.mechanisms.machine.solve.loads import drive_and_shaking
        from fourbar_ros.numerics.vectors import Vector
        drive, is_slide = self.drive, self.is_driven_by_slide
        unit = n.power_of_two(*constants.lengths)
        lengths, per_unit = [length / unit for length in constants.lengths], 1.0 / unit
        length_of = {link: length for link, name in LENGTH_OF.items()
                     for known, length in zip(self.length_names, lengths) if known == name}
        links, needs = self._links(lengths, m, per_unit), {}
        for (name, link), body in zip(links.items(), constants.bodies):
            needs[name] = needs_of(body, unit, constants.gravity,
                                   applied_to(constants.external, name), link)
        push, (shake_x, shake_y, shake, moment) = drive_and_shaking(
            n, self._links(lengths, m, per_unit, True).values(), needs.values())
        push, (sine, sign) = unit * push, drive.sine
        forces = drive.forces(
            n, drive.numbers(lengths), length_of, {**links, GROUND: FIXED},
            {**needs, GROUND: Needs(Vector(shake_x, shake_y), moment)},
            sign * getattr(m, sine) if sine else 1.0,
            [getattr(m, each.position) * per_unit for each in drive.slides], push)
        drives = (0.0, push) if is_slide else (push, 0.0)
        return (*[unit * value if name.endswith('couple') else value
                  for name, value in forces.items()],
                *drives[:1 + (SLIDE in self.INPUTS)], shake_x, shake_y, shake, unit * moment)


# --- shared by kinds -----------------------------------------------------------------------------

# Reactions where the crank drives the first link of the dyad.
FORWARD = {'f41': ('base', 1.0), 'f21': ('first', -1.0), 'f32': ('inner', 1.0),
           'f43': ('second', 1.0)}


def results(kind: Any, motion: str, loads: str) -> tuple[Any, Any]:
    """Give a kind the types of its motion and its loads, of these names, and return them."""
    fields = kind.motion_fields()       # the directions are for this package
    kind.MOTION = record_type(motion, fields, len(fields) - 2 * len(kind.DIRECTIONS))
    kind.LOADS = record_type(loads, kind.load_fields())
    return kind.MOTION, kind.LOADS
