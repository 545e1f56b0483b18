"""A system as one FMU: what it computes is held against the system itself and against other hosts."""

import json
import zipfile
from dataclasses import replace

import numpy as np
import pytest

from shipcosim.cosim import engines_missing, export_fmu, simulate
from shipcosim.cosim.container import PLATFORMS
from shipcosim.cosim.export_fmu import block_of
from shipcosim.errors import ShipcosimError
from shipcosim.scenario import Scenario
from shipcosim.ssp import read_fmu, read_system

CONVERSION = '|<ssc:LinearTransformation factor="2"/>'
TYPED = ["clock.count -> meter.number", "clock.odd -> meter.flag", "clock.text -> meter.text"]


@pytest.fixture
def chain(make_system):
    """Lag and integrator behind an input of the system."""
    return make_system(
        {"integrator": ("integrator", {"y_start": 3.0}), "lag": ("lag", {"time_constant": 0.5})},
        ["u -> lag.u", "lag.y -> integrator.u", "integrator.y -> y"],
        {"u": ("input", "Real", ""), "y": ("output", "Real", "")},
    )


def block_values(fmu, stop_time, step_size, engine="fmpy", **values):
    """Table of the FMU alone, its signals named as in the system."""
    scenario = Scenario(stop_time=stop_time, step_size=step_size, set={f"block.{n}": v for n, v in values.items()})
    table = simulate(block_of(fmu), scenario, engine=engine)
    return table.rename({name: name.removeprefix("block.") for name in table.data_vars})


def test_a_chain_follows_its_closed_form_in_one_block(chain, tmp_path):
    assert export_fmu(chain, tmp_path / "chain.fmu", 0.125) == []
    table = block_values(tmp_path / "chain.fmu", 2.0, 0.125, u=4.0)
    k = np.arange(17)
    lag = 4.0 * -np.expm1(-k * 0.125 / 0.5)
    assert np.allclose(table["lag.y"], lag, rtol=1e-14)
    assert np.allclose(table["y"], 3.0 + 0.125 * np.concatenate([[0.0], np.cumsum(lag[:-1])]), rtol=1e-14)


def test_one_large_step_outside_is_many_inside(chain, tmp_path):
    export_fmu(chain, tmp_path / "chain.fmu", 0.125)
    fine, coarse = (block_values(tmp_path / "chain.fmu", 2.0, step, u=4.0) for step in (0.125, 0.5))
    assert np.array_equal(fine["y"][::4], coarse["y"])


def test_the_block_shows_connectors_parameters_and_signals_as_the_system_has_them(make_system, tmp_path):
    connectors = {"speed": ("input", "Real", 'unit="rad/s"'), "out": ("output", "Real", 'unit="rpm"')}
    connectors |= {"gear": ("parameter", "Real", "")}
    lines = ["speed -> shaft.speed", "shaft.rpm -> out", "gear -> gain.factor"]
    system = make_system({"shaft": "shaft", "gain": ("gain", {"offset": 2.5})}, lines, connectors)
    export_fmu(system, tmp_path / "shaft.fmu", 0.1)
    fmu = read_fmu(tmp_path / "shaft.fmu")
    facts = {n: (v.causality, v.unit, v.start, v.description) for n, v in fmu.variables.items() if n != "time"}
    assert facts == {
        "speed": ("input", "rad/s", 0.0, ""),
        "gear": ("parameter", "1", 1.0, ""),
        "out": ("output", "rpm", None, ""),
        "shaft.angle": ("input", "deg", 0.0, "angle"),
        "shaft.rpm": ("output", "rpm", None, "speed times ten"),
        "shaft.torque": ("output", "N.m", None, "torque"),
        "gain.u": ("input", "1", 0.0, "input"),
        "gain.y": ("output", "1", None, "factor times input plus offset"),
        "gain.offset": ("parameter", "1", 2.5, "offset"),
    }
    assert fmu.units["deg"].factor == pytest.approx(np.pi / 180) and fmu.experiment["stepSize"] == 0.1
    own = export_fmu(system, tmp_path / "own.fmu", 0.1, connectors_only=True)
    assert own == [] and set(read_fmu(tmp_path / "own.fmu").variables) == {"time", "speed", "gear", "out"}


