# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Drive the input: by a thread on a time grid, a timer of simulated time, or a subscription."""
from __future__ import annotations

from math import isnan, nan
import threading
import time
from traceback import format_exc

from fourbar_ros.pipeline import joints
from fourbar_ros.pipeline.message_fields import is_time
from fourbar_ros.pipeline.rate_estimator import estimator_of
from fourbar_ros.ros.messages import resolve, sec_nanosec
from fourbar_ros.ros.node import qos
from fourbar_ros.ros.node.sequence import Sequence, WithInfo
from fourbar_ros.scene.topics import INPUT_DEPTH, INPUTS
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import QoSProfile, ReliabilityPolicy

SLEEP = 0.1            # [s] longest sleep: how soon a thread sees that it shall stop
CATCH_UP = 1.0         # [s] a thread later than this skips the samples it missed
CLOCK_STEP = 0.05      # [s] the wall clock was set if it is this far from the monotonic one
CHECK_CLOCK = 1.0      # [s] how often that is looked at
FUTURE = 1.0           # [s] a stamp further ahead of our clock is counted as of the future


class Drive:
    """Base of all drives: counters for the diagnostics, and a new scene between two samples."""

    def __init__(self, node, stream, recording):
        self._node, self._stream, self._recording = node, stream, recording
        self.settings = stream.scene.drive
        self.counts = dict.fromkeys(self.COUNTED, 0)

    def apply(self, settings):
        """Take over changed DriveSettings of the scene."""
        self.settings = settings

    def age(self):
        """Return the time since the newest input [s]; NaN if the drive has no input."""
        return nan

    def state(self):
        """Return (values, problems) for the diagnostics, beside the counters."""
        return {}, []


class TimerDrive(Drive):
    """
    Constant speed on the wall clock.

    Sample k belongs to the time start + k / rate, however late the scheduler is, and its angle
    follows from that time, without accumulating errors. It is a thread, not a ROS timer, because
    rclpy's timers drop missed ticks and slip from their grid.
    """

    COUNTED = ('late', 'missed', 'clock_steps')

    def start(self):
        """Start the thread."""
        self._stopping = False
        self._thread = threading.Thread(target=self._guarded, name='drive', daemon=True)
        self._thread.start()

    def stop(self):
        """Stop it and wait for the current sample."""
        self._stopping = True
        self._thread.join()

    def _guarded(self):
        try:
            self._run()
        # a fault of ours: never a silent end of the stream
        except Exception as error:
            self._node.failure = error

    def _run(self):
        settings, began = self.settings, time.monotonic()
        self._begin(settings)
        offset, checked = self._offset(), began
        sample, period = 0, 1.0 / settings.rate
        while not self._stopping:
            elapsed = sample * period
            wait = began + elapsed - time.monotonic()
            if wait > SLEEP:
                time.sleep(SLEEP)
                continue
            if wait > 0.0:
                time.sleep(wait)
            # suspended, or a rate this machine cannot do
            elif wait < -CATCH_UP:
                skipped = int(-wait / period)
                self.counts['missed'] += skipped
                sample += skipped
                continue
            elif -wait > period:
                self.counts['late'] += 1
            moment = began + elapsed
            if moment - checked > CHECK_CLOCK:
                offset, checked = self._follow_clock(offset), moment
            self._sample(sec_nanosec(round(moment * 1e9) + offset), settings, elapsed)
            sample += 1
            # go on from here at the new speed and rate
            if self.settings is not settings:
                self._go_on(settings, elapsed)
                settings, began, sample = self.settings, moment, 1
                period = 1.0 / settings.rate

    def _begin(self, settings):
        self._angle = settings.start

    def _sample(self, stamp, settings, elapsed):
        self._stream.step(stamp, self._angle + settings.speed * elapsed, settings.speed, 0.0)

    def _go_on(self, settings, elapsed):
        """Take the angle of now as that from which it goes on with other settings."""
        self._angle += settings.speed * elapsed

    def _offset(self):
        return self._node.get_clock().now().nanoseconds - time.monotonic_ns()

    def _follow_clock(self, offset):
        """Return the offset from monotonic to wall clock; a new one if the wall clock was set."""
        new = self._offset()
        if abs(new - offset) < CLOCK_STEP * 1e9:
            return offset
        self.counts['clock_steps'] += 1
        self._node.get_logger().warning(f'the clock was set by {(new - offset) * 1e-9:.3f} s')
        return new


