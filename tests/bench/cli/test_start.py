"""At night: new files of the systems and FMUs that `make test` leaves out."""

import pytest
from cli.conftest import call
from cli.test_start import SYSTEMS, all_fmus, check_copy, check_fmus, check_parameters, empty

from shipcosim.library import names

OTHERS = sorted({*names("system")} - {*SYSTEMS})


@pytest.mark.parametrize("system", OTHERS)
def test_new_scenario_and_copy_of_every_system_have_no_fault(call, empty, system):
    check_copy(call, empty, system)


@pytest.mark.parametrize("system", OTHERS)
def test_parameters_of_every_system_are_written_as_they_are(call, empty, system):
    check_parameters(call, empty, system)


def test_parameters_of_every_fmu_are_written_as_they_are(call, empty, root):
    assert check_fmus(call, empty, all_fmus(root)) > 20
