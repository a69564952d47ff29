# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The classics of a lecture, scenes in config/classics, each against its textbook property."""
from dataclasses import replace
from math import pi

from fourbar_ros import find_extrema, load_scene, point_motion
from fourbar_ros.scene.files import folder
import numpy as np
import pytest

EPS = 2.0**-52
SCENES = {file.stem: file for file in sorted((folder() / 'classics').glob('*.yaml'))}
TURN = np.linspace(-pi, pi, 361)[:-1] + 1e-3      # of a crank
NEAR = np.array([1e-3, 1e-6, 1e-9, 1e-12])        # of a flat position


def machine_of(name):
    return load_scene(SCENES[name]).linkage


def traced(name, inputs, rate=1.0, machine=None):
    """Return the motion of the first point of a scene: of another machine if given."""
    scene = load_scene(SCENES[name])
    machine = machine or scene.linkage
    point, = scene.points.values()
    return point_motion(machine, machine.motion(inputs, rate), point.link, point.along,
                        point.across)


def inside(machine, share=1e-3, count=201):
    """Return inputs over the widest range of a machine, without its ends."""
    low, high = max(machine.input_ranges, key=lambda ends: ends[1] - ends[0])
    return np.linspace(low + share * (high - low), high - share * (high - low), count)


def close(found, wanted, times=16.0, size=1.0):
    assert np.abs(found - wanted).max() <= times * EPS * size


def test_scenes_are_short_and_found_by_their_names():
    assert len(SCENES) == 20
    for name, file in SCENES.items():
        lines = file.read_text(encoding='utf-8').splitlines()
        assert len(lines) <= 26 and lines[0].startswith('# '), name
        assert load_scene(name).linkage == machine_of(name)


# --- exact lines ---------------------------------------------------------------------------------

def test_scott_russell_draws_the_y_axis():
    theta = np.concatenate([TURN, *(flat + side * NEAR for flat in (0.5 * pi, -0.5 * pi)
                                    for side in (-1.0, 0.0, 1.0))])
    point = traced('scott_russell', theta)
    close(point.x, 0.0)
    close(point.y, 0.4 * np.sin(theta))
    close(point.velocity_y, 0.4 * np.cos(theta))
    close(point.acceleration_y, -0.4 * np.sin(theta))


# square: what O P times O Q is, by the rods; diameter: of the circle that P runs on
@pytest.mark.parametrize('name, square, diameter, pivot, times', [
    ('peaucellier', 0.4**2 - 0.15**2, 0.3, 0.15, 64),
    ('hart', 0.25 * (0.5**2 - 0.2**2), 0.2, 0.1, 256)])
def test_inversors_draw_a_line(name, square, diameter, pivot, times):
    machine = machine_of(name)
    theta = inside(machine)
    point = traced(name, theta)
    close(point.x + pivot, square / diameter, times)
    close(point.y, square / diameter * np.tan(0.5 * theta), times)
    assert np.all(machine.transmission_sine(machine.motion(theta)) != 0.0)


# --- parallelograms ------------------------------------------------------------------------------

@pytest.mark.parametrize('name', ['parallelogram', 'coupling_rod'])
def test_wheels_turn_alike_and_rods_do_not_turn(name):
    machine = machine_of(name)
    theta = np.concatenate([TURN, TURN + 4.0 * pi, 0.0 * NEAR, NEAR, pi - NEAR, NEAR - pi, -NEAR])
    radius = machine.dyads[0].first.along
    motion = machine.motion(theta, 2.0, 3.0)
    for dyad in machine.dyads:
        rod, wheel = dyad.links
        close(getattr(motion, f'omega_{wheel}'), 2.0, 8, 2.0)
        close(getattr(motion, f'alpha_{wheel}'), 3.0, 8, 30.0)
        for rate in ('theta', 'omega', 'alpha'):
            close(getattr(motion, f'{rate}_{rod}'), 0.0, 8, 30.0)
        point = point_motion(machine, motion, rod, 0.4, 0.1)
        start = sum(one.length_1 for one in machine.dyads[:machine.dyads.index(dyad)])
        close(point.x, start + 0.4 + radius * np.cos(theta), 8, 4.0)
        close(point.y, 0.1 + radius * np.sin(theta), 8, 4.0)


def test_the_antiparallelogram_turns_as_two_ellipses_that_roll():
    machine = machine_of('antiparallelogram')
    a, d, theta = 0.2, 0.5, np.concatenate([TURN, TURN + 4.0 * pi, 0.0 * NEAR, NEAR, pi - NEAR])
    ratio = -(d * d - a * a) / (d * d + a * a - 2.0 * a * d * np.cos(theta))
    close(machine.motion(theta, 1.0).omega_rocker, ratio, 16, 3.0)


