"""Unit conversion against numbers from outside: BIPM SI brochure (9th ed.) and definitions of the nautical units."""

import math

import pytest

from shipcosim.ssp.xml.units import Unit, conversion, relation, spelled


@pytest.mark.parametrize(
    ("source", "target", "value", "expected"),
    [
        ("nmi", "m", 1.0, 1852.0),
        ("kn", "km/h", 1.0, 1.852),
        ("rpm", "rad/s", 60.0, 2 * math.pi),
        ("deg/s", "rad/s", 180.0, math.pi),
        ("degC", "K", 0.0, 273.15),
        ("K", "degC", 0.0, -273.15),
        ("bar", "Pa", 1.0, 1e5),
        ("kW", "N.m/s", 1.0, 1e3),
        ("t", "kg", 1.0, 1e3),
        ("kg.m2/s2", "J", 5.0, 5.0),
        ("N.s/m", "kg/s", 3.0, 3.0),
        ("kN", "N", 1.0, 1e3),
        ("s-1", "Hz", 2.0, 2.0),
        ("m/s^2", "m/s2", 2.0, 2.0),
        ("J/(kg.K)", "m2/(s2.K)", 4.0, 4.0),
        ("%", "1", 50.0, 0.5),
        ("1/min", "Hz", 60.0, 1.0),
    ],
)
def test_a_quantity_keeps_its_size_in_another_unit(source, target, value, expected):
    factor, offset = conversion(spelled(source), spelled(target))
    assert factor * value + offset == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("source", "target", "expected"),
    [
        ("m", "m", "same"),
        ("m", "km", "convertible"),
        ("rad/s", "1/s", "angle"),
        ("m", "s", "incompatible"),
        ("N.m", "N", "incompatible"),
    ],
)
def test_units_relate_by_their_dimensions(source, target, expected):
    assert relation(spelled(source), spelled(target)) == expected


@pytest.mark.parametrize("name", ["", "parsnip", "m//s", "m/s.kg", "N/(m/s)", "(m", "degC/s", "xm", "m^", "µm", "."])
def test_what_makes_no_sense_is_no_unit(name):
    assert spelled(name) is None


def test_undefined_units_are_equal_by_name_alone():
    assert relation(Unit("parsnip"), Unit("parsnip")) == "same"
    assert relation(Unit("parsnip"), Unit("m", (0, 1, 0, 0, 0, 0, 0, 0))) == "unknown"
