"""Tables as people read them."""

import numpy as np
import pytest
import xarray as xr

from shipcosim.report.run.derived import add_derived
from shipcosim.report.run.roles import find_roles
from shipcosim.report.theme.display import display_table, thinned

FLOWS = ("environment", 3.0), ("harbour", 1.0), ("predictor", 2.0)
"""Components with wind and current, and their components north and east. [m/s]"""


def table_of(time=None, **signals):
    """Table of (values, unit), with two underscores for the dot of a signal's name."""
    time = np.arange(len(next(iter(signals.values()))[0])) * 1.0 if time is None else time
    variables = {
        k.replace("__", "."): ("time", np.asarray(v), {"units": unit})
        for k, (v, unit) in signals.items()
    }
    return xr.Dataset(variables, coords={"time": time})


def shown(table, verdicts=()):
    """As the page has it."""
    roles = find_roles(table.data_vars)
    return add_derived(
        display_table(table, roles.signal(roles.ship, "psi")), table, roles, verdicts
    )


def test_angles_are_in_degrees_and_do_not_jump_at_the_half_turn():
    true = np.linspace(0.0, 4 * np.pi, 200)
    wrapped = (true + np.pi) % (2 * np.pi) - np.pi
    drawn = shown(table_of(gyro__psi=(wrapped, "rad")))
    np.testing.assert_allclose(drawn["gyro.psi"], np.degrees(true), atol=1e-9)
    assert drawn["gyro.psi"].attrs["units"] == "deg"


def test_a_gap_does_not_spoil_the_angles_after_it():
    drawn = shown(table_of(gyro__psi=([3.0, np.nan, -3.0], "rad")))
    np.testing.assert_allclose(drawn["gyro.psi"], np.degrees([3.0, np.nan, 2 * np.pi - 3.0]))


def test_reference_lies_beside_the_ship_whatever_turn_it_counts():
    ship = table_of(
        vessel__x=([0.0, 0.0], "m"),
        vessel__y=([0.0, 0.0], "m"),
        vessel__psi=([3.1, 3.14], "rad"),
        reference__x_d=([0.0, 0.0], "m"),
        reference__y_d=([0.0, 0.0], "m"),
        reference__psi_d=([-3.13, -3.13], "rad"),
    )
    drawn = shown(ship)
    assert np.abs(drawn["reference.psi_d"] - drawn["vessel.psi"]).max() < 10.0
    assert np.abs(drawn["heading error"]).max() < 4.0


def test_one_unit_serves_the_whole_page():
    loads = {
        "port__thrust": ([20e3, 0.0], "N"),
        "line__force": ([5.0, 0.0], "N"),
        "shaft__torque": ([9.0, 0.0], "N.m"),
    }
    drawn = shown(table_of(**loads))
    assert drawn["port.thrust"].attrs["units"] == drawn["line.force"].attrs["units"] == "kN"
    assert float(drawn["port.thrust"][0]) == 20.0
    assert drawn["shaft.torque"].attrs["units"] == "N.m"


def test_wind_that_blows_to_the_south_west_comes_from_the_north_east():
    drawn = shown(table_of(weather__wind_north=([-3.0], "m/s"), weather__wind_east=([-3.0], "m/s")))
    assert float(drawn["wind from"][0]) == pytest.approx(45.0)
    assert float(drawn["wind speed"][0]) == pytest.approx(np.sqrt(18.0))


def test_wind_and_current_are_those_at_the_ship_where_a_harbour_changes_them():
    flow = ("wind_north", "wind_east", "current_north", "current_east")
    at_sea, inside, guessed = (
        {f"{who}__{name}": ([-value], "m/s") for name in flow} for who, value in FLOWS
    )
    guessed["predictor__predicted_at"] = ([0.0], "s")
    drawn = shown(
        table_of(environment__wind_speed_mean=([9.0], "m/s"), **at_sea, **guessed, **inside)
    )
    assert (
        float(drawn["wind speed"][0])
        == float(drawn["current speed"][0])
        == pytest.approx(np.sqrt(2.0))
    )


def test_thinning_keeps_the_peaks_the_order_of_time_and_both_ends():
    values = np.sin(np.arange(100_000) / 500.0)
    values[[12_345, 67_890]] = 40.0, -30.0
    drawn, span = thinned(shown(table_of(a__b=(values, "m"))), most=3_000)
    assert drawn.sizes["time"] < 4_000 and span > 1
    assert float(drawn["a.b"].max()) == 40.0 and float(drawn["a.b"].min()) == -30.0
    assert (np.diff(drawn["time"]) > 0).all()
    assert drawn["a.b"][[0, -1]].values.tolist() == values[[0, -1]].tolist()
    peak = drawn["time"].values[int(np.argmax(drawn["a.b"].values))]
    assert abs(peak - 12_345) <= span


def test_texts_are_left_out():
    table = table_of(a__b=([1.0, 2.0], "m"))
    table["a.mode"] = ("time", np.array(["on", "off"]))
    assert list(shown(table)) == ["a.b"]