def test_a_scissor_lift_of_two_stages():
    machine = machine_of('scissor_lift')
    x = np.linspace(0.31, 1.09, 79)
    motion, loads = machine.step(x, 0.2)
    height = np.sqrt(1.44 - x * x)
    table = point_motion(machine, motion, 'outer_2', along=1.2)
    close(table.x, x, 64)
    close(table.y, 2.0 * height, 64, 4.0)
    close(table.velocity_y, -0.4 * x / height, 64, 4.0)
    close(loads.driving_force / (-4000.0 * x / height), 1.0, 256)


# --- approximate lines ---------------------------------------------------------------------------

LAST = np.arccos(1.0 / 1.2)             # of Roberts: 1.2 from both pivots, the apex at one of them
FIRST = LAST + 2.0 * np.arcsin(0.5 / 1.2)
# scene: inputs, the point on the line at some of them, the line's axis and place, how long the
# point's way along it is at least, within which bounds its largest deviation is
LINES = {
    'watt_line': ((-0.35, 0.35), {}, 'x', 0.5, 0.3, (0.0, 2.5e-3)),
    'roberts': ((LAST, FIRST), {FIRST: 0.0, np.arccos(0.5 / 1.2): 1.0, LAST: 2.0}, 'y', 0.0, 1.9,
                (0.01, 0.014)),
    'chebyshev': ((np.arctan2(3.0, 4.0), 0.5 * pi), {0.5 * pi: 0.0, np.arctan2(4.0, 3.0): 0.2},
                  'y', 0.4, 0.3, (0.9e-3, 1e-3)),
    'evans': ((-0.6, 0.6), {}, 'x', 0.0, 0.4, (0.0, 1.5e-4)),
    'hoeken': ((0.5 * pi, 1.5 * pi), {0.5 * pi: 0.4, pi: 0.2, 1.5 * pi: 0.0}, 'y', 0.4, 0.39,
               (0.8e-3, 1e-3)),
}


@pytest.mark.parametrize('name', LINES)
def test_a_point_stays_near_its_line(name):
    ends, met, axis, place, way, (least, most) = LINES[name]
    point = traced(name, np.linspace(*ends, 181)[1:-1])
    off, along = getattr(point, axis) - place, getattr(point, 'xy'.replace(axis, ''))
    assert np.ptp(along) > way and least < np.abs(off).max() < most
    for theta, at in met.items():           # circles meet there
        there = traced(name, float(theta))
        close(getattr(there, axis) - place, 0.0, 64, 2.0)
        close(getattr(there, 'xy'.replace(axis, '')) - at, 0.0, 64, 2.0)


def test_hoeken_goes_steadily():
    theta = np.linspace(0.15 * pi, 0.85 * pi, 181) + 0.5 * pi
    mean = 0.4 / (0.5 * pi)                                         # in half a turn at 2 rad/s
    assert np.abs(-traced('hoeken', theta, rate=2.0).velocity_x / mean - 1.0).max() < 0.15


# --- legs, presses, pumps, engines ---------------------------------------------------------------

def test_klann_walks():
    machine = machine_of('klann')
    assert machine.turns_fully
    point = traced('klann', TURN)
    stands = point.y < point.y.min() + 0.15 * np.ptp(point.y)
    assert 0.45 < stands.mean() < 0.55          # half a turn
    assert np.ptp(point.x[stands]) > 0.85 * np.ptp(point.x)
    assert abs(np.sign(point.velocity_x[stands]).mean()) > 0.7       # it goes one way
    assert (stands & ~np.roll(stands, 1)).sum() == 1       # one step a turn


def test_the_pads_of_a_gripper_stay_parallel():
    machine, points = machine_of('gripper'), load_scene(SCENES['gripper']).points
    s = np.linspace(*machine.input_ranges[0], 84)
    motion, loads = machine.step(s, 0.01)
    left, right = (point_motion(machine, motion, *points[name]) for name in ('left', 'right'))
    for side in ('left', 'right'):
        close(np.exp(1j * getattr(motion, f'theta_{side}_finger')), -1.0, 64)
        close(getattr(motion, f'omega_{side}_finger'), 0.0, 256, 2.0)
    close(left.x - right.x, 0.0, 256)
    close(left.y + right.y, 0.0, 256)
    # force times way of the nut = twice 20 N times way of a pad, without the weight of rods
    light = replace(machine, bodies={})
    close(light.loads(s).driving_force, -2.0 * 20.0 * left.velocity_y / 0.01, 1e4, 40.0)


