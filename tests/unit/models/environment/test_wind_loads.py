"""Wind: who feels what from where, and the tables of both ships against their sources with their own signs."""

from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads

LONG = parameters(WindParameters)
SHORT = parameters(WindParameters, "gunnerus-28m9", "vessel")
SHIPS = pytest.mark.parametrize("wind", [LONG, SHORT], ids=["long", "short"])


@pytest.mark.parametrize(
    "psi, wind_from, bow_from",
    [(0.0, 0.0, 0.0), (0.0, 90.0, 90.0), (90.0, 0.0, -90.0), (45.0, 90.0, 45.0)],
)
def test_a_ship_at_rest_has_the_true_wind_turned_by_her_heading(psi, wind_from, bow_from):
    north, east = -8.0 * np.cos(radians(wind_from)), -8.0 * np.sin(radians(wind_from))
    speed, apparent = apparent_wind(radians(psi), 0.0, 0.0, north, east)
    assert speed == pytest.approx(8.0) and apparent == pytest.approx(radians(bow_from))


def test_running_before_the_wind_at_its_speed_is_calm():
    assert apparent_wind(0.0, 8.0, 0.0, 8.0, 0.0)[0] == pytest.approx(0.0)


@SHIPS
def test_head_wind_pushes_astern_and_following_wind_ahead_without_side_force(wind):
    head, following = wind_loads(10.0, 0.0, wind=wind), wind_loads(10.0, pi, wind=wind)
    assert head[0] < 0.0 < following[0]
    assert head[1:] == following[1:] == pytest.approx((0.0, 0.0))


@SHIPS
def test_wind_from_starboard_pushes_to_port_and_on_the_bow_turns_to_port(wind):
    _, Y, N = wind_loads(10.0, radians(45.0), wind=wind)
    assert Y < 0.0 and N < 0.0


@SHIPS
def test_wind_from_port_mirrors_wind_from_starboard(wind):
    angle = np.linspace(0.0, pi, 40)
    X, Y, N = wind_loads(7.0, angle, wind=wind)
    np.testing.assert_allclose(wind_loads(7.0, -angle, wind=wind), (X, -Y, -N))


@SHIPS
def test_loads_grow_with_the_square_of_the_speed(wind):
    np.testing.assert_allclose(
        wind_loads(14.0, 0.6, wind=wind), 4.0 * np.array(wind_loads(7.0, 0.6, wind=wind))
    )


def test_long_ship_has_the_table_of_its_source(shared):
    """The source's angle is where the air flows to, 0 to 180 deg to starboard, so it comes from port: 180 deg less."""
    path = shared / "reference/data/gunnerus_33p9_wind_load_coefficients.csv"
    to, *loads = np.genfromtxt(path, delimiter=",", skip_header=2).T
    found = wind_loads(1.0, np.radians(to) - pi, wind=LONG)
    np.testing.assert_allclose(found, loads, rtol=1e-6, atol=1e-6)


def test_short_ship_has_the_coefficients_of_its_source(shared):
    """The source's angle is positive for wind from port. Dimensions as in its head; the table keeps five digits."""
    path = shared / "reference/data/gunnerus_28p9_wind_coefficients.csv"
    angle, CX, CY, CN = np.genfromtxt(path, delimiter=",", skip_header=2).T
    found = wind_loads(1.0, -np.radians(angle), wind=SHORT)
    sizes = 0.5 * 1.23 * np.array([[81.0], [172.0], [172.0 * 31.25]])
    np.testing.assert_allclose(found, sizes * [CX, CY, CN], rtol=5e-5, atol=1e-9)


def test_long_ship_is_blendermanns_research_vessel():
    """Blendermann 1994: CX = -CDl cos(a)/d, CY = CDt sin(a)/d, d = 1 - delta/2 (1 - CDl/CDt) sin^2(2a)."""
    frontal, lateral, CDt, delta, density = 85.0, 210.0, 0.85, 0.6, 1.224
    for degrees in (10.0, 30.0, 60.0, 120.0, 150.0):
        angle, CDlAF = radians(degrees), 0.55 if degrees < 90.0 else 0.65
        CDl = CDlAF * frontal / lateral
        denominator = 1.0 - 0.5 * delta * (1.0 - CDl / CDt) * np.sin(2.0 * angle) ** 2
        X, Y, _ = wind_loads(1.0, angle, wind=LONG)
        assert X == pytest.approx(
            -0.5 * density * frontal * CDlAF * np.cos(angle) / denominator, rel=2e-3
        )
        assert Y == pytest.approx(
            -0.5 * density * lateral * CDt * np.sin(angle) / denominator, rel=2e-3
        )


def test_a_table_that_does_not_go_round_is_refused():
    with pytest.raises(ValueError, match="from 0 to 90"):
        wind_loads(
            1.0, 0.5, wind=replace(parameters(WindParameters), wind_table="0 -1 0 0; 90 0 -1 0")
        )


@SHIPS
def test_a_vane_that_shows_ten_degrees_too_much_has_the_wind_ten_degrees_less(wind):
    """Offset = given minus real, round the stern too."""
    vane = replace(wind, apparent_wind_offset=radians(10.0))
    real = np.radians([-175.0, -60.0, -5.0, 0.0, 5.0, 40.0, 170.0])
    given = (real + radians(10.0) + pi) % (2.0 * pi) - pi
    np.testing.assert_allclose(
        wind_loads(9.0, given, wind=vane), wind_loads(9.0, real, wind=wind), rtol=1e-9, atol=1e-9
    )
    ahead = wind_loads(9.0, 0.0, wind=vane)
    assert ahead[1] > 0.0 and ahead == pytest.approx(wind_loads(9.0, radians(-10.0), wind=wind))


@SHIPS
def test_offsets_as_an_array_are_as_many_vanes(wind):
    offsets = np.array([0.0, 0.3, -0.2])
    each = [
        wind_loads(9.0, 0.5, wind=replace(wind, apparent_wind_offset=float(offset)))
        for offset in offsets
    ]
    together = wind_loads(9.0, 0.5, wind=replace(wind, apparent_wind_offset=offsets))
    np.testing.assert_allclose(together, np.transpose(each), rtol=1e-12)
    assert each[0] == wind_loads(9.0, 0.5, wind=wind)
