"""A system as one FMU: what it computes is held against the system itself and against other hosts."""

import json
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from dataclasses import replace
from pathlib import Path

import c_fmus
import numpy as np
import pytest

from shipcosim.cosim import RunError, RunOptions, engines_missing, export_fmu, simulate
from shipcosim.cosim.export.container import PLATFORMS
from shipcosim.cosim.export.fmu import block_of
from shipcosim.errors import ShipcosimError
from shipcosim.scenario import Scenario
from shipcosim.ssp import Component, Connection, System, read_fmu, read_system

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
    scenario = Scenario(
        stop_time=stop_time, step_size=step_size, set={f"block.{n}": v for n, v in values.items()}
    )
    table = simulate(block_of(fmu), scenario, RunOptions(engine=engine))
    return table.rename({name: name.removeprefix("block.") for name in table.data_vars})


def test_a_chain_follows_its_closed_form_in_one_block(chain, tmp_path):
    assert export_fmu(chain, tmp_path / "chain.fmu", 0.125) == []
    table = block_values(tmp_path / "chain.fmu", 2.0, 0.125, u=4.0)
    k = np.arange(17)
    lag = 4.0 * -np.expm1(-k * 0.125 / 0.5)
    assert np.allclose(table["lag.y"], lag, rtol=1e-14)
    assert np.allclose(
        table["y"], 3.0 + 0.125 * np.concatenate([[0.0], np.cumsum(lag[:-1])]), rtol=1e-14
    )


def test_one_large_step_outside_is_many_inside(chain, tmp_path):
    export_fmu(chain, tmp_path / "chain.fmu", 0.125, check=False)
    fine, coarse = (block_values(tmp_path / "chain.fmu", 2.0, step, u=4.0) for step in (0.125, 0.5))
    assert np.array_equal(fine["y"][::4], coarse["y"])


def test_the_block_shows_connectors_parameters_and_signals_as_the_system_has_them(
    make_system, tmp_path
):
    connectors = {
        "speed": ("input", "Real", 'unit="rad/s"'),
        "out": ("output", "Real", 'unit="rpm"'),
    }
    connectors |= {"gear": ("parameter", "Real", "")}
    lines = ["speed -> shaft.speed", "shaft.rpm -> out", "gear -> gain.factor"]
    system = make_system({"shaft": "shaft", "gain": ("gain", {"offset": 2.5})}, lines, connectors)
    export_fmu(system, tmp_path / "shaft.fmu", 0.1, check=False)
    fmu = read_fmu(tmp_path / "shaft.fmu")
    facts = {
        n: (v.causality, v.unit, v.start, v.description)
        for n, v in fmu.variables.items()
        if n != "time"
    }
    assert facts == {
        "speed": ("input", "rad/s", 0.0, "speed"),
        "gear": ("parameter", "1", 1.0, "factor"),
        "out": ("output", "rpm", None, "speed times ten"),
        "shaft.angle": ("input", "deg", 0.0, "angle"),
        "shaft.rpm": ("output", "rpm", None, "speed times ten"),
        "shaft.torque": ("output", "N.m", None, "torque"),
        "gain.u": ("input", "1", 0.0, "input"),
        "gain.y": ("output", "1", None, "factor times input plus offset"),
        "gain.offset": ("parameter", "1", 2.5, "offset"),
    }
    assert (
        fmu.units["deg"].factor == pytest.approx(np.pi / 180) and fmu.experiment["stepSize"] == 0.1
    )
    own = export_fmu(system, tmp_path / "own.fmu", 0.1, connectors_only=True, check=False)
    assert own == [] and set(read_fmu(tmp_path / "own.fmu").variables) == {
        "time",
        "speed",
        "gear",
        "out",
    }


def test_values_of_all_types_go_in_and_out(make_system, tmp_path):
    system = make_system(
        {"clock": "clock", "meter": ("meter", {"text": "abc", "real": 0.25})}, TYPED
    )
    export_fmu(system, tmp_path / "typed.fmu", 0.1, check=False)
    table = block_values(tmp_path / "typed.fmu", 1.0, 0.1)
    theirs = simulate(system, Scenario(stop_time=1.0, step_size=0.1))
    for name in ("meter.y", "meter.number_seen", "clock.odd", "clock.count"):
        assert np.array_equal(table[name], theirs[name]), name
    assert table["meter.y"][-1] == 1000.0 + 9 + 0.001 * len("9 of them") + 0.25


