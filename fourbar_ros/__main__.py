"""``python -m fourbar_ros`` is ``fourbar``."""
import sys

from .cli import main

sys.exit(main())
