# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Plant bugs, one at a time, in a copy of this tree: do the fast tests of their room find them?

python scripts/mutate.py [ROOM ...] [--only TEXT]     in the shell of scripts/env.sh

Prints for each bug whether it was found, by which test, after how many seconds; exit code 3 if one
survives. A text that is no longer in its file once is named: mend the table.
"""
import argparse
import os
from pathlib import Path
import re
import shutil
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
LONGEST = 600.0       # [s] of the tests of a room; what takes longer hangs, so it is found


class Bug(NamedTuple):
    """Text of a file that is replaced by another; ``tests`` of the room that run first."""

    file: str
    old: str
    new: str
    tests: str = ''


# {room: (its tests, folder of its files, bugs)}
ROOMS = {
    'mechanisms': ('test/mechanics test/numerics test/mechanisms', 'fourbar_ros', [
        Bug('mechanics/newton_euler.py', 'r.normal * alpha - r * (omega',
            'r.normal * alpha + r * (omega',
            'test/mechanisms/contract/test_accuracy.py'),
        Bug('mechanics/bodies.py', 'mass * (3.0 * radius**2 + length**2) / 12.0',
            'mass * (radius**2 + length**2) / 12.0',
            'test/mechanics/test_bodies.py'),
        Bug('mechanics/bodies.py', 'mass * (width**2 + length**2) / 12.0',
            'mass * (thickness**2 + length**2) / 12.0',
            'test/mechanics/test_bodies.py'),
        Bug('mechanisms/machine/solve/loads.py', 'moment - length * directions[link].cross(force)',
            'moment + length * directions[link].cross(force)',
            'test/mechanisms/contract/test_accuracy.py'),
        Bug('mechanisms/kind.py', ' slope * v, slope * a + bend * square',
            ' slope * v, slope * a - bend * square',
            'test/mechanisms/contract/test_accuracy.py'),
        Bug('mechanisms/curves.py', 'link.v_x - omega * y, link.v_y + omega * x',
            'link.v_x + omega * y, link.v_y + omega * x',
            'test/mechanisms/test_points.py'),
        Bug('mechanics/newton_euler.py', '- 2.0 * (w * link.v_y)', '+ 2.0 * (w * link.v_y)',
            'test/mechanisms/test_moving_base.py'),
        Bug('mechanisms/machine/solve/loads.py', 'moment + curve.x * force.y - curve.y * force.x',
            'moment + curve.x * force.y + curve.y * force.x',
            'test/mechanisms/machine/test_against_cartesian.py'),
        Bug('numerics/roots.py', 'return np.where(x < period, x, 0.0)', 'return x',
            'test/numerics/test_roots.py'),
    ]),
    # `mirrored` without `is_angle` is no bug: of a quantity that is no angle the negative fits the
    # samples of this side better only where both fit within rounding errors.
    'extrema': ('test/extrema', 'fourbar_ros/extrema', [
        Bug('find.py', 'if extremum.sense != -sense and', 'if extremum.sense == sense and',
            'test/extrema/test_find.py'),
        Bug('find.py', 'extremum.side, unit * extremum.condition',
            'extremum.side, extremum.condition',
            'test/extrema/test_sliders.py'),
        Bug('find.py', 'return max(extremum.noise, 4', 'return max(0.0, 4',
            'test/extrema/test_in_doubt.py'),
        Bug('path_search.py', 'falls = slopes * side > 0.0', 'falls = slopes * side < 0.0',
            'test/extrema/test_find.py'),
        Bug('path_search.py', 'GROWTH * fall[:, 1]) & (fall[:, 1] >',
            'GROWTH * fall[:, 1]) | (fall[:, 1] >', 'test/extrema/test_in_doubt.py'),
        Bug('path_search.py', 'goes_on = np.abs(one_sided - bounded) <= 1e-6',
            'goes_on = np.abs(one_sided - bounded) >= 0.0', 'test/extrema/test_in_doubt.py'),
    ]),
    'dynamics': ('test/dynamics test/export', '', [
        Bug('fourbar_ros/dynamics/equation.py',
            'force + drive - (damping + half_slope * rate) * rate',
            'force + drive - (damping - half_slope * rate) * rate',
            'test/dynamics/test_equation.py'),
        Bug('fourbar_ros/dynamics/equation.py', 'extra * turn * bend', 'extra * bend',
            'test/dynamics/test_toggles.py'),
        Bug('fourbar_ros/dynamics/equation.py', 'couple * motions[name].omega', 'couple',
            'test/dynamics/test_equation.py'),
        Bug('fourbar_ros/dynamics/equation.py', 'energy, size = energy - work,',
            'energy, size = energy + work,',
            'test/dynamics/test_runs.py'),
        Bug('fourbar_ros/dynamics/sources.py', 'self.free_speed / self.gear',
            'self.free_speed * self.gear',
            'test/dynamics/test_drives.py'),
        Bug('fourbar_ros/dynamics/sources.py', 'change_by_speed=-constant / self.inductance',
            'change_by_speed=constant / self.inductance',
            'test/dynamics/test_drives.py'),
        Bug('fourbar_ros/mechanisms/elements.py',
            'return max(1, round(self.value.table.span / tau))', 'return 1',
            'test/dynamics/test_position_forces.py'),
        Bug('fourbar_ros/mechanisms/elements.py', 'self.free_length - self.preload)',
            'self.free_length + self.preload)',
            'test/scene/test_acting_everywhere.py'),
        Bug('fourbar_ros/mechanisms/elements.py', '- (force.y - point.y) * force.force_x',
            '+ (force.y - point.y) * force.force_x',
            'test/dynamics/test_element_forces.py'),
        Bug('fourbar_ros/dynamics/node_step.py', 'position + twist if self._has_shaft',
            'position - twist if self._has_shaft',
            'test/dynamics/test_steps.py'),
        Bug('fourbar_ros/dynamics/node_step.py',
            '[linear.next_ratio > 0.0]', '[linear.next_ratio < 0.0]',
            'test/dynamics/test_steps.py'),
        Bug('fourbar_ros/dynamics/rosenbrock.py', 'half_slope * u) * u) / terms.inertia',
            'half_slope) * u) / terms.inertia',
            'test/dynamics/test_stepper.py'),
        Bug('fourbar_ros/dynamics/node_step.py', 'OK if is_good else OUT_OF_BUDGET', 'OK',
            'test/dynamics/test_steps.py'),
        Bug('fourbar_lab/export/statements.py', """f'{"-" * (value < 0)}HUGE_VAL'""", "'HUGE_VAL'",
            'test/export/test_statements.py'),
        Bug('fourbar_lab/export/statements.py',
            "'truediv': '{} == 0.0'", "'truediv': '{} < 0.0'",
            'test/export/test_statements.py'),
        Bug('fourbar_lab/export/statements.py', '{text} ? 1.0 : 0.0', '{text} ? 0.0 : 1.0',
            'test/export/test_c_code.py'),
    ]),
    'scene': ('test/scene test/pipeline', 'fourbar_ros', [
        Bug('scene/units.py', "'rpm': pi / 30.0,", "'rpm': pi / 60.0,",
            'test/scene/test_units.py'),
        Bug('scene/units.py', "'in': '0.0254'", "'in': '0.254'",
            'test/scene/test_units.py'),
        Bug('scene/units.py', "'deg/s': DEGREE", "'deg/s': 1.0",
            'test/scene/test_units.py'),
        Bug('scene/elements.py', '[force_in_si * force for force', '[in_si * force for force',
            'test/scene/test_forces.py'),
        Bug('scene/elements.py', 'Way(attachment, direction=0.5 * pi)', 'Way(attachment)',
            'test/scene/test_forces.py'),
        Bug('scene/dynamics.py', "gear * gear * values['motor.rotor", "gear * values['motor.rotor",
            'test/scene/test_dynamics.py'),
        Bug('pipeline/rate_estimator.py', 'self.curvature = 2.0 * self._bend',
            'self.curvature = self._bend',
            'test/pipeline/test_rate_estimator.py'),
        Bug('pipeline/wrenches.py', '2.0 * new - old for', '1.5 * new - 0.5 * old for',
            'test/pipeline/test_wrenches.py'),
        Bug('pipeline/joints.py', 'values[index] / self._scales[joint].ratio',
            'values[index] * self._scales[joint].ratio',
            'test/pipeline/test_joints.py'),
        Bug('pipeline/stepper.py',
            "'clamp' and status == OUT_OF_RANGE", "'clamp' and status != OK",
            'test/pipeline/test_stepper.py'),
        Bug('pipeline/stepper.py', 'if status in (OK, LOADS_UNKNOWN)', 'if status == OK',
            'test/pipeline/test_stepper.py'),
        Bug('pipeline/stepper.py', 'isinf(rate) or isinf(acceleration)', 'isinf(rate)',
            'test/pipeline/test_stepper.py'),
    ]),
    'bag': ('test/bag', 'fourbar_ros/bag', [
        Bug('recorder.py', '+ 1) & 0xFFFFFFFF', '+ 1) & 0x7FFFFFFF',
            'test/bag/test_recorder.py'),
        Bug('recorder.py', 'self.dropped += len(messages)', 'self.dropped += 1',
            'test/bag/test_recorder.py'),
        Bug('recorder.py', 'self._bytes_in - self._bytes_out + size', 'self._bytes_in + size',
            'test/bag/test_recorder.py'),
        Bug('metadata.py', 'max(end for _, end in spans)', 'spans[0][1]',
            'test/bag/test_recorder.py'),
        Bug('metadata.py', 'messages=before + topic.messages', 'messages=topic.messages',
            'test/bag/test_recorder.py'),
        Bug('reader.py', 'kinds = [Opcode.CHUNK]', 'pass',
            'test/bag/test_reader.py'),
        Bug('reader.py', 'record.sequence >= repeated.get(topic, 0)', 'True',
            'test/bag/test_reader.py'),
        Bug('overview.py', 'if gap < 1 << 31:', 'if True:',
            'test/bag/test_reader.py test/bag/test_recorder.py'),
        Bug('recovery.py', 'counts[record.channel_id] += 1', 'counts[record.channel_id] = 1',
            'test/bag/test_reader.py'),
        Bug('comparison.py', 'times_met[stamp, name] += 1', 'times_met[stamp, name] = 1',
            'test/bag/test_tools.py'),
        Bug('recomputation.py', 'np.isnan(a) & np.isnan(b)', 'np.isnan(a) | np.isnan(b)',
            'test/bag/test_recompute.py'),
        Bug('recomputation.py', 'self._origin.in_order and self._bag.is_finished', 'False',
            'test/bag/test_recompute.py'),
        Bug('recomputation.py', 'np.maximum(counts - 1, 0)', 'np.maximum(counts - 2, 0)',
            'test/bag/test_recompute.py'),
        Bug('recomputation.py', 'of_stamp.get(stamp, LATER if is_behind else NOWHERE)', 'NOWHERE',
            'test/bag/test_recompute.py'),
        Bug('recomputation.py', 'self._modes.pop(stamp, stepper.mode)', 'stepper.mode',
            'test/bag/test_recorded_before.py'),
    ]),
    'node': ('test/ros/test_node.py test/ros/test_inputs.py test/ros/test_torque.py '
             'test/ros/test_chain.py',
             'fourbar_ros/ros/node', [
        Bug('sequence.py', 'self.lost += sequence - max(before)', 'self.lost += 1',
            'test/ros/test_trouble.py'),
        Bug('topic_input.py', 'estimate if isnan(acceleration) else acceleration', 'estimate',
            'test/ros/test_inputs.py'),
        Bug('topic_input.py', 'self._estimator.reset()', 'pass',
            'test/ros/test_inputs.py'),
        Bug('topic_input.py', 'if limit != 0.0 and self._waiting and self._time()',
            'if limit != 0.0 and self._time()',
            'test/ros/test_inputs.py'),
        Bug('acting.py', 'Wrench(force.x, force.y, torque.z)',
            'Wrench(force.y, force.x, torque.z)',
            'test/ros/test_chain.py'),
        Bug('acting.py', "frame not in ('', ours)", 'frame != ours',
            'test/ros/test_chain.py'),
        Bug('torque_input.py', 'wrench.force.x if is_slide', 'wrench.force.y if is_slide',
            'test/ros/test_torque.py'),
        Bug('torque_input.py', 'min(max(torque, -limit), limit)', 'min(torque, limit)',
            'test/ros/test_torque.py'),
        Bug('clock_input.py', 'self._angle += speed * passed', 'pass',
            'test/ros/test_inputs.py'),
        Bug('clock_input.py', '(begin - self._began) * 1e-9', '(begin - self._began) * 1e-6',
            'test/ros/test_inputs.py'),
        Bug('acting.py', '0 <= self._newest - time', '0 < self._newest - time',
            'test/ros/test_base.py'),
        Bug('topic_input.py', 'now + nanoseconds(FUTURE)', 'now + nanoseconds(1e3 * FUTURE)',
            'test/ros/test_inputs.py'),
    ]),
    'lab': ('test/studies test/balancing test/reproduction',
            'fourbar_lab', [
        Bug('studies/measures.py', 'np.minimum(self.min, pi - self.max)',
            'np.minimum(self.min, self.max)',
            'test/studies/test_measures.py'),
        Bug('studies/measures.py', 'slow / fast, nan)', 'fast / slow, nan)',
            'test/studies/test_measures.py'),
        Bug('studies/measures.py', 'min(linkage.input_ranges', 'max(linkage.input_ranges',
            'test/studies/test_measures.py'),
        Bug('studies/variation.py', 'centre - size, 2.0 * size', 'centre - size, size',
            'test/studies/test_study.py'),
        Bug('studies/variation.py', 'generator.advance(start * blocks)',
            'generator.advance(start)',
            'test/studies/test_study.py'),
        Bug('studies/tolerance_analysis.py', 'abs(middle.by[name]) * size',
            'middle.by[name] * size',
            'test/studies/test_tolerances.py'),
        Bug('studies/tolerance_analysis.py', 'DEVIATIONS * size', 'size',
            'test/studies/test_tolerances.py'),
        Bug('balancing/cone.py', 'm * (x * x + y * y)', 'm * x * x',
            'test/balancing/test_balancing.py'),
        Bug('balancing/cone.py', 'r * side + by_inertia * r * r', 'r * side - by_inertia * r * r',
            'test/balancing/test_balancing.py'),
        Bug('reproduction/slides.py', 'motion.alpha4 + mirrored.alpha4',
            'motion.alpha4 - mirrored.alpha4',
            'test/reproduction'),
    ]),
}


def copied(folder):
    """Copy the files that git does not ignore, as they are now; return the copy."""
    names = subprocess.run(['git', 'ls-files', '-coz', '--exclude-standard'], cwd=ROOT,
                           check=True, capture_output=True, text=True).stdout.split('\0')
    for name in filter(None, names):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
    return folder


def tested(copy, tests):
    """Return the name of the first fast test that fails, '' if none does."""
    environment = {**os.environ, 'OPENBLAS_NUM_THREADS': '1', 'PYTHONPATH':
                   os.pathsep.join([str(copy), os.environ.get('PYTHONPATH', '')])}
    run = [sys.executable, '-m', 'pytest', *tests.split(), '-x', '-q', '-m', 'not slow']
    with subprocess.Popen(run, cwd=copy, env=environment, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, start_new_session=True) as process:
        try:
            out, _ = process.communicate(timeout=LONGEST)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, 9)
            return f'hangs, more than {LONGEST:g} s'
    named = re.search(r'^(?:FAILED|ERROR) (.*?)(?: - |$)', out, re.M)
    assert process.returncode in (0, 1, 2), out
    return (named[1] if named else out[-300:]) if process.returncode else ''


def main():
    """Plant the bugs that are asked for; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('rooms', nargs='*', metavar='ROOM', help=', '.join(ROOMS))
    parser.add_argument('--only', default='', metavar='TEXT', help='bugs whose old text has TEXT')
    asked = parser.parse_args()
    if unknown := set(asked.rooms) - set(ROOMS):
        parser.error(f'{", ".join(unknown)}: must be of {", ".join(ROOMS)}')
    survived = 0
    with tempfile.TemporaryDirectory() as folder:
        copy = copied(Path(folder) / 'tree')
        for room in asked.rooms or ROOMS:
            tests, place, bugs = ROOMS[room]
            for bug in bugs:
                if asked.only not in bug.old:
                    continue
                file = copy / place / bug.file
                text = file.read_text(encoding='utf-8') if file.exists() else ''
                if text.count(bug.old) != 1:
                    print(f'{room}: {bug.file}: not there once: {bug.old}', flush=True)
                    survived += 1
                    continue
                file.write_text(text.replace(bug.old, bug.new), encoding='utf-8')
                began = time.monotonic()
                by = bug.tests and tested(copy, bug.tests) or tested(copy, tests)
                file.write_text(text, encoding='utf-8')
                print(f'{room}: {bug.file}: {bug.new.strip()}: '
                      f'{"found by " + by if by else "SURVIVED"}, '
                      f'{time.monotonic() - began:.0f} s', flush=True)
                survived += not by
    print(f'{survived} survived')
    return 3 if survived else 0


if __name__ == '__main__':
    sys.exit(main())
