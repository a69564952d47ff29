# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Print requirements of setup.py, without setuptools: requirements.py run EXTRA ..."""
from pathlib import Path
import runpy
import sys
from types import SimpleNamespace

found = {}
sys.modules['setuptools'] = SimpleNamespace(find_packages=lambda **_: [], setup=found.update)
runpy.run_path(str(Path(__file__).resolve().parent.parent / 'setup.py'))
for name in sys.argv[1:]:
    print(*(found['install_requires'] if name == 'run' else found['extras_require'][name]),
          sep='\n')
