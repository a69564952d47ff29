from glob import glob

from setuptools import find_packages, setup

package_name = 'fourbar_ros'

setup(
    name=package_name,
    version='0.1.0',
    packages=find_packages(include=[package_name, package_name + '.*']),
    package_data={package_name: ['*.yaml']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        ('share/' + package_name + '/config', glob('config/*.yaml')),
        ('share/' + package_name + '/config/published', glob('config/published/*.yaml')),
        ('share/' + package_name + '/launch', glob('launch/*.launch.py')),
    ],
    python_requires='>=3.10',
    install_requires=['setuptools', 'numpy>=1.26', 'pyyaml>=6', 'rich>=13'],
    extras_require={
        'bag': ['mcap>=1.5,<2', 'lz4', 'zstandard'],
        'parquet': ['pyarrow'],
        'plot': ['matplotlib'],
        'proof': ['python-flint'],
        'test': ['pytest<9', 'mpmath', 'rosbags', 'mcap-ros2-support>=0.6,<1', 'hypothesis', 'scipy', 'matplotlib'],
    },
    zip_safe=True,
    maintainer='fourbar_ros developers',
    maintainer_email='fourbar-ros@users.noreply.github.com',
    description='Exact motion, loads and extrema of planar four-bar linkages, with a ROS 2 node.',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'fourbar = fourbar_ros.cli:main',
            'fourbar_node = fourbar_ros.ros.start:main',
            'fourbar_demo = fourbar_ros.ros.demo:main',
        ],
    },
)
