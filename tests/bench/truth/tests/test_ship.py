import json

import numpy as np
import pandas as pd
import pytest

from truth.ship import (
    BETA,
    OTHER_WIND_LOAD,
    THRUST_COEFFICIENT,
    TOLERANCE,
    WIND_LOAD,
    Coefficients,
    draw_coefficients,
    strip_coefficients,
    wind_table,
)
from truth.thrusters import axial_thrust, side_force


def test_propeller_table_is_the_scaled_series_of_the_reference(shared):
    series = json.loads(
        (shared / "reference" / "data" / "propeller_4quadrant_fourier.json").read_text()
    )
    fourier = series["propellers"]["B4-70_PD1.4"]
    beta = np.radians(BETA)
    k = np.arange(len(fourier["AT"]))[:, None]
    scaled = np.array(fourier["AT"]) @ np.cos(k * beta) + np.array(fourier["BT"]) @ np.sin(k * beta)
    scaled *= np.interp(BETA, [-180, -90, 0, 31.9, 90, 180], [0.875, 1, 1.383, 0.441, 1, 0.875])
    elsewhere = (BETA < 0) | (BETA > 31.9)
    np.testing.assert_allclose(THRUST_COEFFICIENT[elsewhere], scaled[elsewhere], atol=1e-4)


def test_propellers_give_the_thrust_of_the_1260_points_straight_ahead(shared):
    points = pd.read_csv(
        shared / "reference" / "data" / "gunnerus_azimuth_fmu_dataset.csv", comment="#"
    )
    points.columns = ["u", "v", "r", "angle", "rpm", "fx", "fy"]
    points = points[(points.v == 0) & (points.angle == 0)]
    ships = Coefficients.stack(
        [draw_coefficients(np.random.default_rng(0), mismatch=0.0)] * len(points)
    )
    rpm = np.tile(points.rpm.to_numpy(), (2, 1))
    thrust = axial_thrust(rpm, np.tile(points.u.to_numpy(), (2, 1)), ships)[0]
    assert np.sqrt(np.mean((thrust - points.fx) ** 2)) < 0.01 * points.fx.abs().max()


def test_side_force_is_that_of_the_1260_points_as_well_as_the_reference_formula(shared):
    points = pd.read_csv(
        shared / "reference" / "data" / "gunnerus_azimuth_fmu_dataset.csv", comment="#"
    )
    u, v, _, angle, rpm, fx, fy = points.to_numpy().T
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    ships = Coefficients.stack(
        [draw_coefficients(np.random.default_rng(0), mismatch=0.0)] * len(points)
    )
    across = c * fy - s * fx
    ours = side_force(
        np.tile(rpm, (2, 1)), np.tile(c * u + s * v, (2, 1)), np.tile(c * v - s * u, (2, 1)), ships
    )[0]
    assert np.sqrt(np.mean((ours - across) ** 2)) < 4000.0 < np.sqrt(np.mean(across**2)) / 8


def test_wind_tables_are_those_of_the_reference(shared):
    folder = shared / "reference" / "data"
    ours = pd.read_csv(folder / "gunnerus_33p9_wind_load_coefficients.csv", comment="#")
    np.testing.assert_allclose(
        WIND_LOAD, ours[["Cx", "Cy", "Cpsi"]].to_numpy().T, rtol=1e-3, atol=0.01
    )
    other = (
        pd.read_csv(folder / "gunnerus_28p9_wind_coefficients.csv", comment="#")[["CX", "CY", "CN"]]
        .to_numpy()
        .T
    )
    size = 0.5 * 1.23 * np.array([85.0, 210.0, 210.0 * 36.25])[:, None]
    np.testing.assert_allclose(OTHER_WIND_LOAD, size * other[:, ::-1], rtol=1e-6)


def test_wind_load_mirrors_port_and_starboard():
    table = wind_table(np.ones(3), rough=True)
    np.testing.assert_allclose(table[:, ::-1], table * np.array([[1.0], [-1.0], [-1.0]]), atol=1e-9)


@pytest.mark.parametrize("mismatch", [1.0, 2.0])
def test_coefficients_scatter_as_the_tolerances_say(mismatch):
    rng = np.random.default_rng(3)
    ships = Coefficients.stack([draw_coefficients(rng, mismatch) for _ in range(1500)])
    for name, tolerance in (
        ("mass", "mass"),
        ("drag", "drag"),
        ("lift", "lift"),
        ("tunnel", "tunnel"),
    ):
        values = getattr(ships, name)
        assert values.std() / values.mean() == pytest.approx(
            mismatch * TOLERANCE[tolerance], rel=0.08
        )
    ahead, astern = ships.propeller[0, 72], ships.propeller[0, 0]
    assert ahead.std() / ahead.mean() == pytest.approx(0.01 * mismatch, rel=0.08)
    assert abs(astern.std() / astern.mean()) == pytest.approx(0.05 * mismatch, rel=0.08)
    assert ships.azimuth_error.std() == pytest.approx(np.radians(0.2) * mismatch, rel=0.08)


def test_rough_cross_flow_has_another_shape_and_the_same_mean():
    assert strip_coefficients(rough=True).mean() == pytest.approx(
        strip_coefficients(rough=False).mean()
    )
    assert np.ptp(strip_coefficients(rough=True)) > 0.5
