"""A log as arrays: even, in SI, nothing made up where nothing is known, late channels put where they belong."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose import twin

from shipcosim.diagnose.ship.inputs import first_motion, record_of
from shipcosim.errors import ShipcosimError
from shipcosim.series import make_table

TIME = np.arange(400.0)
RAMP = {
    "north": (0.5 * TIME, "m"),
    "east": (-0.25 * TIME, "m"),
    "heading": (np.mod(350.0 + 0.1 * TIME, 360.0), "deg"),
    "surge": (0.4 + 0.0 * TIME, "m/s"),
    "sway": (0.1 + 0.0 * TIME, "m/s"),
    "yaw_rate": (0.1 + 0.0 * TIME, "deg/s"),
    "wind_speed": (5.0 + 0.01 * TIME, "m/s"),
    "wind_from": (np.mod(100.0 + 0.2 * TIME, 360.0), "deg"),
    "port_rpm": (60.0 + 0.3 * TIME, "rpm"),
    "port_azimuth": (np.mod(170.0 + 0.5 * TIME + 180.0, 360.0) - 180.0, "deg"),
    "starboard_rpm": (100.0 + 0.0 * TIME, "rpm"),
    "starboard_azimuth": (-20.0 + 0.0 * TIME, "deg"),
    "tunnel_rpm": (600.0 - 0.6 * TIME, "rpm"),
}
INNER = slice(20, -20)


def log(without=(), **changed):
    channels = {
        role: (changed.get(role, values), unit)
        for role, (values, unit) in RAMP.items()
        if role not in without
    }
    return make_table(TIME, [(role, values, unit, "") for role, (values, unit) in channels.items()])


def holed(role, first, last):
    values = RAMP[role][0].copy()
    values[first : last + 1] = np.nan
    return {role: values}


def test_channels_are_in_si_and_angles_do_not_jump():
    record = record_of(log(), twin.model())
    np.testing.assert_allclose(record.measured[:, 2], np.radians(350.0 + 0.1 * TIME), atol=1e-12)
    np.testing.assert_allclose(record.measured[:, 5], np.radians(0.1), rtol=1e-12)
    n, azimuth = record.units["port"]
    np.testing.assert_allclose(n[1:-1], 1.0 + 0.005 * TIME[1:-1], rtol=1e-12)
    np.testing.assert_allclose(np.diff(azimuth[1:-1]), np.radians(0.5), rtol=1e-9)
    np.testing.assert_allclose(np.diff(record.wind[1][1:-1]), np.radians(0.2), rtol=1e-9)
    assert record.step == 1.0 and record.usable.all() and record.remarks == ()


@pytest.mark.parametrize("role", ["port_rpm", "starboard_azimuth", "tunnel_rpm", "wind_from"])
def test_steps_next_to_a_gap_in_what_drives_the_ship_are_not_known(role):
    """Over rows 100 to 110 nothing is known: not what happens from row 99 on, but from row 111 on."""
    record = record_of(log(**holed(role, 100, 110)), twin.model())
    assert np.flatnonzero(~record.usable).tolist() == list(range(99, 111))
    for series in (*record.units["port"], *record.units["starboard"], *record.wind):
        assert np.isfinite(series).all()


def test_a_gap_in_a_measurement_stays_one_and_the_ship_is_driven_on():
    record = record_of(log(**holed("north", 100, 110)), twin.model())
    assert np.flatnonzero(np.isnan(record.measured[:, 0])).tolist() == list(range(100, 111))
    assert record.usable.all()


def test_heading_does_not_jump_across_a_gap_through_north():
    record = record_of(log(**holed("heading", 90, 110)), twin.model())
    np.testing.assert_allclose(
        record.measured[111:, 2], np.radians(350.0 + 0.1 * TIME[111:]), atol=1e-12
    )


@pytest.mark.parametrize(
    ("lag", "thrusters", "wind"),
    [
        # thrusters logged late: what acts now is found that much later in their channels
        ("thruster_lag", 3.0, 0.0),
        # navigation logged late: what drove the ship that is seen now acted, and was logged, that much earlier
        ("navigation_lag", -3.0, -3.0),
        ("wind_lag", 0.0, 3.0),
    ],
)
@pytest.mark.parametrize("share", [0.0, 0.5])
def test_late_channels_are_taken_where_they_belong(lag, thrusters, wind, share):
    none = {"instruments.wind_lag": 0.0}
    model = twin.model().with_values(none | {f"instruments.{lag}": 3.0})
    inputs = record_of(log(), model).inputs(model, share)
    at = TIME[:-1] + share
    np.testing.assert_allclose(inputs.time, at)
    np.testing.assert_allclose(
        inputs.units["tunnel"][0][INNER], (10.0 - 0.01 * (at + thrusters))[INNER], rtol=1e-9
    )
    np.testing.assert_allclose(
        inputs.wind_speed[INNER], (5.0 + 0.01 * (at + wind))[INNER], rtol=1e-9
    )


def test_a_sensor_that_averages_over_the_last_seconds_is_read_half_of_them_later():
    """The mean over 2.5 s of a ramp is its value 1.25 s before: the default of the wind's lag."""
    averaged = 5.0 + 0.01 * (TIME - 1.25)
    inputs = record_of(log(wind_speed=averaged), twin.model()).inputs(twin.model())
    np.testing.assert_allclose(inputs.wind_speed[INNER], 5.0 + 0.01 * TIME[:-1][INNER], rtol=1e-9)


