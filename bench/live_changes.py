# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Inputs of 100 and 500 Hz beside live changes: ``python -m bench.live_changes [SCENE]``.

Another process asks for the changes, at the lowest priority: what is measured is the node. Beside
it a bare rclpy node that answers the same inputs, and takes the same changes of a parameter that
means nothing to it; and this node while the bare one is changed, which takes the processor alone.
"""
import os
from pathlib import Path
import statistics
import subprocess
import sys
import tempfile
import time

from bench.processes import bare
from fourbar_msgs.msg import Motion
from fourbar_ros.ros.messages import resolve
from fourbar_ros.scene.files import read_values
from fourbar_ros.scene.topics import OUTPUTS
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter

sys.path.insert(0, str(Path(__file__).parent.parent / 'test'))
from support.harness import Client, NodeProcess  # noqa: E402

RATES, SECONDS, CHANGES = (100, 500), 4.0, (20, 100)        # [Hz], [s], [Hz]
# which node answers and which is changed
ALONE = (('fourbar', ''), ('bare', ''))
CHANGED = (('fourbar', 'fourbar'), ('bare', 'bare'), ('fourbar', 'bare'))


class Stream:
    """Sends motions on a grid of time; notes when each was sent and answered [ns]."""

    def __init__(self, client, node):
        self.client, self.sent, self.heard = client, {}, {}
        self.publisher = client.publisher(node=node)
        client.node.create_subscription(resolve(OUTPUTS['state'].type), f'/{node}/state',
                                        self.take, 1000)
        client.until(lambda: self.send(-1) or -1 in self.heard, 'an answer')
        client.spin(0.5)

    def take(self, message):
        """Note when an answer came."""
        self.heard[message.header.stamp.sec - 10] = time.monotonic_ns()

    def send(self, number):
        """Send one motion."""
        message = Motion(position=0.01 * number, velocity=5.0, acceleration=0.0)
        message.header.stamp.sec = number + 10
        self.sent[number] = time.monotonic_ns()
        self.publisher.publish(message)

    def run(self, rate):
        """Send for some seconds; return the latencies [ms], sorted."""
        self.sent.clear(), self.heard.clear()
        begin, number = time.monotonic(), 0
        while number < rate * SECONDS:
            if time.monotonic() - begin >= number / rate:
                self.send(number)
                number += 1
            self.client.executor.spin_once(timeout_sec=0.0005)
        # what was only late is no loss: wait until nothing more has come for a second
        count = -1
        while count != (count := len(self.heard)):
            self.client.spin(1.0)
        return sorted((self.heard[n] - self.sent[n]) * 1e-6 for n in self.heard if n in self.sent)


def change(rate, node):
    """Change gravity of a node so often [Hz]; print how many of how many changes were taken."""
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


def main(scene='paper'):
    """Print a row for each rate of changes."""
    print('| inputs [Hz] | answered by | changes [1/s] | of | applied | inputs lost | p50 [ms] '
          '| p99 | max |')
    print('| --- | --- | --- | --- | --- | --- | --- | --- | --- |')
    with tempfile.TemporaryDirectory() as folder:
        parameters = {**read_values(scene), 'drive.source': 'motion'}
        nodes = [NodeProcess(parameters, Path(folder)), bare('echo')]
        client = Client()
        try:
            streams = {name: Stream(client, name) for name in ('fourbar', 'bare')}
            rows = [(rate, *asked) for rate in RATES
                    for asked in ((0, ALONE), *((changes, CHANGED) for changes in CHANGES))]
            for rate, changes, answered, changed in (
                    (rate, changes, *pair) for rate, changes, pairs in rows for pair in pairs):
                stream, changer = streams[answered], None
                if changes:
                    changer = subprocess.Popen(
                        [sys.executable, '-m', 'bench.live_changes', '--change', str(changes),
                         changed],
                        stdout=subprocess.PIPE, text=True)
                    changer.stdout.readline()
                late = stream.run(rate)
                applied = changer.communicate()[0].strip() if changer else '0 of 0'
                print(f'| {rate} | {answered} | {changes} | {changed} | {applied} | '
                      f'{len(stream.sent) - len(late)} of {len(stream.sent)} | '
                      f'{statistics.median(late):.2f} | {late[int(0.99 * len(late))]:.2f} | '
                      f'{late[-1]:.2f} |', flush=True)
        finally:
            client.close()
            for node in nodes:
                node.stop()


if __name__ == '__main__':
    if sys.argv[1:2] == ['--change']:
        change(float(sys.argv[2]), sys.argv[3])
    else:
        main(*sys.argv[1:])
