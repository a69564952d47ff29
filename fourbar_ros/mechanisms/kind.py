# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A kind: a machine of one dyad with names, classes and closed-form ranges of its own.

A kind has three moving links, crank O1-A, coupler (or block) and output. For each of its inputs a
:class:`DrivenMachine` says which machine it is: a link is the frame, another one turns or slides
in it and is driven, and the other two are the dyad between both. Driven at the crank the frame is
the ground; driven at A it is the crank, in which the coupler turns, and output and ground are the
dyad. The machine's pose and its loads are those of :mod:`.machine.solve`; a kind names them.
Angles are those between two links, so they are read from the pose of the machine whichever link
is the frame. Links that the machine takes from their other joint on are *reversed*.

Lengths are scaled by a power of two, so that no square of one overflows.
"""
from abc import abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from math import pi, remainder
from typing import Any, ClassVar, NamedTuple

from fourbar_ros.mechanics.bodies import Bodies, External, NOT_APPLIED
from fourbar_ros.mechanics.newton_euler import needs_of
from fourbar_ros.mechanisms import parts
from fourbar_ros.mechanisms.checks import check_joint_names, checked
from fourbar_ros.mechanisms.curves import Direction, LinkMotion, point_of
from fourbar_ros.mechanisms.evaluation import Constants
from fourbar_ros.mechanisms.geometry import cached_by_lengths
from fourbar_ros.mechanisms.load_table import DERIVED
from fourbar_ros.mechanisms.machine.solve import dyads
from fourbar_ros.mechanisms.machine.solve.frames import driven_crank, driven_slider, pose_of
from fourbar_ros.mechanisms.machine.solve.loads import solve_loads
from fourbar_ros.mechanisms.machine.structure import DyadLengths, Layout, load_fields, Pair, Stage
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import BETA, Coordinate, THETA1, THETA2, THETA3, THETA4, TRAVEL
from fourbar_ros.numerics.number_types import NumberType, Operation, power_of_two, Scalar

# Outputs at a dead point that differ by less, as part of a turn or of the lengths, are the same.
NEAR_DEAD_POINT = 1e-6
# Nearer to an end of the stroke than this, in units of the input, the output turns back by about
# the square of that distance, which is its rounding. The search that finds the dead points of
# machines has none up to some 1e-6 from an end.
AT_END_OF_STROKE = 2.0**-22

LINKS = ('crank', 'coupler', 'output')
# {coordinate: (a link, that from which its angle counts)}
ANGLES = {THETA1: ('crank', parts.GROUND), BETA: ('coupler', parts.GROUND),
          THETA4: ('output', parts.GROUND), THETA2: ('coupler', 'crank'),
          THETA3: ('output', 'coupler')}
UP: Direction = (0.0, 1.0, 0.0, 0.0)

Lengths = Sequence[Scalar]
# Of a pose: {coordinate: direction of its link, or slide, with both derivatives}.
Coordinates = Mapping[Coordinate, Sequence[Scalar]]


class DrivenMachine(NamedTuple):
    """The machine that a kind is when one of its coordinates is driven."""

    layout: Layout      # see one_dyad(); a driven slider slides along x, at offset
    # lengths of the kind -> those of the dyad, closing_ranges, singular_inputs
    lengths: Callable[..., DyadLengths]
    ranges: Callable[..., parts.Ranges]
    singular: Callable[..., list[complex]]
    # {load of the kind: load of the machine, after '-' as it acts on the other link}
    reactions: Mapping[str, str]
    slides: tuple[Coordinate, ...] = ()     # of the dyad, in order
    # {link that the machine takes from its other joint on: name of its length}
    reversed: Mapping[str, str] = {}
    sign: float = 1.0       # -1.0 where the dyad has the sign of the other mode
    # lengths, coordinates -> cosine and sine of the transmission angle or its negative, and more;
    # None: those of the dyad
    transmission: Callable[[Lengths, Coordinates], Sequence[Scalar]] | None = None
    # number type, constants, motion, needs of links, loads of the machine -> those of them that
    # take the place of others, which would lose digits
    corrected: Callable[..., Mapping[str, Scalar]] | None = None


def one_dyad(driver: str, frame: str, driven: str, dyad: str, links: tuple[str, str],
             first: int = 1) -> Layout:
    """Return the structure of a machine of one dyad."""
    # first: on which link the first of the dyad hangs: 1 the driven one, 0 the frame.
    is_slide = driver == parts.SLIDE
    is_pair = dyad == 'RRR' or dyad in ('RRP', 'RPR') and not is_slide
    return Layout(driver, (frame, driven, *links), (Stage(
        'dyad', dyad, first, 1 - first, links, 2, Pair(0, 1, is_slide) if is_pair else None),), '')


class Kind(Mechanism):
    """Base of the kinds, which state fields and, for each input, a :class:`DrivenMachine`."""

    # PARTS are the coordinates in the order of the fields of a motion.

    DRIVES: ClassVar[Mapping[str, DrivenMachine]]
    CLASSES: ClassVar[Mapping[tuple[int, ...], str]]    # {signs of the margins: classification}
    RATIOS: ClassVar[Mapping[str, Coordinate]]      # {field: coordinate, per unit of the input}
    # {'x': coordinate}: cos_x and sin_x are fields, the direction of a link
    DIRECTIONS: ClassVar[Mapping[str, Coordinate]]
    # which of these coupler and output have; '': it does not turn
    COUPLER: ClassVar[str] = 'b'
    OUTPUT: ClassVar[str] = 'y'
    FROM_HALF_A_TURN: ClassVar[Coordinate | None] = None        # it counts from there
    BODIES, EXTERNAL, INPUTS = Bodies, External, {parts.CRANK: THETA1, parts.SLIDE: TRAVEL}

    def __post_init__(self) -> None:
        self._set(**checked(self))
        self._require_closing()
        self._check_fit()
        if self.joint_names:
            check_joint_names(self.joint_names, dict.fromkeys(self.pins(), ()))

    @classmethod
    def pins(cls) -> list[str]:
        """Return the joints that pictures name, in order: those of O1, A, B, O4 that it has."""
        known = {link.first_joint for link in cls.LINKS} | {each.joint for each in cls.REACTIONS}
        return [joint for joint in ('O1', 'A', 'B', 'O4') if joint in known]

    def _require_closing(self) -> None:
        """Raise InvalidParameter if the links close nowhere."""

    @property
    def drive(self) -> DrivenMachine:
        return self.DRIVES[self.input]

    @cached_by_lengths
    def closing_ranges(self) -> parts.Ranges:
        return self.drive.ranges(*self.lengths)

    @property
    def singular_inputs(self) -> list[complex]:
        return self.drive.singular(*self.lengths)

    @cached_by_lengths
    def classification(self) -> str:
        if 0.0 in self.margins:
            return 'change point'
        return self.CLASSES[tuple([1 if margin > 0.0 else -1 for margin in self.margins])]

    def stalls(self, side: float) -> Iterable[tuple[Any, ...]]:
        """Return the dead points in which the dyad is on a side, +1 or -1, within a turn."""
        # Input and outputs [rad], [m], and of two links in line: are they stretched, not folded.
        return ()

    @property
    def dead_point_fields(self) -> tuple[str, ...]:
        coordinates = self.input_coordinate, *[output.coordinate for output in self.outputs]
        return (*[coordinate.position for coordinate in coordinates], 'stretched')

    @cached_by_lengths
    def dead_points(self) -> tuple[Any, ...]:
        """Return where the output turns back in this mode, inside the stroke, at any rate."""
        # Records of the input, of angles from -pi on, and the output there; for a change point
        # whose branch changes its side, those of either side through which its motion goes in a
        # period. Those of a machine have no closed form, see dead_points() in extrema.over_input.
        near, output = AT_END_OF_STROKE * self.input_unit, self.outputs[0].coordinate
        points = [*self.stalls(self.sign)]

        def is_inside(x: float) -> bool:
            return self.is_in_stroke(x) and all(abs(self.distance(x, end)) > near
                                                for end in self.cut or ())

        def is_passed(point: Any) -> bool:
            """Return whether the motion has the output of a point there: on its own branch."""
            apart = getattr(self.motion(point[0]), output.position) - point[1]
            if output.unit == 'rad':
                return abs(remainder(apart, 2.0 * pi)) < NEAR_DEAD_POINT
            return bool(abs(apart) < NEAR_DEAD_POINT * power_of_two(*self.lengths))

        if self.flat_inputs:
            turns = 1 if self.is_driven_by_slide else round(self.period / (2.0 * pi))
            points = [(point[0] + 2.0 * pi * turn, *point[1:]) for side in (1.0, -1.0)
                      for point in self.stalls(side) for turn in range(turns)]
        return tuple([
            parts.record_type('DeadPoint', self.dead_point_fields[:len(point)])._make(point)
            for point in sorted((self.from_minus_pi_on(x), *rest) for x, *rest in points)
            if is_inside(point[0]) and (not self.flat_inputs or is_passed(point))])

    def motion_in(self, n: NumberType, constants: Constants, position: Scalar, rate: Scalar,
                  acceleration: Scalar) -> parts.NamedFields:
        """Return the motion from the pose of the machine, with lengths of about one."""
        drive, unit = self.drive, n.power_of_two(*constants.lengths)
        lengths = [length / unit for length in constants.lengths]
        per = 1.0 / unit if self.is_driven_by_slide else 1.0
        v, a, x = rate * per, acceleration * per, position * per
        # the last length of a kind with a slider is its offset
        driven = (driven_slider(x, lengths[-1]) if self.is_driven_by_slide else driven_crank(n, x))
        pose = pose_of(n, drive.layout, [drive.lengths(*lengths)],
                       [constants.sign if drive.sign > 0.0 else -constants.sign], driven)
        dyad = pose.dyads[0]
        # {coordinate: cosine and sine of an angle, or a slide, then its first and its second
        # derivative with respect to the input}
        coordinates: dict[Coordinate, Sequence[Scalar]] = {
            coordinate: dyad.slides[3 * k:3 * k + 3] for k, coordinate in enumerate(drive.slides)}
        if driven.slide:
            coordinates.setdefault(TRAVEL, driven.slide)
        for coordinate in [each for each in self.PARTS if each in ANGLES]:
            link, counted_from = ANGLES[coordinate]
            c, s, first, second = pose.relation(
                *map(drive.layout.links.index, (link, counted_from)))
            if (link in drive.reversed) != (counted_from in drive.reversed):
                c, s = -c, -s       # one of both links points the other way in the machine
            coordinates[coordinate] = c, s, first, second

        # in the order of the fields that results() gives
        square, fields, ratios = v * v, list[Scalar](), {self.input_coordinate: 1.0}
        for coordinate in self.PARTS:
            *value, first, second = coordinates[coordinate]
            if coordinate == self.input_coordinate:
                fields += (position, rate, acceleration)
            elif coordinate in ANGLES:
                side = -1.0 if coordinate == self.FROM_HALF_A_TURN else 1.0
                c, s = value
                fields += (n.atan2(side * s, side * c), first * v, first * a + second * square)
                ratios[coordinate] = first * per
            else:
                fields += (unit * value[0], unit * (first * v),
                           unit * (first * a + second * square))
                ratios[coordinate] = unit * first * per
        of_output = 1.0 if self.outputs[0].coordinate in ANGLES else unit
        cosine, sine, *_ = (drive.transmission(lengths, coordinates) if drive.transmission
                            else (dyad.cosine, dyad.sine))
        fields += (n.atan2(n.fabs(sine), cosine),
                   *[ratios[each] for each in self.RATIOS.values()],
                   of_output * self.condition(n.fabs, lengths, coordinates), dyad.sine)
        for coordinate in self.DIRECTIONS.values():
            fields += coordinates[coordinate][:2]
        return self.MOTION._make(fields)

    @abstractmethod
    def condition(self, fabs: Operation, lengths: Lengths, coordinates: Coordinates) -> Scalar:
        """Return the error of the output, in units of lengths or [rad], in a pose."""

    def link_motions(self, motion: parts.NamedFields, lengths: Lengths | None = None
                     ) -> dict[str, LinkMotion]:
        return self._links(self.lengths if lengths is None else lengths, motion)

    def _links(self, lengths: Lengths, motion: Any, per_unit: Scalar = 1.0,
               are_ratios: bool = False) -> dict[str, LinkMotion]:
        """Return the motion of three links; ``lengths`` are ``per_unit`` times those in [m]."""
        # are_ratios: at unit rate of the input and zero acceleration. A direction of the motion,
        # as 'b', is that of a link: x of the crank, COUPLER and OUTPUT of both others, if they
        # turn.
        rates: dict[Coordinate, tuple[Scalar, Scalar]]
        if are_ratios:
            rates = {self.input_coordinate: (1.0, 0.0), **{
                coordinate: (getattr(motion, name), 0.0)
                for name, coordinate in self.RATIOS.items()}}
        else:
            rates = {coordinate: (getattr(motion, coordinate.rate),
                                  getattr(motion, coordinate.acceleration))
                     for coordinate in self.PARTS}
        turning: dict[str, Direction] = {
            name: (getattr(motion, f'cos_{name}'), getattr(motion, f'sin_{name}'),
                   *rates[coordinate]) for name, coordinate in self.DIRECTIONS.items()}
        crank = LinkMotion(*dyads.ORIGIN, *turning['x'])
        coupler = LinkMotion(*point_of(crank, lengths[0]),
                             *(turning[self.COUPLER] if self.COUPLER else UP))
        if self.OUTPUT:
            a4 = lengths[self.LENGTHS.index(GROUND_LENGTH)]
            output = LinkMotion(a4, 0.0, 0.0, 0.0, 0.0, 0.0, *turning[self.OUTPUT])
        else:
            velocity, acceleration = rates[TRAVEL]
            output = LinkMotion(motion.slide * per_unit, lengths[-1], velocity * per_unit, 0.0,
                                acceleration * per_unit, 0.0, 1.0, 0.0, 0.0, 0.0)
        return dict(zip(LINKS, (crank, coupler, output)))

    def read_coordinate(self, n: NumberType,
                        curves: Sequence[LinkMotion]) -> tuple[Scalar, Scalar, Scalar]:
        if self.is_driven_by_slide or self.input == parts.CRANK:
            return super().read_coordinate(n, curves)
        # an angle between two moving links
        link, counted_from = [curves[LINKS.index(name)] for name in ANGLES[self.input_coordinate]]
        c0, s0 = counted_from.cosine, counted_from.sine
        sine, cosine = link.sine * c0 - link.cosine * s0, link.cosine * c0 + link.sine * s0
        side = -1.0 if self.input_coordinate == self.FROM_HALF_A_TURN else 1.0
        return (n.atan2(side * sine, side * cosine), link.omega - counted_from.omega,
                link.alpha - counted_from.alpha)

    def transmission_sine(self, motion: parts.NamedFields) -> Scalar:
        sine: Scalar = motion.sine
        return sine

    @property
    def layout(self) -> Layout:
        return self.drive.layout

    def joint_in_layout(self, joint: str) -> str:
        force = next(each.magnitude for each in self.REACTIONS if each.joint == joint)
        return self.drive.reactions[force].lstrip('-')

    def joint_loads(self, n: NumberType, constants: Constants, m: Any,
                    reports: list[Any] | None = None) -> list[Scalar]:
        drive, unit = self.drive, n.power_of_two(*constants.lengths)
        lengths, per_unit = [length / unit for length in constants.lengths], 1.0 / unit
        by_name = {length.name: value for length, value in zip(self.LENGTHS, lengths)}
        borne = [link for link in ('crank', 'output') if drive.layout.ground]
        needs = {link: needs_of(body, unit, constants.gravity,
                                getattr(constants.external, link, NOT_APPLIED), moving)
                 for (link, moving), body in zip(self._links(lengths, m, per_unit).items(),
                                                 constants.bodies)}
        loads = dict(zip(load_fields(drive.layout), solve_loads(
            n, drive.layout, [drive.lengths(*lengths)],
            self._links(lengths, m, per_unit, are_ratios=True), needs,
            [[getattr(m, slide.position) * per_unit for slide in drive.slides]], [m.sine], unit,
            {link: by_name[length] for link, length in drive.reversed.items()}, borne,
            self.friction_in(n, constants, unit, reports, getattr(m, self.input_coordinate.rate))
            if self.friction else None)))
        for link in borne:
            joint = drive.reactions['f41' if link == 'crank' else 'f43']
            side, joint = -1.0 if joint.startswith('-') else 1.0, joint.lstrip('-')
            force = needs[link].force * side
            x, y = loads[f'{joint}_x'] + force.x, loads[f'{joint}_y'] + force.y
            loads |= {f'{joint}_x': x, f'{joint}_y': y, joint: n.hypot(x, y)}
        if drive.corrected and not self.friction:
            loads |= drive.corrected(n, constants, m, needs, loads)

        named = list[Scalar]()
        for name in self.LOADS._fields[:-len(DERIVED) or None]:
            force, _, axis = name.partition('_')
            if force in drive.reactions and axis:
                joint = drive.reactions[force]
                load = loads[f'{joint.lstrip("-")}_{axis}']
                named.append(-load if joint.startswith('-') else load)
            else:
                load = loads[drive.reactions.get(name, name).lstrip('-')]
                named.append(unit * load if name.endswith(('_couple', '_moment')) else load)
        return named


CRANK_LENGTH = parts.Length('a1', 'length of the crank O1-A')
COUPLER_LENGTH = parts.Length('a2', 'length of the coupler A-B')
GROUND_LENGTH = parts.Length('a4', 'length of the ground link O1-O4')
CRANK_LINK, JOINT_O1 = parts.Link('crank', 'crank', 'O1', 'a1'), parts.Joint('O1', THETA1, 'crank')

# Reactions where the crank drives the first link of the dyad.
FORWARD = {'f41': 'base', 'f21': '-dyad_first', 'f32': 'dyad_inner', 'f43': 'dyad_second'}


def results(kind: Any, motion: str, loads: str) -> tuple[Any, Any]:
    """Give a kind the types of its motion and its loads, of these names, and return them."""
    forces, drives = ('f41', 'f21', 'f32', 'f43'), kind.DRIVES.values()
    fields = (*[name for coordinate in kind.PARTS for name in coordinate], 'transmission_angle',
              *kind.RATIOS, 'condition',
              'sine',       # from here on they are for this package, and are not shown
              *[f'{axis}_{name}' for name in kind.DIRECTIONS for axis in ('cos', 'sin')])
    kind.MOTION = parts.record_type(motion, fields)
    kind.LOADS = parts.record_type(loads, (
        *[f'{force}_{axis}' for force in forces for axis in 'xy'], *forces,
        *[name for name in next(iter(drives)).reactions if name not in forces], 'driving_torque',
        *['driving_force'] * (parts.SLIDE in kind.INPUTS), 'shaking_force_x', 'shaking_force_y',
        'shaking_force', 'shaking_moment', *[row.name for row in DERIVED]))
    from fourbar_ros.mechanisms.quantities import fields_of  # it imports mechanisms
    meanings = fields_of(kind, next(iter(kind.INPUTS.values()))) | {
        name: parts.Quantity(name, '', f'{coordinate.rate} over the rate of the input', False)
        for name, coordinate in kind.RATIOS.items()}
    kind.MOTION = parts.documented(kind.MOTION, meanings, fields.index('sine'))
    kind.LOADS = parts.documented(kind.LOADS, meanings)
    return kind.MOTION, kind.LOADS
