"""Units against numbers from outside: pint, the BIPM SI brochure (9th ed.), definitions of the nautical units."""

import math
import re
import subprocess
import sys

import pint
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcosim.units import (
    BASE_UNITS,
    SYMBOLS,
    Unit,
    UnitError,
    amount,
    conversion,
    fmi_unit,
    number_in,
    relation,
    spelled_conversion,
    spelled_unit,
)

PARTS = st.sampled_from(
    "m s deg kn C dB % ° µ ² 9 1e9 0 ** ^ * / . ( ) - + , = @ ' [ ]".split() + [" "]
)


@given(st.lists(PARTS, min_size=1, max_size=8).map("".join))
@settings(max_examples=200, deadline=None)
def test_a_text_is_a_unit_or_is_refused_as_one(text):
    """pint, which is asked in the end, raises anything."""
    for convert in (
        lambda: spelled_unit(text),
        lambda: spelled_conversion(text, "m"),
        lambda: number_in(f"5 {text}", fmi_unit("m")),
    ):
        try:
            convert()
        except UnitError:
            pass


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
    "hPa": "hPa",
    "dm": "decimeter",
    "%": "percent",
    "s-1": "s**-1",
}


@pytest.mark.parametrize("unit, same", SAME_IN_PINT.items())
def test_factor_and_exponents_agree_with_pint(unit, same):
    ours = fmi_unit(unit)
    expected = REGISTRY.Quantity(1.0, same).to_base_units()
    assert ours.factor == pytest.approx(expected.magnitude, rel=1e-12) and ours.offset == 0.0
    product = 1.0 * REGISTRY.dimensionless
    for name, power in ours.powers.items():
        product = product * REGISTRY.Quantity(1.0, name) ** power
    assert product.dimensionality == expected.dimensionality


def test_angles_keep_their_radian_which_dimensions_do_not_show():
    assert fmi_unit("deg").powers == fmi_unit("rad").powers == {"rad": 1}
    assert fmi_unit("rpm").powers == {"s": -1, "rad": 1}
    assert fmi_unit("1").powers == {}


def test_celsius_has_the_offset_of_kelvin():
    assert fmi_unit("degC") == Unit("degC", fmi_unit("K").exponents, 1.0, 273.15)
    assert fmi_unit("degC").base_unit_attributes == {"K": "1", "offset": "273.15"}


def test_exponents_come_in_the_order_of_fmi():
    assert list(fmi_unit("N.m/rad").powers) == [
        name for name in BASE_UNITS if name in ("kg", "m", "s", "rad")
    ]


@pytest.mark.parametrize(
    "unit", ["", "N*m", "furlong", "N/m/s", "N.m/s.K", "m2.5", "m^2", "kdeg", " m", "degC/s"]
)
def test_what_fmi_does_not_write_is_refused_by_name(unit):
    with pytest.raises(ValueError, match="unit"):
        fmi_unit(unit)


def test_fractional_exponents_are_refused_with_a_way_out():
    with pytest.raises(ValueError, match="square"):
        fmi_unit("m/s1.5")


