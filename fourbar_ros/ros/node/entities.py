# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Publishers, subscriptions, clock, troubles and threads, as all files of the node use them."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache, wraps
from queue import Full, Queue
import threading
import time
from traceback import format_exc
from typing import Any

from fourbar_ros.errors import FourBarError, InvalidParameter, nearest
from fourbar_ros.ros.messages import Message, resolve
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import FAMILIES, INPUT_DEPTH, OUTPUTS, PICTURES, QUEUE_DEPTH, Topic
from rclpy import qos
from rclpy.clock import Clock, ClockType
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.serialization import deserialize_message
from rclpy.subscription import Subscription

OVERRIDES = 'qos_overrides.'       # a user's parameters: qos_overrides.TOPIC.publisher.depth
QUIET = 10.0                       # [s] between two lines of one cause in the log

WAITING = 8                        # most jobs that wait for one thread


def publisher(node: Node, topic: Topic, **options: Any) -> Publisher:
    """Return a publisher on a topic with its QoS, latched or not, and the user's overrides."""
    profile = qos.QoSProfile(depth=QUEUE_DEPTH)
    if topic.latched:
        profile = qos.QoSProfile(depth=1, durability=qos.DurabilityPolicy.TRANSIENT_LOCAL)
    with _refused(node, topic):
        return node.create_publisher(resolve(topic.type), topic.topic, profile, **options,
                                     qos_overriding_options=_overrides(node, 'publisher', topic))


def subscription(node: Node, topic: Topic, take: Callable[..., None], troubles: Troubles,
                 is_reliable: bool = False, events: SubscriptionEventCallbacks | None = None
                 ) -> Subscription:
    """
    Return a subscription on a topic with the user's overrides; ``take`` gets serialised messages.

    By default it is best effort, which matches publishers of any reliability. A publisher with
    another policy that does not match is a trouble.
    """
    def note(info: Any) -> None:
        name = qos.qos_policy_name_from_kind(info.last_policy_kind).lower()
        troubles.incompatible[topic.name] = name
        troubles.count('incompatible_publishers', f'{topic.topic}: nothing is received from a '
                       f'publisher with an incompatible {name}')
    troubles.counts.setdefault('incompatible_publishers', 0)
    events = events or SubscriptionEventCallbacks()
    events.incompatible_qos = note
    policy = qos.ReliabilityPolicy.RELIABLE if is_reliable else qos.ReliabilityPolicy.BEST_EFFORT
    with _refused(node, topic):
        return node.create_subscription(
            resolve(topic.type), topic.topic, take,
            qos.QoSProfile(depth=INPUT_DEPTH, reliability=policy), raw=True,
            event_callbacks=events,
            qos_overriding_options=_overrides(node, 'subscription', topic))


class SequenceNumbers:
    """
    Counts the messages that were lost on one topic, by gaps in their sequence numbers.

    Every publisher counts its messages, but a message does not name its publisher. So the next
    number of each publisher is kept; a number that fits none leaves a gap behind the nearest
    below. With several publishers a gap may be counted for the wrong publisher; the sum is right.
    ``publishers()`` returns how many there are. ``is_numbered`` is False with a middleware that
    gives no sequence numbers: then nothing is known.
    """

    def __init__(self, publishers: Callable[[], int]) -> None:
        self._publishers = publishers
        self._next: list[int] = []       # the number that each publisher will give next
        self._heard: set[int] = set()    # indices there of those that sent lately
        self.is_numbered = True

    def forget(self) -> None:
        """Start anew: publishers have come or gone."""
        self._next, self._heard = [], set()

    def heard(self) -> int:
        heard, self._heard = self._heard, set()
        return len(heard)

    def lost_before(self, sequence: int | None) -> int:
        """
        Return how many messages were lost before one with this number, None if it has none.

        The number due from each publisher is known; another one leaves a gap behind the nearest.
        """
        if sequence is None:
            self.is_numbered = False
            return 0
        lost = 0
        expected = self._next
        if sequence in expected:
            publisher = expected.index(sequence)
        elif len(expected) < self._publishers():
            publisher = len(expected)                    # its first message
            expected.append(sequence)
        elif before := [due for due in expected if due < sequence]:
            lost = sequence - max(before)                # 5, 6, 9: 7 and 8 are lost
            publisher = expected.index(max(before))
        else:
            publisher, self._next = 0, [sequence]        # a publisher that has started again
            self._heard.clear()
        self._next[publisher] = sequence + 1
        self._heard.add(publisher)
        return lost


def counted_subscription(
        node: Node, topic: Topic, take: Callable[[bytes, int], None], troubles: Troubles,
        is_reliable: bool = False, deadline: Callable[[Any], None] | None = None
        ) -> tuple[Subscription, SequenceNumbers]:
    """
    Return a subscription as of :func:`subscription`, and its sequence numbers.

    ``take`` is called with each message and how many were lost since the one before; ``deadline``
    with the event of a missed deadline, which not every middleware knows.
    """
    sequence = SequenceNumbers(lambda: made.get_publisher_count())
    events = SubscriptionEventCallbacks(matched=lambda _: sequence.forget())
    if deadline:
        events.deadline = deadline

    def receive(data: bytes, info: dict[str, Any]) -> None:
        take(data, sequence.lost_before(info['publication_sequence_number']))

    # rclpy sees by the signature of receive that it wants the info. Its EventsExecutor then passes
    # both as one tuple (rclpy 7.1.5), other executors, and later ones, as two arguments.
    @wraps(receive)
    def from_any_executor(*arguments: Any) -> None:
        receive(*(arguments if len(arguments) == 2 else arguments[0]))

    made = subscription(node, topic, from_any_executor, troubles, is_reliable, events)
    return made, sequence


