"""The mechanics, with numpy only: no ROS, no scipy, no files."""
from .bodies import Body, round_rod
from .errors import FourBarError, InvalidParameter, MissingBodies, OutOfRange, Toggle
from .kinematics import Motion
from .linkage import CROSSED, OPEN, Bodies, FourBar
from .loads import Loads

__all__ = ['Bodies', 'Body', 'CROSSED', 'FourBar', 'FourBarError', 'InvalidParameter', 'Loads',
           'MissingBodies', 'Motion', 'OPEN', 'OutOfRange', 'Toggle', 'round_rod']
