"""FMUs in components' places count in every command: checks for other tools, engines side by side, exports, states."""

import json
import zipfile

import pytest

import shipcosim
from shipcosim.cosim import engines_missing, repeat

SWAP = """
[components]
allocator = "optimal_allocator"
"""


@pytest.fixture
def swapped(gunnerus):
    """The project with the scenario `swapped`: one second of stationkeeping with another allocator."""
    short = (gunnerus / "scenarios" / "short.toml").read_text(encoding="utf-8")
    (gunnerus / "scenarios" / "swapped.toml").write_text(short + SWAP, encoding="utf-8")
    return gunnerus


def in_kilonewtons(fmu, target):
    """The same FMU, but for an output that it declares in kN."""
    with zipfile.ZipFile(fmu) as old, zipfile.ZipFile(target, "w") as new:
        for entry in old.infolist():
            data = old.read(entry)
            if entry.filename == "modelDescription.xml":
                before, after = data.decode().split('name="tau_X"', 1)
                assert 'unit="N"' in after and "</UnitDefinitions>" in before
                unit = '<Unit name="kN"><BaseUnit kg="1" m="1" s="-2" factor="1000"/></Unit></UnitDefinitions>'
                before = before.replace("</UnitDefinitions>", unit)
                data = (
                    before + 'name="tau_X"' + after.replace('unit="N"', 'unit="kN"', 1)
                ).encode()
            new.writestr(entry, data)


def test_check_for_a_tool_looks_at_the_fmu_that_a_scenario_swaps_in(swapped, call):
    in_kilonewtons(
        swapped / "build" / "fmus" / "extended_allocator.fmu", swapped / "scenarios" / "other.fmu"
    )
    for tool in ("libcosim", "ecos"):
        result = call("check", "swapped", "--for", tool)
        assert result.code == 1 and "allocator.tau_X ->" not in result.out
    path = swapped / "scenarios" / "swapped.toml"
    path.write_text(path.read_text().replace('"optimal_allocator"', '"other.fmu"'))
    for tool in ("libcosim", "ecos"):
        result = call("check", "swapped", "--for", tool)
        assert (
            "allocator.tau_X -> controller.tau_X_allocated" in result.out
            and "A conversion of units" in result.out
        )


def test_check_for_a_tool_says_once_that_there_is_no_such_fmu(swapped, call):
    path = swapped / "scenarios" / "swapped.toml"
    path.write_text(path.read_text().replace("optimal_allocator", "optimal_alocator"))
    result = call("check", "swapped", "--for", "ecos")
    assert result.code == 1 and result.out.count("optimal_alocator") == 1
    assert "swapped.toml, line " in result.out and "Did you mean 'optimal_allocator'?" in result.out


@pytest.mark.parametrize(
    "what", [("swapped",), ("ssp/gunnerus_dp", "--component", "allocator=optimal_allocator")]
)
def test_a_tool_that_reads_the_file_itself_is_not_compared_with_an_fmu_in_anothers_place(
    what, swapped, call
):
    result = call("compare", *what, "--as-read", "--stop-time", "1")
    assert result.code == 2 and "runs the FMU that it names for allocator" in result.err
    assert "without as_read (--as-read)" in result.err


def test_engines_are_compared_with_the_fmu_that_takes_the_place(swapped, call, needs):
    for name, missing in engines_missing().items():
        needs(name, str(missing))
    of_scenario = call("compare", "swapped", "--json")
    of_option = call("compare", "short", "--component", "allocator=optimal_allocator", "--json")
    found = [
        {signal["name"]: signal["range"] for signal in json.loads(result.out)["signals"]}
        for result in (of_scenario, of_option)
    ]
    assert json.loads(of_scenario.out)["agree"] and of_scenario.code == 0
    assert found[0] == found[1]
    assert found[0]["allocator.port_azimuth_cmd"] > 0.01  # the system's own allocator turns nothing


def test_exports_hold_the_fmu_that_takes_the_place(swapped, call):
    assert call("export", "osp", "swapped", "--out", "osp").code == 0
    assert (swapped / "osp" / "optimal_allocator.fmu").is_file() and not (
        swapped / "osp" / "allocator.fmu"
    ).exists()
    option = ("--component", "allocator=extended_allocator")  # over the scenario's
    assert (
        call("export", "fmu", "swapped", *option, "--out", "block").code == 0
    )  # run beside the system first
    with zipfile.ZipFile(swapped / "block" / "gunnerus_dp.fmu") as block:
        held = {name.split("/")[1] for name in block.namelist() if name.startswith("resources/")}
    assert any(name.endswith("_extended_allocator") for name in held)
    assert not any(name.endswith("_allocator") and "extended" not in name for name in held)


def test_a_simulator_of_an_osp_structure_runs_another_fmu_too(swapped, call):
    assert (
        call(
            "export",
            "osp",
            "ssp/gunnerus_dp",
            "--stop-time",
            "1",
            "--step-size",
            "0.05",
            "--out",
            "osp",
        ).code
        == 0
    )
    result = call(
        "simulate",
        "osp",
        "--component",
        "allocator=optimal_allocator",
        "--stop-time",
        "1",
        "--out",
        "out",
    )
    assert result.code == 0, result.err
    table = shipcosim.read_table("out/result.nc")
    assert json.loads(table.attrs["fmus"])["allocator"]["file"] == "optimal_allocator.fmu"


def test_a_run_is_the_same_in_processes_of_its_own_and_repeated_from_its_table(swapped, call):
    assert call("run", "swapped", "--out", "here").code == 0
    assert call("run", "swapped", "--isolate", "--out", "apart").code == 0
    assert (swapped / "here" / "result.csv").read_text() == (
        swapped / "apart" / "result.csv"
    ).read_text()
    table, again = shipcosim.read_table("here/result.nc"), repeat("here/result.nc")
    assert all(bool((again[name] == table[name]).all()) for name in table.data_vars)


def test_a_run_goes_on_from_its_state_and_not_with_another_fmu(swapped, call):
    assert call("run", "swapped", "--until", "0.7", "--store", "state", "--out", "first").code == 0
    assert call("run", "swapped", "--from", "state", "--out", "second").code == 0
    assert call("run", "swapped", "--out", "whole").code == 0
    second, whole = (shipcosim.read_table(f"{name}/result.nc") for name in ("second", "whole"))
    assert float(abs(second["vessel.x"][-1] - whole["vessel.x"][-1])) == 0.0
    refused = call(
        "run",
        "swapped",
        "--from",
        "state",
        "--component",
        "allocator=extended_allocator",
        "--out",
        "no",
    )
    assert (
        refused.code == 2
        and "extended_allocator.fmu is another FMU than the one that was stored" in refused.err
    )
