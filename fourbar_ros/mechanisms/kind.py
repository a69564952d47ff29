# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A kind: a machine of one dyad with names, classes and closed-form ranges of its own.

A kind has three moving links, crank O1-A, coupler (or block) and output. For each of its inputs a
:class:`Drive` says which machine it is: a link is the frame, another one turns or slides in it and
is driven, and the other two are the dyad between both. Driven at the crank the frame is the
ground; driven at A it is the crank, in which the coupler turns, and output and ground are the
dyad. Angles are those between two links, so they are read from the pose of the machine whichever
link is the frame. Links that the machine takes from their other joint on are *reversed*.

Lengths are scaled by a power of two, so that no square of one overflows.
"""
from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, NamedTuple, TYPE_CHECKING

from fourbar_ros.mechanics.bodies import applied_to, Bodies, External
from fourbar_ros.mechanisms.contract import Constants, CRANK, SLIDE
from fourbar_ros.mechanisms.kinds import DERIVED, derives
from fourbar_ros.mechanisms.machine.describe.description import Numbers, RPR, RRP, RRR
from fourbar_ros.mechanisms.machine.describe.layout import Layout, Pair, PLACES, SLIDES, Stage
from fourbar_ros.mechanisms.machine.solve.dyads import Direction, Driven, ORIGIN
from fourbar_ros.mechanisms.machine.solve.frames import hangings, Poses
from fourbar_ros.mechanisms.machine.solve.pairs import make_moves
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import (
    around,
    Arrow,
    BETA,
    Coordinate,
    GROUND,
    NamedFields,
    record_type,
    THETA1,
    THETA2,
    THETA3,
    THETA4,
    total,
    TRAVEL,
)
from fourbar_ros.mechanisms.parts import (
    ORIGIN as AT_ORIGIN,
)
from fourbar_ros.mechanisms.points import FIXED, link_motion, LinkMotion, point_motion, point_of
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar

if TYPE_CHECKING:
    from fourbar_ros.mechanics.newton_euler import Needs
    from fourbar_ros.numerics.vectors import Vector

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


class Drive(NamedTuple):
    """
    The machine that a kind is when one of its coordinates is driven.

    Parameters
    ----------
    links : tuple of 4 str
        The frame, the driven link, and both links of the dyad.
    dyad : str
        'RRR', 'RRP', 'RPR' or 'RPP'.
    numbers : callable
        lengths -> the :class:`.Numbers` of the dyad.
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
    numbers: Callable[[Lengths], Numbers]
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
        is_pair = self.dyad == RRR or self.dyad in (RRP, RPR) and not is_slide
        stage = Stage('dyad', self.dyad, self.first, 1 - self.first, self.links[2:], 2,
                      Pair(0, is_slide) if is_pair else None)
        return Layout(SLIDE if is_slide else CRANK, self.links, (stage,), self.links[3])

    def make_pose(self, n: NumberType, lengths: Lengths, sign: Scalar,
                  coordinates: Sequence[Coordinate]) -> Function:
        """Return input -> (directions by coordinate, slides by coordinate, motion of the dyad)."""
        layout, numbers = self.layout, [self.numbers(lengths)]
        hanging, start = hangings(layout, numbers), self.start and self.start(lengths)
        moves, = make_moves(n, layout, numbers, [sign if self.sign > 0.0 else -sign])
        sin, cos, is_turned = n.sin, n.cos, self.turn < 0.0
        angles = [(each, [self.links.index(link) for link in ANGLES[each]],
                   len({*ANGLES[each]}.intersection(self.reversed)) == 1)
                  for each in coordinates if each in ANGLES]

        def pose(x: Scalar) -> Any:
            """Return the pose of the machine, with the angles between links of the kind."""
            if start:
                driven = Driven((x + start[0], start[1], 1.0, 0.0, 0.0, 0.0, *ALONG), (0.0, 0.0),
                                (x, 1.0, 0.0))
            else:
                c, s = cos(x), sin(x)
                c, s = (-c, -s) if is_turned else (c, s)
                driven = Driven((*ORIGIN, c, s, 1.0, 0.0), (0.0, 0.0))
            poses, directions = Poses(hanging, driven), {}
            moved = moves(*poses.hang(0))
            poses.add(0, moved)
            for coordinate, links, is_reversed in angles:
                c, s, turn, bend = poses.relation(*links)
                directions[coordinate] = (-c, -s, turn, bend) if is_reversed else (c, s, turn,
                                                                                   bend)
            return directions, {coordinate: moved.slides[3 * k:3 * k + 3]
                                for k, coordinate in enumerate(self.slides)}, moved
        return pose

    def make_forces(self, n: NumberType, lengths: Mapping[str, Scalar],
                    numbers: Numbers) -> Function:
        """
        Return (links, needs, sine, slides, drive) -> {field: reaction}.

        ``lengths``: of links; links and needs by name, those of the ground too, each about its own
        first joint.
        """
        from fourbar_ros.mechanisms.machine.solve.loads import make_backward, make_base
        layout, names = self.layout, list[str]()
        backward, base = make_backward(n, layout, [numbers]), make_base(n, layout)
        for place in PLACES:
            names += [f'{place}_x', f'{place}_y', place]
            names += [f'{place}_normal', f'{place}_couple'] * (place in SLIDES[self.dyad])
        of_base = 'base_x', 'base_y', 'base', 'base_normal', 'base_couple'
        wanted = self.fields_of_loads()
        from fourbar_ros.numerics.vectors import Vector  # linkages with masses alone

        def forces(links: Mapping[str, LinkMotion], needs: Mapping[str, Needs], sine: Scalar,
                   slides: Sequence[Scalar], drive: Scalar) -> dict[str, Scalar]:
            """Return the reactions at all joints of the machine by the names of the kind."""
            directions: list[Vector] = []
            own: list[Needs] = []
            for name in self.links:
                e, (force, moment) = Vector(links[name].cosine, links[name].sine), needs[name]
                if name in self.reversed:
                    moment, e = moment - lengths[name] * e.cross(force), -e
                directions.append(e)
                own.append(needs[name]._replace(moment=moment))
            frame, *moving = directions
            own = own[1:]
            found = dict(zip(names, backward([(*ORIGIN, e.x, e.y) for e in moving], [slides],
                                             [sine], own, drive)))
            found.update(zip(of_base, base(own[0], drive, frame)))
            return {name: -found[of] if sign < 0.0 else found[of]
                    for name, (of, sign) in wanted.items()}
        return forces

    def fields_of_loads(self) -> dict[str, tuple[str, float]]:
        """Return {field of the loads: (field of a joint of the machine, sign)}."""
        forces = [(name, *self.reactions[name]) for name in FORCES]
        return {**{f'{name}_{axis}': (f'{joint}_{axis}', sign)
                   for name, joint, sign in forces for axis in 'xy'},
                **{name: (joint, 1.0) for name, joint, _ in forces},
                **{name: of for name, of in self.reactions.items() if name not in FORCES}}


