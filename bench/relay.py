# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The relay on joint_states at 1 kHz, beside a bare rclpy node that echoes as many joints.

Both listen and answer on one topic, as in a robot, so both pass over their own answers. Inputs go
to them in turns, half a millisecond apart.
"""
from os import getloadavg
import time

from bench.node import beside, side_by_side
from bench.processes import bare, ours, percentile, sent, undisturbed

RATE = 1000.0                   # [Hz] of the inputs of each
LATE = 1e3                      # [us] the next input comes then
CASES = {'position, velocity': ['joint_states'], 'and loads, effort': ['joint_states', 'loads']}
RELAY = {'drive__source': 'joint_state', 'drive__joint': 'crank', 'drive__timeout': 0.0,
         'joint_states__only_passive': True}


def relay(outputs):
    """Start ours."""
    return ours(outputs, ['~/input_joint_states:=/fourbar/joint_states'], **RELAY)


def measured(outputs, samples):
    """Return ((slices of bare, slices of ours), inputs to each) of so many inputs a slice."""
    from sensor_msgs.msg import JointState
    counts = []

    def work(listeners):
        counts.append(sent(2.0 * RATE, samples / RATE, [one.send for one in listeners]) // 2)
        time.sleep(0.3)
    crank = JointState(name=['crank'], position=[0.3], velocity=[25.0])
    parts = side_by_side(lambda: bare('relay', outputs), lambda: relay(outputs), outputs, work,
                         poked=True, heard='joint_states', given=('joint_states', crank))
    return parts, sum(counts)


def rows(what, outputs, samples):
    """Yield the lines of a case: bare, ours, their ratio."""
    parts, total = measured(outputs, samples)
    columns = beside(*parts, lambda p: (percentile(p.late, 0.5), percentile(p.late, 0.99),
                                        p.per_step))
    for name, side, values in zip(('bare', 'fourbar'), parts, columns):
        delays = [delay for part in side for delay in part.late]
        late, lost = sum(delay > LATE for delay in delays), total - len(delays)
        yield (f'| {what} | {name} | ' + ' | '.join(f'{value:.0f}' for value in values)
               + f' | {total} | {late} ({100.0 * late / total:.2g} %) | {lost} |')
    yield '| | ratio | ' + ' | '.join(f'{value:.2f}' for value in columns[2]) + ' | | | |'


def main(samples=3000):
    """Print a table."""
    with undisturbed():
        print(f'Load of the machine at the start: {getloadavg()[0]:.1f}.\n')
        print('| answers | node | p50 [us] | p99 [us] | CPU a message [us] | inputs '
              '| later than 1 ms | lost |\n|' + ' --- |' * 8)
        for what, outputs in CASES.items():
            for row in rows(what, outputs, samples):
                print(row)


if __name__ == '__main__':
    main()
