# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What a mechanism states: its names, lengths, links and joints, and its formulas.

A kind, or a machine of dyads, gives these facts, and formulas for any
:class:`~fourbar_ros.numerics.number_types.NumberType`. All else follows from them:
:mod:`.geometry`, :mod:`.mechanism`.
"""
from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, TYPE_CHECKING

from fourbar_ros.mechanics.bodies import Gravity
from fourbar_ros.mechanisms import parts
from fourbar_ros.mechanisms.curves import LinkMotion
from fourbar_ros.numerics.number_types import NumberType, Scalar

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.evaluation import Constants


class StatedMechanism(ABC):
    """Base of the mechanisms: frozen dataclasses of lengths and what else they are made with."""

    # The fields besides lengths: mode, input, bodies, gravity, external, elements, stroke. A kind
    # has its facts as attributes of its class, a machine put together at run time as its own
    # attributes. The numbers of links, joints, loads and outputs are known nowhere else.
    TITLE: str                      # name of the kind in texts
    TEXT: str                       # description, for the manual
    LENGTHS: tuple[parts.Length, ...]     # in the order of ``lengths``
    LINKS: tuple[parts.Link, ...]         # the moving links, in the order of the fields of BODIES
    JOINTS: tuple[parts.Joint, ...]       # as ``joint_states`` shows them, from O1 on
    REACTIONS: tuple[parts.Reaction, ...]     # forces and couples at each joint
    PARTS: Mapping[parts.Coordinate, str]     # moving coordinates as text: the table of a pose
    DRAWN: tuple[parts.Coordinate, ...]       # coordinates written below a picture
    INPUTS: Mapping[str, parts.Coordinate]    # {name of the input: its coordinate}
    OUTPUTS: Mapping[str, tuple[parts.Output, ...]]   # {name of the input: published one first}
    # Types of the results, NamedTuples. A motion has ``transmission_angle`` and ``condition``,
    # loads have ``shaking_force_x``, ``_y``, ``shaking_force`` and ``shaking_moment``.
    MOTION: Any
    LOADS: Any
    # Types of ``bodies`` and ``external``, NamedTuples: a field for each link, and for each link
    # that can be loaded.
    BODIES: Any
    EXTERNAL: Any
    QUANTITIES: tuple[parts.Quantity, ...] = ()       # quantities that no other kind has
    # How the size of each length enters each of ``margins``: 1, -1 or, not at all, 0.
    MARGIN_SIGNS: tuple[tuple[int, ...], ...]
    # {assembly mode: its name}, see modes
    MODES: Mapping[int, str] = {parts.CROSSED: '1', parts.OPEN: '2'}
    # Fields of the motion: cosine and sine of the direction of a driven slide; None: it is x.
    SLIDE_DIRECTION: tuple[str, str] | None = None
    # Whether a single step leaves out products with masses and lengths of zero. A zero in its
    # results may then have the other sign.
    LEAVES_OUT_ZEROS: bool = False
    TORQUE: str = 'T_{41}'          # symbol of the driving torque: of which link on which

    __dataclass_fields__: ClassVar[dict[str, Any]]
    mode: int
    input: str
    bodies: Any
    gravity: Gravity
    external: Any
    elements: tuple[Any, ...]       # springs, dampers, forces over a position: :mod:`.elements`
    friction: Any       # pairs of :data:`.mechanisms.friction.Friction`
    stroke: tuple[float, float] | None      # lowest and highest input [rad or m]
    joint_names: Mapping[str, str]          # {joint: name which pictures show}

    @abstractmethod
    def motion_in(self, n: NumberType, constants: Constants, position: Scalar, rate: Scalar,
                  acceleration: Scalar) -> parts.NamedFields:
        """Return the motion, MOTION of numbers of a type, as are the constants and the input."""

    @abstractmethod
    def joint_loads(self, n: NumberType, constants: Constants, motion: parts.NamedFields,
                    reports: list[Any] | None = None) -> Any:
        """Return the fields of LOADS that are no DERIVED ones, for constants of a number type."""
        # reports: a list to which joints with friction append a FrictionReport

    @property
    @abstractmethod
    def layout(self) -> Any:
        """Return the structure of its machine, a Layout."""

    @property
    @abstractmethod
    def closing_ranges(self) -> parts.Ranges:
        """Return the ranges (low, high) of the input in which the links close [rad or m]."""

    @property
    @abstractmethod
    def singular_inputs(self) -> list[complex]:
        """Return the complex inputs where the dyad is in line, or quantities have a pole."""
        # Toggles and flat positions of change points are real. One of each conjugate pair is
        # enough. The search for extrema puts more samples near them, where quantities change fast.

    @property
    @abstractmethod
    def classification(self) -> str:
        """Return the type by name: which links turn fully."""

    @abstractmethod
    def link_motions(self, motion: parts.NamedFields, lengths: Any = None
                     ) -> Mapping[str, LinkMotion]:
        """Return {name of one of its ``LINKS``: its motion}, from one of its motions."""
        # The coupler of an inverted slider-crank is its block; output is the slider of a
        # slider-crank, the bar of an inverted one. Fields are numbers of any type, and so are
        # lengths, those of constants that take the place of its own.

    @abstractmethod
    def transmission_sine(self, motion: parts.NamedFields) -> Scalar:
        """Return a number of at most one in size that is zero where the dyad is in line."""
        # Errors of rates and loads grow as one over it: the search for extrema bounds noise by it.

    @property
    def modes(self) -> Mapping[int, str]:
        """Return {assembly mode: its name}; one input may have fewer than another."""
        return self.MODES
