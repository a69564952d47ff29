# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Loads of a machine: Newton-Euler backward through its dyads.

The paper's 9x9 system, Eq. (9), is solved by hand as its Eq. (10) does by an inverse. Assumed:
rigid links that move in one plane; joints without clearance; gravity uniform;
external forces and couples constant along the ground axes, at points fixed in their link. The
drive is a pure torque on the second of two links from the first, or a force along a slide.

A link needs the force f and the moment m_X about its first joint X, by (N1) and (N2) of
:mod:`fourbar_ros.mechanics.newton_euler`. The drive follows from virtual power with the velocities
at unit rate of the input,

    (L1)  T = sum of f . X' + m_X angle'

the shaking force and moment about O1 from the links, -sum of f and -sum of m_X + X x f. Then the
dyads are solved from the last to the first, each a statically determinate system solved by hand.
Where the ground is a link of a dyad and the frame moves, the ground needs the loads that hold all
other links,

    (L2)  f, m of the ground = shaking force and moment, but for forces that it bears itself

A dyad adds its forces to the *needs* of the links on which it hangs: the force f and the moment
m about its first joint that the joints of a link must add up to. The force D of a
cylinder's drive acts along its rod, on the rod and back on the tube. Slides transmit
a normal force along n and a couple; with friction, which few machines have, see
:mod:`fourbar_ros.mechanisms.machine.solve.friction`. Notation as in
:mod:`fourbar_ros.mechanisms.machine.solve.dyads`.

RRR, with F = a e1 + b e2 of the second rod on the first at B, r1 e1 x F = m1, -r2 e2 x F = m2:

    (F1)  b = m1 / (r1 sine),   a = m2 / (r2 sine);   at P f1 - F, at Q f2 + F

RRP, with F = -a t - b n of the block on the rod, N n and the couple C of the guide on the block:

    (F2)  a = f2 . t,   b = (h a - m1) / g,   N = f2 . n - b,   C = m2;   at P f1 - F

RPR, with F = N n and the couple C of the bar on the block:

    (F3)  C = m1,   N = -(m1 + m2) / s;   at P f1 - F, at Q f2 + F

RPP, with F = N2 n_c and C2 of the slot on the block, N1 n and C1 of the guide on the yoke:

    (F4)  N2 = f2 . t / sin g,  C2 = m1,  N1 = f2 . n + N2 cos g,  C1 = m2 + C2 + d N2;
          at P f1 - F, F = N2 n_c

PRP, with N1 n1, C1 and N2 n2, C2 of the lines on the blocks, f = f1 + f2:

    (F5)  N1 = f . t2 / (t1 x t2),   N2 = -f . t1 / (t1 x t2),   C1 = m1,   C2 = m2,
          F = f1 - N1 n1
