"""The ship in motion: the recorded run of another simulator, trials, energy, symmetry, current."""

from dataclasses import replace
from math import cos, degrees, hypot, pi, radians, sin

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.core.motion import Motion
from shipcosim.models.propulsion.azimuth import AzimuthParameters, azimuth_loads, azimuth_replay
from shipcosim.models.ship.hull import HullParameters, hull_loads
from shipcosim.models.ship.vessel import at_present, carried, step, through_water

from .test_hull import mass_matrix

LONG = parameters(HullParameters)
SHORT = parameters(HullParameters, "gunnerus-28m9", "vessel")
UNITS = [parameters(AzimuthParameters, "gunnerus-33m9", side) for side in ("port", "starboard")]
KNOT = 1852.0 / 3600.0


@pytest.fixture(scope="module")
def recorded(shared):
    """Turn of the short ship in Vico: states, accelerations, and the recorded loads of its two units."""
    path = shared / "reference/data/gunnerus_28p9_vico_turn_reference.csv"
    run = np.genfromtxt(path, delimiter=",", names=True, skip_header=1)
    port, starboard = (
        parameters(AzimuthParameters, "gunnerus-28m9", side) for side in ("port", "starboard")
    )
    X0, Y0, X1, Y1 = (run[f"bodyforce{i}_{axis}"] for i in (0, 1) for axis in ("surge", "sway"))
    tau = np.array([X0 + X1, Y0 + Y1, port.x * (Y0 + Y1) - port.y * X0 - starboard.y * X1])
    eta = np.array([run["N"], run["E"], np.radians(run["heading"])])
    nu = np.array([run["surge_vel"], run["sway_vel"], np.radians(run["yaw_vel"])])
    acceleration = np.array([run["surge_acc"], run["sway_acc"], np.radians(run["yaw_acc"])])
    return eta, nu, acceleration, tau


def test_short_ship_explains_the_recorded_accelerations(recorded):
    _, (u, v, r), acceleration, tau = recorded
    inertia = np.array([-v * r, u * r, 0.0 * r]) * SHORT.mass
    missing = mass_matrix(SHORT) @ acceleration + inertia - tau - hull_loads(u, v, r, hull=SHORT)
    assert np.all(np.max(np.abs(missing), axis=1) < [0.1e3, 1.1e3, 8.2e3])


def test_short_ship_repeats_the_recorded_turn(recorded):
    """Forces between the samples of 1 s by interpolation; 3.3 m and 1.7 deg after 160 s is what the sheet found."""
    eta, nu, _, tau = recorded
    ship, parts = Motion(*map(float, (*eta[:, 0], *nu[:, 0]))), 10
    for k in range(eta.shape[1] - 1):
        for share in (np.arange(parts) + 0.5) / parts:
            load = (1.0 - share) * tau[:, k] + share * tau[:, k + 1]
            ship = step(ship, *map(float, load), 0.0, 0.0, 1.0 / parts, hull=SHORT)
    assert hypot(ship.x - eta[0, -1], ship.y - eta[1, -1]) == pytest.approx(3.3, abs=0.1)
    assert abs(np.angle(np.exp(1j * (ship.psi - eta[2, -1])))) == pytest.approx(
        radians(1.7), abs=radians(0.1)
    )


def steady(rpm, angle, *, time=400.0, h=0.1):
    """The long ship after a while with both units alike: speed, yaw rate. [m/s, rad/s]"""
    ship = Motion(0.0, 0.0, 0.0, 4.0, 0.0, 0.0)
    for _ in range(round(time / h)):
        motion = ship.u, ship.v, ship.r
        loads = [
            azimuth_loads(azimuth_replay(rpm / 60.0, angle, *motion, unit=u), *motion, unit=u)
            for u in UNITS
        ]
        tau = [sum(load) for load in zip(*(load[2:] for load in loads), strict=True)]
        ship = step(ship, *tau, 0.0, 0.0, h, hull=LONG)
    return hypot(ship.u, ship.v), ship.r


