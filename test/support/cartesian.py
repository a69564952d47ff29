# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Machines to many digits in Cartesian coordinates of all links: no dyad is solved here.

A link has the place x, y of its first joint and its angle phi. A joint forbids C(q) = 0: a pin
two coordinates, a slide one and the turn, the drive the last. Newton's iteration finds the pose,
the Jacobian J of the same constraints the rates, and J transposed all reactions at once, from one
dense system of Newton and Euler.

Numbers stand in columns: the first has the machine as it is, each other has one datum moved by
step() of itself. By how much results differ from column to column is their condition.
"""
from copy import copy
from typing import NamedTuple

from flint import acb, arb, arb_mat, ctx
from fourbar_ros import Applied, Base
from fourbar_ros.machine import Machine
from fourbar_ros.mechanisms.kinds import kind_of, KINDS
from fourbar_ros.numerics.number_types import direction
import mpmath as mp
import numpy as np
from scipy.linalg import qr

EPS = 2.0**-52
BITS, MANY_BITS = 512, 1600      # MANY: next to exact change points
ANGLES = 'theta', 'beta'         # how fields begin that count modulo a turn
BEGIN = 0.01                     # from where a change point is approached [rad or m]
mp.mp.dps = 150                  # what tests compute by hand
GROUND, J = 'ground', acb(0, 1)
NONE, ONE, ZERO = acb(0), acb(1), arb(0)

conj, real, imag, middle, exp, log = (np.frompyfunc(f, 1, 1) for f in (
    lambda z: z.conjugate(), lambda z: z.real, lambda z: z.imag, lambda z: z.mid(),
    lambda z: z.exp(), lambda z: z.log()))


def step():
    return arb(2)**(-ctx.prec // 2)


def number(value):
    """Return a number, also one of mpmath, as it is."""
    if not isinstance(value, mp.mpf):
        return arb(value)
    sign, mantissa, exponent, _ = value._mpf_
    return arb(-int(mantissa) if sign else int(mantissa)) * arb(2)**exponent


def of_mpmath(value):
    """Return a real number for mpmath."""
    mantissa, exponent = value.mid().man_exp()
    return mp.mpf(int(mantissa)) * mp.mpf(2)**int(exponent)


class Columns:
    """Makes numbers in 1 + ``count`` columns, the next one moved in each; counts them in used."""

    def __init__(self, count=0, used=0):
        self.count, self.used = count, used

    def real(self, value, weight=None):
        """Return a number; ``weight``: what is moved by, if not the number."""
        self.used += 1
        column = np.full(1 + self.count, number(value), object)
        if self.count:
            column[self.used] += step() * (column[0] if weight is None else weight)
        return column

    def point(self, along, across):
        return self.real(along) + J * self.real(across)

    def direction(self, angle):
        """Return a direction whose cosine and sine are data; exact at right angles."""
        cosine, sine = direction(angle)
        exact = acb(cosine, sine) if 0.0 in (cosine, sine) else (J * number(angle)).exp()
        return exact * exp(J * self.real(0.0, 2.0 * cosine * sine))


class Joint(NamedTuple):
    """Point a of link i on point b of link j; or on the line through it, if i slides along j."""

    name: str
    i: str
    a: object
    j: str
    b: object
    turn: object = None       # the direction of i, and of the line, seen from j
    is_driven: bool = False


class Kind(NamedTuple):
    """A four-bar or one with sliders, by its name, lengths and input: joints, pose, names."""

    name: str
    lengths: tuple
    sign: int
    input: str
    bodies: object = None
    external: object = None
    gravity: tuple = (0.0, 0.0)
    is_flat: bool = False         # at a change point: its mode is a branch, not the sign of mode()

    @property
    def moving(self):
        return 'crank', 'coupler', 'output'

    @property
    def driven_pair(self):
        """Return the links between which the drive turns; at B the angle counts from behind."""
        pairs = {'A': ('coupler', 'crank'), 'B': ('output', 'coupler')}
        return pairs.get(self.input, ('crank', GROUND))

    def joints(self, data, here, along):
        """Return O1, A, and the joints at both ends of the output link."""
        a, *others = (data.real(v) for v in self.lengths)
        found = [Joint('base', 'crank', here, GROUND, here)]
        pin_a, is_slide = Joint('A', 'coupler', here, 'crank', a), self.input == 'slide'
        if self.name == 'inverted_slider':
            a4, offset = others
            return [*found, pin_a,
                    Joint('inner', 'coupler', here, 'output', J * offset, along, is_slide),
                    Joint('outer', 'output', here, GROUND, a4)]
        if self.name == 'four_bar':
            a2, a3, a4 = others
            return [*found, pin_a, Joint('inner', 'coupler', a2, 'output', a3),
                    Joint('outer', 'output', here, GROUND, a4)]
        inner = (Joint('inner', 'coupler', others[0], 'output', here)
                 if self.name == 'slider_crank' else
                 Joint('inner', 'coupler', here, 'output', here, J * along))
        return [*found, pin_a, inner,
                Joint('outer', 'output', here, GROUND, J * others[-1], along, is_slide)]

    def mode(self, found):
        """Return what has the sign of the assembly mode."""
        (a, *_), (e, *_) = found.link('coupler')
        if self.input in 'AB':
            (opposite, *_) = found.link('output' if self.input == 'A' else 'crank')[1]
            return imag(opposite)
        if self.name == 'four_bar':
            return imag(conj(acb(self.lengths[3]) - a) * e)
        if self.name == 'slider_crank' and self.input == 'crank':
            return real(e)
        if self.name == 'slider_crank':
            return imag(conj(a) * found.link('output')[0][0])
        if self.name == 'inverted_slider' and self.input == 'crank':
            return real(conj(e) * (a - acb(self.lengths[1])))
        return imag(a) if self.input == 'slide' else np.array([arb(self.sign)])

    def fields(self, found):
        """Return the fields of motion and of loads: columns, those of forces complex."""
        crank, coupler, output = ([found.angle(name, order) for order in range(3)]
                                  for name in self.moving)
        between = [one - other for one, other in zip(coupler, crank)]
        motion = {**_named('theta1 omega1 alpha1', crank), **_named('theta2 omega2 alpha2',
                                                                    between)}
        if self.name in ('four_bar', 'slider_crank'):
            motion |= _named('beta omega_beta alpha_beta', coupler)
            last = [one - other for one, other in zip(output, coupler)]
            last[0] = last[0] + (arb.pi() if self.name == 'four_bar' else 0)
            motion |= _named('theta3 omega3 alpha3', last)
        if self.name in ('four_bar', 'inverted_slider'):
            motion |= _named('theta4 omega4 alpha4', output)
        names = {'inverted_slider': ['slide'], 'slider_crank': ['slide'],
                 'scotch_yoke': ['slot', 'slide']}.get(self.name, ())
        sliding = [joint for joint in found.joints if joint.turn is not None]
        for name, joint in zip(names, sliding):
            p, q, t = found.ends(joint)
            gap = [one - other for one, other in zip(p, q)]
            motion |= _named(f'{name} {name}_velocity {name}_acceleration', [
                real(leibniz(t, gap, order)) for order in range(3)])
        if not self.bodies:
            return motion, {}
        found = found.loads()
        loads = {'f41': found['base'], 'f21': -found['A'], 'f32': found['inner'],
                 'f43': found['outer'], 'driving_torque': found['driving_torque'],
                 'shaking_force': found['shaking_force'],
                 'shaking_moment': found['shaking_moment'],
                 'driving_power': found['driving_power']}
        if names:
            joint = sliding[-1].name
            loads |= {'guide_force': found[f'{joint}_normal'],
                      'guide_couple': found[f'{joint}_couple'],
                      'driving_force': found['driving_force']}
        if self.name == 'scotch_yoke':
            loads['slot_couple'] = found['inner_couple']
        return motion, loads


def _named(names, levels):
    return dict(zip(names.split(), levels))


def joints_of(machine, data):
    """Return the joints of a machine, that of the driven link first."""
    here, along = np.full(1 + data.count, NONE, object), np.full(1 + data.count, ONE, object)
    if isinstance(machine, Kind):
        return machine.joints(data, here, along)
    is_slide = machine.input == 'slide'
    found = [Joint('base', machine.layout.driven, here, machine.layout.links[0], here,
                   along if is_slide else None, is_slide)]
    for dyad in machine.stages:
        (one, two), (p, q) = dyad.links, (data.point(*at[1:]) for at in (dyad.first, dyad.second))
        its = {name: value for name in ('length_1', 'length_2', 'offset', 'direction_1',
                                        'direction_2', 'slot')
               if (value := getattr(dyad, name)) is not None}
        its = {name: data.real(value) if name[0] in 'lo' else data.direction(value)
               for name, value in its.items()}
        inner_turn = along if dyad.kind == 'RPR' else its.get('slot')
        a, b = its.get('length_1', here), its.get('length_2', J * its.get('offset', here))
        found += [
            Joint(f'{dyad.name}_first', one, here, dyad.first.link, p, its.get('direction_1')),
            Joint(f'{dyad.name}_inner', one, a, two, b, inner_turn, dyad.name == 'cylinder'),
            Joint(f'{dyad.name}_second', two, here, dyad.second.link, q, its.get('direction_2'))]
    return found


def leibniz(one, other, order):
    """Return the derivative of conj(one) other from the derivatives of both."""
    return sum(n * conj(one[r]) * other[order - r]
               for r, n in enumerate(((1,), (1, 1), (1, 2, 1))[order]))


class Cartesian:
    """
    A machine at an input with a rate and an acceleration.

    ``q``: its three arrays (links, 3, columns) have x, y, phi of the moving links, and their first
    and second derivatives by time.

    Parameters
    ----------
    machine : Machine or Kind
    given : tuple of 3 numbers
    near : array (links, 3) or Cartesian
        A pose near the one that is wanted; or the machine in one column, for its conditions.

    """

    def __init__(self, machine, given, near):
        self.machine = machine
        self.names = machine.moving if isinstance(machine, Kind) else machine.layout.moving
        is_solved = isinstance(near, Cartesian)
        data = Columns()
        self.read(given, data)
        if is_solved:
            self.read(given, Columns(data.used))
        self.count, self.known = len(self.given[0]), {}
        self.q = [np.full((len(self.names), 3, self.count), ZERO, object) for _ in range(3)]
        if is_solved:
            for level, exact in zip(self.q, near.q):
                level[:] = exact
            self.inverse = near.inverse
        else:
            self.q[0][:, :, 0] = np.vectorize(arb, otypes=[object])(near)
            self.newton()
            self.inverse = self.jacobian().inv()
        for order in range(not is_solved, 3):
            self.move(order, self.inverse * arb_mat(self.forbidden(order).tolist()))

    def read(self, given, data):
        self.joints = joints_of(self.machine, data)
        x, *rates = map(number, given)
        # of an angle only the part beyond full turns counts
        turn = 2 * arb.pi()
        turns = 0 if self.machine.input in ('slide', 'cylinder') else round(float(x / turn))
        self.given = [data.real(x, x - turns * turn), *map(data.real, rates)]

    def move(self, order, step):
        step = np.array(step.tolist(), object).reshape(self.q[order].shape)
        self.q[order] = middle(self.q[order] - step)
        self.known = {}
        return max(abs(float(v)) for v in step.flat)

    def newton(self):
        for _ in range(60):
            size = self.move(0, self.jacobian().solve(
                arb_mat(self.forbidden(0).tolist())))
            if size < 2.0**(-0.6 * ctx.prec):
                return
            if not size < 1e9:
                break
        raise ArithmeticError('Newton does not converge')

    def link(self, name):
        """Return z and e of a link, each with two derivatives."""
        if name not in self.known:
            self.known[name] = self.moved(name)
        return self.known[name]

    def moved(self, name):
        if name == GROUND:
            none = np.full(self.count, NONE, object)
            return [none] * 3, [none + ONE, none, none]
        (x, y, phi), (dx, dy, turn), (ddx, ddy, bend) = (
            level[self.names.index(name)] for level in self.q)
        e = exp(J * phi)
        return ([x + J * y, dx + J * dy, ddx + J * ddy],
                [e, J * turn * e, (J * bend - turn * turn) * e])

    def angle(self, name, order):
        return ZERO if name == GROUND else self.q[order][self.names.index(name), 2]

    def driven_pair(self):
        return (getattr(self.machine, 'driven_pair', None)
                or ('crank', self.machine.layout.links[0]))

    def turned_by_the_drive(self, order):
        i, j = self.driven_pair()
        half = arb.pi() if self.machine.input == 'B' and not order else ZERO
        return self.angle(i, order) - self.angle(j, order) + half

    def ends(self, joint):
        """Return the points of both links of a joint and the direction of its line, by time."""
        if joint.name in self.known:
            return self.known[joint.name]
        (z_i, e_i), (z_j, e_j) = self.link(joint.i), self.link(joint.j)
        turn = ONE if joint.turn is None else joint.turn
        found = self.known[joint.name] = (
            [z + e * joint.a for z, e in zip(z_i, e_i)],
            [z + e * joint.b for z, e in zip(z_j, e_j)], [e * turn for e in e_j])
        return found

    def forbidden(self, order):
        """Return the derivatives of what the joints forbid: array (3 links, columns)."""
        rows = []
        for joint in self.joints:
            p, q, t = self.ends(joint)
            gap = [one - other for one, other in zip(p, q)]
            if joint.turn is None:
                rows += [real(gap[order]), imag(gap[order])]
            else:
                turned = self.angle(joint.i, order) - self.angle(joint.j, order)
                if not order:       # without full turns
                    turned = imag(log(exp(J * turned) / joint.turn))
                rows += [imag(leibniz(t, gap, order)), turned]
            if joint.is_driven:
                rows.append(real(leibniz(t, gap, order)) - self.given[order])
        if not any(joint.is_driven for joint in self.joints):
            turned = self.turned_by_the_drive(order) - self.given[order]
            rows.append(turned if order else imag(log(exp(J * turned))))
        return np.array(rows, object)

    def actions(self):
        """Yield (joint, field, i, j, place, force, couple): what it does on i, and back on j."""
        none = np.full(self.count, NONE, object)
        for joint in self.joints:
            (p, *_), _, (t, *_) = self.ends(joint)
            both = joint.i, joint.j, p
            if joint.turn is None:
                yield joint.name, '', *both, none + ONE, ZERO
                yield joint.name, '', *both, none + J, ZERO
            else:
                yield joint.name, f'{joint.name}_normal', *both, J * t, ZERO
                yield joint.name, f'{joint.name}_couple', *both, none, arb(1)
            if joint.is_driven:
                yield joint.name, 'driving_force', *both, t, ZERO
        if not any(joint.is_driven for joint in self.joints):
            yield 'base', 'driving_torque', *self.driven_pair(), none, none, arb(1)

    def rows(self):
        """Yield {link: (3, columns)} of what joints do on links: the rows of dC/dq."""
        for _, _, i, j, place, force, couple in self.actions():
            yield {self.names.index(name): sign * np.array([
                real(force), imag(force),
                couple + imag(conj(place - self.link(name)[0][0]) * force)], object)
                for name, sign in ((i, 1), (j, -1)) if name != GROUND}

    def jacobian(self):
        """Return dC/dq of the first column."""
        found = np.full((3 * len(self.names), len(self.names), 3), ZERO, object)
        for row, its in zip(found, self.rows()):
            for link, entries in its.items():
                row[link] = entries[:, 0]
        return arb_mat(found.reshape(len(found), -1).tolist())

    def is_in_modes(self):
        """Return whether each dyad lies as its mode says, but those that lie flat somewhere."""
        if isinstance(self.machine, Kind):
            return self.machine.is_flat or self.sides()[0] * self.machine.sign > 0
        has_flats = bool(self.machine.flat_inputs)
        return all(side * dyad.sign > 0 or has_flats and stage.pair for side, dyad, stage in zip(
            self.sides(), self.machine.stages, self.machine.layout.stages))

    def sides(self):
        """Return for each dyad a number whose sign is the side on which it closes."""
        if isinstance(self.machine, Kind):
            return [float(self.machine.mode(self)[0])]
        sides = []
        for dyad in self.machine.stages:
            (_, (one, *_)), (_, (two, *_)) = map(self.link, dyad.links)
            p, q = (self.link(at.link)[0][0] + self.link(at.link)[1][0] * acb(*at[1:])
                    for at in (dyad.first, dyad.second))
            sine = {'RRR': imag(conj(one) * two), 'RRP': real(conj(two) * one),
                    'RPR': real(conj(two) * (p - q))}.get(dyad.kind)
            if dyad.name == 'cylinder':
                (pivot, *_), _ = self.link('crank')
                sine = imag(conj(q - pivot) * (p - pivot))
            sides.append(dyad.sign if sine is None else float(sine[0]))
        return sides

    # --- results: {field: column} ----------------------------------------------------------------

    def motion(self):
        """Return places (complex) and angles of links, pins and slides by the names of fields."""
        found = {}
        for name, *levels in zip(self.names, *self.q):
            found[f'place_{name}'] = levels[0][0] + J * levels[0][1]
            found.update(_of_angle(name, [level[2] for level in levels]))
        for joint in self.joints[self.joints[0].j == GROUND:]:
            p, q, t = self.ends(joint)
            gap = [one - other for one, other in zip(p, q)]
            if joint.turn is not None:
                found.update(zip((f'slide_{joint.i}', f'slide_{joint.i}_velocity',
                                  f'slide_{joint.i}_acceleration'),
                                 (real(leibniz(t, gap, order)) for order in range(3))))
            elif GROUND not in (joint.i, joint.j):
                sign = -1 if joint.name.endswith('inner') else 1    # of j against i there
                found.update(_of_angle(joint.name, [
                    sign * (self.angle(joint.i, order) - self.angle(joint.j, order))
                    for order in range(3)]))
        return found

    def needs(self, data):
        """Return what joints must give to each link: force, moment about its first joint."""
        machine, found = self.machine, []
        base = machine.gravity if isinstance(machine.gravity, Base) else None
        f = data.point(*(machine.gravity[:2] if base else (-g for g in machine.gravity)))
        w, turned = [data.real(v) for v in base[2:]] if base else (ZERO, ZERO)
        for name in self.names:
            joint, e = self.link(name)
            body, act = getattr(machine.bodies, name), getattr(machine.external, name, Applied())
            centre = data.point(body.cg_along, body.cg_across)
            at, push = data.point(act.along, act.across), data.point(act.force_x, act.force_y)
            c, v, a = (place + arm * centre for place, arm in zip(joint, e))
            # d^2/dt^2 of exp(j phi) c, turned back by exp(-j phi); phi' = w
            force = data.real(body.mass) * (a + 2 * J * w * v + (J * turned - w * w) * c + f)
            moment = (data.real(body.inertia) * (self.angle(name, 2) + turned)
                      - data.real(act.couple)
                      + imag(conj(e[0] * centre) * force) - imag(conj(e[0] * at) * push))
            found += [real(force - push), imag(force - push), moment]
        return np.array(found, object)

    def widened(self, more):
        """Return the same with more columns, in which nothing is moved yet."""
        def wide(v):
            return v if v is None else np.concatenate([v, np.repeat(v[..., :1], more, -1)], -1)
        other = copy(self)
        other.count, other.known = self.count + more, {}
        other.q = [wide(level) for level in self.q]
        other.joints = [joint._replace(a=wide(joint.a), b=wide(joint.b), turn=wide(joint.turn))
                        for joint in self.joints]
        return other

    def loads(self):
        """Return forces at joints (complex), couples, drive and shaking loads by their fields."""
        data = Columns()
        self.needs(data)
        wide = self.widened(data.used if self.count > 1 else 0)
        needs = wide.needs(Columns(wide.count - 1, self.count - 1))
        transposed = self.inverse.transpose()
        forces = np.repeat(_times(transposed, needs[:, :1]), wide.count, 1)
        left = needs.copy()
        for force, row in zip(forces, wide.rows()):
            for link, entries in row.items():
                left[3 * link:3 * link + 3] -= entries * force
        forces = middle(forces + _times(transposed, left))
        found = dict.fromkeys(('driving_torque', 'driving_force'), 0 * forces[0])
        for size, (joint, field, _, _, _, force, _) in zip(forces, wide.actions()):
            found[joint] = found.get(joint, NONE) + size * force
            if field:
                found[field] = size
        # what all links need, along their velocities: no reaction is in it
        found['driving_power'] = (needs * wide.q[1].reshape(needs.shape)).sum(axis=0)
        places = [wide.link(name)[0][0] for name in self.names]
        pushes = [x + J * y for x, y in zip(needs[::3], needs[1::3])]
        found['shaking_force'] = -sum(pushes)
        found['shaking_moment'] = -sum(moment + imag(conj(z) * push) for moment, z, push in zip(
            needs[2::3], places, pushes))
        return found


def _times(matrix, columns):
    return np.array((matrix * arb_mat(columns.tolist())).tolist(), object)


def _of_angle(name, levels):
    return dict(zip((f'theta_{name}', f'omega_{name}', f'alpha_{name}'), levels))


def value_and_condition(column, kept=None):
    """Return the first of a column, and the sizes of it and of its changes per step()."""
    moved = (column[1:] - column[0]) / step()
    if kept is not None:
        own = len(kept.shares[0])
        moved[:own] -= (moved[kept.data][:, None] * kept.shares).sum(0)
    return column[0], float(abs(column[0]) + sum(map(abs, moved), ZERO))


class Kept(NamedTuple):
    """
    How to move data such that an exact change point stays one.

    With each datum, ``data`` are moved by minus its ``shares``: array (data, all data).
    """

    data: list
    shares: object


def kept_at(machine, flat, near):
    """Return what keeps a change point at the input ``flat``; ``near``: a Cartesian next to it."""
    side = arb(2)**(-ctx.prec // 6) * (1 if near.given[0][0] > flat else -1)
    there = toward(near, flat, flat + side)
    moved = Cartesian(machine, [v[0] for v in there.given], there)
    turned = (moved.q[0][:, :, 1:] - moved.q[0][:, :, :1]).reshape(-1, moved.count - 1) / step()
    sizes = np.vectorize(float)(turned * side)       # where J is regular, of the size of side
    sizes[np.abs(sizes) < 1e-9 * np.abs(sizes).max()] = 0.0
    rank = int((np.linalg.svd(sizes, compute_uv=False) > 1e-9).sum())
    if not rank:
        return None
    rows = qr(sizes.T, pivoting=True, mode='r')[1][:rank]
    data = qr(sizes[rows], pivoting=True, mode='r')[1][:rank]
    shares = arb_mat(turned[rows][:, data].tolist()).solve(arb_mat(turned[rows].tolist()))
    return Kept(data.tolist(), np.array(shares.tolist(), object))


class NoWay(Exception):
    """The reference does not get to an input in the modes given: it says nothing there."""


def toward(found, flat, end):
    """Return the pose at an input next to a change point, each distance the last one squared."""
    side = 1 if end > flat else -1
    distance, goal = (abs(x - flat).mid() for x in (found.given[0][0], end))
    while distance > goal:
        distance = distance**2 if distance**2 > goal else goal
        found = follow(found, end if distance == goal else flat + side * distance)
    return found


def follow(found, end):
    """Return the pose at another input, in the same modes and by Taylor steps from it."""
    machine, x = found.machine, found.given[0][0]
    found = Cartesian(machine, (x, 1, 0), found.q[0][:, :, 0])
    share = arb(1)
    while share > arb(2)**-60:
        way = (end - x).mid() * share
        q, turn, bend = (level[:, :, 0] for level in found.q)
        guess = q + turn * way + bend * (way * way / 2)
        try:
            there = Cartesian(machine, ((x + way).mid(), 1, 0), guess)
        except (ArithmeticError, ZeroDivisionError):
            there = None
        if there and all(now * before > 0 for now, before in zip(there.sides(), found.sides())
                         ) and _size(there.q[0][:, :, 0] - guess) <= 0.05 * _size(guess - q):
            if share == 1:
                return there
            found, x, share = there, (x + way).mid(), arb(1)
        else:
            share = share / 2
    raise NoWay(f'no way to the input {float(end.mid())!r}')


def _size(values):
    return max(abs(float(v)) for v in values.flat)


def reference_of(mechanism):
    """Return what a :class:`Cartesian` takes: a machine of dyads itself, a linkage as a Kind."""
    if isinstance(mechanism, (Kind, Machine)):
        return mechanism
    name = next((name for name in KINDS if type(mechanism) is kind_of(name, 'crank')), 'four_bar')
    return Kind(name, mechanism.lengths, 2 * mechanism.mode - 3, mechanism.input,
                mechanism.bodies, mechanism.external, mechanism.gravity,
                mechanism.change_point_margin == 0.0)


def pose_of(mechanism, x):
    """Return x, y and angle of the moving links at an input, by the library."""
    motion, found = mechanism.motion(float(x)), []
    for link in mechanism.BODIES._fields:
        at = mechanism.link_motion(motion, link)
        found.append([at.x, at.y, float(np.arctan2(at.sine, at.cosine))])
    if mechanism.input == 'crank' and getattr(mechanism, 'carrier', GROUND) == GROUND:
        found[0][2] = float(x)
    return found


def exact(mechanism, given, near=None):
    """
    Return the :class:`Cartesian` of a mechanism in one column, by default near the library's pose.

    Raises ArithmeticError or ZeroDivisionError if there is no pose near it, or none in its modes.
    """
    found = Cartesian(reference_of(mechanism), given,
                      pose_of(mechanism, given[0]) if near is None else near)
    if not found.is_in_modes():
        raise ArithmeticError('in another mode')
    return found


def beside(mechanism, flat, ways, rates=(1.0, 0.0)):
    """Yield the same at inputs ``flat + way`` next to an exact change point, by falling ways."""
    begin = float(flat) + (BEGIN if ways[0] > 0 else -BEGIN)
    found = exact(mechanism, (begin, 1.0, 0.0))
    for way in ways:
        found = toward(found, flat, flat + way)
        yield Cartesian(found.machine, (flat + way, *rates), found.q[0][:, :, 0])


def fields_of(found):
    """Return columns of motion and of loads by their fields, those of vectors complex."""
    if isinstance(found.machine, Kind):
        return found.machine.fields(found)
    return found.motion(), found.loads() if found.machine.bodies else {}


def values_of(found):
    """Return {field: value for mpmath}: places and forces by x, y and size too."""
    values, (motion, loads) = {}, fields_of(found)
    for name, (value, *_) in (motion | loads).items():
        if not isinstance(value, acb):
            values[name] = of_mpmath(value)
            continue
        place = name.startswith('place_')
        x, y = (f'x{name[5:]}', f'y{name[5:]}') if place else (f'{name}_x', f'{name}_y')
        values |= {x: of_mpmath(value.real), y: of_mpmath(value.imag)}
        if not place:
            values[name] = of_mpmath(abs(value))
    return values


def values(mechanism, x, rate=1.0, acceleration=0.0):
    """Return {field: value for mpmath} of a mechanism at an input."""
    with ctx.workprec(BITS):
        return values_of(exact(mechanism, tuple(map(number, (x, rate, acceleration)))))


def exact_values(machine, name, inputs, rates):
    """Return a quantity at some inputs to many digits; None if the reference does not have it."""
    found = [values(machine, float(x), *rates) for x in inputs]
    return [each[name] for each in found] if name in found[0] else None


# --- the library beside it -----------------------------------------------------------------------

def conditions(found, given, kept=None):
    """
    Return {field: (value, condition)} of motion and of loads, those of vectors complex.

    Angles of machines at pins have the conditions of both links, places of links that slide that
    of the slide too: they are what their way adds up to.

    Parameters
    ----------
    found : Cartesian
        In one column.
    given : tuple of 3 numbers
    kept : Kept, optional
        At an exact change point.

    """
    columns = Cartesian(found.machine, given, found)
    motion, loads = ({name: value_and_condition(column, kept) for name, column in fields.items()}
                     for fields in fields_of(columns))
    if isinstance(found.machine, Kind):
        return motion, loads
    layout = found.machine.layout
    for pin, *pair in layout.pins():
        for what in ('theta', 'omega', 'alpha'):
            truth, condition = motion[f'{what}_{pin}']
            motion[f'{what}_{pin}'] = truth, condition + sum(
                motion[f'{what}_{layout.links[i]}'][1] for i in pair)
    for link in {*layout.slides()[found.machine.input == 'slide':]} - {GROUND}:
        (place, condition), (way, _) = motion[f'place_{link}'], motion[f'slide_{link}']
        motion[f'place_{link}'] = place, condition + float(abs(way))
    return motion, loads


def errors(mechanism, given, found, kept=None):
    """
    Yield (field, error of the library in eps times condition, whether it is a load).

    Of one value and of an array. Angles count modulo a turn and have a condition of 1 at least;
    fields NAME_x, NAME_y have one error, of their vector.
    """
    many = [np.full(100, float(v)) for v in given]
    for is_load, fields in enumerate(conditions(found, given, kept)):
        if not fields:
            continue
        both = [mechanism.loads(*its) if is_load else mechanism.motion(*its)
                for its in (tuple(map(float, given)), many)]
        for name, (truth, condition) in fields.items():
            yield name, max(_error(name, ours, truth, condition) for ours in both), bool(is_load)


def off(name, ours, truth):
    """Return by how much a field of a result, the first of an array, is off: as the truth is."""
    def first(field):
        return float(np.ravel(getattr(ours, field))[0])
    if not isinstance(truth, acb):
        return arb(first(name)) - truth
    x, y = ((f'x{name[5:]}', f'y{name[5:]}') if name.startswith('place') else
            (f'{name}_x', f'{name}_y'))
    return acb(first(x), first(y)) - truth


def _error(name, ours, truth, condition):
    error = off(name, ours, truth)
    if name.startswith(ANGLES):
        error, condition = (J * error).exp() - ONE, max(condition, 1.0)
    size = float(abs(error))
    if condition:
        return size / (EPS * condition)
    return 0.0 if size <= 1e-30 else float('inf')
