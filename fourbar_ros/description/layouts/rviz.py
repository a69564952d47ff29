# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""An RViz configuration: description, frames and markers, seen from above."""
from __future__ import annotations

from typing import Any

from fourbar_ros.description.layouts.plots import full_name, NODE
from fourbar_ros.scene.scene import Scene

CLASSES = {'robot_description': ('RobotModel', 'Description Topic'),
           'tf': ('TF', None), 'markers': ('MarkerArray', 'Topic'),
           'traces': ('MarkerArray', 'Topic')}


def rviz(scene: Scene, node: str = NODE) -> str:
    """Return the configuration, YAML."""
    import yaml
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
