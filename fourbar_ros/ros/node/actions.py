# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The search for extrema as an action: with feedback, and it can be canceled."""
from __future__ import annotations

from collections.abc import Callable
from traceback import format_exc

from fourbar_ros.ros.messages import Message, resolve
from fourbar_ros.ros.node.base import Base
from fourbar_ros.ros.node.extrema import Canceled, Search
from fourbar_ros.scene.topics import FIND_EXTREMA
from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import ServerGoalHandle


class ExtremaServer(ActionServer):
    """
    The action server of a node; goals wait for the worker that also answers the service.

    rclpy would execute a goal in the executor, which could then take neither inputs nor a request
    to cancel.
    """

    def __init__(self, node: Base) -> None:
        self._owner, self._worker = node, node.workers['search']
        super().__init__(node, resolve(FIND_EXTREMA.type), FIND_EXTREMA.service, self._answer,
                         cancel_callback=lambda _: CancelResponse.ACCEPT)

    def notify_execute(self, goal_handle: ServerGoalHandle,
                       execute_callback: Callable[[ServerGoalHandle], Message] | None) -> None:
        """Queue a goal for the worker: rclpy would run an accepted one in its executor."""
        def run() -> None:
            """Answer the goal, in the worker's thread."""
            try:         # rclpy's coroutine of a goal; ours never waits, so one send completes it
                self._execute_goal(execute_callback or self._answer, goal_handle).send(None)
            except StopIteration:
                pass
            except Exception:                            # the client is gone, or the node
                self._owner.get_logger().debug(f'a goal of find_extrema: {format_exc()}')
        self._worker.do(run)

    def _answer(self, goal: ServerGoalHandle) -> Message:
        """Search for a goal's extrema, send feedback, set its final state, return the result."""
        kind = self.action_type

        def check() -> None:
            if goal.is_cancel_requested:
                raise Canceled('canceled: the extrema are those found before')
            self._worker.check()

        def progress(quantity: str, mode: int, done: int, total: int, found: int) -> None:
            check()
            goal.publish_feedback(kind.Feedback(quantity=quantity, mode=mode, done=done,
                                                total=total, found=found))

        result = kind.Result()
        try:
            result = Search(self._owner.stream.scene, goal.request, check).answer(result, progress)
        except Exception as error:           # a fault of ours: report it, the stream goes on
            self._owner.get_logger().error(f'a fault in find_extrema: {format_exc()}')
            result.result = result.RESULT_INVALID_REQUEST
            result.message = f'a fault in the node, see its log: {error!r}'
        if goal.is_cancel_requested:
            goal.canceled()
        elif result.result == result.RESULT_OK:
            goal.succeed()
        else:
            goal.abort()
        return result
