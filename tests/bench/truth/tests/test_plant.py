import numpy as np
import pytest

from truth import plant
from truth.knobs import Knobs
from truth.ship import DRAUGHT, LENGTH, WATER_DENSITY, Coefficients, draw_coefficients
from truth.thrusters import unit_loads

KNOT = 1852.0 / 3600.0
N = 2
ZERO = np.zeros(N)


def ships(mismatch=0.0, rough=False):
    return Coefficients.stack([draw_coefficients(np.random.default_rng(5), mismatch, rough)] * N)


def both(*values, n=N):
    return np.repeat(np.array(values, float)[:, None], n, axis=1)


def sail(
    seconds,
    rpm=(0, 0, 0),
    azimuth=(0, 0),
    wind=(0, 0),
    nu=(0, 0, 0),
    h=0.25,
    psi=0.0,
    turn=(),
    coefficients=None,
):
    """Ship after some seconds with its thrusters as they are."""
    coefficients = coefficients or ships()
    n = coefficients.mass.size
    knobs, zero = Knobs(n), np.zeros(n)
    for name, value in dict(turn).items():
        getattr(knobs, name)[:] = value
    rpm, azimuth, wind = both(*rpm, n=n), np.radians(both(*azimuth, n=n)), both(*wind, n=n)
    ship = plant.at_rest(zero, zero, zero + psi, rpm, azimuth, coefficients, knobs)
    u, v, r = both(*nu, n=n)
    u_c, v_c = plant.to_body(ship.psi, knobs.current_north, knobs.current_east)
    momentum = plant.momenta(u, v, r, u_c, v_c, coefficients, knobs)
    ship = ship._replace(u=u, v=v, r=r, u_r=u - u_c, v_r=v - v_c, momentum=momentum)
    for _ in range(round(seconds / h)):
        ship = plant.step(ship, rpm, azimuth, wind, zero, coefficients, knobs, h)
    return ship


def ideal():
    """Ships without resistance of any kind."""
    coefficients = ships()
    for name in ("drag", "strips", "lift", "side_spin", "side_flow", "propeller", "wind"):
        setattr(coefficients, name, 0.0 * getattr(coefficients, name))
    return coefficients


def energy(ship, coefficients):
    a11, a22, a26, a66 = coefficients.added
    m, inertia = coefficients.mass, coefficients.inertia
    u, v, r = ship.u, ship.v, ship.r
    return 0.5 * ((m + a11) * u**2 + (m + a22) * v**2 + 2 * a26 * v * r + (inertia + a66) * r**2)


@pytest.mark.parametrize(("rpm", "knots"), [(110, 6.87), (170, 10.62), (195, 12.18)])
def test_speed_ahead_is_that_of_the_nominal_model(rpm, knots):
    assert sail(900, rpm=(rpm, rpm, 0)).u[0] / KNOT == pytest.approx(knots, rel=0.01)


@pytest.mark.parametrize(
    ("angle", "rpm", "diameter", "rate"),
    [(10, 170, 223, 2.56), (20, 164, 125, 3.72), (30, 110, 84, 3.01)],
)
def test_steady_turns_are_those_of_the_nominal_model(angle, rpm, diameter, rate):
    ship = sail(900, rpm=(rpm, rpm, 0), azimuth=(angle, angle))
    assert np.degrees(abs(ship.r[0])) == pytest.approx(rate, rel=0.01)
    assert 2 * np.hypot(ship.u, ship.v)[0] / abs(ship.r[0]) == pytest.approx(diameter, rel=0.01)


def test_speeds_of_drawn_ships_scatter_as_little_as_the_tolerances():
    drawn = Coefficients.stack(
        [draw_coefficients(np.random.default_rng(seed)) for seed in range(60)]
    )
    speeds = sail(600, rpm=(170, 170, 0), coefficients=drawn).u / KNOT
    assert np.mean(speeds) == pytest.approx(10.62, rel=0.02)
    assert 0.003 < np.std(speeds) / 10.62 < 0.04


def test_an_ideal_fluid_keeps_energy_and_earth_fixed_momentum():
    coefficients = ideal()
    before = sail(0, nu=(1.0, 0.4, 0.03), coefficients=coefficients)
    after = sail(200, nu=(1.0, 0.4, 0.03), coefficients=coefficients)
    assert energy(after, coefficients) == pytest.approx(energy(before, coefficients), rel=1e-3)
    start, end = (plant.to_earth(s.psi, *s.momentum[:2]) for s in (before, after))
    np.testing.assert_allclose(end, start, atol=1e-3 * np.hypot(*start).max())


