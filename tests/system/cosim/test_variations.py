"""Many variations of one run: each is the run that it would be alone, and one that fails takes no other with it."""

import importlib.util
import json

import numpy as np
import pandas
import pytest
import xarray

import shipcosim
from shipcosim.cosim import RunOptions, Variation, simulate, simulate_many
from shipcosim.cosim import variations as many_module
from shipcosim.cosim.master import compiled
from shipcosim.cosim.master.run import Simulation
from shipcosim.cosim.systems import system_of
from shipcosim.errors import ShipcosimError
from shipcosim.native import component
from shipcosim.scenario import Event, read_scenario
from shipcosim.ssp import with_values

NATIVE = RunOptions(engine="native")
SEEDS = [{"environment.seed": seed, "sensors.seed": 100 + seed} for seed in (3, 8, 21, 22, 23)]
SHORT = {"stop_time": 12.0, "events": [{"time": 4.0, "override": {"reference.x_set": 5.0}}]}


@pytest.fixture(autouse=True, scope="session")
def compiler(needs):
    if importlib.util.find_spec("ziglang") is None:
        needs("ziglang", 'Install it: pip install -e ".[native]".')


@pytest.fixture(scope="module")
def dp(root):
    scenario = read_scenario(root / "scenarios" / "gust.toml").model_copy(
        update={"stop_time": 12.0, "events": []}
    )
    return with_values(system_of(scenario), scenario.set), scenario.model_copy(
        update={"expect": [], "set": {}}
    )


def test_each_variation_is_its_run_alone_bit_for_bit_in_any_number_of_threads(dp):
    system, scenario = dp
    variations = [Variation(values, scenario) for values in SEEDS]
    many = [simulate_many(system, scenario, variations, NATIVE, workers=n) for n in (1, 2, 4)]
    for number, values in enumerate(SEEDS):
        alone = simulate(system, scenario.model_copy(update={"set": values}), NATIVE)
        for name, column in alone.items():
            for runs in many:
                assert runs[name][number].values.tobytes() == column.values.tobytes(), name
    assert not many[0]["vessel.x"][0].equals(many[0]["vessel.x"][1])
    assert many[0]["environment.seed"].values.tolist() == [3, 8, 21, 22, 23]
    assert json.loads(many[0].attrs["remarks"]) == []


@pytest.mark.parametrize("engine", ["native", "fmpy"])
def test_a_run_goes_in_the_arrays_of_the_one_before_where_numbers_alone_differ(
    dp, monkeypatch, engine
):
    system, scenario = dp
    events = [Event(time=1.0, bias={"port.thrust_cmd": 500.0})]
    scenario = scenario.model_copy(update={"stop_time": 3.0, "events": events})
    made, options = [], RunOptions(engine=engine)
    monkeypatch.setattr(
        many_module,
        "Simulation",
        lambda *all, **more: made.append(Simulation(*all, **more)) or made[-1],
    )
    values = [
        SEEDS[0],
        SEEDS[1],
        SEEDS[0] | {"vessel.mass": 5.1e5, "reference.x_set": 2.0},
        SEEDS[0],
    ]
    runs = simulate_many(
        system, scenario, [Variation(one, scenario) for one in values], options, workers=1
    )
    assert len(made) == 1
    for number, one in enumerate(values):
        alone = simulate(system, scenario.model_copy(update={"set": one}), options)
        for name, column in alone.items():
            assert runs[name][number].values.tobytes() == column.values.tobytes(), name
    assert not np.array_equal(runs["vessel.x"][0], runs["vessel.x"][2])


def test_what_differs_in_numbers_alone_is_compiled_once(dp, monkeypatch):
    system, scenario = dp
    simulate_many(system, scenario, [Variation({}, scenario)], NATIVE)
    monkeypatch.setattr(component, "trace", None)  # nothing is recorded again
    values = {
        "environment.seed": 4321,
        "sensors.seed": 77,
        "vessel.mass": 5.1e5,
        "controller.position_noise": 0.3,
    }
    runs = simulate_many(system, scenario, [Variation(values, scenario)], NATIVE)
    assert json.loads(runs.attrs["remarks"]) == []


