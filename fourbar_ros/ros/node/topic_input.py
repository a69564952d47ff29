# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Drive the input by the messages of a topic; missing rates are estimated."""
from math import isnan
from traceback import format_exc
from typing import Any

from fourbar_ros.pipeline import joints, rate_estimator
from fourbar_ros.ros.messages import Message, sec_nanosec, Stamp
from fourbar_ros.ros.node import clock_input, entities
from fourbar_ros.ros.node.joint_senders import JointSenders
from fourbar_ros.ros.node.stream import Stream
from fourbar_ros.scene.message_fields import driven_of, nanoseconds
from fourbar_ros.scene.topics import INPUTS
from rclpy.node import Node

WATCH = 0.1            # [s] how often silence is looked for
SILENT = 2.0           # [s] without a first message after which the diagnostics warn
FUTURE = 1.0           # [s] stamps further ahead of our clock are counted and logged
RESTARTED = ('the estimate of missing rates starts afresh: after a pause above drive.timeout, a '
             'step above drive.jump{}, or a clock set back')
WRAPS = ' (for positions that wrap after a turn give drive.top_speed)'


class TopicInput:
    """One step for each input message, with its stamp; missing rates are estimated."""

    def __init__(self, node: Node, stream: Stream, troubles: entities.Troubles) -> None:
        """Subscribe to the input of a scene; the estimate of its missing rates begins."""
        self._node, self._stream, self._troubles = node, stream, troubles
        self._counts = troubles.counts
        troubles.expect('received', 'lost', 'malformed', 'without_joint', 'of_other_joints',
                        'bad_stamps', 'future', 'late', 'estimate_restarts', 'timeouts',
                        'deadlines_missed', 'turns_in_doubt', 'faults')
        self._scene = scene = stream.scene   # of the last input
        self._settings = settings = scene.drive      # topic, joint and gear: they stay
        self._topic = INPUTS[settings.source]
        self._scale = joints.Scale(settings.joint_ratio, settings.joint_offset)
        clock, self._time = entities.clock_of(node)
        self._arrival = self._time()         # [ns] of the newest input
        self._is_next_awaited = False        # whether its silence is a timeout
        self._plausible = 0                  # [ns] stamps up to here are no surprise
        self._estimator = rate_estimator.estimator_of(scene)
        self._are_rates_estimated = False    # of the last input
        self._counter = joints.TurnCounter(rate_estimator.gap_of(settings.timeout))
        # the estimator takes a wrapping angle for a jump unless a top speed is known
        may_wrap = not (scene.must_count_turns or scene.linkage.is_driven_by_slide)
        self._why_restarted = RESTARTED.format(WRAPS if may_wrap else '')
        self._senders = JointSenders(settings.joint, scene.names_shown)
        self._read = entities.reader(self._topic, self._take, self._refuse)
        has_deadline = entities.has_override(node, 'subscription', self._topic, 'deadline')
        self._subscription, self._sequence = entities.counted_subscription(
            node, self._topic, self._receive, troubles,
            deadline=self._deadline_missed if has_deadline else None)
        self._timer = node.create_timer(WATCH, self._watch, clock=clock)

    @property
    def _is_relay(self) -> bool:
        """Return whether messages without the driven joint are no errors."""
        return (self._stream.scene.leaves_driven_out
                or self._subscription.topic_name in self._stream.topics())

    def _deadline_missed(self, info: Any) -> None:
        self._counts['deadlines_missed'] += info.total_count_change

    def stop(self) -> None:
        self._node.destroy_timer(self._timer)
        self._node.destroy_subscription(self._subscription)

    def age(self) -> float:
        """Return the time since the newest input [s]: steady, or simulated with use_sim_time."""
        return (self._time() - self._arrival) * 1e-9

    def report(self) -> clock_input.Reported:
        """Return (values, problems): lost inputs, the quality of an estimated acceleration."""
        estimator = self._estimator
        values: dict[str, Any] = {}
        name = self._subscription.topic_name
        problems = self._senders.problems(
            name, self._subscription.get_publisher_count(), self._sequence.heard(),
            is_ours=self._is_relay and name in self._stream.topics())
        for problem in problems:
            self._troubles.log(problem[:12], problem)
        self._senders.forget()
        if not self._sequence.is_numbered:
            values['lost'] = 'unknown: the middleware gives no numbers'
        if self._is_relay and self._counts['of_other_joints'] and not self._counts['received']:
            problems.append(f'joint {self._settings.joint!r} never came')
        elif not self._counts['received'] and self.age() > SILENT:
            policy = self._troubles.incompatible.get(self._topic.name)
            if policy and self._node.count_publishers(name):
                why = f'the publisher of {name} has an incompatible {policy}'
            elif self._subscription.get_publisher_count():
                why = f'the publisher of {name} is silent'
            else:
                published, why = self._stream.topics(), f'{name} has no publisher'
                if topics := [topic for topic, types in self._node.get_topic_names_and_types()
                              if self._topic.type in types and topic != name
                              and self._node.count_publishers(topic) > published.count(topic)]:
                    why += f'; {self._topic.type} comes on {", ".join(sorted(topics))}'
            problems.append(f'no input yet: {why}')
        if isnan(estimator.lag) or not self._are_rates_estimated:
            return values, problems
        unit = 'm/s^2' if self._stream.scene.linkage.is_driven_by_slide else 'rad/s^2'
        noise = estimator.noise
        values[f'noise of the estimated acceleration [{unit}]'] = (
            'unknown' if isnan(noise) else f'{noise:.3g}')
        values['lag of the estimated acceleration [s]'] = f'{estimator.lag:.3g}'
        if estimator.is_noise:
            problems.append('the estimated acceleration is noise')
        return values, problems

    def _receive(self, data: bytes, lost: int) -> None:
        self._counts['lost'] += lost
        try:
            self._read(data)
        except Exception:                                # it is ours and must not end us
            self._troubles.count('faults', f'a fault in taking an input: {format_exc()}')

    def _refuse(self, why: str) -> None:
        """Count a message that ROS cannot read; in a bag it would stop others."""
        self._note_arrival()
        self._troubles.count('malformed', why)

    def _take(self, message: Message) -> None:
        """Step to the input of a message, with its turns and rates completed; record it."""
        motion = driven_of(message, self._settings.joint)
        if motion is None and self._is_relay:    # from ourselves, or another part of the robot
            self._troubles.count('of_other_joints')
            if why := self._senders.note_other(message, self._counts['received'] > 0):
                self._troubles.log('of_other_joints', f'{self._subscription.topic_name}: {why}')
            return
        self._note_arrival()
        self._stream.record_input(self._topic.name, message)
        if motion is None:
            self._senders.others_are_heard = True
            hint = '' if self._counts['without_joint'] else self._senders.hint([message])
            self._troubles.count('without_joint', 'no position of joint '
                                 f'{self._settings.joint!r} in the input message{hint}')
            return
        stamp, nanoseconds = self._stamp(message.header.stamp.sec, message.header.stamp.nanosec)
        if self._stream.scene.must_count_turns:
            motion = self._counted(nanoseconds, *motion)
        if self._settings.source == 'joint_state':
            motion = self._scale.to_input(*motion)
            self._senders.note(message.name)
        position, velocity, acceleration = motion
        self._are_rates_estimated = isnan(velocity) or isnan(acceleration)
        velocity, acceleration = self._completed(nanoseconds, position, velocity, acceleration)
        self._stream.step(stamp, position, velocity, acceleration)

    def _completed(self, stamp: int, position: float, velocity: float, acceleration: float
                   ) -> tuple[float, float]:
        """
        Return (velocity, acceleration), missing ones estimated; by the scene in force.

        The next input may lack rates that this one has, so the estimator sees them all.
        """
        scene, settings_of = self._stream.scene, rate_estimator.estimator_settings
        if scene is not self._scene and settings_of(scene) != settings_of(self._scene):
            self._estimator = rate_estimator.estimator_of(scene)     # else it keeps its rates
        self._scene = scene
        estimator = self._estimator
        late, restarts = estimator.late, estimator.restarts
        velocity, estimate = estimator.update(stamp, position, velocity, acceleration)
        if self._are_rates_estimated:
            self._counts['late'] += estimator.late - late
            if estimator.restarts > restarts:
                self._troubles.count('estimate_restarts', self._why_restarted)
        return velocity, estimate if isnan(acceleration) else acceleration

    def _counted(self, stamp: int, position: float, velocity: float, acceleration: float
                 ) -> tuple[float, float, float]:
        """Return a motion with the turns that its position has made, if that wraps."""
        wrapped = self._counter.wraps
        position, is_in_doubt = self._counter.counted(stamp, position, velocity)
        whose = f'joint {self._settings.joint!r}' if self._settings.joint else 'the input'
        if self._counter.wraps and not wrapped:
            self._troubles.log('wraps', f'{whose} wraps after a turn, which leads to another pose '
                               '(behind a gear, at a change point): its turns are counted from '
                               'the first message on, which is taken to be in turn 0')
        if is_in_doubt:
            self._troubles.count('turns_in_doubt', f'{whose}: a pause in positions that wrap, or '
                                 'one beyond a turn; it may have made turns')
        return position, velocity, acceleration

    def _note_arrival(self) -> None:
        self._troubles.count('received')
        self._arrival, self._is_next_awaited = self._time(), True

    def _stamp(self, sec: int, nanosec: int) -> tuple[Stamp, int]:
        """Return the stamp of an input and the same in [ns]; the time of now if it has none."""
        stamp = sec * 10**9 + nanosec
        is_valid = sec >= 0 and nanosec < 10**9
        if stamp and is_valid:
            if stamp > self._plausible:        # the clock is read once in a while only
                now = self._node.get_clock().now().nanoseconds
                self._plausible = now + nanoseconds(FUTURE)
                if stamp > self._plausible:
                    self._troubles.count('future', f'input stamped {(stamp - now) * 1e-9:.3f} s '
                                         'ahead of the clock')
            return (sec, nanosec), stamp
        if not is_valid:
            self._troubles.count('bad_stamps', f'input stamped {sec} s, {nanosec} ns, which is no '
                                 'time: stamped on arrival')
        stamp = self._node.get_clock().now().nanoseconds
        return sec_nanosec(stamp), stamp

    def _watch(self) -> None:
        """Tell the stream when no input has come for ``drive.timeout``, once in a silence."""
        self._plausible = 0                                # the clock may have been set
        if self.age() < 0.0 or not self._arrival:       # simulated time went back, or has begun
            self._arrival = self._time()
        limit = self._stream.scene.drive.timeout
        if limit != 0.0 and self._is_next_awaited and (
                self._time() - self._arrival > nanoseconds(limit)):
            self._is_next_awaited = False
            self._troubles.count('timeouts')
            self._estimator.reset()
            self._stream.timeout(limit)
