# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Problems of the field, and their answers to at least 20 digits.

Each answer was computed by two routes that agree in all its digits: two formulations as Taylor
series in time in ball arithmetic, or Radau IIA of order 27 and 23 for stiff shafts; or quadrature
of the energy integral, which knows no equation of motion. Runs agree with all of them to 1e-9.

P2 is of SUNDIALS, after E. J. Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems
(1989), 6.1.8: of its printed q(10) all digits hold, of its G five. P3 is the IFToMM benchmark A02,
whose community accepts errors of 1e-1 to 1e-3. P4 is Haug's 4.9.2, with 1.98 for a crank; at a
tolerance of 1e-6 scipy reports success with errors of 3e-4 (LSODA) to 1e-3 (BDF).
"""
from collections.abc import Callable
from math import pi
from typing import NamedTuple

from fourbar_ros import Applied, Bodies, Body, External, FourBar, round_rod, SliderCrank
from fourbar_ros.dynamics.system import System
from fourbar_ros.mechanisms.elements import Attachment, Spring
from fourbar_ros.mechanisms.machine.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import mpmath as mp
import numpy as np

# P2, q(10) and its rate: one equation, and three coordinates with multipliers.
P2_POSITION, P2_RATE = '1.27567584865023941071419054572', '-0.23991499719600068392576030065'
# P2, integral of the kinetic energy to 10 s: G of the source, by the same two series.
P2_ENERGY = '3.33660679948278440821761539279'
# P4, crank angle at 4.99 s: quadrature of (F1) in 30 digits, and Taylor series.
P4_POSITION = '26.5492929885905007592319343928785'
# P6: the paper's crank-rocker, a motor line of 400 N m and 26 rad/s, a rotor of 0.5 kg m^2 and an
# elastic shaft {stiffness: crank angle and rate, rotor angle and rate at 0.5 s}.
P6 = {
    10**3: (11.053036712758026133077, 26.847146032521329859387,
            11.182640094591427197152, 22.616586794746154384684),
    10**5: (11.370083234362233117973, 23.18074685696328244752,
            11.371307489533053719505, 23.199975211721346343545),
    10**7: (11.374256246971480389396951, 23.170163961325954539022420,
            11.374268516280366070581463, 23.170352832577040134510496),
    10**9: (11.374296030790494060791513, 23.170068884951790983601438,
            11.374296153485998498505213, 23.170070773324093107434555)}


def sundials_slider_crank():
    """P2: LLNL/sundials, examples/idas/serial/idasSlCrank_dns.c, after Haug 6.1.8."""
    spring = Spring(Attachment('crank', 0.25), Attachment('coupler', 0.5), 1.0, free_length=1.0,
                    damping=1.0)
    # its generalized forces, F on x and -F sin p on the angle p of the rod, are those of 2 F on
    # the slider and -F on the crank pin, as x = cos p + a cos q
    slider_crank = SliderCrank(
        0.5, 1.0, bodies=Bodies(Body(0.0, inertia=1.0), Body(0.0, inertia=2.0), Body(1.0)),
        external=External(Applied(force_x=-1.0), Applied(force_x=2.0)), elements=(spring,))
    return System(slider_crank, pi / 2)


def one_window():
    """P3, N = 1: a parallelogram of rods, 1 m and 1 kg, upright, the upper at 1 m/s."""
    rod = Body(1.0, cg_along=0.5, inertia=1.0 / 12.0)
    parallelogram = FourBar(1.0, 1.0, 1.0, 1.0, bodies=Bodies(rod, rod, rod), gravity=(0.0, -9.81))
    return System(parallelogram, pi / 2, -1.0)


def windows(count):
    """P3: so many windows side by side as a machine, each post the crank of the next."""
    dyads, post = [], 'crank'
    for i in range(count):
        dyads.append(Dyad(f'window{i}', 'RRR', Point(post, 1.0), Point('ground', i + 1.0),
                          (f'beam{i}', f'post{i}'), length_1=1.0, length_2=1.0))
        post = f'post{i}'
    links = ['crank', *(link for dyad in dyads for link in dyad.links)]
    bodies = dict.fromkeys(links, Body(1.0, cg_along=0.5, inertia=1.0 / 12.0))
    return System(Machine(dyads, bodies=bodies, gravity=(0.0, -9.81)), pi / 2, -1.0)


def windows_exact(time, count):
    """Return theta1 of P3: a pendulum that goes round, in elliptic functions."""
    posts = mp.mpf(count + 1)
    strength = mp.mpf('9.81') * (posts / 2 + count) / (posts / 3 + count)
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


def wheel(inertia=2.0, **options):
    """Return a linkage of which only the crank has mass: a flywheel, J constant."""
    nothing = Body(0.0)
    return FourBar(0.4, 1.2, 0.8, 1.0, bodies=Bodies(Body(0.0, inertia=inertia), nothing, nothing),
                   **options)


# --- extremes: J changes by many powers of ten within a small angle -----------------------------


def light_crank(inertia=1e-6):
    """Return a heavy slider on a light crank: at the dead centres the crank alone is left of J."""
    slider_crank = SliderCrank(0.5, 1.0, bodies=Bodies(Body(0.0, inertia=inertia), Body(0.0),
                                                       Body(1.0)))
    return System(slider_crank, 0.5, 1.0)


def near_change_point(gap=1e-6):
    """Rods of a linkage that lies flat but for a gap: its output whips past the flat position."""
    rod = Body(1.0, cg_along=0.5, inertia=1.0 / 12.0)
    linkage = FourBar(0.5, 1.0, 1.0, 0.5 + gap, bodies=Bodies(rod, rod, rod))
    return System(linkage, 1.0, 3.0)


def light_rods(mass=1e-8):
    """Return a heavy output link on rods of hardly any mass: dead points of the output."""
    bodies = Bodies(Body(mass, cg_along=0.2, inertia=mass), Body(mass, cg_along=0.6, inertia=mass),
                    Body(2.0, cg_along=0.4, inertia=0.3))
    return System(FourBar(0.4, 1.2, 0.8, 1.0, bodies=bodies), 0.5, 1.0)


class Extreme(NamedTuple):
    """A free linkage of which J changes suddenly, and its position after 2 s and 3 s."""

    make: Callable
    at: dict


# By quadrature of (F1) in 40 digits, with the rates of the bodies from the angles of the loop.
EXTREMES = {
    'light crank 1e-6': Extreme(light_crank, {
        2.0: 1.9151624315388963, 3.0: 4.1330009533757003}),
    'light crank 1e-12': Extreme(lambda: light_crank(1e-12), {
        2.0: 1.9151587246847359, 3.0: 4.1330829651592008}),
    'light rods 1e-8': Extreme(light_rods, {2.0: 1.0899490728257863, 3.0: 1.2837462071995263}),
    'near a change point 1e-6': Extreme(near_change_point, {
        2.0: 6.2831861117089765, 3.0: 8.2681015999691376}),
    'near a change point 1e-10': Extreme(lambda: near_change_point(1e-10), {
        2.0: 6.2831853072594648, 3.0: 8.2613077553201190}),
    'near lock-up 1e-2': Extreme(near_lock_up, {2.0: 11.294986445254462, 3.0: 16.804867726026118}),
    'near lock-up 1e-8': Extreme(lambda: near_lock_up(2.0 * (1.0 - 1e-8)), {
        2.0: 11.116176647707732, 3.0: 15.819194659816398})}


def samples(linkage, seed, count=20):
    """Yield (input, rate, acceleration) in the first range of the input."""
    (low, high), *_ = linkage.input_ranges
    rng = np.random.default_rng(seed)
    for share, rate, acceleration in rng.uniform((0.05, -9.0, -50.0), (0.95, 9.0, 50.0),
                                                 (count, 3)).tolist():
        yield low + share * (high - low), rate, acceleration


def steps(mover, count, tick=1e-3, command=0.0):
    """Return how each of so many steps of the node went, from its start."""
    state, went = mover.first, []
    for _ in range(count):
        went.append(mover.advance(state, tick, command))
        state = went[-1].state
    return went
