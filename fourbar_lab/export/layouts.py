# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Layouts of a scene for RViz, Foxglove, Lichtblick and PlotJuggler.

They show the topics that the node of the scene publishes. Which curves belong into one plot
follows from its outputs alone.
"""
from __future__ import annotations

from collections.abc import Sequence
import json
from typing import Any, NamedTuple

from fourbar_ros.description.xml import add, as_text, Element
from fourbar_ros.scene.files import NODE
from fourbar_ros.scene.scene import Scene
import yaml

# {output: (class of RViz's display, its entry for the topic)}
CLASSES = {'robot_description': ('RobotModel', 'Description Topic'),
           'tf': ('TF', None), 'markers': ('MarkerArray', 'Topic'),
           'traces': ('MarkerArray', 'Topic')}
COLOURS = ('#1f77b4', '#d62728', '#1ac938', '#ff7f0e', '#9467bd', '#17becf', '#bcbd22')
ROWS = 3               # plots below each other on a tab of PlotJuggler
Titled = tuple[str, Sequence[tuple[str, str]]]      # title of a plot, (topic, field) of its curves


def rviz(scene: Scene, node: str = NODE) -> str:
    """Return an RViz configuration, YAML, that shows the pictures of a scene from above."""
    size = max(map(abs, scene.linkage.lengths))
    displays: list[dict[str, Any]] = [
        {'Class': 'rviz_default_plugins/Grid', 'Name': 'Grid', 'Enabled': True,
         'Cell Size': float(f'{size:.1g}'), 'Plane': 'XY'}]
    for name, topic in scene.pictures.items():
        kind, entry = CLASSES[name]
        display = {'Class': f'rviz_default_plugins/{kind}', 'Name': name, 'Enabled': True}
        if kind == 'RobotModel':
            display['Description Source'] = 'Topic'
        if entry:
            display[entry] = {'Value': full_name(topic.topic, node), 'Depth': 5,
                              'Durability Policy': 'Transient Local' if topic.latched else
                              'Volatile', 'Reliability Policy': 'Reliable'}
        displays.append(display)
    manager = {'Class': '', 'Displays': displays,
               'Global Options': {'Fixed Frame': scene.frame_id, 'Frame Rate': 30,
                                  'Background Color': '255; 255; 255'},
               'Views': {'Current': {'Class': 'rviz_default_plugins/TopDownOrtho',
                                     'Name': 'Current View', 'Target Frame': scene.frame_id,
                                     'Scale': float(f'{400.0 / size:.4g}'),
                                     'X': float(f'{0.5 * size:.4g}'), 'Y': 0.0}}}
    return str(yaml.safe_dump({'Panels': [{'Class': 'rviz_common/Displays', 'Name': 'Displays'},
                                          {'Class': 'rviz_common/Time', 'Name': 'Time'}],
                               'Visualization Manager': manager}, sort_keys=False))


def foxglove(scene: Scene, node: str = NODE) -> str:
    """
    Return a layout for Foxglove and for Lichtblick, its open fork, JSON: machine beside plots.

    Curves are drawn over the stamps of the messages, so that all outputs of a step stand at one
    time.
    """
    panels: dict[str, Any] = {}
    if scene.pictures:
        panels['3D!machine'] = _machine(scene, node)
    for number, plot in enumerate(plots_of(scene, node)):
        panels[f'Plot!{number}'] = {
            'title': plot.title, 'showLegend': True, 'legendDisplay': 'floating',
            'showXAxisLabels': True, 'showYAxisLabels': True, 'isSynced': True,
            'xAxisVal': 'timestamp',
            'paths': [{'value': f'{curve.topic}.{curve.field}', 'label': curve.label,
                       'enabled': True, 'timestampMethod': 'headerStamp'}
                      for curve in plot.curves]}
    plots = [name for name in panels if name.startswith('Plot!')]
    layout = _stack(plots)
    if scene.pictures:
        layout = ({'direction': 'row', 'first': '3D!machine', 'second': layout,
                   'splitPercentage': 50} if plots else '3D!machine')
    return json.dumps({'configById': panels, 'globalVariables': {}, 'userNodes': {},
                       'playbackConfig': {'speed': 1}, 'layout': layout}, indent=2) + '\n'


def _machine(scene: Scene, node: str) -> dict[str, Any]:
    """Return the settings of the panel that shows the machine, from above."""
    size = max(map(abs, scene.linkage.lengths))
    shown = {full_name(topic.topic, node): {'visible': True}
             for name, topic in scene.pictures.items() if name in ('markers', 'traces')}
    layers: dict[str, Any] = {'grid': {'layerId': 'foxglove.Grid', 'instanceId': 'grid',
                                       'visible': True, 'size': 4.0 * size, 'divisions': 20}}
    if 'robot_description' in scene.pictures:
        layers['urdf'] = {'layerId': 'foxglove.Urdf', 'instanceId': 'urdf', 'visible': True,
                          'sourceType': 'topic',
                          'topic': full_name(scene.pictures['robot_description'].topic, node)}
    return {'followTf': scene.frame_id, 'fixedFrame': scene.frame_id, 'topics': shown,
            'layers': layers, 'scene': {'labelScaleFactor': 0.1 * size},
            'cameraState': {'perspective': False, 'phi': 0.0, 'thetaOffset': 0.0,
                            'distance': 3.0 * size, 'targetOffset': [0.5 * size, 0.0, 0.0],
                            'target': [0.0, 0.0, 0.0], 'targetOrientation': [0, 0, 0, 1],
                            'fovy': 45, 'near': 0.01 * size, 'far': 100.0 * size}}


def _stack(names: list[str]) -> Any:
    """Return nested splits, each of two parts, that stack panels of equal height."""
    if len(names) < 2:
        return names[0] if names else ''
    return {'direction': 'column', 'first': names[0], 'second': _stack(names[1:]),
            'splitPercentage': 100.0 / len(names)}


def plotjuggler(scene: Scene, node: str = NODE) -> str:
    """Return a layout for PlotJuggler, XML: tabs of ROWS plots; curves are named TOPIC/FIELD."""
    root, plots = Element('root'), plots_of(scene, node)
    window = add(root, 'tabbed_widget', name='Main Window', parent='main_window')
    for first in range(0, len(plots), ROWS):
        part = plots[first:first + ROWS]
        tab = add(window, 'Tab', tab_name=part[0].title, containers='1')
        splitter = add(add(tab, 'Container'), 'DockSplitter', orientation='-',
                       count=str(len(part)),
                       sizes=';'.join([f'{1.0 / len(part):.6f}'] * len(part)))
        for plot in part:
            element = add(add(splitter, 'DockArea', name=plot.title), 'plot',
                          mode='TimeSeries', style='Lines')
            for number, curve in enumerate(plot.curves):
                add(element, 'curve', name=f'{curve.topic}/{curve.field.replace(".", "/")}',
                    color=COLOURS[number % len(COLOURS)])
    add(window, 'currentTabIndex', index='0')
    add(root, 'use_relative_time_offset', enabled='1')
    return as_text(root)


# --- plots ---------------------------------------------------------------------------------------

class Curve(NamedTuple):
    """A curve: full name of a topic, a field of its message with dots, the text of the legend."""

    topic: str
    field: str
    label: str


class Plot(NamedTuple):
    """Curves with one axis: its title with the unit."""

    title: str
    curves: tuple[Curve, ...]


def full_name(topic: str, node: str = NODE) -> str:
    """Return the full name: '~/state' of /left/leg is /left/leg/state, 'tf' is /left/tf."""
    if topic.startswith('~'):
        return node + topic[1:]
    return topic if topic.startswith('/') else f'{node.rpartition("/")[0]}/{topic}'


def plots_of(scene: Scene, node: str = NODE) -> list[Plot]:
    """Return the plots for the outputs of a scene; ``node``: full name of its node."""
    titled = [*_states(scene),
              ('angular velocity of links [rad/s]', _members(scene, 'links', 'angular_velocity')),
              ('angular acceleration of links [rad/s^2]',
               _members(scene, 'links', 'angular_acceleration')),
              *_loads(scene),
              ('reactions, x [N]', _members(scene, 'reactions', 'wrench.force.x')),
              ('reactions, y [N]', _members(scene, 'reactions', 'wrench.force.y')),
              ('speed of points [m/s]', _members(scene, 'points', 'speed')), *_output(scene)]
    return [Plot(title, tuple(Curve(full_name(topic, node), field, _label(topic, field))
                              for topic, field in curves))
            for title, curves in titled if curves]


def _label(topic: str, field: str) -> str:
    """Return the text of a legend: the field; of a topic '~/points/tip' 'tip' before it."""
    _, is_member, name = topic.removeprefix('~/').partition('/')
    return f'{name} {field.removeprefix("wrench.")}' if is_member else field


def _states(scene: Scene) -> list[Titled]:
    """Return plots of position, rate, acceleration of the joints, angles and slides apart."""
    if 'state' not in scene.topics:
        return []
    topic, fields = scene.topics['state'].topic, scene.layout.fields['state']
    coordinates = [*dict.fromkeys(joint.coordinate for joint in scene.linkage.JOINTS)]
    plots = []
    for unit in ('rad', 'm'):
        for i, (what, per) in enumerate((('position', ''), ('rate', '/s'),
                                         ('acceleration', '/s^2'))):
            names = [coordinate[i] for coordinate in coordinates if coordinate.unit == unit]
            plots.append((f'{what} [{unit}{per}]',
                          [(topic, name) for name in names if name in fields]))
    return [*plots, ('transmission angle [rad]', [(topic, 'transmission_angle')])]


def _loads(scene: Scene) -> list[Titled]:
    """Return plots of the forces at the joints, the drive, and the shaking moment."""
    if 'loads' not in scene.topics:
        return []
    topic, fields = scene.topics['loads'].topic, scene.layout.fields['loads']
    forces = [name for name in fields if name in (*scene.linkage.reactions, 'shaking_force')]
    others = [('driving force [N]', 'driving_force') if scene.linkage.is_driven_by_slide
              else ('driving torque [N m]', 'driving_torque'),
              ('shaking moment [N m]', 'shaking_moment')]
    return [('forces [N]', [(topic, name) for name in forces]),
            *((title, [(topic, name)]) for title, name in others if name in fields)]


def _members(scene: Scene, family: str, field: str) -> list[tuple[str, str]]:
    """Return (topic, field) for each topic of a family: 'points', 'links' or 'reactions'."""
    return [(topic.topic, field) for name, topic in scene.topics.items()
            if name.startswith(f'{family}/')]


def _output(scene: Scene) -> list[Titled]:
    """Return plots of the output's motion, if the scene does not send the whole state too."""
    if 'output' not in scene.topics or 'state' in scene.topics:
        return []
    topic = scene.topics['output'].topic
    return [(f'output: {field}', [(topic, field)])
            for field in ('position', 'velocity', 'acceleration')]
