# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Evaluate inputs one by one: a status qualifies the values, nothing raises.

A Stepper evaluates those of a scene, by its policy out of range and in its assembly modes.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cache, partial
from math import isfinite, isinf, isnan, nan, nextafter
from types import MappingProxyType
from typing import cast, NamedTuple, TYPE_CHECKING

from fourbar_ros import errors
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import mode_number, NamedFields
from fourbar_ros.numerics.number_types import REAL
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import DRIVE_STATE, DRIVEN, PICTURES, Topic
import numpy as np

if TYPE_CHECKING:      # scenes with wrenches need it
    from fourbar_ros.pipeline.joints import SceneJoints
    from fourbar_ros.pipeline.wrenches import ActingInput

# The same values as the STATUS_ constants of fourbar_msgs/LinkageState (a test compares them).
OK, OUT_OF_RANGE, INVALID_INPUT, TOGGLE, RATES_UNKNOWN, INPUT_TIMEOUT, LOADS_UNKNOWN, \
    LOCKED = range(8)
STATUS_NAMES = ('ok', 'out of range', 'invalid input', 'toggle', 'rates unknown', 'input timeout',
                'loads unknown', 'locked by friction')

Evaluated = tuple[int, NamedFields, NamedFields]      # status, MOTION and LOADS of the mechanism


@cache
def _none_of(fields: type[NamedTuple]) -> NamedFields:
    return cast(NamedFields, fields._make([nan] * len(fields._fields)))


def evaluate(mechanism: Mechanism, position: float, rate: float, acceleration: float,
             with_loads: bool) -> Evaluated:
    """
    Return (status, motion, loads) at an input; unknown fields are NaN, as loads not asked for.

    INVALID_INPUT: the input is NaN, infinite, an angle at which floats are 4 rad apart, or so
    fast that a result overflows. RATES_UNKNOWN: the rate or acceleration is NaN; fields that do
    not depend on it are valid. TOGGLE: rates are unbounded, or at the flat position of a change
    point the condition alone; there are no loads. LOCKED: by friction, so there are no loads.
    LOADS_UNKNOWN: a spring whose ends meet, or a user's force, has no value.
    """
    inputs = position, rate, acceleration
    if not isfinite(position * mechanism.overflowing) or isinf(rate) or isinf(acceleration):
        return INVALID_INPUT, mechanism.unknown(*inputs), _none_of(mechanism.LOADS)
    if isnan(rate) or isnan(acceleration):
        return _partly(RATES_UNKNOWN, mechanism, *inputs)
    try:
        if with_loads:
            motion, loads = mechanism.step(*inputs)
            size = sum(motion) + sum(loads)
        else:
            motion, loads = mechanism.motion(*inputs), _none_of(mechanism.LOADS)
            size = sum(motion)
        if isfinite(size):
            return OK, motion, loads
        if isinf(motion.condition):     # a flat position
            return _partly(TOGGLE, mechanism, *inputs)
    except errors.OutOfRange:
        return OUT_OF_RANGE, mechanism.unknown(*inputs), _none_of(mechanism.LOADS)
    except errors.Toggle:
        return _partly(TOGGLE, mechanism, *inputs)
    except errors.Locked:
        return LOCKED, mechanism.motion(*inputs), _none_of(mechanism.LOADS)
    except errors.UnknownForce:
        return LOADS_UNKNOWN, mechanism.motion(*inputs), _none_of(mechanism.LOADS)
    except errors.InvalidParameter:     # numbers overflow
        pass
    return INVALID_INPUT, mechanism.unknown(*inputs), _none_of(mechanism.LOADS)


def _partly(status: int, mechanism: Mechanism, position: float, rate: float, acceleration: float
            ) -> Evaluated:
    """Return a motion whose unknown or unbounded fields are NaN, without loads."""
    # an array has infinite or undefined fields, here NaN, where a float raises
    motion = mechanism.motion(np.array([position]), rate, acceleration)
    no_loads = _none_of(mechanism.LOADS)
    if isnan(motion.transmission_angle[0]):
        return OUT_OF_RANGE, mechanism.unknown(position, rate, acceleration), no_loads
    values = [float(field[0]) for field in motion]
    return (status, mechanism.MOTION(*[value if isfinite(value) else nan for value in values]),
            no_loads)


# --- samples of a scene --------------------------------------------------------------------------

Sample = tuple[int, tuple[float, ...]]      # status, and values in the order of the scene's layout

# endings of the fields that are infinite at a limit, besides omega and alpha
_UNBOUNDED = ('_ratio', 'condition', '_velocity', '_acceleration')


