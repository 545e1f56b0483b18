"""The engine with compiled models against the one in Python: the same table, state, errors and interrupts."""

import importlib.util
import json
from types import SimpleNamespace

import numpy as np
import pytest

from shipcosim.cosim import RunError, RunOptions, simulate
from shipcosim.cosim.master import compiled
from shipcosim.cosim.master import run as own
from shipcosim.cosim.master.run import Interrupted
from shipcosim.cosim.systems import system_of
from shipcosim.errors import ShipcosimError, error_at
from shipcosim.native.compiler import run_compiler
from shipcosim.scenario import Event, read_scenario

NATIVE = RunOptions(engine="native")
PYTHON = RunOptions(engine="fmpy")
SCENARIOS = (
    "four_corner",
    "drift",
    "failures/bus_a_short_of_power",
    "allocation/four_corner_extended",
    "prediction/gnss_loss",
    "paper_i/exercise",
)
CLOSE = 1e-12
OPTIMISED = 1e-8  # with an optimal allocator, whose equations enlarge rounding by some 1e6


@pytest.fixture(autouse=True, scope="session")
def compiler(needs):
    if importlib.util.find_spec("ziglang") is None:
        needs("ziglang", 'Install it: pip install -e ".[native]".')


def by_python(table):
    """Components that Python stepped, by the table's remarks."""
    remarks = [
        text
        for text in json.loads(table.attrs["remarks"])
        if text.startswith("stepped by Python, ")
    ]
    return {text.split(", ", 1)[1].partition(":")[0]: text for text in remarks}


def far_off(table, other, close=CLOSE):
    """Signals that differ by more than rounding, over the largest range of their unit."""
    spans = {}
    for values in table.values():
        unit = values.attrs.get("unit", "")
        spans[unit] = max(spans.get(unit, 1e-12), float(np.ptp(values.values.astype(float))))
    found = {}
    for name, values in table.items():
        difference = np.abs(values.values.astype(float) - other[name].values.astype(float)).max()
        if difference > close * spans[values.attrs.get("unit", "")]:
            found[name] = difference
    return found


def both(scenario, until):
    system = system_of(scenario)
    options = {"until": until}
    return simulate(system, scenario, RunOptions(engine="fmpy", **options)), simulate(
        system, scenario, RunOptions(engine="native", **options)
    )


@pytest.mark.parametrize("name", SCENARIOS)
def test_the_table_is_that_of_python_but_for_rounding(root, name):
    python, native = both(read_scenario(root / "scenarios" / f"{name}.toml"), 40.0)
    assert list(native) == list(python) and native.attrs["engine"] == "native"
    assert native.time.values.tobytes() == python.time.values.tobytes()
    assert not far_off(python, native)
    assert not by_python(native)


@pytest.mark.parametrize("degrees", [0, 75, 200, 310])
def test_the_optimal_allocator_is_compiled_and_gives_what_python_gives(root, degrees):
    scenario = read_scenario(root / "scenarios" / "held.toml")
    values = {**scenario.set, "environment.wind_from": f"{degrees} deg"}
    scenario = scenario.model_copy(
        update={"components": {"allocator": "optimal_allocator"}, "set": values}
    )
    python, native = both(scenario, 40.0)
    assert not by_python(native)
    assert not far_off(python, native, OPTIMISED)


def test_a_stored_run_goes_on_bit_for_bit(root):
    scenario = read_scenario(root / "scenarios" / "four_corner.toml")
    events = [
        Event(time=0.0, override={"reference.x_set": 20.0}),
        Event(time=12.0, override={"port.failed": True}),
    ]
    scenario = scenario.model_copy(
        update={"stop_time": 20.0, "output_interval": None, "events": events, "expect": []}
    )
    system, stored = system_of(scenario), []
    whole = simulate(system, scenario, NATIVE)
    first = simulate(system, scenario, RunOptions(engine="native", until=8.35, store=stored.append))
    rest = simulate(system, scenario, RunOptions(engine="native", resume=stored[0]))
    n = first.sizes["time"] - 1
    for name in whole:
        parts = np.concatenate([first[name].values[:n], rest[name].values])
        assert parts.tobytes() == whole[name].values.tobytes(), name
    in_python = simulate(system, scenario, RunOptions(resume=stored[0]))
    assert not far_off(
        rest, in_python
    )  # a stored state is that of the FMUs: either engine goes on from it


