"""Each effect does to the ship what the contract says, with its unit and sign."""

import re
from pathlib import Path

import numpy as np
import pytest

import truth
from truth import effects, plant, unknowns
from truth.knobs import Knobs
from truth.ship import Coefficients, draw_coefficients
from truth.thrusters import tunnel_load, unit_loads

N = 2
ZERO = np.zeros(N)


def both(*values):
    return np.repeat(np.array(values, float)[:, None], N, axis=1)


@pytest.fixture
def coefficients():
    return Coefficients.stack([draw_coefficients(np.random.default_rng(0), mismatch=0.0)] * N)


def hidden(cause, parameters, component=None, shape=None):
    """Knobs of two ships of which the first has an effect, at the start of the log and heading north."""
    knobs, effect = (
        Knobs(N),
        effects.Effect(effects.Answer(cause, component, parameters), shape or {}),
    )
    effects.ACT[cause](effect, knobs, 0, 0.0, ship_at(0.0), 1.0)
    return knobs


def ship_at(psi):
    coefficients = Coefficients.stack(
        [draw_coefficients(np.random.default_rng(0), mismatch=0.0)] * N
    )
    return plant.at_rest(
        ZERO, ZERO, ZERO + psi, both(80, 80, 500), both(0, 0), coefficients, Knobs(N)
    )


def units(coefficients, knobs, rpm=(80, 80, 0), azimuth=(0, 0)):
    """Load of the units, of the ship with the effect and of the one without."""
    return np.array(
        unit_loads(ZERO, ZERO, ZERO, both(*rpm), np.radians(both(*azimuth)), coefficients, knobs)
    )


def started(coefficients, knobs, **turned):
    """Where two ships that lay still have gone after 20 s."""
    ship = plant.at_rest(ZERO, ZERO, ZERO, both(0, 0, 0), both(0, 0), coefficients, Knobs(N))
    ship = ship._replace(**turned)
    for _ in range(80):
        ship = plant.step(ship, ship.rpm, ship.azimuth, both(0, 0), ZERO, coefficients, knobs, 0.25)
    return ship


def test_current_carries_the_ship_where_it_goes(coefficients):
    knobs = hidden("current", {"north": 0.3, "east": -0.2})
    for _ in range(3):
        ship = started(coefficients, knobs)
    assert ship.x[0] > 0 > ship.y[0]
    assert ship.x[1] == ship.y[1] == 0


def test_varying_current_has_its_values_at_the_first_and_last_row():
    rng, ends = np.random.default_rng(2), []
    for _ in range(8):
        _, parameters, shape = effects.draw_current_varying(rng, 1.0, 40)
        effect = effects.Effect(effects.Answer("current_varying", None, parameters), shape)
        for t, end in ((0.0, "start"), (2400.0, "end")):
            knobs = Knobs(N)
            effects.act_current_varying(effect, knobs, 0, t, None, 1.0)
            assert knobs.current_north[0] == pytest.approx(parameters[f"north_{end}"], abs=1e-12)
            assert knobs.current_east[0] == pytest.approx(parameters[f"east_{end}"], abs=1e-12)
        ends.append(shape["turn"] == 0.0)
    assert any(ends) and not all(ends)


def test_wave_drift_on_the_beam_is_the_vector_of_the_contract():
    _, parameters, shape = effects.draw_wave_drift(np.random.default_rng(1), 1.0, 40)
    size, towards = (
        np.hypot(*parameters.values()),
        np.arctan2(parameters["east"], parameters["north"]),
    )
    effect = effects.Effect(effects.Answer("wave_drift", None, parameters), shape)
    on_beam, from_astern, quartering = [], [], []
    for t in range(0, 20000, 100):
        for psi, seen in (
            (towards - np.pi / 2, on_beam),
            (towards, from_astern),
            (towards - np.pi / 4, quartering),
        ):
            knobs = Knobs(N)
            effects.act_wave_drift(effect, knobs, 0, t, ship_at(psi), 1.0)
            seen.append((knobs.force_x[0], knobs.force_y[0], knobs.moment[0]))
    assert np.mean(on_beam, axis=0)[1] == pytest.approx(size, rel=0.1)
    assert np.std(on_beam, axis=0)[1] == pytest.approx(0.15 * size, rel=0.3)
    assert np.mean(from_astern, axis=0)[0] == pytest.approx(size / 3, rel=0.8)
    assert abs(np.mean(quartering, axis=0)[1]) < 0.7 * size
    assert abs(np.mean(quartering, axis=0)[2]) > 5 * abs(np.mean(on_beam, axis=0)[2])