"""
from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import partial
from typing import NamedTuple, TYPE_CHECKING

from fourbar_ros.mechanics.bodies import Body, Gravity, NOT_APPLIED
from fourbar_ros.mechanics.newton_euler import Needs, needs_of, Vector
from fourbar_ros.mechanisms.curves import FIXED, LinkMotion
from fourbar_ros.mechanisms.machine import structure
from fourbar_ros.mechanisms.machine.solve.pairs import slides_of
from fourbar_ros.mechanisms.machine.structure import CYLINDER, DyadLengths, Layout, Stage
from fourbar_ros.mechanisms.parts import GROUND, NamedFields
from fourbar_ros.numerics.number_types import NumberType, Scalar

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.machine.solve.friction import MachineFriction

AXIS = Vector(1.0, 0.0)
NONE_REVERSED: Mapping[str, Scalar] = {}


def loads_of(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths],
             bodies: Iterable[Body], gravity: Gravity, external: NamedTuple,
             motion: NamedFields, friction: MachineFriction | None = None) -> tuple[Scalar, ...]:
    """Return the fields of :func:`.structure.load_fields` for a motion of a machine."""
    unit_curves = {link: LinkMotion(*[getattr(motion, f'{name}_{link}')
                                      for name in structure.COEFFICIENTS])
                   for link in layout.moving}
    needs = {link: needs_of(body, 1.0, gravity, getattr(external, link, NOT_APPLIED),
                            curve.at(motion.rate, motion.acceleration))
             for (link, curve), body in zip(unit_curves.items(), bodies)}
    slides = [[getattr(motion, structure.travel(link).position) for link in stage.slides()]
              for stage in layout.stages]
    sines = [getattr(motion, f'sine_{stage.name}') for stage in layout.stages]
    return solve_loads(n, layout, dyad_lengths, unit_curves, needs, slides, sines,
                       friction=friction)


def solve_loads(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths],
                curves: Mapping[str, LinkMotion], needs: dict[str, Needs],
                slides: Sequence[Sequence[Scalar]], sines: Sequence[Scalar],
                unit: Scalar = 1.0, lengths_of_reversed: Mapping[str, Scalar] = NONE_REVERSED,
                borne: Collection[str] = (), friction: MachineFriction | None = None
                ) -> tuple[Scalar, ...]:
    """Return the fields of :func:`.structure.load_fields`."""
    # curves, needs: of the moving links by name, curves at unit rate of the input; slides, sines:
    # of each dyad; unit: of lengths [m], so that moments are in N unit. lengths_of_reversed: of
    # links that the machine takes from their other joint on: their needs are moved there. borne:
    # links with first joints on the ground, if the ground moves in the frame. The force that such
    # a link needs is borne at that joint and is left out of the forces here, as a heavy crank on
    # O1 would spoil the digits of those at A; the caller adds it. friction: of the joints, if any
    # has.
    drive = shake_x = shake_y = shaking_moment = 0.0
    of_ground = Needs(Vector(0.0, 0.0), 0.0)
    for link, (force, moment) in needs.items():
        curve = curves[link]
        drive = drive + (force.x * curve.v_x + force.y * curve.v_y + moment * curve.omega)  # (L1)
        shake_x, shake_y = shake_x - force.x, shake_y - force.y
        about_O1 = moment + curve.x * force.y - curve.y * force.x
        shaking_moment = shaking_moment - about_O1
        of_ground = (Needs(of_ground.force, of_ground.moment - moment) if link in borne
                     else Needs(of_ground.force - force, of_ground.moment - about_O1))   # (L2)
    drive = unit * drive
    directions = {link: Vector(curve.cosine, curve.sine) for link, curve in curves.items()}
    directions[GROUND] = AXIS
    forces_borne = {link: needs[link].force for link in borne}
    needs = {**needs, GROUND: of_ground,
             **{link: Needs(Vector(0.0, 0.0), needs[link].moment) for link in borne}}
    for link, length in lengths_of_reversed.items():
        force, moment = needs[link]
        needs[link] = Needs(force, moment - length * directions[link].cross(force))
        directions[link] = -directions[link]
    moving = [curves.get(link, FIXED) for link in layout.links]
    # nothing hangs on the last dyad, and each adds its forces to the needs of its carriers
    e, held, fields = ([directions[link] for link in layout.links],
                       [needs[link] for link in layout.links], list[Scalar]())
    for stage, lengths, of_stage, sine in [*zip(layout.stages, dyad_lengths, slides, sines)][::-1]:
        i = stage.link
        solve = partial(SOLVERS[stage.kind], lengths.sizes, e[i], e[i + 1], of_stage, sine)
        if friction:
            forces, drive = friction.of_dyad(stage, lengths, of_stage, e, moving, held, solve,
                                             drive, borne_at(layout, stage, forces_borne))
        else:
            forces = solve(held[i], held[i + 1])
            if stage.name == CYLINDER:
                forces = with_drive_along(forces, e[i] * drive)
        of_dyad, sliding = list[Scalar](), slides_of(stage, lengths)
        normals = dict(zip(structure.SLIDES[stage.kind], forces.normals))
        for joint in structure.JOINTS:
            force = getattr(forces, joint)
            of_dyad += (force.x, force.y, n.hypot(force.x, force.y))
            if joint in normals:
                of_dyad += (normals[joint], getattr(forces, f'{joint}_couple'))
        fields = [*of_dyad, *fields]
        for member, carrier, arm, force, couple in (
                (i, stage.first, lengths.p, forces.first, forces.first_couple),
                (i + 1, stage.second, lengths.q, forces.second, forces.second_couple)):
            if not carrier:     # the frame
                continue
            # where the member begins on its carrier, from the first joint of that: differences of
            # places on the ground would lose digits far from O1
            for slide, (block, (rail, (x, y), (c, s))) in zip(of_stage, sliding):
                if (block, rail) == (member, carrier):
                    arm = x + slide * c, y + slide * s
            r = Vector(*arm).along(e[carrier])
            held[carrier] = Needs(held[carrier].force + force, held[carrier].moment + couple
                                  + r.x * force.y - r.y * force.x)
    (force, moment), of_slide = held[1], list[Scalar]()
    if layout.driver == 'slide':            # normal force and couple, and the drive along it
        of_slide = [e[0].cross(force), moment]
        force = e[0] * drive + e[0].normal * of_slide[0]
    if friction:
        first, second = of_slide or (force.x, force.y)
        drive = friction.of_base(first, second, drive)
    loads = (force.x, force.y, n.hypot(force.x, force.y), *of_slide, *fields,
             *((drive, 0.0) if layout.driver == 'crank' else (0.0, drive)),
             shake_x, shake_y, n.hypot(shake_x, shake_y), shaking_moment)
    # NaN where friction locks a joint
    return tuple([load + friction.gate for load in loads]) if friction else loads


def borne_at(layout: Layout, stage: Stage, forces: Mapping[str, Vector]) -> dict[str, Vector]:
    """Return {joint of a dyad: the force that is borne there besides that of the dyad}."""
    borne = dict[str, Vector]()
    for joint, name in stage.joints():
        first, second = [layout.links[link] for link in stage.ends(joint)]
        loaded, acting = (first, second) if joint == 'inner' else (second, first)
        if acting == GROUND and loaded in forces:
            borne[name] = forces[loaded]
        elif loaded == GROUND and acting in forces:
            borne[name] = -forces[acting]
    return borne


class DyadForces(NamedTuple):
    """Forces [N] at the joints of a dyad, and couples [N m] about first joints of its links."""

    first: Vector               # of the link of its point ``first`` on its first link
    first_couple: Scalar
    second: Vector              # of the link of its point ``second`` on its second link
    second_couple: Scalar
    inner: Vector               # of its second link on its first
    inner_couple: Scalar
    normals: tuple[Scalar, ...]     # normal forces of the joints that slide, in their order


def with_drive_along(forces: DyadForces, push: Vector) -> DyadForces:
    """Return the forces in a cylinder whose drive pushes the rod, and the tube back."""
    return forces._replace(first=forces.first - push, first_couple=0.0,
                           second=forces.second + push, second_couple=0.0,
                           inner=forces.inner + push)


def rrr_forces(sizes: Sequence[Scalar], e1: Vector, e2: Vector, _slides: Sequence[Scalar],
               sine: Scalar, needs1: Needs, needs2: Needs) -> DyadForces:
    """Return the forces in the dyad RRR, two rods, from the moments of both about P and Q."""
    (f1, m1), (f2, m2), (r1, r2) = needs1, needs2, sizes
    b, a = m1 / (r1 * sine), m2 / (r2 * sine)                                           # (F1)
    F = e1 * a + e2 * b
    return DyadForces(f1 - F, 0.0, f2 + F, 0.0, F, 0.0, ())


def rrp_forces(sizes: Sequence[Scalar], e1: Vector, t: Vector, _slides: Sequence[Scalar],
               sine: Scalar, needs1: Needs, needs2: Needs) -> DyadForces:
    """Return the forces in the dyad RRP, a rod and a block that slides along t."""
    (f1, m1), (f2, m2), r1, n = needs1, needs2, sizes[0], t.normal
    h, g = r1 * t.cross(e1), r1 * sine
    a = f2.dot(t)                                                                       # (F2)
    b = (h * a - m1) / g
    normal = t.cross(f2) - b
    F = -(t * a) - n * b
    return DyadForces(f1 - F, 0.0, n * normal, m2, F, 0.0, (normal,))


def rpr_forces(_sizes: Sequence[Scalar], t: Vector, _t: Vector, slides: Sequence[Scalar],
               _sine: Scalar, needs1: Needs, needs2: Needs) -> DyadForces:
    """Return the forces in the dyad RPR, a block on a bar along t, from both moments about Q."""
    (f1, m1), (f2, m2) = needs1, needs2
    normal = -(m1 + m2) / slides[0]                                                     # (F3)
    F = t.normal * normal
    return DyadForces(f1 - F, 0.0, f2 + F, 0.0, F, m1, (normal,))


def rpp_forces(sizes: Sequence[Scalar], c: Vector, t: Vector, slides: Sequence[Scalar],
               _sine: Scalar, needs1: Needs, needs2: Needs) -> DyadForces:
    """Return the forces in the dyad RPP, a block in a slot along c and its yoke along t."""
    (f1, m1), (f2, m2), (_, _, cos_g, sin_g) = needs1, needs2, sizes
    slot = f2.dot(t) / sin_g                                                            # (F4)
    guide = t.cross(f2) + slot * cos_g
    F = c.normal * slot
    return DyadForces(f1 - F, 0.0, t.normal * guide, m2 + m1 + slides[0] * slot, F, m1,
                      (slot, guide))


def prp_forces(_sizes: Sequence[Scalar], t1: Vector, t2: Vector, _slides: Sequence[Scalar],
               sine: Scalar, needs1: Needs, needs2: Needs) -> DyadForces:
    """Return the forces in the dyad PRP, two blocks pinned together on lines along t1 and t2."""
    (f1, m1), (f2, m2) = needs1, needs2
    f = (f1 + f2) / sine
    normal1, normal2 = f.dot(t2), -f.dot(t1)                                            # (F5)
    on_first = t1.normal * normal1
    return DyadForces(on_first, m1, t2.normal * normal2, m2, f1 - on_first, 0.0,
                      (normal1, normal2))


# (sizes of the dyad, directions of both links, slides, sine, needs of both) -> forces
SOLVERS: dict[str, Callable[..., DyadForces]] = {
    'RRR': rrr_forces, 'RRP': rrp_forces, 'RPR': rpr_forces, 'RPP': rpp_forces, 'PRP': prp_forces}
