# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Inputs of 100 and 500 Hz beside live changes: ``python -m bench.live_changes [SCENE]``.

Another process asks for the changes, at the lowest priority: what is measured is the node. Beside
it a bare rclpy node that answers the same inputs, and takes the same changes of a parameter that
means nothing to it; and this node while the bare one is changed, which takes the processor alone.
"""
import os
from statistics import median
import subprocess
import sys
import time

from bench.node import running
from bench.pages import table
from bench.processes import bare, node_of, percentile, sent, Slice, undisturbed
from fourbar_ros.scene.files import read_values

RATES, SECONDS, CHANGES = (100, 500), 4.0, (20, 100)        # [Hz], [s], [Hz]
# which node answers and which is changed
ALONE = (('fourbar', ''), ('bare', ''))
CHANGED = (('fourbar', 'fourbar'), ('bare', 'bare'), ('fourbar', 'bare'))


def change(rate, node):
    """Change gravity of a node so often [Hz]; print how many of how many changes were taken."""
    from rcl_interfaces.srv import SetParameters
    from rclpy.parameter import Parameter
    from support.harness import Client
    os.nice(19)
    client, answers = Client(), []
    setter = client.node.create_client(SetParameters, f'/{node}/set_parameters')
    client.until(setter.service_is_ready, 'the parameter service')
    print('ready', flush=True)
    begin = time.monotonic()
    for number in range(round(rate * (SECONDS + 1.0))):
        client.spin(max(0.0, begin + number / rate - time.monotonic()))
        answers.append(setter.call_async(SetParameters.Request(parameters=[
            Parameter('gravity.y', value=-9.0 - 1e-3 * number).to_parameter_msg()])))
    # the first answers may be lost: the middleware drops those to a client it has not found yet
    while any(not answer.done() for answer in answers) and time.monotonic() < begin + 30.0:
        client.spin(0.5)
    done = [answer.result() for answer in answers if answer.done()]
    print(sum(answer.results[0].successful for answer in done), 'of', len(answers))
    client.close()


def measured(child, listener, rate, changes, changed):
    """Return a row of the table: what one node answers while one is changed."""
    changer = changes and subprocess.Popen(
        [sys.executable, '-m', 'bench.live_changes', '--change', str(changes), changed],
        stdout=subprocess.PIPE, text=True)
    if changer:
        changer.stdout.readline()
    with Slice(child, listener) as part:
        count = sent(rate, SECONDS, [listener.send])
        time.sleep(1.0)             # what is only late is no loss
    late = [1e-3 * value for value in part.late]
    return (rate, child.name, changes, changed,
            changer.communicate()[0].strip() if changer else '0 of 0',
            f'{count - len(late)} of {count}',
            *(f'{value:.2f}' for value in (median(late), percentile(late, 0.99), max(late))))


def main(scene='paper'):
    """Print a row for each rate of changes."""
    values = {**read_values(scene), 'drive.source': 'motion'}
    with undisturbed(), running(node_of(values), bare('echo'), poked=True) as pairs:
        named = {child.name: (child, listener) for child, listener in pairs}
        table(('inputs [Hz]', 'answered by', 'changes [1/s]', 'of', 'applied', 'inputs lost',
               'p50 [ms]', 'p99', 'max'),
              [measured(*named[answers], rate, changes, changed) for rate in RATES
               for changes, cases in ((0, ALONE), *((each, CHANGED) for each in CHANGES))
               for answers, changed in cases])


if __name__ == '__main__':
    if sys.argv[1:2] == ['--change']:
        change(float(sys.argv[2]), sys.argv[3])
    else:
        main(*sys.argv[1:])
