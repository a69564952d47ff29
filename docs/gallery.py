# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Write gallery.md and its pictures: ``python docs/gallery.py``.

Every shipped scene with a picture and a sentence. A test checks that nothing is out of date; a
picture holds the digest of the scene that it shows.
"""
from hashlib import sha256
from math import radians
from pathlib import Path
import re
import sys

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from fourbar_lab.cli.list import about  # noqa: E402
from fourbar_lab.drawing import cycles  # noqa: E402
from fourbar_ros.scene.files import find  # noqa: E402, I100
from fourbar_ros.scene.scene import load  # noqa: E402

PAGE, PICTURES = ROOT / 'docs' / 'gallery.md', ROOT / 'docs' / 'gallery'
SIZE = 4.4, 3.3      # [inch]
SAMPLES = 241        # of a path
LONG = re.compile(r'(?<![(.\d])\d+\.\d{3,}|(?<=translate\()\d+\.\d{3,}')     # not of a scale
# {heading: {scene: (title, input of the picture [degrees] or [m])}}
ENTRIES = {
    'Straight lines': {
        'watt_line': ("Watt's line", -15), 'chebyshev': ("Chebyshev's line", 60),
        'hoeken': ("Hoeken's line", 120), 'roberts': ("Roberts' line", 70),
        'evans': ("Evans' grasshopper", -30), 'scott_russell': ('Scott-Russell', 35),
        'peaucellier': ('Peaucellier', 40), 'hart': ("Hart's inversor", 40)},
    'Parallelograms and lifts': {
        'parallelogram': ('Parallelogram', 60), 'antiparallelogram': ('Antiparallelogram', 70),
        'coupling_rod': ('Coupling rods of a locomotive', 60),
        'scissor_lift': ('Scissor lift', 0.7), 'lift_table': ('Lift table', 0.6)},
    'Presses, grippers, doors, wipers': {
        'press': ('Crank press', 320), 'toggle_press': ('Toggle press', 40),
        'gripper': ('Gripper of the Robotiq type', -0.055),
        'door_closer': ('Door closer', 50), 'wiper': ('Windscreen wiper', 40),
        'quick_return': ("Whitworth's quick return", 50), 'scotch_yoke': ('Scotch yoke', 50)},
    'Pumps and diggers': {
        'pumpjack': ('Pumpjack', 40), 'cylinder': ('Boom with a cylinder', 1.4),
        'bucket': ("Excavator's bucket", 1.7)},
    'Walking legs': {'jansen': ("Jansen's leg", 60), 'klann': ("Klann's leg", 60)},
    'Engines': {
        'slider_crank': ('Slider-crank', 50), 'engine': ('Four-stroke engine', 50),
        'v_engine': ('V engine', 70), 'v8': ('V8', 20), 'radial_engine': ('Radial engine', 40)},
    'Six-bars and more': {
        'watt': ("Watt's six-bar", 60), 'stephenson': ("Stephenson's six-bar", 60),
        'andrews': ("Andrews' squeezing mechanism", -4)},
    'Four-bars and problems of books': {
        'paper': ('Crank-rocker of Hayes, Hninn and Irani', 60), 'motor': ('With a motor', 100),
        'controlled': ('With a controller', 150), 'released': ('Let go', 330),
        'slides_7_6': ('Example 7.6', 60), 'slides_7_7': ('Example 7.7', 60),
        'sundials': ('Slider-crank of SUNDIALS', 90)},
}


def digest(name):
    """Return what names a picture's scene and pose."""
    pose = next(found[name] for found in ENTRIES.values() if name in found)
    return sha256(find(name).read_bytes() + repr((pose, SIZE)).encode()).hexdigest()[:16]


def entry(name, title):
    """Return the Markdown of a scene."""
    text, file = find(name).read_text(encoding='utf-8'), find(name).relative_to(ROOT).as_posix()
    return (f'### {title}\n\n[`{name}`](../{file}): {about(text)}.\n\n'
            f'![{title}](gallery/{name}.svg)\n')


def page():
    """Return the text of the page."""
    parts = [f'## {heading}\n\n'
             + '\n'.join(entry(name, title) for name, (title, _) in entries.items())
             for heading, entries in ENTRIES.items()]
    return ('# Gallery\n\n<!-- gallery -->\n'
            'Every scene that comes with the package: `fourbar list` names them, and each verb '
            'takes a name or a file (`fourbar show watt_line`). Brown curves are paths of points. '
            'To change one: `fourbar scene print watt_line -o my.yaml`.\n\n'
            'Each of them moves in the browser, without a server: in the site (`make docs`) a '
            'click on a picture opens its page; they are 10 MB and not in the repository. '
            '`fourbar live watt_line -o watt_line.html` writes one.\n\n'
            + '\n'.join(parts) + '<!-- end -->\n')


def draw(name, at):
    """Return the figure of a scene in a pose."""
    scene = load(name)
    linkage, points = scene.linkage, scene.points
    motion = linkage.motion(at if linkage.is_driven_by_slide else radians(at))
    paths = cycles.paths_of(linkage, points, SAMPLES) if points else ()
    return cycles.make_linkage_figure(linkage, motion, points, paths, size=SIZE)


def save(name, at):
    """Write the picture of a scene, with coordinates of a hundredth of a point."""
    path = PICTURES / f'{name}.svg'
    draw(name, at).savefig(path, metadata={'Date': None, 'Creator': None,
                                           'Identifier': digest(name)})
    text = path.read_text(encoding='utf-8')
    text = LONG.sub(lambda number: f'{float(number[0]):.2f}', text)
    path.write_text(re.sub(r'\s*\n\s*', '\n', text), encoding='utf-8')


def main():
    """Write the page and all pictures."""
    PICTURES.mkdir(exist_ok=True)
    for entries in ENTRIES.values():
        for name, (_, at) in entries.items():
            save(name, at)
    PAGE.write_text(page(), encoding='utf-8')


if __name__ == '__main__':
    main()
