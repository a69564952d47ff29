# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Workflows call targets of the Makefile; the paper takes its figures from the pages it names."""
import re

import pytest
from support import ROOT
import yaml

NUMBER = re.compile(r'(?<![\w.])\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w])')
PAPER, BIB = ((ROOT / f'paper.{suffix}') for suffix in ('md', 'bib'))


def test_workflows_call_targets_that_there_are():
    targets = set(re.findall(r'^([\w-]+):', (ROOT / 'Makefile').read_text(), re.M))
    called = set()
    for file in (ROOT / '.github/workflows').glob('*.yml'):
        for job in yaml.safe_load(file.read_text())['jobs'].values():
            called |= {step['run'] for step in job['steps'] if 'run' in step}
    assert called == {'make test', 'make lint', 'make docs'}
    assert {command.split()[1] for command in called} <= targets


@pytest.mark.parametrize('name', ['bug', 'wish'])
def test_a_form_of_an_issue_asks_for_something(name):
    form = yaml.safe_load((ROOT / f'.github/ISSUE_TEMPLATE/{name}.yml').read_text())
    assert any(field.get('validations', {}).get('required') for field in form['body'])


def test_the_paper_has_the_length_and_the_references_of_its_journal():
    text = PAPER.read_text(encoding='utf-8').split('---', 2)[2]
    assert 250 <= len(text.split()) <= 1000
    cited = set(re.findall(r'@([a-z]\w+)', text))
    assert cited == set(re.findall(r'^@\w+\{(\w+),', BIB.read_text(encoding='utf-8'), re.M))


def test_figures_of_the_paper_stand_on_the_pages_that_it_names():
    text = PAPER.read_text(encoding='utf-8').split('---', 2)[2]
    with_pages = [part for part in text.split('\n\n') if 'docs/bench/' in part]
    assert len(with_pages) >= 4
    for part in with_pages:
        pages = [(ROOT / page).read_text(encoding='utf-8')
                 for page in re.findall(r'docs/bench/\w+\.md', part)]
        there = {float(number) for page in pages for number in NUMBER.findall(page)}
        given = {float(number) for number in NUMBER.findall(re.sub('`[^`]*`', '', part))}
        assert given <= there, given - there
