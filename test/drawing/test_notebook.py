# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""At a prompt, in a notebook and on paper: texts, tables and figures of what a person asks for."""
import csv
import io
import pydoc
import re
import subprocess
import sys

from fourbar_lab.drawing import collineation_axis
from fourbar_lab.drawing.cycles import usual_input
from fourbar_lab.drawing.figure import COLOURS, CURVES, save
from fourbar_lab.studies import find_extrema_many
from fourbar_ros import (
    Bodies,
    Body,
    find_extrema,
    flat_bar,
    FourBar,
    InvalidParameter,
    load_scene,
    Loads,
    point_motion,
    round_rod,
    SliderCrank,
)
from fourbar_ros.bag.overview import info
from fourbar_ros.cli.main import main
from fourbar_ros.dynamics import Flywheel, simulate, TorqueTable
from fourbar_ros.errors import FourBarError
from fourbar_ros.extrema import OverInput
from fourbar_ros.machine import Machine
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.mechanisms.load_table import LOADS
from fourbar_ros.mechanisms.picture import diagram_of
from fourbar_ros.notebook import LONGEST
from fourbar_ros.scene.files import shipped
from fourbar_ros.transmission import trajectory, Transmission
import numpy as np
import pytest
from support import bags, ROOT
from support.scenes import PAPER, RODS

PAPER_SCENE = load_scene('paper')


@pytest.fixture
def run():
    pytest.importorskip('scipy')
    scene = load_scene('motor')
    return simulate(scene.dynamics.system(scene.linkage), 0.1, 1e-6)


def test_texts_are_short_and_tables_whole(run, tmp_path):
    bags.run(tmp_path, 'run', {**PAPER, **RODS}, [(0.01 * k, 25.0, 0.0) for k in range(1, 9)])
    shown = [run, info(tmp_path / 'run'), find_extrema(PAPER_SCENE.linkage, (), 25.0)]
    for name in shipped():
        scene = load_scene(name)
        low, high = scene.linkage.input_ranges[0]
        inputs = np.linspace(low, high, 7)[1:-1]
        shown += [scene, scene.linkage, scene.linkage.motion(inputs),
                  scene.linkage.motion(float(inputs[1]))]
        for text in (repr(scene), repr(scene.linkage)):
            assert all(len(line) <= 100 or ' ' not in line.strip() for line in text.splitlines())
        if scene.linkage.has_loads:
            shown += [scene.linkage.loads(inputs, 1.0)]
    long, linkage = np.linspace(0.0, 0.1, 500), PAPER_SCENE.linkage
    shown += [run.at(long), run.loads_at(long), point_motion(
        linkage, linkage.motion(long), 'coupler', 0.1), collineation_axis(
        linkage, linkage.motion(long)), trajectory(long), TorqueTable(long, long),
        find_extrema_many(0.4, np.linspace(1.1, 1.3, 50), 0.8, 1.0)['omega4']]
    for each in shown:
        text = repr(each)
        lines = text.splitlines()
        assert text and (len(text) <= LONGEST if len(lines) == 1 else len(lines) <= 10), text
    for each in shown[:20]:
        assert '<table>' in each._repr_html_()
    every = shown[2]
    assert every._repr_html_().count('<tr>') == len(every) + 1 and list(every) == every


def test_extrema_say_rates_mode_and_their_side_of_a_jump():
    linkage = load_scene('press').linkage
    every = find_extrema(linkage, 'driving_torque', 3.0, 2.0)
    sides = [{0: '', 1: 'from above', -1: 'from below'}[each.side] for each in every]
    assert repr(every).startswith('at 3 rad/s and 2 rad/s^2, mode 2:\n') and any(sides)
    html = every._repr_html_()
    assert html.startswith('<p>at 3 rad/s and 2 rad/s^2, mode 2</p>')
    assert [row[-2] for row in cells_of(html)[1:]] == sides
    assert repr(find_extrema(PAPER_SCENE.linkage, 'omega4')).startswith('at 1 rad/s, mode 2:')
    # at rest, or at any rate
    assert repr(find_extrema(linkage, ('holding_torque', 'slide'))).startswith('mode 2:')