def test_one_that_fails_says_why_and_keeps_its_rows(make_system, make_scenario):
    system, scenario = (
        make_system({"lag": ("lag", {"u": 1.0}), "engine": ("failing", {"how": "warn"})}),
        make_scenario(1.0, 0.1),
    )
    how = [
        {},
        {"engine.how": "raise"},
        {"engine.how": "start"},
        {"lag.time_constant": 2.0},
        {"engine.when": "1 kg"},
    ]
    runs = simulate_many(
        system, scenario, [Variation(values, scenario) for values in how], NATIVE, workers=2
    )
    errors = runs.error.values.tolist()
    assert errors[0] == errors[3] == ""
    assert (
        "50%s of it is wrong" in errors[1]
        and "50%s of the start is wrong" in errors[2]
        and "kg" in errors[4]
    )
    assert runs["lag.y"].notnull().sum("time").values.tolist() == [11, 6, 0, 11, 0]
    assert runs["lag.y"][3, -1] == pytest.approx(-np.expm1(-0.5))
    with pytest.raises(ShipcosimError, match="(?s)All 1 variations fail, the first with: .*50%s"):
        simulate_many(system, scenario, [Variation({"engine.how": "raise"}, scenario)], NATIVE)


def test_what_does_not_fit_ends_all_before_the_first(dp):
    system, scenario = dp
    with pytest.raises(ShipcosimError, match="vessel has no variable 'mas'.*Did you mean 'mass'"):
        simulate_many(
            system,
            scenario,
            [Variation({}, scenario), Variation({"vessel.mas": 1.0}, scenario)],
            NATIVE,
        )


def test_without_a_compiler_python_steps_and_the_remarks_say_so(
    make_system, make_scenario, monkeypatch
):
    system, scenario = make_system({"lag": ("lag", {"u": 3.0})}), make_scenario()
    variations = [Variation({"lag.time_constant": float(n)}, scenario) for n in range(1, 4)]
    compiled_runs = simulate_many(system, scenario, variations, NATIVE, workers=2)
    monkeypatch.setattr(compiled, "is_installed", lambda: False)
    runs = simulate_many(system, scenario, variations, NATIVE, workers=2)
    assert "there is no compiler" in json.loads(runs.attrs["remarks"])[0]
    np.testing.assert_allclose(runs["lag.y"], compiled_runs["lag.y"], rtol=1e-12)


def test_a_table_of_values_with_gaps_own_events_and_an_own_end(root):
    mass = [5.5e5, np.nan, 6.0e5]
    table = pandas.DataFrame({"vessel.mass": mass, "environment.seed": [1, 1, 2]})
    runs = shipcosim.simulate_many(
        "gunnerus_dp", "gust", table, record=["vessel.x", "port"], stop_time=5.0
    )
    assert {str(name).partition(".")[0] for name in runs} == {"vessel", "port"} and runs.sizes[
        "variation"
    ] == 3
    again = shipcosim.simulate_many(
        "gunnerus_dp",
        "gust",
        xarray.Dataset({"vessel.mass": ("variation", mass[:1])}),
        record="vessel.x",
        stop_time=5.0,
    )
    assert not np.array_equal(runs["vessel.x"][0], runs["vessel.x"][1])  # the set's own mass
    assert np.array_equal(again["vessel.x"][0], runs["vessel.x"][0])
    shorter = root / "ssp" / "gunnerus_dp" / "resources" / "gunnerus-28m9.ssv"
    stopped = {"time": 2.0, "override": {"port.failed": True}}
    own = [{}, {"events": [stopped]}, {"stop_time": 3.0}, {"parameters": [shorter]}]
    runs = shipcosim.simulate_many(
        "gunnerus_dp", "gust", own, record=["vessel.x", "port.thrust"], stop_time=5.0
    )
    x, thrust = runs["vessel.x"].values, runs["port.thrust"].values
    assert np.array_equal(x[0, runs.time <= 2.0], x[1, runs.time <= 2.0]) and not np.array_equal(
        thrust[0], thrust[1]
    )
    assert (
        np.array_equal(x[0, runs.time <= 3.0], x[2, runs.time <= 3.0])
        and np.isnan(x[2, runs.time > 3.01]).all()
    )
    assert not np.array_equal(x[0], x[3]) and runs.error.values.tolist() == [""] * 4


def test_runs_are_reduced_to_what_is_asked_for(dp):
    system, scenario = dp
    variations = [Variation(values, scenario) for values in SEEDS[:2]]
    whole = simulate_many(system, scenario, variations, NATIVE)
    largest = simulate_many(
        system,
        scenario,
        variations,
        NATIVE,
        choose=lambda names: ["vessel.x"],
        reduce=lambda run: run["vessel.x"].max(),
    )
    assert largest["reduced"].values.tolist() == whole["vessel.x"].max("time").values.tolist()
    parts = simulate_many(
        system,
        scenario,
        variations,
        NATIVE,
        reduce=lambda run: {"n": len(run), "ends": run["vessel.x"].values[[0, -1]]},
    )
    assert parts["n"].values.tolist() == [len(whole)] * 2 and parts["ends"].shape == (2, 2)
