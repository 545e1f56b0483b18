"""A changed system is valid and runs in libcosim, also where libcosim ignores the parameter sets of the original."""

import pytest
from conformance.cases import cases, write
from conformance.recording import in_libcosim

import shipcosim as sc
from shipcosim.cosim import engines_missing
from shipcosim.ssp import check_system

IGNORED = (
    "ssv_file",
    "ssv_several",
    "ssv_on_system",
    "ssv_prefix",
    "ssm",
    "ssm_transformations",
    "ssv_in_fmu",
)
"""Cases whose parameters libcosim does not take from where they stand."""
TAKEN = (
    "connection",
    "linear",
    "feedback",
    "types",
    "names",
    "fmu_places",
    "start_values",
    "parameter_types",
)


@pytest.fixture(autouse=True)
def libcosim(needs):
    if missing := engines_missing().get("libcosim"):
        needs("libcosim", str(missing))


@pytest.mark.parametrize("name", [*TAKEN, *IGNORED])
def test_changed_and_written_it_is_valid_and_runs_in_libcosim(name, tmp_path):
    case = cases()[name]
    system = sc.read(write(case, tmp_path, "ssp, 2.0, other prefixes"))
    system.bind_to_components()
    system.step_size, system.stop_time = case.step_size, case.stop_time
    first = next(iter(system.components))
    system.rename(first, "renamed")
    system.write(tmp_path / "changed.ssp")
    assert [
        problem for problem in check_system(tmp_path / "changed.ssp") if problem.severity == "error"
    ] == []
    follows = {signal: signal.replace(f"{first}.", "renamed.", 1) for signal in case.expect}
    renamed = type(case)(
        **{**vars(case), "expect": {follows[s]: text for s, text in case.expect.items()}}
    )
    values = in_libcosim(renamed, tmp_path / "changed.ssp")
    for signal in renamed.expect:
        assert float(values[signal]) == pytest.approx(
            float(renamed.closed_form(signal)[-1]), rel=1e-12
        ), signal
