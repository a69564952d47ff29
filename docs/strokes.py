# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Strokes of the drawn pictures: links, joints, ground, arrows, angles, dimensions.

Each panel is drawn in inches of paper from its own lower left corner, in black and white.
"""
from math import atan2, cos, pi, sin

GREY = '0.45'
NOTE = {'fontsize': 11, 'style': 'italic'}


def panel(figure, left, bottom, width, height, title):
    """Return axes whose unit is the inch."""
    across, up = figure.get_size_inches()
    ax = figure.add_axes((left / across, bottom / up, width / across, height / up))
    ax.set(xlim=(0, width), ylim=(0, height))
    ax.axis('off')
    text(ax, (0.0, height - 0.14), title, ha='left', fontsize=12.5, fontweight='bold')
    return ax


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


def block(ax, at, turned, along=0.46, across=0.3, **style):
    """Draw a block about a pin."""
    corners = [polar(polar(at, turned, x * along), turned + pi / 2, y * across)
               for x, y in ((0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5))]
    ax.fill(*zip(*corners), **{'fc': '0.85', 'ec': 'k', 'lw': 1.0, 'zorder': 4, **style})


def x_axis(ax, o1, length):
    """Draw the x axis."""
    arrow(ax, o1, moved(o1, length, 0.0), width=0.9)
    text(ax, moved(o1, length + 0.12, 0.0), '$x$')
