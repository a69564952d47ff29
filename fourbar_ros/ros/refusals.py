# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What ROS refuses, as an error of one line."""
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from fourbar_ros.errors import FourBarError
import rclpy
from rclpy.exceptions import NameValidationException, ParameterException
from rclpy.impl.implementation_singleton import rclpy_implementation

UNKNOWN = rclpy_implementation.UnknownROSArgsError
# a file that rcl cannot parse, names that are not valid, another type for a parameter
ERRORS = rclpy_implementation.RCLError, UNKNOWN, NameValidationException, ParameterException


@contextmanager
def in_one_line() -> Iterator[None]:
    """Raise FourBarError for arguments, names and parameters that ROS refuses."""
    try:
        yield
    except ERRORS as error:
        raise FourBarError(f'ROS 2 knows no argument {error}' if isinstance(error, UNKNOWN)
                           else ' '.join(str(error).split()).removesuffix(' ^')) from None


def init(arguments: Sequence[str] = (), **options: Any) -> None:
    """Initialise ROS with these arguments and the ``options`` of rclpy.init, or FourBarError."""
    if rclpy.ok():
        raise FourBarError('rclpy is initialised already in this program')
    with in_one_line():
        try:
            rclpy.init(args=['fourbar', *arguments], **options)
        except ERRORS:
            raise
        except RuntimeError as error:        # of rclpy's own, without a type
            raise FourBarError(f'no log (ROS_LOG_DIR): {error}') from None