def check_qos_overrides(node: Node, scene: Scene) -> None:
    """Refuse overrides of topics that the node has not, and of policies that ROS does not know."""
    later = [topic for name, topic in {**OUTPUTS, **PICTURES}.items() if name not in FAMILIES]
    topics = {'publisher': [*scene.published, *later], 'subscription': scene.received}
    known = {f'{node.resolve_topic_name(topic.topic)}.{entity}.{kind.lower()}'
             for entity, those in topics.items() for topic in those
             for kind in qos.QoSPolicyKind.__members__ if kind != 'INVALID'
             and (entity, kind) != ('subscription', 'LIFESPAN')}
    for name, parameter in node.get_parameters_by_prefix(OVERRIDES.rstrip('.')).items():
        if name not in known:
            raise InvalidParameter(f'{OVERRIDES}{name}', parameter.value,
                                   f'no such quality of service{nearest(name, known)}')


def has_override(node: Node, entity: str, topic: Topic, policy: str) -> bool:
    name = node.resolve_topic_name(topic.topic)
    return bool(node.has_parameter(f'{OVERRIDES}{name}.{entity}.{policy}'))


def reader(topic: Topic, take: Callable[[Message], object], refuse: Callable[[str], object]
           ) -> Callable[[bytes], None]:
    """Return the function of bytes that calls ``take(message)``, or ``refuse(why)`` if bad."""
    kind = resolve(topic.type)

    def read(data: bytes) -> None:
        try:
            message = deserialize_message(data, kind)
        except Exception:        # whatever ROS raises for bytes that it cannot read
            refuse(f'{topic.topic}: a message that is no {topic.type}')
        else:
            take(message)
    return read


@contextmanager
def _refused(node: Node, topic: Topic) -> Iterator[None]:
    """Name the overrides of a topic in one line where ROS refuses to create it with them."""
    prefix = f'{OVERRIDES}{node.resolve_topic_name(topic.topic)}.'
    try:
        yield
    except (AssertionError, RuntimeError, TypeError, ValueError) as error:
        overrides = {name: parameter.value for name, parameter
                     in node.get_parameters_by_prefix(prefix.rstrip('.')).items()}
        if not overrides:
            raise
        raise FourBarError(f'{prefix}*: {overrides}: {error}') from None


def _overrides(node: Node, entity: str, topic: Topic) -> QoSOverridingOptions:
    """Return the policies that the user gives, so that rclpy declares no others."""
    return QoSOverridingOptions([kind for kind in qos.QoSPolicyKind.__members__.values()
                                 if has_override(node, entity, topic, kind.name.lower())])


def clock_of(node: Node) -> tuple[Clock, Callable[[], int]]:
    """Return the clock of silences and samples, simulated or steady, and its reading [ns]."""
    if not node.get_parameter('use_sim_time').value:
        return Clock(clock_type=ClockType.STEADY_TIME), time.monotonic_ns
    clock = node.get_clock()
    return clock, lambda: int(clock.now().nanoseconds)


class Troubles:
    """
    What goes wrong in a node: a line of each cause in ten seconds, and ``counts``.

    The counts {cause: how often since the start} are for the diagnostics; ``incompatible``: {short
    name of a topic: policy} of the last publisher that did not match.
    """

    def __init__(self, node: Node) -> None:
        self._child = cache(node.get_logger().get_child)
        self.counts: dict[str, int] = {}
        self.incompatible: dict[str, str] = {}

    def expect(self, *causes: str) -> None:
        self.counts |= dict.fromkeys(causes, 0)

    def count(self, cause: str, text: str = '') -> None:
        """Count a cause once more; log a text of it, if there is one."""
        self.counts[cause] += 1
        if text:
            self.log(cause, text)

    def log(self, cause: str, text: str, level: str = 'warning') -> None:
        """Log a text, unless one of this cause was logged just now."""
        getattr(self._child(cause), level)(text, throttle_duration_sec=QUIET)


# --- threads for slow jobs, as long services, while the executor goes on with inputs -------------

class Abandoned(FourBarError):
    """The node stops before the work is done."""


class Worker:
    """A thread that does one job after the other; ``tell(text)``: when a job has raised."""

    def __init__(self, name: str, tell: Callable[[str], object], waiting: int = WAITING) -> None:
        self._jobs: Queue[Callable[[], object] | None] = Queue(waiting)
        self._stopping, self._tell = False, tell
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def do(self, job: Callable[[], object]) -> bool:
        """Queue a job; return False if too many wait."""
        try:
            self._jobs.put_nowait(job)
        except Full:
            return False
        return True

    @property
    def is_this_thread(self) -> bool:
        return threading.current_thread() is self._thread

    def check(self) -> None:
        """Raise Abandoned if the node stops; long jobs call it between their pieces."""
        if self._stopping:
            raise Abandoned('abandoned: the node stops')

    def abandon(self) -> None:
        """Make the running job give up at its next :meth:`check`; begin no other."""
        self._stopping = True
        with suppress(Full):                 # then it sees that at its next job
            self._jobs.put_nowait(None)

    def stop(self, patience: float | None = None) -> None:
        """Abandon the running job and wait for its end, up to ``patience`` [s]."""
        self.abandon()
        self._thread.join(patience)

    def _run(self) -> None:
        while (job := self._jobs.get()) and not self._stopping:
            try:
                job()
            except Exception:                            # the next job is done all the same
                if not self._stopping:       # else the service may be gone, to which it answers
                    self._tell(f'a fault in {self._thread.name}: {format_exc()}')
