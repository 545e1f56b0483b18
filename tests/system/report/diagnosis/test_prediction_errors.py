"""Errors of predictions as they are drawn and listed."""

import numpy as np
import xarray as xr

from shipcosim.diagnose.validation.summary import PredictionErrors, condition_errors
from shipcosim.report.diagnosis.prediction_errors import error_table


def errors_of():
    shape = ("model", "horizon", "segment")
    position = np.arange(24.0).reshape(2, 3, 4)
    columns = {
        name: (shape, position) for name in ("position", "heading", "surge", "sway", "yaw_rate")
    }
    regime = ("segment", ["holding", "moving", "moving", "turning"])
    return xr.Dataset(
        columns, {"model": ["plain", "floor"], "horizon": [10.0, 30.0, 60.0], "regime": regime}
    )


def test_errors_are_root_mean_squares_by_horizon_and_by_what_the_ship_did():
    each = errors_of()
    overall, moving = (
        condition_errors("all", each),
        condition_errors("moving", each.isel(segment=[1, 2])),
    )
    errors = PredictionErrors(each, overall, (moving,), (), False, None, 0.0, 0.0)
    table = error_table(errors)
    assert [row[1] for row in table.rows[:3]] == ["10 s", "30 s", "60 s"]
    assert table.rows[0][3].split(" / ")[0] == f"{np.sqrt(np.mean([0, 1, 4, 9])):.2g}"
    moving = dict(
        zip(table.head, next(row for row in table.rows if row[0] == "moving"), strict=True)
    )
    assert moving["Segments"] == "2" and moving["Position [m]"] == "9.5 / 22"  # of 9, 10 and 21, 22
