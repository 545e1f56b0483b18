"""Tables that feed a system, from any time on, and many segments of one record."""

import numpy as np
import pytest
import xarray

from shipcosim.cosim import RunError, RunOptions, interpolated, replay, simulate
from shipcosim.errors import ShipcosimError
from shipcosim.library import build_stale
from shipcosim.scenario import Scenario, read_scenario
from shipcosim.series import make_table
from shipcosim.ssp import read_system, with_values

FED = {"ramp": ("input", "Real", "")}


@pytest.fixture
def integrator(make_system):
    """An integrator fed by the system's input, and a clock."""
    return make_system({"sum": "integrator", "clock": "clock"}, ["ramp -> sum.u"], FED)


def record(times, values, unit="1", **attributes):
    table = make_table(
        np.asarray(times, dtype=float), [("ramp", np.asarray(values, dtype=float), unit, "")]
    )
    table["ramp"].attrs |= attributes
    return table


def test_fmus_get_the_time_of_a_run_that_starts_late(integrator, make_scenario):
    whole = simulate(integrator, make_scenario(110.0))
    late = simulate(integrator, make_scenario(110.0), RunOptions(start_time=100.0))
    assert late.time.values.tolist() == whole.time.values[1000:].tolist()
    assert np.array_equal(late["clock.time"][1:], whole["clock.time"][1001:])
    assert np.array_equal(late["clock.step_size"][1:], whole["clock.step_size"][1001:])
    assert np.array_equal(late["clock.count"], np.arange(101))


def test_events_of_a_run_that_starts_late_act_at_their_times(integrator, make_scenario):
    events = [{"time": 1.0, "override": {"ramp": 5.0}}, {"time": 10.5, "override": {"ramp": 2.0}}]
    table = simulate(integrator, make_scenario(11.0, events=events), RunOptions(start_time=10.0))
    assert table["ramp"].values.tolist() == [0.0] * 5 + [2.0] * 6


def test_a_held_column_changes_at_its_rows_and_a_linear_one_between_them(integrator, make_scenario):
    times, values = [0.0, 3.0, 4.0], [1.0, 1.0, 3.0]
    held = simulate(
        integrator, make_scenario(4.0), RunOptions(inputs=record(times, values), start_time=3.0)
    )
    assert held["ramp"].values.tolist() == [1.0] * 10 + [3.0]
    line = record(times, values, interpolation="linear")
    linear = simulate(integrator, make_scenario(4.0), RunOptions(inputs=line, start_time=3.0))
    assert np.allclose(linear["ramp"], 1.0 + 2.0 * np.linspace(0.0, 1.0, 11), rtol=1e-14)
    # left Riemann sums of 1 + 2 t over 0.1 s steps
    assert np.allclose(
        linear["sum.y"], [0.1 * k + 0.01 * k * (k - 1) for k in range(11)], rtol=0, atol=1e-13
    )


def test_units_of_the_header_are_converted(make_system, make_scenario):
    connectors = {"speed": ("input", "Real", 'unit="rad/s"')}
    system = make_system({"shaft": "shaft"}, ["speed -> shaft.speed"], connectors)
    table = make_table(np.array([0.0, 1.0]), [("speed", np.array([30.0, 60.0]), "rpm", "")])
    assert np.allclose(
        simulate(system, make_scenario(), RunOptions(inputs=table))["speed"][[0, -1]],
        [np.pi, 2.0 * np.pi],
    )


def test_an_angle_is_interpolated_the_shorter_way_round(make_system, make_scenario):
    system = make_system(
        {"shaft": "shaft"}, ["course -> shaft.angle"], {"course": ("input", "Real", 'unit="deg"')}
    )
    table = make_table(np.array([0.0, 1.0]), [("course", np.array([170.0, -170.0]), "deg", "")])
    marked = interpolated(table, system, ["c*"])
    assert np.allclose(
        simulate(system, make_scenario(), RunOptions(inputs=marked))["course"],
        170.0 + 20.0 * np.linspace(0, 1, 11),
    )
    assert "interpolation" not in table["course"].attrs


GAP = record([*np.arange(0.0, 20.0, 0.5), *np.arange(40.0, 61.0, 0.5)], np.zeros(82))


