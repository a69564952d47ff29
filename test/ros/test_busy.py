# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Many long requests at once: proofs wait for proofs alone, and only so many of them."""
from fourbar_msgs.srv import FindExtrema
from fourbar_ros.ros.node.entities import WAITING
from fourbar_ros.scene.files import read_values

PROOF = FindExtrema.Request(mode=0, velocity=10.0, certify=True)     # of every quantity
JANSEN = {**read_values('config/jansen.yaml'), 'outputs': ['state']}


def test_only_proofs_wait_for_a_proof_and_eight_of_them(run_node, client):
    """
    In order of events, not by the clock: a proof takes as long as hundreds of evaluations.

    An evaluation after each request gives the node time to take it: a service keeps ten only.
    """
    node, asked = run_node(JANSEN), 14
    wanted = {'quantities': ['driving_torque'], 'velocity': 10.0}
    service, alone = client.service('find_extrema'), client.call('find_extrema', **wanted)
    proofs = []

    def answered():
        client.spin(0.01)
        return [number for number, proof in enumerate(proofs) if proof.done()]
    for _ in range(asked):
        proofs.append(service.call_async(PROOF))
        client.call('evaluate', position=0.5)
    client.until(lambda: proofs[-1].done(), 'the answer to the last')
    busy = list(range(1 + WAITING, asked))               # before them one at work, eight that wait
    assert answered() == busy
    for number in busy:
        answer = proofs[number].result()
        assert answer.result == answer.RESULT_BUSY and not answer.extrema
        assert answer.message == '8 requests wait for an answer already: ask again later'
    assert repr(client.call('find_extrema', **wanted)) == repr(alone) and alone.extrema
    assert answered() == busy
    assert node.stop() == 0                              # in the middle of it
