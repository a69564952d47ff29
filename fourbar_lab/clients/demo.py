# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Run a scene on a real node: live table, extrema by service, a bag, and its recomputation."""
from collections import Counter
from collections.abc import Sequence
from functools import partial
from math import cos, degrees, isnan, nan, remainder, sin
from pathlib import Path
import signal
import subprocess
import sys
from tempfile import TemporaryDirectory
import time

from fourbar_lab.clients.node_client import NoAnswer, NodeClient, opened
from fourbar_lab.drawing.tables import linkage_table, rates_in_words
from fourbar_msgs.msg import Extremum
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.cli.common import Parser
from fourbar_ros.cli.main import terminable
from fourbar_ros.cli.scene import errors_and_times
from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.quantities import known_quantities, positions
from fourbar_ros.pipeline.stepper import STATUS_NAMES
from fourbar_ros.ros.messages import Message, to_stamp
from fourbar_ros.scene.files import find, NODE
from fourbar_ros.scene.scene import load, Scene
from fourbar_ros.scene.topics import INPUTS
from fourbar_ros.scene.units import of
from fourbar_ros.terminal import make_console, make_table
from rclpy.node import Node
from rich.console import Console
from rich.live import Live
from rich.table import Table

PATIENCE = 20.0        # [s] for the node to start, be found and answer
SWING = 0.95           # share of the input range that the demonstration swings through
REFRESH = 8            # live tables per second
KINDS = {Extremum.KIND_MINIMUM: 'min', Extremum.KIND_MAXIMUM: 'max',
         Extremum.KIND_CONSTANT: 'const'}


class Driver(NodeClient):
    """Swings the input of a node that messages drive, and keeps its latest outputs."""

    def __init__(self, node: Node, scene: Scene) -> None:
        super().__init__(node, PATIENCE)
        self.scene = scene
        self.latest: dict[str, Message] = {}         # newest message of each output, by its name
        self.received = Counter[str]()
        for name, topic in scene.topics.items():
            self.subscribe(topic, partial(self._take, name))
        self.input = self.publisher(scene.drive.source) if scene.drive.source in INPUTS else None

    def _take(self, name: str, message: Message) -> None:
        self.latest[name] = message
        self.received[name] += 1

    def drive(self, seconds: float) -> None:
        """
        Send the input of a time [s] after the start, if messages drive the node.

        It swings as a sine through 0.95 of its last range, with the scene's speed in the middle.
        """
        if not self.input:
            return
        low, high = self.scene.linkage.input_ranges[-1]
        middle, reach = 0.5 * (low + high), SWING * 0.5 * (high - low)
        frequency = self.scene.drive.speed / reach                       # [rad/s]
        sine, cosine = reach * sin(frequency * seconds), reach * cos(frequency * seconds)
        message = self.input.msg_type()
        message.header.stamp = to_stamp(self.node.get_clock().now().nanoseconds)
        position, velocity = middle + sine, frequency * cosine
        if self.scene.drive.source == 'joint_state':
            message.name = [self.scene.drive.joint]
            message.position, message.velocity = [position], [velocity]
        else:
            message.position, message.velocity = position, velocity
            message.acceleration = -frequency * frequency * sine
        self.input.publish(message)


def live_table(client: Driver, seconds: float) -> Table:
    """Return a table: the latest state and loads, how many messages came on each topic."""
    table = make_table(f'{NODE} at {seconds:4.1f} s', ('', '        value>', 'unit'))
    state, loads = client.latest.get('state'), client.latest.get('loads')
    if state:
        table.add_row('status', STATUS_NAMES[state.status], '')
    linkage = client.scene.linkage
    quantities = {**positions(linkage, linkage.input), **known_quantities(linkage, linkage.input)}
    rows = [(linkage.input_coordinate.position, linkage.input_coordinate.unit, state),
            *((name, quantity.unit, loads if quantity.is_load else state)
              for name, quantity in quantities.items())]
    for name, unit, message in rows:
        value = getattr(message, name, nan)
        if not isnan(value):
            table.add_row(name.replace('_', ' '), *(
                (f'{remainder(degrees(value), 360.0):.3f}', 'deg') if unit == 'rad' else
                (f'{value:.5g}', unit)))
    for name, count in client.received.items():
        table.add_row(f'received {name}', str(count), 'messages')
    return table


