"""The outline of a ship, and where on her way it is drawn."""

import numpy as np
import pytest

from shipcosim.report.run.track import hull_outline, outline_rows, placed, symbol_size


def test_outline_is_as_long_and_as_wide_as_the_ship_and_points_forward():
    forward, starboard = hull_outline(33.9, 9.6)
    assert np.ptp(forward) == pytest.approx(33.9) and np.ptp(starboard) == pytest.approx(9.6)
    assert starboard[np.argmax(forward)] == 0.0
    assert (forward[0], starboard[0]) == (forward[-1], starboard[-1])


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
    areas = [
        area(*placed(hull_outline(33.9, 9.6), 7.0, -3.0, psi)) for psi in (0.0, 33.0, 180.0, 271.0)
    ]
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


def test_symbol_of_a_ship_of_unknown_size_is_small_beside_her_track():
    way = np.linspace(0.0, 100.0, 101)
    length, breadth = symbol_size(way, 0.0 * way)
    assert length == pytest.approx(8.0) and 0.0 < breadth < 0.5 * length
