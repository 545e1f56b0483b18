"""The free drift of drift.toml against the balance of wind, waves and drag, solved apart from the simulation.

The balance is written here from the numbers of the nominal model: at steady drift r = 0, so cross flow is a plain drag,
the added mass leaves Munk's moment, and the stopped units leave their side force. A free propeller's thrust is small
and left out.
"""

import math

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve
from ships import parameters

from shipcosim.models.environment.waves import jonswap
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.ship.vessel import DriftParameters

RHO, LENGTH, DRAUGHT = 1025.0, 33.9, 2.786
WIND, WIND_FROM, CURRENT, HEIGHT, PERIOD, WAVES_FROM = (
    8.0,
    math.pi / 4,
    (-0.3, 0.0),
    0.5,
    6.0,
    math.pi / 4,
)


def rows(table):
    return np.array([[float(number) for number in row.split()] for row in table.split(";")])


def wind_load(psi, u, v):
    """The table gives X, Y, N over the squared speed, by the direction the air comes from, clockwise from the bow."""
    north, east = WIND * -math.cos(WIND_FROM), WIND * -math.sin(WIND_FROM)
    ahead = math.cos(psi) * north + math.sin(psi) * east - u
    aside = math.cos(psi) * east - math.sin(psi) * north - v
    source = math.degrees(math.atan2(-aside, -ahead))
    table = rows(parameters(WindParameters).wind_table)
    X, Y, N = (np.interp(abs(source), table[:, 0], table[:, column]) for column in (1, 2, 3))
    side = math.copysign(1.0, source)
    return (ahead**2 + aside**2) * np.array([X, side * Y, side * N])


def wave_load(psi):
    """Mean drift 2 ∫ S D over the frequencies of the table."""
    table = rows(parameters(DriftParameters).drift_table)
    travel = math.degrees(math.remainder(WAVES_FROM + math.pi - psi, 2 * math.pi))
    omegas = np.unique(table[:, 0])
    headings = np.unique(table[:, 1])
    at_heading = np.array(
        [
            [
                np.interp(abs(travel), headings, table[table[:, 0] == omega][:, column])
                for column in (2, 3, 4)
            ]
            for omega in omegas
        ]
    )
    side = math.copysign(1.0, travel)
    fine = np.linspace(omegas[0], omegas[-1], 2000)
    spectrum = jonswap(fine, HEIGHT, PERIOD, 3.3)
    load = [
        np.trapezoid(2 * spectrum * np.interp(fine, omegas, at_heading[:, i]), fine)
        for i in range(3)
    ]
    return np.array([load[0], side * load[1], side * load[2]])


def hull_load(u, v):
    cross_flow = -0.5 * RHO * DRAUGHT * 1.5 * LENGTH * v * abs(v)
    lift = -30_000.0 * abs(u) * v
    return np.array(
        [-1645.0 * u * abs(u), cross_flow + lift, -2.3 * lift - (212_400.0 - 26_550.0) * u * v]
    )


def unit_load(u, v):
    """Side force of the two stopped azimuths at -45 and 45 deg."""
    total = np.zeros(3)
    for y, azimuth in ((-2.0, -math.pi / 4), (2.0, math.pi / 4)):
        across = math.cos(azimuth) * v - math.sin(azimuth) * u
        force = -0.80 * RHO * 1.9**2 * math.hypot(u, v) * across
        X, Y = -force * math.sin(azimuth), force * math.cos(azimuth)
        total += np.array([X, Y, -14.02 * Y - y * X])
    return total


def balance(psi):
    """Velocity over ground in body axes at which surge and sway balance, and the yaw moment left."""

    def loads(u, v):
        c, s = math.cos(psi), math.sin(psi)
        u_r, v_r = u - (c * CURRENT[0] + s * CURRENT[1]), v - (c * CURRENT[1] - s * CURRENT[0])
        return wind_load(psi, u, v) + wave_load(psi) + hull_load(u_r, v_r) + unit_load(u_r, v_r)

    start = [math.cos(psi) * CURRENT[0], -math.sin(psi) * CURRENT[0]]
    u, v = fsolve(lambda velocity: loads(*velocity)[:2], np.array(start) + 0.1)
    return u, v, loads(u, v)[2]


def stable_headings():
    """Headings at which the moment vanishes and turns the ship back: where it falls through zero."""
    grid = np.radians(np.arange(-180.0, 181.0, 5.0))
    moments = [balance(psi)[2] for psi in grid]
    return [
        brentq(lambda psi: balance(psi)[2], a, b)
        for a, b, left, right in zip(grid[:-1], grid[1:], moments[:-1], moments[1:], strict=True)
        if left > 0.0 > right
    ]


def test_free_drift_ends_in_the_balance_of_wind_waves_and_drag(run_scenario):
    table = run_scenario("drift")
    last = table.sel(time=slice(800.0, 900.0))
    assert float(abs(table["port.torque"].sel(time=310.0))) == 0.0
    psi = float(last["vessel.psi"].mean())
    north, east = (
        float((last[name][-1] - last[name][0]) / (last.time[-1] - last.time[0]))
        for name in ("vessel.x", "vessel.y")
    )
    expected_psi = min(
        stable_headings(), key=lambda heading: abs(math.remainder(heading - psi, 2 * math.pi))
    )
    u, v, _ = balance(expected_psi)
    expected_north = math.cos(expected_psi) * u - math.sin(expected_psi) * v
    expected_east = math.sin(expected_psi) * u + math.cos(expected_psi) * v
    course = math.atan2(east, north) - math.atan2(expected_east, expected_north)
    assert abs(math.degrees(math.remainder(psi - expected_psi, 2 * math.pi))) < 10.0
    assert abs(math.degrees(math.remainder(course, 2 * math.pi))) < 10.0
    assert math.hypot(north, east) == pytest.approx(
        math.hypot(expected_north, expected_east), rel=0.10
    )


def test_drift_is_predicted_from_what_the_ship_knows(run_scenario):
    """60 s ahead. Figures of ten seeds, and what others would miss: docs/generated/prediction.md."""
    table = run_scenario("drift")
    time, seconds = table["time"].values, 120  # rows in 60 s
    start, later = (time >= 305.0) & (time <= 330.0), (time >= 400.0) & (time <= 840.0)
    for when, most in ((start, 3.0), (later, 2.0)):
        rows = np.flatnonzero(when)
        x, y = (
            table[f"predictor.{axis}_60"][rows].values
            - table[f"vessel.{axis}"][rows + seconds].values
            for axis in "xy"
        )
        assert float(np.hypot(x, y).mean()) < most