def test_tow_pulls_the_stern(coefficients):
    ship = started(coefficients, hidden("tow", {"north": 0.0, "east": 3000.0}))
    assert ship.y[0] > 0 and ship.psi[0] < 0


@pytest.mark.parametrize("thruster", effects.THRUSTERS)
def test_thrust_loss_weakens_that_thruster_alone(coefficients, thruster):
    knobs = hidden("thrust_loss", {"loss": 0.3}, thruster)
    load = units(coefficients, knobs)
    tunnel = tunnel_load(ZERO, ZERO + 500.0, coefficients, knobs)
    lost = {"port": -load[2, 0], "starboard": load[2, 0], "tunnel": 1 - tunnel[0] / tunnel[1]}
    assert (tunnel[0] / tunnel[1]) == pytest.approx(0.7 if thruster == "tunnel" else 1.0)
    assert load[0, 0] / load[0, 1] == pytest.approx(1.0 if thruster == "tunnel" else 0.85)
    assert lost[thruster] > 0


def test_azimuth_offset_turns_the_real_thrust_clockwise_of_the_logged(coefficients):
    knobs = hidden("azimuth_offset", {"offset": 10.0}, "port")
    rpm, azimuth = both(80, 80, 0), np.radians(both(0, 0))
    for _ in range(100):
        rpm, azimuth = plant.turn_drives(
            rpm, azimuth, both(80, 80, 0), both(0, 0), coefficients, knobs, 0.25
        )
    assert np.degrees(azimuth[0, 0]) == pytest.approx(10.0, abs=0.1)
    assert np.degrees(azimuth[1, 0]) == pytest.approx(0.0, abs=0.1)


def test_rpm_offset_is_logged_minus_real(coefficients):
    knobs = hidden("rpm_offset", {"offset": 12.0}, "starboard")
    rpm, azimuth = both(80, 80, 0), both(0, 0)
    for _ in range(200):
        rpm, azimuth = plant.turn_drives(
            rpm, azimuth, both(80, 80, 0), azimuth, coefficients, knobs, 0.25
        )
    assert rpm[1, 0] == pytest.approx(68.0, abs=0.1)
    assert rpm[0, 0] == pytest.approx(80.0, abs=0.1)


def test_reverse_loss_is_at_negative_rpm_only(coefficients):
    knobs = hidden("reverse_loss", {"loss": 0.4})
    ahead, astern = units(coefficients, knobs)[0], units(coefficients, knobs, rpm=(-80, -80, 0))[0]
    assert ahead[0] == ahead[1]
    assert astern[0] / astern[1] == pytest.approx(0.6)


@pytest.mark.parametrize(
    ("rpm", "azimuth", "share"),
    [
        (
            (80, 0, 0),
            (-90, 0),
            1.0,
        ),  # port pushes to port: its slipstream hits starboard, which does not run
        ((80, 80, 0), (-90, 0), 0.6),  # and which does
        ((80, 80, 0), (-90, 45), 0.6),
        ((80, 80, 0), (90, 0), 1.0),  # away
        ((-80, 80, 0), (90, 0), 0.6),  # astern with the unit turned round is the same slipstream
        ((80, 80, 0), (-45, 0), 0.97),  # 45 deg off it misses
    ],
)
def test_interaction_takes_from_the_unit_in_the_slipstream(coefficients, rpm, azimuth, share):
    knobs = hidden("thruster_interaction", {"loss": 0.4}, shape={"width": 20.0})
    alone = units(coefficients, knobs, (rpm[0], 0, 0), azimuth)
    together = units(coefficients, knobs, rpm, azimuth)
    of_starboard = np.hypot(*(together - alone)[:2])
    if rpm[1]:
        assert of_starboard[0] / of_starboard[1] == pytest.approx(share, abs=0.04)
    assert alone[1, 0] == pytest.approx(alone[1, 1])


def test_mass_scales_inertia_but_not_added_mass(coefficients):
    ship = started(coefficients, Knobs(N)), started(coefficients, hidden("mass", {"scale": 1.2}))
    assert all(np.all(s.u == 0) for s in ship)
    knobs = hidden("mass", {"scale": 1.2})
    u, v, r = plant.velocities((ZERO + 1e6, ZERO, ZERO), ZERO, ZERO, coefficients, knobs)
    assert u[1] / u[0] == pytest.approx((1.2 * 531e3 + 26550) / (531e3 + 26550))
    _, _, r = plant.velocities((ZERO, ZERO, ZERO + 1e6), ZERO, ZERO, coefficients, knobs)
    assert r[0] < r[1]