def cells_of(html):
    """Return the rows of all tables of a text in HTML, as lists of texts."""
    return [re.findall(r'<t[dh][^>]*>([^<]*)</t[dh]>', row)
            for row in re.findall(r'<tr>(.*?)</tr>', html, re.S)]


def test_html_says_name_value_unit_and_meaning():
    pytest.importorskip('matplotlib')
    for name in ('paper', 'watt', 'press', 'cylinder', 'scotch_yoke'):
        linkage = load_scene(name).linkage
        motion, loads = linkage.step(0.3 + linkage.input_ranges[0][0], 1.0)
        for record in (motion, loads):
            head, *rows = cells_of(record._repr_html_())
            assert head == ['', 'value', 'unit', 'meaning']
            assert [row[0] for row in rows] == list(record._shown)
            assert all(len(meaning) > 5 and unit for _, _, unit, meaning in rows), rows
    rows = {row[0]: row[1:] for row in cells_of(PAPER_SCENE._repr_html_())}
    assert rows['scene'] == ['paper'] and rows['gravity.y'] == [
        '0', 'm/s^2', 'gravitational acceleration: y component']
    assert rows['linkage.a1'] == [
        '0.4', 'm', 'length of the crank O1-A (four_bar, slider_crank, inverted_slider, '
        'scotch_yoke)'] and 'class' in rows, rows


def test_a_linkage_alone_at_an_angle():
    """No arrow, and its joints where they are; also at a toggle and with paths, at that pose."""
    pytest.importorskip('matplotlib')
    scene = load_scene('motor')
    for figure in (scene.draw('1.2rad', over='linkage'), scene.draw('1.2rad', over='paths')):
        axes, = figure.axes
        joints = {line.get_xydata()[0].tobytes() for line in axes.lines
                  if len(line.get_xdata()) == 1}
        diagram = diagram_of(scene.linkage, scene.linkage.motion(1.2))
        assert {point.tobytes() for point in diagram.joints.values()} <= joints
        assert not any(getattr(text, 'arrow_patch', None) for text in axes.texts)
    toggle = load_scene('door_closer')
    low, _ = toggle.linkage.input_ranges[0]
    assert toggle.draw(f'{low}rad', over='linkage').axes


def test_a_linkage_says_what_is_in_doubt():
    """Millimetres given as metres, and a rod that is a point mass: where one looks, and once."""
    points = {'A': (0, 0), 'B': (20, 50), 'C': (180, 90), 'D': (200, 10)}
    rods = Bodies(Body(0.1), flat_bar(0.18, 7850.0, 0.02, 0.005), Body(0.3, cg_along=0.1))
    for linkage, said in ((FourBar(60, 180, 140, 200), 'lengths of up to 200 m: in mm?'),
                          (Machine.from_points(points, ['AB', 'BC', 'CD'], 'AD'), 'in mm?'),
                          (FourBar(0.06, 0.18, 0.14, 0.2, bodies=rods), '')):
        rows = cells_of(linkage._repr_html_())
        assert said in repr(linkage) and ('#' in repr(linkage)) is bool(said)
        assert [text for name, text in rows if name == 'in doubt'] == [linkage.doubt][:bool(said)]
        assert linkage.doubt.endswith(said)
    assert ['point mass' in text for name, text in rows
            if name in ('crank', 'coupler', 'output') and 'kg' in text] == [True, False, False]
    engine = SliderCrank(0.05, 0.15, bodies=Bodies(*rods[:2], Body(0.3)))
    assert 'CG at (0, 0) m' in dict(cells_of(engine._repr_html_()))['output']    # a piston
    assert eval(repr(FourBar(60, 180, 140, 200))) == FourBar(60, 180, 140, 200)


def test_what_is_computed_from_a_linkage_has_a_short_repr(run):
    """They showed an address, and a flywheel all of its 8192 numbers."""
    linkage = PAPER_SCENE.linkage
    for shown, said in (
            (OverInput(linkage, 'f41', 25.0), "quantity='f41', rate=25.0"),
            (run.system, 'position=0.0, rate=0.0'),
            (Flywheel(1.0, 2.0, 0.02, np.zeros(4096), np.ones(4096)), 'torque=2.0')):
        text = repr(shown)
        assert said in text and len(text) <= LONGEST and ' at 0x' not in text, text


