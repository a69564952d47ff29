"""The mechanics, with numpy only: no ROS, no scipy, no files."""
from .bodies import Applied, Body, round_rod
from .errors import FourBarError, InvalidParameter, MissingBodies, OutOfRange, Toggle
from .kinematics import Motion
from .linkage import CROSSED, OPEN, Bodies, External, FourBar
from .loads import Loads

__all__ = ['Applied', 'Bodies', 'Body', 'CROSSED', 'External', 'FourBar', 'FourBarError', 'InvalidParameter',
           'Loads', 'MissingBodies', 'Motion', 'OPEN', 'OutOfRange', 'Toggle', 'round_rod']