@pytest.mark.parametrize(
    "table, said",
    [
        (
            record([0.0, 0.5], [0.0, 0.0]),
            "goes from 0 s to 0.5 s, the run from 0 s to 60 s.*Start later or stop",
        ),
        (record([1.0, 60.0], [0.0, 0.0]), "goes from 1 s"),
        (
            record([0.0, 2.0, 1.0, 60.0], np.zeros(4)),
            "time of row 3 is 1 s, after 2 s in the row before.*Sort",
        ),
        (record([0.0, 2.0, 2.0, 2.0, 60.0], np.zeros(5)), "time of row 4 is 2 s, after 2 s"),
        (record([0.0, np.nan, 60.0], np.zeros(3)), "time of row 2 is nan"),
        (
            record([0.0, 1.0, 2.0, 60.0], [0.0, np.nan, np.nan, 0.0]),
            "ramp: is nan at 1 s. So are 1 more.*Fill or drop",
        ),
        (record([0.0, 60.0], [0.0, 0.0], "kg"), "ramp: cannot convert 'kg' into '1'"),
        (
            record([0.0, 60.0], [0.0, 0.0], interpolation="cubic"),
            "ramp: interpolation = 'cubic'.*'held', or 'linear'",
        ),
        (
            record([0.0, 60.0], [0.0, 0.0]).rename(ramp="rmp"),
            "has no input 'rmp'.*Did you mean 'ramp'",
        ),
        (record([0.0, 60.0], [0.0, 0.0]).drop_vars("ramp"), "no column beside time"),
        (GAP, "no row between 19.5 s and 40 s; 2.5 s are allowed.*max_gap"),
        (
            record([0.0, 60.0], [0.0, 0.0]).assign_attrs(max_gap=10.0),
            "between 0 s and 60 s; 10 s are allowed",
        ),
    ],
)
def test_a_table_that_cannot_feed_the_run_is_refused_in_words(
    integrator, make_scenario, table, said
):
    with pytest.raises(ShipcosimError, match=f"(?s)inputs: .*{said}"):
        simulate(integrator, make_scenario(60.0), RunOptions(inputs=table))


def test_what_is_wrong_outside_the_run_does_not_matter(integrator, make_scenario):
    table = GAP.copy(deep=True)
    table["ramp"][5] = np.nan
    simulate(integrator, make_scenario(60.0), RunOptions(inputs=table, start_time=40.0))
    simulate(integrator, make_scenario(60.0), RunOptions(inputs=GAP.assign_attrs(max_gap=100.0)))


def test_whole_numbers_are_not_cut_off(make_system, make_scenario):
    system = make_system({"meter": "meter"}, ["n -> meter.number"], {"n": ("input", "Integer", "")})
    table = make_table(np.array([0.0, 1.0]), [("n", np.array([1.0, 0.7]), "", "")])
    with pytest.raises(ShipcosimError, match="n: is 0.7 at 1 s.*whole numbers"):
        simulate(system, make_scenario(), RunOptions(inputs=table))


def test_a_column_to_interpolate_has_to_be_there(integrator):
    with pytest.raises(ShipcosimError, match="no column 'rampe'.*Did you mean 'ramp'"):
        interpolated(record([0.0], [0.0]), integrator, ["rampe"])


def test_segments_are_the_runs_that_each_would_be_alone(make_system):
    system = make_system(
        {"sum": "integrator", "lag": "lag", "clock": "clock"},
        ["ramp -> sum.u", "sum.y -> lag.u"],
        FED,
    )
    table = record(np.arange(0.0, 21.0), np.sin(np.arange(21.0)), interpolation="linear")
    starts, states = [0.0, 12.345, 3.0], {"sum.y_start": [0.0, 1.0, -2.0], "lag.time_constant": 0.7}
    together = replay(system, table, starts, 5.0, states=states, step_size=0.1)
    assert dict(together.sizes) == {"segment": 3, "time": 51}
    assert together["start_time"].values.tolist() == starts
    assert np.allclose(together["time"], np.linspace(0.0, 5.0, 51))
    for number in (0, 2):
        own = with_values(
            system, {name: np.broadcast_to(v, 3)[number].item() for name, v in states.items()}
        )
        scenario = Scenario(stop_time=starts[number] + 5.0, step_size=0.1)
        alone = simulate(own, scenario, RunOptions(inputs=table, start_time=starts[number]))
        for name in alone:
            assert np.array_equal(together[name][number], alone[name]), name
    assert np.allclose(together["clock.time"][1, 1:], 12.345 + np.linspace(0.1, 5.0, 50))


