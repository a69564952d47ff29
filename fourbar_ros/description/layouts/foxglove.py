# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A layout for Foxglove and for Lichtblick, its open fork: the machine beside its plots.

Both read the same file. Curves are drawn over the stamps of the messages, so that all outputs of a
step stand at one time.
"""
from __future__ import annotations

import json
from typing import Any

from fourbar_ros.description.layouts.plots import full_name, NODE, plots_of
from fourbar_ros.scene.scene import Scene


def foxglove(scene: Scene, node: str = NODE) -> str:
    """Return the layout, JSON."""
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
    names = list(panels)
    machine = [name for name in names if name[0] == '3']
    plots = [name for name in names if name[0] == 'P']
    layout = _stack(plots)
    if machine:
        layout = ({'direction': 'row', 'first': machine[0], 'second': layout,
                   'splitPercentage': 50} if plots else machine[0])
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
    """Return panels one below the other, of the same height."""
    if len(names) < 2:
        return names[0] if names else ''
    return {'direction': 'column', 'first': names[0], 'second': _stack(names[1:]),
            'splitPercentage': 100.0 / len(names)}
