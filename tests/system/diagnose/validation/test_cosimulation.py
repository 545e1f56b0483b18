"""Predictions as co-simulations: the extended system itself says what the array form says."""

from dataclasses import replace

import numpy as np
import pytest

from shipcosim.diagnose.extension.extend import extend
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.inference.predictions import replayable
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.measured_motion import true_motion
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.diagnose.validation.cosimulation import (
    Replayed,
    driving_table,
    in_array_form,
    replayed,
)
from shipcosim.diagnose.validation.gain import Predictor
from shipcosim.errors import ShipcosimError
from shipcosim.library import build_stale
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import apparent_wind
from shipcosim.ssp import read_system, with_values

ROWS = np.array([20, 130])
TIME = 300.0 + np.arange(220.0)
SPAN = (250.0, 700.0)


@pytest.fixture(scope="module")
def system(root):
    return read_system(root / "ssp" / "gunnerus_open", fmus=[build_stale(root)])


@pytest.fixture(scope="module")
def ship_model(system):
    return replace(ship_model_of(system), span=SPAN)


@pytest.fixture(scope="module")
def log():
    """A log of units that work, turn and reverse in a wind that turns."""
    slow = (TIME - TIME[0]) / 40.0
    units = {
        "port": (1.2 + 0.5 * np.sin(slow), 0.4 * np.sin(0.7 * slow)),
        "starboard": (0.9 * np.cos(0.8 * slow), np.pi + 0.5 * np.sin(slow)),
        "tunnel": (8.0 * np.sin(1.3 * slow), np.zeros(TIME.size)),
    }
    wind = 8.0 + np.sin(slow), 1.0 + 0.6 * np.sin(0.5 * slow)
    return Record(TIME, np.zeros((TIME.size, 6)), units, wind, np.ones(TIME.size, bool))


def predictor(log, ship_model):
    """A model that starts from what the log shows: ahead at 1 m/s, turning."""
    t = TIME - TIME[0]
    psi = 0.3 + 0.005 * t
    seen = Motion(3.0 + 0.9 * t, 0.3 * t, psi, 1.0 + 0.0 * t, 0.1 + 0.0 * t, 0.005 + 0.0 * t)
    return Predictor(*replayable(log, ship_model, seen), ship_model, true_motion(seen, ship_model))


def found(cause, component=None, **parameters):
    estimates = {
        name: ParameterEstimate(value, 0.1 * abs(value), unit)
        for name, (value, unit) in parameters.items()
    }
    return Finding(cause, component, parameters=estimates)


CAUSES = {
    "none": ([], {}),
    "aboard": (
        [
            found("thrust_loss", "port", loss=(0.3, "1")),
            found("azimuth_offset", "starboard", offset=(8.0, "deg")),
            found("wind_direction", offset=(15.0, "deg")),
            found("mass", scale=(1.15, "1")),
        ],
        {
            "port.thrust_loss": 0.3,
            "starboard.azimuth_offset": np.radians(8.0),
            "vessel.apparent_wind_offset": np.radians(15.0),
            "vessel.mass_scale": 1.15,
        },
    ),
    "around": (
        [
            found("current", north=(0.25, "m/s"), east=(-0.15, "m/s")),
            found("tow", north=(1500.0, "N"), east=(-1000.0, "N")),
            found("wave_drift", north=(-1000.0, "N"), east=(2000.0, "N")),
        ],
        {
            "water.current_north": 0.25,
            "water.current_east": -0.15,
            "water.tow_north": 1500.0,
            "water.tow_east": -1000.0,
            "water.drift_north": -1000.0,
            "water.drift_east": 2000.0,
        },
    ),
    "shown": (
        [
            found("heading_bias", offset=(4.0, "deg")),
            found("lever_arm", x=(6.0, "m"), y=(-2.0, "m")),
            found("velocity_scale", scale=(1.1, "1")),
            found("navigation_lag", lag=(2.35, "s")),
        ],
        {
            "instruments.heading_bias": np.radians(4.0),
            "instruments.lever_x": 6.0,
            "instruments.lever_y": -2.0,
            "instruments.velocity_scale": 1.1,
            "instruments.navigation_lag": 2.35,
        },
    ),
    "late": ([], {"instruments.thruster_lag": 3.0}),
}


