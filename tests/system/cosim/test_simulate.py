"""A run against closed forms: what the exchange between components does, and when."""

import json
import math

import numpy as np
import pytest

from shipcosim.cosim import RunOptions, simulate
from shipcosim.errors import ShipcosimError
from shipcosim.series import make_table, write_table


def test_lag_follows_its_closed_form(make_system, make_scenario):
    system = make_system({"lag": ("lag", {"u": 3.0, "time_constant": 2.0, "y_start": -1.0})})
    table = simulate(system, make_scenario(10.0, 0.05))
    t = table.time.values
    assert np.allclose(table["lag.y"], 3.0 - 4.0 * np.exp(-t / 2.0), rtol=0, atol=1e-13)


def test_jacobi_delays_each_link_of_a_chain_by_one_step(make_system, make_scenario):
    chain = {"a": ("integrator", {"u": 1.0}), "b": "integrator", "c": "integrator"}
    table = simulate(make_system(chain, ["a.y -> b.u", "b.y -> c.u"]), make_scenario(2.0, 0.1))
    k, h = np.arange(21), 0.1
    assert np.allclose(table["a.y"], h * k)
    assert np.allclose(table["b.y"], h**2 * k * (k - 1) / 2)
    assert np.allclose(table["c.y"], h**3 * k * (k - 1) * (k - 2) / 6)


def test_gauss_seidel_passes_values_on_within_the_step_whatever_order_they_are_listed_in(
    make_system, make_scenario
):
    chain = {"c": "integrator", "b": "integrator", "a": ("integrator", {"u": 1.0})}
    system = make_system(chain, ["a.y -> b.u", "b.y -> c.u"])
    table = simulate(system, make_scenario(2.0, 0.1), RunOptions(order="gauss-seidel"))
    k, h = np.arange(21), 0.1
    assert np.allclose(table["b.y"], h**2 * k * (k + 1) / 2)
    assert np.allclose(table["c.y"], h**3 * k * (k + 1) * (k + 2) / 6)


def test_the_order_is_that_of_the_scenario_unless_an_option_says_another(
    make_system, make_scenario
):
    system = make_system({"b": "integrator", "a": ("integrator", {"u": 1.0})}, ["a.y -> b.u"])
    scenario = make_scenario(2.0, 0.1).model_copy(update={"order": "gauss-seidel"})
    k, h = np.arange(21), 0.1
    table = simulate(system, scenario)
    assert table.attrs["order"] == "gauss-seidel"
    assert np.allclose(table["b.y"], h**2 * k * (k + 1) / 2)
    jacobi = simulate(system, scenario, RunOptions(order="jacobi"))
    assert np.allclose(jacobi["b.y"], h**2 * k * (k - 1) / 2)


def test_gauss_seidel_breaks_a_loop_where_the_system_lists_it_first(make_system, make_scenario):
    loop = {"first": ("integrator", {"y_start": 1.0}), "law": ("gain", {"factor": -1.0})}
    system = make_system(loop, ["first.y -> law.u", "law.y -> first.u"])
    gauss_seidel = simulate(system, make_scenario(1.0, 0.1), RunOptions(order="gauss-seidel"))[
        "first.y"
    ].values
    assert np.allclose(gauss_seidel, 0.9 ** np.arange(11))


def test_halving_the_step_halves_the_error_of_a_feedback(make_system, make_scenario):
    loop = {"tank": ("integrator", {"y_start": 1.0}), "law": ("gain", {"factor": -1.0})}
    system = make_system(loop, ["tank.y -> law.u", "law.y -> tank.u"])
    errors = [
        abs(simulate(system, make_scenario(1.0, h))["tank.y"].values[-1] - math.exp(-1.0))
        for h in (0.02, 0.01)
    ]
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.05)


def test_times_are_the_nearest_doubles_over_the_whole_run(make_system, make_scenario):
    table = simulate(
        make_system({"clock": "clock"}), make_scenario(1100.0, 0.05, output_interval=0.5)
    )
    expected = [k / 2 for k in range(2201)]
    assert table.time.values.tolist() == expected
    assert table["clock.time"].values.tolist() == expected
    assert table["clock.count"].values[-1] == 22000


def test_units_are_converted_between_components(make_system, make_scenario):
    system = make_system({"a": ("shaft", {"speed": 2.0}), "b": "shaft"}, ["a.rpm -> b.speed"])
    table = simulate(system, make_scenario(0.2, 0.1))
    assert np.allclose(table["b.rpm"].values[1:], 10.0 * 20.0 * 2.0 * math.pi / 60.0, rtol=1e-15)
    assert table["b.rpm"].attrs["units"] == "rpm"


