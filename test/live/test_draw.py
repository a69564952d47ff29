# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Linkages drawn in a real browser by real clicks and drags.

What is drawn is a scene: Python reads it, and its pose is the picture's.
"""
import json
from math import hypot, tau
import shutil

from fourbar_lab.live.answers import scene_of
from fourbar_ros.cli.main import main
from fourbar_ros.errors import OutOfRange
from fourbar_ros.extrema import find_extrema
from fourbar_ros.mechanisms.picture import diagram_of
from fourbar_ros.scene.files import folder
from fourbar_ros.scene.scene import load
from PIL import Image
import pytest
from support.browser import browser, live, needs_browser, Tab

pytestmark = needs_browser
CLICK = 1.5         # [px]: a click is at whole pixels
BESIDE = 90         # [px] from the middle of a link to the left end of its length's label


class Paper(Tab):
    """A page on which one draws; places are in pixels of the window, from the picture's middle."""

    def tool(self, name):
        self.driver.find_element('css selector', f'[data-tool={name}]').click()

    def begin(self):
        """Begin with nothing."""
        self.tool('new')
        self.until(lambda: self.state['scene'] == {} and self.state['view']['tool'] == 'rods',
                   'an empty page')

    def at(self, x, y):
        """Return a place of the window, x and y [px] from the middle of the picture."""
        left, top, width, height = self.script(
            'const b = page.picture.svg.getBoundingClientRect(); '
            'return [b.x, b.y, b.width, b.height]')
        return left + width / 2 + x, top + height / 2 - y

    def press(self, *places):
        """Click at each of some places."""
        for place in places:
            self.drag(place)

    def joint(self, name):
        """Return where a joint is in the plane [m]."""
        return self.script('return page.engine.joint(arguments[0])', name)

    def between(self, one, two, part=0.5):
        """Return a place on the way from a joint to another."""
        (x, y), (u, v) = self.place(one), self.place(two)
        return x + part * (u - x), y + part * (v - y)

    def drawn(self, *dyads):
        """Wait until scene and picture have these dyads; return the scene in Python."""
        joints = [f'{name}_first' for name in dyads]
        self.until(lambda: list(dyads) == self.state['scene'].get('linkage', {}).get('dyads', [])
                   and self.script('return Boolean(page.engine) && arguments[0].every(joint => '
                                   'joint in page.engine.structure.sketch.joints)', joints),
                   f'the dyads {dyads}')
        return self.in_python()

    def in_python(self):
        """Return the scene in Python, once its pose is the picture's to 1e-12 of its size."""
        scenes = []

        def is_as_shown():
            scene = scene_of(self.state['scene'])
            scenes[:] = [scene]
            x = self.script('return page.engine.x')
            try:
                joints = diagram_of(scene.linkage, scene.linkage.motion(x)).joints
            except OutOfRange:          # the engine is that of the scene before
                return False
            size = max(hypot(*place) for place in joints.values())
            shown = self.script('return arguments[0].map(joint => page.engine.joint(joint))',
                                [*joints])
            return not self.alarm() and max(
                hypot(u - x, v - y) for (u, v), (x, y) in zip(shown, joints.values())
            ) < 1e-12 * size
        self.until(is_as_shown, 'the pose of Python')
        return scenes[0]

    def four_bar(self):
        """Draw a four-bar by four clicks."""
        self.begin()
        self.press(self.at(-100, -80), self.at(-60, 0), self.at(140, 110), self.at(150, -80))
        return self.drawn('d1')


@pytest.fixture(scope='module')
def file(tmp_path_factory):
    """Return a scene that a page may save, away from the shipped ones."""
    path = tmp_path_factory.mktemp('scenes') / 'mine.yaml'
    shutil.copy(folder() / 'paper.yaml', path)
    return path


@pytest.fixture(scope='module')
def address(file):
    with live(file) as address:
        yield address


@pytest.fixture
def paper(driver, address):
    return Paper(driver, address)


def test_a_four_bar_is_drawn_by_four_clicks_and_saved(paper, file):
    scene = paper.four_bar()
    dyad, = scene.linkage.dyads
    assert dyad.mode == 2 and dyad.first.link == 'crank' and dyad.second.link == 'ground'
    # three digits, as the clicks were: 200 px are 250 mm of an empty page of 800 px, and so on
    for length in (dyad.length_1, dyad.length_2, dyad.first.along):
        assert float(f'{length:.3g}') == length
    scale = hypot(40, 80) / dyad.first.along
    assert hypot(200, 110) / scale == pytest.approx(dyad.length_1, abs=2 * CLICK / scale)
    assert hypot(10, 190) / scale == pytest.approx(dyad.length_2, abs=2 * CLICK / scale)
    assert scene.linkage.loads(1.0, 10.0).driving_torque       # with masses of steel
    paper.menu('files', 'save in its file')
    paper.until(lambda: 'saved' in paper.text_of('said'), 'the file')
    assert main(['scene', 'check', str(file)]) == 0
    saved = load(file)
    assert saved.linkage == scene.linkage and saved.values == scene.values


