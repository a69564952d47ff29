# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Files that the page sends, as the browser has written them."""
import csv
import io
import time
from xml.etree import ElementTree

from fourbar_lab.live.svg import WIDTH
from fourbar_ros.scene.scene import load
import numpy as np
from PIL import Image
import pytest
import resvg_py
from support.browser import needs_browser, PATIENCE, Tab

pytestmark = [needs_browser, pytest.mark.slow]
SVG = '{http://www.w3.org/2000/svg}'


@pytest.fixture(scope='module')
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp('downloads')


@pytest.fixture(scope='module')
def tab(driver, address, folder):
    driver.execute_cdp_cmd('Browser.setDownloadBehavior', {
        'behavior': 'allow', 'downloadPath': str(folder)})
    return Tab(driver, f'{address}/?linkage.a2=1.1&at=60')


@pytest.fixture
def download(tab, folder):
    """Return a function: words of the menu and a suffix -> the file that was downloaded."""
    def download(words, suffix):
        tab.click('download')
        tab.choose(words)
        file, end = folder / f'paper.{suffix}', time.monotonic() + 5.0 * PATIENCE
        while not file.exists():        # Chromium renames what is complete
            assert time.monotonic() < end, f'no {file.name} among {list(folder.iterdir())}'
            time.sleep(0.1)
        return file
    return download


def test_the_scene_file_loads_again(download):
    scene = load(download('scene file', 'yaml'))
    assert scene.linkage.a2 == 1.1 and scene.linkage.bodies and scene.drive.speed == 25.0


def test_the_svg_is_the_picture(download, tab):
    root = ElementTree.parse(download('picture (SVG)', 'svg')).getroot()
    pins = [(float(pin.get('cx')), float(pin.get('cy'))) for pin in root.iter(f'{SVG}circle')
            if pin.get('class') == 'pin']
    assert pins == tab.pins()


def colours(png):
    """Return (width, number of colours, whether white is the most frequent one) of a picture."""
    picture = Image.open(io.BytesIO(png)).convert('RGB')
    found = picture.getcolors(2 ** 24)
    return picture.width, len(found), max(found)[1] == (255, 255, 255)


def test_a_program_that_is_no_browser_shows_the_svg_in_its_colours(download):
    file = download('picture (SVG)', 'svg')
    assert 'var(' not in file.read_text()
    width, count, is_on_white = colours(resvg_py.svg_to_bytes(svg_path=str(file)))
    assert width == WIDTH and count > 50 and is_on_white


def test_the_png_is_the_picture_three_times_as_large(download):
    width, count, is_on_white = colours(download('picture (PNG)', 'png').read_bytes())
    assert width == 3 * WIDTH and count > 50 and is_on_white


def test_the_csv_has_the_core_s_numbers(download):
    from fourbar_ros import FourBar
    with download('numbers of a cycle', 'csv').open() as file:
        rows = list(csv.DictReader(file))
    columns = {name.partition(' [')[0]: np.array([float(row[name]) for row in rows])
               for name in rows[0]}
    motion = FourBar(0.4, 1.1, 0.8, 1.0).motion(np.radians(columns['theta1']), 25.0)
    assert len(rows) == 361 and np.isfinite(columns['driving_torque']).all()
    np.testing.assert_allclose(columns['theta4'], np.degrees(motion.theta4), rtol=1e-12)
    for name in ('omega4', 'alpha4'):
        np.testing.assert_allclose(columns[name], getattr(motion, name), rtol=1e-9, atol=1e-9)


def test_the_html_moves_without_a_server(download, tab):
    page, home = download('page that needs no server', 'html'), tab.driver.current_window_handle
    assert 'var(' not in page.read_text()
    assert 'http://' not in page.read_text().replace('http://www.w3.org', '')
    tab.driver.switch_to.new_window('tab')
    try:
        tab.driver.get(page.as_uri())
        drawing = "return document.getElementById('mechanism').innerHTML"
        before = tab.driver.execute_script(drawing)
        assert 'class="pin"' in before
        tab.until(lambda: tab.driver.execute_script(drawing) != before, 'motion')
    finally:
        tab.driver.close()
        tab.driver.switch_to.window(home)


def test_nothing_is_saved_of_what_is_impossible(tab, folder):
    tab.write('linkage.a2', '9')
    tab.until(tab.alarm, 'the reason')
    before = set(folder.iterdir())
    tab.click('download')
    tab.choose('scene file')
    tab.until(lambda: 'nothing to save' in tab.driver.find_element('tag name', 'body').text,
              'why not')
    assert set(folder.iterdir()) == before