def test_a_picture_fits_its_cell_and_says_mode_and_pose():
    pytest.importorskip('matplotlib')
    picture = PAPER_SCENE.draw(60)._repr_svg_()
    assert picture.startswith('<svg style="max-width: 100%; height: auto"')
    for mode, said in (1, '1 (crossed)'), (2, '2 (open)'):
        axes, = PAPER_SCENE.draw(60, over='linkage', mode=mode).axes
        assert axes.get_title(loc='left').endswith(f'theta1 60 deg, assembly mode {said}')
    rows = dict(row for row in cells_of(LINKAGE._repr_html_()) if len(row) == 2)
    name, degrees, unit = rows['drawn at'].split()
    assert (name, unit) == ('theta1', 'deg')
    assert usual_input(LINKAGE) == pytest.approx(np.radians(float(degrees)), abs=1e-6)


def test_a_repr_makes_the_same_linkage_again():
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, mode=1)
    assert eval(repr(linkage)) == linkage


def test_help_says_unit_and_meaning_of_each_load():
    text = pydoc.plain(pydoc.render_doc(Loads))
    for name in Loads._fields:
        entry = re.search(rf'^ \|  {name}\n \|      \[([^]]+)\] (.+)$', text, re.M)
        assert entry and entry[1] == LOADS[name].unit and len(entry[2]) > 8, name
    machine = load_scene('watt').linkage
    for kind in (*KINDS.values(), machine):
        for name in kind.LOADS._fields:
            unit = 'N m' if name.endswith(('torque', 'moment', 'couple')) else (
                'W' if name == 'driving_power' else 'N')
            assert getattr(kind.LOADS, name).__doc__.startswith(f'[{unit}] '), (kind, name)
    table = machine.loads(0.3, 25.0)._repr_html_()
    assert 'x of the force of crank on coupler, at one_first' in table
    assert f'{machine.loads(0.3, 25.0).one_first_x:.10g}' in table


VERBS = [(['draw', 'paper', '--at', '60'], lambda: PAPER_SCENE.draw(60)),
         (['draw', 'paper', '--at', '1.2rad', '--speed', '300rpm', '--title', 'T'],
          lambda: PAPER_SCENE.draw('1.2rad', speed='300rpm', title='T')),
         (['draw', 'paper', '--over', 'paths'], lambda: PAPER_SCENE.draw(over='paths')),
         (['draw', 'paper', '--over', 'axis'], lambda: PAPER_SCENE.draw(over='axis')),
         (['draw', 'paper', '--over', 'forces', '--mode', '1', '--width', '88mm'],
          lambda: PAPER_SCENE.draw(over='forces', mode=1, width='88mm')),
         (['plot', 'paper', 'f41', 'omega4', '--units', 'kN,rpm', '--title', ''],
          lambda: PAPER_SCENE.plot('f41', 'omega4', units='kN,rpm', title=''))]


@pytest.mark.parametrize('words, figure_of', VERBS, ids=lambda each: ' '.join(each)
                         if isinstance(each, list) else '')
def test_a_method_draws_what_its_verb_draws(words, figure_of, tmp_path):
    pytest.importorskip('matplotlib')
    files = tmp_path / 'verb.svg', tmp_path / 'method.svg'
    assert main([*words, '-o', str(files[0])]) == 0
    figure = figure_of()
    save(figure, files[1])
    assert files[0].read_text() == files[1].read_text()
    assert figure._repr_svg_().startswith('<svg')


def test_a_frame_is_the_table_of_its_verb(capsys):
    pytest.importorskip('pandas')
    for words, frame in (
            (['f41', 'theta4', '--samples', '9'], PAPER_SCENE.table('f41', 'theta4', samples=9)),
            (['--speeds', '1', '60rpm'], PAPER_SCENE.table(speeds=(1.0, '60rpm')))):
        assert main(['table', 'paper', *words, '-o', '-']) == 0
        head, *rows = csv.reader(io.StringIO(capsys.readouterr().out))
        assert list(frame.columns) == head
        assert frame.to_numpy().tolist() == [[float(cell) for cell in row] for row in rows]


