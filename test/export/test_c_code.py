# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Generated C has the bits of Python: results, statuses, its ports of hypot and fsum."""
import ctypes
from dataclasses import replace
import math
from pathlib import Path
import shutil
import subprocess
import sys

from fourbar_lab.export import generate
from fourbar_lab.export.model import GeneratedModel, NotGenerated
from fourbar_lab.export.statements import snippet
from fourbar_ros import FourBar, load_scene, SliderCrank
from fourbar_ros.cli.main import main
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanics.bodies import Applied, Base
from fourbar_ros.numerics.number_types import exact_sum
from fourbar_ros.scene import from_values, read_values
import numpy as np
import pytest
from support import ROOT
from support.exported import (
    Code,
    COMPILERS,
    differences,
    EPS,
    library_of,
    of_python,
    random_inputs,
    SCENES,
    STRICT,
)
from support.random_machines import random_machines
from support.samples import more
from support.scenes import file_of

pytestmark = pytest.mark.skipif(not COMPILERS, reason='no C compiler')
C = (COMPILERS[0], '-std=c99', '-O2') if COMPILERS else ()
EVERY = [(compiler, '-std=c99', level) for compiler in COMPILERS
         for level in ('-O0', '-O1', '-O2', '-O3')]


def compared(scene, folder, name, count, commands, seed=1, is_strict=True):
    """Fail where the C of a scene differs from Python, for any of some compilers."""
    code = Code(scene, folder, name)
    mechanism = code.model.mechanism
    inputs = random_inputs(mechanism, seed, count)
    expected = of_python(mechanism, scene.points, inputs)
    for command in commands:
        said = differences(code.compiled(*command)(inputs), expected, len(code.model.motion),
                           is_strict, not (mechanism.LEAVES_OUT_ZEROS and mechanism.flat_inputs))
        assert not said, f'{name}, {" ".join(command)}: {said}'
    return code


@pytest.mark.parametrize('name', ['paper', 'jansen'])
def test_a_base_is_four_numbers_that_can_be_changed(name, tmp_path):
    values = load_scene(name).values
    scene = from_values({**values, 'gravity.x': 0.0, 'gravity.y': 0.0,
                         'base.topic': 'motion_of_base'})
    on_base = replace(scene, linkage=scene.linkage.with_base(Base(1.0, 9.0, 2.0, -3.0)))
    code = compared(on_base, tmp_path, name, 20, [C])
    assert [one.name for one in code.model.tunable if one.name.startswith('base.')] == [
        'base.force_x', 'base.force_y', 'base.rate', 'base.acceleration']


def with_linkage(machine):
    """Return a scene with a machine in it."""
    return replace(load_scene('paper'), linkage=machine, points={})


@pytest.mark.parametrize('name', ['paper', 'cylinder', 'bucket', 'released', 'sundials'])
def test_results_and_statuses_have_the_bits_of_the_node(name, tmp_path):
    compared(load_scene(name), tmp_path, name, 1000, [(*C, *STRICT)])


@pytest.mark.parametrize('free, stroke', [
    (FourBar(0.4, 1.2, 0.8, 1.0), (0.0, 0.85)), (FourBar(1.2, 0.5, 0.8, 1.0), (-0.5, 1.0)),
    (FourBar(0.4, 1.2, 0.8, 1.0), (20.0, 21.0)), (FourBar(0.5, 1.0, 1.0, 0.5), (3.0, 4.5)),
    (FourBar(0.4, 1.2, 0.8, 1.0), (-9.0, 9.0))],
    ids=('turns', 'two ranges', 'another turn', 'kite', 'over a turn'))
def test_a_range_of_a_crank_has_the_statuses_of_the_node(free, stroke, tmp_path):
    compared(with_linkage(replace(free, stroke=stroke)), tmp_path, 'ranged', 2000, [(*C, *STRICT)])


@pytest.mark.parametrize('seed, count, dyads, rows', [more((11, 3, 4, 500), (12, 8, 5, 10_000))])
def test_machines_at_random_have_them_too(seed, count, dyads, rows, tmp_path):
    for i, (machine, _) in enumerate(random_machines(seed, count, dyads=(1, dyads),
                                                     least_sine=0.1)):
        compared(with_linkage(machine), tmp_path / str(i), f'random_{i}', rows,
                 [C] if rows < 1000 else EVERY[i % 4::4], is_strict=rows < 1000)


