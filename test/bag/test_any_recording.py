# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The recorder in any order of what can happen to it: sampled, flushed, split, changed, killed.

After each step a copy of what is on the disk, as kill -9 would leave it, is read and recovered.
"""
from pathlib import Path
import shutil
import tempfile

from bag.test_recorder import assert_every_reader_takes, numbers, until
from fourbar_ros.bag.metadata import number_of
from fourbar_ros.bag.overview import info
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recorder import BagWriter
from fourbar_ros.bag.recovery import recover
from hypothesis import strategies as st
from hypothesis.stateful import initialize, precondition, rule, RuleBasedStateMachine
from support import bags
from support.bags import MOTION, motion

TEXT = bags.channel('/text', 'std_msgs/msg/String')


class Recording(RuleBasedStateMachine):
    """A writer beside the list of what it took."""

    @initialize(how=st.sampled_from([{}, {'split_size': 300}, {'split_duration': 0.05}]))
    def start(self, how):
        self.folder = Path(tempfile.mkdtemp(prefix='fourbar_recording_'))
        self.now, self.taken, self.texts, self.kills = 10**18, 0, 0, 0
        self.writer = BagWriter(self.folder, 'run', [MOTION, TEXT], {'scene': 'first'},
                                clock=lambda: self.now, **how)

    @rule(count=st.integers(1, 20), pause=st.sampled_from([0, 10**7, 10**8]))
    def sample(self, count, pause):
        for _ in range(count):
            self.now += pause
            assert self.writer.write(0, motion(self.taken))
            self.taken += 1

    @rule()
    def sample_two_topics(self):
        assert self.writer.write_all([(0, motion(self.taken)),
                                      (1, bags.encode(TEXT.type, data='x'))])
        self.taken, self.texts = self.taken + 1, self.texts + 1

    @rule(text=st.text('ab', max_size=3))
    def change(self, text):
        self.writer.note('scene', text)

    @rule()
    def flush(self):
        until(lambda: numbers(self.writer.path) == list(range(self.taken)), 'a flush')

    @precondition(lambda self: self.kills < 2)
    @rule()
    def kill(self):
        """Find a beginning without damage, and make it whole."""
        self.kills += 1
        path = self.folder / f'killed{self.kills}'
        path.mkdir()
        # the newest first: each is a beginning of what was there when the next was copied
        for file in sorted(self.writer.path.glob('*.mcap'), key=number_of, reverse=True):
            shutil.copy(file, path)
        found, state = numbers(path), info(path, check=True)
        assert found == list(range(len(found))) and not state.damage and not state.missing
        if state.topics:
            recovered = recover(path, self.folder / f'whole{self.kills}')
            assert numbers(recovered.path) == found and not recovered.damage
            assert_every_reader_takes(recovered.path, recovered.messages)

    def teardown(self):
        if not hasattr(self, 'writer'):
            return
        path = self.writer.close('the end')
        raws = list(Bag(path).raw([MOTION.topic]))
        assert numbers(path) == list(range(self.taken)) and not self.writer.dropped
        assert [raw.sequence for raw in raws] == list(range(self.taken))
        assert all(a.time <= b.time for a, b in zip(raws, raws[1:]))
        found = info(path, check=True)
        assert found.is_sound and found.ended == 'the end'
        assert_every_reader_takes(path, self.taken + self.texts)
        shutil.rmtree(self.folder)


TestRecording = Recording.TestCase
