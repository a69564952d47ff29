# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Evaluate inputs one by one: a status qualifies the numbers, nothing raises.

Steppers evaluate those of a scene, by its policy out of range and in its assembly modes.
"""
from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cache, partial
from math import isfinite, isinf, isnan, nan, nextafter
from typing import cast, NamedTuple, TYPE_CHECKING, Union

from fourbar_ros.errors import FourBarError, InvalidParameter, OutOfRange, Toggle
from fourbar_ros.mechanisms.curves import LinkFields, PointMotion
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import mode_number, NamedFields
from fourbar_ros.numerics.number_types import REAL
from fourbar_ros.scene.message_fields import EQUATION, joint_values, RIGID
from fourbar_ros.scene.scene import Scene
import numpy as np

if TYPE_CHECKING:      # scenes with wrenches need it
    from fourbar_ros.pipeline.joints import SceneJoints
    from fourbar_ros.pipeline.wrenches import ActingInput

# The same numbers as the STATUS_ constants of fourbar_msgs/LinkageState (a test compares them).
OK, OUT_OF_RANGE, INVALID_INPUT, TOGGLE, RATES_UNKNOWN, INPUT_TIMEOUT, LOADS_UNKNOWN = range(7)
STATUS_NAMES = ('ok', 'out of range', 'invalid input', 'toggle', 'rates unknown', 'input timeout',
                'loads unknown')


Evaluated = tuple[int, NamedFields, NamedFields]      # status, MOTION and LOADS of the mechanism


@cache
def _none_of(fields: type[NamedTuple]) -> NamedFields:
    """Return a record of this type, all NaN."""
    return cast(NamedFields, fields._make([nan] * len(fields._fields)))


def evaluate(mechanism: Mechanism, position: float, rate: float, acceleration: float,
             with_loads: bool) -> Evaluated:
    """
    Return (status, motion, loads) at an input; unknown fields are NaN, as loads not asked for.

    INVALID_INPUT: the input is NaN or infinite, or so fast that a result overflows. RATES_UNKNOWN:
    the rate or acceleration is NaN; fields that do not depend on it are valid.
    """
    inputs = position, rate, acceleration
    if not isfinite(position) or isinf(rate) or isinf(acceleration):
        return INVALID_INPUT, mechanism.unknown(*inputs), _none_of(mechanism.LOADS)
    if isnan(rate) or isnan(acceleration):
        return _partly(RATES_UNKNOWN, mechanism, *inputs)
    try:
        if with_loads:
            motion, loads = mechanism.step(*inputs)
            is_finite = isfinite(sum(motion) + sum(loads))
        else:
            motion, loads = mechanism.motion(*inputs), _none_of(mechanism.LOADS)
            is_finite = isfinite(sum(motion))
    except InvalidParameter:     # numbers overflow
        is_finite = False
    except OutOfRange:
        return OUT_OF_RANGE, mechanism.unknown(*inputs), _none_of(mechanism.LOADS)
    except Toggle:
        return _partly(TOGGLE, mechanism, *inputs)
    if is_finite:
        return OK, motion, loads
    return INVALID_INPUT, mechanism.unknown(*inputs), _none_of(mechanism.LOADS)


def _partly(status: int, mechanism: Mechanism, position: float, rate: float, acceleration: float
            ) -> Evaluated:
    """
    Return (status, motion, loads) where a part of the motion exists, without loads.

    It is evaluated as an array of one input. An array has infinite or undefined fields where a
    single input raises; they become NaN.
    """
    motion = mechanism.motion(np.array([position]), rate, acceleration)
    no_loads = _none_of(mechanism.LOADS)
    if isnan(motion.transmission_angle[0]):
        return OUT_OF_RANGE, mechanism.unknown(position, rate, acceleration), no_loads
    values = [float(field[0]) for field in motion]
    return (status, mechanism.MOTION(*[value if isfinite(value) else nan for value in values]),
            no_loads)


# --- samples of a scene --------------------------------------------------------------------------

Wanted = Union[bool, Collection[str]]       # outputs as points/NAME and equation; True: all
Sample = tuple[int, tuple[float, ...]]      # status and values

# endings of the fields that are infinite at a limit, besides omega and alpha
_UNBOUNDED = ('_ratio', 'condition', '_velocity', '_acceleration')
_NO_POINT, _NO_LINK = (nan,) * len(PointMotion._fields), (nan,) * len(LinkFields._fields)


class Stepper:
    """
    Evaluates inputs of one scene in order.

    Out of range its policy holds: 'none' (nothing is known), 'hold' (the last good values again),
    or 'clamp' (the pose at the nearest limit; rates and loads are unbounded there, so NaN). The
    status says OUT_OF_RANGE in any case.

    ``acting``: a wrench for each link that a topic loads, and the base if it has one, by default
    the scene's before a first message. ``joints``: those of joint_states, by default at the start.
    """

    def __init__(self, scene: Scene, acting: Mapping[str, ActingInput] | None = None,
                 joints: SceneJoints | None = None) -> None:
        """Prepare all that depends on the scene alone; no step has been made."""
        self._scene = scene
        self.linkage, self._policy = scene.bare_linkage, scene.drive.out_of_range
        # outputs: (name, function of the solved values, its values where nothing is known)
        self._parts: list[tuple[str, Callable[[NamedFields], Iterable[float]],
                                tuple[float, ...]]] = []
        if scene.points:
            from fourbar_ros.mechanisms.points import make_point  # other scenes do without
            self._parts += [(f'points/{name}', make_point(REAL, scene.linkage, *point), _NO_POINT)
                            for name, point in scene.points.items()]
        if 'links' in scene.outputs:
            from fourbar_ros.mechanisms.points import link_fields  # other scenes do without
            self._parts += [(f'links/{link.name}',
                             partial(link_fields, scene.linkage, link=link.name), _NO_LINK)
                            for link in scene.linkage.LINKS]
        # for the policy hold: the last values within range; for clamp: inputs at the limits
        self._good: tuple[float, ...] | None = None
        self._limits: list[float] | None = None
        self._drive_wrench, self.joints = None, joints or joints_of(scene)
        # outputs of the linkage with what acts on it: (name, function of it, its motion and loads,
        # values where nothing is known)
        self._of_linkage: list[tuple[
            str, Callable[[Mechanism, NamedFields, NamedFields], Iterable[float]],
            tuple[float, ...]]] = []
        self._carried = scene.carried
        if self._carried or 'inertia' in scene.outputs:
            from fourbar_ros.mechanisms import inertia  # other scenes do without
            self._rest_of = inertia.rest_of
        if 'equation' in scene.outputs:
            self._of_linkage.append(('equation', partial(
                _equation, scene.bare_linkage.weightless, scene.drive.carried_inertia),
                (nan,) * len(EQUATION)))
        if 'inertia' in scene.outputs:
            self._of_linkage.append((
                'inertia', lambda linkage, motion, _: inertia.held_rigid(linkage, motion),
                (nan,) * len(RIGID)))
        own_joints = joint_values(len(scene.layout.joints)) if self.joints else ()
        # the values of a sample where nothing is known, without those of its joints
        self._nothing = (nan,) * (len(scene.layout.index_of) - len(own_joints))
        if 'drive_wrench' in scene.outputs:
            from fourbar_ros.pipeline.wrenches import drive_wrench
            self._drive_wrench = drive_wrench(scene.linkage, scene.layout.index_of)
        # (position, rate) -> linkage with the forces of springs and dampers there, if any
        self._with_element_forces = scene.make_loaded(self.linkage)
        self.acting: dict[str, ActingInput] = {}
        self._loads_unknown = False
        for name in scene.acting:
            from fourbar_ros.pipeline.wrenches import in_silence
            self.act(name, (acting or {}).get(name) or in_silence(scene, name, None))

    def act(self, name: str, what: ActingInput) -> None:
        """
        Let a wrench act on a link, or let the base move, from the next step on.

        If anything that acts is not known, no load is.
        """
        from fourbar_ros.pipeline.wrenches import loaded  # other scenes do without
        self.acting[name] = what
        linkage = loaded(self.linkage, self._scene, self.acting)
        self._loads_unknown = linkage is None and self._scene.needs_loads
        if linkage is not None:
            self.linkage = linkage
            self._with_element_forces = self._scene.make_loaded(self.linkage)

    def step(self, position: float, rate: float, acceleration: float, with_loads: bool,
             with_parts: Wanted) -> Sample:
        """
        Return (status, values) at an input, [rad] or [m], and its rate and acceleration.

        The values are (*motion, *loads, *motion of each point and link, *equation, *rigid, *drive
        wrench, *joints), as the scene's FieldMap places them. ``with_parts``: which of the points
        and links, of equation and inertia are wanted; the values of others are NaN.
        """
        linkage = self.linkage
        if self._with_element_forces and with_loads:       # springs act on the links too
            loaded = self._with_element_forces(position, rate)
            linkage, with_loads = loaded or linkage, loaded is not None
        status, motion, loads = evaluate(linkage, position, rate, acceleration,
                                         with_loads and not self._loads_unknown)
        if self._loads_unknown and status == OK:
            status = LOADS_UNKNOWN
        elif self._carried and with_loads and status == OK:
            loads = self._rest_of(loads, self._carried, linkage)
            if not isfinite(loads.shaking_force + loads.shaking_moment):
                status, loads = INVALID_INPUT, _none_of(linkage.LOADS)
                motion = linkage.unknown(position, rate, acceleration)
        values = self._completed((*motion, *loads, *self._of_parts(motion, with_parts),
                                  *self._shown_of(linkage, status, motion, loads, with_parts)))
        if self._policy == 'hold':
            if status in (OK, LOADS_UNKNOWN):
                self._good = values
            elif status in (OUT_OF_RANGE, INVALID_INPUT) and self._good:
                values = self._good
        elif self._policy == 'clamp' and status == OUT_OF_RANGE:
            values = self._at_limit(position)
        return status, values

    def silence(self) -> tuple[float, ...]:
        """Return the values during a timeout: NaN, except for held joint positions."""
        return self._nothing + self.joints.of(self._nothing) if self.joints else self._nothing

    def _completed(self, values: tuple[float, ...]) -> tuple[float, ...]:
        """Append the drive wrench and the joints, where the scene has them."""
        if self._drive_wrench:
            values += self._drive_wrench(values)
        return values + self.joints.of(values) if self.joints else values

    def _of_parts(self, motion: NamedFields, wanted: Wanted) -> list[float]:
        """Return the motion of all points and links, NaN for any that is not wanted."""
        return [value for name, part, unknown in self._parts
                for value in (part(motion) if wanted is True or wanted and name in wanted
                              else unknown)]

    def _shown_of(self, linkage: Mechanism, status: int, motion: NamedFields, loads: NamedFields,
                  wanted: Wanted) -> list[float]:
        """Return equation of motion and inertia, NaN where they are not wanted or not known."""
        values: list[float] = []
        for name, part, unknown in self._of_linkage:
            found = unknown
            if status == OK and (wanted is True or wanted and name in wanted):
                with suppress(FourBarError):        # numbers overflow
                    found = tuple(part(linkage, motion, loads))
            values += found if isfinite(sum(found)) else unknown
        return values

    def _at_limit(self, position: float) -> tuple[float, ...]:
        """Return the values at the limit nearest to an input; rates and loads are NaN there."""
        if self._limits is None:
            self._limits = [_first_assembled(self.linkage, end, toward)
                            for low, high in self.linkage.input_ranges
                            for end, toward in ((low, high), (high, low))]
        nearest = min(self._limits,
                      key=lambda limit: abs(float(self.linkage.distance(position, limit))))
        _, motion, loads = evaluate(self.linkage, nearest, nan, nan, False)
        motion = motion._replace(**{name: nan for name in motion._fields
                                    if name.startswith(('omega', 'alpha'))
                                    or name.endswith(_UNBOUNDED)})
        return self._completed((*motion, *loads, *self._of_parts(motion, True),
                                *self._shown_of(self.linkage, OUT_OF_RANGE, motion, loads,
                                                False)))


def _equation(weightless: Mechanism, carried: float, linkage: Mechanism, motion: NamedFields,
              loads: NamedFields) -> list[float]:
    from fourbar_ros.mechanisms.inertia import input_equation  # other scenes do without
    position, rate, acceleration = (getattr(motion, name) for name in linkage.input_coordinate)
    return [*input_equation(linkage, position, rate, weightless),
            getattr(loads, linkage.drive_load) - carried * acceleration]


def _first_assembled(linkage: Mechanism, end: float, toward: float) -> float:
    """
    Return the first float from the end of a range at which the linkage can be assembled.

    By rounding that may be some floats inside.
    """
    while evaluate(linkage, end, 0.0, 0.0, False)[0] == OUT_OF_RANGE and end != toward:
        end = nextafter(end, toward)
    return end


def joints_of(scene: Scene, angles: Sequence[float] | None = None, is_wrapped: bool = False
              ) -> SceneJoints | None:
    """Return the SceneJoints of a scene, None for one without the output joint_states."""
    if 'joint_states' not in scene.outputs:
        return None
    from fourbar_ros.pipeline.joints import SceneJoints  # other scenes do without
    return SceneJoints(scene, angles, is_wrapped)


class InModes:
    """
    A :class:`Stepper` for each assembly mode, made when it is needed; arguments as of a stepper.

    A drive that passes a toggle goes on in another mode than the scene's; its joints go on too.
    """

    def __init__(self, scene: Scene, acting: Mapping[str, ActingInput] | None = None,
                 joints: SceneJoints | None = None) -> None:
        self._scene, self.own_mode = scene, mode_number(scene.linkage.mode)
        self.joints = joints or joints_of(scene)
        self._own = Stepper(scene, acting, self.joints)
        self._all = {self.own_mode: self._own}

    @property
    def acting(self) -> dict[str, ActingInput]:
        """Return what acts as topics say, see :meth:`Stepper.act`."""
        return self._own.acting

    def act(self, name: str, what: ActingInput) -> None:
        """Let something act from the next step on."""
        for stepper in self._all.values():
            stepper.act(name, what)

    def prepare(self, modes: Iterable[int]) -> None:
        """Make the steppers of modes that may come, so that no step has to wait for one."""
        for mode in modes:
            if mode not in self._all:
                self._all[mode] = Stepper(self._scene.taken_in(mode), self.acting, self.joints)

    def step(self, mode: int, position: float, rate: float, acceleration: float,
             with_loads: bool, with_parts: Wanted) -> Sample:
        """Return (status, values) as :meth:`Stepper.step`, in the mode of this number."""
        if mode not in self._all:
            self.prepare([mode])
        return self._all[mode].step(position, rate, acceleration, with_loads, with_parts)

    def silence(self) -> tuple[float, ...]:
        """Return the values during a timeout."""
        return self._own.silence()
