"""At night: states of all FMUs, in a program that is not Python."""

import pytest
from fmi.test_c_host import (
    FMUS,
    FMUS_IN_CI,
    NATIVE,
    NATIVE_IN_CI,
    check_native,
    check_reference,
    check_state,
    host,
    loaded,
    native,
    program,
)

from shipcosim.library import build_stale


@pytest.mark.parametrize("name", [name for name in FMUS if name not in FMUS_IN_CI])
def test_every_fmu_of_the_project_gives_its_reference_result(name, root, loaded, host):
    check_reference(name, root, loaded, host)


@pytest.mark.parametrize("name", [name for name in NATIVE if name not in NATIVE_IN_CI])
def test_every_native_fmu_gives_the_reference_result_where_there_is_no_python(
    name, root, loaded, host, native
):
    check_native(name, loaded(native(name)), root, host)


@pytest.mark.parametrize("name", [name for name in NATIVE if name != "reference"])
def test_a_state_of_every_native_fmu_goes_on_in_another_process_bit_for_bit(
    name, root, loaded, host, tmp_path, native
):
    check_state(name, loaded(native(name)), root, host, tmp_path)


@pytest.mark.parametrize("name", [name for name in FMUS if name != "vessel"])
def test_a_state_of_every_fmu_goes_on_in_another_process_bit_for_bit(
    name, root, loaded, host, tmp_path
):
    check_state(name, loaded(build_stale(root) / f"{name}.fmu"), root, host, tmp_path)
