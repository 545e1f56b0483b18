"""The missing force as it is drawn."""

import numpy as np
import pytest
import xarray as xr

from shipcosim.diagnose.validation.missing_force import MissingForce, by_sector
from shipcosim.report.diagnosis.force_figures import force_figures


def by_title(figures):
    return {figure.title: figure for figure in figures}


def test_missing_force_against_the_wind_is_its_mean_in_sectors():
    n = 360
    wind = np.arange(n, dtype=float)
    force = {
        name: ("time", np.zeros(n), {"units": "N"}) for name in ("surge", "sway", "north", "east")
    }
    force["surge"] = ("time", 1000.0 * np.cos(np.radians(wind)), {"units": "N"})
    force |= {
        "yaw": ("time", np.zeros(n), {"units": "N.m"}),
        "heading": ("time", wind),
        "wind_from": ("time", wind),
    }
    force = xr.Dataset(force, {"time": wind})
    panels = by_title(
        force_figures(MissingForce(force, None, {"wind_from": by_sector(force, "wind_from")}, ()))
    )
    surge = panels["Missing force against the wind"].traces[0]
    assert len(surge["x"]) == 24 and surge["x"][0] == 7.5
    assert surge["y"] == pytest.approx(np.cos(np.radians(surge["x"])), abs=0.01)
    assert panels["Missing force, body frame"].traces[0]["y"][0] == pytest.approx(1.0)  # kN