class SimulatedTimerDrive(Drive):
    """Constant speed on simulated time: a ROS timer; the angle follows from the clock."""

    COUNTED = ('clock_steps',)

    def start(self):
        """Start the timer."""
        self._angle, self._began, self._last = self.settings.start, None, 0
        self._timer = self._node.create_timer(1.0 / self.settings.rate, self._tick)

    def stop(self):
        """Stop it."""
        self._node.destroy_timer(self._timer)

    def apply(self, settings):
        """Take over speed and rate, continuing from the current angle."""
        if self._began is not None:
            self._angle += self.settings.speed * (self._last - self._began) * 1e-9
            self._began = self._last
        rate_changed = settings.rate != self.settings.rate
        super().apply(settings)
        if rate_changed:
            self.stop()
            self._timer = self._node.create_timer(1.0 / settings.rate, self._tick)

    def _tick(self):
        now = self._node.get_clock().now().nanoseconds
        if now == 0:
            return                                       # no /clock yet
        # the first tick, or the simulation starts again
        if self._began is None or now < self._last:
            if self._began is not None:
                self.counts['clock_steps'] += 1
                self._node.get_logger().warning('simulated time went back: starting again')
                self._angle = self.settings.start
            self._began = now
        self._last = now
        angle = self._angle + self.settings.speed * (now - self._began) * 1e-9
        self._stream.step(sec_nanosec(now), angle, self.settings.speed, 0.0)