class Wanted(NamedTuple):
    """
    What a step computes and sends.

    Points, links, equation and inertia are computed for their topics alone: their values are NaN
    in a step that does not want the output.
    """

    with_loads: bool = False
    outputs: Mapping[str, Topic] = MappingProxyType({})     # those of the scene, by their names
    pictures: tuple[str, ...] = ()                          # tf, markers
    driven: bool = False
    drive_state: bool = False

    @classmethod
    def of(cls, scene: Scene, names: Iterable[str] | None = None) -> Wanted:
        """Return what a step needs that sends the topics of these names, by default all."""
        every = {*scene.topics, *scene.pictures, DRIVEN.name, DRIVE_STATE.name}
        wanted = every if names is None else set(names)
        outputs = {name: topic for name, topic in scene.topics.items() if name in wanted}
        with_loads = any(topic.needs_loads for topic in outputs.values()) or (
            'joint_states' in outputs and scene.needs_loads)        # for its effort
        pictures = tuple(name for name, topic in PICTURES.items() if name in wanted
                         and name in scene.pictures and not topic.latched)
        return cls(with_loads, outputs, pictures, driven=DRIVEN.name in wanted,
                   drive_state=DRIVE_STATE.name in wanted)


class Stepper:
    """
    Evaluates inputs of one scene in order, in any of its assembly modes.

    Out of range the scene's policy holds: 'none' (nothing is known), 'hold' (the last good values
    again), or 'clamp' (the pose at the nearest limit; rates and loads are unbounded there, so
    NaN). The status says OUT_OF_RANGE in any case.

    ``mode`` is that of the scene. A drive that passes a toggle goes on in another one; its joints
    go on too. ``acting``: a wrench for each link that a topic loads, and the base if a topic moves
    it, by default the scene's before a first message. ``joints``: those of joint_states, by
    default at the start.
    """

    def __init__(self, scene: Scene, acting: Mapping[str, ActingInput] | None = None,
                 joints: SceneJoints | None = None) -> None:
        """Prepare the scene's mode, and what its outputs need."""
        self._scene, self.mode = scene, mode_number(scene.linkage.mode)
        self._policy = scene.drive.out_of_range
        self.joints = joints or joints_of(scene)
        self._drive_wrench = None
        if 'drive_wrench' in scene.outputs:
            from fourbar_ros.pipeline.wrenches import drive_wrench
            self._drive_wrench = drive_wrench(scene.linkage, scene.layout.index_of)
        self.acting: dict[str, ActingInput] = {}
        if scene.acting:
            from fourbar_ros.pipeline.wrenches import in_silence
            self.acting = {name: acting[name] if acting and name in acting
                           else in_silence(scene, name, None) for name in scene.acting}
        self._branches: dict[int, _Branch] = {}     # by mode
        self.prepare([self.mode])

    def prepare(self, modes: Iterable[int]) -> None:
        """Prepare modes that may come, so that no step has to wait for one."""
        for mode in modes:
            if mode not in self._branches:
                scene = self._scene if mode == self.mode else self._scene.taken_in(mode)
                self._branches[mode] = _Branch(scene)
                if self.acting:
                    self._branches[mode].load(self.acting)

    def act(self, name: str, acting: ActingInput) -> None:
        """
        Let a wrench act on a link, or let the base move, from the next step on.

        If anything that acts is not known, no load is.
        """
        self.acting[name] = acting
        for branch in self._branches.values():
            branch.load(self.acting)

    def step(self, position: float, rate: float, acceleration: float, wanted: Wanted,
             mode: int | None = None) -> Sample:
        """
        Return (status, values) at an input, [rad] or [m], and its rate and acceleration.

        The order of the values is that of the scene's layout. ``mode``: None for the scene's.
        """
        if mode is None:
            mode = self.mode
        if mode not in self._branches:
            self.prepare([mode])
        branch = self._branches[mode]
        mechanism, with_loads = branch.mechanism, wanted.with_loads
        status, motion, loads = evaluate(mechanism, position, rate, acceleration,
                                         with_loads and not branch.loads_unknown)
        if branch.loads_unknown and status == OK:
            status = LOADS_UNKNOWN
        elif branch.carried and with_loads and status == OK:
            loads = branch.rest_of(loads, branch.carried, mechanism)
            if not isfinite(loads.shaking_force + loads.shaking_moment):
                status, loads = INVALID_INPUT, _none_of(mechanism.LOADS)
                motion = mechanism.unknown(position, rate, acceleration)
        values = self._completed((*motion, *loads, *branch.outputs(mechanism, status, motion,
                                                                   loads, wanted.outputs)))
        if self._policy == 'hold':
            if status in (OK, LOADS_UNKNOWN, LOCKED):
                branch.held = values
            elif status in (OUT_OF_RANGE, INVALID_INPUT) and branch.held:
                values = branch.held
        elif self._policy == 'clamp' and status == OUT_OF_RANGE:
            values = self._at_limit(branch, position)
        return status, values

    def silence(self) -> tuple[float, ...]:
        """Return the values during a timeout: NaN, except for held joint positions."""
        if not self.joints:
            return self._scene.layout.unknown
        unknown = self._scene.layout.unknown[:self._scene.layout.groups['joint_states'].start]
        return unknown + self.joints.of(unknown)

    def _completed(self, values: tuple[float, ...]) -> tuple[float, ...]:
        """Return values of a sample with those made of them: drive wrench and joint states."""
        if self._drive_wrench:
            values += self._drive_wrench(values)
        return values + self.joints.of(values) if self.joints else values

    def _at_limit(self, branch: _Branch, position: float) -> tuple[float, ...]:
        """Return the values at the limit nearest to an input; rates and loads are NaN there."""
        mechanism = branch.mechanism
        if branch.limits is None:
            branch.limits = []
            for end, toward in (ends for low, high in mechanism.input_ranges
                                for ends in ((low, high), (high, low))):
                while (end != toward                # by rounding, a pose may be some floats inside
                       and evaluate(mechanism, end, 0.0, 0.0, False)[0] == OUT_OF_RANGE):
                    end = nextafter(end, toward)
                branch.limits.append(end)
        nearest = min(branch.limits,
                      key=lambda limit: abs(float(mechanism.distance(position, limit))))
        _, motion, loads = evaluate(mechanism, nearest, nan, nan, False)
        motion = motion._replace(**{name: nan for name in motion._fields
                                    if name.startswith(('omega', 'alpha'))
                                    or name.endswith(_UNBOUNDED)})
        return self._completed((*motion, *loads, *branch.outputs(
            mechanism, OUT_OF_RANGE, motion, loads, self._scene.topics)))


