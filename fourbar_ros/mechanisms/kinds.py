# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The kinds of mechanisms by the names that they have in scenes."""
from fourbar_ros.mechanisms.four_bars import FourBar, MovingJointFourBar
from fourbar_ros.mechanisms.kind import Kind
from fourbar_ros.mechanisms.sliders import InvertedSlider, ScotchYoke, SliderCrank

KINDS: dict[str, type[Kind]] = {'four_bar': FourBar, 'slider_crank': SliderCrank,
                                'inverted_slider': InvertedSlider, 'scotch_yoke': ScotchYoke}


def kind_of(name: str, driven: str) -> type[Kind]:
    """Return the class of a kind ('four_bar', ...) for an input; A and B have their own."""
    kind = KINDS[name]
    return MovingJointFourBar if kind is FourBar and driven in MovingJointFourBar.INPUTS else kind