def test_bars_are_made_of_a_material_and_the_crank_with_them(paper):
    before = paper.four_bar().linkage.bodies
    paper.open('Numbers')
    paper.script("""
document.querySelectorAll("#panel details").forEach(e => e.open = true);
const material = document.querySelector("[aria-label=material]");
material.value = "2700";
material.onchange()""")
    paper.until(lambda: paper.state['scene']['bodies']['rods']['density'] == 2700, 'aluminium')
    # what is none of them is shown, not chosen: it made a density of 0
    assert paper.script("return document.querySelector('[aria-label=material] option').disabled")
    after = paper.in_python().linkage.bodies
    for name in ('crank', 'l1', 'l2'):
        one, two = getattr(before, name), getattr(after, name)
        for field in ('mass', 'inertia'):
            ratio = getattr(two, field) / getattr(one, field)
            assert ratio == pytest.approx(2700 / 7850, rel=1e-9)
    along = paper.state['scene']['linkage']['points']['A']['along']
    paper.write('linkage.points.A.along', str(0.9 * along))
    assert paper.in_python().linkage.bodies.crank.mass == pytest.approx(
        0.9 * after.crank.mass, rel=1e-9)


def test_a_four_bar_is_drawn_and_shaped_by_keys_alone(paper):
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys
    paper.begin()
    paper.script('page.picture.svg.focus({ preventScroll: true })')

    def keys(*pressed):
        ActionChains(paper.driver).send_keys(*pressed).perform()
    keys(Keys.LEFT * 6, Keys.DOWN * 4, Keys.ENTER, Keys.RIGHT * 2, Keys.UP * 4, Keys.ENTER,
         Keys.RIGHT * 10, Keys.UP * 5, Keys.ENTER, Keys.DOWN * 9, Keys.ENTER)
    dyad, = paper.drawn('d1').linkage.dyads
    scale = paper.script('return page.picture.scale')
    # of 200 and 100 px, to a third digit
    assert dyad.length_1 * scale == pytest.approx(hypot(200, 100), rel=5e-3)
    assert dyad.second.along * scale == pytest.approx(240, rel=5e-3)
    assert dyad.second.across == pytest.approx(0.0, abs=5e-3 * 240 / scale)
    before = paper.state['scene']
    paper.tool('shape')
    paper.script('page.picture.svg.focus({ preventScroll: true })')
    x, y = paper.script('const p = page.picture; return p.pixels(page.engine.joint("d1_second"))'
                        '.map((v, i) => v - [p.width, p.height][i] / 2)')
    sideways, upwards = (Keys.RIGHT if x > 0 else Keys.LEFT), (Keys.DOWN if y > 0 else Keys.UP)
    keys(sideways * round(abs(x) / 20), upwards * round(abs(y) / 20), ' ', Keys.RIGHT * 2, ' ')
    assert paper.in_python().linkage.dyads[0].second.along > dyad.second.along
    ActionChains(paper.driver).key_down(Keys.CONTROL).send_keys('z').key_up(Keys.CONTROL).perform()
    paper.until(lambda: paper.state['scene'] == before, 'the scene before')


def test_a_slider_crank_gets_a_spring(paper):
    paper.begin()
    paper.press(paper.at(-200, 0), paper.at(-150, 50))
    paper.tool('slide')
    paper.press(paper.at(100, 20))
    scene = paper.drawn('d1')
    dyad, = scene.linkage.dyads
    assert dyad.kind == 'RRP' and dyad.direction_2 == 0.0 and dyad.mode == 2
    paper.tool('spring')
    paper.drag(paper.place('d1_inner'), paper.at(250, 0))
    paper.until(lambda: 's1' in paper.state['scene'].get('springs', {}), 'a spring')
    scene = paper.in_python()
    spring, = scene.linkage.elements
    assert spring.stiffness == 1000.0 and spring.second.link == 'ground'
    assert spring.first.link == 'l1' and spring.first.along == dyad.length_1
    paper.tool('weight')
    paper.until(lambda: paper.state['scene'].get('gravity', {}).get('y') == -9.80665, 'weight')
    assert paper.in_python().linkage.gravity == (0.0, -9.80665)