@pytest.mark.parametrize(
    ("source", "target", "value", "expected"),
    [
        ("nmi", "m", 1.0, 1852.0),
        ("kn", "km/h", 1.0, 1.852),
        ("rpm", "rad/s", 60.0, 2 * math.pi),
        ("rev", "deg", 1.0, 360.0),
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
    factor, offset = conversion(spelled_unit(source), spelled_unit(target))
    assert factor * value + offset == pytest.approx(expected, rel=1e-14)
    assert spelled_conversion(source, target) == (factor, offset)


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
    assert relation(spelled_unit(source), spelled_unit(target)) == expected


@pytest.mark.parametrize(
    "name", ["", "parsnip", "m//s", "m/s.kg", "N/(m/s)", "(m", "degC/s", "xm", "m^", "µm", "."]
)
def test_what_makes_no_sense_is_no_unit(name):
    assert spelled_unit(name) is None


def test_undefined_units_are_equal_by_name_alone():
    assert relation(Unit("parsnip"), Unit("parsnip")) == "same"
    assert relation(Unit("parsnip"), spelled_unit("m")) == "unknown"


PINT_CALLS_IT = {"-": "dimensionless", "1": "dimensionless", "rev": "revolution", "Ohm": "ohm"}


@pytest.mark.parametrize("source", SYMBOLS)
def test_every_two_symbols_convert_as_in_pint(source):
    for target in SYMBOLS:
        units = [REGISTRY.Unit(PINT_CALLS_IT.get(name, name)) for name in (source, target)]
        try:
            offset, one = (
                float(REGISTRY.Quantity(value, units[0]).to(units[1]).magnitude)
                for value in (0.0, 1.0)
            )
        except pint.DimensionalityError:
            with pytest.raises(UnitError, match="different things"):
                spelled_conversion(source, target)
        else:
            assert spelled_conversion(source, target) == pytest.approx(
                (one - offset, offset), rel=1e-15
            )


def test_what_the_table_does_not_hold_is_left_to_pint():
    assert spelled_conversion("ft", "m") == (pytest.approx(0.3048, rel=1e-15), 0.0)
    assert spelled_conversion("degF", "K") == (pytest.approx(5 / 9), pytest.approx(459.67 * 5 / 9))


@pytest.mark.parametrize(
    ("spelling", "said"), [("furlonk", "not known"), ("__import__('os')", "no unit")]
)
def test_what_nobody_knows_is_refused(spelling, said):
    with pytest.raises(UnitError, match=said):
        spelled_conversion(spelling, "m")


def test_units_of_the_table_are_converted_without_importing_pint():
    code = "import sys; from shipcosim.series import conversion; conversion('kn', 'm/s'); print('pint' in sys.modules)"
    assert (
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout
        == "False\n"
    )


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("45 deg", "rad", math.pi / 4),
        ("45°", "rad", math.pi / 4),
        ("-90deg", "rad", -math.pi / 2),
        ("10 kn", "m/s", 10 * 1852 / 3600),
        ("1.5e2 kN", "N", 150e3),
        (" .5 t ", "kg", 500.0),
        ("20 degC", "K", 293.15),
        ("68 degF", "degC", 20.0),
        ("100 ft", "m", 30.48),
        ("10 lbf", "N", 44.4822161526),
        ("50 %", "1", 0.5),
        ("2 1/s", "Hz", 2.0),
        ("10 min", "s", 600.0),
    ],
)
def test_an_amount_is_the_number_that_its_unit_says(text, unit, expected):
    assert number_in(text, spelled_unit(unit)) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    "text", ["45", "kaimal", "", "deg", "4,5 m", "1_0 m", "nan m", "inf m", "1e5", "--1 m"]
)
def test_other_texts_are_no_amounts(text):
    assert amount(text) is None


@pytest.mark.parametrize(
    ("text", "unit", "said"),
    [
        (
            "45 deg",
            "m",
            "'45 deg' is in deg, where m is wanted: they measure different things. Write a number in m",
        ),
        ("10 %", "rad", "in %, where rad is wanted"),
        ("3 rad", "1", "in rad, where 1 is wanted"),
        ("5 rpm", "1/s", "in rpm, where 1/s is wanted"),
        ("3 parsnip", "m", "the unit 'parsnip' is not known"),
        ("3 __import__('os')", "m", "is not known"),
        ("kaimal", "m/s", "is no number with a unit. Write a number in m/s"),
    ],
)
def test_an_amount_of_another_kind_is_refused(text, unit, said):
    with pytest.raises(UnitError, match=re.escape(said)):
        number_in(text, spelled_unit(unit))


def test_what_has_no_unit_takes_no_amount():
    with pytest.raises(UnitError, match="no unit is wanted.*Write a number"):
        number_in("3 m", None)


def test_an_angle_is_taken_where_a_file_defines_it_without_the_radian():
    assert number_in("180 deg", Unit("rad", (0,) * 8)) == pytest.approx(math.pi)
    assert number_in("180 deg", Unit("deg", (0,) * 8, math.pi / 180)) == pytest.approx(180.0)
    with pytest.raises(UnitError):
        number_in("180 deg", Unit("ratio", (0,) * 8))


def test_a_difference_has_no_offset():
    assert number_in("1 degC", spelled_unit("K"), difference=True) == 1.0
