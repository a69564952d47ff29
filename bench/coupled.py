# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Coupled to a simulator: a chassis and a rotor in MuJoCo, the linkage in a node, in lock step."""
from contextlib import contextmanager
import runpy
import time

from fourbar_ros import load_scene
from fourbar_ros.mechanisms.points import point_motion
import numpy as np
from scipy.integrate import solve_ivp

from . import ROOT
from .pages import figure, save, table
from .processes import Child

EXAMPLES = ROOT / 'examples'
O1, CHASSIS = np.array([-0.5, 0.2]), 12.0                # place, moment of inertia of the chassis
K, C = np.diag([4e5, 4e5, 2e5]), np.diag([800.0, 800.0, 300.0])
G = np.array([0.0, -9.81])
STEPS = 1e-3, 2.5e-4
MASSES, ROTORS = (60.0, 6.0, 1.5), (20.0, 1.0, 0.2, 0.05)


@contextmanager
def node(scene, outputs):
    """Run the node of an example; give what runs a simulation with it, and times that."""
    from fourbar_ros.clients import LockStep
    child = Child('fourbar', '-m', 'fourbar_ros.ros.node.start', '--ros-args', '--params-file',
                  str(EXAMPLES / 'nodes' / f'{scene}.yaml'))
    lockstep, begin = LockStep(outputs=outputs), 0.0

    def run(simulate, *arguments, until, **others):
        nonlocal begin
        started = time.monotonic()
        way = simulate(lambda stamp, *given, **base: lockstep(begin + stamp, *given, **base),
                       *arguments, until=until, **others)
        begin += until + 1.0            # the stamps of a node rise from one simulation to the next
        return way, time.monotonic() - started
    try:
        yield run
    finally:
        lockstep.close()
        child.stop()


def coupled(linkage, crank, time, state, rates):
    """Return mass matrix and forces of a linkage on a chassis (x, y, phi), from its links."""
    phi, turn = state[2], rates[2]
    motion = linkage.motion(*crank(time))
    rotated = np.array([[np.cos(phi), -np.sin(phi)], [np.sin(phi), np.cos(phi)]])
    matrix, force = np.zeros((3, 3)), np.zeros(3)
    for link, (body, _) in linkage.loads_of_links().items():
        at = point_motion(linkage, motion, link, body.cg_along, body.cg_across)
        r, v, a = (rotated @ part for part in (O1 + at.place, at.velocity, at.acceleration))
        to = np.array([[1.0, 0.0, -r[1]], [0.0, 1.0, r[0]]])     # acceleration by x, y and phi
        own = a - turn**2 * r + 2.0 * turn * np.array([-v[1], v[0]])
        matrix += body.mass * to.T @ to + np.diag([0.0, 0.0, body.inertia])
        force += body.mass * to.T @ (G - own)
        force[2] -= body.inertia * linkage.link_motion(motion, link).alpha
    return matrix, force


def on_a_chassis(linkage, crank, mass):
    """Return the function (time, place, rates) -> accelerations of a chassis with a linkage."""
    own, weight = np.diag([mass, mass, CHASSIS]), np.array([*(mass * G), 0.0])

    def acceleration(time, place, rates):
        matrix, force = coupled(linkage, crank, time, place, rates)
        return np.linalg.solve(own + matrix, force + weight - K @ place - C @ rates)
    return acceleration


def on_a_rotor(linkage, motor, inertia):
    """Return the function (time, angle, rate) -> acceleration of a crank, each in an array."""
    def acceleration(_, angle, rate):
        angle, rate = float(angle[0]), float(rate[0])
        return np.array([(motor(rate) - linkage.bias(angle, rate))
                         / (inertia + linkage.inertia(angle))])
    return acceleration


def followed(acceleration, size, step, until):
    """
    Return times, the exact motion from rest, and that of MuJoCo's integrator, linkage solved for.

    Rows of ``size`` places and their rates.
    """
    times = np.arange(round(until / step) + 1) * step
    exact = solve_ivp(lambda now, state: [*state[size:],
                                          *acceleration(now, state[:size], state[size:])],
                      (0.0, until), np.zeros(2 * size), method='DOP853', rtol=1e-9, atol=1e-11,
                      t_eval=np.minimum(times, until)).y.T
    place, rates, way = np.zeros(size), np.zeros(size), []
    for now in times:
        way.append([*place, *rates])
        rates = rates + step * acceleration(now, place, rates)
        place = place + step * rates
    return times, exact, np.array(way)


def errors(way, exact):
    """Return the largest error of each column over its largest size."""
    return np.abs(way - exact).max(axis=0) / np.abs(exact).max(axis=0)


def row(name, step, ours, implicit, exact, seconds, until):
    """Return a row of a table."""
    one, other = errors(ours, exact), errors(implicit, exact)
    return (name, f'{1e3 * step:g} ms', ', '.join(f'{100 * e:.2g} %' for e in one),
            ', '.join(f'{100 * e:.2g} %' for e in other), f'{(one / other).max():.2f}',
            f'{until / seconds:.1f}')


def main(samples=None):
    """Print both tables; ``samples``: simulated seconds, by default 3 and 2."""
    base, drive = (runpy.run_path(str(EXAMPLES / f'mujoco_{name}.py'))
                   for name in ('chassis', 'motor'))
    head = ('step', 'error in lock step', 'error of the implicit coupling', 'largest ratio',
            'times real time')
    until = samples or 3.0
    linkage = load_scene(EXAMPLES / 'nodes/mujoco_chassis.yaml').linkage
    rows = []
    with node('mujoco_chassis', ('shaking_wrench',)) as run:
        for mass in MASSES:
            for step in STEPS:
                times, exact, implicit = followed(on_a_chassis(linkage, base['crank'], mass), 3,
                                                  step, until)
                exact, implicit = exact[:, :3], implicit[:, :3]
                for asks in (1, 2):
                    ours, seconds = run(base['simulate'], mass, step, until=until, asks=asks)
                    rows.append(row(f'{mass:g} kg, {asks} a step', step, ours, implicit, exact,
                                    seconds, until))
                if (mass, step) == (MASSES[0], STEPS[1]):
                    shown = times, exact, ours
    print('A chassis on springs carries the linkage of 5.8 kg; errors of x, y and angle over '
          'their largest size, against the exact coupled system:\n')
    table(('chassis, asks', *head), rows)
    until, linkage = samples or 2.0, load_scene(EXAMPLES / 'nodes/mujoco_motor.yaml').linkage
    rows = []
    with node('mujoco_motor', ('equation',)) as run:
        for inertia in ROTORS:
            for step in STEPS:
                _, exact, implicit = followed(on_a_rotor(linkage, drive['motor'], inertia), 1,
                                              step, until)
                ours, seconds = run(drive['simulate'], inertia, step, until=until)
                rows.append(row(f'{inertia:g} kg m^2', step, ours, implicit, exact, seconds,
                                until))
    print('\nA motor turns the crank; errors of angle and rate:\n')
    table(('rotor', *head), rows)
    picture(*shown)


def picture(times, exact, ours):
    """Draw the chassis in lock step over the exact one."""
    fig, axes = figure()
    axes.plot(times, 1e3 * exact[:, 0], label='exact')
    axes.plot(times, 1e3 * ours[:, 0], '--', label='MuJoCo and node')
    axes.set_xlabel('time [s]')
    axes.set_ylabel('x of the chassis [mm]')
    axes.legend()
    save(fig, 'coupled')