@pytest.mark.parametrize('call, said', [
    (lambda: PAPER_SCENE.draw(), 'at: must be given'),
    (lambda: PAPER_SCENE.draw('5kg'), "at = '5kg': must be a number in deg, or with one of"),
    (lambda: PAPER_SCENE.draw('5mm'), "at = '5mm': must be a number in deg, or with one of"),
    (lambda: PAPER_SCENE.draw([60]), 'at = [60]: must be a finite number, not of type list'),
    (lambda: PAPER_SCENE.draw(True), 'at = True: must be a finite number, not of type bool'),
    (lambda: PAPER_SCENE.draw(60, acceleration={}), 'acceleration = {}: must be a finite number'),
    (lambda: PAPER_SCENE.draw(60, mode=[9]), 'mode = [9]: must be 1 or 2'),
    (lambda: PAPER_SCENE.draw(60, title=3), 'title = 3: must be a text'),
    (lambda: PAPER_SCENE.draw(60, width=[3]), 'width = [3]: must be a finite number'),
    (lambda: PAPER_SCENE.draw(over='all'), "over = 'all': must be 'linkage', 'paths', 'forces'"),
    (lambda: load_scene('motor').draw(over=3), "over = 3: must be 'linkage', 'paths', 'forces'"),
    (lambda: PAPER_SCENE.plot('f41', title=3), 'title = 3: must be a text'),
    (lambda: PAPER_SCENE.plot('f41', units='parsec'), 'units'),
    (lambda: PAPER_SCENE.plot('f41', units=[3]), "units = [3]: must be a text as 'mm,kN', or a"),
    (lambda: PAPER_SCENE.plot('f41', speed='1m'), 'speed'),
    (lambda: PAPER_SCENE.plot('f41', speed=b'3'), "speed = b'3': must be a finite number, not"),
    (lambda: PAPER_SCENE.table(speeds='12'), "speeds = '12': must be the lowest and the highest"),
    (lambda: PAPER_SCENE.table(speeds=(None, 1)), 'must be the lowest and the highest'),
    (lambda: PAPER_SCENE.table(speeds=(1, '5m/s')), "speeds = '5m/s': must be a number in rad/s"),
    (lambda: PAPER_SCENE.table('f41', speeds=(1, 2)), 'speeds: cannot be combined with quantit'),
    (lambda: load_scene(3), '3: must be a path, or the name of a scene'),
    (lambda: load_scene({'linkage.a1': 0.4}), "'linkage.a1': 0.4}: must be a path, or the name of "
     'a scene; fourbar_ros.scene.from_values makes one'),
    (lambda: PAPER_SCENE.table('f41', units='kg,W'), "units = 'kg,W': is of no column")])
def test_a_wrong_option_is_named(call, said):
    with pytest.raises(FourBarError) as refused:
        call()
    message = str(refused.value)
    assert said in message and '\n' not in message and '--' not in message


LINKAGE = PAPER_SCENE.linkage


@pytest.mark.parametrize('call', [
    lambda text: find_extrema(LINKAGE, 'f41', text), lambda text: LINKAGE.motion(text),
    lambda text: find_extrema(LINKAGE, 'f41', 1.0, text), lambda text: LINKAGE.step(1.0, text),
    lambda text: find_extrema(LINKAGE, 'f41', within=(text, 2.0)), lambda text: Body(text),
    lambda text: find_extrema(LINKAGE, 'f41', seconds=text), lambda text: FourBar(text, 3, 2, 3),
    lambda text: Transmission(LINKAGE, text), lambda text: round_rod(text, 7750.0, 0.01),
    lambda text: point_motion(LINKAGE, LINKAGE.motion(1.0), 'coupler', text),
    lambda text: simulate(load_scene('motor').dynamics.system(LINKAGE), text)])
