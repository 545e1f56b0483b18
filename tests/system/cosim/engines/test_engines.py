"""libcosim and ecos behind the same call: the same table as ours, or a refusal in words."""

import json
import shutil
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from shipcosim.cosim import ENGINES, Interrupted, RunError, RunOptions, engines_missing, simulate
from shipcosim.cosim.engines.registry import OWN
from shipcosim.errors import ShipcosimError
from shipcosim.scenario import read_scenario
from shipcosim.series import make_table
from shipcosim.ssp import read_system

OTHERS = [name for name in ENGINES if name not in OWN]
EXACT = {"libcosim": 0.0, "ecos": 1e-12}
"""Largest differences in a short run: ecos adds up its time."""


@pytest.fixture(params=OTHERS)
def engine(request, needs):
    """Each of the other engines that is installed."""
    if missing := engines_missing().get(request.param):
        needs(f"engine {request.param}", str(missing))
    return request.param


def assert_alike(ours, theirs, tolerance):
    """The same signals in the same form, as close as this."""
    assert list(ours.data_vars) == list(theirs.data_vars)
    np.testing.assert_array_equal(ours["time"].values, theirs["time"].values)
    for name, column in ours.data_vars.items():
        other = theirs[name]
        assert (column.attrs, column.dtype) == (other.attrs, other.dtype), name
        np.testing.assert_allclose(
            other.values.astype(float), column.values.astype(float), 0, tolerance, err_msg=name
        )


LOOP = {
    "plant": ("integrator", {"y_start": 0.3}),
    "filter": ("lag", {"time_constant": 0.7, "y_start": -0.2}),
    "law": ("gain", {"factor": -0.9, "offset": 0.123}),
    "clock": "clock",
    "meter": ("meter", {"number": 3, "text": "é" * 20000}),
}
CONNECTIONS = [
    "plant.y -> filter.u",
    'filter.y -> law.u | <ssc:LinearTransformation factor="1.7" offset="0.1"/>',
    "law.y -> plant.u",
    "clock.count -> meter.number",
    "clock.odd -> meter.flag",
]


@pytest.fixture
def loop(make_system):
    """A loop with a transformation, all types of values, and a text of 40 kB."""
    return make_system(LOOP, CONNECTIONS)


def test_table_is_ours(loop, make_scenario, engine):
    scenario = make_scenario(15.0, 0.05)
    ours, theirs = simulate(loop, scenario), simulate(loop, scenario, RunOptions(engine=engine))
    assert_alike(ours, theirs, EXACT[engine])
    assert ours["meter.number_seen"].values[-1] == 299
    assert theirs.attrs["engine"] == engine
    differing = {n for n, v in ours.attrs.items() if theirs.attrs[n] != v}
    assert differing - {"remarks"} == {"engine"}


def test_rows_at_the_output_interval(loop, make_scenario, engine):
    scenario = make_scenario(1.0, 0.05, output_interval=0.25)
    assert_alike(
        simulate(loop, scenario), simulate(loop, scenario, RunOptions(engine=engine)), EXACT[engine]
    )


EVENTS = [
    {"time": 0.0, "override": {"plant.u": 0.5}},
    {"time": 0.1, "override": {"law.u": 2.5}},
    {"time": 0.2, "bias": {"law.u": -0.25}},
    {"time": 0.3, "reset": ["law.u", "plant.u"]},
    {"time": 0.4, "override": {"plant.y": 1.5}},
    {"time": 0.5, "bias": {"plant.y": 0.125, "filter.u": 1e-5}},
    {"time": 0.6, "reset": ["plant.y"]},
    {"time": 0.7, "override": {"law.factor": -0.4, "meter.real": 7.0}},
    {"time": 0.8, "bias": {"meter.real": 2.0}},
    {"time": 0.8, "override": {"meter.real": 4.0}},
    {"time": 0.9, "reset": ["meter.real"]},
]


def test_events_act_alike(loop, make_scenario, engine):
    scenario = make_scenario(1.2, 0.05, events=EVENTS)
    ours = simulate(loop, scenario)
    assert_alike(ours, simulate(loop, scenario, RunOptions(engine=engine)), EXACT[engine])
    assert abs(ours["filter.y"] - simulate(loop, make_scenario(1.2, 0.05))["filter.y"]).max() > 0.05