def test_a_chain_of_direct_feedthrough_starts_as_in_the_system(make_system, tmp_path):
    parts = {name: ("gain", {"factor": 2.0}) for name in ("d", "c", "b", "a")} | {
        "source": ("lag", {"y_start": 1.0})
    }
    lines = ["source.y -> a.u", "a.y -> b.u", "b.y -> c.u", "c.y -> d.u"]
    system = make_system(parts, lines)
    export_fmu(system, tmp_path / "gains.fmu", 0.1, check=False)
    assert block_values(tmp_path / "gains.fmu", 0.1, 0.1)["d.y"][0] == 16.0


def test_a_loop_whose_start_needs_passes_gets_them(make_system, tmp_path):
    parts = {name: ("gain", {"factor": -1.0, "offset": 1.0}) for name in ("b", "a")}
    parts |= {"lag": ("lag", {"y_start": 3.0}), "gain": ("gain", {"factor": 2.0})}
    lines = ["lag.y -> gain.u", "gain.y -> a.u", "a.y -> b.u", "b.y -> lag.u"]
    system = make_system(parts, lines)
    export_fmu(system, tmp_path / "loop.fmu", 0.1)
    with zipfile.ZipFile(tmp_path / "loop.fmu") as archive:
        assert len(json.loads(archive.read("resources/container.json"))["connections"]) == 2 * len(
            lines
        )
    table, theirs = (
        block_values(tmp_path / "loop.fmu", 3.0, 0.1),
        simulate(system, Scenario(stop_time=3, step_size=0.1)),
    )
    assert np.allclose(table["lag.y"], theirs["lag.y"], rtol=1e-12) and table["b.y"][0] == 6.0


