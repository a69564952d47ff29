# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Draw both slider-cranks: lengths, angles, forces on the slider."""
from math import degrees, pi, radians

from fourbar_ros import InvertedSlider, SliderCrank
from strokes import (
    angle,
    arc,
    arrow,
    block,
    dimension,
    direction,
    GREY,
    hatch,
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
    x_axis,
)

SIZE = (10.0, 5.5)                  # [inch]
SLIDER_CRANK = SliderCrank(0.55, 1.15, 0.16), radians(65.0)
INVERTED = InvertedSlider(0.55, 1.0, 0.17), radians(85.0)
F = r'\mathbf{F}'


def draw(figure):
    """Draw both panels."""
    slider_crank_panel(panel(figure, 0.15, 0.1, 4.8, 5.3, '(a) Slider-crank'))
    inverted_panel(panel(figure, 5.15, 0.1, 4.8, 5.3, '(b) Inverted slider-crank'))


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
