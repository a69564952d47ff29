"""The mechanics, with numpy only: no ROS, no scipy, no files."""
from .bodies import Applied, Bodies, Body, External, round_rod
from .errors import FourBarError, InvalidParameter, MissingBodies, OutOfRange, Toggle
from .kinematics import Motion
from .inverted_slider import InvertedSlider
from .linkage import FourBar
from .loads import Loads
from .mechanism import CROSSED, OPEN
from .slider_crank import SliderCrank

__all__ = ['Applied', 'Bodies', 'Body', 'CROSSED', 'External', 'FourBar', 'FourBarError', 'InvalidParameter',
           'InvertedSlider', 'Loads', 'MissingBodies', 'Motion', 'OPEN', 'OutOfRange', 'SliderCrank', 'Toggle',
           'round_rod']
