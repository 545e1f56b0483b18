"""Connections, units and transformations come out as plain factors, and what is wrong is refused."""

import math

import pytest


def pair(shop, source="Real m", target="Real m", inside="", **attributes):
    """Two components, one connection between them."""
    shop.fmu("one", f"output y {source}")
    shop.fmu("two", f"input u {target}")
    elements = shop.component("a", "one", "output y") + shop.component("b", "two", "input u")
    shop.ssd(elements, shop.connection("a.y", "b.u", inside, **attributes))


def test_a_connection_goes_from_output_to_input(shop):
    pair(shop)
    (connection,) = shop.read().connections
    assert (connection.source, connection.target) == (("a", "y"), ("b", "u"))
    assert (connection.factor, connection.offset, connection.mapping) == (1.0, 0.0, None)


def test_start_and_end_of_a_connection_do_not_decide_its_direction(shop):
    shop.fmu("one", "output y Real m")
    shop.fmu("two", "input u Real m")
    elements = shop.component("a", "one", "output y") + shop.component("b", "two", "input u")
    shop.ssd(elements, shop.connection("b.u", "a.y"))
    assert shop.read().connections[0].source == ("a", "y")


@pytest.mark.parametrize(
    ("source", "target", "factor", "offset"),
    [
        ("deg", "rad", math.pi / 180, 0.0),
        ("kn", "m/s", 1852 / 3600, 0.0),
        ("degC", "K", 1.0, 273.15),
        ("K", "degC", 1.0, -273.15),
        ("km", "m", 1000.0, 0.0),
    ],
)
def test_units_are_converted(shop, source, target, factor, offset):
    pair(shop, f"Real {source}", f"Real {target}")
    (connection,) = shop.read().connections
    assert connection.factor == pytest.approx(factor, rel=1e-15)
    assert connection.offset == pytest.approx(offset, rel=1e-15)
