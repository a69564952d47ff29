# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The SROS2 policy of a scene allows what its running node uses, and nothing else."""
from xml.etree import ElementTree

from fourbar_ros.cli.main import main
from fourbar_ros.cli.scene import policy
from fourbar_ros.scene.files import read_values
from fourbar_ros.scene.scene import from_values
from fourbar_ros.scene.topics import OUTPUTS, PICTURES
from support.samples import some
from support.scenes import PAPER, RODS, TIP

FULL = {**PAPER, **RODS, **TIP, 'drive.source': 'joint_state', 'drive.joint': 'motor',
        'external.output.from_topic': True, 'trajectories': True, 'drive.start': 1.0,
        'outputs': [name for name in OUTPUTS if name not in ('links', 'reactions')] + [*PICTURES]}
TORQUE = {**PAPER, **RODS, 'drive.source': 'torque', 'outputs': ['links', 'reactions']}
MACHINE = {**read_values('jansen'), 'drive.source': 'motion', 'external.hip.from_topic': True,
           'external.foot.from_topic': True, 'outputs': [*OUTPUTS, *PICTURES]}
SCENES = {'timer': PAPER, 'bare': {**PAPER, 'services': ['evaluate'], 'outputs': ['state']},
          'full': FULL, 'torque': TORQUE, 'machine': MACHINE}


def allowed(text, node='fourbar'):
    """Return {(kind, verb): names} of a policy, with full names."""
    profile = ElementTree.fromstring(text).find('.//profile')
    assert profile.get('node') == node
    space, found = profile.get('ns').rstrip('/'), {}
    for group in profile:
        (verb, allow), = group.attrib.items()
        assert allow == 'ALLOW'
        found[group.tag, verb] = {
            each.text if each.text.startswith('/') else f'{space}/{each.text}' for each in group}
    return found


def used(node):
    """Return the same of a node of the graph."""
    space = '/'
    names = {
        ('topics', 'publish'): node.get_publisher_names_and_types_by_node('fourbar', space),
        ('topics', 'subscribe'): node.get_subscriber_names_and_types_by_node('fourbar', space),
        ('services', 'reply'): node.get_service_names_and_types_by_node('fourbar', space)}
    found = {key: {name for name, _ in value} for key, value in names.items()}
    return {key: value for key, value in found.items() if value}


@some('name', SCENES, 1)
def test_the_policy_is_the_live_graph(run_node, client, name):
    run_node(SCENES[name])
    want = allowed(policy(from_values(SCENES[name])))
    last = dict.fromkeys(want, set())
    client.until(lambda: 'fourbar' in client.node.get_node_names(), 'the node')

    def same():
        last.update(used(client.node))
        return last == want
    try:
        client.until(same, 'the graph', 30.0)
    finally:
        assert last == want, {key: last[key] ^ want[key] for key in want}


def test_it_is_printed_for_a_node_in_a_namespace(capsys):
    assert main(['scene', 'policy', 'cylinder', '--node', '/left/arm', '--use-sim-time']) == 0
    found = allowed(capsys.readouterr().out, 'arm')
    assert '/left/arm/state' in found['topics', 'publish']
    assert '/left/joint_states' in found['topics', 'publish']
    assert found['topics', 'subscribe'] == {'/left/arm/input', '/clock'}
