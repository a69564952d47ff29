# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The contract of a mechanism: what it states about itself, and the formulas it gives."""
from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, NamedTuple

from fourbar_ros.mechanics.bodies import External
from fourbar_ros.mechanisms.parts import (
    Arrow,
    Connection,
    Coordinate,
    Diagram,
    Joint,
    Length,
    Link,
    Output,
    Quantity,
    Reaction,
)
from fourbar_ros.mechanisms.points import LinkMotion
from fourbar_ros.numerics.number_types import Function, NumberType

CROSSED, OPEN = 1, 2     # assembly modes: sin(theta4 - beta) < 0, > 0 of a 4R linkage
CRANK, SLIDE = 'crank', 'slide'     # inputs

Ranges = tuple[tuple[float, float], ...]        # (low, high) of an input [rad or m]


class Constants(NamedTuple):
    """
    What the formulas of a mechanism are made for: floats, or numbers of any type.

    Other numbers take their places by :func:`~fourbar_ros.numerics.number_types.converted`.
    """

    lengths: Any
    sign: Any
    bodies: Any
    gravity: Any
    external: External


class Contract(ABC):
    """
    What a mechanism states about itself and must give; everything else follows from it.

    Everything outside of a mechanism's own folder asks these names, of an instance: a kind has
    them as attributes of its class, a mechanism put together at run time as attributes of its own.
    How many links, joints, loads and outputs there are is known nowhere else.

    Attributes
    ----------
    TITLE : str
        What the kind is called in texts.
    TEXT : str
        What it is, for the manual.
    LENGTHS : tuple of Length
        In the order of :attr:`lengths`.
    LINKS : tuple of Link
        The moving links, in the order of the fields of ``BODIES``.
    JOINTS : tuple of Joint
        As ``joint_states`` shows them, from O1 on.
    REACTIONS : tuple of Reaction
        What is transmitted at each joint.
    PARTS : mapping
        {Coordinate: what moves, as text}: the table of a pose.
    DRAWN : tuple of Coordinate
        Those that are written below a picture.
    INPUTS : mapping
        {name of the input: its Coordinate}.
    OUTPUTS : mapping
        {name of the input: tuple of :class:`Output`, the one that is published as ``output``
        first}.
    MOTION, LOADS : NamedTuple types
        Types of the results. A motion has ``transmission_angle`` and ``condition``, loads have
        ``shaking_force_x``, ``_y``, ``shaking_force``, ``shaking_moment``.
    BODIES, EXTERNAL : NamedTuple types
        Types of ``bodies`` and ``external``: a field for each link, and for each link that can be
        loaded.
    MARGIN_SIGNS : tuple of tuple
        How the size of each length enters each of :attr:`margins`: 1, -1 or, not at all, 0.
    PICTURE : module
        With functions ``diagram``, ``velocity_polygon``, ``acceleration_polygon`` of (mechanism,
        motion).
    MODES : mapping
        {assembly mode: its name as text}; see :attr:`modes`.
    QUANTITIES : tuple of Quantity
        Fields of motion and loads that can be asked for by name, and that no other kind has.
    SLIDE_DIRECTION : tuple of 2 str, optional
        Fields of the motion: cosine and sine of the direction of a driven slide; None: it is x.
    LEAVES_OUT_ZEROS : bool
        Whether a single step leaves out products with masses and lengths of zero. A zero in its
        results may then have the other sign.
    mode, input, bodies, gravity, external, stroke
        What one is made with, beside its lengths; see the kinds.

    """

    TITLE: str
    TEXT: str
    LENGTHS: tuple[Length, ...]
    LINKS: tuple[Link, ...]
    JOINTS: tuple[Joint, ...]
    REACTIONS: tuple[Reaction, ...]
    PARTS: Mapping[Coordinate, str]
    DRAWN: tuple[Coordinate, ...]
    INPUTS: Mapping[str, Coordinate]
    OUTPUTS: Mapping[str, tuple[Output, ...]]
    MOTION: Any
    LOADS: Any
    BODIES: Any
    EXTERNAL: Any
    QUANTITIES: tuple[Quantity, ...] = ()
    MARGIN_SIGNS: tuple[tuple[int, ...], ...]
    PICTURE: Any
    MODES: Mapping[int, str] = {CROSSED: '1', OPEN: '2'}
    SLIDE_DIRECTION: tuple[str, str] | None = None
    LEAVES_OUT_ZEROS: bool = False

    # --- what one is made with ------------------------------------------------------------------

    __dataclass_fields__: ClassVar[dict[str, Any]]
    mode: Any
    input: Any
    bodies: Any
    gravity: Any
    external: Any
    stroke: Any = None       # of mechanisms that have none

    # --- what a kind must give ------------------------------------------------------------------

    @abstractmethod
    def motion_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (position, rate, acceleration) -> fields of MOTION for a number type."""

    @abstractmethod
    def loads_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (fields of MOTION) -> fields of LOADS for constants of a number type."""

    @property
    @abstractmethod
    def closing_ranges(self) -> Ranges:
        """Return the ranges (low, high) of the input in which the links close [rad or m]."""

    @property
    @abstractmethod
    def singular_inputs(self) -> list[complex]:
        """
        Return the complex inputs where the dyad is in line, or quantities have a pole, as a list.

        As far as their real part and the size of their imaginary part go: toggles (real), flat
        positions of change points (real) and others. Extrema are searched for with samples that
        crowd there.
        """

    @property
    @abstractmethod
    def margins(self) -> tuple[float, ...]:
        """Return the differences of sums of lengths [m] that are zero at change points."""

    @property
    @abstractmethod
    def classification(self) -> str:
        """Return the type by name: which links turn fully."""

    @abstractmethod
    def link_motion(self, motion: Any, link: str) -> LinkMotion:
        """
        Return the :class:`~fourbar_ros.mechanisms.points.LinkMotion` of a link by name.

        Plain arithmetic with fields of the motion, whatever numbers these are.
        """

    @abstractmethod
    def transmission_sine(self, motion: Any) -> Any:
        """Return a number that is zero where the dyad is in line, at most one."""

    # --- its pictures, by the module PICTURE -----------------------------------------------------

    def diagram(self, motion: Any) -> Diagram:
        """Return what a picture shows in one pose."""
        return self.PICTURE.diagram(self, motion)

    def velocity_polygon(self, motion: Any) -> list[Arrow]:
        """Return the arrows of the velocities [m/s]; the pole is the origin."""
        return self.PICTURE.velocity_polygon(self, motion)

    def acceleration_polygon(self, motion: Any) -> list[Arrow]:
        """Return the arrows of the accelerations [m/s^2]; the pole is the origin."""
        return self.PICTURE.acceleration_polygon(self, motion)

    # --- what some kinds know -------------------------------------------------------------------

    @property
    def dead_points(self) -> tuple[Any, ...]:
        """
        Return where the output turns back at any speed of the input.

        NamedTuples, the input first.
        """
        return ()

    @property
    def ranges_of_both_modes(self) -> Mapping[str, Ranges]:
        """Return {position of an output: its ranges over both modes}, if known in closed form."""
        return {}

    @property
    def modes(self) -> Mapping[int, str]:
        """Return {assembly mode: its name}; one input may have fewer than another."""
        return self.MODES

    @property
    def connections(self) -> tuple[Connection, ...]:
        """
        Return which links each of ``JOINTS`` connects, in the same order.

        Descriptions for other programs are made of it; a kind without has none.
        """
        return ()