class Kind(Mechanism):
    """
    Base of the kinds, which state their fields and, for each input, a :class:`Drive`.

    ``PARTS`` are the coordinates in the order of the fields of a motion.
    """

    DRIVES: ClassVar[Mapping[str, Drive]]
    RATIOS: ClassVar[Mapping[str, Coordinate]]      # {field: coordinate, per unit of the input}
    # {'x': coordinate}: cos_x and sin_x are fields, the direction of a link
    DIRECTIONS: ClassVar[Mapping[str, Coordinate]]
    # which of these coupler and output have; '': it does not turn
    COUPLER: ClassVar[str] = 'b'
    OUTPUT: ClassVar[str] = 'y'
    FROM_HALF_A_TURN: ClassVar[Coordinate | None] = None        # it counts from there
    BODIES, EXTERNAL = Bodies, External

    @property
    def drive(self) -> Drive:
        """Return the machine that it is for its input."""
        return self.DRIVES[self.input]

    @staticmethod
    @abstractmethod
    def place_of_output(lengths: Lengths) -> tuple[Scalar, Scalar]:
        """Return the first joint of the output, or where its slide is zero [m]."""

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

    def motion_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (position, rate, acceleration) -> fields of MOTION for a number type."""
        n, drive, given, kind = numbers, self.drive, self.input_coordinate, type(self)
        unit = n.power_of_two(*constants.lengths)
        lengths = [length / unit for length in constants.lengths]
        pose = drive.make_pose(n, lengths, constants.sign, tuple(kind.PARTS))
        atan2, fabs, transmission = n.atan2, n.fabs, drive.transmission
        per = 1.0 / unit if given.unit == 'm' else 1.0
        of_output = unit if self.outputs[0].coordinate.unit == 'm' else 1.0

        def motion(position: Scalar, rate: Scalar, acceleration: Scalar) -> NamedFields:
            """Return pose, rates and accelerations."""
            v, a = rate * per, acceleration * per
            directions, slides, moved = pose(position * per)
            square, fields, ratios = v * v, list[Scalar](), {given: 1.0}
            for coordinate in kind.PARTS:
                if coordinate == given:
                    fields += (position, rate, acceleration)
                elif coordinate in slides:
                    s, d_s, dd_s = slides[coordinate]
                    fields += (unit * s, unit * (d_s * v), unit * (d_s * a + dd_s * square))
                    ratios[coordinate] = unit * d_s * per
                else:
                    c, s, turn, bend = directions[coordinate]
                    angle = (atan2(-s, -c) if coordinate == kind.FROM_HALF_A_TURN
                             else atan2(s, c))
                    fields += (angle, turn * v, turn * a + bend * square)
                    ratios[coordinate] = turn * per
            sine, cosine = (transmission(fabs, lengths, directions) if transmission
                            else (fabs(moved.sine), moved.cosine))
            fields += (atan2(sine, cosine), *[ratios[each] for each in kind.RATIOS.values()],
                       of_output * drive.condition(fabs, lengths, directions, slides))
            for coordinate in kind.DIRECTIONS.values():
                fields += directions[coordinate][:2]
            found: NamedFields = kind.MOTION._make(fields)
            return found
        return motion

    def link_motion(self, motion: NamedFields, link: str) -> LinkMotion:
        """Return the motion of a link by name, its first joint O1, A, and O4 or B."""
        return self._links(self.lengths, motion)[link]

    def _links(self, lengths: Lengths, motion: Any, per_unit: Scalar = 1.0,
               are_ratios: bool = False) -> dict[str, LinkMotion]:
        """
        Return the motion of the three links; ``lengths`` are ``per_unit`` times those in [m].

        ``are_ratios``: per unit of the input, without accelerations.
        """
        of = {coordinate: name for name, coordinate in self.RATIOS.items()}

        def rates(coordinate: Coordinate) -> tuple[Scalar, Scalar]:
            """Return rate and acceleration of a coordinate."""
            if not are_ratios:
                return getattr(motion, coordinate.rate), getattr(motion, coordinate.acceleration)
            return getattr(motion, of[coordinate]) if coordinate in of else 1.0, 0.0

        def turning(name: str, standing: Direction) -> tuple[Scalar, ...]:
            """Return direction, rate and acceleration of a link, ``standing`` if it stands."""
            return ((getattr(motion, f'cos_{name}'), getattr(motion, f'sin_{name}'),
                     *rates(self.DIRECTIONS[name])) if name else standing)
        crank = LinkMotion(*ORIGIN, *turning('x', ALONG))
        coupler = LinkMotion(*point_of(crank, lengths[0]), *turning(self.COUPLER, UP))
        x, y = self.place_of_output(lengths)
        at = x, y, 0.0, 0.0, 0.0, 0.0
        if not self.OUTPUT:
            velocity, acceleration = rates(TRAVEL)
            at = (motion.slide * per_unit, y, velocity * per_unit, 0.0, acceleration * per_unit,
                  0.0)
        return dict(zip(LINKS, (crank, coupler, LinkMotion(*at, *turning(self.OUTPUT, ALONG)))))

    # --- loads ----------------------------------------------------------------------------------

    @derives
    def loads_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (fields of MOTION) -> fields of LOADS for constants of a number type."""
        # of linkages with masses alone
        from fourbar_ros.mechanics.newton_euler import about_first_joint, Needs, needs_of
        from fourbar_ros.mechanisms.machine.solve.loads import make_drive_and_shaking
        from fourbar_ros.numerics.vectors import Vector
        n, drive, is_slide = numbers, self.drive, self.is_driven_by_slide
        unit = n.power_of_two(*constants.lengths)
        lengths, per_unit = [length / unit for length in constants.lengths], 1.0 / unit
        length_of = {link: length for link, name in LENGTH_OF.items()
                     for own, length in zip(self.length_names, lengths) if own == name}
        terms = {name: about_first_joint(body, unit, constants.gravity,
                                         applied_to(constants.external, name))
                 for name, body in zip(LINKS, constants.bodies)}
        balance = make_drive_and_shaking(n)
        forces = drive.make_forces(n, length_of, drive.numbers(lengths))
        sine, sign = drive.sine

        def loads(m: Any) -> Any:
            """Return the needs of the links, the drive by virtual power, then all reactions."""
            links = self._links(lengths, m, per_unit)
            needs = {name: needs_of(
                term, Vector(link.a_x, link.a_y), Vector(link.cosine, link.sine), link.omega,
                link.alpha) for (name, term), link in zip(terms.items(), links.values())}
            push, (shake_x, shake_y, shake, moment) = balance(
                self._links(lengths, m, per_unit, True).values(), needs.values())
            push = unit * push
            found = forces({**links, GROUND: FIXED},
                           {**needs, GROUND: Needs(Vector(shake_x, shake_y), moment)},
                           sign * getattr(m, sine) if sine else 1.0,
                           [getattr(m, each.position) * per_unit for each in drive.slides], push)
            drives = (0.0, push) if is_slide else (push, 0.0)
            own = (*[unit * value if name.endswith('couple') else value
                     for name, value in found.items()],
                   *drives[:1 + (SLIDE in self.INPUTS)], shake_x, shake_y, shake, unit * moment)
            return own if DERIVED else self.LOADS(*own)
        return loads