@pytest.mark.parametrize("rpm, knots", [(110.0, 6.87), (170.0, 10.62), (195.0, 12.18)])
def test_long_ship_reaches_the_speeds_of_the_nominal_model(rpm, knots):
    speed, rate = steady(rpm, 0.0)
    assert speed / KNOT == pytest.approx(knots, rel=0.02)
    assert rate == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    "angle, rpm, diameter, rate",
    [(10.0, 170.0, 223.0, 2.56), (20.0, 164.0, 125.0, 3.72), (30.0, 110.0, 84.0, 3.01)],
)
def test_long_ship_turns_as_the_nominal_model(angle, rpm, diameter, rate):
    speed, r = steady(rpm, radians(angle))
    assert r < 0.0  # thrust to starboard at the stern turns the bow to port
    assert degrees(-r) == pytest.approx(rate, rel=0.02)
    assert 2.0 * speed / -r == pytest.approx(diameter, rel=0.02)


@pytest.mark.parametrize("hull", [LONG, SHORT], ids=["long", "short"])
def test_port_turn_mirrors_starboard_turn(hull):
    ship = mirrored = Motion(0.0, 0.0, 0.0, 2.0, 0.0, 0.0)
    for _ in range(200):
        ship = step(ship, 2e4, 4e3, 5e4, 0.1, 0.2, 0.1, hull=hull)
        mirrored = step(mirrored, 2e4, -4e3, -5e4, 0.1, -0.2, 0.1, hull=hull)
    np.testing.assert_allclose(mirrored, np.array(ship) * [1, -1, -1, 1, -1, -1], atol=1e-12)


def test_kinetic_energy_of_the_free_long_ship_never_grows():
    """Relative to the water, over two minutes, from 300 states."""
    u, v, r, psi = np.random.default_rng(2).uniform(-1.0, 1.0, (4, 300)) * [
        [8.0],
        [3.0],
        [0.3],
        [pi],
    ]
    ship, current = Motion(0.0 * u, 0.0 * u, psi, u, v, r), (0.4, -0.3)

    def energy(ship):
        nu_r = np.array([*through_water(ship.psi, ship.u, ship.v, *current), ship.r])
        return 0.5 * np.einsum("in,ij,jn->n", nu_r, mass_matrix(LONG), nu_r)

    before = energy(ship)
    for _ in range(240):
        ship = step(ship, 0.0, 0.0, 0.0, *current, 0.5, hull=LONG)
        after = energy(ship)
        assert np.all(after <= before)
        before = after


@pytest.mark.parametrize("hull", [LONG, SHORT], ids=["long", "short"])
def test_a_uniform_current_carries_a_free_ship_at_its_own_speed(hull):
    north, east, psi = 0.4, -0.3, 0.7
    u, v = north * cos(psi) + east * sin(psi), -north * sin(psi) + east * cos(psi)
    ship = Motion(0.0, 0.0, psi, u, v, 0.0)
    for _ in range(100):
        ship = step(ship, 0.0, 0.0, 0.0, north, east, 0.5, hull=hull)
    np.testing.assert_allclose(ship, [50.0 * north, 50.0 * east, psi, u, v, 0.0], atol=1e-12)


def test_motion_in_a_current_is_motion_in_still_water_plus_its_way():
    """Galilei: the same loads, seen by somebody who drifts along."""
    still = Motion(0.0, 0.0, 0.5, 1.0, 0.1, 0.02)
    u_c, v_c = 0.4 * cos(0.5) - 0.3 * sin(0.5), -0.4 * sin(0.5) - 0.3 * cos(0.5)
    carried = still._replace(u=1.0 + u_c, v=0.1 + v_c)
    for _ in range(100):
        still = step(still, 1e4, 2e3, -5e4, 0.0, 0.0, 0.1, hull=LONG)
        carried = step(carried, 1e4, 2e3, -5e4, 0.4, -0.3, 0.1, hull=LONG)
    assert carried.x - still.x == pytest.approx(4.0) and carried.y - still.y == pytest.approx(-3.0)
    assert carried.psi == pytest.approx(still.psi) and carried.r == pytest.approx(still.r)