def test_a_guide_is_turned_by_a_drag(paper):
    paper.begin()
    paper.press(paper.at(-100, -100), paper.at(-70, -50))
    paper.tool('slide')
    paper.drag(paper.at(0, 100), paper.at(2, 160))
    dyad, = paper.drawn('d1').linkage.dyads
    assert dyad.direction_2 == pytest.approx(1.5707963267948966, abs=1e-11)


def test_a_six_bar_of_watt_is_three_clicks_more(paper):
    """The second dyad hangs on two moving links that a pin joins: its mode is that of a branch."""
    paper.four_bar()
    paper.press(paper.between('d1_first', 'd1_inner', 0.4), paper.at(-60, 180),
                paper.between('d1_inner', 'd1_second', 0.6))
    scene = paper.drawn('d1', 'd2')
    one, two = scene.linkage.dyads
    assert {two.first.link, two.second.link} == {*one.links}
    assert scene.values['dyads.d2.first'] and scene.values['dyads.d2.second']   # by names
    # above both ends, as it was drawn
    assert paper.joint('d2_inner')[1] > max(paper.joint('d2_first')[1],
                                            paper.joint('d2_second')[1])
    paper.tool('rods')
    paper.press(paper.place('d2_inner'), paper.at(260, 200), paper.at(330, -40))
    scene = paper.drawn('d1', 'd2', 'd3')
    point = scene.values['dyads.d3.first']
    assert scene.values[f'linkage.points.{point}.distance_2'] == 0.0    # the pin stands once


def differing(one, two):
    """Return the values that differ of two scenes: both NaN are the same."""
    return {name: (one.get(name), two.get(name)) for name in {*one, *two}
            if one.get(name) != two.get(name) and one.get(name) == one.get(name)}


def assert_as_shown(paper, file, capsys):
    """Hold ranges, extrema of the drive and the largest pin force against ``fourbar show``."""
    capsys.readouterr()
    assert main(['show', str(file), '--json']) == 0
    shown = json.loads(capsys.readouterr().out)
    ranges = pytest.approx([0.0, tau] if shown['input']['turns_fully'] else
                           shown['input']['ranges'][-1], abs=1e-9)
    paper.until(lambda: paper.script('return page.engine.ranges')[-1] == ranges,
                'the ranges of the server')
    drive = paper.script('return page.structure().drive')
    known = [extremum['value'] for extremum in shown['extrema'] if extremum['quantity'] == drive
             and extremum['value'] not in ('inf', '-inf')]
    paper.open('Extrema')
    paper.until(lambda: 'fourbar show' in paper.proof(), 'the extrema')
    assert sorted(paper.digits(drive)) == pytest.approx(sorted(known), rel=1e-9)
    return shown


def assert_is_in_its_file(paper, wanted, download, capsys):
    """Hold what is drawn, and the file of it, against the values of a scene; return the file."""
    assert not differing(paper.in_python().values, wanted)
    file = download(paper, 'scene (YAML)', 'yaml', 'drawing')
    assert not differing(load(file).values, wanted)
    assert main(['scene', 'check', str(file)]) == 0
    assert_as_shown(paper, file, capsys)
    return file


def test_a_slider_crank_driven_at_its_slide_is_drawn_from_nothing(paper, download, capsys):
    paper.begin()
    paper.tool('slide')
    paper.press(paper.at(-200, -60))        # the block that drives, on a level guide
    paper.tool('rods')
    paper.press(paper.at(40, 30), paper.at(90, -40))
    scene = paper.drawn('d1')
    dyad, = scene.linkage.dyads
    assert scene.linkage.input == 'slide' and dyad.kind == 'RRR' and dyad.first == (
        'slider', 0.0, 0.0)
    scale = hypot(240, 90) / dyad.length_1
    assert dyad.second.along * scale == pytest.approx(290, abs=2 * CLICK)
    assert dyad.second.across * scale == pytest.approx(20, abs=2 * CLICK)
    assert paper.state['view']['at'] == 0.0
    before = scene.values
    paper.tool('shape')
    x, y = paper.place('base')
    paper.drag((x, y), (x + 10, y + 30), (x + 25, y + 60))      # it stays on its guide
    scene = paper.in_python()
    metre = paper.script('return page.picture.scale')
    assert paper.state['view']['at'] * metre == pytest.approx(25, abs=2 * CLICK)
    assert scene.linkage.dyads[0].first == ('slider', 0.0, 0.0)
    assert scene.linkage.dyads[0].length_1 < dyad.length_1
    paper.click('undo')
    assert_is_in_its_file(paper, before, download, capsys)


