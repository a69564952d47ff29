# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Draw the picture of conventions.md: angles, assembly modes, forces on free bodies."""
from math import cos, degrees, pi, radians, sin

from fourbar_ros import CROSSED, FourBar, OPEN
from strokes import (
    angle,
    arc,
    arrow,
    centre_of_gravity,
    dimension,
    direction,
    GREY,
    joint,
    line,
    link,
    moved,
    NOTE,
    panel,
    pivot,
    polar,
    reference,
    text,
)

SIZE = (10.0, 7.0)                  # [inch]
LENGTHS = (0.4, 1.2, 0.8, 1.0)      # the paper's linkage [m]
THETA1 = radians(60.0)
F = r'\mathbf{F}'


def draw(figure):
    """Draw all panels."""
    angles_panel(panel(figure, 0.15, 3.6, 5.9, 3.3, '(a) Joints, lengths, angles'))
    modes_panel(panel(figure, 6.2, 3.6, 3.7, 3.3, '(b) Assembly modes at the same input angle'))
    bodies_panel(panel(figure, 0.15, 0.1, 9.7, 3.4,
                       rf'(c) Loads: ${F}_{{ij}}$ is the force of link $i$ on link $j$,  '
                       rf'${F}_{{ji}} = -{F}_{{ij}}$'))


def pose(mode, origin, scale):
    """Return (Motion, O1, A, B, O4) with points on paper."""
    motion = FourBar(*LENGTHS, mode=mode).motion(THETA1)
    a1, _, a3, a4 = (length * scale for length in LENGTHS)
    o4 = origin[0] + a4, origin[1]
    return motion, origin, polar(origin, THETA1, a1), polar(o4, motion.theta4, a3), o4


def angles_panel(ax):
    """Draw (a): lengths, joints and all angles."""
    motion, o1, a, b, o4 = pose(OPEN, (0.72, 0.62), 2.95)
    beta, theta4 = motion.beta, motion.theta4

    line(ax, o1, o4, color=GREY, lw=0.8, zorder=1)
    arrow(ax, o1, (o4[0] + 1.22, o4[1]), width=0.9)
    text(ax, (o4[0] + 1.33, o4[1]), '$x$')
    arrow(ax, o1, (o1[0], o1[1] + 1.45), width=0.9)
    text(ax, (o1[0], o1[1] + 1.57), '$y$')
    ax.plot(o1[0] - 0.36, o1[1] + 0.22, 'o', ms=9, mfc='w', mec='k', mew=0.9)
    ax.plot(o1[0] - 0.36, o1[1] + 0.22, 'o', ms=2.2, color='k')
    text(ax, (o1[0] - 0.54, o1[1] + 0.22), '$z$')

    for start, end in ((o1, a), (a, b), (o4, b)):
        link(ax, start, end)
    for at in (o1, o4):
        pivot(ax, at)
    for at in (o1, a, b, o4):
        joint(ax, at)

    angle(ax, o1, 0.52, 0.0, THETA1, r'$\theta_1$', 0.17)
    angle(ax, o4, 0.52, 0.0, theta4, r'$\theta_4$', 0.17)
    reference(ax, a, 0.0, 1.45)
    angle(ax, a, 1.15, 0.0, beta, r'$\beta$', 0.14)
    reference(ax, a, THETA1, 0.95)
    angle(ax, a, 0.62, THETA1, beta, r'$\theta_2$', 0.18)
    reference(ax, b, beta, 0.85)
    angle(ax, b, 0.5, beta, theta4 - pi, r'$\theta_3$', 0.17, 0.45)
    angle(ax, b, 0.5, beta + pi, theta4 + pi, r'$\mu$', 0.14, sense=False)

    text(ax, (0.0, 2.88), r'$\theta_1,\ \beta,\ \theta_4$ absolute,  $\theta_2,\ \theta_3$ '
                          r'relative,',
         ha='left', fontsize=11)
    text(ax, (0.0, 2.66), 'counter-clockwise positive', ha='left', fontsize=11)
    middle = (a[0] + b[0]) / 2, (a[1] + b[1]) / 2
    text(ax, polar(middle, beta + pi / 2, 0.2), '$a_2$')
    text(ax, polar(polar(o1, THETA1, 0.72), THETA1 + pi / 2, 0.2), '$a_1$')
    text(ax, polar(polar(o4, theta4, 1.15), theta4 - pi / 2, 0.22), '$a_3$')
    dimension(ax, (o1[0], o1[1] - 0.42), (o4[0], o4[1] - 0.42), '$a_4$', (0, 0),
              bbox={'fc': 'w', 'lw': 0, 'pad': 1.5})
    text(ax, (o1[0] - 0.27, o1[1] - 0.03), '$O_1$')
    text(ax, (o4[0] - 0.27, o4[1] + 0.15), '$O_4$')
    text(ax, (a[0] - 0.2, a[1] + 0.1), '$A$')
    text(ax, (b[0] - 0.06, b[1] + 0.23), '$B$')