def test_what_is_not_in_the_log_is_said():
    absent = ("tunnel_rpm", "port_azimuth", "wind_speed")
    record = record_of(log(absent), twin.model())
    tunnel, port = record.remarks[1], record.remarks[0]
    assert (
        "'tunnel'" in tunnel
        and "stand still" in tunnel
        and "'port'" in port
        and "point ahead" in port
    )
    assert "No wind" in record.remarks[2] and record.wind is None and len(record.remarks) == 3
    assert record.inputs(twin.model()).wind_speed is None
    assert (record.units["tunnel"][0] == 0.0).all() and record.usable.all()


def test_wind_over_ground_serves_where_there_is_no_apparent_wind():
    table = log(("wind_speed", "wind_from")).assign(
        true_wind_speed=("time", 7.0 + 0.0 * TIME), true_wind_from=("time", 20.0 + 0.0 * TIME)
    )
    record = record_of(table, twin.model())
    np.testing.assert_allclose(record.wind, (np.full(400, 7.0), np.full(400, np.radians(20.0))))


@pytest.mark.parametrize(
    ("rows", "absent", "said"),
    [
        (400, ("east", "heading"), "no channel east, heading.*needs north, east and heading"),
        (
            46,
            (),
            "46 rows over 45 s, of a ship whose slowest answer takes .* s.*60 rows over 105 s",
        ),
        (100, (), "100 rows over 99 s.*over 105 s"),
    ],
)
def test_too_little_is_refused_with_what_is_needed(rows, absent, said):
    with pytest.raises(ShipcosimError, match=said):
        record_of(log(absent).isel(time=slice(rows)), twin.model())


def test_first_motion_has_rates_of_positions_where_none_are_measured():
    given = first_motion(record_of(log(), twin.model()))
    made = first_motion(record_of(log(("surge", "sway", "yaw_rate")), twin.model()))
    psi = np.radians(350.0 + 0.1 * TIME)
    np.testing.assert_allclose(made.psi[INNER], psi[INNER], atol=1e-9)
    np.testing.assert_allclose(made.r[INNER], np.radians(0.1), rtol=1e-6)
    np.testing.assert_allclose(
        made.u[INNER], (0.5 * np.cos(psi) - 0.25 * np.sin(psi))[INNER], atol=1e-6
    )
    np.testing.assert_allclose(
        made.v[INNER], (-0.25 * np.cos(psi) - 0.5 * np.sin(psi))[INNER], atol=1e-6
    )
    np.testing.assert_allclose(given.u, 0.4)