def test_the_arms_of_a_door_closer():
    machine = machine_of('door_closer')
    spindle, frame, arm, forearm = 0.2 + 0.05j, 0.4 + 0.05j, 0.24, 0.32
    # it opens until the arms are in line
    r, d = abs(spindle), abs(frame)
    between = np.arccos((r * r + d * d - (arm + forearm)**2) / (2.0 * r * d))
    wide = between + np.angle(frame) - np.angle(spindle)
    assert max(machine.input_ranges[0]) == pytest.approx(wide, abs=1e-12)
    theta = np.linspace(0.0, 0.5 * pi, 91)
    motion = machine.motion(theta, 1.0)
    leverage = np.abs(motion.omega_arm - 1.0)       # of the spring's moment on the door
    assert leverage.max() == leverage[:15].max() > 1.4 * leverage[-1]       # it latches


@pytest.mark.parametrize('name, lever, crank, rod, arm, ground', [
    ('wiper', 'left_lever', 0.045, 0.25, 0.06, np.hypot(0.25, 0.06)),
    ('wiper', 'right_lever', 0.045, 0.25, 0.06, np.hypot(0.25, 0.06)),
    ('pumpjack', 'beam', 0.9, 2.9, 2.5, np.hypot(2.4, 2.8))])
def test_a_lever_swings_between_crank_and_rod_in_line(name, lever, crank, rod, arm, ground):
    far, near = (np.arccos((ground**2 + arm**2 - reach**2) / (2.0 * ground * arm))
                 for reach in (rod + crank, rod - crank))
    found = [e.value for e in find_extrema(machine_of(name), (f'theta_{lever}',))]
    assert max(found) - min(found) == pytest.approx(far - near, abs=64 * EPS)


def test_a_wiper_swings_without_a_toggle():
    machine, points = machine_of('wiper'), load_scene(SCENES['wiper']).points
    motion = machine.motion(TURN)
    assert machine.turns_fully
    assert 95.0 < np.degrees(np.ptp(np.unwrap(motion.theta_left_lever))) < 105.0
    assert np.abs(np.sin(motion.theta_left_lever - motion.theta_rod)).min() > np.sin(pi / 6.0)
    left, right = (point_motion(machine, motion, *points[name]) for name in ('left', 'right'))
    close(right.x - left.x, 0.5, 256)
    close(right.y, left.y, 256)


def test_a_toggle_press_has_no_bound():
    machine = replace(machine_of('toggle_press'), bodies={})
    straight = np.arccos(1.0 / 12.0)
    for side in (1.0, -1.0):
        torque = machine.loads(straight + side * NEAR[:3]).driving_torque
        advantage = 5000.0 / np.abs(torque)             # force for a torque of 1 N m
        assert (advantage[1:] / advantage[:-1] > 900.0).all()


def orders(machine, rate):
    """Return {order: size} of the shaking force in one turn, as vectors that turn."""
    theta = 2.0 * pi * np.arange(256) / 256.0
    loads = machine.loads(theta, rate)
    sizes = np.fft.fft(loads.shaking_force_x + 1j * loads.shaking_force_y) / 256.0
    return {k: abs(sizes[k]) for k in range(-16, 17)}


def test_a_radial_engine_of_five():
    found = orders(machine_of('radial_engine'), 100.0)
    theta = 2.0 * pi * np.arange(256) / 256.0
    place = 0.06 * np.cos(theta) + np.sqrt(0.22**2 - (0.06 * np.sin(theta))**2)
    series = np.fft.fft(place).real / 256.0 * np.arange(-128, 128).take(
        np.arange(256) - 128)**2 * 100.0**2           # of the acceleration of one piston
    for k, size in found.items():
        # five pistons in five directions: orders k with k - 1 a multiple of 5; the first balanced
        wanted = 5.0 * abs(series[k]) if k % 5 == 1 and k != 1 else 0.0
        assert abs(size - wanted) < 1e-10 * 600.0, k
    assert found[-4] > 8.0


def test_a_v8():
    found = orders(machine_of('v8'), 100.0)
    one = 0.37 * 0.045 * 100.0**2          # of one rod's mass at the pin [N]
    assert all(size < 1e-12 * one for k, size in found.items() if k % 4 or not k)
    assert 0.001 * one < found[4] < 0.02 * one
