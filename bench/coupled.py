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
    """Run the node of an example; give the LockStep with it."""
    from fourbar_ros.clients import LockStep
    child = Child('fourbar', '-m', 'fourbar_ros.ros.node.start', '--ros-args', '--params-file',
                  str(EXAMPLES / 'nodes' / f'{scene}.yaml'))
    lockstep = LockStep(outputs=outputs)
    try:
        yield lockstep
    finally:
        lockstep.close()
        child.stop()


def coupled(linkage, crank, time, state):
    """Return mass matrix and forces of a linkage on a chassis (x, y, phi), from its links."""
    _, _, phi, _, _, turn = state
    motion = linkage.motion(*crank(time))
    rotated = np.array([[np.cos(phi), -np.sin(phi)], [np.sin(phi), np.cos(phi)]])
    matrix, force = np.zeros((3, 3)), np.zeros(3)
    for link, (body, _) in linkage.loads_of_links().items():
        at = point_motion(linkage, motion, link, body.cg_along, body.cg_across)
        r, v, a = (rotated @ part for part in (
            O1 + (at.x, at.y), (at.velocity_x, at.velocity_y),
            (at.acceleration_x, at.acceleration_y)))
        to = np.array([[1.0, 0.0, -r[1]], [0.0, 1.0, r[0]]])     # acceleration by x, y and phi
        own = a - turn**2 * r + 2.0 * turn * np.array([-v[1], v[0]])
        matrix += body.mass * to.T @ to + np.diag([0.0, 0.0, body.inertia])
        force += body.mass * to.T @ (G - own)
        force[2] -= body.inertia * linkage.link_motion(motion, link).alpha
    return matrix, force


def chassis(linkage, crank, mass, step, until):
    """Return the exact motion, and that of MuJoCo's integrator with the linkage solved for."""
    own, weight = np.diag([mass, mass, CHASSIS]), np.array([*(mass * G), 0.0])

    def rates(time, state):
        matrix, force = coupled(linkage, crank, time, state)
        return [*state[3:], *np.linalg.solve(
            own + matrix, force + weight - K @ state[:3] - C @ state[3:])]
    times = np.arange(round(until / step) + 1) * step
    exact = solve_ivp(rates, (0.0, until), np.zeros(6), method='DOP853', rtol=1e-9, atol=1e-11,
                      t_eval=np.minimum(times, until)).y[:3].T
    state, way = np.zeros(6), [np.zeros(3)]
    for now in times[:-1]:
        matrix, force = coupled(linkage, crank, now, state)
        state[3:] += step * np.linalg.solve(
            own + matrix, force + weight - K @ state[:3] - C @ state[3:])
        state[:3] += step * state[3:]
        way.append(state[:3].copy())
    return times, exact, np.array(way)


def rotor(linkage, motor, inertia, step, until):
    """Return the exact motion, and that of MuJoCo's integrator with the linkage solved for."""
    def acceleration(angle, rate):
        return ((motor(rate) - linkage.bias(float(angle), float(rate)))
                / (inertia + linkage.inertia(float(angle))))
    times = np.arange(round(until / step) + 1) * step
    exact = solve_ivp(lambda _, y: [y[1], acceleration(*y)], (0.0, until), [0.0, 0.0],
                      method='DOP853', rtol=1e-9, atol=1e-11,
                      t_eval=np.minimum(times, until)).y.T
    angle = rate = 0.0
    way = [[angle, rate]]
    for _ in times[:-1]:
        rate += step * acceleration(angle, rate)
        angle += step * rate
        way.append([angle, rate])
    return times, exact, np.array(way)


def errors(way, exact):
    """Return the largest error of each column over its largest size."""
    return np.abs(way - exact).max(axis=0) / np.abs(exact).max(axis=0)


def row(name, step, ours, implicit, exact, seconds, until):
    """Return a row of a table, and whether ours is within 1.2 times the implicit coupling."""
    one, other = errors(ours, exact), errors(implicit, exact)
    return (name, f'{1e3 * step:g} ms', ', '.join(f'{100 * e:.2g} %' for e in one),
            ', '.join(f'{100 * e:.2g} %' for e in other), f'{(one / other).max():.2f}',
            f'{until / seconds:.1f}')


def timed(function, *arguments):
    """Return the result of a function, and how long it took [s]."""
    began = time.monotonic()
    return function(*arguments), time.monotonic() - began


def main(samples=None):
    """Print both tables; ``samples``: simulated seconds, by default 3 and 2."""
    base, drive = (runpy.run_path(str(EXAMPLES / f'mujoco_{name}.py'))
                   for name in ('chassis', 'motor'))
    head = ('step', 'error in lock step', 'error of the implicit coupling', 'largest ratio',
            'times real time')
    until = samples or 3.0
    linkage = load_scene(EXAMPLES / 'nodes/mujoco_chassis.yaml').bare_linkage
    rows = []
    with node('mujoco_chassis', ('shaking_wrench',)) as ask:
        for mass in MASSES:
            for step in STEPS:
                times, exact, implicit = chassis(linkage, base['crank'], mass, step, until)
                for asks in (1, 2):
                    ours, seconds = timed(base['simulate'], ask, mass, step, until, asks)
                    rows.append(row(f'{mass:g} kg, {asks} a step', step, ours, implicit, exact,
                                    seconds, until))
                if (mass, step) == (MASSES[0], STEPS[1]):
                    shown = times, exact, ours
    print('A chassis on springs carries the linkage of 5.8 kg; errors of x, y and angle over '
          'their largest size, against the exact coupled system:\n')
    table(('chassis, asks', *head), rows)
    until, linkage = samples or 2.0, load_scene(EXAMPLES / 'nodes/mujoco_motor.yaml').linkage
    rows = []
    with node('mujoco_motor', ('equation',)) as ask:
        for inertia in ROTORS:
            for step in STEPS:
                _, exact, implicit = rotor(linkage, drive['motor'], inertia, step, until)
                ours, seconds = timed(drive['simulate'], ask, inertia, step, until)
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
