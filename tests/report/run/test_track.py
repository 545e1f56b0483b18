"""The ship on the chart."""

import json

import numpy as np
import pytest
import xarray as xr

from shipcosim.report.run.roles import find_roles
from shipcosim.report.run.track import hull_outline, outline_rows, placed, ship_size, track_figure


def area(east, north):
    """Of a closed outline, positive if it runs clockwise seen from above with north up."""
    return -0.5 * np.sum(east[:-1] * north[1:] - east[1:] * north[:-1])


def test_bow_points_where_she_heads():
    bow = int(np.argmax(hull_outline(33.9, 9.6)[0]))
    east, north = placed(hull_outline(33.9, 9.6), 100.0, 50.0, 90.0)
    assert (east[bow], north[bow]) == pytest.approx((50.0 + 16.95, 100.0))


def test_starboard_is_right_of_the_heading():
    forward, starboard = hull_outline(30.0, 8.0)
    corner = int(np.argmax(starboard))
    east, north = placed((forward, starboard), 0.0, 0.0, 0.0)
    assert east[corner] == pytest.approx(4.0) and north[corner] == pytest.approx(forward[corner])


def test_outline_keeps_its_size_whatever_the_heading():
    areas = [area(*placed(hull_outline(33.9, 9.6), 7.0, -3.0, psi)) for psi in (0.0, 33.0, 180.0, 271.0)]
    assert areas == pytest.approx([areas[0]] * 4)


def test_ship_that_lies_still_is_outlined_at_start_and_end_only():
    still = np.zeros(500)
    assert outline_rows(still, still, still, 33.9) == [0, 499]


def test_turn_on_the_spot_is_outlined_every_twenty_degrees():
    still = np.zeros(91)
    assert outline_rows(still, still, np.arange(91.0), 33.9) == [0, 20, 40, 60, 80, 90]


def test_long_way_is_outlined_at_even_distances_and_not_too_often():
    way = np.linspace(0.0, 50_000.0, 5_001)
    rows = outline_rows(way, 0.0 * way, 0.0 * way, 33.9)
    assert len(rows) <= 41
    assert len(set(np.diff(rows[:-1]))) == 1


def chart_of(start_values):
    """The chart of a ship that sails 100 m north; with these start values in the table's attributes."""
    way = np.linspace(0.0, 100.0, 101)
    signals = {"vessel.x": (way, "m"), "vessel.y": (0.0 * way, "m"), "vessel.psi": (0.0 * way, "rad")}
    table = xr.Dataset({k: ("time", v, {"units": unit}) for k, (v, unit) in signals.items()}, {"time": way})
    table.attrs["start_values"] = json.dumps(start_values)
    roles = find_roles(table.data_vars)
    return track_figure(table, roles, (), ship_size(table, roles))


def test_ship_is_drawn_to_scale_where_the_table_says_how_large_she_is():
    chart = chart_of({"vessel.length": 40.0, "vessel.breadth": 10.0})
    assert np.ptp(chart.outline[0]) == 40.0 and np.ptp(chart.outline[1]) == 10.0
    assert "ship on the way" in [trace["name"] for trace in chart.traces]


@pytest.mark.parametrize("start_values", [{}, {"vessel.length": 40.0}])
def test_ship_of_unknown_size_is_a_small_symbol_that_says_so(start_values):
    chart = chart_of(start_values)
    assert np.ptp(chart.outline[0]) == pytest.approx(8.0)
    assert "ship on the way, not to scale" in [trace["name"] for trace in chart.traces]