def test_a_boom_and_bucket_driven_by_a_cylinder_are_drawn_from_nothing(paper, download, capsys):
    paper.begin()
    paper.tool('cylinder')
    paper.press(paper.at(0, 0), paper.at(60, 140), paper.at(-220, 20))
    scene = paper.drawn()                   # a boom alone is a machine
    assert scene.linkage.input == 'cylinder' and not scene.linkage.dyads
    base, pin, mode = (getattr(scene.linkage.cylinder, name) for name in ('base', 'pin', 'mode'))
    scale = hypot(60, 140) / pin.along
    assert pin.across == 0.0 and mode == 1
    assert (base.along * scale, base.across * scale) == (
        pytest.approx(-220, abs=2 * CLICK), pytest.approx(20, abs=2 * CLICK))
    assert paper.state['view']['at'] == pytest.approx(hypot(
        pin.along * 60 / hypot(60, 140) - base.along,
        pin.along * 140 / hypot(60, 140) - base.across), abs=2 * CLICK / scale)
    paper.tool('rods')
    (x, y), (u, v) = paper.place('base'), paper.place('cylinder_first')
    paper.press((u, v), (x + 170, y - 120), (x + 100, y))
    scene = paper.drawn('d1')
    assert scene.linkage.dyads[0].first == pin
    symbols = [*paper.script('return Object.values(page.structure().sketch.symbols)')]
    assert len(symbols) == len({*symbols}) and 'A' in scene.values['dyads.d1.first']
    before, stays = scene.values, paper.joint('d1_inner')
    paper.tool('shape')
    x, y = paper.place('cylinder_second')
    paper.drag((x, y), (x - 10, y + 30), (x - 20, y + 60))
    scene = paper.in_python()
    metre = paper.script('return page.picture.scale')
    assert (scene.linkage.cylinder.base.across - base.across) * metre == pytest.approx(
        -60, abs=2 * CLICK)
    moved = paper.joint('d1_inner')
    assert hypot(moved[0] - stays[0], moved[1] - stays[1]) * metre < CLICK
    x, y = paper.place('cylinder_first')    # of the crank, the cylinder and the dyad
    paper.drag((x, y), (x + 10, y + 6), (x + 20, y + 12))
    scene = paper.in_python()
    assert scene.linkage.dyads[0].first == scene.linkage.cylinder.pin != pin
    paper.click('undo')
    paper.click('undo')
    file = assert_is_in_its_file(paper, before, download, capsys)
    paper.tool('delete')
    paper.press(paper.between('d1_first', 'd1_inner'))
    assert paper.drawn().linkage.cylinder == load(file).linkage.cylinder


def test_a_lecturer_finds_the_largest_pin_force_of_a_six_bar_and_takes_a_picture(
        driver, download, capsys):
    """From an empty page to the picture: 14 clicks."""
    with live() as address:
        paper = Paper(driver, address)
        paper.press(paper.at(-100, -80), paper.at(-60, 0), paper.at(140, 110), paper.at(150, -80))
        paper.drawn('d1')
        paper.press(paper.place('d1_inner'), paper.at(260, 200), paper.at(330, -40))
        paper.drawn('d1', 'd2')
        paper.open('Extrema')
        paper.until(lambda: 'fourbar show' in paper.proof(), 'the proof')
        largest = paper.rows('Extrema')[0]
        assert largest[1] == 'max\nlargest force of all joints'
        paper.driver.find_element('css selector', '#view-Extrema .go').click()
        shown = float(largest[2].removesuffix(' N'))
        paper.until(lambda: abs(max(paper.script(
            'return Object.keys(page.structure().sketch.forces).map(name => '
            'page.engine.get(name))')) - shown) < 1e-4 * shown, 'the pose with this force')
        picture = Image.open(download(paper, 'picture (PNG)', 'png', 'drawing'))
        assert picture.width >= 1500
        file = download(paper, 'scene (YAML)', 'yaml', 'drawing')
        worst = assert_as_shown(paper, file, capsys)['drive']['worst_pin']
    assert shown == pytest.approx(worst['force'], rel=1e-4)