def test_states_are_converted_and_signals_chosen(make_system):
    connectors = {"speed": ("input", "Real", 'unit="rad/s"')}
    system = make_system({"shaft": "shaft"}, ["speed -> shaft.speed"], connectors)
    table = make_table(np.array([0.0, 2.0]), [("speed", np.zeros(2), "rpm", "")])
    angle = xarray.DataArray([np.pi, 2.0 * np.pi], dims="segment", attrs={"units": "rad"})
    options = {"states": {"shaft.angle": angle}, "step_size": 0.5, "signals": ["shaft.torque"]}
    replayed = replay(system, table, [0.0, 1.0], 1.0, **options)
    assert (
        list(replayed.data_vars) == ["shaft.torque"]
        and replayed["shaft.torque"].attrs["units"] == "N.m"
    )
    assert np.allclose(replayed["shaft.torque"][:, 0], [180.0, 360.0])


def test_every_bad_segment_is_named_before_anything_runs(integrator):
    table = record(np.arange(0.0, 30.0), np.where(np.arange(30.0) == 15.0, np.nan, 0.0))
    with pytest.raises(ShipcosimError) as error:
        replay(integrator, table, [0.0, 10.0, 25.0], 10.0, step_size=0.1)
    where = [(problem.where, problem.found.split(".")[0]) for problem in error.value.problems]
    assert where == [
        ("segment 1 at 10 s: inputs: ramp", "is nan at 15 s"),
        ("segment 2 at 25 s: inputs", "The table goes from 0 s to 29 s, the run from 25 s to 35 s"),
    ]


@pytest.mark.parametrize(
    "starts, states, said",
    [
        ([], {}, "no list of times"),
        (
            [0.0, 1.0],
            {"sum.y_start": [1.0, 2.0, 3.0]},
            "sum.y_start.*3,.* values for 2 segments. Give one, or 2",
        ),
        ([0.0], {"sum.y_strt": 1.0}, "sum has no variable 'y_strt'"),
        ([0.0], {"sum.y_start": np.nan}, "nan is not a finite number"),
    ],
)
def test_states_that_do_not_fit_are_refused(integrator, starts, states, said):
    with pytest.raises(ShipcosimError, match=said):
        replay(
            integrator, record([0.0, 9.0], [0.0, 0.0]), starts, 1.0, states=states, step_size=0.1
        )


@pytest.mark.parametrize(
    "times, said",
    [
        (
            {"duration": 0.25},
            "duration = 0.25 s is no whole number of steps of 0.1 s.*nearest would be 0.2 s",
        ),
        ({"duration": -1.0}, "duration = -1 s"),
        ({"output_interval": 0.15}, "output_interval = 0.15 s is no whole"),
        ({"step_size": 0.0}, "No step size"),
        ({"starts": [-5.0]}, "segment at -5 s ends before time 0"),
    ],
)
def test_times_of_segments_have_to_fit_the_steps(integrator, times, said):
    options = {"starts": [0.0], "duration": 1.0, "step_size": 0.1} | times
    with pytest.raises(ShipcosimError, match=said):
        replay(integrator, record([-9.0, 9.0], [0.0, 0.0]), **options)


def test_a_segment_that_fails_is_named(make_system):
    system = make_system(
        {"f": ("failing", {"when": 12.0}), "sum": "integrator"}, ["ramp -> sum.u"], FED
    )
    with pytest.raises(RunError, match=r"segment 1 at 10 s: f: failed in the step from t = 12 s"):
        replay(system, record([0.0, 30.0], [0.0, 0.0]), [0.0, 10.0], 5.0, step_size=0.5)