@pytest.mark.skipif('fma' not in Path('/proc/cpuinfo').read_text(), reason='no fused operations')
def test_fused_operations_change_no_bit(tmp_path):
    """The vectorizer of gcc contracts a * b + c beside a * b - c, whatever the pragma says."""
    slider = SliderCrank(0.05, 0.2, 0.01, input='slide')
    compared(with_linkage(slider), tmp_path, 'fused', 1000, [(*C, '-mfma')])


@pytest.mark.slow
@pytest.mark.parametrize('path', SCENES, ids=lambda path: path.stem)
def test_every_shipped_scene_with_every_compiler(path, tmp_path):
    code = compared(load_scene(path), tmp_path, path.stem, 10_000,
                    EVERY[SCENES.index(path) % 4::4])        # a level in turn
    for compiler in COMPILERS:             # what would contract, and be checked for errors
        subprocess.run([compiler, '-std=c99', '-O2', *STRICT, '-c', f'{code.name}.c', '-o', 'a.o'],
                       check=True, cwd=tmp_path)
        subprocess.run([compiler.replace('gcc', 'g++').replace('clang', 'clang++'), '-x', 'c++',
                        '-std=c++11', '-O2', *STRICT, '-c', f'{code.name}.c', '-o', 'a.o'],
                       check=True, cwd=tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize('name', ['paper', 'bucket', 'parallelogram', 'gripper'])
def test_sanitizers_find_nothing(name, tmp_path):
    code = Code(load_scene(name), tmp_path, name)
    inputs = random_inputs(code.model.mechanism, 5, 2000)
    inputs.tofile(tmp_path / 'inputs')
    (tmp_path / 'main.c').write_text(f"""
#include <stdio.h>
#include "{name}.h"
void many(const {name}_parameters *, const {name}_input *, int, double *, int *);
static {name}_input inputs[2000];
static double to[2000 * {code.width}];
static int status[2000];
int main(void)
{{
  FILE *file = fopen("inputs", "rb");
  if (!file || fread(inputs, sizeof *inputs, 2000, file) != 2000) return 2;
  many(0, inputs, 2000, to, status);
  return {name}_self_check();
}}
""")
    subprocess.run([*C, '-fsanitize=address,undefined', '-fno-sanitize-recover=all',
                    f'{name}.c', 'many.c', 'main.c', '-o', 'checked', '-lm'], check=True,
                   cwd=tmp_path)
    subprocess.run([tmp_path / 'checked'], check=True, cwd=tmp_path)


# --- what it is built of -------------------------------------------------------------------------

@pytest.fixture(scope='module')
def ports(tmp_path_factory):
    folder = tmp_path_factory.mktemp('ports')
    (folder / 'ports.c').write_text(
        '#include <float.h>\n#include <math.h>\n#include <stdint.h>\n#include <string.h>\n'
        'enum { MOST_TERMS = 8 };\n' + ''.join(
            snippet('functions.c', name)
            for name in ('hypot', 'exact_sum', 'power_of_two', 'power')) + """
double h(double x, double y) { return hypot_of(x, y); }
double s(int count, const double *terms) { return exact_sum(count, terms); }
double p(int count, const double *terms) { return power_of_two(count, terms); }
double w(double x, double y) { return power(x, y); }
""")
    subprocess.run([*C, '-O3', '-shared', '-fPIC', '-o', folder / 'ports.so', folder / 'ports.c',
                    '-lm'], check=True)
    library = ctypes.CDLL(str(folder / 'ports.so'))
    for name in 'hspw':
        getattr(library, name).restype = ctypes.c_double
    library.h.argtypes = library.w.argtypes = [ctypes.c_double] * 2
    return library


def of_all_sizes(rng, shape):
    return rng.normal(size=shape) * 2.0**rng.integers(-60, 60, shape)


def test_hypot_has_the_bits_of_python(ports):
    rng = np.random.default_rng(3)
    pairs = [*rng.normal(size=(20_000, 2)).tolist(), *of_all_sizes(rng, (5000, 2)).tolist(),
             *(rng.normal(size=(500, 2)) * 10.0**rng.uniform(-305, 308, (500, 2))).tolist(),
             *((x, y) for x in (0.0, -0.0, math.inf, 1.0, 5e-324) for y in (0.0, -math.inf, 3.0))]
    assert [pair for pair in pairs if ports.h(*pair) != math.hypot(*pair)] == []
    assert math.isnan(ports.h(math.nan, 1.0)) and ports.h(math.nan, math.inf) == math.inf


def test_hypot_of_tiny_numbers_is_that_of_python_3_12(ports):
    tiny = [(x * 2.0**-1074, y * 2.0**-1074) for x in (1, 3, 77) for y in (0, 1, 40, 2**30)]
    for pair in tiny:
        if sys.version_info >= (3, 12):
            assert ports.h(*pair) == math.hypot(*pair)
        assert abs(ports.h(*pair) - math.hypot(*pair)) <= 2.0**-1074


def test_exact_sums_and_powers_have_the_bits_of_python(ports):
    rng = np.random.default_rng(4)
    for terms in [*of_all_sizes(rng, (5000, 4)).tolist(), [0.0, -0.0, 0.0, 0.0],
                  [1e16, 1.0, 1e-16, -1e16], [1.0, 2.0**-53, 2.0**-106, 0.0],
                  [1.0, 2.0**-53, -2.0**-106, 0.0], [0.1, -0.1, 0.0, -0.0], [0.1, 0.5, -0.2, -0.4],
                  *([1.0, 1.0, -2.0, k * EPS] for k in range(-18, 19))]:
        given = (ctypes.c_double * 4)(*terms)
        assert ports.s(4, given).hex() == exact_sum(terms).hex()
        if any(terms):
            assert ports.p(4, given) == math.ldexp(1.0, math.frexp(max(map(abs, terms)))[1])
    # a compiler makes x * x of pow(x, 2): another last bit in one of a thousand
    values = np.random.default_rng(5).uniform(0.1, 3.0, 20_000).tolist()
    assert [x for x in values if ports.w(x, 2.0) != x ** 2.0] == []
    assert [x for x in values if x ** 2.0 != x * x], 'no such x was drawn'


# --- parameters and outputs ----------------------------------------------------------------------

def test_parameters_can_be_changed_and_have_the_bits_of_another_mechanism(tmp_path):
    scene = load_scene('paper')
    code = Code(scene, tmp_path, 'paper')
    run, own = code.compiled(*C), scene.linkage
    bodies = own.bodies._replace(coupler=replace(own.bodies.coupler, mass=5.5, cg_across=0.07))
    external = own.external._replace(output=Applied(1.0, -2.0, along=0.3, across=0.01, couple=0.4))
    other = replace(own, a1=0.37, a3=0.83, bodies=bodies, gravity=(0.3, -9.81), external=external)
    inputs = random_inputs(other, 2, 500)
    found = {'a1': 0.37, 'a3': 0.83, 'bodies.coupler.mass': 5.5, 'bodies.coupler.cg_across': 0.07,
             'gravity.x': 0.3, 'gravity.y': -9.81, 'external.output.force_x': 1.0,
             'external.output.force_y': -2.0, 'external.output.along': 0.3,
             'external.output.across': 0.01, 'external.output.couple': 0.4}
    values = [found.get(one.name, one.value) for one in code.model.tunable]
    assert found.keys() <= {one.name for one in code.model.tunable}
    assert not differences(run(inputs, values), of_python(other, {}, inputs), 27)
    # impossible data: no plausible number, and nothing is kept of them
    for name, value in (('a1', 5.0), ('a1', -0.4), ('a4', 0.0), ('bodies.crank.mass', -1.0),
                        ('bodies.output.inertia', -1e-3), ('a2', math.nan)):
        broken = [value if one.name == name else one.value for one in code.model.tunable]
        status, rows = run(inputs, broken)
        assert not (status == 0).any() and np.isnan(rows[:, 3:15]).all(), (name, value)
    assert not differences(run(inputs), of_python(own, {}, inputs), 27)


@pytest.mark.parametrize('name, changed', [
    # points and pins of several dyads among them
    ('jansen', {'linkage.points.pin.along': 0.16, 'linkage.points.pivot.y': -0.07,
                'dyads.lower.length_2': 0.4, 'linkage.points.knee.distance_2': 0.01}),
    ('v8', {'linkage.points.pin_1.along': 0.046, 'dyads.L1.length_1': 0.16}),  # a pair, RRP
    ('stephenson', {'dyads.hoeken.first.across': 0.01, 'dyads.hoeken.second.across': 0.02,
                    'dyads.hoeken.length_1': 0.24}),
    ('parallelogram', {'dyads.loop.length_2': 0.25})])             # leaves the change point
def test_lengths_of_dyads_can_be_changed(name, changed, tmp_path):
    scene = load_scene(name)
    other = replace(from_values({**scene.values, **changed}).linkage,
                    bodies=scene.linkage.bodies._asdict())
    inputs = random_inputs(other, 2, 300)
    changed = {path.removeprefix('dyads.'): value for path, value in changed.items()}
    code = Code(scene, tmp_path, name, parameters=[*changed])       # zeros among them
    assert changed.keys() == {one.name for one in code.model.tunable}
    values = [changed[one.name] for one in code.model.tunable]
    run = code.compiled(*C)
    said = differences(run(inputs, values), of_python(other, scene.points, inputs),
                       len(code.model.motion))
    assert not said, said
    length = next(name for name in changed if 'length' in name)
    broken = [-one.value if one.name == length else one.value for one in code.model.tunable]
    assert not (run(inputs, broken)[0] == 0).any()


def test_elements_that_no_scene_can_have_give_no_number(tmp_path):
    """A scene and JavaScript refused these springs, C took them."""
    scene = from_values({**load_scene('paper').values, **{
        f'springs.s.{name}': value for name, value in (
            ('first.across', 0.4), ('second.link', 'output'), ('second.along', 0.4),
            ('stiffness', 900.0), ('free_length', 0.2), ('damping', 3.0))},
        'torsion_springs.t.second': 'output', 'torsion_springs.t.stiffness': 40.0,
        'friction.A.coefficient': 0.1, 'friction.A.radius': 0.02})
    code = Code(scene, tmp_path, 'paper')
    run, inputs = code.compiled(*C), np.array([(0.5, 3.0, 0.0)])
    assert (run(inputs)[0] == 0).all()
    for name in ('springs.s.stiffness', 'springs.s.free_length', 'springs.s.damping',
                 'torsion_springs.t.stiffness', 'friction.A.coefficient', 'friction.A.radius'):
        for value, is_good in ((-1e-3, False), (0.0, True)):
            values = [value if one.name == name else one.value for one in code.model.tunable]
            assert values != [one.value for one in code.model.tunable]
            assert (run(inputs, values)[0] == 0).all() == is_good, (name, value)


def test_every_length_of_every_scene_can_be_changed():
    for path in SCENES:
        scene = load_scene(path)
        if not scene.dynamics:
            lengths = {*scene.linkage.numbers_of_lengths, *[
                name for name in scene.values if name.startswith('linkage.points.')]}
            names = {name for name, _ in GeneratedModel(scene, 'scene').names} & lengths - {''}
            model = GeneratedModel(scene, 'scene', parameters=sorted(names))
            assert {one.name for one in model.tunable} == names, path


# decimals are change points as whole numbers are; kites and 1 : 5 : 2 : 4 repeat after two turns
CHANGE_POINTS = [(0.1, 0.5, 0.2, 0.4), (0.3, 0.6, 0.6, 0.3), (0.3, 0.6, 0.3, 0.6),
                 (0.25, 0.25, 0.4, 0.4), (0.4, 0.4, 0.4, 0.4)]


@pytest.mark.parametrize('lengths', CHANGE_POINTS, ids=str)
@pytest.mark.parametrize('mode', [1, 2])
def test_at_change_points_turns_count_and_flat_positions_are_toggles(mode, lengths, tmp_path):
    values = {name: value for name, value in load_scene('paper').values.items()
              if not name.startswith(('linkage.', 'external.', 'bodies.'))}
    own = {f'linkage.a{i}': length for i, length in enumerate(lengths, 1)}
    bodies = {'bodies.rods.density': 7850.0, 'bodies.rods.radius': 0.01}
    scene = from_values({**values, **bodies, **own, 'linkage.mode': mode})
    linkage, code = scene.linkage, Code(scene, tmp_path, 'point')
    rng = np.random.default_rng(3)
    inputs = np.concatenate([random_inputs(linkage, 1, 500), np.column_stack(
        [rng.uniform(-4.0 * math.pi, 4.0 * math.pi, 300), *rng.normal(0.0, 20.0, (2, 300))])])
    expected = of_python(linkage, {}, inputs)
    is_flat = np.isin(inputs[:, 0], (0.0,)) & (0.0 in linkage.flat_inputs)
    assert set(expected[0][is_flat & np.isfinite(inputs).all(axis=1)]) <= {2, 3}
    assert (expected[0][is_flat] == 3).any() or 0.0 not in linkage.flat_inputs
    # the same from a code that was written for other lengths
    other = Code(from_values({**values, **bodies, 'linkage.a1': 0.3, 'linkage.a2': 0.8,
                              'linkage.a3': 0.5, 'linkage.a4': 0.7, 'linkage.mode': mode}),
                 tmp_path / 'other', 'other')
    own |= {f'a{i}': length for i, length in enumerate(lengths, 1)}
    own |= {f'bodies.{link}.{field}': getattr(body, field)
            for link, body in linkage.bodies._asdict().items()
            for field in ('mass', 'cg_along', 'inertia')}
    found = other.compiled(*C)(inputs, [own.get(one.name, one.value)
                                        for one in other.model.tunable])
    for results in (code.compiled(*C)(inputs), found):
        said = differences(results, expected, len(code.model.motion))
        assert not said, said


@pytest.mark.parametrize('name, lengths', [('slider_crank', {'a1': 0.05, 'offset': 0.02}),
                                           ('cylinder', {'a1': 1.3, 'a4': 1.5})])
def test_points_follow_the_lengths(name, lengths, tmp_path):
    scene = load_scene(name)
    code, other = Code(scene, tmp_path, name), replace(scene.linkage, **lengths)
    inputs = random_inputs(other, 2, 300)
    values = [lengths.get(one.name, one.value) for one in code.model.tunable]
    assert any('.x' in one.name for one in code.model.motion)
    said = differences(code.compiled(*C)(inputs, values),
                       of_python(other, scene.points, inputs), len(code.model.motion))
    assert not said, said


def test_forces_over_the_place_of_a_point_follow_the_lengths(tmp_path):
    scene = from_values({
        **load_scene('paper').values, 'points.p.link': 'coupler', 'points.p.along': 0.5,
        'forces.push.link': 'coupler', 'forces.push.along': 0.7, 'forces.push.across': 0.2,
        'forces.push.acts': 'y', 'forces.push.over': 'p.x',
        'forces.push.places': [-1.0, 0.2, 0.6, 2.0],
        'forces.push.values': [10.0, 200.0, -30.0, 100.0],
        # steps: within a table, at its begin, at its end, where a cycle comes round
        **{f'forces.{name}.{field}': value
           for name, over, places in (('step', 'p.x', [0.2, 0.2, 0.5, 0.5, 0.6, 0.6]),
                                      ('cut', 'theta4', [1.0, 1.5, 1.5, 1.6, 2.0, 2.0]),
                                      ('cycle', 'input', [
                                          -1.0, -1.0, 0.5, 0.5, 1.0, 2.0 * math.pi - 1.0]))
           for field, value in (('link', 'output'), ('acts', 'couple'), ('over', over),
                                ('places', places), ('periodic', name == 'cycle'),
                                ('values', [0.0, 70.0, 60.0, -20.0, 30.0, 0.0]))}})
    code, other = Code(scene, tmp_path, 'pushed'), replace(scene.linkage, a1=0.35)
    inputs = random_inputs(other, 2, 300)
    values = [0.35 if one.name == 'a1' else one.value for one in code.model.tunable]
    said = differences(code.compiled(*C)(inputs, values),
                       of_python(other, scene.points, inputs), len(code.model.motion))
    assert not said, said


def test_numbers_folded_in_have_the_same_bits_and_less_is_written(tmp_path):
    scene = load_scene('paper')
    whole, folded = (Code(scene, tmp_path / name, 'paper', **options) for name, options in (
        ('whole', {}), ('folded', {'parameters': []})))
    few = Code(scene, tmp_path / 'few', 'paper', outputs=['theta4', 'driving_torque'],
               parameters=['gravity.x'])
    inputs = random_inputs(scene.linkage, 3, 500)
    expected = whole.compiled(*C)(inputs)
    found = folded.compiled(*C)(inputs)
    assert not folded.model.tunable and [one.name for one in few.model.tunable] == ['gravity.x']
    assert all(np.array_equal(*pair, equal_nan=True) for pair in zip(found, expected))
    places = [whole.model.mechanism.MOTION._fields.index('theta4'),
              len(whole.model.mechanism.MOTION._fields)
              + whole.model.mechanism.LOADS._fields.index('driving_torque')]
    status, rows = few.compiled(*C)(inputs)
    # what overflows is judged by the outputs that are wanted
    assert (status == expected[0])[abs(inputs).max(axis=1) < 1e60].all()
    same = status == expected[0]
    assert np.array_equal(rows[same][:, 3:], expected[1][same][:, places], equal_nan=True)
    assert few.written.operations < 0.75 * whole.written.operations
    assert 'hypot_of' not in (tmp_path / 'few' / 'paper.c').read_text()


def test_the_code_checks_itself_and_says_what_it_is(tmp_path):
    generate('jansen', tmp_path)
    assert library_of(tmp_path, 'jansen').jansen_self_check() == 0
    text = (tmp_path / 'jansen.h').read_text()
    for word in ('jansen', 'operations', 'Left out, as zero', '-ffast-math loses'):
        assert word in text


@pytest.mark.skipif('clang' not in COMPILERS, reason='needs clang and its contraction')
def test_contraction_is_switched_off_in_the_source(tmp_path):
    scene = load_scene('paper')
    compared(scene, tmp_path, 'paper', 300, [(compiler, '-std=gnu99', '-O2', '-march=native')
                                             for compiler in COMPILERS])


# --- refused, renamed ----------------------------------------------------------------------------

def test_what_cannot_be_generated_is_refused_by_name(tmp_path):
    for options, words in (
            ({'outputs': ['theta5']}, 'theta5'), ({'parameters': ['a9']}, 'a9'),
            ({'as_': 'pascal'}, 'pascal')):
        with pytest.raises(InvalidParameter, match=words):
            generate('paper', tmp_path, **options)
    for name in ('springs.back.damping', 'friction.O1.length'):
        with pytest.raises(InvalidParameter, match=f'{name}.*no result depends on it'):
            generate('press', tmp_path, parameters=[name])
    with pytest.raises(NotGenerated, match='a1.*motion by torque'):
        generate('released', tmp_path, parameters=['a1'])
    with pytest.raises(InvalidParameter, match='parameters'):
        generate('motor', tmp_path, parameters=['a9'])
    assert not list(tmp_path.iterdir())


def test_words_of_c_are_changed_and_said(tmp_path, capsys):
    path = file_of({**read_values('paper'), 'points.int.link': 'coupler'}, tmp_path, 'double')
    assert main(['generate', str(path), '-o', str(tmp_path / 'code')]) == 0
    said = capsys.readouterr()
    assert 'double is double_' in said.err and 'operations' in said.out
    assert library_of(tmp_path / 'code', 'double_').double__self_check() == 0


@pytest.mark.skipif(not shutil.which('c++'), reason='no C++ compiler')
def test_headers_whose_names_differ_in_case_are_two(tmp_path):
    for name in ('arm', 'Arm'):
        generate('paper', tmp_path, name=name)
    (tmp_path / 'both.cc').write_text('#include "arm.h"\n#include "Arm.h"\n'
                                      'int main() { return Arm_self_check(); }\n')
    subprocess.run(['c++', '-fsyntax-only', tmp_path / 'both.cc'], check=True)


@pytest.mark.skipif(not shutil.which('c++'), reason='no C++ compiler')
def test_the_example_of_a_transmission_goes_both_ways(tmp_path):
    generate('paper', tmp_path)
    subprocess.run([*C, *STRICT, '-c', 'paper.c'], check=True, cwd=tmp_path)
    subprocess.run(['c++', '-std=c++17', *STRICT, '-I.', str(ROOT / 'examples/transmission.cpp'),
                    'paper.o', '-o', 'transmission'], check=True, cwd=tmp_path)
    said = subprocess.run(['./transmission'], check=True, cwd=tmp_path, capture_output=True,
                          text=True).stdout
    # position, velocity and effort of the motor again: 1e-12 is where Newton ends
    assert np.abs(np.array(said.split(), float) - [1.0, 25.0, 3.0]).max() < 1e-9
