"""Polygons close and are to scale; pictures say what is in them."""
import subprocess
import sys
from math import hypot
from pathlib import Path

import numpy as np
import pytest
import slider_reference
from test_points import four_bars

from fourbar_ros.core import Bodies, Body, FourBar
from fourbar_ros.core.inverted_slider import InvertedSlider
from fourbar_ros.core.slider_crank import SliderCrank
from fourbar_ros.draw import joints, nice
from fourbar_ros.polygons import acceleration_polygon, velocity_polygon

ROOT = Path(__file__).parent.parent


def cases(count):
    yield from list(four_bars(131, count))[:count]
    for kind in slider_reference.KINDS:
        yield from slider_reference.random_loaded(kind, 132, count)


def test_polygons_close():
    """Parts in a chain end where a sum from the pole ends; to 1e-12 of the longest arrow."""
    for mechanism, given in cases(15):
        motion = mechanism.motion(*given)
        for polygon in (velocity_polygon, acceleration_polygon):
            arrows = polygon(mechanism, motion)
            longest = max(hypot(*arrow.vector) for arrow in arrows)
            ends = [arrow.vector for arrow in arrows if arrow.is_sum]
            starts = [arrow.start for arrow in arrows]
            assert all(np.array_equal(arrow.start, (0.0, 0.0)) for arrow in arrows if arrow.is_sum)
            for arrow in arrows:
                end = arrow.start + arrow.vector
                assert min(hypot(*(end - other)) for other in ends + starts) <= 1e-12 * longest, arrow.label


def test_sums_are_the_motion_of_the_joints():
    motion = SliderCrank(0.1, 0.3, 0.02).motion(0.7, 30.0, 4.0)
    velocity = {arrow.label: arrow.vector for arrow in velocity_polygon(SliderCrank(0.1, 0.3, 0.02), motion)}
    assert velocity['V_B'] == pytest.approx((motion.slide_velocity, 0.0), abs=1e-14)
    inverted = InvertedSlider(0.1, 0.3, 0.02)
    motion = inverted.motion(0.7, 30.0, 4.0)
    arrows = {arrow.label: arrow.vector for arrow in acceleration_polygon(inverted, motion)}
    assert hypot(*arrows['A_{Cor}']) == pytest.approx(abs(2.0 * motion.omega4 * motion.slide_velocity), rel=1e-14)
    assert hypot(*arrows['A_{rel}']) == pytest.approx(abs(motion.slide_acceleration), rel=1e-14)
    assert hypot(*arrows['A_A']) == pytest.approx(0.1 * hypot(30.0**2, 4.0), rel=1e-14)


def test_joints_keep_the_lengths():
    for mechanism, given in cases(5):
        places = joints(mechanism, mechanism.motion(*given))
        assert hypot(*(places['A'] - places['O_1'])) == pytest.approx(mechanism.a1, rel=1e-14)
        if hasattr(mechanism, 'a2'):
            assert hypot(*(places['B'] - places['A'])) == pytest.approx(mechanism.a2, rel=1e-12)


@pytest.mark.parametrize('value, expected', [(1.0, 1.0), (1.99, 1.0), (2.0, 2.0), (4.9, 2.0), (73.0, 50.0), (0.3, 0.2),
                                             (9e-7, 5e-7)])
def test_scale_bars_are_round(value, expected):
    assert nice(value) == pytest.approx(expected, rel=1e-14)


BODIES = Bodies(Body(1.0, 0.1, 0.0, 0.01), Body(2.0, 0.2, 0.0, 0.02), Body(1.0, 0.1, 0.0, 0.01))


@pytest.mark.parametrize('mechanism, value', [
    (FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES), 1.0), (SliderCrank(0.4, 1.2, -0.1, bodies=BODIES), 1.0),
    (InvertedSlider(0.4, 1.2, 0.1, bodies=BODIES), 1.0), (SliderCrank(0.4, 1.2, input='slide', bodies=BODIES), 1.0)])
def test_pictures_have_equal_scales_and_all_labels(mechanism, value):
    pytest.importorskip('matplotlib')
    from fourbar_ros.draw import make_figure
    motion, loads = mechanism.step(value, 5.0, 1.0)
    figure = make_figure(mechanism, motion, loads, 'title')
    figure.canvas.draw()
    for axes in figure.axes:
        (left, bottom), (right, top) = axes.transData.transform([(0.0, 0.0), (1.0, 1.0)])
        assert (right - left) == pytest.approx(top - bottom, rel=1e-9)
    words = [[text.get_text() for text in axes.texts] for axes in figure.axes]
    assert {f'${name}$' for name in joints(mechanism, motion)} <= set(words[0])
    assert any(f'{loads.f41:.4g} N' in text for text in words[0])
    for arrow in velocity_polygon(mechanism, motion):
        assert f'${arrow.label}$' in words[1] and f'${arrow.label}$ = {hypot(*arrow.vector):.4g}' in words[1]


def test_an_arrow_is_as_long_as_its_scale_bar_says():
    pytest.importorskip('matplotlib')
    from fourbar_ros.draw import make_figure
    mechanism = FourBar(0.4, 1.2, 0.8, 1.0)
    figure = make_figure(mechanism, mechanism.motion(1.0, 25.0))
    velocities = figure.axes[1]
    bar, = (line for line in velocities.lines if len(line.get_xdata()) == 2)
    text, = (text.get_text() for text in velocities.texts if text.get_text().endswith(' m/s'))
    assert np.ptp(bar.get_xdata()) == pytest.approx(float(text.split()[0]), rel=1e-12)     # axes in m/s


def test_the_command(tmp_path):
    pytest.importorskip('matplotlib')

    def draw(*arguments):
        return subprocess.run([sys.executable, '-m', 'fourbar_ros', 'draw', *arguments], capture_output=True, text=True,
                              cwd=ROOT, check=False)

    for name in ('pose.svg', 'pose.pdf'):
        out = tmp_path / name
        done = draw('config/paper.yaml', '--at', '60', '-o', str(out))
        assert done.returncode == 0 and done.stdout.strip() == str(out), done.stderr
        assert out.stat().st_size > 10_000
    done = draw('config/paper.yaml', '--at', '60', '-o', str(tmp_path / 'pose.xyz'))
    assert done.returncode == 1 and done.stderr.startswith('fourbar: ') and len(done.stderr.splitlines()) == 1
    missing = tmp_path / 'missing' / 'pose.svg'
    done = draw('config/paper.yaml', '--at', '60', '-o', str(missing))
    assert done.returncode == 1 and done.stderr == f'fourbar: {missing}: No such file or directory\n'


@pytest.mark.parametrize('arguments', [('draw', 'config/paper.yaml', '--at', '60', '-o', 'pose.svg'),
                                       ('reproduce', '--html', 'page.html')], ids=lambda arguments: arguments[0])
def test_without_matplotlib_one_line_says_what_to_install(monkeypatch, capsys, arguments):
    from fourbar_ros.cli import main
    monkeypatch.chdir(ROOT)
    monkeypatch.setitem(sys.modules, 'matplotlib', None)
    assert main(list(arguments)) == 1
    said = capsys.readouterr().err
    assert said.endswith(' needs matplotlib: pip install matplotlib\n') and len(said.splitlines()) == 1
