"""fourbar_demo: a scene through a real node: live table, extrema by service, bag, bag recomputed."""
from __future__ import annotations

import signal
import subprocess
import sys
import time
from math import cos, degrees, isnan, remainder, sin
from pathlib import Path

import rclpy
import yaml
from fourbar_msgs.msg import Extremum
from rclpy.experimental import EventsExecutor
from rich.live import Live

from fourbar_ros.scene import topics as interfaces, files as scene_file
from fourbar_ros.scene import scene as scenes
from fourbar_ros.scene.arguments import Parser, positive
from fourbar_ros.bag.recompute import recompute
from fourbar_ros.errors import FourBarError
from fourbar_ros.pipeline.status import STATUS_NAMES
from fourbar_ros.report.tables import (
    make_console,
    mode_name,
    plain_table,
    rate_unit,
    what_it_is,
)
from fourbar_ros.ros.messages import resolve, to_stamp

NODE = '/fourbar'
PATIENCE = 20.0        # [s] for the node to be found and to answer
SWING = 0.95           # share of a rocker's range that is swung through
REFRESH = 8            # live tables a second
KINDS = {Extremum.KIND_MINIMUM: 'minimum', Extremum.KIND_MAXIMUM: 'maximum', Extremum.KIND_CONSTANT: 'constant'}
SHORT = {'minimum': 'min', 'maximum': 'max', 'constant': 'const'}


class DemoError(FourBarError):
    """The demonstration could not go on; the message says at what."""


