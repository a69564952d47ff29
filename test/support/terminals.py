# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Commands in a terminal of a given width, as a user sees them."""
import fcntl
import os
import pty
import re
import struct
import subprocess
import sys
import termios

from support import ROOT

COLORS = re.compile(r'\x1b\[[0-9;?]*[A-Za-z]')
NUMBER = re.compile(r'(?<![\w.…])-?(?:\d+\.?\d*(?:e[-+]\d+)?|inf|nan)(?![\w.…])')


def shown(arguments, width, **environment):
    """Return (standard output, exit code) of a command in a terminal of so many columns."""
    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack('HHHH', 50, width, 0, 0))
    given = {name: value for name, value in os.environ.items()
             if name not in ('COLUMNS', 'NO_COLOR')}
    process = subprocess.Popen(arguments, stdin=slave, stdout=slave, stderr=subprocess.DEVNULL,
                               cwd=ROOT,
                               env={**given, 'TERM': 'xterm', **environment})
    os.close(slave)
    text = b''
    while part := _read(master):
        text += part
    os.close(master)
    return COLORS.sub('', text.decode()).replace('\r', '\n'), process.wait()


def _read(master):
    try:
        return os.read(master, 65536)
    except OSError:         # the other side has ended
        return b''


def numbers(text):
    """Return all numbers of a text as they are written, sorted."""
    return sorted(NUMBER.findall(text))


def python(code):
    """Return the command that runs some Python."""
    return [sys.executable, '-c', code]