def test_what_is_dragged_moves_and_undo_takes_it_back(paper):
    paper.four_bar()
    (x, y), (u, v) = paper.place('d1_inner'), paper.place('d1_second')
    paper.press(paper.between('d1_first', 'd1_inner'), (x - 200, y - 30), (u + 120, v - 60))
    before = paper.drawn('d1', 'd2')
    assert before.linkage.dyads[1].second.link == 'ground'
    paper.tool('shape')
    joints, scale = ('d1_inner', 'd2_inner', 'd2_second', 'd1_first'), paper.script(
        'return page.picture.scale')
    stays, (u, v) = [paper.joint(name) for name in joints], paper.joint('d1_second')
    x, y = paper.place('d1_second')
    paper.drag((x, y), (x + 10, y - 4), (x + 30, y - 12))
    after = paper.in_python()
    assert after.linkage.dyads[0].second != before.linkage.dyads[0].second
    for name, place in zip(joints, stays):
        now = paper.joint(name)         # rods have lengths of three digits
        assert hypot(now[0] - place[0], now[1] - place[1]) < 1e-2 * paper.script(
            'return page.engine.size'), name
    x, y = paper.joint('d1_second')
    assert hypot(x - u - 30 / scale, y - v - 12 / scale) < 2 * CLICK / scale
    paper.click('undo')                 # a drag is one step
    assert paper.in_python().values == before.values
    paper.click('redo')
    assert paper.in_python().values == after.values


def test_shift_keeps_a_length_and_a_typed_one_takes_units(paper):
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys
    kept = paper.four_bar().linkage.dyads[0].length_1
    paper.tool('shape')
    x, y = paper.place('d1_inner')
    ActionChains(paper.driver).key_down(Keys.SHIFT).perform()
    paper.drag((x, y), (x + 20, y + 20), (x + 40, y + 30))
    ActionChains(paper.driver).key_up(Keys.SHIFT).perform()
    dyad = paper.in_python().linkage.dyads[0]
    assert dyad.length_1 == pytest.approx(kept, rel=1e-9) and dyad.length_2 != kept
    paper.press(paper.script(
        'const b = document.querySelector(\'[data-length="dyads.d1.length_2"]\')'
        '.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]'))
    paper.keys('180 mm', Keys.ENTER)
    paper.until(lambda: paper.state['scene']['dyads']['d1']['length_2'] == 0.18, 'the length')
    assert paper.in_python().linkage.dyads[0].length_2 == 0.18


def test_a_bare_number_has_the_unit_that_is_shown_and_a_refusal_names_what_was_typed(paper):
    from selenium.webdriver.common.keys import Keys
    crank = 'linkage.points.A.along'
    paper.four_bar()
    paper.tool('shape')

    def write(typed):
        paper.press(paper.script(
            'const b = document.querySelector(`[data-length="${arguments[0]}"]`)'
            '.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]', crank))
        paper.keys(typed, Keys.ENTER)
        return paper.state['scene']['linkage']['points']['A']['along']
    assert write('41') == 0.041 and paper.in_python().values[crank] == 0.041
    paper.until(lambda: paper.is_answered(crank, 0.041), 'the answer')      # which clears an alarm
    assert write('45 kg') == 0.041
    paper.until(lambda: f"{crank} = '45 kg': must be a number in m" in paper.alarm(), 'the unit')
    paper.keys(Keys.ESCAPE)
    assert write('45 m') == 45.0
    paper.until(lambda: f'{crank} = 45 m: dyads.d1: cannot close' in paper.alarm(), 'the name')
    paper.until(lambda: paper.script(
        "return document.querySelectorAll('#curves.stale, #panel .stale').length") == 3, 'pale')
    paper.open('Numbers')
    paper.write('dyads.d1.length_1', '30')
    paper.until(lambda: 'dyads.d1.length_1 = 30 m: ' in paper.alarm(), 'the newest name')
    paper.click('undo')
    paper.click('undo')
    paper.in_python()
    assert not paper.script("return document.querySelectorAll('.stale').length")


def test_the_input_of_a_slide_is_typed_in_metres(paper):
    paper.begin()
    paper.tool('slide')
    paper.press(paper.at(-200, -60))
    paper.tool('rods')
    paper.press(paper.at(40, 30), paper.at(90, -40))
    paper.drawn('d1')
    paper.open('Numbers')
    at = paper.state['view']['at']
    paper.write('input value', f'{at + 0.002:.6f}')
    assert paper.state['view']['at'] == pytest.approx(at + 0.002, abs=1e-6)
    paper.write('input value', f'{1000.0 * at:.3f} mm')
    assert paper.state['view']['at'] == pytest.approx(at, abs=1e-6) and not paper.wrong()