def test_resistance_only_takes_energy():
    coefficients = ships(mismatch=1.0)
    energies = [
        energy(sail(t, nu=(0.8, -0.5, 0.03), coefficients=coefficients), coefficients)[0]
        for t in range(0, 100, 10)
    ]
    assert np.all(np.diff(energies) < 0)


def test_port_and_starboard_mirror():
    ship = sail(120, (90, 40, 600), (30, -50), (5, 4), (0.4, 0.2, 0.01))
    mirror = sail(120, (40, 90, -600), (50, -30), (5, -4), (0.4, -0.2, -0.01))
    for name, sign in (("x", 1), ("u", 1), ("y", -1), ("psi", -1), ("v", -1), ("r", -1)):
        np.testing.assert_allclose(
            getattr(mirror, name), sign * getattr(ship, name), rtol=1e-9, atol=1e-9
        )


def test_earth_may_be_turned():
    ship = sail(120, (90, 40, 600), (30, -50), (5, 4))
    c, s = np.cos(1.1), np.sin(1.1)
    other = sail(120, (90, 40, 600), (30, -50), (5 * c - 4 * s, 5 * s + 4 * c), psi=1.1)
    np.testing.assert_allclose(
        (other.x, other.y), (c * ship.x - s * ship.y, s * ship.x + c * ship.y), atol=1e-9
    )


def test_half_the_step_ends_within_two_centimetres_after_a_minute():
    coarse, fine = (
        sail(60, (90, 40, 600), (30, -50), (5, 4), (0.4, 0.2, 0.02), h=h) for h in (0.25, 0.125)
    )
    assert np.hypot(coarse.x - fine.x, coarse.y - fine.y)[0] < 0.02


def test_cross_flow_of_the_strips_is_the_closed_form():
    pure_sway = plant.hull_load(ZERO, ZERO + 0.5, ZERO, ships(), Knobs(N))
    pure_yaw = plant.hull_load(ZERO, ZERO, ZERO + 0.04, ships(), Knobs(N))
    per_length = 0.5 * WATER_DENSITY * DRAUGHT * 1.5
    assert pure_sway[1][0] == pytest.approx(-per_length * LENGTH * 0.25, rel=1e-9)
    assert pure_yaw[2][0] == pytest.approx(-per_length * LENGTH**4 / 32 * 0.0016, rel=0.01)


def test_a_dead_ship_drifts_with_the_current():
    turn = {
        "current_north": 0.25,
        "current_east": -0.1,
        "drag": 20.0,
    }  # more, so that it need not take hours
    ship = sail(1500, nu=(0.5, 0.3, 0.0), turn=turn)
    north, east = plant.to_earth(ship.psi, ship.u, ship.v)
    assert north[0] == pytest.approx(0.25, abs=0.03)
    assert east[0] == pytest.approx(-0.1, abs=0.03)


def test_a_steady_current_only_carries_the_ship_along():
    still = sail(200, (80, 60, 300), (20, -10), nu=(0.5, 0.0, 0.0))
    turn = {"current_north": 0.3, "current_east": 0.2}
    carried = sail(200, (80, 60, 300), (20, -10), wind=(0.3, 0.2), nu=(0.8, 0.2, 0.0), turn=turn)
    assert carried.psi[0] == pytest.approx(still.psi[0], abs=1e-3)
    assert carried.x[0] - still.x[0] == pytest.approx(60.0, abs=0.1)
    assert carried.y[0] - still.y[0] == pytest.approx(40.0, abs=0.1)


def test_units_pull_their_bollard_thrust():
    coefficients, knobs = ships(), Knobs(N)
    still = (ZERO, ZERO, ZERO)
    scale = WATER_DENSITY * 1.9**4 * (100 / 60) ** 2
    ahead = unit_loads(*still, both(100, 100, 0), both(0, 0), coefficients, knobs)[0]
    astern = unit_loads(*still, both(-100, -100, 0), both(0, 0), coefficients, knobs)[0]
    assert ahead[0] == pytest.approx(2 * 0.8208 * scale, rel=0.002)
    assert astern[0] == pytest.approx(-2 * 0.418 * scale, rel=0.002)


def test_a_side_wind_heels_a_rough_ship_away_from_it():
    assert sail(60, wind=(0, 10), coefficients=ships(rough=True)).roll[0] > np.radians(0.1)
    assert sail(60, wind=(0, 10), coefficients=ships()).roll[0] == 0.0


def test_nothing_moves_without_cause():
    ship = sail(100)
    assert (
        max(np.abs(value).max() for value in (ship.x, ship.y, ship.psi, ship.u, ship.v, ship.r))
        < 1e-12
    )
