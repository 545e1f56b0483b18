"""Hull loads against integrals by strips, symmetry, the source's polynomial written out, and energy."""

import json
from dataclasses import replace

import numpy as np
import pytest

from shipcosim.models import hull as models
from shipcosim.models.hull import HullParameters, hull_loads
from shipcosim.models.ships import parameters

LONG = HullParameters()
SHORT = parameters(HullParameters, "gunnerus-28m9", "vessel")
RANDOM = np.random.default_rng(1)
ANY_VELOCITY = RANDOM.uniform(-1.0, 1.0, (3, 5000)) * [[8.0], [3.0], [0.3]]


def mass_matrix(hull):
    static = hull.mass * hull.centre_of_gravity_x
    return np.array(
        [
            [hull.mass + hull.A11, 0.0, 0.0],
            [0.0, hull.mass + hull.A22, static + hull.A26],
            [0.0, static + hull.A62, hull.inertia_yaw + hull.A66],
        ]
    )


@pytest.mark.parametrize(
    "v, r",
    [(1.0, 0.0), (1.0, 0.02), (0.1, 0.08), (-0.3, 0.05), (0.2, -0.06), (0.0, 0.1), (0.5, 0.5 / 16.95), (0.0, 0.0)],
)
def test_cross_flow_is_the_sum_over_strips(v, r):
    x = (np.arange(100_000) + 0.5) / 100_000 * 33.9 - 16.95
    strips = -0.5 * 1025.0 * 1.5 * 2.786 * np.abs(v + x * r) * (v + x * r) * (33.9 / len(x))
    _, Y, N = models.cross_flow(0.0, v, r, hull=LONG)
    assert Y == pytest.approx(np.sum(strips), rel=1e-8, abs=1e-6)
    assert N == pytest.approx(np.sum(x * strips), rel=1e-8, abs=1e-6)


@pytest.mark.parametrize("name", models.CONTRIBUTIONS)
@pytest.mark.parametrize("hull", [LONG, SHORT], ids=["long", "short"])
def test_port_mirrors_starboard(name, hull):
    load, _ = models.CONTRIBUTIONS[name]
    u, v, r = ANY_VELOCITY
    X, Y, N = load(u, v, r, hull=hull)
    np.testing.assert_allclose(load(u, -v, -r, hull=hull), (X, -Y, -N), rtol=1e-12)


def test_added_mass_does_no_work():
    u, v, r = ANY_VELOCITY
    X, Y, N = models.added_mass_coriolis(u, v, r, hull=LONG)
    np.testing.assert_allclose(X * u + Y * v + N * r, 0.0, atol=1e-6 * np.max(np.abs(N * r)))


def test_the_water_never_gives_the_long_hull_energy():
    u, v, r = ANY_VELOCITY
    X, Y, N = hull_loads(u, v, r, hull=LONG)
    assert np.max(X * u + Y * v + N * r) <= 0.0


def test_short_hull_is_the_source_polynomial_which_holds_the_added_mass(shared):
    """Parameter sheet 2.1 with Xuu as u abs(u): C_A in it, so counted once."""
    source = json.loads((shared / "reference/data/gunnerus_28p9_simval_hull.json").read_text())
    u, v, r = ANY_VELOCITY
    found = hull_loads(u, v, r, hull=SHORT)
    names = dict(source["coefficients_SI"], u=u, v=v, r=r, Xuu=0.0, Xuuu=0.0)
    drag = (-2100.0 * u * np.abs(u), 0.0, 0.0)
    for axis, extra, load in zip("XYN", drag, found, strict=True):
        formula = source[axis].replace("^", "**")
        for letter in "uvr":
            formula = formula.replace(f"|{letter}|", f"abs({letter})")
        np.testing.assert_allclose(load, eval(formula, {}, names) + extra, rtol=1e-9, atol=1e-3)


def test_only_what_a_hull_has_coefficients_for_is_computed():
    assert LONG.contributions == ("added_mass_coriolis", "quadratic_damping", "cross_flow", "lift")
    assert SHORT.contributions == ("added_mass_coriolis", "quadratic_damping", "polynomial")
    assert replace(LONG, N_r=np.zeros(2)).contributions[1] == "linear_damping"


def test_inverse_mass_is_the_inverse():
    hull = replace(LONG, centre_of_gravity_x=0.5, A62=-6e5)
    i11, i22, i26, i62, i66 = hull.inverse_mass
    inverse = [[i11, 0.0, 0.0], [0.0, i22, i26], [0.0, i62, i66]]
    np.testing.assert_allclose(mass_matrix(hull) @ inverse, np.eye(3), atol=1e-12)