@pytest.mark.parametrize(
    ("parts", "lines", "said"),
    [
        ({"a": "lag", "b": "lag"}, [f"a.y -> b.u {CONVERSION}"], "multiplied by 2 and 0 added"),
        (
            {"a": "shaft", "b": "shaft"},
            ["a.rpm -> b.speed"],
            "multiplied by 0.10472 and 0 added .unit conversion",
        ),
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
    [
        ({"initial": True}, "goes into a parameter"),
        ({"mapping": {1: 2}}, "values are replaced by others"),
    ],
    ids=["handover", "mapping"],
)
def test_connections_with_more_than_a_copy_are_refused(chain, tmp_path, change, said):
    system = replace(chain, connections=tuple(replace(c, **change) for c in chain.connections))
    with pytest.raises(ShipcosimError, match=said):
        export_fmu(system, tmp_path / "no.fmu", 0.125)


def test_a_block_that_computes_something_else_is_not_written(make_system, tmp_path, monkeypatch):
    monkeypatch.setattr(
        "shipcosim.cosim.export.container.sources_first", lambda system: list(system.components)
    )
    monkeypatch.setattr("shipcosim.cosim.export.fmu.SWEEPS", (1,))
    parts = {name: ("gain", {"factor": 2.0}) for name in ("c", "b", "a")} | {
        "source": ("lag", {"y_start": 1.0})
    }
    system = make_system(parts, ["source.y -> a.u", "a.y -> b.u", "b.y -> c.u"])
    with pytest.raises(ShipcosimError, match=r"c.y is 8 at t = 0 s, in the FMU 0"):
        export_fmu(system, tmp_path / "no.fmu", 0.1)
    assert not (tmp_path / "no.fmu").exists()


def test_a_block_that_kills_its_process_is_an_error(chain, tmp_path, monkeypatch):
    from shipcosim.cosim.export import container

    right = container._component
    monkeypatch.setattr(
        container, "_component", lambda *a: right(*a) | {"modelIdentifier": "not_there"}
    )
    with pytest.raises(ShipcosimError, match="block: "):
        export_fmu(chain, tmp_path / "no.fmu", 0.125)
    assert not (tmp_path / "no.fmu").exists()


def test_the_same_system_gives_the_same_bytes(chain, tmp_path):
    for name in ("one", "two"):
        export_fmu(chain, tmp_path / f"{name}.fmu", 0.125, check=name == "one")
    assert (tmp_path / "one.fmu").read_bytes() == (tmp_path / "two.fmu").read_bytes()


def test_the_block_is_a_valid_fmu_with_fmpys_libraries(chain, tmp_path):
    from fmpy.validation import validate_fmu

    export_fmu(chain, tmp_path / "chain.fmu", 0.125, check=False)
    assert validate_fmu(str(tmp_path / "chain.fmu")) == []
    with zipfile.ZipFile(tmp_path / "chain.fmu") as archive:
        names, configuration = (
            archive.namelist(),
            json.loads(archive.read("resources/container.json")),
        )
    assert {name.split("/")[1] for name in names if name.startswith("binaries/")} == set(PLATFORMS)
    assert [part["name"] for part in configuration["components"]] == ["integrator", "lag"]


@pytest.mark.parametrize("engine", ["libcosim", "ecos"])
def test_other_engines_run_the_block_to_the_same_values(chain, tmp_path, engine, needs):
    if engine in engines_missing():
        needs(engine)
    export_fmu(chain, tmp_path / "chain.fmu", 0.125, check=False)
    ours, theirs = (
        block_values(tmp_path / "chain.fmu", 50.0, 0.125, name, u=4.0) for name in ("fmpy", engine)
    )
    assert np.allclose(ours["y"], theirs["y"], rtol=1e-12)


def test_fmpy_itself_runs_the_block(chain, tmp_path):
    from fmpy import simulate_fmu

    export_fmu(chain, tmp_path / "chain.fmu", 0.125, check=False)
    ours = block_values(tmp_path / "chain.fmu", 20.0, 0.125, u=4.0)
    inputs = {"start_values": {"u": 4.0}, "output": ["y"]}
    theirs = simulate_fmu(
        tmp_path / "chain.fmu", stop_time=20.0, step_size=0.125, output_interval=0.125, **inputs
    )
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
        assert np.allclose(
            block[name], ours[name], rtol=0.0, atol=1e-10 * max(abs(ours[name]).max(), 1e-6)
        ), name
    mass = read_fmu(tmp_path / "ship.fmu").variables["vessel.mass"]
    assert (mass.causality, mass.unit, mass.start) == (
        "parameter",
        "kg",
        system.components["vessel"].start["mass"],
    )


def test_what_a_component_says_when_it_fails_comes_out_of_the_block(make_system, tmp_path):
    system = make_system({"one": ("failing", {"when": 0.5}), "two": "lag"}, ["one.y -> two.u"])
    export_fmu(system, tmp_path / "failing.fmu", 0.1, check=False)
    with pytest.raises(
        RunError,
        match="block: failed in the step from t = 0.5 s.*\n(.*\n)*.*ValueError: 50%s of it is",
    ):
        block_values(tmp_path / "failing.fmu", 1.0, 0.1)


DECAY = """
#define NX 1
#define NZ 0
#define STATES {0}
static void start(M* m) { m->r[0] = 1; }
static void equations(M* m) { m->r[1] = m->r[2] - m->r[0]; }
static void indicators(M* m, double* z) {}
static void event(M* m) { }
static int completed(M* m) { return 0; }
"""


@pytest.fixture
def decay(tmp_path, needs):
    """Function: FMU of a decay by Euler's method, in a version and form of FMI."""
    if c_fmus.compiler() is None:
        needs("a C compiler")
    variables = [
        ("x", 0, "output", "Real", None),
        ("der(x)", 1, "local", "Real", None),
        ("u", 2, "input", "Real", 0.0),
    ]

    def make(version, form="CoSimulation"):
        text = c_fmus.describe("decay", version, variables, (form,), 1)
        return read_fmu(c_fmus.build(tmp_path, "decay", version, DECAY, text, form))

    return make


def test_components_of_fmi_3_and_fmi_2_are_one_block(make_system, decay, tmp_path):
    lag = make_system({"lag": ("lag", {"y_start": 2.0})}).components["lag"]
    parts = {"decay": Component("decay", decay("3.0")), "lag": lag}
    lines = (Connection(("lag", "y"), ("decay", "u")), Connection(("decay", "x"), ("lag", "u")))
    system = System("mixed", "mixed.ssd", parts, lines)
    export_fmu(system, tmp_path / "mixed.fmu", 0.1, check=False)
    theirs = simulate(system, Scenario(stop_time=2.0, step_size=0.1))
    table = block_values(tmp_path / "mixed.fmu", 2.0, 0.1)
    assert (
        np.allclose(table["decay.x"], theirs["decay.x"], rtol=1e-13)
        and table["decay.x"][1] == 0.9 + 0.1 * 2.0
    )


@pytest.mark.parametrize(
    ("version", "form", "said"),
    [
        ("2.0", "ModelExchange", "is no co-simulation FMU"),
        ("1.0", "CoSimulation", "is no co-simulation FMU of FMI 2.0"),
    ],
)
def test_other_forms_are_refused(decay, tmp_path, version, form, said):
    system = System("one", "one.ssd", {"decay": Component("decay", decay(version, form))})
    with pytest.raises(ShipcosimError, match=said):
        export_fmu(system, tmp_path / "no.fmu", 0.1)


def test_the_block_runs_in_a_program_that_is_not_python(chain, root, tmp_path, needs):
    if not (
        sys.platform == "linux"
        and c_fmus.compiler()
        and sysconfig.get_config_var("Py_ENABLE_SHARED")
    ):
        needs("Linux, a C compiler and a Python with a shared library")
    export_fmu(chain, tmp_path / "chain.fmu", 0.125, check=False)
    with zipfile.ZipFile(tmp_path / "chain.fmu") as archive:
        archive.extractall(tmp_path / "chain")
    fmu = read_fmu(tmp_path / "chain.fmu")
    program, library = tmp_path / "host", tmp_path / "chain/binaries/linux64/container_fmu.so"
    source = root / "tests" / "system" / "fmi" / "host.c"
    subprocess.run(
        [c_fmus.compiler(), "-std=gnu11", "-w", "-o", program, source, "-ldl", "-lpthread"],
        check=True,
    )
    lines = [["load", "b", library, fmu.token, (tmp_path / "chain/resources").as_uri()]]
    lines += [["set", "b", "Real", fmu.variables["u"].value_reference, 4.0], ["begin", "b"]]
    lines += [["step", "b", k * 0.125, 0.125] for k in range(8)]
    lines += [["get", "b", "Real", fmu.variables["y"].value_reference], ["quit"]]
    text = "".join("\t".join(map(str, line)) + "\n" for line in lines)
    path = {"PATH": f"{Path(sys.executable).parent}:/usr/bin:/bin"}
    said = subprocess.run(
        [program], input=text, env=path, capture_output=True, text=True, timeout=600
    ).stdout
    answers = [line for line in said.splitlines() if not line.startswith("log ")]
    assert float(answers[-1]) == float(
        block_values(tmp_path / "chain.fmu", 1.0, 0.125, u=4.0)["y"][-1]
    )


def test_two_blocks_of_one_fmu_are_a_block_again(chain, tmp_path):
    export_fmu(chain, tmp_path / "chain.fmu", 0.125, check=False)
    fmu = read_fmu(tmp_path / "chain.fmu")
    parts = {
        "a": Component("a", fmu, {"u": 4.0}),
        "b": Component("b", fmu, {"lag.time_constant": 2.0}),
    }
    both = System("both", "both.ssd", parts, (Connection(("a", "y"), ("b", "u")),))
    export_fmu(both, tmp_path / "both.fmu", 0.125, check=False)
    table, block = (
        simulate(both, Scenario(stop_time=2.0, step_size=0.125)),
        block_values(tmp_path / "both.fmu", 2.0, 0.125),
    )
    assert np.array_equal(
        table["a.y"], block_values(tmp_path / "chain.fmu", 2.0, 0.125, u=4.0)["y"]
    )
    assert np.array_equal(table["b.y"], block["b.y"]) and not np.array_equal(
        table["b.y"], table["a.y"]
    )


def test_names_with_blanks_dots_and_brackets_are_kept(make_system, fmus, tmp_path):
    shutil.copy(fmus("lag") / "lag.fmu", tmp_path / "a lag [1].2 æ.fmu")
    fmu = read_fmu(tmp_path / "a lag [1].2 æ.fmu")
    parts = {name: Component(name, fmu, {"y_start": 1.0}) for name in ("the ship.no. 1", "b[2]")}
    lines = (Connection(("the ship.no. 1", "y"), ("b[2]", "u")),)
    export_fmu(System("odd", "odd.ssd", parts, lines), tmp_path / "odd.fmu", 0.1, check=False)
    assert {"the ship.no. 1.y", "b[2].y", "the ship.no. 1.u"} <= set(
        read_fmu(tmp_path / "odd.fmu").variables
    )
    assert block_values(tmp_path / "odd.fmu", 0.1, 0.1)["b[2].y"][1] == 1.0
