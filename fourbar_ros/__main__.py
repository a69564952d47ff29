"""``python -m fourbar_ros`` is ``fourbar``."""
import sys

from fourbar_ros.cli.main import main

sys.exit(main())
