# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A release: the changelog in the form of ROS, the workflow that publishes, what is refused."""
import re
import shutil
import subprocess
import sys

import pytest
from support import ROOT
import yaml

CHANGELOG = ROOT / 'CHANGELOG.md'
SCRIPTS = 'scripts/release.sh', 'scripts/changelog.py'
VERSIONED = ('fourbar_ros/__init__.py', 'package.xml', 'msg_defs/package.xml',
             'scripts/tf2_msgs/package.xml')


def sections(text):
    """Return {head of a section of the changelog: count of its entries}."""
    return {head.strip(): len(re.findall('^- ', body, re.M)) for head, body in
            re.findall(r'^## ([^\n]*)\n(.*?)(?=^## |\Z)', text, re.M | re.S)}


def test_ros_tools_read_every_entry_of_the_changelog(tmp_path):
    changelog = pytest.importorskip('catkin_pkg.changelog')
    from docutils.core import publish_doctree
    from docutils.nodes import bullet_list, section, system_message
    text = CHANGELOG.read_text(encoding='utf-8').replace('## Unreleased: 2.0.0',
                                                         '## 2.0.0 (2027-01-02)')
    (tmp_path / 'CHANGELOG.md').write_text(text, encoding='utf-8')
    (tmp_path / 'scripts').mkdir()
    shutil.copy(ROOT / 'scripts/changelog.py', tmp_path / 'scripts')
    done = subprocess.run([sys.executable, tmp_path / 'scripts/changelog.py'], check=True,
                          capture_output=True, text=True)
    (tmp_path / 'CHANGELOG.rst').write_text(done.stdout, encoding='utf-8')
    tree = publish_doctree(done.stdout, settings_overrides={'report_level': 1})
    assert not list(tree.findall(system_message))
    read = changelog.get_changelog_from_path(str(tmp_path), 'fourbar_ros')
    wanted = sections(text)
    assert {f'{version} ({date:%Y-%m-%d})' for version, date, _ in read.foreach_version()} == {
        *wanted}
    counts = [sum(len(each.children) for each in part.findall(bullet_list))
              for part in tree.findall(section)]
    assert [count for count in counts if count] == [*wanted.values()]


def test_the_workflow_publishes_tags_and_nothing_else_has_a_right():
    flow = yaml.safe_load((ROOT / '.github/workflows/release.yml').read_text())
    assert list(flow[True]) == ['push'] and list(flow[True]['push']) == ['tags']
    build, publish = flow['jobs']['build'], flow['jobs']['publish']
    assert flow['permissions'] == {'contents': 'read'} and 'permissions' not in build
    assert publish['permissions'] == {'id-token': 'write'} and publish['needs'] == 'build'
    assert [step['run'] for step in build['steps'] if 'run' in step] == ['make release']
    head, settings = yaml.safe_load_all((ROOT / 'rosdoc2.yaml').read_text())
    assert head == {'type': 'rosdoc2 config', 'version': 1}
    assert (ROOT / settings['settings']['python_source']).is_dir()


@pytest.fixture
def source(tmp_path):
    """Return a repository of what release.sh reads, whose check takes everything."""
    for name in (*VERSIONED, *SCRIPTS, 'CHANGELOG.md'):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    check = tmp_path / 'scripts/check_pip.py'
    check.write_text('import pathlib, sys\npathlib.Path("asked").write_text(sys.argv[-1])\n'
                     'pathlib.Path("dist").mkdir()\npathlib.Path("dist/a.whl").touch()\n')
    for words in (['init', '-q'], ['add', '.'],
                  ['-c', 'user.name=a', '-c', 'user.email=a@b', 'commit', '-qm', 'all']):
        subprocess.run(['git', *words], cwd=tmp_path, check=True)
    return tmp_path


def release(folder, **environment):
    return subprocess.run(['bash', 'scripts/release.sh'], cwd=folder, capture_output=True,
                          text=True, check=False, env={'PATH': '/usr/bin:/bin', **environment,
                                                       'PYTHON': sys.executable})


def test_a_release_is_made_by_one_command_and_a_wrong_tag_is_refused(source):
    done = release(source, QUICK='1')
    assert done.returncode == 0, done.stderr
    assert (source / 'dist/a.whl').exists() and (source / 'asked').read_text() == '--quick'
    assert (source / 'CHANGELOG.rst').read_text().startswith('^^^')
    version = re.search("__version__ = '(.+)'", (source / VERSIONED[0]).read_text())[1]
    for tag, said in (('9.9.9', f'the tag is 9.9.9, the version {version}'), (version, 'a date')):
        subprocess.run(['git', 'tag', tag], cwd=source, check=True)
        done = release(source)
        is_dated = f'\n## {version} (' in CHANGELOG.read_text(encoding='utf-8')
        assert (done.returncode == 0) == (is_dated and tag == version)
        assert done.returncode == 0 or said in done.stderr
        subprocess.run(['git', 'tag', '-d', tag], cwd=source, check=True, capture_output=True)
    (source / 'package.xml').write_text('<version>0.1.0</version>')
    assert 'package.xml has not the version' in release(source).stderr
