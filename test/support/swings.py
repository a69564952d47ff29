# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Linkages of all kinds whose input turns back at toggle positions, let go with a rate."""
from fourbar_ros import Bodies, Body, FourBar, InvertedSlider, SliderCrank

BODIES = Bodies(Body(1.0, cg_along=0.2, cg_across=0.05, inertia=0.1),
                Body(2.0, cg_along=0.6, cg_across=0.1, inertia=0.2),
                Body(1.5, cg_along=0.4, cg_across=-0.1, inertia=0.1))
PULL = {'gravity': (0.3, -9.81), 'bodies': BODIES}
CASES = {
    'non-Grashof': (FourBar(1.0, 0.8, 0.9, 2.0, **PULL), 0.5, 2.0),
    'non-Grashof, other class': (FourBar(1.0, 1.0, 2.0, 0.9, **PULL), 2.5, 1.0),
    'rocker of a crank-rocker': (FourBar(0.8, 1.2, 0.4, 1.0, **PULL), 1.4, 4.0),
    'rocker of a double-rocker': (FourBar(0.8, 0.4, 1.0, 1.1, **PULL), 0.9, 3.0),
    'driven slider': (SliderCrank(0.5, 1.3, 0.1, input='slide', **PULL), 1.2, 3.0),
    'crank longer than its coupler': (SliderCrank(1.5, 1.0, 0.1, **PULL), 0.3, 4.0),
    'cylinder': (InvertedSlider(0.5, 1.2, 0.2, input='slide', **PULL), 1.1, 3.0),
    'inverted, with limits': (InvertedSlider(0.7, 1.2, 0.8, **PULL), 2.5, 3.0),
}


class Alone(FourBar):
    """A linkage of which no other coordinate is known."""

    def driven_otherwise(self):
        return ()
