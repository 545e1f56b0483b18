"""Hull loads against integrals by strips, symmetry, the source's polynomial written out, and energy."""

import json
from dataclasses import replace

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.core.motion import Motion
from shipcosim.models.ship import hull as models
from shipcosim.models.ship.hull import HullParameters, hull_loads
from shipcosim.models.ship.vessel import accelerations, step

LONG = parameters(HullParameters)
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
    [
        (1.0, 0.0),
        (1.0, 0.02),
        (0.1, 0.08),
        (-0.3, 0.05),
        (0.2, -0.06),
        (0.0, 0.1),
        (0.5, 0.5 / 16.95),
        (0.0, 0.0),
    ],
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


def test_linear_derivatives_astern_are_those_of_the_hull_mirrored_fore_and_aft():
    hull = replace(LONG, added_mass_coriolis=0.0, lift=0.0, X_uu=0.0, cross_flow_drag=0.0)
    hull = replace(hull, Y_uv=-3e4, Y_ur=3e5, N_uv=-3e5, N_ur=-2e6)
    u, v, r = ANY_VELOCITY
    X, Y, N = hull_loads(u, v, r, hull=hull)
    np.testing.assert_allclose(hull_loads(-u, v, -r, hull=hull), (-X, Y, -N), rtol=1e-12)


def test_short_hull_adrift_astern_loses_energy():
    """In still water without thrust, as she had gained it: 1.42-fold in a minute with Yuv u v and Nur u r."""
    start = Motion(0.0, 0.0, 0.0, -0.3, 0.2, 0.0)
    none = 0.0, 0.0, 0.0, 0.0, 0.0
    energies = []
    for _ in range(61):
        nu = np.array(start[3:])
        energies.append(0.5 * nu @ mass_matrix(SHORT) @ nu)
        start = step(start, *none, 1.0, hull=SHORT)
    assert np.all(np.diff(energies) < 0.0)


def test_short_hull_is_the_source_polynomial_which_holds_the_added_mass(shared):
    """Parameter sheet 2.1 with Xuu as u abs(u): C_A in it, so counted once. Astern Yuv and Nur damp as ahead."""
    source = json.loads((shared / "reference/data/gunnerus_28p9_simval_hull.json").read_text())
    u, v, r = ANY_VELOCITY
    found = hull_loads(u, v, r, hull=SHORT)
    names = dict(source["coefficients_SI"], u=u, v=v, r=r, Xuu=0.0, Xuuu=0.0)
    names |= {name: np.sign(u) * names[name] for name in ("Yuv", "Nur")}
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


def test_mass_scale_is_a_ship_of_that_mass_and_inertia_in_the_same_water():
    """Heavier by 15 % with her added mass: the same accelerations as of a hull whose numbers say so, turning too."""
    scaled = replace(LONG, mass_scale=1.15, centre_of_gravity_x=0.7)
    heavy = replace(LONG, mass=1.15 * 531e3, inertia_yaw=1.15 * 43.0e6, centre_of_gravity_x=0.7)
    motion = (*ANY_VELOCITY, 2e4, -1e4, 3e5)
    np.testing.assert_allclose(
        accelerations(*motion, hull=scaled), accelerations(*motion, hull=heavy), rtol=1e-12
    )
    at_rest = accelerations(0.0, 0.0, 0.0, 1e4, 0.0, 0.0, hull=replace(LONG, mass_scale=1.15))
    assert at_rest == pytest.approx((1e4 / (1.15 * 531e3 + 26_550.0), 0.0, 0.0))


def test_linear_damping_fades_with_speed_and_not_with_turning():
    hull = replace(LONG, X_u=-9e3, Y_v=-2e4, Y_r=1e4, N_v=-1e4, N_r=-3e6)
    fading = replace(hull, linear_damping_speed=1.2)
    u, v, r = ANY_VELOCITY
    whole = np.array(models.linear_damping(u, v, r, hull=hull))
    faded = np.array(models.linear_damping(u, v, r, hull=fading))
    np.testing.assert_allclose(faded, whole * np.exp(-(u**2 + v**2) / 1.2**2), rtol=1e-12)
    spot = models.linear_damping(0.0, 0.0, 0.1, hull=fading)
    assert spot == models.linear_damping(0.0, 0.0, 0.1, hull=hull)


def test_drag_scale_multiplies_the_resistance_ahead_and_nothing_else():
    hull = replace(LONG, X_u=-400.0, Y_v=-300.0)
    u, v, r = ANY_VELOCITY
    X, Y, N = hull_loads(u, v, r, hull=replace(hull, drag_scale=2.5))
    X_once, Y_once, N_once = hull_loads(u, v, r, hull=hull)
    np.testing.assert_allclose(
        X - X_once, 1.5 * (-400.0 * u - 1645.0 * u * np.abs(u)), rtol=1e-9, atol=1e-6
    )
    assert np.array_equal(Y, Y_once) and np.array_equal(N, N_once)


