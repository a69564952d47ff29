"""What every slider mechanism is held to, driven at its crank or slide: accuracy, balances, arrays, scaling."""
import pytest
from support import slider_reference as reference
from support.slider_reference import FAMILIES, KINDS

from fourbar_ros import SliderCrank

every_kind = pytest.mark.parametrize('kind', KINDS, ids=lambda kind: f'{kind[0].__name__}-{kind[1]}')


def seed(kind):
    return 80 if kind[0] is SliderCrank else 100


@every_kind
@pytest.mark.parametrize('family', FAMILIES)
def test_motion_of_a_sample(kind, family):
    reference.check_motion(kind, family, seed(kind) + 1, 25)


@every_kind
@pytest.mark.parametrize('family', ['random', 'near a toggle', 'near a change point', 'link ratios 1e8'])
def test_loads_of_a_sample(kind, family):
    reference.check_loads(kind, family, seed(kind) + 2, 3)


@pytest.mark.slow
@every_kind
@pytest.mark.parametrize('family', FAMILIES)
def test_motion_and_loads_in_full(kind, family):
    reference.check_motion(kind, family, seed(kind) + 3, 3000)
    reference.check_loads(kind, family, seed(kind) + 4, 100)


@every_kind
def test_power_and_momentum_balance(kind):
    reference.check_balance(kind, seed(kind) + 5, 200)


@every_kind
def test_arrays_equal_single_values(kind):
    reference.check_arrays(kind, seed(kind) + 6, 20)


@every_kind
def test_complex_step(kind):
    reference.check_complex_step(kind, seed(kind) + 7, 20)


@every_kind
@pytest.mark.parametrize('power', [-300, 200])
def test_scaling_by_a_power_of_two_changes_no_bit(kind, power):
    reference.check_scaling(kind, seed(kind) + 8, 5, power)