WIND = [
    f"environment.{name}_rate"
    for name in ("wind_speed", "wind_turn", "current_speed", "current_turn")
]
SHIP = ("x", "y", "psi", "u", "v", "r")


@pytest.fixture(scope="module")
def sailed(root):
    """The DP ship for 200 s in gusts, waves and current, every step; and the open ship in the same sea, without gusts.

    The record's wind has the gusts in it; the open ship's environment passes it on at once.
    """
    fmus = build_stale(root)
    scenario = read_scenario(root / "scenarios" / "four_corner.toml")
    events = [event for event in scenario.events if event.time < 200.0]
    scenario = scenario.model_copy(
        update={"stop_time": 200.0, "output_interval": None, "events": events}
    )
    dp = read_system(scenario.system_path, scenario.parameter_paths, fmus=[fmus])
    sea = {
        name: scenario.set[f"environment.{name}"]
        for name in ("significant_wave_height", "peak_period", "seed")
    }
    sea |= {"waves_from": scenario.set["environment.waves_from"], "gust_scale": 0.0}
    values = {f"environment.{name}": value for name, value in sea.items()} | dict.fromkeys(
        WIND, 1e9
    )
    run = simulate(dp, scenario, RunOptions(engine="native"))  # a tenth of the time of Python
    return run, with_values(read_system(root / "ssp" / "gunnerus_open", fmus=[fmus]), values)


def log_of(run):
    """What a log of a run would hold for the inputs of gunnerus_open."""

    def polar(north, east):
        return np.hypot(run[north], run[east]).values, np.arctan2(run[east], run[north]).values

    (wind, wind_to), (current, current_to) = (
        polar(f"environment.{of}_north", f"environment.{of}_east") for of in ("wind", "current")
    )
    columns = [
        (f"{side}_rpm", run[f"{side}.rpm"].values, "rpm")
        for side in ("port", "starboard", "tunnel")
    ]
    columns += [
        (f"{side}_azimuth", run[f"{side}.azimuth"].values, "rad") for side in ("port", "starboard")
    ]
    columns += [("true_wind_speed", wind, "m/s"), ("true_wind_from", wind_to + np.pi, "rad")]
    columns += [("current_speed", current, "m/s"), ("current_to", current_to, "rad")]
    return make_table(run["time"].values, [(*column, "") for column in columns])


def largest_distance(run, system, log, starts):
    """Of the replayed tracks from the recorded one, over all segments of 60 s; (m, rad)."""
    begin = run.sel(time=starts, method="nearest")
    states = {f"vessel.{name}_start": begin[f"vessel.{name}"] for name in SHIP}
    replayed = replay(
        system, log, starts, 60.0, states=states, signals=["vessel.x", "vessel.y", "vessel.psi"]
    )
    apart = [0.0, 0.0]
    for number, start in enumerate(starts):
        sailed = run.sel(time=start + replayed["time"].values, method="nearest")
        x, y, psi = (
            replayed[f"vessel.{n}"].values[number] - sailed[f"vessel.{n}"].values
            for n in ("x", "y", "psi")
        )
        apart = np.maximum(apart, [np.hypot(x, y).max(), np.abs(psi).max()])
    return apart


STARTS = [0.0, 20.0, 60.05, 100.0, 140.0]


def test_a_replayed_ship_follows_the_track_that_was_sailed(sailed):
    """Inputs act a step (0.05 s) late: at under 1 m/s the ship is less than twice 0.05 m behind, and 0.2 deg off."""
    run, system = sailed
    distance, angle = largest_distance(run, system, log_of(run), STARTS)
    assert float(np.hypot(run["vessel.x"], run["vessel.y"]).max()) > 10.0
    assert distance < 0.1 and angle < np.radians(0.2)


def test_without_the_delay_of_a_step_the_track_is_the_same_to_a_millimetre(sailed):
    """What is left: the first step, whose inputs were there already, and a torque that a replay does not integrate."""
    run, system = sailed
    log = log_of(run)
    early = log.isel(time=slice(1, None)).assign_coords(time=log["time"].values[:-1])
    distance, angle = largest_distance(
        run, system, early, [start for start in STARTS if start < 139.0]
    )
    assert distance < 1e-3 and angle < 1e-4