def test_values_of_all_types_go_in_and_out(make_system, tmp_path):
    system = make_system({"clock": "clock", "meter": ("meter", {"text": "abc", "real": 0.25})}, TYPED)
    export_fmu(system, tmp_path / "typed.fmu", 0.1)
    table = block_values(tmp_path / "typed.fmu", 1.0, 0.1)
    theirs = simulate(system, Scenario(stop_time=1.0, step_size=0.1))
    for name in ("meter.y", "meter.number_seen", "clock.odd", "clock.count"):
        assert np.array_equal(table[name], theirs[name]), name
    assert table["meter.y"][-1] == 1000.0 + 9 + 0.001 * len("9 of them") + 0.25


def test_a_chain_of_direct_feedthrough_starts_as_in_the_system(make_system, tmp_path):
    parts = {name: ("gain", {"factor": 2.0}) for name in ("d", "c", "b", "a")} | {"source": ("lag", {"y_start": 1.0})}
    lines = ["source.y -> a.u", "a.y -> b.u", "b.y -> c.u", "c.y -> d.u"]
    system = make_system(parts, lines)
    export_fmu(system, tmp_path / "gains.fmu", 0.1)
    assert block_values(tmp_path / "gains.fmu", 0.1, 0.1)["d.y"][0] == 16.0


def test_a_loop_whose_start_needs_passes_gets_them(make_system, tmp_path):
    parts = {name: ("gain", {"factor": -1.0, "offset": 1.0}) for name in ("b", "a")}
    parts |= {"lag": ("lag", {"y_start": 3.0}), "gain": ("gain", {"factor": 2.0})}
    lines = ["lag.y -> gain.u", "gain.y -> a.u", "a.y -> b.u", "b.y -> lag.u"]
    system = make_system(parts, lines)
    export_fmu(system, tmp_path / "loop.fmu", 0.1)
    with zipfile.ZipFile(tmp_path / "loop.fmu") as archive:
        assert len(json.loads(archive.read("resources/container.json"))["connections"]) == 2 * len(lines)
    table, theirs = (
        block_values(tmp_path / "loop.fmu", 3.0, 0.1),
        simulate(system, Scenario(stop_time=3, step_size=0.1)),
    )
    assert np.allclose(table["lag.y"], theirs["lag.y"], rtol=1e-12) and table["b.y"][0] == 6.0


@pytest.mark.parametrize(
    ("parts", "lines", "said"),
    [
        ({"a": "lag", "b": "lag"}, [f"a.y -> b.u {CONVERSION}"], "multiplied by 2 and 0 added"),
        ({"a": "shaft", "b": "shaft"}, ["a.rpm -> b.speed"], "multiplied by 0.10472 and 0 added .unit conversion"),
        ({"a": "lag", "b": ("lag", {}, 0.2)}, ["a.y -> b.u"], "has a step of 0.2 s of its own"),
        ({"a": "clock", "b": "meter"}, ["a.count -> b.real"], "different types, Int32 and Float64"),
    ],
    ids=["transformation", "units", "steps", "types"],
)
def test_what_the_container_cannot_express_is_refused(make_system, tmp_path, parts, lines, said):
    with pytest.raises(ShipcosimError, match=said):
        export_fmu(make_system(parts, lines), tmp_path / "no.fmu", 0.1)
    assert not (tmp_path / "no.fmu").exists()


@pytest.mark.parametrize(
    ("change", "said"),
    [({"initial": True}, "goes into a parameter"), ({"mapping": {1: 2}}, "values are replaced by others")],
    ids=["handover", "mapping"],
)
def test_connections_with_more_than_a_copy_are_refused(chain, tmp_path, change, said):
    system = replace(chain, connections=tuple(replace(c, **change) for c in chain.connections))
    with pytest.raises(ShipcosimError, match=said):
        export_fmu(system, tmp_path / "no.fmu", 0.125)


