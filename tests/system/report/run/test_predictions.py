"""The table of predictions of a run, and what the page shows of it."""

import csv

import numpy as np
import pytest
import xarray as xr

from shipcosim.report import write_report
from shipcosim.report.run.predictions import (
    UNITS,
    make_predictions,
    summarise,
    texts,
    write_predictions,
)

SPEED = (0.5, -0.25)  # m/s, north and east
TURN = np.radians(1.5)  # rad/s, through south within the run


@pytest.fixture(scope="module")
def table():
    """A ship that moves and turns evenly, and a predictor that is 3 m too far north and 0.1 rad off after 30 s."""
    time = np.arange(0.0, 121.0, 0.5)
    made = np.floor(time / 2.0) * 2.0
    units = {"x": "m", "y": "m", "psi": "rad"}

    def pose(t):
        return {
            "x": SPEED[0] * t,
            "y": SPEED[1] * t,
            "psi": (2.0 + TURN * t + np.pi) % (2 * np.pi) - np.pi,
        }

    found = {
        f"vessel.{axis}": ("time", v, {"units": units[axis]}) for axis, v in pose(time).items()
    }
    found["predictor.predicted_at"] = ("time", made, {"units": "s"})
    found["predictor.learned"] = ("time", np.where(made < 40.0, 1.0, 0.25), {"units": "1"})
    for ahead, off in ((10, (0.0, 0.0, 0.0)), (30, (3.0, 0.0, 0.1))):
        for (axis, value), error in zip(pose(made + ahead).items(), off, strict=True):
            found[f"predictor.{axis}_{ahead}"] = ("time", value + error, {"units": units[axis]})
        circle = np.where(made < 20.0, 3.5, 2.5)
        found[f"predictor.position_region_{ahead}"] = ("time", circle, {"units": "m"})
        found[f"predictor.heading_region_{ahead}"] = ("time", 0.0 * made, {"units": "rad"})
    return xr.Dataset(found, {"time": ("time", time, {"units": "s"})})


def test_each_prediction_has_a_row_a_horizon_beside_what_became_of_the_ship(table):
    found = make_predictions(table)
    assert list(found) == list(UNITS)
    assert len(found) == 2 * 61 and set(found["component"]) == {"predictor"}
    late = found[(found["time"] == 80.0) & (found["horizon"] == 30.0)].iloc[0]
    assert (late["true_x"], late["true_y"]) == pytest.approx((55.0, -27.5))
    assert (late["x"], late["error_north"], late["error_east"]) == pytest.approx((58.0, 3.0, 0.0))
    assert late["error_heading"] == pytest.approx(0.1) and late["learned"] == 0.25


def test_what_lies_beyond_the_run_has_no_truth(table):
    found = make_predictions(table)
    beyond = found["time"] + found["horizon"] > 120.0
    assert (
        beyond.any()
        and (found["true_x"].isna() == beyond).all()
        and (found["error_heading"].isna() == beyond).all()
    )


def test_the_share_within_the_regions_is_counted_where_there_are_regions(table):
    near, far = summarise(make_predictions(table))
    assert (near.horizon, near.count, near.position, near.in_position_region) == pytest.approx(
        (10.0, 56, 0.0, 1.0)
    )
    assert (far.horizon, far.count, far.position, far.heading) == pytest.approx(
        (30.0, 46, 3.0, 0.1)
    )
    assert far.in_position_region == pytest.approx(10 / 46)
    assert np.isnan(far.in_heading_region)
    assert texts([far]) == [
        ("predictor, 30 s ahead", "3.00 m rms", "5.7 deg rms", "22 % of places within the regions")
    ]


def test_truth_between_two_rows_is_on_the_straight_line(table):
    sparse = make_predictions(table.isel(time=slice(0, None, 7)))
    assert np.nanmax(np.abs(sparse["error_east"])) < 1e-9
    assert np.nanmax(np.abs(sparse.loc[sparse["horizon"] == 10.0, "error_heading"])) < 1e-9


def test_a_run_without_a_predictor_has_no_predictions(table):
    none = make_predictions(table[["vessel.x", "vessel.y", "vessel.psi"]])
    assert len(none) == 0 and list(none) == list(UNITS) and summarise(none) == []
    assert len(make_predictions(table.drop_vars("vessel.psi"))) == 0


def test_the_file_says_units_and_leaves_unknown_cells_empty(table, tmp_path):
    write_predictions(make_predictions(table), tmp_path / "predictions.csv")
    with open(tmp_path / "predictions.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert (
        rows[0]["time [s]"] == "0.0"
        and rows[0]["component"] == "predictor"
        and rows[0]["true_psi [rad]"]
    )
    assert (
        rows[-1]["true_x [m]"] == ""
        and rows[-1]["in_position_region"] == ""
        and rows[0]["in_heading_region"] == ""
    )


def test_the_scene_draws_places_regions_and_where_she_came_to_be(table, browse, tmp_path):
    write_report(table, tmp_path / "report.html")
    page = browse(tmp_path / "report.html")
    script = "scene.pause(); scene.time = arguments[0]; scene.paint(); return scene.drawn"
    near, far = [item for item in page.ask(script, 41.2) if item["what"] == "predicted"]
    assert (near["seconds"], far["seconds"]) == (10, 30)
    assert (far["north"], far["east"], far["radius"]) == pytest.approx(
        (38.0, -17.5, 2.5), abs=0.02
    )  # made at 40 s
    assert far["true"] == pytest.approx([35.0, -17.5], abs=0.02)
    assert (
        page.ask("return document.getElementById('scene-key').textContent").count("region of 90 %")
        == 1
    )
    assert [item["true"] for item in page.ask(script, 119.0) if item["what"] == "predicted"] == [
        None,
        None,
    ]