def test_connected_values_of_other_types_change_in_libcosim_only(loop, make_scenario, engine):
    events = [
        {"time": 0.2, "override": {"meter.number": 50, "clock.odd": True}},
        {"time": 0.4, "reset": ["clock.odd"]},
    ]
    scenario = make_scenario(1.0, 0.05, events=events)
    if engine == "libcosim":
        assert_alike(
            simulate(loop, scenario), simulate(loop, scenario, RunOptions(engine=engine)), 0.0
        )
    else:
        with pytest.raises(ShipcosimError, match=r"meter\.number:? .*not Real"):
            simulate(loop, scenario, RunOptions(engine=engine))


def test_inputs_of_the_system_from_start_value_table_and_events(make_system, make_scenario, engine):
    system = make_system(
        {"law": ("gain", {"factor": 3.0}), "lag": "lag", "meter": "meter"},
        [
            ".push -> law.u | <ssc:LinearTransformation factor='2' offset='1'/>",
            "law.y -> lag.u",
            ".on -> meter.flag",
        ]
        + [".still -> meter.real", "lag.y -> .out"],
        {
            "push": ("input", "Real", ""),
            "on": ("input", "Boolean", ""),
            "still": ("input", "Real", ""),
            "out": ("output", "Real", ""),
        },
    )
    times = np.array([0.0, 0.2, 0.5, 1.0])
    table = make_table(
        times,
        [
            ("push", np.array([0.5, 1.0, -1.0, 0.0]), "", ""),
            ("on", np.array([False, True, False, True]), "", ""),
        ],
    )
    table["push"].attrs["interpolation"] = "linear"
    events = [{"time": 0.3, "bias": {"push": 10.0}}, {"time": 0.6, "reset": ["push"]}]
    scenario = make_scenario(1.0, 0.05, events=events, set={"still": 4.0})
    tables = [
        simulate(system, scenario, RunOptions(engine=name, inputs=table))
        for name in ("fmpy", engine)
    ]
    assert_alike(*tables, EXACT[engine])
    assert tables[1]["push"].values[6] == pytest.approx(1.0 - 2.0 / 3.0 + 10.0)


def test_step_of_its_own(make_system, make_scenario, engine):
    system = make_system(
        {"clock": "clock", "slow": ("lag", {"time_constant": 1.3}, 0.15)}, ["clock.time -> slow.u"]
    )
    scenario = make_scenario(3.0, 0.05)
    if engine == "libcosim":
        assert_alike(
            simulate(system, scenario), simulate(system, scenario, RunOptions(engine=engine)), 0.0
        )
    else:
        with pytest.raises(ShipcosimError, match="steps 3 base steps at a time"):
            simulate(system, scenario, RunOptions(engine=engine))


@pytest.mark.parametrize(
    "parts, connections, complaint",
    [
        ({"clock": "clock", "lag": "lag"}, ["clock.count -> lag.u"], "from Integer to Real"),
        (
            {"clock": "clock", "meter": "meter"},
            [
                'clock.count -> meter.number | <ssc:IntegerMappingTransformation><ssc:MapEntry source="1" target="9"/>'
                "</ssc:IntegerMappingTransformation>"
            ],
            "it maps values",
        ),
    ],
)
def test_what_an_engine_would_ignore_is_refused(
    make_system, make_scenario, engine, parts, connections, complaint
):
    system = make_system(parts, connections)
    with pytest.raises(ShipcosimError, match=f"{engine} cannot make this connection.*{complaint}"):
        simulate(system, make_scenario(), RunOptions(engine=engine))


def test_other_orders_are_refused(loop, make_scenario, engine):
    with pytest.raises(ShipcosimError, match="gauss-seidel"):
        simulate(loop, make_scenario(), RunOptions(engine=engine, order="gauss-seidel"))


def test_failure_gives_the_rows_before_it(make_system, make_scenario, engine):
    system = make_system({"failing": ("failing", {"when": 0.5})})
    if engine == "ecos":  # does not notice, and the table says that it would not
        assert (
            "does not say when an FMU fails"
            in simulate(system, make_scenario(), RunOptions(engine=engine)).attrs["remarks"]
        )
        return
    with pytest.raises(RunError, match="in the step from t = 0.5 s") as caught:
        simulate(system, make_scenario(1.0, 0.1), RunOptions(engine=engine))
    table = caught.value.table
    assert table["time"].values[-1] == 0.5 and table.attrs["complete"] == 0
    assert "failing" in str(caught.value)