def test_several_logs_are_driven_as_each_alone():
    model, record = twin.model(), record_of(log(), twin.model())
    both = {
        name: tuple(np.stack([series, 2.0 * series]) for series in pair)
        for name, pair in record.units.items()
    }
    inputs = replace(record, units=both).inputs(model, 0.5)
    alone = record.inputs(model, 0.5)
    np.testing.assert_allclose(
        inputs.units["port"][0], np.stack([alone.units["port"][0], 2 * alone.units["port"][0]])
    )


def test_a_stiff_ship_gets_as_many_steps_as_her_damping_asks_for():
    """Runge-Kutta of fourth order diverges beyond 2.8 of rate times step: at most 1 here, and never without bound."""
    record, model = record_of(log(), twin.model()), twin.model()
    assert record.substeps(model) == 1
    assert replace(record, rate=3.5 / record.step).substeps(model) == 4
    assert replace(record, rate=1e9).substeps(model) == 64


def fast(step, rows, **changed):
    """A log with rows that close; ramps go on at the same pace."""
    time = step * np.arange(rows)
    channels = [
        (role, np.interp(time, TIME, values), unit, "") for role, (values, unit) in RAMP.items()
    ]
    channels = [
        (role, changed.get(role, values), unit, meaning) for role, values, unit, meaning in channels
    ]
    return make_table(
        time, [one for one in channels if one[0] not in ("heading", "port_azimuth", "wind_from")]
    )


@pytest.mark.parametrize(
    ("step", "rows", "thinned"), [(0.1, 9, 0.9), (0.5, 2, 1.0), (0.9, 1, 0.9), (1.0, 1, 1.0)]
)
def test_rows_closer_than_the_ship_answers_are_averaged_and_that_is_said(step, rows, thinned):
    heading = np.mod(350.0 + 0.1 * step * np.arange(1800), 360.0)
    table = fast(step, 1800).assign(heading=("time", heading, {"units": "deg", "long_name": ""}))
    record = record_of(table, twin.model())
    assert record.step == pytest.approx(thinned)
    middles = step * (np.arange(record.time.size) * rows + 0.5 * (rows - 1))
    np.testing.assert_allclose(record.time, middles, atol=1e-9)
    np.testing.assert_allclose(record.measured[:, 0], 0.5 * np.minimum(middles, 399.0), atol=0.5)
    np.testing.assert_allclose(record.measured[:, 2], np.radians(350.0 + 0.1 * middles), atol=1e-9)
    said = [remark for remark in record.remarks if "averaged" in remark]
    assert said == (
        [] if rows == 1 else [f"Rows {step:g} s apart are averaged over {thinned:g} s, " + ENOUGH]
    )


ENOUGH = "which resolves this ship's answer."


def test_a_speed_that_swings_is_averaged_by_its_push():
    """Half the time at 60 rpm, half at 180: the thrust of 134 rpm, not of 120; and to and fro, of none."""
    swings = np.where(np.arange(1800) % 2, 60.0, 180.0)
    forth = np.where(np.arange(1800) // 2 % 2, 90.0, -90.0)
    heading = ("time", np.full(1800, 10.0), {"units": "deg", "long_name": ""})
    table = fast(0.25, 1800, port_rpm=swings, tunnel_rpm=forth).assign(heading=heading)
    record = record_of(table, twin.model())
    assert record.step == 1.0
    port, tunnel = record.units["port"][0][2:-2] * 60.0, record.units["tunnel"][0][2:-2] * 60.0
    before = (
        0.25 * swings[:-2] + 0.5 * swings[1:-1] + 0.25 * swings[2:]
    )  # what no reader could tell from noise
    np.testing.assert_allclose(port, np.sqrt(np.mean(before**2)), rtol=1e-9)
    np.testing.assert_allclose(tunnel, 0.0, atol=1e-9)