class TopicDrive(Drive):
    """One step for each input message, with its stamp; missing rates are estimated."""

    COUNTED = ('received', 'lost', 'malformed', 'without_joint', 'of_other_joints',
               'bad_stamps', 'future', 'late', 'estimate_restarts', 'timeouts',
               'deadlines_missed', 'faults')

    def start(self):
        """Subscribe to raw bytes, which are recorded as they are."""
        self._topic = INPUTS[self.settings.source]
        self._simulated = self._node.get_parameter('use_sim_time').value
        self._heard, self._waiting, self._horizon = self._now(), False, 0
        self._estimated = False
        self._is_relay = self._stream.scene.joint_states.only_passive
        self.estimator = None
        self.apply(self.settings)
        profile = QoSProfile(depth=INPUT_DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._sequence = Sequence(lambda: self._subscription.get_publisher_count())
        self._subscription = qos.create(
            self._node, 'subscription', resolve(self._topic.type), self._topic.topic,
            WithInfo(self._receive),
            profile, raw=True, event_callbacks=self._events())
        self._timer = self._node.steady_timers.add(SLEEP, self._watch)

    def _events(self):
        events = SubscriptionEventCallbacks(matched=lambda _: self._sequence.forget())
        if qos.has_override(self._node, 'subscription', self._topic.topic, 'deadline'):
            events.deadline = self._deadline_missed      # not every middleware knows this event
        return events

    def _deadline_missed(self, info):
        self.counts['deadlines_missed'] += info.total_count_change

    def stop(self):
        """Unsubscribe."""
        self._node.steady_timers.remove(self._timer)
        self._node.destroy_subscription(self._subscription)

    def apply(self, settings):
        """Take over settings; the estimate starts afresh."""
        from fourbar_ros.ros.node.inputs import (
            Reader,  # only these drives need the definitions of messages
        )

        super().apply(settings)
        self._scale = joints.Scale(settings.joint_ratio, settings.joint_offset)
        self._read = Reader(self._topic.type, settings.joint)
        before, self.estimator = self.estimator, estimator_of(self._stream.scene)
        if before:
            self.estimator.late, self.estimator.restarts = before.late, before.restarts

    def age(self):
        """Return the time since the newest input [s]: steady, or simulated with use_sim_time."""
        return self._now() - self._heard

    def _now(self):
        return (self._node.get_clock().now().nanoseconds * 1e-9 if self._simulated
                else time.monotonic())

    def state(self):
        """Return (values, problems): the quality of an estimated acceleration."""
        self.counts.update(lost=self._sequence.lost, late=self.estimator.late,
                           estimate_restarts=self.estimator.restarts)
        lost = ({} if self._sequence.is_numbered
                else {'lost': 'unknown: the middleware gives no numbers'})
        if isnan(self.estimator.lag) or not self._estimated:
            return lost, []
        unit = 'm/s^2' if self._stream.scene.linkage.is_driven_by_slide else 'rad/s^2'
        noise = self.estimator.noise
        return ({**lost, f'noise of the estimated acceleration [{unit}]': 'unknown' if isnan(noise)
                 else f'{noise:.3g}',
                 'lag of the estimated acceleration [s]': f'{self.estimator.lag:.3g}'},
                ['the estimated acceleration is noise'] if self.estimator.is_noise else [])

    def _receive(self, data, info):
        try:
            self._sequence.take(info['publication_sequence_number'])
            self._take(data)
        # a fault of ours: told, and the next message is taken
        except Exception:
            self._note('faults', f'a fault in taking an input: {format_exc()}')

    def _take(self, data):
        try:
            stamp, given = self._read(data)
            if given is None and self._is_relay:         # our own, or of another part of the robot
                self.counts['of_other_joints'] += 1
                return
            self._note_arrival()
        # whatever a foreign writer sends, the node goes on
        except Exception:
            self._note_arrival()
            self._note('malformed', f'{self._topic.topic}: a message that is no '
                                    f'{self._topic.type}')
            # nor does a bag hold it: its readers would stumble
            return
        self._recording.write(self._topic.name, data)
        if given is None:
            self._note('without_joint', f'joint {self.settings.joint!r} is not in the input '
                                        'message')
            return
        stamp, time_of = self._stamp(*stamp)
        if self.settings.source == 'joint_state':
            given = self._scale.to_input(*given)
        position, velocity, acceleration = given
        self._estimated = isnan(velocity) or isnan(acceleration)
        if self._estimated:
            velocity, estimate = self.estimator.update(time_of, position, velocity)
            acceleration = estimate if isnan(acceleration) else acceleration
        self._stream.step(stamp, position, velocity, acceleration)

    def _note_arrival(self):
        self.counts['received'] += 1
        self._heard, self._waiting = self._now(), True

    def _stamp(self, sec, nanosec):
        """
        Return the stamp of an input, as (sec, nanosec) and in ns.

        An input without a valid stamp gets the current time.
        """
        time_of = sec * 10**9 + nanosec
        is_good = is_time(sec, nanosec)
        if time_of and is_good:
            if time_of > self._horizon:
                self._look_ahead(time_of)
            return (sec, nanosec), time_of
        if not is_good:
            self._note('bad_stamps', f'input stamped {sec} s, {nanosec} ns, which is no time: '
                                     'stamped on arrival')
        time_of = self._node.get_clock().now().nanoseconds
        return sec_nanosec(time_of), time_of

    def _look_ahead(self, time_of):
        now = self._node.get_clock().now().nanoseconds
        self._horizon = now + round(FUTURE * 1e9)
        if time_of > self._horizon:
            self._note('future', f'input stamped {(time_of - now) * 1e-9:.3f} s ahead of the '
                                 'clock')

    def _note(self, what, text):
        self.counts[what] += 1
        self._node.log.warning(what, text)

    def _watch(self):
        self._horizon = 0                                # the clock may have been set
        if self.age() < 0.0:                             # so was that of a simulation
            self._heard = self._now()
        limit = self.settings.timeout
        if limit and self._waiting and self.age() > limit:
            self._waiting = False
            self.counts['timeouts'] += 1
            self.estimator.reset()
            self._stream.timeout(sec_nanosec(self._node.get_clock().now().nanoseconds), limit)
