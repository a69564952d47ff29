# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
from glob import glob
from pathlib import Path
import re

from setuptools import find_packages, setup

NAME = 'fourbar_ros'
HERE = Path(__file__).resolve().parent      # colcon runs it through a link
# Scenes are installed in the package, to be found by name, and in share, as ROS does.
SCENES = [f'{NAME}.config', f'{NAME}.config.published', f'{NAME}.config.studies',
          f'{NAME}.config.robots', f'{NAME}.config.chains']

setup(
    name=NAME,
    version=re.search("__version__ = '(.+)'", (HERE / NAME / '__init__.py').read_text())[1],
    packages=find_packages(include=[NAME, NAME + '.*']) + SCENES,
    package_dir={SCENES[0]: 'config', SCENES[1]: 'config/published',
                 SCENES[2]: 'config/studies', SCENES[3]: 'config/robots',
                 SCENES[4]: 'config/chains'},
    package_data={NAME: ['py.typed'], f'{NAME}.reproduction': ['*.yaml'],
                  f'{NAME}.live': ['*.js'],
                  SCENES[0]: ['*.yaml'], SCENES[1]: ['*.yaml'], SCENES[2]: ['*.yaml'],
                  SCENES[3]: ['*.yaml'], SCENES[4]: ['*.yaml']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + NAME]),
        ('share/' + NAME, ['package.xml']),
        ('share/' + NAME + '/config', glob('config/*.yaml')),
        ('share/' + NAME + '/config/published', glob('config/published/*.yaml')),
        ('share/' + NAME + '/config/studies', glob('config/studies/*.yaml')),
        ('share/' + NAME + '/config/robots', glob('config/robots/*.yaml')),
        ('share/' + NAME + '/config/chains', glob('config/chains/*.yaml')),
        ('share/' + NAME + '/launch', glob('launch/*.launch.py')),
    ],
    python_requires='>=3.10',
    install_requires=['numpy>=1.26', 'pyyaml>=6', 'rich>=13'],
    extras_require={
        'bag': ['mcap>=1.5,<2', 'lz4', 'zstandard'],
        'parquet': ['pyarrow'],
        'plot': ['matplotlib'],
        'proof': ['python-flint'],
        'dynamics': ['scipy>=1.11'],
        'study': ['scipy>=1.11', 'pyarrow>=15', 'matplotlib', 'distributed'],
        'live': ['nicegui>=3.5,<4'],
        'test': ['pytest<9', 'mpmath', 'rosbags', 'mcap>=1.5,<2', 'lz4', 'zstandard',
                 'mcap-ros2-support>=0.6,<1', 'scipy', 'matplotlib', 'python-flint',
                 'yourdfpy', 'mujoco', 'pyarrow', 'distributed', 'coverage'],
    },
    zip_safe=False,
    maintainer='fourbar_ros developers',
    maintainer_email='fourbar-ros@users.noreply.github.com',
    description='Motion, loads and extrema of planar linkages in closed form, with a ROS 2 node.',
    long_description=(HERE / 'README.md').read_text(encoding='utf-8'),
    long_description_content_type='text/markdown',
    keywords=['four-bar linkage', 'slider-crank', 'mechanism', 'kinematics', 'dynamics', 'ROS 2'],
    classifiers=[
        'Development Status :: 4 - Beta',
        'Intended Audience :: Education',
        'Intended Audience :: Science/Research',
        'Operating System :: OS Independent',
        'Programming Language :: Python :: 3',
        'Programming Language :: Python :: 3.10',
        'Programming Language :: Python :: 3.11',
        'Programming Language :: Python :: 3.12',
        'Programming Language :: Python :: 3.13',
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
    },
)