@pytest.mark.parametrize(
    "hull", [LONG, replace(LONG, centre_of_gravity_x=1.0), SHORT], ids=["long", "offset", "short"]
)
def test_acceleration_is_what_a_small_step_gives(hull):
    ship, tau, current = Motion(0.0, 0.0, 0.5, 2.0, 0.3, 0.05), (1e4, -2e3, 3e4), (0.4, -0.3)
    later = step(ship, *tau, *current, 1e-5, hull=hull)
    found = (np.array(later[3:]) - ship[3:]) / 1e-5
    _, rates, _ = at_present(ship, *tau, *current, hull=hull)
    np.testing.assert_allclose(rates, found, rtol=1e-4, atol=1e-7)


def test_equation_of_motion_is_that_of_the_thesis():
    """M_RB nu_dot + C_RB(nu) nu + M_A nu_r_dot = tau + hull loads in matrices, with the current's own rate."""
    hull, ship, tau, current = (
        LONG,
        Motion(0.0, 0.0, 0.5, 2.0, 0.3, 0.05),
        (1e4, -2e3, 3e4),
        (0.4, -0.3),
    )
    u, v, r = ship[3:]
    u_r, v_r = through_water(ship.psi, u, v, *current)
    rates = np.array(at_present(ship, *tau, *current, hull=hull)[1])
    nu_c_dot = np.array([r * (v - v_r), -r * (u - u_r), 0.0])
    rigid = mass_matrix(replace(hull, A11=0.0, A22=0.0, A26=0.0, A62=0.0, A66=0.0))
    added = mass_matrix(hull) - rigid
    coriolis = hull.mass * np.array([-v * r, u * r, 0.0])
    left = rigid @ rates + coriolis + added @ (rates - nu_c_dot)
    np.testing.assert_allclose(
        left, np.add(tau, hull_loads(u_r, v_r, r, hull=hull)), rtol=1e-9, atol=1e-6
    )


def test_halving_the_step_changes_nothing_that_matters():
    def run(h):
        ship = Motion(0.0, 0.0, 0.0, 5.0, 0.0, 0.0)
        for _ in range(round(60.0 / h)):
            ship = step(ship, 6e4, 2e4, -2.5e5, 0.3, 0.1, h, hull=LONG)
        return ship

    np.testing.assert_allclose(run(0.1), run(0.05), atol=1e-5)


def swayed(share, *, parts=400):
    """Sway of a ship beam on to a current that grows from 0 to 0.4 m/s in 20 s, without damping or yaw. [m/s]"""
    plain = dict.fromkeys(("A26", "A62", "cross_flow_drag", "lift", "X_uu"), 0.0)
    hull = replace(LONG, **plain, added_mass_coriolis=0.0, current_acceleration=share)
    ship, h, change = Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 20.0 / parts, 0.4 / parts
    for k in range(parts):
        ship = step(
            carried(ship, 0.0, change, hull=hull),
            0.0,
            0.0,
            0.0,
            0.0,
            (k + 1) * change,
            h,
            hull=hull,
        )
    return ship.v


def test_accelerating_water_carries_the_ship_by_the_share_of_its_force_that_acts():
    """(m + A22) v_dot = F: nothing; the added mass alone, F = A22 v_c_dot; with the displaced mass, as the water."""
    assert swayed(0.0) == 0.0
    m, A22 = LONG.mass, LONG.A22
    assert swayed(A22 / (m + A22)) == pytest.approx(A22 * 0.4 / (m + A22))
    assert swayed(1.0) == pytest.approx(0.4)


def test_carried_by_all_of_the_force_the_ship_feels_no_change_of_a_current():
    hull = replace(LONG, current_acceleration=1.0)
    ship = Motion(1.0, 2.0, 0.7, 0.5, -0.2, 0.02)
    after = carried(ship, 0.3, -0.1, hull=hull)
    before = through_water(ship.psi, ship.u, ship.v, 0.1, 0.2)
    assert through_water(after.psi, after.u, after.v, 0.1 + 0.3, 0.2 - 0.1) == pytest.approx(before)
    assert carried(ship, 0.3, -0.1, hull=LONG) == ship
