"""Other tools read a file themselves, and what they take otherwise is found and run here: the same digits come out."""

import json

import numpy as np
import pytest
from conformance import cases as conformance
from typer.testing import CliRunner

from shipcosim.cli import app
from shipcosim.cosim import engines_missing, simulate
from shipcosim.cosim.engines.foreign_process import readers
from shipcosim.errors import ShipcosimError
from shipcosim.scenario import Scenario
from shipcosim.ssp import parameter, read_system, write_ssv
from shipcosim.ssp.portability.as_interpreted import taken_by, told_set

SILENT = [
    "boolean_mapping",
    "integer_mapping",
    "linear_default",
    "ssm",
    "ssm_transformations",
    "ssv_file",
    "ssv_on_system",
    "ssv_prefix",
    "ssv_several",
    "units",
    "units_then_linear",
]
"""Cases that at least one of the tools runs to another result without a word."""


@pytest.fixture(params=["libcosim", "ecos"])
def host(request, needs):
    if missing := engines_missing().get(request.param):
        needs(request.param, str(missing))
    return request.param


@pytest.mark.parametrize("name", SILENT[::3])
def test_run_here_as_a_tool_takes_it_a_system_has_the_tools_values(name, host, tmp_path):
    check_as_read(name, host, tmp_path)


def check_as_read(name, host, tmp_path):
    path = conformance.write(conformance.cases()[name], tmp_path, "ssp, 1.0")
    scenario = Scenario(stop_time=2.0, step_size=0.25)
    theirs = readers(path, scenario, set_name=told_set(path))[host](read_system(path))
    respects, whole = taken_by(host, path)
    ours = simulate(whole, scenario).isel(time=slice(1, None))
    for signal in theirs.data_vars:
        np.testing.assert_allclose(
            ours[signal].values.astype(float), theirs[signal].values, 0, 1e-12, err_msg=signal
        )
    plain = simulate(read_system(path), scenario).isel(time=slice(1, None))
    differ = any(
        not np.array_equal(plain[s].values.astype(float), theirs[s].values)
        for s in theirs.data_vars
    )
    assert differ == bool(respects)


def compared(*arguments):
    result = CliRunner().invoke(app, ["compare", *map(str, arguments), "--as-read", "--json"])
    return result.exit_code, result


def test_compare_says_which_tools_agree_and_why_the_others_do_not(host, tmp_path):
    path = conformance.write(conformance.cases()["units_then_linear"], tmp_path, "ssp, 1.0")
    code, result = compared(path, "--stop-time", 2, "--step-size", 0.25)
    told = json.loads(result.stdout)
    assert code == 1
    signals = {signal["name"]: signal for signal in told["signals"]}
    assert signals["gain.y"]["agreeing"][0] == ["fmpy"] and host in signals["ramp.y"]["agreeing"][0]
    wanted = "connections are something else: ramp.y -> gain.u is 2 times plus 5 instead of 2000 times plus 5"
    assert signals["gain.y"]["causes"][host] == [wanted] and signals["ramp.y"]["causes"] == {}
    assert told["remarks"][host][-1] == f"Run here with that, every signal is that of {host}."


def test_a_tool_that_refuses_or_dies_is_left_out_with_a_word(host, tmp_path):
    path = conformance.write(conformance.cases()["parameter_enumeration"], tmp_path, "ssp, 1.0")
    _, result = compared(path, "--stop-time", 1, "--step-size", 0.25)
    said = json.loads(result.stdout)["left_out"][host]
    assert (
        said == "libcosim: crashes."
        if host == "libcosim"
        else said.startswith("ecos: refuses the file.")
    )


def test_parameters_events_and_files_that_a_tool_does_not_know_are_refused(tmp_path):
    path = conformance.write(conformance.cases()["connection"], tmp_path)
    with pytest.raises(ShipcosimError, match="knows no events"):
        readers(path, Scenario(stop_time=1.0, step_size=0.1, set={"ramp.bottom": 1.0}))
    write_ssv(tmp_path / "x.ssv", "x", [parameter("ramp.bottom", 1.0)])
    cases = {"does not know them": (path, "--parameters", tmp_path / "x.ssv")}
    cases["cannot read this themselves"] = (path / "SystemStructure.ssd",)
    cases["starts at 1 s, but a comparison starts at 0"] = (
        conformance.write(conformance.cases()["experiment"], tmp_path / "late"),
    )
    for message, arguments in cases.items():
        code, result = compared(*arguments, "--stop-time", 1, "--step-size", 0.1)
        assert code == 2 and message in result.stderr