def test_linear_transformation_comes_after_the_source(make_system, make_scenario):
    link = 'a.y -> b.u | <ssc:LinearTransformation factor="3.0" offset="0.5"/>'
    table = simulate(
        make_system({"a": ("gain", {"offset": 2.0}), "b": "gain"}, [link]), make_scenario(0.2, 0.1)
    )
    assert np.all(table["b.y"] == 6.5)


def test_other_types_travel_too_and_integers_become_reals(make_system, make_scenario):
    links = ["clock.count -> meter.number", "clock.odd -> meter.flag", "clock.text -> meter.text"]
    links.append('clock.count -> meter.real | <ssc:LinearTransformation factor="1e6" offset="0"/>')
    table = simulate(
        make_system({"clock": "clock", "meter": "meter"}, links), make_scenario(1.0, 0.1)
    )
    k = np.arange(1, 10)
    length = np.array([len(f"{n} of them") for n in k])
    assert table["clock.odd"].dtype == bool and table["clock.count"].dtype == np.int32
    assert np.array_equal(table["meter.number_seen"].values[2:], k)
    assert np.allclose(
        table["meter.y"].values[2:], k + 1000.0 * (k % 2) + 0.001 * length + 1e6 * k, atol=1e-9
    )


def test_mapping_replaces_values(make_system, make_scenario):
    table_ = '<ssc:IntegerMappingTransformation><ssc:MapEntry source="2" target="-5"/></ssc:IntegerMappingTransformation>'
    system = make_system(
        {"clock": "clock", "meter": "meter"}, [f"clock.count -> meter.number | {table_}"]
    )
    table = simulate(system, make_scenario(0.5, 0.1))
    assert table["meter.number_seen"].values.tolist() == [0, 0, 1, -5, 3, 4]


