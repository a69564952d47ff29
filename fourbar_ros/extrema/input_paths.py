"""
Sample points of the input that resolve any mechanism: for the 4R by :mod:`fourbar_ros.extrema.four_bar_rates.input_paths`, for sliders here.

The input is x = phi for a crank that turns fully, x = middle + half sin(phi) for a range between two toggles,
where phi goes through them into the other assembly mode without a root. The samples are equal steps of

    t(phi) = phi + sum over singular points of some kernels 2 atan(tan((phi - c)/2) / tanh(w/2)),

each of which crowds a constant number of them within w of c. A quantity is analytic but for points z of
the complex plane where the dyad is in line, or a pole; there c = Re z, w = |Im z|, and 4 w, 16 w, ... make
the samples thin out with the distance.
"""
from __future__ import annotations

from math import pi

import numpy as np

from fourbar_ros.extrema.four_bar_rates.input_paths import End, InputPath, closer_points
from fourbar_ros.extrema.four_bar_rates.input_paths import input_paths as elliptic_paths
from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar

# Samples of a kernel; widths of the kernels of a singular point; the least that is resolved.
PER_KERNEL, WIDER, NARROWEST = 16, 4.0, 1e-12
HALVINGS, POLISHINGS = 24, 6        # to solve t(phi) = t


class TooNarrow(FourBarError, ValueError):
    """The range of the input is so narrow beside the input itself that floats do not resolve it."""

    def __init__(self):
        super().__init__('the range of the input is too narrow, beside the input itself, to be searched')


def input_paths(mechanism, points):
    """
    Return the list of :class:`~fourbar_ros.extrema.four_bar_rates.input_paths.InputPath` that make up the motion of a mechanism in its mode.

    ``points`` is the least number of points of a full turn, without those added at the ends. A slide is
    given in units of :attr:`input_unit`.
    """
    if isinstance(mechanism, FourBar):
        return elliptic_paths(mechanism, points)
    unit = mechanism.input_unit
    singular = np.array(mechanism.singular_inputs, complex) / unit
    if mechanism.turns_fully:
        return _closed(singular, points)
    stroke = None if mechanism.stroke is None else [end / unit for end in mechanism.stroke]
    return [path for low, high in mechanism.closing_ranges
            for path in _between(singular, low / unit, high / unit, points, not mechanism.is_driven_by_slide, stroke)]


def _closed(singular, points):
    """Return the paths of a crank that makes full turns: one, or those between its flat positions."""
    flat = np.unique(singular.real[singular.imag == 0.0])
    kernels = _kernels(singular[singular.imag != 0.0], points)
    if not flat.size:
        return [InputPath(_spread(kernels, -pi, pi, ())[0], None, None, 0, -1)]
    ends = [*flat, flat[0] + 2.0 * pi]
    return [_path(kernels, *pair, lambda phi: phi, [End(float(end), True) for end in pair]) for pair in zip(ends, ends[1:])]


def _between(singular, low, high, points, is_periodic, stroke=None):
    """
    Return the paths of a range between two toggles: one, or two with a flat position between them.

    With a stroke, only what of them lies in it, down to its ends.
    """
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    singular = singular[(singular != low) & (singular != high)]
    if is_periodic:
        singular = np.concatenate([singular + turn for turn in (-2.0 * pi, 0.0, 2.0 * pi)])
        singular = singular[(np.abs(singular - low) > NARROWEST) & (np.abs(singular - high) > NARROWEST)]
    scaled = (singular - middle) / half
    is_flat = (scaled.imag == 0.0) & (np.abs(scaled.real) < 1.0)
    angles = np.arcsin(scaled[~is_flat])
    kernels = _kernels(np.concatenate((angles, pi - angles)), points)
    flat = {float(np.arcsin(place)): End(float(x), True)
            for place, x in zip(scaled.real[is_flat], singular.real[is_flat])}
    ends = {-0.5 * pi: End(low, False), **dict(sorted(flat.items())), 0.5 * pi: End(high, False)}
    if stroke:
        ends = _within(ends, stroke, middle, half)

    def to_input(phi):
        # From the nearer end: that distance is what quantities near a toggle depend on.
        return np.where(phi < 0.0, low + 2.0 * half * np.sin(0.5 * (phi + 0.5 * pi))**2,
                        high - 2.0 * half * np.sin(0.5 * (0.5 * pi - phi))**2)
    return [_path(kernels, *pair, to_input, [ends[end] for end in pair]) for pair in zip(ends, list(ends)[1:])]


def _within(ends, stroke, middle, half):
    """Return {phi: End} of the part of a range that lies in a stroke."""
    low, high = stroke
    inside = {phi: end for phi, end in ends.items() if low <= end.x <= high}
    for x in stroke:
        if abs(x - middle) < half and all(x != end.x for end in inside.values()):
            inside[float(np.arcsin((x - middle) / half))] = End(x, False, True)
    return dict(sorted(inside.items()))


def _path(kernels, first, last, to_input, ends):
    phi, before, after = _spread(kernels, first, last, ends)
    x = to_input(phi)
    # Nearer to an end than this, x has no digits left for the distance.
    near = [np.abs(x - end.x) < 2.0**-40 * max(abs(end.x), 2.0**-12) for end in ends]
    before, after = before - near[0].sum(), after - near[1].sum()
    x = x[~(near[0] | near[1])]
    if min(before, after) < 0:
        raise TooNarrow
    return InputPath(x, *ends, int(before), int(x.size - 1 - after))


def _kernels(singular, points):
    """Return (centres, tangents of half the widths, samples of a turn) of all kernels."""
    centres, widths = [0.0], [40.0]               # as good as infinitely wide: equal steps
    for z in singular:
        width = max(abs(z.imag), NARROWEST)
        while width < 1.0:
            centres.append(z.real)
            widths.append(width)
            width *= WIDER
    weights = np.full(len(centres), float(PER_KERNEL))
    weights[0] = points
    return np.array(centres)[:, None], np.tanh(0.5 * np.array(widths))[:, None], weights[:, None] / (2.0 * pi)


def _samples(kernels, phi):
    """Return t and dt/dphi: t rises by the number of samples of all kernels in a turn of phi."""
    centres, tangents, weights = kernels
    half = 0.5 * (phi - centres)
    turns = np.round(half / pi)
    half = half - turns * pi                      # in [-pi/2, pi/2]
    sine, cosine = np.sin(half), np.cos(half)
    t = 2.0 * (np.arctan2(sine, tangents * cosine) + turns * pi)
    return (weights * t).sum(axis=0), (weights * tangents / (sine * sine + (tangents * cosine)**2)).sum(axis=0)


def _spread(kernels, first, last, ends):
    """Return the phi of equal steps between two ends, half a step from them, and how many were added at each."""
    begin, end = (_samples(kernels, np.array([v]))[0][0] for v in (first, last))
    count = int(np.ceil(end - begin))
    before, after = (closer_points(end, count) for end in ends or (None, None))
    t = np.concatenate((before[::-1], (np.arange(count) + 0.5) / count, 1.0 - after))
    t = begin + (end - begin) * t
    low, high = np.full(t.size, first), np.full(t.size, last)
    for _ in range(HALVINGS):
        phi = 0.5 * (low + high)
        is_low = _samples(kernels, phi)[0] < t
        low, high = np.where(is_low, phi, low), np.where(is_low, high, phi)
    for _ in range(POLISHINGS):
        value, slope = _samples(kernels, phi)
        phi = np.clip(phi - (value - t) / slope, low, high)
    return phi, before.size, after.size
