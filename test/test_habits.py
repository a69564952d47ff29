# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Lists that nobody reads are right: versions and dependencies."""
from functools import cache
from pathlib import Path
import re
import subprocess
import sys

ROOT = Path(__file__).parent.parent
# Distribution or package.xml name of each import that has another name than its package.
NAMES = {'yaml': 'pyyaml', 'flint': 'python-flint', 'mcap_ros2': 'mcap-ros2-support',
         'foxglove': 'foxglove-sdk', 'axe_core_python': 'axe-core-python'}
OURS = ('fourbar_ros', 'fourbar_lab', 'bench', 'support')


def text(path):
    return (ROOT / path).read_text(encoding='utf-8')


@cache
def packages_imported(folder):
    """Return the top names of all modules that Python files in a folder import."""
    found = ' '.join(text(path) for path in (ROOT / folder).rglob('*.py'))
    return {one or other for one, other in re.findall(
        r'^ *(?:import (\w+)|from (\w+)[\w.]* import )', found, re.M)}


def third_party(*folders):
    imported = set().union(*map(packages_imported, folders))
    return sorted(imported - set(sys.stdlib_module_names) - set(OURS))


def ros_depends():
    return set(re.findall(r'<(?:exec_|test_)?depend>([^<]+)<', text('package.xml')))


def test_the_version_stands_in_one_place_and_its_copies_agree():
    version = re.search(r"^__version__ = '([^']+)'$", text('fourbar_ros/__init__.py'), re.M)[1]
    for file in ('package.xml', 'msg_defs/package.xml', 'scripts/tf2_msgs/package.xml'):
        assert re.findall('<version>([^<]+)</version>', text(file)) == [version], file
    assert re.findall('^version: (.+)$', text('CITATION.cff'), re.M) == [version]
    done = subprocess.run([sys.executable, 'setup.py', '--version'], cwd=ROOT, check=True,
                          capture_output=True, text=True)
    assert done.stdout.split()[-1] == version
    assert f'\n## {version}' in text('CHANGELOG.md') or '\n## Unreleased' in text('CHANGELOG.md')


def test_what_the_product_imports_is_declared():
    ros = ros_depends()
    for name in third_party('fourbar_ros', 'fourbar_lab', 'launch'):
        distribution = NAMES.get(name, name)
        assert (name in ros or f'python3-{name}' in ros
                or distribution in text('setup.py')), name


def test_every_message_package_that_is_imported_is_in_package_xml():
    packages = {name for name in third_party('fourbar_ros', 'fourbar_lab', 'launch')
                if name.endswith(('_msgs', '_interfaces')) or name in ('rclpy', 'launch_ros')}
    assert packages <= ros_depends(), packages - ros_depends()


def requirements(*extras):
    """Return the names of the distributions that setup.py asks for."""
    done = subprocess.run([sys.executable, 'scripts/requirements.py', *extras], cwd=ROOT,
                          check=True, capture_output=True, text=True)
    return {re.split(r'[\[<>=]', line)[0] for line in done.stdout.splitlines()}


def test_what_is_installed_is_pinned():
    pinned = set(re.findall('^([^#=]+)==', text('scripts/constraints.txt'), re.M))
    asked = requirements('ros', 'plot', 'test', 'docs', 'lint')
    assert asked <= pinned, asked - pinned
    assert pinned <= asked | requirements('run', 'bag', 'dynamics'), pinned - asked
