# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One scene in one of the formats: URDF here, MJCF by fourbar_lab."""
from fourbar_ros.description.model import model_of, NoDescription
from fourbar_ros.description.urdf import urdf
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.optional import lab
from fourbar_ros.scene.scene import Scene

FORMATS = 'urdf', 'mjcf'


def check_pictures(scene: Scene) -> None:
    """Raise NoDescription if a scene names pictures that cannot be made for it."""
    if {'robot_description', 'tf'} & scene.pictures.keys():
        model_of(scene)
    if 'robot_description' in scene.pictures:
        describe(scene)


def describe(scene: Scene, format_: str = 'urdf') -> str:
    """
    Return a scene as URDF or MJCF.

    Raises InvalidParameter for an unknown format, NoDescription if the format cannot hold the
    scene, ModuleNotFoundError for MJCF without fourbar_lab.
    """
    if format_ not in FORMATS:
        raise InvalidParameter('format', format_, f'must be one of {", ".join(FORMATS)}')
    ratios = [('joint_states.ratios', name, ratio)
              for name, ratio in zip(scene.joint_names, scene.joint_states.ratios)]
    if scene.drive.source == 'joint_state':
        ratios.append(('drive.joint_ratio', scene.drive.joint, scene.drive.joint_ratio))
    for parameter, name, ratio in ratios:
        if abs(ratio) != 1.0:
            raise NoDescription(f'{parameter}: a description has no gears, so the ratio of {name} '
                                f'must be 1 or -1, not {ratio:g}; use the output tf instead')
    write = urdf if format_ == 'urdf' else lab(format_)
    return str(write(model_of(scene)))