# --- shared by kinds -----------------------------------------------------------------------------

# Reactions where the crank drives the first link of the dyad.
FORWARD = {'f41': ('base', 1.0), 'f21': ('first', -1.0), 'f32': ('inner', 1.0),
           'f43': ('second', 1.0)}


def acceleration_of_b(mechanism: Kind, motion: NamedFields) -> list[Arrow]:
    """Return the arrows of A_B = A_A + A_B/A, with normal and tangential parts [m/s^2]."""
    crank, coupler = (link_motion(mechanism, motion, link) for link in ('crank', 'coupler'))
    (a1, a2), (a_a, a_b) = mechanism.lengths[:2], (
        point_motion(mechanism, motion, link, length).acceleration
        for link, length in zip(('crank', 'coupler'), mechanism.lengths))
    return [total(a_a, 'A_A'), *around(AT_ORIGIN, crank, a1 * crank.direction, 'A'),
            *around(a_a, coupler, a2 * coupler.direction, 'B/A'), total(a_b, 'A_B')]


def velocity_of_b(mechanism: Kind, motion: NamedFields) -> list[Arrow]:
    """Return the arrows of V_B = V_A + V_B/A [m/s]."""
    v_a, v_b = (point_motion(mechanism, motion, link, length).velocity
                for link, length in zip(('crank', 'coupler'), mechanism.lengths))
    return [total(v_a, 'V_A'), total(v_b, 'V_B'), Arrow(v_a, v_b - v_a, 'V_{B/A}', False)]


def results(kind: Any, motion: str, loads: str) -> tuple[Any, Any]:
    """Give a kind the types of its motion and its loads, of these names, and return them."""
    fields = kind.motion_fields()       # the directions are for this package
    kind.MOTION = record_type(motion, fields, len(fields) - 2 * len(kind.DIRECTIONS))
    kind.LOADS = record_type(loads, kind.load_fields())
    return kind.MOTION, kind.LOADS