def test_drag_and_cross_flow_scale_their_terms_alone(coefficients):
    moving = (ZERO + 0.5, ZERO + 0.3, ZERO + 0.02)
    drag = plant.hull_load(*moving, coefficients, hidden("drag", {"scale": 2.0}))
    assert drag[0][0] == pytest.approx(2 * drag[0][1]) and drag[1][0] == drag[1][1]
    flow = plant.hull_load(ZERO, *moving[1:], coefficients, hidden("crossflow", {"scale": 1.5}))
    assert flow[1][0] == pytest.approx(1.5 * flow[1][1]) and flow[2][0] == pytest.approx(
        1.5 * flow[2][1]
    )


def test_wind_scale_is_of_the_force(coefficients):
    load = plant.wind_load(
        ZERO, ZERO, ZERO, ZERO + 5, ZERO + 3, coefficients, hidden("wind_scale", {"scale": 1.3})
    )
    np.testing.assert_allclose(load[:, 0], 1.3 * load[:, 1])


@pytest.mark.parametrize("cause", effects.DRAW)
def test_half_the_size_is_half_as_far_from_neutral(cause):
    full, half = (effects.DRAW[cause](np.random.default_rng(9), size, 40)[1] for size in (1.0, 0.5))
    for name, value in full.items():
        neutral = 1.0 if name == "scale" else 0.0
        assert half[name] - neutral == pytest.approx((value - neutral) / 2)


@pytest.mark.parametrize("cause", effects.DRAW)
def test_sizes_keep_to_the_table_and_use_it(cause):
    low, high, _ = effects.SIZES[cause]
    drawn = [effects.DRAW[cause](np.random.default_rng(seed), 1.0, 40) for seed in range(200)]
    scales = cause in ("wind_scale", "mass", "drag", "crossflow", "velocity_scale")
    sizes = np.array([np.max(np.abs(np.array(list(p.values())) - scales)) for _, p, _ in drawn])
    if cause == "rpm_offset":
        sizes = sizes / np.array([12.0 if c == "tunnel" else 1.0 for c, _, _ in drawn])
    if cause in ("current", "current_varying", "wave_drift", "tow", "lever_arm"):
        sizes = np.array(
            [np.max(np.hypot(*np.reshape(list(p.values()), (-1, 2)).T)) for _, p, _ in drawn]
        )
    least = 0.6 * low if cause == "crossflow" else low
    assert least <= sizes.min() < least + 0.1 * (high - low)
    assert high - 0.1 * (high - low) < sizes.max() <= high


def test_the_table_of_sizes_in_the_readme_is_the_one_in_use():
    text = (Path(truth.__file__).with_name("README.md")).read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\w+) \| ([\d.]+) \| ([\d.]+) \| (.*?)\|$", text, flags=re.M)
    assert {
        name: (float(low), float(high), unit.strip()) for name, low, high, unit in rows
    } == effects.SIZES


def test_catalogue_is_that_of_the_contract(shared):
    text = (
        (shared / "contracts.md")
        .read_text(encoding="utf-8")
        .split("### Causes, their parameters and units")[1]
    )
    rows = [line.split("|")[1] for line in text.splitlines() if line.startswith("| `")]
    assert {name for row in rows for name in re.findall(r"`(\w+)`", row)} == set(effects.SIZES)


@pytest.mark.parametrize("name", unknowns.ALL)
def test_unknown_effects_turn_a_knob_and_none_that_stays_neutral(name):
    effect = unknowns.draw_unknown(np.random.default_rng(4), "trial", 1.0, (0.0, 0.0), name)
    turned = False
    for t in range(0, 600, 10):
        knobs, ship = Knobs(N), ship_at(0.7)
        ship = ship._replace(x=ship.x + 2, y=ship.y - 3, u=ship.u + 0.2, rpm=both(30, 30, 100))
        unknowns.act_unknown(effect, knobs, 0, float(t), ship, 1.0)
        turned |= bool(np.any(knobs.table[:, 0] != knobs.neutral))
        np.testing.assert_array_equal(knobs.table[:, 1], knobs.neutral)
    assert turned


def test_there_are_at_least_eight_effects_outside_the_catalogue():
    assert len(unknowns.ALL) >= 8 and not set(unknowns.ALL) & set(effects.SIZES)
