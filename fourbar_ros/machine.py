# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Machines of dyads in Python: a driven link, and dyads in the order in which they hang on it.

A six-bar by Watt, with round rods and its weight:

>>> from fourbar_ros import find_extrema
>>> from fourbar_ros.machine import Dyad, Machine, Point, rods
>>> dyads = [
...     Dyad('one', 'RRR', Point('crank', 0.4), Point('ground', 1.0), ('coupler', 'rocker'),
...          length_1=1.2, length_2=0.8),
...     Dyad('two', 'RRR', Point('rocker', 0.5, -0.4), Point('ground', 2.2),
...          ('connector', 'output'), length_1=0.8, length_2=0.7)]
>>> six_bar = Machine(dyads, bodies=rods(dyads, density=7750.0, radius=0.01),
...                   gravity=(0.0, -9.81))
>>> motion, loads = six_bar.step(1.0, 25.0)         # angle [rad] and rate [rad/s] of the crank
>>> round(motion.omega_output, 6), round(loads.driving_torque, 6)
(-1.567642, 173.612578)
>>> for extremum in find_extrema(six_bar, ('omega_output',), rate=25.0):
...     print(extremum.kind, f'{extremum.value:.6f} rad/s at {extremum.theta1:.6f} rad')
maximum 4.034871 rad/s at 0.113387 rad
minimum -2.899616 rad/s at 0.748834 rad
maximum 9.252828 rad/s at 2.469690 rad
minimum -14.125835 rad/s at 5.548036 rad

A four-bar with a cylinder from its crank, here 'arm', to its coupler, here 'crank', seen from A:

>>> loop = Dyad('loop', 'RRR', Point('crank', 1.2), Point('arm', 0.4), ('output', 'ground'),
...             length_1=0.8, length_2=1.0)
>>> pushed = Machine([loop], 'cylinder', cylinder=Cylinder(Point('arm', 0.3), Point('crank', 0.5)))
>>> motion = pushed.motion(0.5, 0.1)                # length [m] and rate [m/s] of the cylinder
>>> round(motion.omega_arm, 6), round(motion.omega_output, 6)
(-0.419302, -0.20434)

"""
from collections.abc import Iterable

from fourbar_ros.mechanics.bodies import Body, round_rod
from fourbar_ros.mechanisms.curves import Point
from fourbar_ros.mechanisms.machine.description import Cylinder, Dyad
from fourbar_ros.mechanisms.machine.from_points import read_drawing
from fourbar_ros.mechanisms.machine.machine import Machine

__all__ = ['Cylinder', 'Dyad', 'Machine', 'Point', 'read_drawing', 'rods']


def rods(dyads: Iterable[Dyad], density: float, radius: float) -> dict[str, Body]:
    """
    Return {link: Body} with a round rod for every link of the dyads that has a length.

    Other links, as slides, get no body here: add theirs to the result. ``density`` in [kg/m^3],
    ``radius`` in [m].
    """
    return {link: round_rod(length, density, radius) for dyad in dyads
            for link, length in zip(dyad.links, (dyad.length_1, dyad.length_2)) if length}
