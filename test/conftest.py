"""Isolation: every test run has its own ROS domain on this machine only, and its own folders."""
import atexit
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

_scratch = tempfile.mkdtemp(prefix='fourbar_test_')
atexit.register(shutil.rmtree, _scratch, ignore_errors=True)
os.environ['ROS_LOG_DIR'] = _scratch
os.environ['ROS_PYTHON_CHECK_FIELDS'] = '1'
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
os.environ['ROS_DOMAIN_ID'] = str(1 + os.getpid() % 100)
os.environ['PYTHONFAULTHANDLER'] = '1'

sys.path.insert(0, str(Path(__file__).parent))


def pytest_sessionfinish(session, exitstatus):
    """Remove the shared memory that killed nodes leave behind (safe while others run)."""
    if shutil.which('fastdds'):
        subprocess.run(['fastdds', 'shm', 'clean'], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                       check=False)