def test_interrupt_gives_the_rows_before_it(loop, make_scenario, engine):
    def stop(done, total):
        if done:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(Interrupted) as caught:
        simulate(loop, make_scenario(2000.0, 0.05), RunOptions(engine=engine, progress=stop))
    table = caught.value.table
    assert table.attrs["complete"] == 0 and 100 <= table.sizes["time"] < 40001


def test_engines_leave_nothing_behind_that_another_run_would_import(
    pythonfmu_system, make_scenario, engine
):
    system = pythonfmu_system("float(helper.VALUE)", "VALUE = 1", "VALUE = 1")
    before = list(sys.path), set(sys.modules)
    simulate(system, make_scenario(), RunOptions(engine=engine))
    assert sys.path == before[0]
    assert {"helper", "model"}.isdisjoint(set(sys.modules) - before[1])


HIDDEN = """
import builtins, sys
real = builtins.__import__
def hiding(name, *rest, **more):
    if name.split(".")[0] in ("libcosimpy", "ecospy"):
        raise OSError("libtbb.so.12: cannot open shared object file") if name == "ecospy" else ImportError(name)
    return real(name, *rest, **more)
builtins.__import__ = hiding
from shipcosim.cosim import engines_missing
print({name: str(problem) for name, problem in engines_missing().items()})
"""


def test_missing_engines_say_what_to_install():
    said = subprocess.run(
        [sys.executable, "-c", HIDDEN], capture_output=True, text=True, check=True
    ).stdout
    assert "pip install libcosimpy" in said and "libtbb12" in said


def test_engines_agree_on_the_four_corners(root, engine):
    agree_on_the_four_corners(root, engine, stop_time=60.0)


def agree_on_the_four_corners(root, engine, stop_time):
    scenario = read_scenario(root / "scenarios" / "four_corner.toml")
    scenario = scenario.model_copy(
        update={"output_interval": None, "stop_time": stop_time, "expect": []}
    )
    system = read_system(
        scenario.system_path, scenario.parameter_paths, fmus=[root / "build" / "fmus"]
    )
    ours, theirs = (
        simulate(system, scenario, RunOptions(engine=name)) for name in ("fmpy", engine)
    )
    assert (
        list(ours.data_vars) == list(theirs.data_vars) and ours.sizes["time"] == 20 * stop_time + 1
    )
    for name, column in ours.data_vars.items():
        values = column.values.astype(float)
        assert np.abs(theirs[name].values - values).max() <= 1e-9 * np.ptp(values), name


def test_seeds_and_hashes_are_in_the_table(loop, make_scenario, engine):
    table = simulate(loop, make_scenario(), RunOptions(engine=engine))
    assert set(json.loads(table.attrs["fmus"])) == set(LOOP)
    assert json.loads(table.attrs["start_values"])["law.offset"] == 0.123


def test_names_with_dots_and_folders_with_blanks(make_system, make_scenario, engine, tmp_path):
    system = make_system({"clock": "clock", "lag": "lag"}, ["clock.time -> lag.u"])
    folder = tmp_path / "a folder, øre"
    folder.mkdir()
    components = {}
    for name, component in system.components.items():
        path = shutil.copy(component.fmu.path, folder)
        fmu = replace(component.fmu, path=Path(path))
        components[f"inner.{name}"] = replace(component, name=f"inner.{name}", fmu=fmu)
    inner = [
        replace(
            c,
            source=(f"inner.{c.source[0]}", c.source[1]),
            target=(f"inner.{c.target[0]}", c.target[1]),
        )
        for c in system.connections
    ]
    system = replace(system, components=components, connections=tuple(inner))
    scenario = make_scenario(1.0, 0.1, events=[{"time": 0.5, "bias": {"inner.lag.u": 1.0}}])
    assert_alike(
        simulate(system, scenario),
        simulate(system, scenario, RunOptions(engine=engine)),
        EXACT[engine],
    )