def modes_panel(ax):
    """Draw (b): both assembly modes at one input angle."""
    for mode, origin, name, relation in ((OPEN, (0.15, 1.66), 'mode 2: open', '>'),
                                         (CROSSED, (2.25, 1.66), 'mode 1: crossed', '<')):
        _, o1, a, b, o4 = pose(mode, origin, 1.25)
        line(ax, o1, o4, color=GREY, zorder=1)
        for start, end in ((o1, a), (a, b), (o4, b)):
            link(ax, start, end)
        pivot(ax, o1, 0.13)
        pivot(ax, o4, 0.13, up=mode == CROSSED)
        for at in (o1, a, b, o4):
            joint(ax, at)
        angle(ax, o1, 0.26, 0.0, THETA1, r'$\theta_1$' if mode == OPEN else '', 0.15, 0.42)
        text(ax, (a[0] - 0.08, a[1] + 0.18), '$A$')
        text(ax, (b[0] + 0.2, b[1] - 0.02), '$B$')
        x = origin[0] + 0.62
        text(ax, (x, 2.88), name)
        text(ax, (x, 0.26), rf'$\sin(\theta_4 - \beta) {relation} 0$')


# --- (c) loads -----------------------------------------------------------------------------------

SCALE = 1.85                        # [inch/m]


def bodies_panel(ax):
    """
    Draw (c): free bodies and the ground.

    The directions of the forces are examples, pairs are opposite.
    """
    motion, o1, a, b, o4 = pose(OPEN, (0.75, 0.78), SCALE)
    a2, b2 = moved(a, 0.95, 0.5), moved(b, 0.95, 0.5)
    b3, o43 = moved(b, 2.15, 0.0), moved(o4, 2.15, 0.0)
    at_a, at_b = direction(a, a2), direction(b2, b3)
    at_o1, at_o4 = radians(-128), radians(-62)
    crank_alone(ax, o1, a, at_o1, at_a)
    coupler_alone(ax, a2, b2, at_a, at_b, motion.beta)
    output_link_alone(ax, o43, b3, at_o4, at_b)
    far = ground_alone(ax, (6.4, 1.42), at_o1, at_o4)
    shaking(ax, far, at_o1, at_o4)


def force(ax, at, along, label, out=None, length=0.5):
    """Draw a force on a joint, its label beyond the tip or ``out`` from its middle."""
    tip = polar(at, along, length)
    arrow(ax, at, tip)
    text(ax, polar(tip, along, 0.18) if out is None else moved(polar(at, along, 0.3), *out),
         f'${F}_{{{label}}}$')


def body(ax, start, end, *labels):
    """Draw a link with labels (text, dx, dy) of its joints."""
    link(ax, start, end)
    for at, (label, dx, dy) in zip((start, end), labels):
        joint(ax, at)
        text(ax, moved(at, dx, dy), label)


def crank_alone(ax, o1, a, at_o1, at_a):
    """Draw the crank with its forces and torque."""
    body(ax, o1, a, ('$O_1$', -0.22, 0.02), ('$A$', -0.18, 0.1))
    force(ax, o1, at_o1, 41, length=0.6)
    force(ax, a, at_a, 21, (0.14, -0.18))
    arc(ax, o1, 0.36, radians(-80), radians(150), 1.5)
    text(ax, moved(o1, 0.58, 0.06), '$T_{41}$')
    text(ax, moved(o1, 0.52, -0.47), '1 crank', **NOTE)


