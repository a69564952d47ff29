# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""fourbar_node: catches signals, then imports the node, which takes a while, and runs it."""
from __future__ import annotations

from collections.abc import Iterator, Sequence
import contextlib
import gc
import os
import re
import signal
import sys
from traceback import print_exc
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fourbar_ros.ros.node.node import FourBarNode

SIGNALS = 'SIGINT', 'SIGTERM', 'SIGHUP'
SWITCH = 0.001  # [s] how long a busy thread may hold the interpreter (Python: 5 ms)
USAGE = 'fourbar_node --ros-args --params-file SCENE'
NODE_NAME = re.compile(r'([A-Za-z_]\w*/)*[A-Za-z_]\w*')
RENAMES = re.compile(r'__(node|name):=')
HELP = """\
usage: fourbar_node [NODE ...] --ros-args --params-file SCENE
                    [-p NAME:=VALUE ...] [-r FROM:=TO ...]

The node of one linkage. SCENE is a parameter file, e.g. config/paper.yaml; fourbar scene check
SCENE explains it, docs/reference_robot.md and reference_desk.md list all parameters. Several
linkages of one robot run in one process: NODE ... are their names, as in the file. Exit codes: 0
stopped by a signal; 2 the scene is invalid.
"""

# A plain list, not an Event: a signal may come while the main thread holds the lock of that.
Signals = list[int]


@contextlib.contextmanager
def caught_signals() -> Iterator[Signals]:
    """Give the list of the signals that come meanwhile, but for a SIGHUP under ``nohup``."""
    caught: Signals = []
    before = {getattr(signal, name): signal.getsignal(getattr(signal, name))
              for name in SIGNALS if hasattr(signal, name)}      # Windows has no SIGHUP
    # a shell starts what a script puts in the background with SIGINT ignored: caught too
    for code, handler in before.items():
        if code != getattr(signal, 'SIGHUP', None) or handler is not signal.SIG_IGN:
            signal.signal(code, lambda code, _: caught.append(code))
    try:
        yield caught
    finally:
        for code, handler in before.items():
            signal.signal(code, handler)


def main() -> int:
    """Run the nodes of the command line; exit with 0 after a signal, 2 for an invalid scene."""
    with caught_signals() as signals:
        code = 1
        try:
            code = run(sys.argv[1:], signals)
        except ModuleNotFoundError:
            raise
        except Exception:
            print_exc()
        with contextlib.suppress(OSError):   # nobody may read it any more
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)   # while Python ends in its own way a second Ctrl-C would break it off


def run(arguments: Sequence[str], signals: Signals) -> int:
    """Run the nodes of these arguments until a signal has come; return the exit code."""
    if list(arguments) in (['-h'], ['--help']):
        print(HELP, end='')
        return 0
    from fourbar_ros.errors import FourBarError
    from fourbar_ros.ros.node.node import FourBarNode
    from fourbar_ros.ros.node.rclpy_guard import spin
    from fourbar_ros.ros.refusals import in_one_line, init
    from fourbar_ros.scene.files import sections
    import rclpy
    from rclpy.signals import SignalHandlerOptions

    nodes: list[FourBarNode] = []
    try:
        with in_one_line():
            for option, file in zip(arguments, arguments[1:]):
                if option == '--params-file':
                    sections(file)           # what is wrong with it, in better words than rcl's
            names, namespace = asked(arguments)
            init(arguments, signal_handler_options=SignalHandlerOptions.NO)
            for name in names:
                nodes.append(FourBarNode(name, namespace, arguments))
    except FourBarError as error:
        print(f'fourbar_node: {" ".join(str(error).split())}', file=sys.stderr)
        close(nodes)
        rclpy.try_shutdown()
        return 2
    warn_of_shared_frames(nodes)
    sys.setswitchinterval(SWITCH)
    gc.freeze()          # else each full collection stops the stream for 20 ms over the imports
    try:
        spin(nodes, signals)
    finally:
        close(nodes, 'the node ended' + (f' by {signal.Signals(signals[0]).name}' if signals
                                         else ''))
        rclpy.try_shutdown()
    return 0


def asked(arguments: Sequence[str]) -> tuple[list[str], str]:
    """Return (names of the nodes, namespace of all) of a command line, or FourBarError."""
    # Words before --ros-args are names of nodes. Without that argument a word is taken for a scene
    # that the user meant, and the message shows how a scene is given. Of several __ns:= ROS takes
    # the last one.
    from fourbar_ros.errors import FourBarError
    from rclpy.utilities import remove_ros_args

    names = remove_ros_args(list(arguments))
    for word in names:
        if '--ros-args' not in arguments or not NODE_NAME.fullmatch(word):
            usage = USAGE.replace('SCENE', word) if word[:1] != '-' else USAGE
            raise FourBarError(f'{word}: not understood; type  {usage}')
    if names and any(map(RENAMES.match, arguments)):
        raise FourBarError('__node:= would rename every node: name them before --ros-args alone')
    if len(set(names)) < len(names):
        raise FourBarError(f'{", ".join(names)}: two nodes of one name')
    namespaces = [word.partition(':=')[2] for word in arguments if word.startswith('__ns:=')]
    return names or ['fourbar'], namespaces[-1] if namespaces else ''


def warn_of_shared_frames(nodes: Sequence[FourBarNode]) -> None:
    """Warn where two nodes publish a TF frame of one name: it would jump between two poses."""
    publishers = [node for node in nodes
                  if {'tf', 'tf_static'} & node.stream.scene.pictures.keys()]
    if len(publishers) < 2:
        return
    from fourbar_ros.ros.node.pictures import frames_of
    owners: dict[str, str] = {}              # {frame: node}
    for node in publishers:
        frames = frames_of(node.stream.scene)
        shared = sorted(frames & owners.keys())
        if shared:
            node.get_logger().warning(
                f'frames {", ".join(shared)}: also of {owners[shared[0]]}; frame_id and '
                'joint_states.prefix keep them apart')
        owners.update(dict.fromkeys(frames, node.get_name()))


def close(nodes: Sequence[FourBarNode], why: str = 'the node ended') -> None:
    """Close all nodes, even if one of them raises; ``why`` goes into their bags."""
    with contextlib.ExitStack() as stack:
        for node in nodes:
            stack.callback(node.close, why)


if __name__ == '__main__':
    sys.exit(main())
