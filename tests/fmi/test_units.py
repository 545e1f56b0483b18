import pint
import pytest

from shipcosim.fmi.units import BASE, base_unit

REGISTRY = pint.UnitRegistry()
SAME_IN_PINT = {
    "1": "dimensionless",
    "m": "m",
    "kg.m2": "kg*m**2",
    "N": "N",
    "kN": "kN",
    "N.m": "N*m",
    "N.s2/m2": "N*s**2/m**2",
    "N.m.s2/rad2": "N*m*s**2/rad**2",
    "rad/s": "rad/s",
    "deg": "deg",
    "deg/s": "deg/s",
    "rpm": "rpm",
    "kn": "knot",
    "nmi": "nautical_mile",
    "W/(m2.K)": "W/m**2/K",
    "MW": "MW",
    "h": "hour",
    "1/min": "1/min",
    "t": "tonne",
    "mol.cd.V": "mol*cd*V",
    "Hz": "1/s",
    "bar": "bar",
    "%": "percent",
    "s-1": "s**-1",
}


@pytest.mark.parametrize("unit, same", SAME_IN_PINT.items())
def test_factor_and_exponents_agree_with_pint(unit, same):
    exponents, factor, offset = base_unit(unit)
    expected = REGISTRY.Quantity(1.0, same).to_base_units()
    assert factor == pytest.approx(expected.magnitude, rel=1e-12) and offset == 0.0
    product = 1.0 * REGISTRY.dimensionless
    for name, power in exponents.items():
        product = product * REGISTRY.Quantity(1.0, name) ** power
    assert product.dimensionality == expected.dimensionality


def test_angles_keep_their_radian_which_dimensions_do_not_show():
    assert base_unit("deg").exponents == base_unit("rad").exponents == {"rad": 1}
    assert base_unit("rpm").exponents == {"s": -1, "rad": 1}
    assert base_unit("1").exponents == {}


def test_celsius_has_the_offset_of_kelvin():
    assert base_unit("degC") == ({"K": 1}, 1.0, 273.15)


def test_exponents_come_in_the_order_of_fmi():
    assert list(base_unit("N.m/rad").exponents) == [name for name in BASE if name in ("kg", "m", "s", "rad")]


@pytest.mark.parametrize("unit", ["", "N*m", "furlong", "N/m/s", "N.m/s.K", "m2.5", "kdeg", " m"])
def test_what_cannot_be_read_is_refused_by_name(unit):
    with pytest.raises(ValueError, match="unit"):
        base_unit(unit)


def test_fractional_exponents_are_refused_with_a_way_out():
    with pytest.raises(ValueError, match="square"):
        base_unit("m/s1.5")
