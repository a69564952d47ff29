# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Ask the paper's question: do extreme velocity and acceleration imply extreme shaking."""
from __future__ import annotations

from math import pi

from fourbar_ros import Bodies, find_extrema_many, FourBar, round_rod
import numpy as np
from rich.progress import track

from .pages import figure, save

LINKAGES = 50_000
# of a revolution; a parabola through the highest three locates the peak
SAMPLES = 360
# of the paper's rods; the angles of the peaks do not depend on them much
DENSITY, RADIUS = 7750.0, 0.01
# [deg] what the paper calls close: "3.2 %" of an angle of 5.73 rad
CLOSE = 10.5


def crank_rockers(count, rng):
    """Return lengths, shape (count, 4): uniform in [0.1, 1] m, kept if a Grashof crank-rocker."""
    kept = []
    while sum(map(len, kept)) < count:
        a = rng.uniform(0.1, 1.0, (4 * count, 4))
        a1, a2, a3, a4 = a.T
        margins = np.array([a4 - a1 + a3 - a2, a4 - a1 - a3 + a2, a2 + a3 - a4 - a1])
        kept.append(a[(margins > 0.0).all(axis=0)])
    return np.concatenate(kept)[:count]


def bodies_of(lengths, rng=None):
    """Return uniform rods, or random mass, centre of gravity and inertia (given ``rng``)."""
    rods = [round_rod(length, DENSITY, RADIUS) for length in lengths[:3]]
    if rng is None:
        return Bodies(*rods)
    return Bodies(*(type(rod)(rod.mass * rng.uniform(0.2, 5.0), length * rng.uniform(-0.2, 1.2),
                              length * rng.uniform(-0.3, 0.3), rod.inertia * rng.uniform(0.2, 5.0))
                    for rod, length in zip(rods, lengths)))


def peak(values):
    """Return (angle, height) of the peak of a periodic function, located by a parabola."""
    i = int(values.argmax())
    before, here, after = values[i - 1], values[i], values[(i + 1) % values.size]
    bend = before - 2.0 * here + after
    shift = 0.5 * (before - after) / bend if bend else 0.0
    return (i + shift) * 2.0 * pi / values.size, here - 0.25 * (before - after) * shift


def distance(angle, others):
    """Return the distance [deg] from an angle to the nearest of others, around the circle."""
    return np.degrees(np.abs((angle - others + pi) % (2.0 * pi) - pi).min())


def study(rng, random_bodies):
    """Return {row name: array of distances [deg] or of shares of the maximum}."""
    lengths = crank_rockers(LINKAGES, rng)
    extrema = find_extrema_many(*lengths.T)
    at = {name: (found, np.searchsorted(found.index, np.arange(LINKAGES + 1)))
          for name, found in extrema.items()}
    grid = np.arange(SAMPLES) * 2.0 * pi / SAMPLES
    rows = {}

    def note(name, value):
        rows.setdefault(name, np.empty(LINKAGES))[k] = value

    for k, a in enumerate(track(lengths.tolist(), 'linkages', transient=True)):
        linkage = FourBar(*a, bodies=bodies_of(a, rng if random_bodies else None))
        motion, loads = linkage.step(grid, 1.0)
        angles = {}
        for name, (found, bounds) in at.items():
            part = slice(bounds[k], bounds[k + 1])
            angles[name] = found.theta1[part]
            largest = np.abs(found.value[part]).argmax()
            angles[f'largest {name}'] = found.theta1[part][largest][None]
        chance = rng.uniform(0.0, 2.0 * pi)
        there = linkage.loads(np.concatenate([angles['omega4'], angles['alpha4']]), 1.0)
        for load in ('shaking_force', 'shaking_moment'):
            angle, height = peak(np.abs(getattr(loads, load)))
            for name, others in angles.items():
                note(f'{load}: peak to nearest {name}', distance(angle, others))
            best = np.abs(getattr(there, load))
            split = len(angles['omega4'])
            note(f'{load}: best over the omega4 extrema / maximum',
                 min(1.0, best[:split].max() / height))
            note(f'{load}: best over the alpha4 extrema / maximum',
                 min(1.0, best[split:].max() / height))
        for name in ('omega4', 'alpha4'):
            note(f'chance: a random angle to nearest {name}', distance(chance, angles[name]))
        sine = np.sin(motion.transmission_angle).min()
        note('good transmission', sine > 0.5)
    return rows


def table(rows, kept):
    """Print distances and shares as two tables."""
    print('| distance in theta1 [deg] | median | 90 % | 99 % | largest | within 10.5 deg |')
    print('| --- | --- | --- | --- | --- | --- |')
    for name, values in rows.items():
        if ' to nearest ' in name:
            v = values[kept]
            print(f'| {name} | {np.median(v):.1f} | {np.quantile(v, 0.9):.1f} | '
                  f'{np.quantile(v, 0.99):.1f} | {v.max():.1f} | {100 * (v <= CLOSE).mean():.0f} '
                  '% |')
    print('\n| value there over the true maximum | 1 % | 10 % | median | below 0.9 |')
    print('| --- | --- | --- | --- | --- |')
    for name, values in rows.items():
        if ' / maximum' in name:
            v = values[kept]
            print(f'| {name.replace(" / maximum", "")} | {np.quantile(v, 0.01):.2f} | '
                  f'{np.quantile(v, 0.1):.2f} | {np.median(v):.3f} | {100 * (v < 0.9).mean():.0f} '
                  '% |')
    print()


def draw(rows):
    """Write the figure: how far the peak of the shaking force and moment is from the extrema."""
    drawing, axes = figure(1, 2, figsize=(10, 4), sharey=True)
    shares = np.linspace(0.0, 100.0, LINKAGES)
    for axis, load, title in zip(axes, ('shaking_force', 'shaking_moment'),
                                 ('shaking force', 'shaking moment')):
        for name, style, text in (('alpha4', '-', 'extreme angular acceleration'),
                                  ('omega4', '--', 'extreme angular velocity')):
            axis.plot(np.sort(rows[f'{load}: peak to nearest {name}']), shares, style,
                      color='black', label=text)
        axis.plot(np.sort(rows['chance: a random angle to nearest omega4']), shares, ':',
                  color='grey',
                  label='a random angle to an extreme velocity')
        axis.axvline(CLOSE, color='grey', linewidth=0.8)
        if axis is axes[0]:
            axis.text(CLOSE + 1.5, 4.0, '10.5°: "close" in the paper', fontsize=9)
        axis.set(title=f'peak of the {title}', xlabel='distance in θ1 to the nearest [deg]',
                 xlim=(0.0, 90.0),
                 ylim=(0.0, 100.0))
        axis.grid(alpha=0.3)
    axes[0].set_ylabel('linkages [%]')
    axes[1].legend(loc='lower right')
    save(drawing, 'shaking', dpi=130)


def main():
    """Print the answer for uniform rods and for random bodies; draw the figure."""
    for title, random_bodies in (('Uniform rods', False), ('Random masses, centres of gravity, '
                                                           'inertias', True)):
        rows = study(np.random.default_rng(1), random_bodies)
        for kind, kept in (('all', np.ones(LINKAGES, bool)),
                           ('transmission angle always in [30, 150] deg', rows['good transmission']
                            > 0.0)):
            print(f'## {title}; {kind}: {kept.sum()} crank-rockers\n')
            table(rows, kept)
        if not random_bodies:
            draw(rows)
    print('![How far the shaking peaks are from the extrema of the output](shaking.svg)')


if __name__ == '__main__':
    main()
