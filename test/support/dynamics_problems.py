# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Reference problems of the field, and their answers to at least 20 digits (docs/dynamics.md)."""
from math import pi

from fourbar_ros import Applied, Bodies, Body, External, FourBar, round_rod, SliderCrank
from fourbar_ros.dynamics.elements import Attachment, Spring
from fourbar_ros.dynamics.system import System
import mpmath as mp

# P2, q(10) and its rate: two formulations by Taylor series agree in all of these digits.
P2_POSITION, P2_RATE = '1.27567584865023941071419054572', '-0.23991499719600068392576030065'
# P4, crank angle at 4.99 s: quadrature of (F1) in 30 digits, and Taylor series.
P4_POSITION = '26.5492929885905007592319343928785'


def sundials_slider_crank():
    """P2: LLNL/sundials, examples/idas/serial/idasSlCrank_dns.c, after Haug 6.1.8."""
    # its generalized forces, F on x and -F sin p on the angle p of the rod, are those of 2 F on
    # the slider and -F on the crank pin, as x = cos p + a cos q
    slider_crank = SliderCrank(
        0.5, 1.0, bodies=Bodies(Body(0.0, inertia=1.0), Body(0.0, inertia=2.0), Body(1.0)),
        external=External(Applied(force_x=-1.0), Applied(force_x=2.0)))
    spring = Spring(Attachment('crank', 0.25), Attachment('coupler', 0.5), 1.0, 1.0, 1.0)
    return System(slider_crank, pi / 2, 0.0, [spring])


def one_window():
    """P3, N = 1: a parallelogram of rods, 1 m and 1 kg, upright, the upper at 1 m/s."""
    rod = Body(1.0, 0.5, 0.0, 1.0 / 12.0)
    parallelogram = FourBar(1.0, 1.0, 1.0, 1.0, bodies=Bodies(rod, rod, rod), gravity=(0.0, -9.81))
    return System(parallelogram, pi / 2, -1.0)


def one_window_exact(time):
    """Return theta1 of P3, N = 1: a pendulum that goes round, in elliptic functions."""
    strength = mp.mpf('9.81') * 2 / (mp.mpf(2) / 3 + 1)
    energy = mp.mpf(1) / 2 + strength
    m, speed = 2 * strength / (energy + strength), mp.sqrt((energy + strength) / 2)
    quarter = mp.ellipk(m)
    u = speed * time + quarter
    turns = mp.floor(u / (2 * quarter) + mp.mpf(1) / 2)
    half = turns * mp.pi + mp.asin((-1)**int(turns) * mp.ellipfun('sn', u, m=m))
    return 3 * mp.pi / 2 - 2 * half


def near_lock_up(crank=1.98):
    """P4: Haug 4.9.2, a slider-crank near lock-up, free at 10 rad/s; energy 1000 J."""
    slider_crank = SliderCrank(crank, 2.0, bodies=Bodies(Body(0.0, inertia=20.0), Body(0.0),
                                                         Body(20.0)))
    return System(slider_crank, 0.0, 10.0)


def paper_linkage(**options):
    """Return the crank-rocker of config/paper.yaml."""
    rods = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8)))
    return FourBar(0.4, 1.2, 0.8, 1.0, bodies=rods, **options)