def watch(client: Driver, node: subprocess.Popen[bytes], seconds: float, console: Console) -> None:
    """Show the stream for some seconds; NoAnswer if no message comes or the node ends."""
    began = time.monotonic()

    def drive() -> bool:
        """Send the next input; return whether there is something to look at."""
        client.drive(time.monotonic() - began)
        return bool(client.received) or node.poll() is not None

    client.until(drive, f'no message from {NODE}')
    first = time.monotonic()
    with Live(console=console, refresh_per_second=REFRESH, transient=False) as live:
        while time.monotonic() - first < seconds and node.poll() is None:
            client.drive(time.monotonic() - began)
            client.spin(0.01 if client.input else 1.0 / REFRESH)
            live.update(live_table(client, time.monotonic() - first))
    if node.poll() is not None:
        raise NoAnswer(f'the node ended with exit code {node.returncode}')
    if not console.is_terminal:          # rich ends the last table only on a terminal
        console.print()


def show_extrema(client: Driver, console: Console) -> None:
    linkage, speed = client.scene.linkage, client.scene.drive.speed
    answer = client.call('find_extrema', velocity=speed)
    if answer.result != answer.RESULT_OK:
        console.print(f'find_extrema: {answer.message}')
        return
    console.print(make_table(
        f'global extrema at {rates_in_words(linkage, speed)}, mode '
        f'{linkage.modes[linkage.mode]}, from {NODE}/find_extrema',
        ('quantity', '', 'value>', 'unit', f'{linkage.input_coordinate.position}>'),
        [(extremum.quantity, KINDS[extremum.kind], f'{extremum.value:.9g}', extremum.unit,
          f'{extremum.theta1 if isnan(extremum.slide) else extremum.slide:.7f}')
         for extremum in answer.extrema if extremum.is_global]))
    console.print()


def run(path: str | Path, seconds: float, directory: str | Path, console: Console) -> bool:
    """
    Start a node with a scene, show its stream and its extrema, check its bag.

    ``seconds``: how long the stream is shown; ``directory``: where the bag goes. Returns whether
    the node ended well and its bag recomputes without a difference.
    """
    path = find(path)
    scene = load(path)
    console.print(linkage_table(scene.linkage, path))
    name = f'{scene.name}_{time.strftime("%Y_%m_%d-%H_%M_%S")}'
    with TemporaryDirectory() as folder:
        file = Path(folder, 'scene.yaml')            # of FILE:NODE that node alone
        file.write_text(scene.as_text, encoding='utf-8')
        node = subprocess.Popen([sys.executable, '-m', 'fourbar_ros.ros.node.start', '--ros-args',
                                 '--params-file', str(file), '-p', 'recording.start:=true',
                                 '-p', f'recording.directory:={directory}',
                                 '-p', f'recording.name:={name}'])
        try:
            with opened(lambda ros_node: Driver(ros_node, scene), 'fourbar_demo') as client:
                watch(client, node, seconds, console)
                show_extrema(client, console)
        finally:
            node.send_signal(signal.SIGTERM)
            code = node.wait()
    console.print(f'the node was stopped by SIGTERM: exit code {code}')
    bag = Path(directory) / name
    recomputation = recompute(bag)
    console.print(f'bag recomputed: {recomputation.compared} outputs from their recorded input, '
                  f'largest difference {recomputation.largest:g}', soft_wrap=True)
    console.print(f'bag: {bag}\nfor Foxglove and PlotJuggler: {bag / (name + "_0.mcap")}',
                  soft_wrap=True)
    console.print('\n'.join(errors_and_times(scene)), soft_wrap=True)
    return not recomputation.problems() and code == 0


def main(args: Sequence[str] | None = None) -> int:
    """Parse the arguments and run; exit code 0 only if the node and its bag are good."""
    parser = Parser(prog='fourbar_demo', description=__doc__)
    parser.add_argument('scene',
                        help='parameter file (YAML) or name of a shipped scene, e.g. paper')
    parser.add_argument('--seconds', type=of('s', above=0.0), default=5.0, metavar='S',
                        help='duration of the stream [s] (default 5)')
    parser.add_argument('--directory', default='bags', metavar='DIR',
                        help='directory for the bag (default bags)')
    arguments = parser.parse_args(args)
    try:
        with terminable():
            good = run(arguments.scene, arguments.seconds, arguments.directory, make_console())
    except FourBarError as error:
        print(f'fourbar_demo: {error}', file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0 if good else 1


if __name__ == '__main__':
    sys.exit(main())