def test_cross_flow_scale_multiplies_the_strips_and_nothing_else():
    u, v, r = ANY_VELOCITY
    found = np.subtract(
        hull_loads(u, v, r, hull=replace(LONG, cross_flow_scale=1.4)),
        hull_loads(u, v, r, hull=LONG),
    )
    np.testing.assert_allclose(
        found, 0.4 * np.array(models.cross_flow(u, v, r, hull=LONG)), rtol=1e-6, atol=1e-3
    )


def test_cross_flow_scale_of_a_hull_without_strips_is_on_damping_in_sway_and_yaw():
    u, v, r = ANY_VELOCITY
    hull = replace(SHORT, Y_v=-500.0, Y_r=100.0, N_v=200.0, N_r=-3e4, X_u=-50.0, N_modrr=-1e6)
    found = np.subtract(
        hull_loads(u, v, r, hull=replace(hull, cross_flow_scale=1.4)),
        hull_loads(u, v, r, hull=hull),
    )
    Y = -500.0 * v + 100.0 * r + hull.Y_modvv * v * np.abs(v)
    N = 200.0 * v - 3e4 * r - 1e6 * r * np.abs(r)
    np.testing.assert_allclose(found, (0.0 * u, 0.4 * Y, 0.4 * N), rtol=1e-6, atol=1e-2)


def test_growing_drag_is_the_quadratic_one_at_froude_number_a_quarter_and_a_higher_power_of_speed():
    growing = replace(LONG, drag_growth=1.0)
    middle = 0.25 * np.sqrt(9.81 * LONG.length)
    drag = [
        -models.quadratic_damping(u, 0.0, 0.0, hull=growing)[0]
        for u in (middle, 2.0 * middle, -2.0 * middle)
    ]
    assert drag[0] == pytest.approx(-LONG.X_uu * middle**2, rel=1e-3)
    assert drag[1] == pytest.approx(8.0 * drag[0], rel=1e-3) and drag[2] == -drag[1]
    assert models.quadratic_damping(0.0, 0.0, 0.0, hull=growing)[0] == 0.0


@pytest.mark.parametrize("hull", [LONG, SHORT], ids=["long", "short"])
@pytest.mark.parametrize("name", ["mass_scale", "drag_scale", "cross_flow_scale"])
def test_scales_as_an_array_are_as_many_hulls(name, hull):
    scales = np.array([1.0, 1.3, 0.6])
    motion = (2.0, -0.4, 0.05, 1e4, 2e3, -3e4)
    each = [accelerations(*motion, hull=replace(hull, **{name: float(scale)})) for scale in scales]
    together = accelerations(*motion, hull=replace(hull, **{name: scales}))
    np.testing.assert_allclose(np.broadcast_arrays(*together), np.transpose(each), rtol=1e-12)
    np.testing.assert_array_equal(each[0], accelerations(*motion, hull=hull))


TANKER = parameters(HullParameters, "kvlcc2", "vessel")
SIZE = 0.5 * 1000.0 * 7.0 * 0.455


@pytest.mark.parametrize("state", [(1.179, 0.0, 0.0), (0.9, -0.25, 0.05), (0.5, 0.2, -0.06)])
def test_mmg_hull_is_the_published_sum_with_its_munk_moment_once(state):
    """Derivatives, resistance of another tank, and what MMG writes on the other side, m_y v r and -m_x u r."""
    u, v, r = state
    U = np.hypot(u, v)
    a, b = v / U, 7.0 * r / U
    X = -0.01545 - 0.040 * a**2 + 0.002 * a * b + 0.011 * b**2 + 0.771 * a**4
    Y = -0.315 * a + 0.083 * b - 1.607 * a**3 + 0.379 * a * a * b - 0.391 * a * b * b + 0.008 * b**3
    N = -0.137 * a - 0.049 * b - 0.030 * a**3 - 0.294 * a * a * b + 0.055 * a * b * b - 0.013 * b**3
    expected = SIZE * U**2 * np.array([X, Y, 7.0 * N]) + np.array(
        [2486.0 * v * r, -245.0 * u * r, 0.0]
    )
    assert hull_loads(u, v, r, hull=TANKER) == pytest.approx(expected, rel=2e-3, abs=0.05)


def test_mmg_loads_vanish_at_rest_and_stay_finite_where_she_turns_on_the_spot():
    assert models.mmg(0.0, 0.0, 0.0, hull=TANKER) == (0.0, 0.0, 0.0)
    slow, fast = (models.mmg(0.0, 0.0, r, hull=TANKER)[2] for r in (0.1, 0.2))
    assert slow < 0.0 and fast == pytest.approx(4.0 * slow)


def test_cross_flow_scale_multiplies_mmgs_third_order_alone():
    scaled = replace(TANKER, cross_flow_scale=2.0)
    first = replace(
        TANKER,
        **{f"mmg_{n}": 0.0 for n in "Y_vvv Y_vvr Y_vrr Y_rrr N_vvv N_vvr N_vrr N_rrr".split()},
    )
    state = (0.9, -0.25, 0.05)
    one, two, linear = (np.array(models.mmg(*state, hull=hull)) for hull in (TANKER, scaled, first))
    np.testing.assert_allclose(two - linear, [0.0, *(2.0 * (one - linear)[1:])], atol=1e-9)