def test_every_moving_link_has_a_mass_and_the_guide_is_told_from_the_pins(paper):
    paper.begin()
    paper.press(paper.at(-200, 0), paper.at(-150, 50))
    paper.tool('slide')
    paper.press(paper.at(100, 20))
    paper.drawn('d1')
    paper.tool('weight')
    paper.until(lambda: 'bodies.l2.mass' in paper.text_of('warnings'), 'the block has no mass')
    paper.open('Numbers')
    paper.script("document.querySelectorAll('#panel details').forEach(e => { e.open = true; })")
    assert paper.text('bodies.l2.mass') == '' and paper.text('bodies.l1.mass') == ''
    paper.write('bodies.l2.mass', '500 g')
    paper.until(lambda: not paper.text_of('warnings'), 'no warning')
    assert paper.in_python().linkage.bodies.l2.mass == 0.5
    paper.write('bodies.l1.mass', '0.2')
    paper.until(lambda: 'bodies.l1.inertia' in paper.alarm(), 'a rod of its own mass needs both')
    paper.write('bodies.l1.inertia', '0.0004')
    paper.until(lambda: not paper.alarm(), 'fields without those of rods')
    assert paper.script("return document.activeElement.getAttribute('aria-label')"
                        ) == 'bodies.l1.inertia'
    paper.write('bodies.l1.cg_along', '50 mm')
    paper.until(lambda: paper.in_python().linkage.bodies.l1.cg_along == 0.05, 'the centre')
    body = paper.in_python().linkage.bodies.l1
    assert (body.mass, body.inertia, body.cg_along) == (0.2, 0.0004, 0.05)
    extrema = find_extrema(paper.in_python().linkage, ['d1_second', 'base', 'd1_first',
                                                       'd1_inner'], 10.0)
    paper.open('Extrema')
    largest = {name: max(one.value for one in extrema if one.quantity == name)
               for name in ('d1_second', 'base', 'd1_first', 'd1_inner')}
    guide = largest.pop('d1_second')
    assert guide > max(largest.values())
    paper.until(lambda: [row[1] for row in paper.rows('Extrema')[:2]] == [
        'max\nlargest force of all joints: guide B2', 'max\nlargest force of all pins'], 'both')
    paper.until(lambda: [float(row[2].removesuffix(' N')) for row in paper.rows('Extrema')[:2]]
                == pytest.approx([guide, max(largest.values())], rel=1e-4), 'their values')


def test_a_click_without_a_drag_moves_nothing(paper):
    paper.four_bar()
    paper.tool('pose')
    before, (x, y) = paper.state['view']['at'], paper.place('d1_inner')
    paper.press((x + 6, y + 5))
    assert paper.state['view']['at'] == before
    paper.drag((x, y), (x + 20, y + 10))
    assert paper.state['view']['at'] != before


def test_a_click_at_the_pale_pose_flips_and_an_address_shows_the_same(paper):
    paper.four_bar()
    paper.tool('flip')
    x, y, width = paper.script('const b = document.querySelector("[data-mirror=d1]")'
                               '.getBoundingClientRect(); return [b.x, b.y, b.width]')
    paper.press((x + width / 2, y + width / 2))
    paper.until(lambda: paper.state['scene']['dyads']['d1']['mode'] == 1, 'the other mode')
    scene = paper.in_python()
    assert scene.linkage.dyads[0].mode == 1
    paper.until(lambda: paper.address().get('dyads.d1.mode') == '1', 'the address')
    state, other = paper.state, Paper(paper.driver, paper.driver.current_url)
    assert other.drawn('d1').linkage == scene.linkage
    assert other.state['scene'] == state['scene'] and not other.alarm()