def test_slow_components_step_and_exchange_at_their_own_rate(make_system, make_scenario):
    parts = {
        "fast": "clock",
        "slow": ("clock", {}, 0.3),
        "fast_seen": "gain",
        "slow_seen": "gain",
        "late": ("gain", {}, 0.3),
    }
    links = ["slow.time -> slow_seen.u", "fast.time -> late.u"]
    table = simulate(make_system(parts, links), make_scenario(1.2, 0.1))
    assert np.allclose(table["slow.time"], np.arange(13) // 3 * 0.3)
    assert np.allclose(table["slow.step_size"].values[3:], 0.3)
    assert np.allclose(table["slow_seen.y"].values[1:], np.arange(12) // 3 * 0.3)
    assert np.allclose(table["late.y"].values[6:], (np.arange(6, 13) // 3 - 1) * 0.3)


def test_output_interval_thins_the_rows_only(make_system, make_scenario):
    system = make_system({"lag": ("lag", {"u": 1.0})})
    every, thin = (
        simulate(system, make_scenario(1.0, 0.1, output_interval=i)) for i in (None, 0.3)
    )
    assert thin.time.values.tolist() == [0.0, 0.3, 0.6, 0.9]
    assert np.array_equal(thin["lag.y"], every["lag.y"].values[::3])


def test_connectors_of_the_system_are_fed_by_a_table_and_shown(make_system, make_scenario):
    connectors = {
        "held": ("input", "Real", 'unit="deg"'),
        "ramp": ("input", "Real", ""),
        "seen": ("output", "Real", ""),
    }
    links = ["held -> shaft.angle", "ramp -> gain.u", "gain.y -> seen"]
    system = make_system({"shaft": "shaft", "gain": "gain"}, links, connectors)
    columns = [
        ("held", np.array([0.1, 0.2, 0.3]), "rad", ""),
        ("ramp", np.array([0.0, 1.0, 3.0]), "", ""),
    ]
    inputs = make_table(np.array([0.0, 0.5, 1.0]), columns)
    inputs["ramp"].attrs["interpolation"] = "linear"
    table = simulate(system, make_scenario(1.0, 0.1), RunOptions(inputs=inputs))
    degrees = np.degrees(np.repeat([0.1, 0.2, 0.3], [5, 5, 1]))
    ramp = np.interp(np.arange(11) * 0.1, [0.0, 0.5, 1.0], [0.0, 1.0, 3.0])
    assert np.allclose(table["held"], degrees) and table["held"].attrs["units"] == "deg"
    assert np.allclose(table["shaft.torque"].values[1:], degrees[:-1])
    assert np.allclose(table["gain.y"].values[1:], ramp[:-1]) and np.array_equal(
        table["seen"], table["gain.y"]
    )


def test_connectors_that_nothing_feeds_leave_the_components_start_values(
    make_system, make_scenario
):
    parts = {"a": ("gain", {"u": 1.0}), "b": ("gain", {"u": 2.0})}
    system = make_system(parts, ["both -> a.u", "both -> b.u"], {"both": ("input", "Real", "")})
    table = simulate(system, make_scenario(0.2, 0.1))
    assert (
        "both" not in table
        and table["a.u"].values.tolist() == [1.0] * 3
        and table["b.y"].values.tolist() == [2.0] * 3
    )


@pytest.mark.parametrize(
    ("time", "name", "values", "said"),
    [
        ([0.0, 1.0], "rmap", [0.0, 1.0], "no input 'rmap'.*Did you mean 'ramp'"),
        ([0.0, 0.5], "ramp", [0.0, 1.0], "the run from 0 s to 1 s"),
        ([0.0, 1.0], "ramp", [0.0, math.nan], "inputs: ramp: is nan at 1 s"),
    ],
)
def test_inputs_that_do_not_fit_are_refused(make_system, make_scenario, time, name, values, said):
    system = make_system({"gain": "gain"}, ["ramp -> gain.u"], {"ramp": ("input", "Real", "")})
    inputs = make_table(np.array(time), [(name, np.array(values), "", "")])
    with pytest.raises(ShipcosimError, match=said):
        simulate(system, make_scenario(1.0, 0.1), RunOptions(inputs=inputs))


def test_start_values_come_from_the_system_and_the_scenario_over_it(make_system, make_scenario):
    system = make_system({"a": ("lag", {"y_start": 1.0, "u": 5.0}), "b": ("lag", {"y_start": 1.0})})
    table = simulate(system, make_scenario(0.1, 0.1, set={"b.y_start": 2.0}))
    assert (table["a.y"].values[0], table["b.y"].values[0], table["a.u"].values[0]) == (
        1.0,
        2.0,
        5.0,
    )
    known = json.loads(table.attrs["start_values"])
    assert known["b.y_start"] == 2.0 and known["b.time_constant"] == 1.0


def test_many_instances_of_one_fmu_keep_apart(make_system, make_scenario):
    parts = {f"c{i}": ("integrator", {"u": float(i)}) for i in range(10)}
    table = simulate(make_system(parts), make_scenario(1.0, 0.1))
    assert [round(float(table[f"c{i}.y"][-1]), 12) for i in range(10)] == [
        float(i) for i in range(10)
    ]


def test_same_run_gives_the_same_bytes(make_system, make_scenario, tmp_path):
    system = make_system({"a": ("lag", {"u": 1.0}), "clock": "clock"}, [])
    for name in ("first", "second"):
        write_table(simulate(system, make_scenario(1.0, 0.1)), tmp_path / f"{name}.nc")
    assert (tmp_path / "first.nc").read_bytes() == (tmp_path / "second.nc").read_bytes()


def test_table_says_what_is_needed_to_repeat_the_run(make_system, make_scenario, tmp_path):
    import hashlib

    system = make_system({"a": ("lag", {"u": 1.0})})
    events = [{"time": 0.5, "override": {"a.u": 2.0}}]
    about = simulate(system, make_scenario(1.0, 0.1, description="a step", events=events)).attrs
    digest = hashlib.sha256(system.components["a"].fmu.path.read_bytes()).hexdigest()
    assert json.loads(about["fmus"]) == {"a": {"file": "lag.fmu", "sha256": digest}}
    assert json.loads(about["events"])[0]["override"] == {"a.u": 2.0}
    assert (about["step_size"], about["engine"], about["complete"], about["description"]) == (
        0.1,
        "fmpy",
        1,
        "a step",
    )


def test_progress_is_told_sparsely_and_to_the_end(make_system, make_scenario):
    told = []
    simulate(
        make_system({"clock": "clock"}),
        make_scenario(50.0, 0.01),
        RunOptions(progress=lambda *done: told.append(done)),
    )
    assert told[0] == (0, 5000) and told[-1] == (5000, 5000) and len(told) < 50


def test_unknown_engine_is_refused(make_system, make_scenario):
    with pytest.raises(ShipcosimError, match="engine 'simulink'"):
        simulate(make_system({"clock": "clock"}), make_scenario(), RunOptions(engine="simulink"))
