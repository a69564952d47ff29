# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Springs, force tables and friction: run time over that of the same mechanism without them."""
from pathlib import Path
from statistics import median
import tempfile
from time import process_time

from .pages import table

ROUNDS, STEPS, BATCH = 7, 2000, 10_000
ROWS = 2048         # of a study
SPEED = 20.0        # of the input [rad/s]


def cases():
    """Return {name: (mechanism without, {what acts: mechanism with it})}."""
    from fourbar_ros import JointFriction, load_scene
    from fourbar_ros.mechanisms.elements import (
        Attachment,
        LinkAngle,
        PositionForce,
        Spring,
        TorsionSpring,
    )
    from fourbar_ros.mechanisms.force_table import ForceTable
    import numpy as np
    places = np.linspace(-3.0, 3.0, 100)
    cut = ForceTable(places, 200.0 * np.sin(3.0 * places) * np.cos(places))
    found = {}
    for name, link in (('paper', 'output'), ('watt', 'rocker')):
        plain = load_scene(name).linkage
        springs = (Spring(Attachment('ground', 1.5, 0.3), Attachment(link, 0.2), 900.0,
                          free_length=0.3, damping=5.0),
                   TorsionSpring('ground', link, 30.0))
        force = PositionForce(Attachment(link, 0.1), cut, LinkAngle(link))
        pins = {reaction.joint: JointFriction(0.1, radius=0.01)
                for reaction in plain.REACTIONS if not reaction.couple}
        found[name] = plain, {
            'a spring': plain.with_elements(springs[0]),
            'two springs': plain.with_elements(*springs),
            'two springs, a table': plain.with_elements(*springs, force),
            'friction in all pins': plain.with_friction(pins),
            'all of these': plain.with_elements(*springs, force).with_friction(pins)}
    return found


def took(call, repeats):
    """Return the CPU time of a call [s]."""
    begin = process_time()
    for _ in range(repeats):
        call()
    return (process_time() - begin) / repeats


def studies(folder):
    """Return {what acts: study of peak and root mean square of the torque of the paper's}."""
    from fourbar_lab.studies.study import from_document
    from fourbar_ros import load_scene
    from fourbar_ros.scene.files import as_text
    import numpy as np
    values = {name: value for name, value in load_scene('paper').values.items() if value == value}
    springs = {}
    for name, x, y in (('back', 1.5, 0.7), ('low', 0.0, -0.8)):
        springs |= {f'springs.{name}.first.along': x, f'springs.{name}.first.across': y,
                    f'springs.{name}.second.link': 'output', f'springs.{name}.second.along': 0.5,
                    f'springs.{name}.stiffness': 900.0, f'springs.{name}.free_length': 0.3}
    cut = {'points.tip.link': 'coupler', 'points.tip.along': 0.5, 'forces.cut.link': 'coupler',
           'forces.cut.along': 0.5, 'forces.cut.acts': 'x', 'forces.cut.over': 'tip.x',
           'forces.cut.places': [0.1, 0.3, 0.35, 0.5, 0.8],
           'forces.cut.values': [0.0, -700.0, -900.0, 100.0, 0.0]}
    places = np.linspace(0.1, 0.8, 100)
    long = {**cut, 'forces.cut.places': places.tolist(),
            'forces.cut.values': (200.0 * np.sin(12.0 * places) * np.cos(5.0 * places)).tolist()}
    pins = {f'friction.{joint}.{name}': value for joint in ('O1', 'A', 'B', 'O4')
            for name, value in (('coefficient', 0.1), ('radius', 0.01))}
    vary = {'linkage.a1': {'range': [0.2, 0.3]}, 'linkage.a2': {'range': [1.1, 1.3]}}
    found = {}
    stiffness, factor = 'springs.back.stiffness', 'forces.cut.factor'
    for what, acting, more in (
            ('nothing', {}, ()), ('two springs', springs, (stiffness,)),
            ('two springs, a table over a way', {**springs, **cut}, (stiffness, factor)),
            ('two springs, a table of 100 places', {**springs, **long}, (stiffness, factor)),
            ('two springs, a table over a way, friction in all pins',
             {**springs, **cut, **pins}, (stiffness, factor))):
        file = folder / f'{len(found)}.yaml'
        file.write_text(as_text({**values, **acting}))
        found[what] = from_document({
            'scene': file.name, 'rows': ROWS, 'keep': 'all',
            'quantities': ['driving_torque.peak', 'driving_torque.rms'],
            'vary': {**vary, **{name: {'range': [0.5, 2.0] if name == factor else [100.0, 2000.0]}
                                for name in more}}}, folder)
    return found


def table_of_studies():
    """Print how many designs of a study are computed in a second, and the ratios."""
    from fourbar_lab.studies.chunks import compute
    with tempfile.TemporaryDirectory() as folder:
        every = studies(Path(folder))
    times = {what: [] for what in every}
    for study in every.values():
        compute(study, 0)
    for _ in range(ROUNDS):
        for what, study in every.items():
            times[what].append(took(lambda s=study: compute(s, 0), 1))
    table(('study of peak and root mean square of the torque', 'rows a second',
           'time over nothing'),
          [(what, f'{ROWS / median(of_study):.3g}',
            f'{median(a / b for a, b in zip(of_study, times["nothing"])):.3g}')
           for what, of_study in times.items()])


def main():
    """Print the ratios of steps and batches, and the times of searches and studies."""
    from fourbar_ros import find_extrema
    import numpy as np
    x, rows = np.linspace(0.0, 6.0, BATCH), []
    print(f'CPU time of the process; {ROUNDS} rounds, in each all in turn; medians. A table has '
          '100 places. Asked: steps with springs 1.3, with friction 4; batches of '
          f'{BATCH} 1.3 and 6.\n')
    for name, (alone, loaded) in cases().items():
        calls = {what: (lambda m=m: m.step(0.5, SPEED, 0.0), lambda m=m: m.loads(x, SPEED))
                 for what, m in {'nothing': alone, **loaded}.items()}
        for step, batch in calls.values():      # traces are made once
            step()
            batch()
        times = {what: [] for what in calls}
        for _ in range(ROUNDS):
            for what, (step, batch) in calls.items():
                times[what].append((took(step, STEPS), took(batch, 5)))
        for what in calls:
            over = [median(now[k] / plain[k] for now, plain in zip(
                times[what], times['nothing'])) for k in (0, 1)]
            rows.append((name, what, f'{1e6 * median(t for t, _ in times[what]):.3g}',
                         f'{over[0]:.3g}', f'{1e3 * median(t for _, t in times[what]):.3g}',
                         f'{over[1]:.3g}'))
    table(('linkage', 'acting', 'step [us]', 'over nothing', 'batch [ms]', 'over nothing'), rows)
    rows = []
    for name, (plain, loaded) in cases().items():
        for what, mechanism in {'nothing': plain, **loaded}.items():
            quantities = ('shaking_force', mechanism.drive_load, *mechanism.reactions)
            find_extrema(mechanism, quantities, SPEED)
            extrema = find_extrema(mechanism, quantities, SPEED)
            seconds = median(took(lambda m=mechanism, q=quantities: find_extrema(m, q, SPEED), 1)
                             for _ in range(ROUNDS))
            rows.append((name, what, len(quantities), len(extrema), f'{seconds:.3g}'))
    print()
    table(('linkage', 'acting', 'loads', 'extrema', 'CPU time of all [s]'), rows)
    print()
    table_of_studies()