def test_points_forces_and_the_drive_are_chosen_and_deleted(paper):
    paper.four_bar()
    paper.tool('point')
    paper.drag(paper.between('d1_first', 'd1_inner'), paper.at(-40, 150))
    paper.until(lambda: 'P1' in paper.state['scene'].get('points', {}), 'a point')
    paper.tool('force')
    x, y = paper.place('d1_inner')
    paper.drag((x, y), (x + 30, y + 10), (x + 60, y + 60))
    paper.until(lambda: 'l2' in paper.state['scene'].get('external', {}), 'a force')
    before = paper.in_python()
    force = before.linkage.external.l2
    assert force.force_x > 0.0 > force.force_y and force.along == (
        before.linkage.dyads[0].length_2)
    # a couple alone was lost with the change of the drive
    paper.script("page.store.dispatch({ set: { 'external.l1': { couple: 3 } } })")
    paper.tool('drive')
    paper.press(paper.between('d1_inner', 'd1_second'))
    paper.until(lambda: 'crank' in paper.state['scene'].get('external', {}), 'another drive')
    after = paper.drawn('d1')
    old, new = before.linkage.dyads[0], after.linkage.dyads[0]
    assert {new.length_1, new.length_2} == {old.length_1, old.first.along}
    assert new.second.along == old.length_2 or new.first.along == old.length_2
    assert after.points['P1'].link == before.points['P1'].link
    assert after.linkage.external.l1.couple == 3.0
    assert after.linkage.external.crank.force_x == force.force_x
    paper.tool('delete')
    paper.press(paper.between('d1_first', 'd1_inner'))
    paper.until(lambda: paper.state['scene'] == {}, 'an empty page')
    paper.click('undo')
    assert paper.drawn('d1').linkage == after.linkage
    # a spring between ground and crank would be one of another link
    paper.script("page.store.dispatch({ set: { 'torsion_springs.s': "
                 "{ first: 'ground', second: 'crank', stiffness: 1, free_angle: 0 } } })")
    paper.tool('drive')
    paper.press(paper.between('d1_inner', 'd1_second'))
    paper.until(lambda: 'choose the drive in the file' in paper.alarm(), 'the refusal')


def test_a_shipped_scene_is_drawn_on(paper):
    """A four-bar becomes a machine in the same frame; a dyad on its coupler follows."""
    paper.script("page.store.dispatch({ set: { joint_names: ['p', 'q', 'r', 's'] } })")
    before = scene_of(paper.state['scene'])
    paper.tool('rods')
    paper.until(lambda: paper.state['scene']['linkage'].get('kind') == 'machine', 'a machine')
    four_bar = paper.drawn('d1')
    x = paper.script('return page.engine.x')
    if before.kind == 'four_bar':
        expected = before.linkage.motion(x)
        assert four_bar.linkage.motion(x).theta_output == pytest.approx(expected.theta4, abs=1e-12)
    joints = 'd1_first', 'd1_inner'
    (u, v), (_, top) = paper.between(*joints), paper.at(0, 240)
    paper.press((u, v), (u + 20, top), (u + 200, v + 20))
    drawn = paper.drawn('d1', 'd2')             # four names would not do for seven joints
    assert len(drawn.linkage.dyads) == 2 and len(set(drawn.joint_names) - {*'pqrs'}) == 7


@pytest.mark.parametrize(('clicks', 'words'), [
    ([(-380, 230)], 'Begin on a joint or on a link'),
    (['d1_inner', 'd1_first'], 'is free: click beside'),
    ([('d1_first', 'd1_inner', 0.3), (-380, 230), ('d1_first', 'd1_inner', 0.7)],
     'it would be one rigid body')])
def test_what_cannot_be_is_said(paper, clicks, words):
    paper.four_bar()
    paper.press(*[paper.place(where) if isinstance(where, str) else
                  paper.between(*where) if isinstance(where[0], str) else paper.at(*where)
                  for where in clicks])
    paper.until(lambda: words in paper.alarm(), words)
    assert paper.state['scene']['linkage']['dyads'] == ['d1']


def test_the_pictures_of_a_phone_can_be_drawn_on(tmp_path_factory, address):
    with browser(tmp_path_factory.mktemp('phone'), 400, 800) as driver:
        paper = Paper(driver, address)
        paper.begin()
        paper.press(paper.at(-90, -60), paper.at(-60, -20), paper.at(60, 60), paper.at(80, -60))
        assert len(paper.drawn('d1').linkage.dyads) == 1


def test_a_pivot_of_jansens_leg_takes_both_of_its_dyads_along(driver):
    with live('jansen') as address:
        paper = Paper(driver, address)
        before = scene_of(paper.state['scene']).linkage
        paper.tool('shape')
        x, y = paper.place('upper_second')
        paper.drag((x, y), (x + 6, y - 4), (x + 12, y - 8))
        after = paper.in_python().linkage
    upper, lower, leg = after.dyads
    assert upper.second == lower.second != before.dyads[0].second
    assert leg.second == ('c', lower.length_2, 0.0)     # the knee stands once
    assert upper.length_2 != before.dyads[0].length_2
    assert upper.length_1 == before.dyads[0].length_1


