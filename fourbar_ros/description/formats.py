# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One scene in one of the formats."""
from __future__ import annotations

from fourbar_ros.description.mjcf import mjcf
from fourbar_ros.description.model import model_of, NoDescription
from fourbar_ros.description.sdf import sdf
from fourbar_ros.description.urdf import urdf
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.scene.scene import Scene

FORMATS = {'urdf': urdf, 'sdf': sdf, 'mjcf': mjcf}


def check_pictures(scene: Scene) -> None:
    """Raise NoDescription if a scene names pictures that cannot be made for it."""
    if {'robot_description', 'tf'} & scene.pictures.keys():
        model_of(scene)
    if 'robot_description' in scene.pictures:
        describe(scene)


def describe(scene: Scene, format_: str = 'urdf') -> str:
    """
    Return a scene as URDF, SDF or MJCF.

    Raises
    ------
    InvalidParameter
        For an unknown format.
    NoDescription
        If the format cannot hold the scene.

    """
    if format_ not in FORMATS:
        raise InvalidParameter('format', format_, f'must be one of {", ".join(FORMATS)}')
    for name, ratio in zip(scene.joint_names, scene.joint_states.ratios):
        if abs(ratio) != 1.0:
            raise NoDescription('joint_states.ratios: a description has no gears, so the ratio '
                                f'of {name} must be 1 or -1, not {ratio:g}')
    return FORMATS[format_](model_of(scene))