class Client:
    """The other side of the wire: a node of its own that listens, drives and asks."""

    def __init__(self, scene):
        rclpy.init()
        self.scene = scene
        self.node = rclpy.create_node('fourbar_demo')
        self.executor = EventsExecutor()
        self.executor.add_node(self.node)
        self.latest, self.received = {}, {}
        for name, topic in scene.topics.items():
            self.node.create_subscription(resolve(topic.type), topic.topic.replace('~', NODE),
                                          lambda message, name=name: self._take(name, message), 100)
        self.input = None
        if scene.drive.source != 'timer':
            topic = interfaces.INPUTS[scene.drive.source]
            self.input = self.node.create_publisher(resolve(topic.type), topic.topic.replace('~', NODE), 10)

    def _take(self, name, message):
        self.latest[name] = message
        self.received[name] = self.received.get(name, 0) + 1

    def spin(self, seconds):
        """Handle what comes in during some seconds."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0.0:
            self.executor.spin_once(timeout_sec=left)

    def given(self, seconds):
        """Return the input and its rates: constant speed, or a swing inside the range of what does not turn fully."""
        drive, linkage = self.scene.drive, self.scene.linkage
        if linkage.turns_fully:
            return drive.start + drive.speed * seconds, drive.speed, 0.0
        low, high = linkage.input_ranges[-1]
        middle, reach = 0.5 * (low + high), SWING * 0.5 * (high - low)
        rate = drive.speed / reach                      # the speed of the scene is that in the middle
        sine, cosine = reach * sin(rate * seconds), reach * cos(rate * seconds)
        return middle + sine, rate * cosine, -rate * rate * sine

    def drive(self, seconds):
        """Send one input, ``seconds`` after the start."""
        if not self.input:
            return
        drive = self.scene.drive
        message = resolve(interfaces.INPUTS[drive.source].type)()
        message.header.stamp = to_stamp(self.node.get_clock().now().nanoseconds)
        position, rate, acceleration = self.given(seconds)
        if drive.source == 'joint_state':
            message.name, message.position, message.velocity = [drive.joint], [position], [rate]
        else:
            message.position, message.velocity, message.acceleration = position, rate, acceleration
        self.input.publish(message)

    def ask(self, service_name, /, **request):
        """Return the answer of a service."""
        service = interfaces.SERVICES[service_name]
        kind = resolve(service.type)
        client = self.node.create_client(kind, service.service.replace('~', NODE))
        future = None
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            if future is None and client.service_is_ready():
                future = client.call_async(kind.Request(**request))
            if future is not None and future.done():
                return future.result()
            self.executor.spin_once(timeout_sec=0.02)
        raise DemoError(f'no answer from {service.service.replace("~", NODE)} in {PATIENCE:g} s')

    def close(self):
        """Leave the graph."""
        self.executor.shutdown()
        self.node.destroy_node()
        rclpy.try_shutdown()


def live_table(client, seconds):
    """Return the table of the newest messages."""
    table = plain_table(f'{NODE} at {seconds:4.1f} s', ('', '        value>', 'unit'))
    state, loads = client.latest.get('state'), client.latest.get('loads')

    def row(name, value, form, unit):
        if not isnan(value):                             # of another kind of linkage
            table.add_row(name.replace('_', ' '), format(value, form), unit)
    if state:
        table.add_row('status', STATUS_NAMES[state.status], '')
        for name in ('theta1', 'theta4', 'transmission_angle'):
            row(name, remainder(degrees(getattr(state, name)), 360.0), '.3f', 'deg')
        for name, unit in (('slide', 'm'), ('omega4', 'rad/s'), ('alpha4', 'rad/s^2'), ('slide_velocity', 'm/s'),
                           ('slide_acceleration', 'm/s^2')):
            row(name, getattr(state, name), '.5g', unit)
    if loads:
        for name, unit in (('f41', 'N'), ('f21', 'N'), ('f32', 'N'), ('f43', 'N'), ('driving_torque', 'N m'),
                           ('driving_force', 'N'), ('guide_force', 'N'), ('shaking_force', 'N'), ('shaking_moment', 'N m')):
            row(name, getattr(loads, name), '.3f', unit)
    for name, count in client.received.items():
        table.add_row(f'received {name}', str(count), 'messages')
    return table


def watch(client, node, seconds, console):
    """Show the stream for some seconds; raises DemoError if nothing comes or the node ends."""
    began = first = time.monotonic()
    with Live(console=console, refresh_per_second=REFRESH, transient=False) as live:
        while time.monotonic() - first < seconds:
            if node.poll() is not None:
                raise DemoError(f'the node ended with exit code {node.returncode}')
            if not client.received:
                first = time.monotonic()
                if first - began > PATIENCE:
                    raise DemoError(f'no message from {NODE} in {PATIENCE:g} s')
            client.drive(time.monotonic() - first)
            client.spin(0.01 if client.input else 1.0 / REFRESH)
            live.update(live_table(client, time.monotonic() - first))
    if not console.is_terminal:
        console.print()                                  # rich ends the last table of a terminal only


def published_for(path):
    """Return what is printed elsewhere for a scene file: entries of published/NAME beside it."""
    file = Path(path).parent / 'published' / Path(path).name
    return yaml.safe_load(file.read_text()) if file.exists() else []


def compare_extrema(client, published, console):
    """Ask for all extrema; print the global ones, and what was published beside them."""
    speed = client.scene.drive.speed
    answer = client.ask('find_extrema', velocity=speed)
    if answer.result != answer.RESULT_OK:
        console.print(f'find_extrema: {answer.message}')
        return
    table = plain_table(f'global extrema at {speed:g} {rate_unit(client.scene.linkage)}, mode {mode_name(client.scene.linkage)}, '
                        f'asked over {NODE}/find_extrema',
                        ('quantity', '', 'value>', 'unit', f'{client.scene.linkage.input_coordinate.position}>',
                         *(('published>', 'at>') if published else ())))
    notes = []
    for extremum in answer.extrema:
        if not extremum.is_global:
            continue
        kind = KINDS[extremum.kind]
        row = [extremum.quantity, SHORT[kind], f'{extremum.value:.9g}', extremum.unit, f'{extremum.theta1 if isnan(extremum.slide) else extremum.slide:.7f}']
        for entry in published:
            if (entry['quantity'], entry['kind']) == (extremum.quantity, kind):
                mark = ''
                if 'note' in entry:
                    notes.append(f'({len(notes) + 1}) {entry["source"]}: {entry["note"]}')
                    mark = f'({len(notes)}) '
                row += [f'{mark}{entry["value"]!r}', f'{entry["theta1"]!r}']
        table.add_row(*row)
    console.print(table)
    for note in notes:
        console.print(note)
    console.print()


def compare_poses(client, published, console):
    """Evaluate the published poses; print theirs beside ours."""
    for entry in published:
        if 'at' not in entry:
            continue
        answer = client.ask('evaluate', mode=entry['mode'], **entry['at'])
        table = plain_table(f'{entry["source"]}, mode {client.scene.linkage.MODES[entry["mode"]]}, asked over {NODE}/evaluate',
                            ('', 'ours>', 'published>'))
        for name, value in entry['values'].items():
            ours = getattr(answer.state, name.removesuffix('_deg'))
            table.add_row(name, f'{degrees(ours) if name.endswith("_deg") else ours:.6f}', f'{value!r}')
        console.print(table)
        console.print()


def check_bag(path, console):
    """Open a bag again, compute every value from its input; returns whether nothing differs."""
    found = recompute(path)
    messages = {difference.topic: difference.messages for difference in found}
    worst = max((difference.largest for difference in found), default=0.0)
    console.print(f'bag reopened: {sum(messages.values())} outputs on {len(messages)} topics recomputed from '
                  f'their recorded input, {len(found)} fields, largest difference {worst:g}', soft_wrap=True)
    return bool(messages) and worst == 0.0


def run(path, seconds, directory, console):
    """Run the whole demonstration; returns whether all of it was right."""
    path = scene_file.find(path)
    scene = scenes.load(path)
    published = published_for(path)
    console.print(what_it_is(scene.linkage, path))
    name = f'{Path(path).stem}_{time.strftime("%Y_%m_%d-%H_%M_%S")}'
    node = subprocess.Popen([sys.executable, '-m', 'fourbar_ros.ros.node.start', '--ros-args',
                             '--params-file', str(path), '-p', 'recording.start:=true',
                             '-p', f'recording.directory:={directory}', '-p', f'recording.name:={name}'])
    client = Client(scene)
    try:
        watch(client, node, seconds, console)
        compare_poses(client, published, console)
        compare_extrema(client, [p for p in published if 'quantity' in p], console)
    finally:
        client.close()
        node.send_signal(signal.SIGTERM)
        code = node.wait()
    console.print(f'node stopped by SIGTERM, exit code {code}')
    bag = Path(directory) / name
    good = check_bag(bag, console)
    console.print(f'bag: {bag}\nfor Foxglove and PlotJuggler: {bag / (name + "_0.mcap")}', soft_wrap=True)
    return good and code == 0


def main(args=None):
    """Parse arguments and run; exit code 0 only if the node and its bag were right."""
    parser = Parser(prog='fourbar_demo', description=__doc__)
    parser.add_argument('scene', help='parameter file (YAML), or name of a shipped scene, as paper')
    parser.add_argument('--seconds', type=positive, default=5.0, help='how long to stream (default 5)')
    parser.add_argument('--directory', default='bags', help='where the bag goes (default bags)')
    arguments = parser.parse_args(args)
    try:
        good = run(arguments.scene, arguments.seconds, arguments.directory, make_console())
    except FourBarError as error:
        print(f'fourbar_demo: {error}', file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0 if good else 1


if __name__ == '__main__':
    sys.exit(main())
