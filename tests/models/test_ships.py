"""Parameter sets: complete, explained, and with the tolerances of the nominal model."""

from dataclasses import fields
from math import pi

import pytest

from shipcosim.models.ships import COMPONENTS, SHIPS, parameter_set, parameters


@pytest.mark.parametrize("ship", SHIPS)
def test_every_number_has_unit_description_and_origin(ship):
    for component, values in parameter_set(ship).items():
        for name, quantity in values.items():
            assert quantity.unit and quantity.description and quantity.origin, f"{component}.{name}"
            assert quantity.tolerance >= 0.0


@pytest.mark.parametrize("ship", SHIPS)
def test_every_set_makes_the_parameters_of_the_models_within_their_bounds(ship):
    for component, kinds in COMPONENTS.items():
        for kind in kinds:
            made = parameters(kind, ship, component)
            for field in fields(kind):
                value, low, high = getattr(made, field.name), field.metadata["minimum"], field.metadata["maximum"]
                assert (low is None or value >= low) and (high is None or value <= high), f"{component}.{field.name}"


@pytest.mark.parametrize("ship", ["gunnerus-33m9", "gunnerus-28m9"])
def test_tolerances_are_those_of_the_nominal_model(ship):
    """Shares of the value: mass and inertia 1 %, added mass 3 %, drag 5 %, and so on; positions 0.02 m."""
    sets = parameter_set(ship)
    shares = {
        "vessel": dict(
            mass=0.01, inertia_yaw=0.01, A11=0.03, A22=0.03, A26=0.03, A66=0.03, X_uu=0.05, wind_load_scale=0.03
        ),
        "port": dict(side_force_coefficient=0.1, thrust_scale=0.01, thrust_scale_outside=0.05),
        "tunnel": dict(thrust_coefficient=0.02),
    }
    if ship == "gunnerus-33m9":
        shares["vessel"] |= dict(cross_flow_drag=0.05, lift=0.1)
    for component, expected in shares.items():
        for name, share in expected.items():
            quantity = sets[component][name]
            assert quantity.tolerance == pytest.approx(share * abs(quantity.value), rel=0.03), name
    assert [sets[c][axis].tolerance for c, axis in (("port", "x"), ("starboard", "y"), ("tunnel", "x"))] == [0.02] * 3


def test_a_set_that_changes_a_number_says_its_own_origin():
    short, default = parameter_set("gunnerus-28m9"), parameter_set("gunnerus-33m9")
    for component, values in short.items():
        for name, quantity in values.items():
            changed = quantity.value != default[component][name].value
            assert not changed or quantity.origin != default[component][name].origin, name


@pytest.mark.parametrize(
    "ship, x, y, tunnel_x", [("gunnerus-33m9", -14.02, 2.0, 14.48), ("gunnerus-28m9", -13.22, 2.7, 13.08)]
)
def test_thrusters_are_where_the_nominal_model_has_them(ship, x, y, tunnel_x):
    sets = parameter_set(ship)
    assert [sets[c]["x"].value for c in ("port", "starboard", "tunnel")] == [x, x, tunnel_x]
    assert [sets[c]["y"].value for c in ("port", "starboard")] == [-y, y]


@pytest.mark.parametrize("ship", ["gunnerus-33m9", "thesis"])
def test_limits_are_those_of_the_thesis(ship):
    unit = parameter_set(ship)["port"]
    assert [unit[name].value for name in ("thrust_min", "thrust_max", "thrust_rate")] == [-30e3, 60e3, 1e3]
    assert unit["azimuth_rate"].value == pytest.approx(10.0 / 180.0 * pi)


def test_an_unknown_ship_is_named_with_those_there_are():
    with pytest.raises(ValueError, match="'titanic'.*gunnerus-33m9"):
        parameter_set("titanic")