def test_a_block_that_computes_something_else_is_not_written(make_system, tmp_path, monkeypatch):
    from shipcosim.cosim import export_fmu as exported

    monkeypatch.setattr("shipcosim.cosim.container.feeders_first", lambda system: list(system.components))
    module = __import__("sys").modules[exported.__module__]
    monkeypatch.setattr(module, "SWEEPS", (1,))
    parts = {name: ("gain", {"factor": 2.0}) for name in ("c", "b", "a")} | {"source": ("lag", {"y_start": 1.0})}
    system = make_system(parts, ["source.y -> a.u", "a.y -> b.u", "b.y -> c.u"])
    with pytest.raises(ShipcosimError, match=r"c.y is 8 at t = 0 s, in the FMU 0"):
        export_fmu(system, tmp_path / "no.fmu", 0.1)
    assert not (tmp_path / "no.fmu").exists()


def test_the_same_system_gives_the_same_bytes(chain, tmp_path):
    for name in ("one", "two"):
        export_fmu(chain, tmp_path / f"{name}.fmu", 0.125, check=name == "one")
    assert (tmp_path / "one.fmu").read_bytes() == (tmp_path / "two.fmu").read_bytes()


def test_the_block_is_a_valid_fmu_with_fmpys_libraries(chain, tmp_path):
    from fmpy.validation import validate_fmu

    export_fmu(chain, tmp_path / "chain.fmu", 0.125)
    assert validate_fmu(str(tmp_path / "chain.fmu")) == []
    with zipfile.ZipFile(tmp_path / "chain.fmu") as archive:
        names, configuration = archive.namelist(), json.loads(archive.read("resources/container.json"))
    assert {name.split("/")[1] for name in names if name.startswith("binaries/")} == set(PLATFORMS)
    assert [part["name"] for part in configuration["components"]] == ["integrator", "lag"]


@pytest.mark.parametrize("engine", ["libcosim", "ecos"])
def test_other_engines_run_the_block_to_the_same_values(chain, tmp_path, engine, needs):
    if engine in engines_missing():
        needs(engine)
    export_fmu(chain, tmp_path / "chain.fmu", 0.125)
    ours, theirs = (block_values(tmp_path / "chain.fmu", 50.0, 0.125, name, u=4.0) for name in ("fmpy", engine))
    assert np.allclose(ours["y"], theirs["y"], rtol=1e-12)


def test_fmpy_itself_runs_the_block(chain, tmp_path):
    from fmpy import simulate_fmu

    export_fmu(chain, tmp_path / "chain.fmu", 0.125)
    ours = block_values(tmp_path / "chain.fmu", 20.0, 0.125, u=4.0)
    inputs = {"start_values": {"u": 4.0}, "output": ["y"]}
    theirs = simulate_fmu(tmp_path / "chain.fmu", stop_time=20.0, step_size=0.125, output_interval=0.125, **inputs)
    assert np.array_equal(ours["y"], theirs["y"])


def test_the_dp_ship_is_one_block(root, tmp_path):
    fmus = root / "build" / "fmus"
    if not fmus.is_dir():
        pytest.skip("needs the project's FMUs: shipcosim build")
    system = read_system(root / "ssp" / "gunnerus_dp", fmus=[fmus])
    export_fmu(system, tmp_path / "ship.fmu", 0.05)
    scenario = Scenario(stop_time=20.0, step_size=0.05)
    ours, block = simulate(system, scenario), block_values(tmp_path / "ship.fmu", 20.0, 0.05)
    shown = [name for name in block.data_vars if name in ours and block[name].dtype.kind == "f"]
    assert {"vessel.x", "vessel.psi", "port.thrust", "predictor.x_10"} <= set(shown)
    for name in shown:  # times are rounded once more inside: 1e-13 of the range after 20 s
        assert np.allclose(block[name], ours[name], rtol=0.0, atol=1e-10 * max(abs(ours[name]).max(), 1e-6)), name
    mass = read_fmu(tmp_path / "ship.fmu").variables["vessel.mass"]
    assert (mass.causality, mass.unit, mass.start) == ("parameter", "kg", system.components["vessel"].start["mass"])