def extended(root, folder, findings):
    if not findings:
        return Replayed(read_system(root / "ssp" / "gunnerus_open", fmus=[build_stale(root)]))
    made = extend(root / "ssp" / "gunnerus_open", findings, folder, log_attributes={"span": SPAN})
    return Replayed(read_system(made.ssp), made.signals)


@pytest.mark.parametrize("name", CAUSES)
def test_a_minute_of_the_extended_system_is_that_of_the_array_form(
    root, tmp_path, ship_model, log, name
):
    findings, values = CAUSES[name]
    model = predictor(log, ship_model.with_values(values))
    array, one = in_array_form(model, ROWS), extended(root, tmp_path, findings)
    coarse, fine = (replayed(one, model, ROWS, step_size=h) for h in (0.1, 0.05))
    assert np.hypot(coarse.x - array.x, coarse.y - array.y).max() < 0.1
    limit = Motion(
        *(2.0 * b - a for a, b in zip(coarse, fine, strict=True))
    )  # exchange is of first order in the step
    assert np.hypot(limit.x - array.x, limit.y - array.y).max() < 0.01
    assert np.abs(np.angle(np.exp(1j * (limit.psi - array.psi)))).max() < np.radians(0.02)


def test_without_the_cause_a_minute_ends_elsewhere(ship_model, log):
    with_it, without = (
        in_array_form(predictor(log, ship_model.with_values(values)), ROWS)
        for values in (CAUSES["aboard"][1], {})
    )
    assert np.hypot(with_it.x - without.x, with_it.y - without.y)[-1].min() > 0.3


def test_parameters_by_a_set_of_values_do_as_an_extension(ship_model, log, system):
    values = {"starboard.thrust_loss": 0.4}
    model = predictor(log, ship_model.with_values(values))
    found = replayed(Replayed(with_values(system, values)), model, ROWS, step_size=0.05)
    array = in_array_form(model, ROWS)
    assert np.hypot(found.x - array.x, found.y - array.y).max() < 0.05


def test_wind_over_ground_meets_the_moving_ship_as_logged(ship_model, log):
    model = predictor(log, ship_model)
    inputs = model.record.inputs(model.model)
    north, east = (-inputs.wind_speed * part(inputs.wind_from) for part in (np.cos, np.sin))
    ship = Motion(*(value[:-1] for value in model.motion))
    speed, direction = apparent_wind(ship.psi, ship.u, ship.v, north, east)
    later = log.inputs(ship_model)  # the sensor's average is of some time ago
    assert np.allclose(speed, later.wind_speed)
    assert np.allclose(direction, later.wind_from)


def test_thrusters_that_no_input_feeds_are_named_together(system, ship_model, log):
    fewer = replace(
        system,
        connections=tuple(c for c in system.connections if c.target[1] != "rpm_in"),
    )
    everyone = "feeds port.rpm_in, starboard.rpm_in, tunnel.rpm_in, which"
    with pytest.raises(ShipcosimError, match=everyone):
        driving_table(fewer, predictor(log, ship_model), 0.1)


def test_a_propeller_that_cannot_turn_needs_no_input_for_its_direction(system, ship_model, log):
    fixed = replace(
        log, units=log.units | {"port": (log.units["port"][0], np.full(TIME.size, 0.1))}
    )
    without = replace(
        system,
        connections=tuple(c for c in system.connections if c.target != ("port", "azimuth_in")),
    )
    model = predictor(fixed, ship_model)
    table, states = driving_table(without, model, 0.1)
    assert "port_azimuth" not in table and states["port.azimuth_in"] == 0.1
    found, array = replayed(Replayed(without), model, ROWS[:1]), in_array_form(model, ROWS[:1])
    assert np.hypot(found.x - array.x, found.y - array.y).max() < 0.1