def test_a_telescope_hangs_on_a_pin_and_the_ground(paper):
    paper.four_bar()
    paper.tool('cylinder')
    x, y = paper.place('d1_inner')
    paper.press((x, y), (x + 60, y + 190))
    one, two = paper.drawn('d1', 'd2').linkage.dyads
    assert two.kind == 'RPR' and two.second.link == 'ground'
    assert two.first == ('l2', one.length_2, 0.0)


def test_a_drawn_page_without_a_server_is_that_of_its_last_numbers(paper, download):
    """It had the formulas of the scene that the page began with, here of the paper."""
    paper.four_bar()
    paper.write('dyads.d1.length_2', '0.21')
    paper.until(lambda: paper.is_answered('dyads.d1.length_2', 0.21), 'the answer')
    caption = "return document.querySelector('#view-Facts .proof').textContent"
    for length in (0.21, 0.23):
        path = download(paper, 'page without a server (HTML)', 'html', 'drawing')
        paper = Paper(paper.driver, path.rename(path.with_stem(f'{length}')).as_uri())
        scene = paper.in_python()
        assert scene.linkage.dyads[0].length_2 == length
        assert not paper.script("return 'save in its file' in page.files")
        assert bool(paper.script(caption)) == (length != 0.21)      # facts of the one before
        assert bool(paper.text_of('about')) == (length == 0.21)
        paper.write('dyads.d1.length_2', '0.23')
        paper.until(lambda: paper.script(caption), 'the caption')


def test_an_empty_page_is_drawn_on_and_keeps_nothing_of_another_scene(driver):
    with live() as address:
        paper = Paper(driver, address)
        assert paper.state['scene'] == {} and paper.text_of('title') == 'drawing'
        paper.press(paper.at(-100, -80), paper.at(-60, 0), paper.at(140, 110), paper.at(150, -80))
        paper.drawn('d1')
        assert paper.script('return page.structure().sketch.points') == {}
        letters = paper.script('return page.structure().sketch.letters')
        points = paper.state['scene']['dyads']['d1']
        assert (letters['d1_first'], letters['d1_second']) == (points['first'], points['second'])
        paper.until(lambda: paper.address().get('from') == 'nothing', 'the address')


def test_after_new_nothing_of_the_scene_before_is_shown(paper, file):
    assert paper.text_of('title') == file.stem
    paper.begin()
    assert paper.text_of('title') == 'drawing' and 'drawing' in paper.driver.title
    assert not paper.script("return document.querySelector('.field, .curve, #panel td')")
    paper.click('undo')
    paper.until(lambda: paper.text_of('title') == file.stem, 'the scene before')


def test_what_a_tool_shows_follows_a_picture_that_is_fitted_again(paper):
    """The pale pin is where a click hits it, after each flip, which fits the picture again."""
    paper.four_bar()
    paper.tool('flip')
    pale = ('const b = document.querySelector("[data-mirror=d1]").getBoundingClientRect();'
            'return [b.x + b.width / 2, b.y + b.height / 2]')
    for mode in (1, 2, 1):
        paper.press(paper.script(pale))
        paper.until(lambda: paper.state['scene']['dyads']['d1']['mode'] == mode, 'the mode')
        paper.in_python()
    paper.script('page.picture.view.scale *= 1.6; page.store.dispatch({ view: { layers: {} } })')
    paper.press(paper.script(pale))         # where the pale pose had no room it gets it
    paper.until(lambda: paper.state['scene']['dyads']['d1']['mode'] == 2, 'the mode')
    paper.in_python()
    paper.tool('shape')

    def is_beside_its_link():
        (x, y), (u, v) = (paper.place(name) for name in ('d1_inner', 'd1_second'))
        x_text, y_text = paper.script(
            'const t = document.querySelector(\'[data-length="dyads.d1.length_2"]\'), b = '
            'page.picture.svg.getBoundingClientRect(); return [b.x + t.x.baseVal[0].value, '
            'b.y + t.y.baseVal[0].value]')
        return hypot(x_text - (x + u) / 2, y_text - (y + v) / 2) < BESIDE
    paper.until(is_beside_its_link, 'the label of a length beside its link')


def test_a_dyad_that_ends_a_full_turn_is_named(paper):
    paper.four_bar()
    (x, y), (u, v) = paper.place('d1_inner'), paper.place('d1_second')
    assert paper.text_of('warnings') == ''
    paper.press(paper.between('d1_first', 'd1_inner'), (x - 150, y - 30), (u + 120, v - 40))
    paper.drawn('d1', 'd2')
    paper.until(lambda: 'd2 cannot close beyond' in paper.text_of('warnings'), 'the range')