def coupler_alone(ax, a, b, at_a, at_b, beta):
    """Draw the coupler with its forces, and where its centre of gravity is."""
    body(ax, a, b, ('$A$', 0.02, -0.2), ('$B$', 0.0, 0.2))
    force(ax, a, at_a + pi, 12, (-0.12, 0.18))
    force(ax, b, at_b, 32, (0.14, 0.16))
    up, foot = beta + pi / 2, polar(a, beta, 0.46 * LENGTHS[1] * SCALE)
    cg = polar(foot, up, 0.34)
    line(ax, a, polar(a, up, 0.72))
    line(ax, cg, polar(cg, up, 0.38))
    line(ax, cg, polar(cg, beta, 0.42))
    dimension(ax, polar(a, up, 0.64), polar(foot, up, 0.64), 'along', polar((0, 0), up, 0.13),
              fontsize=11, rotation=degrees(beta))
    dimension(ax, polar(foot, beta, 0.34), polar(cg, beta, 0.34), 'across',
              polar((0, 0), beta, 0.3), fontsize=11, rotation=degrees(beta))
    centre_of_gravity(ax, cg)
    text(ax, polar(cg, beta + pi, 0.27), 'CG', fontsize=11)
    text(ax, moved(foot, 0.17, -0.2), '2 coupler', **NOTE)


def output_link_alone(ax, o4, b, at_o4, at_b):
    """Draw the output link with its forces."""
    body(ax, o4, b, ('$O_4$', -0.24, 0.02), ('$B$', 0.19, 0.06))
    force(ax, b, at_b + pi, 23, (-0.14, -0.17))
    force(ax, o4, at_o4, 43, length=0.6)
    text(ax, moved(o4, -0.02, 0.6), '3 output link', ha='right', **NOTE)


def ground_alone(ax, o1, at_o1, at_o4):
    """Draw the ground with its forces and torque, and O1 again beside it; return O4."""
    o4 = moved(o1, LENGTHS[3] * SCALE, 0.0)
    line(ax, o1, o4, color=GREY, zorder=1)
    for at, label in ((o1, '$O_1$'), (o4, '$O_4$'), (moved(o4, 0.95, 0.0), '$O_1$')):
        pivot(ax, at)
        joint(ax, at)
        text(ax, moved(at, 0.0, -0.39), label)
    force(ax, o1, at_o1 + pi, 14, length=0.6)
    force(ax, o4, at_o4 + pi, 34, length=0.6)
    arc(ax, o1, 0.36, radians(222), radians(72), 1.5)
    text(ax, moved(o1, -0.45, 0.3), '$T_{14}$')
    text(ax, moved(o1, 0.97, 0.15), '4 ground', **NOTE)
    return o4


def shaking(ax, o4, at_o1, at_o4):
    """Draw what the forces on the ground add up to: shaking force and moment about O1."""
    text(ax, moved(o4, 0.4, 0.15), '=', fontsize=16)
    same = moved(o4, 0.95, 0.0)
    total = [0.6 * (f(at_o1 + pi) + f(at_o4 + pi)) for f in (cos, sin)]
    arrow(ax, same, moved(same, *total), 2.6)
    arc(ax, same, 0.36, radians(-45), radians(66), 2.2)
    text(ax, moved(same, total[0] + 0.03, total[1] + 0.15), f'${F}$')
    text(ax, moved(same, 0.5, 0.18), '$M$')
    text(ax, (6.0, 0.6), rf'shaking force  ${F} = {F}_{{14}} + {F}_{{34}}$', ha='left')
    text(ax, (6.0, 0.32), r'shaking moment about $O_1$:  '
         rf'$M = T_{{14}} + (\mathbf{{O}}_4 - \mathbf{{O}}_1) \times {F}_{{34}}$', ha='left')
