# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What is said about a mechanism: extrema of transmission angles, toggles."""
from math import acos, degrees
import re

from fourbar_lab.drawing.cycles import cycles
from fourbar_lab.drawing.record import transmission_angles
from fourbar_lab.drawing.tables import facts
from fourbar_ros import FourBar
from fourbar_ros.scene.files import folder
from fourbar_ros.scene.scene import load
import numpy as np
import pytest

SCENES = sorted(file.stem for file in folder().glob('*.yaml'))
SAMPLES = 20_001


@pytest.mark.parametrize('lengths', [(0.4, 1.2, 0.8, 1.0), (0.3, 1.0, 0.9, 1.1),
                                     (1.5, 1.2, 1.1, 0.4)])
def test_the_band_of_a_turning_crank_is_that_of_the_cosine_law(lengths):
    a1, a2, a3, a4 = lengths
    ends = [degrees(acos((a2 * a2 + a3 * a3 - d * d) / (2.0 * a2 * a3)))
            for d in (a4 - a1, a4 + a1)]
    linkage = FourBar(*lengths)
    angle, = transmission_angles(linkage).values()
    assert np.degrees([angle['least'], angle['most']]) == pytest.approx(sorted(ends), abs=1e-9)
    worst, text = max(abs(end - 90.0) for end in ends), dict(facts(linkage))['transmission angle']
    assert text.startswith(f'{min(ends):.4f} to {max(ends):.4f} deg; ')
    assert f'worst deviation from 90 deg: {worst:.1f} deg' in text


@pytest.mark.parametrize('name', SCENES)
def test_bands_hold_all_samples_and_no_more(name):
    linkage = load(folder() / f'{name}.yaml').linkage
    motions = [linkage.motion(np.linspace(low, high, SAMPLES)[1:-1])
               for low, high in linkage.input_ranges]
    for field, angle in transmission_angles(linkage).items():
        values = np.concatenate([np.broadcast_to(np.degrees(getattr(motion, field)), SAMPLES - 2)
                                 for motion in motions])
        least, most = np.degrees([angle['least'], angle['most']])
        assert least - 1e-9 <= values.min() and values.max() <= most + 1e-9
        # between two samples an angle grows as the root of the distance at most: at toggles
        near = 2.0 * 180.0 / SAMPLES**0.5
        assert values.min() <= least + near and values.max() >= most - near


@pytest.mark.parametrize('lengths', [(1.0, 0.4, 0.8, 1.2), (1.0, 0.7, 0.9, 1.3)])
def test_links_are_in_line_at_toggles(lengths):
    linkage = FourBar(*lengths)
    text = dict(facts(linkage))['toggle']
    found = [float(angle) for angle in re.findall(r'(-?\d+\.\d+) deg', text)]
    assert len(found) == 2 * len(linkage.input_ranges)
    for angle in found:
        sine = linkage.transmission_sine(linkage.motion(
            np.radians([angle - 1e-4, angle + 1e-4])))      # one of them is in the range
        assert np.nanmin(np.abs(sine)) <= 1e-2      # a root of 1e-4 deg, times what the links are


def test_a_full_turn_has_no_toggle():
    assert dict(facts(FourBar(0.4, 1.2, 0.8, 1.0)))['toggle'].startswith('none')


@pytest.mark.parametrize('stroke', [(0.0, 0.85), (-3.0, -2.0), (20.0, 21.0)])
def test_a_range_of_the_crank_is_that_of_its_facts_curves_and_marks(stroke):
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, stroke=stroke)
    low, high = map(degrees, stroke)
    said = dict(facts(linkage))
    assert said['toggle'].startswith('none') and f'{low:.9g}'[:6] in said['input']
    x, = cycles(linkage)
    assert np.degrees([x[0], x[-1]]) == pytest.approx([low, high], abs=1e-6)
    # as sampled, each counted in the range
    angle, = transmission_angles(linkage).values()
    values = linkage.motion(x).transmission_angle
    assert [angle['least'], angle['most']] == pytest.approx([values.min(), values.max()], abs=1e-6)
    assert stroke[0] - 1e-12 <= angle['worst_at'] <= stroke[1] + 1e-12


def test_each_number_has_its_unit_and_a_zero_of_symmetry_is_zero():
    said = dict(facts(load('press').linkage))
    assert said['lengths'] == 'a1 0.04 m  a2 0.16 m  offset 0 m'
    assert said['inertia at the input'].endswith(' kg m^2')
    assert re.search(r' at \(0\.\d+, 0\) m', said['held rigid, mean'])
