# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Machines with dry and viscous friction in Cartesian coordinates: no dyad is solved here.

The constraints and their multipliers are those of :mod:`support.cartesian`; the sizes of all
friction couples and forces are further unknowns. The model, as a designer knows it:

- A pin that transmits the force F bears on a journal of radius r: Coulomb's couple mu r |F|
  against the relative rotation (Shigley's Mechanical Engineering Design, journal bearing with a
  dry contact), and a viscous couple c times the relative rate.
- A guide that transmits the normal force N and the couple C about the first joint of the block:
  the two ends of a block of length b, b/2 to both sides of that joint, bear N/2 + C/b and
  N/2 - C/b on one or on both faces of the guide, and the friction force along the slide is mu
  times the sum of both sizes (the drawer of Norton, Design of Machinery, and of every textbook
  of statics). Without a length the couple is borne without friction: mu |N|. And a viscous force
  c times the sliding rate. All of it acts on the line of the slide through that joint.
- The drive itself: a constant and a viscous torque, which no joint feels.

A joint that does not move has no friction. With friction growing from none in small steps the
sizes are followed; where they cannot be, the mechanism locks itself.
"""
from flint import acb, arb, ctx
import numpy as np
from support.cartesian import (
    BITS,
    Cartesian,
    conj,
    fields_of,
    imag,
    Kind,
    leibniz,
    NONE,
    pose_of,
    real,
    reference_of,
    ZERO,
)

LARGEST, LEAST = 1 / 16, 2.0**-16     # steps of the friction, from none to all
OF_KINDS = {'O1': 'base', 'A': 'A', 'B': 'inner', 'slide': 'inner', 'slot': 'inner',
            'O4': 'outer', 'guide': 'outer'}


class Locks(Exception):
    """Friction cannot grow so far: the mechanism locks itself."""


def _floats(values):
    return np.array([float(v) for v in np.ravel(values)])


class Rubbing(Cartesian):
    """
    A machine with friction in one pose.

    Parameters
    ----------
    machine, given, near
        As of :class:`.Cartesian`; one column.
    friction : mapping
        {joint, as the library names it: record with coefficient, radius, viscous and length};
        'drive': record with torque and viscous.

    """

    def __init__(self, machine, given, near, friction):
        super().__init__(machine, given, near)
        names = OF_KINDS if isinstance(machine, Kind) else {}
        self.friction = {names.get(name, name): record for name, record in friction.items()}

    def relative_rate(self, joint):
        """Return the rate of the first link of a joint, as the second sees it."""
        p, q, t = self.ends(joint)
        if joint.turn is None:
            return float((self.angle(joint.i, 1) - self.angle(joint.j, 1))[0])
        return float(real(leibniz(t, [one - other for one, other in zip(p, q)], 1))[0])

    def columns_of(self, joint):
        """Return what friction of size one does on all links: along, or turned as, link i."""
        (p, *_), _, (t, *_) = self.ends(joint)
        force, couple = (NONE, arb(1)) if joint.turn is None else (t, ZERO)
        column = np.zeros((len(self.names), 3))
        for name, sign in ((joint.i, 1.0), (joint.j, -1.0)):
            if name in self.names:
                at = self.link(name)[0][0]
                column[self.names.index(name)] += sign * np.concatenate([_floats(v) for v in (
                    real(force + 0 * at), imag(force + 0 * at),
                    couple + imag(conj(p - at) * force))])
        return column.ravel()

    def multipliers(self):
        """Return the sizes of all actions, with friction; and {joint: force along or couple}."""
        actions, count = list(self.actions()), 3 * len(self.names)
        reactions = np.zeros((count, count))
        for column, row in zip(reactions.T, self.rows()):
            for link, entries in row.items():
                column[3 * link:3 * link + 3] = _floats(entries)
        joints = [joint for joint in self.joints if joint.name in self.friction]
        own = [self.friction[joint.name] for joint in joints]
        rates = np.array([self.relative_rate(joint) for joint in joints])
        rubs = np.array([self.columns_of(joint) for joint in joints]).reshape(len(joints), count).T
        # a joint of links that move together turns by rounding alone, here of many digits
        signs, viscous = np.sign(np.where(abs(rates) < 1e-30, 0.0, rates)), np.array(
            [record.viscous for record in own])
        # which two actions a joint's friction grows with: both of a pin, N and C of a guide
        felt = [[k for k, action in enumerate(actions) if action[0] == joint.name
                 and not action[1].startswith('driving')] for joint in joints]
        needs = _floats(self.needs(_Plain()))
        solve = np.linalg.inv(reactions)

        def forces(sizes):
            return solve @ (needs + rubs @ (signs * sizes + viscous * rates))

        def sizes_of(values):
            found = []
            for joint, record, (one, two) in zip(joints, own, felt):
                first, second = values[one], values[two]
                if joint.turn is None:
                    found.append(record.coefficient * record.radius * np.hypot(first, second))
                else:
                    ends = first / 2 + second / record.length, first / 2 - second / record.length
                    found.append(record.coefficient * (abs(ends[0]) + abs(ends[1])))
            return np.array(found)

        sizes = _grown(lambda c: sizes_of(forces(c)), np.zeros(len(joints)))
        values = forces(sizes)
        return actions, values, dict(zip(
            [joint.name for joint in joints], -(signs * sizes + viscous * rates)))

    def loads(self):
        """Return the fields of :meth:`.Cartesian.loads`, with friction."""
        found = super().loads()
        actions, values, rubbed = self.multipliers()
        drive = self.friction.get('drive')
        rate = float(self.given[1][0])
        lost = drive.torque * np.sign(rate) + drive.viscous * rate if drive else 0.0
        forces, fields = {}, {}
        for value, (joint, field, _, _, _, force, _) in zip(values, actions):
            forces[joint] = forces.get(joint, 0.0) + value * complex(force[0])
            if field:
                fields[field] = value + (lost if field.startswith('driving') else 0.0)
        for joint in self.joints:
            if joint.turn is not None and joint.name in rubbed:
                forces[joint.name] += rubbed[joint.name] * complex(self.ends(joint)[2][0][0])
        found.update({name: np.array([acb(value)]) for name, value in forces.items()})
        drive = next(name for name in fields if name.startswith('driving'))
        fields['driving_power'] = fields[drive] * rate
        found.update({name: np.array([arb(float(value))]) for name, value in fields.items()})
        return found


class _Plain:
    """Numbers in one column, none of them moved."""

    def real(self, value, weight=None):
        return np.array([arb(value)], object)

    def point(self, along, across):
        return np.array([acb(float(along), float(across))], object)


def _grown(function, sizes):
    """Return the fixed point that grows out of ``sizes``, as the function does from nothing."""
    share, step, grows = 0.0, LARGEST, function(sizes)
    while share < 1.0:
        step = min(step, 1.0 - share)
        there, bend = _solved(lambda c: (share + step) * function(c), sizes)    # noqa: B023
        if there is not None:
            # along the tangent; past a kink in another direction, past a fold far away
            change, expected = there - sizes, max(abs(step * grows), default=0.0)
            off = max(abs(change - step * grows), default=0.0)
            if off <= 0.5 * expected or step < LEAST and off <= 100.0 * expected:
                sizes, share, step = there, share + step, min(2.0 * step, LARGEST)
                grows = np.linalg.solve(bend, function(sizes))
                continue
        if step < LEAST:
            raise Locks
        step = step / 2.0
    return sizes


def _solved(function, sizes):
    """
    Return the fixed point next to ``sizes`` and 1 less the slopes there, by Newton's iteration.

    None for both if there is none.
    """
    for _ in range(30):
        slopes, values = np.empty((sizes.size, sizes.size)), function(sizes)
        step = 1e-6 * (1e-3 + max(abs(sizes), default=0.0))
        for k in range(sizes.size):
            moved = np.zeros(sizes.size)
            moved[k] = step
            slopes[:, k] = (function(sizes + moved) - function(sizes - moved)) / (2.0 * step)
        matrix = np.eye(sizes.size) - slopes
        if np.linalg.det(matrix) <= 0.0:
            break
        change = np.linalg.solve(matrix, values - sizes)
        sizes = sizes + change
        if max(abs(change), default=0.0) <= 1e-13 * (1e-300 + max(abs(sizes), default=0.0)):
            return sizes, matrix
    return None, None


def loads_with(mechanism, given, friction):
    """
    Return {field: load} of a mechanism of the library with friction, forces complex.

    Locks where friction cannot grow so far.
    """
    with ctx.workprec(BITS):
        found = Rubbing(reference_of(mechanism), given, pose_of(mechanism, given[0]), friction)
        return {name: complex(value) for name, (value, *_) in fields_of(found)[1].items()}