def test_values_of_all_types_are_exchanged_as_in_python(make_system, make_scenario):
    parts = {
        "clock": "clock",
        "meter": "meter",
        "slow": ("meter", {}, 0.3),
        "lag": ("lag", {"y_start": 2.0}),
    }
    lines = [
        "clock.count -> meter.number",
        "clock.odd -> meter.flag",
        'lag.y -> meter.real | <ssc:LinearTransformation factor="3" offset="1"/>',
        "clock.count -> slow.number",
        "meter.y -> lag.u",
    ]
    events = [
        {"time": 0.5, "override": {"meter.flag": True}, "bias": {"lag.u": 2.0}},
        {"time": 1.2, "reset": ["lag.u"]},
    ]
    system, scenario = make_system(parts, lines), make_scenario(2.4, 0.1, events=events)
    python, native = simulate(system, scenario, PYTHON), simulate(system, scenario, NATIVE)
    assert "clock" in by_python(native)  # it makes a text of a number
    for name in python:
        assert np.allclose(native[name], python[name], rtol=1e-13, atol=0.0), name


def test_foreign_fmus_are_stepped_beside_compiled_ones(pythonfmu_system, make_scenario):
    system, scenario = pythonfmu_system("t + h"), make_scenario(1.0, 0.1)
    native = simulate(system, scenario, NATIVE)
    assert np.allclose(native["stock.y"], native.time)
    assert by_python(native)["stock"] == "stepped by Python, stock: its code is not ours"
    assert native.attrs["stepped_by_python"] == "stock, other"


def test_an_error_is_said_as_in_python_and_keeps_its_rows(make_system, make_scenario):
    system = make_system({"clock": "clock", "engine": ("failing", {"how": "raise"})})
    said = []
    for options in (RunOptions(), NATIVE):
        with pytest.raises(RunError) as error:
            simulate(system, make_scenario(1.0, 0.1), options)
        text = str(error.value.problems[0])
        said.append(
            (text.splitlines()[0], "50%s of it is wrong" in text, error.value.table.sizes["time"])
        )
    assert said[0] == said[1] and said[0][1:] == (True, 6)


def test_ctrl_c_keeps_the_rows(make_system, make_scenario):
    system = make_system({"clock": "clock", "engine": ("failing", {"how": "stop"})})
    with pytest.raises(Interrupted) as interrupted:
        simulate(system, make_scenario(1.0, 0.1), NATIVE)
    assert interrupted.value.table["clock.count"].values.tolist() == list(range(7))


def test_another_order_and_a_missing_compiler_are_said_and_run_in_python(
    make_system, make_scenario, monkeypatch
):
    system, scenario = make_system({"lag": ("lag", {"u": 3.0})}), make_scenario()
    python = simulate(system, scenario)
    table = simulate(system, scenario, RunOptions(engine="native", order="gauss-seidel"))
    assert "in the order gauss-seidel" in by_python(table)["all components"]
    monkeypatch.setattr(compiled, "is_installed", lambda: False)
    table = simulate(system, scenario, NATIVE)
    assert "pip install 'shipcosim[native]'" in by_python(table)["all components"]
    assert table["lag.y"].values.tolist() == python["lag.y"].values.tolist()


def test_auto_compiles_a_run_that_is_long_and_no_other(make_system, make_scenario, monkeypatch):
    system, scenario = make_system({"lag": ("lag", {"u": 3.0})}), make_scenario()
    python = simulate(system, scenario, RunOptions(engine="fmpy"))
    assert simulate(system, scenario).attrs["engine"] == "fmpy"
    monkeypatch.setattr(own, "LONG", 10)
    table = simulate(system, scenario)
    assert table.attrs["engine"] == "native" and not by_python(table)
    assert np.allclose(table["lag.y"], python["lag.y"], rtol=1e-13, atol=0.0)
    for options in (
        {"order": "gauss-seidel"},
        {"isolate": True},
        {"realtime": 1000.0},
        {"until": 0.2},
    ):
        assert simulate(system, scenario, RunOptions(**options)).attrs["engine"] == "fmpy"
    monkeypatch.setattr(compiled, "is_installed", lambda: False)
    assert simulate(system, scenario).attrs["engine"] == "fmpy"


def test_a_compiler_that_fails_is_said_and_python_steps(make_system, make_scenario, monkeypatch):
    def failing(sources):
        raise error_at("compiler", "fails: no space left.")

    system, scenario = make_system({"lag": ("lag", {"u": 3.0})}), make_scenario()
    python = simulate(system, scenario)
    monkeypatch.setattr(compiled, "libraries", failing)
    monkeypatch.setattr(own, "LONG", 10)
    for engine in ("auto", "native"):
        table = simulate(system, scenario, RunOptions(engine=engine))
        assert "no space left" in by_python(table)["all components"]
        assert table.attrs["engine"] == "fmpy"
        assert table["lag.y"].values.tolist() == python["lag.y"].values.tolist()


def test_a_compiler_that_ends_without_a_word_is_said_with_its_code(tmp_path, monkeypatch):
    """As it does where the disk of the cache is full."""
    ended = SimpleNamespace(returncode=-6, stderr="")
    monkeypatch.setattr("shipcosim.native.compiler.subprocess.run", lambda *_, **__: ended)
    with pytest.raises(ShipcosimError, match="compiler: fails: it ends with code -6"):
        run_compiler([], tmp_path)
