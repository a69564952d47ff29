# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Two linkages and a plant of another maker: the same bits by FMUs, by nodes and in Python."""
import pytest
from support.generated import COMPILERS


@pytest.mark.slow
@pytest.mark.skipif(not COMPILERS, reason='no C compiler')
def test_a_plant_of_another_maker_moves_fmus_and_nodes_alike(tmp_path):
    pytest.importorskip('fmpy')
    from bench import coupled
    if coupled.reference_fmu() is None:
        pytest.skip(coupled.WHERE)
    expected, _ = coupled.coupled(coupled.in_python, tmp_path, 300)
    assert abs(expected[:, 3]).max() > 2.0 and expected[:, 1].std() > 0.1
    for kind in (coupled.Units, coupled.Nodes):
        linkages = kind(tmp_path)
        try:
            found, _ = coupled.coupled(linkages, tmp_path, 300)
        finally:
            linkages.close()
        assert found.tolist() == expected.tolist()
