"""The mechanisms by the names they have in scenes."""
from __future__ import annotations

from .inverted_slider import InvertedSlider
from .linkage import FourBar
from .slider_crank import SliderCrank

KINDS = {'four_bar': FourBar, 'slider_crank': SliderCrank, 'inverted_slider': InvertedSlider}
