# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The page of a scene in the browser; needs starlette and uvicorn. Press Enter to end it.

You see the mechanism, its curves and forces, and a field for each parameter.
"""
import re
import subprocess
import sys
from time import sleep
from urllib.request import urlopen

server = subprocess.Popen(
    [sys.executable, '-u', '-m', 'fourbar_ros', 'live', 'paper', '--no-browser'],
    stdout=subprocess.PIPE, text=True)
try:
    for line in server.stdout:
        if address := re.search(r'http://\S+', line):
            break
    else:
        sys.exit('the page did not start')
    page = ''
    while not page and server.poll() is None:
        try:
            page = urlopen(address[0], timeout=60).read().decode()
        except OSError:             # it names its address just before it listens
            sleep(0.2)
    print(address[0], re.search('<title>(.*?)</title>', page)[1], flush=True)
    sys.stdin.readline()
finally:
    server.terminate()
    print('ended with', server.wait(60))
