# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Workflows call targets of the Makefile; the paper takes its figures from the pages it names."""
import re

from support import ROOT
import yaml

NUMBER = re.compile(r'(?<![\w.])\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w])')
PAPER = ROOT / 'docs' / 'paper' / 'paper.md'


def test_workflows_call_targets_that_there_are():
    targets = set(re.findall(r'^([\w-]+):', (ROOT / 'Makefile').read_text(), re.M))
    called = set()
    for file in (ROOT / '.github/workflows').glob('*.yml'):
        for job in yaml.safe_load(file.read_text())['jobs'].values():
            called |= {step['run'] for step in job['steps'] if 'run' in step}
    assert {command.split()[1] for command in called} <= targets


def test_figures_of_the_paper_stand_on_the_pages_that_it_names():
    text = PAPER.read_text(encoding='utf-8').split('---', 2)[2]
    with_pages = [part for part in text.split('\n\n') if 'docs/bench/' in part]
    assert len(with_pages) >= 3
    for part in with_pages:
        pages = [(ROOT / page).read_text(encoding='utf-8')
                 for page in re.findall(r'docs/bench/\w+\.md', part)]
        there = {float(number) for page in pages for number in NUMBER.findall(page)}
        given = {float(number) for number in NUMBER.findall(re.sub('`[^`]*`', '', part))}
        assert given <= there, given - there
