"""A component runs another FMU: it fits where it has what is wired, and whatever is wrong is one clear error."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import shipcosim
from shipcosim import library
from shipcosim.cli import app
from shipcosim.errors import ShipcosimError
from shipcosim.fmi.export.builder import build_fmu
from shipcosim.scenario import check_files, read_scenario
from shipcosim.ssp import read_system

FEWER = '''
"""An allocator that lacks a weight."""

from shipcosim.fmi import Parameters
from shipcosim.interfaces import NamedAllocator
from shipcosim.models.allocation import pseudo_inverse
from shipcosim.models.allocation.units import NamedUnits


class Fewer(NamedAllocator):
    """Has only what describes the units; it is not run."""

    model = Parameters(NamedUnits)
    law = pseudo_inverse
'''


@pytest.fixture(scope="module")
def dp(root):
    """Function from FMUs by component to the DP system of R/V Gunnerus."""
    path = root / "ssp" / "gunnerus_dp"

    def read(**components):
        values = path / "resources" / "gunnerus-33m9.ssv"
        return read_system(path, values, fmus=library.fmus(path), components=components)

    return read


def fmu(name):
    return library.find("fmu", name)


def refusal(read, **components):
    with pytest.raises(ShipcosimError) as error:
        read(**components)
    return str(error.value)


def test_an_fmu_of_the_same_interface_takes_another_ones_place(dp):
    own, other = dp(), dp(allocator=fmu("extended_allocator"))
    assert other.components["allocator"].fmu.path.name == "extended_allocator.fmu"
    assert other.connections == own.connections and not own.swapped
    assert dict(other.swapped) == {"allocator": str(fmu("extended_allocator"))}
    assert (
        other.components["allocator"].start["port_x"] == own.components["allocator"].start["port_x"]
    )
    assert not [remark for remark in other.remarks if remark.where.startswith("components")]


def test_what_is_wired_and_missing_is_named_at_once_with_what_is_close(dp):
    text = refusal(dp, allocator=fmu("fixed_angle_allocator"))
    assert text.count("components, allocator") == 1
    assert (
        "fixed_angle_allocator.fmu cannot take the place of 'allocator': it lacks port_available, starboard_available"
        in text
    )
    assert "(port_thrust_cmd)" in text and "tau_X_cmd," not in text


def test_an_fmu_of_quite_another_kind_is_refused_with_what_it_has(dp):
    assert "It has: psi, tau_X, tau_Y, tau_N." in refusal(dp, allocator=fmu("drift_force"))


def test_a_component_that_is_not_there_is_an_error(dp):
    assert "There is no component 'alocator'" in (text := refusal(dp, alocator=fmu("allocator")))
    assert "Did you mean 'allocator'?" in text


def test_values_for_parameters_that_it_has_not_are_said_in_one_remark(dp, tmp_path):
    (tmp_path / "fewer.py").write_text(FEWER, encoding="utf-8")
    system = dp(allocator=build_fmu(tmp_path / "fewer.py", tmp_path))
    (remark,) = [remark for remark in system.remarks if remark.where == "components, allocator"]
    assert remark.found == "fewer.fmu takes its place and has no azimuth_weight, tunnel_weight."
    assert remark.severity == "remark"


def scenario_file(tmp_path, root, fmu):
    """Stationkeeping for two seconds with another allocator."""
    text = (
        (root / "scenarios" / "stationkeeping.toml")
        .read_text(encoding="utf-8")
        .partition("[[events]]")[0]
    )
    text = text.replace("stop_time       = 600.0 ", "stop_time       = 2.0 ")
    path = tmp_path / "other.toml"
    path.write_text(f'{text}\n[components]\nallocator = "{fmu}"\n', encoding="utf-8")
    return path


def test_a_scenario_swaps_a_component_and_says_at_the_line_what_is_not_there(tmp_path, root):
    run = shipcosim.run(scenario_file(tmp_path, root, "extended_allocator"))
    assert run.system.components["allocator"].fmu.path.name == "extended_allocator.fmu"
    assert float(abs(run["allocator.port_azimuth_cmd"][-1])) != pytest.approx(0.7853981633974483)
    scenario = read_scenario(scenario_file(tmp_path, root, "extended_alocator"))
    (problem,) = check_files(scenario)
    line = Path(scenario.path).read_text(encoding="utf-8").count("\n")
    assert (
        problem.where.endswith(f"line {line}")
        and "Did you mean 'extended_allocator'?" in problem.remedy
    )


def test_the_command_line_goes_over_the_scenario_and_the_page_says_so(tmp_path, root, monkeypatch):
    monkeypatch.chdir(root)
    path, out = scenario_file(tmp_path, root, "extended_allocator"), tmp_path / "out"
    arguments = ["run", str(path), "--out", str(out), "--component", "allocator=allocator"]
    assert CliRunner().invoke(app, arguments).exit_code == 0
    table = shipcosim.read_table(out / "result.nc")
    assert json.loads(table.attrs["changed"]) == ["allocator runs allocator"]
    assert json.loads(table.attrs["fmus"])["allocator"]["file"] == "allocator.fmu"
    assert "allocator runs allocator" in (out / "report.html").read_text(encoding="utf-8")
    again = shipcosim.run(path, components={"allocator": "allocator"})
    assert float(abs(table["vessel.y"] - again["vessel.y"]).max()) == 0.0


@pytest.mark.parametrize(
    "given", ["allocator", "allocator=", "=allocator", "allocator=no_such_fmu"]
)
def test_what_swaps_nothing_is_one_error(given, root, monkeypatch):
    monkeypatch.chdir(root)
    result = CliRunner().invoke(app, ["run", "stationkeeping", "--component", given])
    assert (
        result.exit_code == 2
        and "--component" in result.stderr
        and "Traceback" not in result.stderr
    )
