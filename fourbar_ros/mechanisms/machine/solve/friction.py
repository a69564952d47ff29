# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Friction in the loads of a machine: dyad by dyad, with the forces of each.

A joint brakes its links with the *effort* c, a couple of a pin and a force of a guide, whose size
grows with what it transmits (:class:`.JointFriction`):

    (J1)  c = mu r |F| of a pin,   c = mu max(|N|, 2 |C| / b) of a guide

The sign of the relative rate, known with the motion, gives its direction. Forces at the joints of
a dyad, v, are affine in the efforts of its three joints,

    (J2)  v = v0 + M c

as later dyads, which are solved before, have theirs already and earlier ones are not felt. Sizes
are of degree one in v, so with G the derivatives of (J1) Newton's iteration is, from c = 0 on,

    (J3)  (1 - G M) c = G v0

The first iteration takes half of the friction, which keeps the others out of cycles where a block
tilts. The solution that it goes to grows out of that without friction. With friction growing
further it ends, at infinity or with a second one, where 1 - G M has a determinant of zero: an
eigenvalue of G M is 1, and from there on any drive adds as much friction as force. The joints
*lock* then. They are free if all sums of principal minors of 1 - G M are positive at the solution:
so they are where (J1) contracts, with all eigenvalues less than 1 in size, and where they are no
eigenvalue is real and 1 or more (Descartes' rule of signs). A joint that friction relieves, an
eigenvalue of -1 or less, does not lock.

Where the motion follows from torque all joints of a machine are solved at once by (J3), with the
acceleration eliminated (:mod:`fourbar_ros.dynamics.resistance`). There are too many minors then:
joints are free if all pivots are positive, leading minors that are 1 without friction and cannot
turn negative with it before the joints so far lock.

The drive pays for all efforts by virtual power. It is felt at the joints of a cylinder, whose
dyad is so solved together with the pin of the crank; the joint of any other driven link
is the last, as nothing feels its effort but the drive.
"""
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import combinations
from math import nan
from typing import Any, NamedTuple

from fourbar_ros.mechanics.newton_euler import Needs, Vector
from fourbar_ros.mechanisms.curves import FIXED, LinkMotion
from fourbar_ros.mechanisms.friction import sign_of
from fourbar_ros.mechanisms.machine import structure
from fourbar_ros.mechanisms.machine.solve.loads import DyadForces, with_drive_along
from fourbar_ros.mechanisms.machine.solve.pairs import slides_of
from fourbar_ros.mechanisms.machine.structure import BASE, CYLINDER, DyadLengths, Stage
from fourbar_ros.mechanisms.parts import DRIVE, SLIDE
from fourbar_ros.numerics.arrays import EPS
from fourbar_ros.numerics.linear_forms import CONSTANT, LinearForm
from fourbar_ros.numerics.number_types import NumberType, Scalar, TINY

SHARES = (0.5, *[1.0] * 5)      # of the friction, in each iteration; one less if no block tilts
CONVERGED = 1e-8       # change of the efforts by the last iteration, over all; its square is left
NEAR_SHARES, CONVERGED_NEAR = (1.0, 1.0, 1.0), 1e-4      # the same from near a solution on
AT_REST = 16.0 * EPS   # a relative rate below this part of the rates of both links is rounding
NO_FORCE = Vector(0.0, 0.0)

Matrix = Sequence[Sequence[Scalar]]
# What a joint transmits, its friction grows with: of a pin x and y of its force, of a guide its
# normal force and couple.
Felt = tuple[Scalar, Scalar]


class FrictionReport(NamedTuple):
    """What is known of joints with dry friction that are solved together, in a pose."""

    joints: list[str]
    locks: Scalar           # NaN where they lock together, else 0
    edges: list[Scalar]     # numbers at whose zeros over the input loads jump, or their slopes


class RubbingJoint(NamedTuple):
    """A joint with friction in a pose: what an effort of 1 against its rate does."""

    name: str
    joint: str             # first, inner or second of a dyad; base
    friction: Any          # its JointFriction, of any numbers
    slide: int | None      # index of the slide of the dyad that it is; None of a pin
    rate: Scalar           # relative rate at unit rate of the input [rad/rad], [m/rad] ...
    moving: Scalar         # the same, 0 of a joint that is at rest but for rounding
    needs: tuple[Needs, Needs]      # by how much those of both links of the dyad grow
    force: Vector          # the effort itself: on the block of a guide
    couple: Scalar         # ... on the second link of a pin


class MachineFriction:
    """Friction of the joints of a machine in a pose."""

    # by_joint: {joint of the layout, or 'drive': its friction}; tilts: {joint with dry friction:
    # whether it is a guide whose block has a length, so that its couple counts}; rate, direction:
    # of the input, its direction by direction_of(); unit: of lengths [m]; reports: a list that
    # takes one for each dyad.
    def __init__(self, n: NumberType, layout: structure.Layout, by_joint: Mapping[str, Any],
                 tilts: Mapping[str, bool], rate: Scalar, direction: Scalar, unit: Scalar,
                 reports: Any) -> None:
        self._n, self._layout, self._by_joint, self._tilts = n, layout, by_joint, tilts
        self._rate, self._unit, self._direction, self._reports = rate, unit, direction, reports
        self.paid: Any = 0.0     # what friction takes of the drive [N m], [N]

    @property
    def gate(self) -> Scalar:
        """Return NaN where any joints lock, else 0."""
        gate = 0.0
        for report in self._reports:
            gate = gate + report.locks
        return gate

    def _pin(self, name: str, joint: str, first: LinkMotion, second: LinkMotion,
             needs: tuple[Needs, Needs]) -> RubbingJoint:
        """Return a pin between two links that move so, at unit rate of the input."""
        fabs = self._n.fabs
        rest = 0.0 if first is FIXED else AT_REST * (fabs(first.omega) + fabs(second.omega))
        rate = second.omega - first.omega
        return RubbingJoint(name, joint, self._by_joint[name], None, rate,
                            self._moving(rate, rest), needs, NO_FORCE, -1.0)

    def _guide(self, name: str, joint: str, slide: int, block: LinkMotion, carrier: LinkMotion,
               arm: Vector, t: Vector, needs: tuple[Needs, Needs]) -> RubbingJoint:
        """Return a guide along t on a carrier, on which the block begins at an arm."""
        fabs, turned = self._n.fabs, arm.normal * carrier.omega
        rest = 0.0 if carrier is FIXED else AT_REST * (fabs(block.v_x) + fabs(block.v_y))
        rate = t.dot(Vector(block.v_x - carrier.v_x - turned.x,
                            block.v_y - carrier.v_y - turned.y))
        return RubbingJoint(name, joint, self._by_joint[name], slide, rate,
                            self._moving(rate, rest), needs, -t, 0.0)

    def _moving(self, rate: Scalar, rest: Scalar) -> Scalar:
        """Return a relative rate at unit rate of the input, 0 if it is no more than ``rest``."""
        moving: Scalar = self._n.where((self._n.fabs(rate) - rest).real > 0.0, rate, 0.0)
        return moving

    def _joints_of(self, stage: Stage, lengths: DyadLengths, slides: Sequence[Scalar],
                   e: Sequence[Vector], curves: Sequence[LinkMotion]) -> list[RubbingJoint]:
        """Return the joints of a dyad that rub; of a cylinder the pin of the crank too."""
        joints, sliding = list[RubbingJoint](), slides_of(stage, lengths)
        for joint, name in stage.joints():
            if name not in self._by_joint:
                continue
            # what both links of the dyad need more for an effort of 1 against the rate
            if joint not in structure.SLIDES[stage.kind]:
                # a couple: 1 on the second of two links, back on the first, which is the carrier
                first, second = stage.ends(joint)
                joints.append(self._pin(name, joint, curves[first], curves[second], (
                    Needs(NO_FORCE, (second == stage.link) - float(first == stage.link)),
                    Needs(NO_FORCE, float(second == stage.link + 1)))))
                continue
            # a force along t on the block, back on the carrier at the block's joint
            k = list(structure.SLIDES[stage.kind]).index(joint)
            block, (carrier, start, along) = sliding[k]
            t = Vector(*along).along(e[carrier])
            arm = (Vector(*start) + Vector(*along) * slides[k]).along(e[carrier])
            needs = [Needs(t, 0.0) if link == block else
                     Needs(-t, -arm.cross(t)) if link == carrier else Needs(NO_FORCE, 0.0)
                     for link in (stage.link, stage.link + 1)]
            joints.append(self._guide(name, joint, k, curves[block], curves[carrier], arm, t,
                                      (needs[0], needs[1])))
        if stage.name == CYLINDER and BASE in self._by_joint:
            joints.append(self._pin(BASE, BASE, curves[0], curves[1], (
                Needs(NO_FORCE, 0.0), Needs(NO_FORCE, 0.0))))
        return joints

    def of_dyad(self, stage: Stage, lengths: DyadLengths, slides: Sequence[Scalar],
                e: Sequence[Vector], curves: Sequence[LinkMotion], held: Sequence[Needs],
                solve: Callable[[Needs, Needs], DyadForces], drive: Scalar,
                borne: Mapping[str, Vector]) -> tuple[DyadForces, Scalar]:
        """Return the forces of a dyad, and the drive, with the friction of its joints."""
        # slides: how far its joints slide; e, curves, held: of all links direction, motion at unit
        # rate of the input, needs without the dyad; solve: needs of both links -> forces of the
        # dyad; drive: without the friction of the dyad; borne: {joint: a force that it transmits
        # besides those of the dyad}.
        joints = self._joints_of(stage, lengths, slides, e, curves)
        is_cylinder = stage.name == CYLINDER
        if is_cylinder:
            borne = {**borne, BASE: held[1].force}

        def with_efforts(efforts: Sequence[Scalar], needs: Sequence[Needs], drive: Scalar
                         ) -> tuple[DyadForces, Scalar]:
            """Return the forces that balance the efforts of all joints, and the drive so far."""
            first, second = needs
            for effort, joint in zip(efforts, joints):
                first, second = (Needs(need.force + more.force * effort,
                                       need.moment + effort * more.moment)
                                 for need, more in zip((first, second), joint.needs))
                drive = drive + self._unit * (joint.rate * effort)      # by virtual power
            forces = solve(first, second)
            if is_cylinder:
                forces = with_drive_along(forces, e[stage.link] * drive)
            return forces, drive

        def felt(forces: DyadForces, rubbing: RubbingJoint) -> Felt:
            if rubbing.slide is not None:
                return forces.normals[rubbing.slide], getattr(forces, f'{rubbing.joint}_couple')
            # the pin of the crank feels what the rod of the cylinder does
            force: Vector = getattr(forces, 'first' if rubbing.joint == BASE else rubbing.joint)
            return force.x, force.y

        needs = held[stage.link], held[stage.link + 1]
        efforts: list[Any] = [self._viscous(joint.friction, joint.rate, joint.slide is None)
                              for joint in joints]
        dry = [k for k, joint in enumerate(joints) if joint.name in self._tilts]
        if dry:
            signs = [self._direction * sign_of(self._n, joint.moving) for joint in joints]
            unknown = list(efforts)
            for k in dry:
                unknown[k] = unknown[k] + LinearForm({joints[k].name: signs[k]})
            forces, _ = with_efforts(unknown, needs, drive)
            affine = list[tuple[LinearForm, LinearForm]]()
            for k in dry:
                x: Any
                y: Any
                x, y = felt(forces, joints[k])
                more = borne.get(joints[k].name, NO_FORCE)
                affine.append((x + more.x, y + more.y))
            sizes, locks = self._sizes([joints[k] for k in dry], affine)
            for k, size in zip(dry, sizes):
                efforts[k] = efforts[k] + signs[k] * size
        forces, drive = with_efforts(efforts, needs, drive)
        for effort, joint in zip(efforts, joints):
            self.paid = self.paid + self._unit * (joint.rate * effort)
        if dry:
            self._report([(joints[k], felt(forces, joints[k])) for k in dry], locks)
        return with_efforts_at_joints(forces, efforts, joints), drive

    def _sizes(self, joints: Sequence[RubbingJoint],
               affine: Sequence[tuple[LinearForm, LinearForm]]) -> tuple[list[Any], Scalar]:
        """Return the sizes of the dry efforts of joints, and NaN where they lock, else 0."""
        # affine: what each feels as linear forms of all of these sizes.
        at_none, *columns = [[(x.coefficient(name), y.coefficient(name)) for x, y in affine]
                             for name in (CONSTANT, *[joint.name for joint in joints])]
        return solved(self._n, [self._law(joint.name, joint.slide is not None)
                                for joint in joints], at_none, columns, SHARES[
            :None if any(self._tilts[joint.name] for joint in joints) else -1])[:2]

    def _report(self, joints: Sequence[tuple[RubbingJoint, Felt]], locks: Scalar) -> None:
        edges = [edge for joint, felt in joints for edge in (joint.moving, *self._edges(
            joint.name, joint.slide is not None, felt))]
        self._reports.append(FrictionReport([joint.name for joint, _ in joints], locks, edges))

    def of_base(self, first: Scalar, second: Scalar, drive: Scalar) -> Scalar:
        """Return the drive [N m], [N] with the friction of the driven joint and of the drive."""
        # first, second: what that joint feels, as Felt; what friction takes is added to ``paid``.
        is_slide, by_joint, taken = self._layout.driver == SLIDE, self._by_joint, list[Any]()
        if BASE in by_joint and self._layout.driver != CYLINDER:
            rate = 1.0 / self._unit if is_slide else 1.0        # at unit rate of the input
            effort = self._viscous(by_joint[BASE], rate, is_pin=not is_slide)
            if BASE in self._tilts:
                size = self._size_at_base(is_slide, (first, second))
                effort = effort + self._direction * size
            taken.append(effort if is_slide else self._unit * effort)
        if DRIVE in by_joint:
            friction = by_joint[DRIVE]
            taken.append(friction.torque * self._direction + friction.viscous * self._rate)
        for effort in taken:
            self.paid, drive = self.paid + effort, drive + effort
        return drive

    def _size_at_base(self, is_slide: bool, felt: Felt) -> Scalar:
        self._reports.append(FrictionReport([BASE], 0.0, self._edges(BASE, is_slide, felt)))
        return _dot(self._law(BASE, is_slide)(felt), felt)

    def _viscous(self, friction: Any, rate: Scalar, is_pin: bool) -> Scalar:
        """Return the viscous effort [N unit], [N]; ``rate`` as of :class:`RubbingJoint`."""
        per = 1.0 / self._unit if is_pin else self._unit
        effort: Scalar = (friction.viscous * per) * (rate * self._rate)
        return effort

    def _edges(self, name: str, is_slide: bool, felt: Felt) -> list[Scalar]:
        """Return numbers at whose zeros, or jumps of sign, a guide's effort bends, (J1)."""
        # That of a pin does where its force vanishes, which is no zero of one number.
        if not is_slide:
            return []
        normal, fabs = felt[0], self._n.fabs
        if not self._tilts[name]:
            return [normal]
        tilt = 2.0 * self._unit / self._by_joint[name].length * felt[1]
        # Where the block bears on both faces, the sign of the couple counts, else that of the
        # force; the number that does not count is 1.
        is_tilted = (fabs(tilt) - fabs(normal)).real > 0.0
        return [self._n.where(is_tilted, 1.0, normal), self._n.where(is_tilted, tilt, 1.0),
                fabs(tilt) - fabs(normal)]

    def _law(self, name: str, is_slide: bool) -> Callable[[Felt], Felt]:
        """Return what a joint feels -> derivatives by it of the size of its effort, (J1)."""
        n, unit, friction = self._n, self._unit, self._by_joint[name]
        if is_slide:
            mu = friction.coefficient
            if not self._tilts[name]:
                return lambda felt: (mu * sign_of(n, felt[0]), 0.0)
            per_length = 2.0 * unit / friction.length

            def of_guide(felt: Felt) -> Felt:
                normal, tilt = felt[0], per_length * felt[1]
                is_tilted = (n.fabs(tilt) - n.fabs(normal)).real > 0.0
                return (mu * n.where(is_tilted, 0.0, sign_of(n, normal)),
                        mu * per_length * n.where(is_tilted, sign_of(n, tilt), 0.0))
            return of_guide
        factor = friction.coefficient * friction.radius / unit

        def of_pin(felt: Felt) -> Felt:
            per = factor / (n.hypot(*felt) + TINY)
            return per * felt[0], per * felt[1]
        return of_pin


class OpenJoint(NamedTuple):
    """A joint with dry friction while the sizes of efforts are unknowns."""

    name: str
    law: Callable[[Felt], Felt]            # as of :func:`solved`
    felt: tuple[Any, Any]                  # linear forms
    moving: Scalar                         # its relative rate at unit rate, 0 at rest
    edges: Callable[[Felt], list[Scalar]]  # what it feels, as numbers -> at whose zeros it bends


class OpenForces(list[OpenJoint]):
    """All joints with dry friction, from the last dyad on, while sizes are unknowns."""

    paid: Any = 0.0         # linear form of what friction takes of the drive
    tilts: bool = False     # whether the block of any guide does


class OpenFriction(MachineFriction):
    """Friction whose sizes are left open, as with it goes an acceleration that is not known."""

    _reports: OpenForces

    def _open(self, name: str, is_slide: bool, felt: tuple[Any, Any], moving: Scalar) -> Any:
        def edges(felt: Felt) -> list[Scalar]:
            if not (is_slide and self._tilts[name]):
                return [felt[0]] if is_slide else []
            fabs, tilt = self._n.fabs, 2.0 * self._unit / self._by_joint[name].length * felt[1]
            return [felt[0], tilt, fabs(tilt) - fabs(felt[0])]
        self._reports.append(OpenJoint(name, self._law(name, is_slide), felt, moving, edges))
        return LinearForm({name: 1.0})

    def _sizes(self, joints: Sequence[RubbingJoint],
               affine: Sequence[tuple[LinearForm, LinearForm]]) -> tuple[list[Any], Scalar]:
        return [self._open(joint.name, joint.slide is not None, felt, joint.moving)
                for joint, felt in zip(joints, affine)], 0.0

    def _report(self, joints: Sequence[tuple[RubbingJoint, Felt]], locks: Scalar) -> None:
        pass

    def _size_at_base(self, is_slide: bool, felt: Felt) -> Any:
        return self._open(BASE, is_slide, felt, 1.0)

    def of_base(self, first: Scalar, second: Scalar, drive: Scalar) -> Scalar:
        drive = super().of_base(first, second, drive)
        self._reports.paid, self._reports.tilts = self.paid, any(self._tilts.values())
        return drive

    @property
    def gate(self) -> Scalar:
        return 0.0


def with_efforts_at_joints(forces: DyadForces, efforts: Sequence[Scalar],
                           joints: Sequence[RubbingJoint]) -> DyadForces:
    """Return the forces of a dyad, which balance efforts, with these efforts in its joints."""
    for effort, rubbing in zip(efforts, joints):
        if rubbing.joint == BASE:       # the pin of the crank is none of the dyad
            continue
        couple = f'{rubbing.joint}_couple'
        forces = forces._replace(**{
            rubbing.joint: getattr(forces, rubbing.joint) + rubbing.force * effort,
            couple: getattr(forces, couple) + rubbing.couple * effort})
    return forces


def solved(n: NumberType, laws: Sequence[Callable[[Felt], Felt]], at_none: Sequence[Felt],
           columns: Sequence[Sequence[Felt]], shares: Sequence[float], by_minors: bool = True,
           near: Sequence[Felt] | None = None) -> tuple[list[Scalar], Scalar, list[Felt]]:
    """Return the sizes of efforts by (J3), whether they lock, and what joints feel with them."""
    # The second result is NaN where they lock, else 0. laws: of each joint what it feels -> slopes
    # of (J1); at_none: what each feels without efforts; columns: by effort what each feels of an
    # effort of one; shares: of the friction, in each iteration; by_minors: for up to four joints,
    # by cofactors and with all principal minors, else by pivots, of which all must be positive;
    # near: what is felt, about, from where two iterations are enough.
    felt, sizes, matrix = list(near or at_none), [0.0] * len(laws), list[list[Scalar]]()
    before, solution = sizes, partial(_solution, n) if by_minors else _without_pivots
    for share in shares:
        slopes = [(share * x, share * y) for law, pair in zip(laws, felt) for x, y in [law(pair)]]
        matrix = [[float(i == j) - _dot(slopes[i], columns[j][i]) for j in range(len(laws))]
                  for i in range(len(laws))]
        before, sizes = sizes, solution(matrix, list(map(_dot, slopes, at_none)))  # (J3)
        felt = [_plus(pair, [(column[i], size) for column, size in zip(columns, sizes)])
                for i, pair in enumerate(at_none)]
    change = all_sizes = 0.0
    for size, old in zip(sizes, before):
        change, all_sizes = change + n.fabs(size - old), all_sizes + n.fabs(size)
    converged = CONVERGED_NEAR if near else CONVERGED
    locks = n.where((change - converged * all_sizes).real > 0.0, nan, 0.0)
    if not by_minors:
        return sizes, locks + locked_by_pivots(n, matrix), felt
    for count in range(1, len(laws) + 1):
        minors = 0.0
        for chosen in combinations(range(len(laws)), count):
            minors = minors + _determinant([[matrix[i][j] for j in chosen] for i in chosen])
        locks = locks + n.where(minors.real > 0.0, 0.0, nan)
    return sizes, locks, felt


def locked(n: NumberType, laws: Sequence[Callable[[Felt], Felt]], felt: Sequence[Felt],
           columns: Sequence[Sequence[Felt]]) -> Scalar:
    """Return 0 where joints that feel this are free, all pivots of 1 - G M positive, or NaN."""
    slopes, every = [law(pair) for law, pair in zip(laws, felt)], range(len(laws))
    return locked_by_pivots(n, [[float(i == j) - _dot(slopes[i], columns[j][i]) for j in every]
                                for i in every])


def locked_by_pivots(n: NumberType, matrix: Matrix) -> Scalar:
    locks = 0.0
    for k, row in enumerate(_reduced(matrix, [0.0] * len(matrix))):
        locks = locks + n.where(row[k].real > 0.0, 0.0, nan)
    return locks


def _dot(first: Felt, second: Felt) -> Scalar:
    return first[0] * second[0] + first[1] * second[1]


def _plus(pair: Felt, terms: Sequence[tuple[Felt, Scalar]]) -> Felt:
    x, y = pair
    for (first, second), size in terms:
        x, y = x + first * size, y + second * size
    return x, y


def _solution(n: NumberType, matrix: Matrix, right: Sequence[Scalar]) -> list[Scalar]:
    """Return the solution of up to four linear equations, by cofactors: no pivot vanishes."""
    whole = _determinant(matrix)
    per = 1.0 / n.where(whole.real > 0.0, whole, 1.0)
    solution = list[Scalar]()
    for i in range(len(matrix)):
        total = 0.0
        for j, value in enumerate(right):
            without = [[*row[:i], *row[i + 1:]] for k, row in enumerate(matrix) if k != j]
            term = value * _determinant(without)
            total = total - term if (i + j) % 2 else total + term
        solution.append(per * total)
    return solution


def _reduced(matrix: Matrix, right: Sequence[Scalar]) -> list[list[Scalar]]:
    """Return the rows of a matrix and a right side, reduced without an exchange of rows."""
    rows, count = [[*row, b] for row, b in zip(matrix, right)], len(matrix)
    for k, i in combinations(range(count), 2):
        share = rows[i][k] / rows[k][k]
        rows[i] = [b - share * a if j > k else b for j, (a, b) in enumerate(zip(rows[k], rows[i]))]
    return rows


def _without_pivots(matrix: Matrix, right: Sequence[Scalar]) -> list[Scalar]:
    solution = [0.0] * len(matrix)
    for k, row in reversed(list(enumerate(_reduced(matrix, right)))):
        rest = row[-1]
        for j in range(k + 1, len(matrix)):
            rest = rest - row[j] * solution[j]
        solution[k] = rest / row[k]
    return solution


def _determinant(matrix: Matrix) -> Scalar:
    """Return a determinant by its first row; of a trace each of its parts is computed once."""
    if not matrix:
        return 1.0
    total = 0.0
    for j, value in enumerate(matrix[0]):
        term = value * _determinant([[*row[:j], *row[j + 1:]] for row in matrix[1:]])
        total = total - term if j % 2 else total + term
    return total
