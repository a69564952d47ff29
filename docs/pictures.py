# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Draw conventions and sliders, .svg and .png, in docs: ``python docs/pictures.py``.

Poses come from the core; black and white; the same bytes on every run with the same matplotlib.
Each panel is drawn in inches of paper from its own lower left corner.
"""
from math import atan2, cos, degrees, pi, radians, sin
from pathlib import Path
import sys

import matplotlib

matplotlib.use('agg')

import matplotlib.pyplot as plt  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from fourbar_ros import CROSSED, FourBar, InvertedSlider, OPEN, SliderCrank  # noqa: E402, I100

LENGTHS = (0.4, 1.2, 0.8, 1.0)      # the paper's linkage [m]
THETA1 = radians(60.0)
SLIDER_CRANK = SliderCrank(0.55, 1.15, 0.16), radians(65.0)
INVERTED = InvertedSlider(0.55, 1.0, 0.17), radians(85.0)

SIZE = (10.0, 7.0)                  # [inch]
SLIDERS_SIZE = (10.0, 5.5)
STYLE = {'font.family': 'STIXGeneral', 'mathtext.fontset': 'stix', 'font.size': 12,
         'svg.hashsalt': 'fourbar_ros', 'svg.fonttype': 'path'}
GREY = '0.45'
NOTE = {'fontsize': 11, 'style': 'italic'}
F = r'\mathbf{F}'


# --- strokes -------------------------------------------------------------------------------------

def polar(origin, angle, radius):
    """Return the point at this angle and distance from the origin."""
    return origin[0] + radius * cos(angle), origin[1] + radius * sin(angle)


def moved(point, dx, dy):
    """Return the point moved by (dx, dy)."""
    return point[0] + dx, point[1] + dy


def direction(start, end):
    """Return the direction from start to end."""
    return atan2(end[1] - start[1], end[0] - start[0])


def text(ax, at, label, **style):
    """Write centred text."""
    ax.text(*at, label, **{'ha': 'center', 'va': 'center', 'zorder': 8, **style})


def line(ax, start, end, **style):
    """Draw a thin line."""
    ax.plot(*zip(start, end), **{'color': 'k', 'lw': 0.8, 'zorder': 2, **style})


def reference(ax, origin, angle, radius):
    """Draw the line an angle is measured from."""
    line(ax, origin, polar(origin, angle, radius), color=GREY, dashes=(4, 3), zorder=1)


def arrow(ax, start, end, width=1.8, **style):
    """Draw an arrow."""
    ax.annotate('', end, start, zorder=6, arrowprops={
        'arrowstyle': '-|>,head_width=0.26,head_length=0.55', 'shrinkA': 0, 'shrinkB': 0,
        'lw': width,
        'color': 'k', 'joinstyle': 'miter', **style})


def arc(ax, origin, radius, start, end, width=1.0, sense=True):
    """Draw an arc, with an arrowhead at ``end`` if the angle has a sense."""
    head = 0.1 / radius * (1 if end > start else -1)
    stop = end - 0.8 * head if sense else end
    steps = [start + (stop - start) * i / 80 for i in range(81)]
    ax.plot(*zip(*(polar(origin, step, radius) for step in steps)), color='k', lw=width, zorder=2,
            solid_capstyle='butt')
    if sense:
        tip, back = polar(origin, end, radius), polar(origin, end - head, radius)
        across = (back[0] - tip[0]) * 0.36, (back[1] - tip[1]) * 0.36
        ax.fill(*zip(tip, (back[0] - across[1], back[1] + across[0]),
                     (back[0] + across[1], back[1] - across[0])), color='k', lw=0, zorder=5)


def angle(ax, origin, radius, start, end, label, out=0.0, share=0.5, sense=True):
    """Draw an angle with its label ``out`` beyond its arc, at this share of the way."""
    arc(ax, origin, radius, start, end, sense=sense)
    text(ax, polar(origin, start + share * (end - start), radius + out), label)


def link(ax, start, end):
    """Draw a link."""
    ax.plot(*zip(start, end), color='k', lw=5.5, solid_capstyle='round', zorder=3)
    ax.plot(*zip(start, end), color='0.85', lw=3.5, solid_capstyle='round', zorder=3)


def joint(ax, at):
    """Draw a revolute joint."""
    ax.plot(*at, 'o', ms=7, mfc='w', mec='k', mew=1.3, zorder=7)


def pivot(ax, at, size=0.17, up=False):
    """Draw the ground below (or above) a joint."""
    x, y = at
    base = y + size if up else y - size
    line(ax, at, (x - 0.7 * size, base), lw=1.1)
    line(ax, at, (x + 0.7 * size, base), lw=1.1)
    hatch(ax, x - 1.2 * size, x + 1.2 * size, base, up)


def hatch(ax, left, right, y, up=False):
    """Draw a ground line with strokes below (or above)."""
    line(ax, (left, y), (right, y), lw=1.3)
    count = round((right - left) / 0.08)
    for i in range(count):
        x = left + (i + 0.9) * (right - left) / count
        line(ax, (x - 0.07 * up, y + 0.07 * up), (x - 0.07 * (not up), y - 0.07 * (not up)),
             lw=0.7)


def centre_of_gravity(ax, at, size=0.085):
    """Draw the mark of a centre of gravity."""
    for quarter in range(4):
        points = [polar(at, (quarter + i / 12) * pi / 2, size) for i in range(13)]
        ax.fill(*zip(at, *points), fc='k' if quarter % 2 else 'w', lw=0, zorder=7)
    ax.plot(*zip(*(polar(at, i * pi / 24, size) for i in range(49))), color='k', lw=0.9, zorder=7)


def dimension(ax, start, end, label, shift, **style):
    """Draw a dimension line, its label ``shift`` off the middle."""
    ax.annotate('', end, start, zorder=4, arrowprops={
        'arrowstyle': '<|-|>,head_width=0.14,head_length=0.35', 'shrinkA': 0, 'shrinkB': 0,
        'lw': 0.8,
        'color': 'k'})
    text(ax, ((start[0] + end[0]) / 2 + shift[0], (start[1] + end[1]) / 2 + shift[1]), label,
         **style)


# --- panels --------------------------------------------------------------------------------------

def panel(figure, left, bottom, width, height, title):
    """Return axes whose unit is the inch."""
    across, up = figure.get_size_inches()
    ax = figure.add_axes((left / across, bottom / up, width / across, height / up))
    ax.set(xlim=(0, width), ylim=(0, height))
    ax.axis('off')
    text(ax, (0.0, height - 0.14), title, ha='left', fontsize=12.5, fontweight='bold')
    return ax


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


def bodies_panel(ax):
    """
    Draw (c): free bodies and the ground.

    The directions of the forces are examples, pairs are opposite.
    """
    scale = 1.85
    motion, o1, a, b, o4 = pose(OPEN, (0.75, 0.78), scale)
    a2, b2 = moved(a, 0.95, 0.5), moved(b, 0.95, 0.5)
    b3, o43 = moved(b, 2.15, 0.0), moved(o4, 2.15, 0.0)
    at_o1, at_o4 = radians(-128), radians(-62)
    at_a, at_b = direction(a, a2), direction(b2, b3)
    beta, up = motion.beta, motion.beta + pi / 2

    def force(at, along, label, out=None, length=0.5):
        tip = polar(at, along, length)
        arrow(ax, at, tip)
        text(ax, polar(tip, along, 0.18) if out is None else moved(polar(at, along, 0.3), *out),
             f'${F}_{{{label}}}$')

    def body(start, end, *labels):
        link(ax, start, end)
        for at, (label, dx, dy) in zip((start, end), labels):
            joint(ax, at)
            text(ax, moved(at, dx, dy), label)

    body(o1, a, ('$O_1$', -0.22, 0.02), ('$A$', -0.18, 0.1))
    force(o1, at_o1, 41, length=0.6)
    force(a, at_a, 21, (0.14, -0.18))
    arc(ax, o1, 0.36, radians(-80), radians(150), 1.5)
    text(ax, moved(o1, 0.58, 0.06), '$T_{41}$')
    text(ax, moved(o1, 0.52, -0.47), '1 crank', **NOTE)

    body(a2, b2, ('$A$', 0.02, -0.2), ('$B$', 0.0, 0.2))
    force(a2, at_a + pi, 12, (-0.12, 0.18))
    force(b2, at_b, 32, (0.14, 0.16))
    foot = polar(a2, beta, 0.46 * LENGTHS[1] * scale)
    cg = polar(foot, up, 0.34)
    line(ax, a2, polar(a2, up, 0.72))
    line(ax, cg, polar(cg, up, 0.38))
    line(ax, cg, polar(cg, beta, 0.42))
    dimension(ax, polar(a2, up, 0.64), polar(foot, up, 0.64), 'along', polar((0, 0), up, 0.13),
              fontsize=11, rotation=degrees(beta))
    dimension(ax, polar(foot, beta, 0.34), polar(cg, beta, 0.34), 'across',
              polar((0, 0), beta, 0.3),
              fontsize=11, rotation=degrees(beta))
    centre_of_gravity(ax, cg)
    text(ax, polar(cg, beta + pi, 0.27), 'CG', fontsize=11)
    text(ax, moved(foot, 0.17, -0.2), '2 coupler', **NOTE)

    body(o43, b3, ('$O_4$', -0.24, 0.02), ('$B$', 0.19, 0.06))
    force(b3, at_b + pi, 23, (-0.14, -0.17))
    force(o43, at_o4, 43, length=0.6)
    text(ax, moved(o43, -0.02, 0.6), '3 output link', ha='right', **NOTE)

    ground = 6.4, 1.42
    far = moved(ground, LENGTHS[3] * scale, 0.0)
    same = moved(far, 0.95, 0.0)
    line(ax, ground, far, color=GREY, zorder=1)
    for at, label in ((ground, '$O_1$'), (far, '$O_4$'), (same, '$O_1$')):
        pivot(ax, at)
        joint(ax, at)
        text(ax, moved(at, 0.0, -0.39), label)
    force(ground, at_o1 + pi, 14, length=0.6)
    force(far, at_o4 + pi, 34, length=0.6)
    arc(ax, ground, 0.36, radians(222), radians(72), 1.5)
    text(ax, moved(ground, -0.45, 0.3), '$T_{14}$')
    text(ax, moved(ground, 0.97, 0.15), '4 ground', **NOTE)

    text(ax, moved(far, 0.4, 0.15), '=', fontsize=16)
    total = [0.6 * (f(at_o1 + pi) + f(at_o4 + pi)) for f in (cos, sin)]
    arrow(ax, same, moved(same, *total), 2.6)
    arc(ax, same, 0.36, radians(-45), radians(66), 2.2)
    text(ax, moved(same, total[0] + 0.03, total[1] + 0.15), f'${F}$')
    text(ax, moved(same, 0.5, 0.18), '$M$')
    text(ax, (6.0, 0.6), rf'shaking force  ${F} = {F}_{{14}} + {F}_{{34}}$', ha='left')
    text(ax, (6.0, 0.32), r'shaking moment about $O_1$:  '
         rf'$M = T_{{14}} + (\mathbf{{O}}_4 - \mathbf{{O}}_1) \times {F}_{{34}}$', ha='left')


def block(ax, at, turned, along=0.46, across=0.3, **style):
    """Draw a block about a pin."""
    corners = [polar(polar(at, turned, x * along), turned + pi / 2, y * across)
               for x, y in ((0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5))]
    ax.fill(*zip(*corners), **{'fc': '0.85', 'ec': 'k', 'lw': 1.0, 'zorder': 4, **style})


def x_axis(ax, o1, length):
    """Draw the x axis."""
    arrow(ax, o1, moved(o1, length, 0.0), width=0.9)
    text(ax, moved(o1, length + 0.12, 0.0), '$x$')


def slider_crank_panel(ax):
    """Draw (a): the slider-crank, and its slider alone."""
    linkage, theta1 = SLIDER_CRANK
    motion, scale, o1 = linkage.motion(theta1), 2.2, (0.5, 2.5)
    beta = motion.beta
    a, b = polar(o1, theta1, linkage.a1 * scale), moved(o1, motion.slide * scale,
                                                        linkage.offset * scale)
    guide, low = b[1] - 0.15, o1[1] - 0.47

    x_axis(ax, o1, 4.0)
    line(ax, (o1[0] + 1.0, b[1]), moved(b, 1.15, 0.0), color=GREY, dashes=(4, 3), zorder=1)
    hatch(ax, b[0] - 0.4, b[0] + 0.4, guide)
    for start, end in ((o1, a), (a, b)):
        link(ax, start, end)
    pivot(ax, o1)
    block(ax, b, 0.0, zorder=2)
    for at in (o1, a, b):
        joint(ax, at)

    angle(ax, o1, 0.45, 0.0, theta1, r'$\theta_1$', 0.17)
    reference(ax, a, 0.0, 1.35)
    angle(ax, a, 1.15, 0.0, beta, r'$\beta$', 0.15)
    reference(ax, a, theta1, 0.8)
    angle(ax, a, 0.55, theta1, beta, r'$\theta_2$', 0.18)
    reference(ax, b, beta, 1.08)
    angle(ax, b, 1.0, beta, 0.0, r'$\theta_3$', 0.18)
    reference(ax, b, pi / 2, 0.8)
    angle(ax, b, 0.6, beta, pi / 2, r'$\mu$', 0.15, 0.65, sense=False)

    text(ax, polar(polar(o1, theta1, 0.72), theta1 + pi / 2, 0.2), '$a_1$')
    text(ax, polar(polar(a, beta, 1.5), beta - pi / 2, 0.2), '$a_2$')
    text(ax, moved(o1, -0.27, -0.03), '$O_1$')
    text(ax, moved(a, -0.2, 0.1), '$A$')
    text(ax, moved(b, -0.13, 0.29), '$B$')
    dimension(ax, moved(o1, 1.15, 0.0), (o1[0] + 1.15, b[1]), 'offset', (0.3, 0.0), fontsize=11)
    line(ax, (b[0], guide - 0.12), (b[0], low - 0.07))
    dimension(ax, (o1[0], low), (b[0], low), 'slide', (0, 0), fontsize=11,
              bbox={'fc': 'w', 'lw': 0, 'pad': 1.5})

    slider_alone(ax, (1.3, 0.75), 0.0, (0.52, 0.0), (0.0, 0.13), (0.0, -0.13))
    text(ax, (0.0, 1.55), '3 slider', ha='left', **NOTE)
    text(ax, (2.6, 0.36), 'ground on slider:', ha='left', fontsize=11)
    text(ax, (2.6, 0.13), f'${F}_{{43}}$ = (driving force, guide force)', ha='left', fontsize=11)


def inverted_panel(ax):
    """Draw (b): the inverted slider-crank, and its block alone."""
    linkage, theta1 = INVERTED
    motion, scale, o1 = linkage.motion(theta1), 2.45, (0.8, 2.5)
    theta4, left = motion.theta4, motion.theta4 + pi / 2
    slide, offset = motion.slide * scale, linkage.offset * scale
    a, o4 = polar(o1, theta1, linkage.a1 * scale), moved(o1, linkage.a4 * scale, 0.0)
    foot, low = polar(o4, left, offset), o1[1] - 0.47
    aside = -offset - 0.62

    x_axis(ax, o1, 3.7)
    for start, end in ((o1, a), (o4, foot), (foot, polar(a, theta4, 0.6))):
        link(ax, start, end)
    for at in (o1, o4):
        pivot(ax, at)
    block(ax, a, theta4)
    for at in (o1, a, o4):
        joint(ax, at)

    angle(ax, o1, 0.45, 0.0, theta1, r'$\theta_1$', 0.17)
    reference(ax, o4, theta4, 0.62 * slide)
    angle(ax, o4, 0.5, 0.0, theta4, r'$\theta_4$', 0.17, 0.17)
    reference(ax, a, theta1, 0.8)
    angle(ax, a, 0.6, theta1, theta4, r'$\theta_2$', 0.18)
    line(ax, a, o4, color=GREY, dashes=(1, 2), zorder=1)
    reference(ax, a, left - pi, 1.12)
    angle(ax, a, 0.5, direction(a, o4), left - pi, r'$\mu$', 0.15, sense=False)

    text(ax, polar(polar(o1, theta1, 0.8), theta1 + pi / 2, 0.2), '$a_1$')
    text(ax, moved(o1, -0.27, -0.03), '$O_1$')
    text(ax, moved(o4, 0.4, -0.15), '$O_4$')
    text(ax, polar(a, left, 0.3), '$A$')
    at = polar(foot, theta4, 0.42 * slide)
    dimension(ax, at, polar(at, left, -offset), '', (0, 0))
    text(ax, moved(at, -0.3, -0.1), 'offset', fontsize=11)
    line(ax, polar(o4, left, -0.1), polar(o4, left, -0.69))
    dimension(ax, polar(foot, left, aside), polar(a, left, aside), 'slide', (0, 0), fontsize=11,
              rotation=degrees(theta4) - 180.0, bbox={'fc': 'w', 'lw': 0, 'pad': 1.5})
    dimension(ax, (o1[0], low), (o4[0], low), '$a_4$', (0, 0),
              bbox={'fc': 'w', 'lw': 0, 'pad': 1.5})

    slider_alone(ax, (1.75, 0.8), theta4, (-0.1, 0.12), (-0.42, -0.03), (0.52, 0.07))
    text(ax, (0.0, 1.55), '2 block', ha='left', **NOTE)
    text(ax, (3.0, 0.36), 'bar on block:', ha='left', fontsize=11)
    text(ax, (3.0, 0.13), f'${F}_{{32}}$ = driving + guide force', ha='left', fontsize=11)


def slider_alone(ax, at, turned, by_drive, by_guide, by_couple):
    """Draw a slider alone, with what guide and drive do to it in their positive sense."""
    up = turned + pi / 2
    reference(ax, at, turned + pi, 0.8)
    block(ax, at, turned, 0.7, 0.42)
    out, tip = polar(at, turned, 0.9), polar(at, up, 0.75)
    arrow(ax, polar(at, turned, 0.35), out)
    text(ax, moved(out, *by_drive), 'driving force', fontsize=11)
    arrow(ax, at, tip)
    text(ax, moved(tip, *by_guide), 'guide force', fontsize=11)
    arc(ax, at, 0.5, turned - radians(140), turned - radians(40), 1.5)
    text(ax, moved(polar(at, up, -0.5), *by_couple), 'guide couple', fontsize=11)
    joint(ax, at)


def main():
    """Draw and save."""
    with plt.rc_context({**plt.rcParamsDefault, **STYLE, 'backend': 'agg'}):
        figure = plt.figure(figsize=SIZE)
        angles_panel(panel(figure, 0.15, 3.6, 5.9, 3.3, '(a) Joints, lengths, angles'))
        modes_panel(panel(figure, 6.2, 3.6, 3.7, 3.3,
                          '(b) Assembly modes at the same input angle'))
        bodies_panel(panel(figure, 0.15, 0.1, 9.7, 3.4,
                           rf'(c) Loads: ${F}_{{ij}}$ is the force of link $i$ on link $j$,  '
                           rf'${F}_{{ji}} = -{F}_{{ij}}$'))
        save(figure, 'conventions')
        figure = plt.figure(figsize=SLIDERS_SIZE)
        slider_crank_panel(panel(figure, 0.15, 0.1, 4.8, 5.3, '(a) Slider-crank'))
        inverted_panel(panel(figure, 5.15, 0.1, 4.8, 5.3, '(b) Inverted slider-crank'))
        save(figure, 'sliders')


def save(figure, name):
    """Save a picture."""
    figure.savefig(ROOT / 'docs' / f'{name}.svg', metadata={'Date': None, 'Creator': None})
    figure.savefig(ROOT / 'docs' / f'{name}.png', dpi=160, metadata={'Software': None})
    plt.close(figure)


if __name__ == '__main__':
    main()
