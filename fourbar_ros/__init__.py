# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Planar linkages: exact motion, loads and extrema. The library needs numpy only.

The names below are imported when they are first used: the node catches signals before numpy loads.
"""
from __future__ import annotations

from importlib import import_module
from typing import Any, TYPE_CHECKING

if TYPE_CHECKING:
    from fourbar_ros.errors import (
        FourBarError,
        InvalidParameter,
        MissingBodies,
        OutOfRange,
        Toggle,
    )
    from fourbar_ros.extrema.batch import find_extrema_many
    from fourbar_ros.extrema.find import find_extrema
    from fourbar_ros.mechanics.bodies import Applied, Bodies, Body, External, round_rod
    from fourbar_ros.mechanisms.contract import CROSSED, OPEN
    from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
    from fourbar_ros.mechanisms.four_bar.loads import Loads
    from fourbar_ros.mechanisms.four_bar.motion import Motion
    from fourbar_ros.mechanisms.inverted_slider_crank.inverted_slider_crank import InvertedSlider
    from fourbar_ros.mechanisms.points import point_motion
    from fourbar_ros.mechanisms.scotch_yoke.scotch_yoke import ScotchYoke
    from fourbar_ros.mechanisms.slider_crank.slider_crank import SliderCrank
    from fourbar_ros.scene.scene import load as load_scene

__version__ = '1.0.0'

_FACE = {
    'errors': ('FourBarError', 'InvalidParameter', 'MissingBodies', 'OutOfRange', 'Toggle'),
    'extrema.batch': ('find_extrema_many',),
    'extrema.find': ('find_extrema',),
    'mechanics.bodies': ('Applied', 'Bodies', 'Body', 'External', 'round_rod'),
    'mechanisms.four_bar.four_bar': ('FourBar',),
    'mechanisms.four_bar.loads': ('Loads',),
    'mechanisms.four_bar.motion': ('Motion',),
    'mechanisms.inverted_slider_crank.inverted_slider_crank': ('InvertedSlider',),
    'mechanisms.contract': ('CROSSED', 'OPEN'),
    'mechanisms.points': ('point_motion',),
    'mechanisms.scotch_yoke.scotch_yoke': ('ScotchYoke',),
    'mechanisms.slider_crank.slider_crank': ('SliderCrank',),
}
_MODULE_OF = {name: module for module, names in _FACE.items() for name in names}

__all__ = [
    'CROSSED', 'OPEN', 'Applied', 'Bodies', 'Body', 'External', 'FourBar', 'FourBarError',
    'InvalidParameter', 'InvertedSlider', 'Loads', 'MissingBodies', 'Motion', 'OutOfRange',
    'ScotchYoke', 'SliderCrank', 'Toggle', 'find_extrema', 'find_extrema_many', 'load_scene',
    'point_motion',
    'round_rod',
]


def __getattr__(name: str) -> Any:
    """Import the module that defines a public name when the name is first used."""
    if name == 'load_scene':
        return import_module('fourbar_ros.scene.scene').load
    if name not in _MODULE_OF:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return getattr(import_module(f'fourbar_ros.{_MODULE_OF[name]}'), name)


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted([*globals(), *__all__])