def test_a_number_in_si_is_no_text_and_the_line_says_what_reads_one(call):
    with pytest.raises(InvalidParameter) as refused:
        call('300rpm')
    said = "not a text; fourbar_ros.scene.quantity('300rpm', unit) reads numbers with units"
    assert str(refused.value).endswith(said)


def test_without_the_package_a_line_says_what_to_install():
    pytest.importorskip('scipy')
    code = ('import sys\nsys.modules["matplotlib"] = sys.modules["pandas"] = None\n'
            'from fourbar_ros import load_scene\nfrom fourbar_ros.dynamics import simulate\n'
            'scene = load_scene("motor")\nprint(scene._repr_html_())\n'
            'run = simulate(scene.dynamics.system(scene.linkage), 0.1, 1e-4)\n'
            'for call in (lambda: scene.draw(60), lambda: scene.table("f41"), run.plot):\n'
            '    try:\n        call()\n    except Exception as error:\n        print(error)\n')
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True,
                          timeout=300, check=False)
    assert done.stdout.splitlines() == [
        'None', 'a drawing requires matplotlib: pip install matplotlib',
        'a frame requires pandas: pip install pandas',
        'a plot requires matplotlib: pip install matplotlib'], done


def size_of(file):
    """Return width and height of the page of a PDF [mm], and its text."""
    text = file.read_bytes().decode('latin-1')
    left, low, right, high = map(float, re.search(r'/MediaBox \[([^]]+)\]', text)[1].split())
    return 25.4 / 72.0 * (right - left), 25.4 / 72.0 * (high - low), text


@pytest.mark.parametrize('words', [['draw', 'stephenson', '--at', '60'],
                                   ['draw', 'klann', '--over', 'paths'],
                                   ['plot', 'paper', 'f41_x', 'f21_x', 'f32_x', 'f43_x', 'f41',
                                    'f21', 'f32', 'f43', 'omega4']])
def test_a_pdf_fits_its_column_and_embeds_fonts_of_type_42(words, tmp_path):
    pytest.importorskip('matplotlib')
    file = tmp_path / 'column.pdf'
    assert main([*words, '--width', '88mm', '-o', str(file)]) == 0
    width, height, text = size_of(file)
    assert width == pytest.approx(88.0, abs=1e-3) and 25.0 < height < 400.0
    assert '/Type3' not in text and '/FontFile2' in text and '/CIDFontType2' in text


def test_a_picture_too_narrow_for_its_texts_is_refused(tmp_path, capsys):
    pytest.importorskip('matplotlib')
    file = tmp_path / 'narrow.pdf'
    assert main(['draw', 'watt', '--at', '60', '--width', '30mm', '-o', str(file)]) == 1
    assert 'mm, and its width is 30 mm' in capsys.readouterr().err and not file.exists()


def test_eight_curves_differ_without_colour():
    """Dashes, or a lightness that differs by a quarter of the way from black to white."""
    shares = np.array([[int(colour[i:i + 2], 16) for i in (1, 3, 5)] for colour in COLOURS])
    lightness = shares @ [0.299, 0.587, 0.114] / 255.0
    for i in range(8):
        for k in range(i):
            assert (CURVES['linestyle'][i] != CURVES['linestyle'][k]
                    or abs(lightness[i] - lightness[k]) > 0.25), (i, k)
    assert lightness.max() < 0.65           # on white paper


def test_curves_are_labelled_at_their_ends_in_their_order():
    pytest.importorskip('matplotlib')
    figure = PAPER_SCENE.plot('f41', 'f21', 'f32', 'f43')
    axis, = figure.axes
    labels = sorted(axis.texts, key=lambda text: text.xyann[1])
    assert [label.xy[1] for label in labels] == sorted(label.xy[1] for label in labels)
    heights = [label.xyann[1] for label in labels]
    assert len(heights) == 4 and min(np.diff(heights)) > 0.05 and heights[-1] < 1.05
    for label in labels:
        line, = [line for line in axis.lines if line.get_label() == label.get_text()]
        assert label.xy == tuple(line.get_xydata()[-1])


