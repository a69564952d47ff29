# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The mechanisms by the names they have in scenes."""
from __future__ import annotations

from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.mechanisms.four_bar.moving_joint import MovingJointFourBar
from fourbar_ros.mechanisms.inverted_slider_crank.inverted_slider_crank import InvertedSlider
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.scotch_yoke.scotch_yoke import ScotchYoke
from fourbar_ros.mechanisms.slider_crank.slider_crank import SliderCrank

KINDS: dict[str, type[Mechanism]] = {
    'four_bar': FourBar, 'slider_crank': SliderCrank, 'inverted_slider': InvertedSlider,
    'scotch_yoke': ScotchYoke}
# {name: the same links, driven at joints that move}
AT_MOVING_JOINTS: dict[str, type[Mechanism]] = {'four_bar': MovingJointFourBar}


def kind_of(name: str, driven: str) -> type[Mechanism]:
    """Return the class of a kind ('four_bar', ...) for an input; A and B have their own."""
    other = AT_MOVING_JOINTS.get(name)
    return other if other and driven in other.INPUTS else KINDS[name]