class _Branch:
    """
    The mechanism of a scene in one mode, with what acts on it, and the outputs computed of it.

    ``held``: the last good values, for the policy hold; ``limits``: inputs at the ends of the
    ranges, for clamp.
    """

    def __init__(self, scene: Scene) -> None:
        """Choose the functions that compute what the outputs of a scene need beside its motion."""
        self._scene, self.mechanism, self.loads_unknown = scene, scene.linkage, False
        self.held: tuple[float, ...] | None = None
        self.limits: list[float] | None = None
        self.carried = scene.carried
        if self.carried or 'inertia' in scene.outputs:
            from fourbar_ros.mechanisms import inertia  # imported where a scene needs it
            self.rest_of = inertia.rest_of
        if scene.points or 'links' in scene.outputs:
            from fourbar_ros.mechanisms import points  # imported where a scene needs it
        # {output: function of motion, or of mechanism, motion and loads, that returns its values},
        # in the order of the layout
        self._of_motion: dict[str, Callable[..., Iterable[float]]] = {}
        self._of_loads: dict[str, Callable[..., Iterable[float]]] = {}
        for output in scene.layout.groups:
            family, _, name = output.partition('/')
            if family == 'points':
                self._of_motion[output] = partial(points.point_in, REAL, scene.linkage,
                                                  **scene.points[name]._asdict())
            elif family == 'links':
                self._of_motion[output] = partial(points.link_fields, scene.linkage, link=name)
            elif output == 'equation':
                self._of_loads[output] = partial(_equation, scene.linkage.weightless,
                                                 scene.drive.carried_inertia)
            elif output == 'inertia':
                self._of_loads[output] = lambda mechanism, motion, _: inertia.held_rigid(
                    mechanism, motion)
        self._unknown = {output: scene.layout.unknown[scene.layout.groups[output]]
                         for output in (*self._of_motion, *self._of_loads)}

    def load(self, acting: Mapping[str, ActingInput]) -> None:
        """Let wrenches and the motion of the base act; if any is unknown, no load is known."""
        from fourbar_ros.pipeline.wrenches import loaded  # imported where a scene needs it
        mechanism = loaded(self.mechanism, self._scene, acting)
        self.loads_unknown = mechanism is None and self._scene.needs_loads
        if mechanism is not None:
            self.mechanism = mechanism

    def outputs(self, mechanism: Mechanism, status: int, motion: NamedFields,
                loads: NamedFields, wanted: Mapping[str, Topic]) -> list[float]:
        """
        Return motion of points and links, equation of motion and inertia; NaN if not wanted.

        The last two are NaN also where the status is not OK.
        """
        values, unknown = list[float](), self._unknown
        for output, of_motion in self._of_motion.items():
            values += of_motion(motion) if output in wanted else unknown[output]
        for output, of_loads in self._of_loads.items():
            result = unknown[output]
            if output in wanted and status == OK:
                with suppress(errors.FourBarError):        # an overflow
                    result = tuple(of_loads(mechanism, motion, loads))
            values += result if isfinite(sum(result)) else unknown[output]
        return values


def _equation(weightless: Mechanism, carried: float, mechanism: Mechanism, motion: NamedFields,
              loads: NamedFields) -> list[float]:
    from fourbar_ros.mechanisms.inertia import input_equation  # imported where a scene needs it
    position, rate, acceleration = (getattr(motion, name) for name in mechanism.input_coordinate)
    return [*input_equation(mechanism, position, rate, weightless),
            getattr(loads, mechanism.drive_load) - carried * acceleration]


def joints_of(scene: Scene, angles: Sequence[float] | None = None, is_wrapped: bool = False
              ) -> SceneJoints | None:
    """Return the SceneJoints of a scene, None for one without the output joint_states."""
    if 'joint_states' not in scene.outputs:
        return None
    from fourbar_ros.pipeline.joints import SceneJoints  # imported where a scene needs it
    return SceneJoints(scene, angles, is_wrapped)
