"""At night: runs that are stored at further times go on bit for bit."""

import pytest
from cosim.conftest import fmus, make_scenario, make_system
from cosim.master.test_state import check_goes_on, system


@pytest.mark.parametrize("order", ["jacobi", "gauss-seidel"])
@pytest.mark.parametrize("until", [0.1, 0.8, 1.3, 1.6, 2.0])
def test_a_stored_run_goes_on_bit_for_bit(system, make_scenario, tmp_path, until, order):
    check_goes_on(system, make_scenario, tmp_path, until, order)
