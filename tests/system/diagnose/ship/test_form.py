"""The form's functions are what they say, and neutral they change nothing."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose import twin

from shipcosim.diagnose.ship.dynamics import loads, rate_difference
from shipcosim.diagnose.ship.form import (
    FROUDE_UNDER_WAY,
    HullForm,
    ThrusterForm,
    WindForm,
    cross_flow_form,
    thrust_kept,
    wind_factors,
)
from shipcosim.diagnose.ship.inputs import Inputs
from shipcosim.models.core.motion import Motion
from shipcosim.models.ship.hull import HullParameters

MOTION = Motion(
    *np.array([[0.0, 1.0], [0.0, 2.0], [0.3, 2.0], [0.8, -0.4], [0.2, -0.3], [0.02, -0.03]])
)
UNITS = {"port": (1.5, 0.4), "starboard": (1.0, -0.5), "tunnel": (8.0, 0.0)}
INPUTS = Inputs(0.0, UNITS, np.array([8.0, 6.0]), np.array([0.7, -2.0]))
EACH = [f"hull_form.cross_flow_{k}" for k in (1, 2, 3)] + [
    "wind_form.X_mean",
    "wind_form.Y_cos_1",
    "wind_form.N_sin_2",
]
EACH += ["port.form.across", "starboard.form.under_way"]


def strength(hull):
    return 0.5 * hull.water_density * hull.draught * hull.cross_flow_drag


def test_a_ship_that_is_pushed_sideways_is_turned_by_drag_that_is_larger_forward():
    """Closed form: N = -k v² ∫ x (x / l) dx, and no more force."""
    hull = twin.model().parts["hull"]
    X, Y, N = cross_flow_form(0.5, 0.0, hull, HullForm(cross_flow_1=0.3))
    assert (X, pytest.approx(0.0, abs=1e-6)) == (0.0, Y)
    assert pytest.approx(-strength(hull) * 0.3 * 0.25 * hull.length**2 / 6.0, rel=0.01) == N


def test_drag_that_is_larger_at_the_ends_resists_turning_more():
    """Closed form: N = -k l⁴ r² ∫ |s|³ (3 s² - 1) / 2 ds = -k l⁴ r² / 4, s from -1 to 1, times its share."""
    hull = twin.model().parts["hull"]
    _, Y, N = cross_flow_form(0.0, 0.03, hull, HullForm(cross_flow_2=0.3))
    assert (
        pytest.approx(-strength(hull) * 0.3 * (hull.length / 2) ** 4 * 0.03**2 / 4.0, rel=0.02) == N
    )
    assert pytest.approx(0.0, abs=1e-6) == Y


def test_the_wind_s_harmonics_are_those_of_its_angle():
    angles = np.array([0.0, np.pi / 2, np.pi, -np.pi / 2])
    surge, sway, yaw = wind_factors(angles, WindForm(X_mean=0.1, Y_cos_1=0.2, N_sin_1=0.3))
    np.testing.assert_allclose(surge, 1.1)
    np.testing.assert_allclose(sway, [1.2, 1.0, 0.8, 1.0])
    np.testing.assert_allclose(yaw, [1.0, 1.3, 1.0, 0.7])


def test_wind_that_is_stronger_on_all_axes_is_a_scale_of_the_wind():
    ship = twin.model()
    form = {f"wind_form.{axis}_mean": 0.1 for axis in "XYN"}
    one, other = (
        loads(MOTION, INPUTS, ship.with_values(v)) for v in (form, {"vessel.wind_load_scale": 1.1})
    )
    np.testing.assert_allclose(np.stack(one["wind"]), np.stack(other["wind"]))


def test_the_hull_takes_thrust_by_where_a_unit_pushes_to():
    """Astern is where a unit that is turned round pushes to, and one that runs backwards alike."""
    form = ThrusterForm(across=0.1, to_starboard=0.02, astern=0.06)
    rpm, degrees = np.array([1.0, 1.0, 1.0, 1.0, -1.0]), np.array([0.0, 90.0, -90.0, 180.0, 0.0])
    kept = thrust_kept(rpm, np.radians(degrees), np.zeros(5), 30.0, form)
    np.testing.assert_allclose(kept, [1.0, 1.0 - 0.15, 1.0 - 0.11, 1.0 - 0.06, 1.0 - 0.06])
    fast = FROUDE_UNDER_WAY * np.sqrt(9.81 * 30.0)
    assert thrust_kept(1.0, 0.0, fast, 30.0, ThrusterForm(under_way=0.1)) == pytest.approx(0.9)


def test_a_thruster_that_the_hull_takes_from_loads_the_ship_as_much_less():
    ship = twin.model()
    taken = ship.with_values({"port.form.across": 0.2})
    lost = 0.2 * np.sin(UNITS["port"][1]) ** 2
    plain, less = (
        np.stack(np.broadcast_arrays(*loads(MOTION, INPUTS, one)["port"])) for one in (ship, taken)
    )
    np.testing.assert_allclose(less, (1.0 - lost) * plain)


@pytest.mark.parametrize("path", EACH)
def test_what_is_taken_from_another_ship_s_loads_is_only_what_is_the_same(path):
    ship = twin.model().with_values({"hull_form.cross_flow_2": 0.1, "wind_form.Y_mean": 0.1})
    changed = ship.with_values({path: 0.2})
    like = ship, loads(MOTION, INPUTS, ship)
    with_help, alone = loads(MOTION, INPUTS, changed, like), loads(MOTION, INPUTS, changed)
    for name, load in alone.items():
        for one, other in zip(with_help[name], load, strict=True):
            np.testing.assert_array_equal(one, other)
    rates = rate_difference(changed, ship, MOTION, INPUTS, like)
    assert max(np.abs(rate).max() for rate in rates) > 0.0


def test_a_ship_of_the_model_s_form_is_as_uncertain_as_her_tolerances_say():
    ship = twin.model()
    assert ship.uncertainties == ship.tolerances
    wider = replace(ship, form_scale=1.0).uncertainties
    assert all(wider[path] >= size for path, size in ship.tolerances.items())
    assert set(wider) == set(ship.tolerances) | set(ship.form_sizes)
    assert all(ship.has(path) and size > 0.0 for path, size in ship.form_sizes.items())


def test_a_hull_without_cross_flow_has_the_strength_of_her_quadratic_damping():
    needed = {
        "mass": 10.0,
        "inertia_yaw": 1.0,
        "A11": 1.0,
        "A22": 1.0,
        "A26": 0.0,
        "A62": 0.0,
        "A66": 1.0,
    }
    hull = HullParameters(**needed, length=2.0, breadth=0.5, draught=0.2, Y_v=-10.0, Y_modvv=-60.0)
    ship = replace(twin.model(), parts=twin.model().parts | {"hull": hull})
    _, _, N = cross_flow_form(1.0, 0.0, hull, HullForm(cross_flow_1=0.3))
    assert pytest.approx(-30.0 * 0.3 * 2.0**2 / 6.0, rel=0.01) == N
    assert ship.form_sizes["vessel.Y_v"] > 0.12 * 10.0