def test_a_force_is_labelled_at_its_own_arrow():
    """No tip of another arrow is nearer; of Stephenson F_C stood at the tip of F_D."""
    pytest.importorskip('matplotlib')
    for name, at in (('stephenson', 60.0), ('stephenson', 200.0), ('watt', 100.0), ('paper', 60)):
        axes = load_scene(name).draw(at).axes[0]
        tips = [np.array(text.xy) for text in axes.texts if getattr(text, 'arrow_patch', None)]
        labels = [text for text in axes.texts if re.fullmatch(r'\$F_[^$]+\$', text.get_text())]
        nearest = [int(np.argmin([np.hypot(*(tip - text.get_position())) for tip in tips]))
                   for text in labels]
        assert len(set(nearest)) == len(labels) > 1, name


def test_the_notebook_of_the_tutorial_runs(tmp_path):
    """In a kernel of Jupyter; each picture and table is there."""
    pytest.importorskip('matplotlib')
    pytest.importorskip('pandas')
    nbclient, nbformat = pytest.importorskip('nbclient'), pytest.importorskip('nbformat')
    pytest.importorskip('ipykernel')
    notebook = nbformat.read(ROOT / 'docs/tutorial.ipynb', as_version=4)
    nbclient.NotebookClient(notebook, timeout=600, startup_timeout=600,
                            resources={'metadata': {'path': str(tmp_path)}}).execute()
    outputs = [output.data for cell in notebook.cells if cell.cell_type == 'code'
               for output in cell.outputs if 'data' in output]
    kinds = [next((kind for kind in ('image/svg+xml', 'text/html') if kind in data), '')
             for data in outputs]
    assert kinds == ['text/html', 'image/svg+xml', 'text/html', 'image/svg+xml', 'text/html',
                     'text/html']
    assert '<svg' in outputs[0]['text/html'] and 'crank-rocker' in outputs[0]['text/html']
    assert size_of(tmp_path / 'column.pdf')[0] == pytest.approx(88.0, abs=1e-3)


@pytest.mark.parametrize(('names', 'options', 'message'), [
    (['f41'], {'width': 88}, "width = 88: must be 20 mm to 2 m, as '88mm'"),
    (['f41'], {'width': '5mm'}, 'width = 0.005: must be 20 mm'),
    ([['f41', 'f32']], {}, 'must be texts, one after another'),
    (['F_C'], {}, "unknown quantity 'F_C'; known: theta4, transmission_angle, omega4, "),
    (['f41'], {'samples': '37'}, "samples = '37': must be a positive number"),
    (['f41'], {'samples': 0}, 'samples = 0: must be a positive number'),
    (['f41'], {'samples': 1.5}, 'samples = 1.5: must be a whole number'),
    (['f41'], {'units': 'kn'}, "'kn' is no unit; did you mean kN?"),
    (['f41'], {'units': {'N': 'foo'}}, "'foo' is no unit"),     # it was a head above newtons
    (['F41'], {}, "unknown quantity 'F41'; did you mean f41?")])
def test_a_wrong_argument_is_one_line(names, options, message):
    with pytest.raises(FourBarError) as refused:
        PAPER_SCENE.plot(*names, **options)
    assert message in str(refused.value)


@pytest.mark.parametrize('speeds', [('10rpm',), (1.0, 2.0, 3.0)])
def test_speeds_are_two(speeds):
    with pytest.raises(InvalidParameter, match='must be the lowest and the highest'):
        PAPER_SCENE.table(speeds=speeds)


def test_units_are_a_text_or_a_list():
    frames = [PAPER_SCENE.table('f41', samples=np.int64(5), units=units)
              for units in ('kN,rad', 'mm,kN,rad', ['kN', 'rad'], {'N': 'kN', 'rad': 'rad'})]
    assert list(frames[0]) == ['theta1 [rad]', 'f41 [kN]']
    assert all(frame.equals(frames[0]) for frame in frames)


def test_a_plot_of_a_run_is_smooth_between_steps(run):
    axis = run.plot().axes[0]
    assert run.system.mechanism.description in axis.get_title().replace('\n', ' ')
    line = axis.lines[0]
    assert len(line.get_xdata()) > 700
    np.testing.assert_array_equal(line.get_ydata(), run.at(line.get_xdata()).position)
