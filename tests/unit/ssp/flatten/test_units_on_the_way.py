"""Units and linear transformations on any way through a system, against conversions through SI written here."""

import zipfile

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as some

# value in SI = factor * value + offset; the definitions of the FMUs in conftest.
QUANTITIES = [
    {"m": (1.0, 0.0), "km": (1000.0, 0.0)},
    {"m/s": (1.0, 0.0), "kn": (0.5144444444444445, 0.0)},
    {"rad": (1.0, 0.0), "deg": (0.017453292519943295, 0.0)},
    {"K": (1.0, 0.0), "degC": (1.0, 273.15)},
]
SEVERAL = settings(
    max_examples=60,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
LINEAR = some.one_of(some.none(), some.tuples(some.sampled_from([-2.0, 0.5]), some.floats(-9, 9)))
WAY = some.sampled_from(QUANTITIES).flatmap(
    lambda units: some.tuples(
        some.just(units), some.lists(some.sampled_from(sorted(units)), min_size=5, max_size=5)
    )
)


def converted(value, source, target, units):
    factor, offset = units[source]
    wanted, shift = units[target]
    return (factor * value + offset - shift) / wanted


def over(value, linear):
    return value if linear is None else linear[0] * value + linear[1]


def xml(linear):
    return (
        ""
        if linear is None
        else f'<ssc:LinearTransformation factor="{linear[0]!r}" offset="{linear[1]!r}"/>'
    )


def typed(unit):
    return f'<ssc:Real unit="{unit}"/>'


SSD_UNITS = """<ssd:Units><ssc:Unit name="m"><ssc:BaseUnit m="1"/></ssc:Unit>
<ssc:Unit name="m/s"><ssc:BaseUnit m="1" s="-1"/></ssc:Unit>
<ssc:Unit name="kn"><ssc:BaseUnit m="1" s="-1" factor="0.5144444444444445"/></ssc:Unit>
<ssc:Unit name="rad"><ssc:BaseUnit rad="1"/></ssc:Unit>
<ssc:Unit name="deg"><ssc:BaseUnit rad="1" factor="0.017453292519943295"/></ssc:Unit>
<ssc:Unit name="K"><ssc:BaseUnit K="1"/></ssc:Unit>
<ssc:Unit name="degC"><ssc:BaseUnit K="1" offset="273.15"/></ssc:Unit>
<ssc:Unit name="km"><ssc:BaseUnit m="1" factor="1000"/></ssc:Unit></ssd:Units>"""


@SEVERAL
@given(way=WAY, first=LINEAR, second=LINEAR, value=some.floats(-50, 50))
def test_from_output_to_input_through_a_nested_system(shop, way, first, second, value):
    units, (a, b, c, d, e) = way
    shop.fmu("source", f"output y Real {a}")
    shop.fmu("target", f"input u Real {e}")
    inner = shop.component("t", "target", f"input u {typed(d)}")
    nested = (
        f'<ssd:System name="s"><ssd:Connectors><ssd:Connector name="w" kind="input">{typed(c)}</ssd:Connector>'
        f"</ssd:Connectors><ssd:Elements>{inner}</ssd:Elements>"
        f"<ssd:Connections>{shop.connection('w', 't.u', xml(second))}</ssd:Connections></ssd:System>"
    )
    elements = shop.component("x", "source", f"output y {typed(b)}") + nested
    shop.ssd(elements, shop.connection("x.y", "s.w", xml(first)), rest=SSD_UNITS)
    (connection,) = shop.read().connections
    begun = converted(value, a, b, units)
    at_system = over(converted(begun, b, c, units), first)
    at_target = over(converted(at_system, c, d, units), second)
    expected = converted(at_target, d, e, units)
    found = connection.factor * value + connection.offset
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-6)


@SEVERAL
@given(way=WAY, linear=LINEAR, mapped=LINEAR, value=some.floats(-50, 50))
def test_from_a_parameter_set_through_a_mapping_and_a_parameter_of_the_system(
    shop, way, linear, mapped, value
):
    units, (a, b, _, d, e) = way
    shop.fmu("target", f"parameter p Real {e}")
    parts = shop.component("t", "target", f"parameter p {typed(d)}")
    entry = f'<ssm:MappingEntry source="given" target="q">{xml(mapped)}</ssm:MappingEntry>'
    shop.ssv(
        f'<ssv:Parameter name="given"><ssv:Real value="{value!r}" unit="{a}"/></ssv:Parameter>'
    )
    shop.ssm(entry)
    head = (
        f'<ssd:Connectors><ssd:Connector name="q" kind="parameter">{typed(b)}</ssd:Connector></ssd:Connectors>'
        '<ssd:ParameterBindings><ssd:ParameterBinding source="resources/numbers.ssv">'
        '<ssd:ParameterMapping source="resources/names.ssm"/></ssd:ParameterBinding></ssd:ParameterBindings>'
    )
    shop.ssd(parts, shop.connection("q", "t.p", xml(linear)), head=head, rest=SSD_UNITS)
    at_system = over(converted(value, a, b, units), mapped)
    at_target = over(converted(at_system, b, d, units), linear)
    expected = converted(at_target, d, e, units)
    assert shop.read().components["t"].start["p"] == pytest.approx(expected, rel=1e-9, abs=1e-6)


def units(*definitions):
    inner = "".join(
        f'<ssc:Unit name="{name}"><ssc:BaseUnit {base}/></ssc:Unit>' for name, base in definitions
    )
    return f"<ssd:Units>{inner}</ssd:Units>"


@pytest.mark.parametrize(
    "scale", ['factor="0"', 'factor="-0.0"', 'factor="NaN"', 'factor="1e999"', 'offset="INF"']
)
@pytest.mark.parametrize("place", ["SSD", "FMU"])
def test_a_unit_that_nothing_converts_to_is_refused(shop, scale, place):
    given = 'm="1" ' + scale
    shop.fmu("one", "input u Real m")
    if place == "FMU":
        _with_unit(
            shop.folder / "resources" / "one.fmu", '<BaseUnit m="1"/>', f"<BaseUnit {given}/>"
        )
    shop.ssd(
        shop.component("one", "one", "input u"),
        rest=units(("m", given)) if place == "SSD" else "",
    )
    assert "The unit 'm' has the factor" in shop.refused()


def _with_unit(path, old, new):
    """Replace a text in the description of an FMU."""
    with zipfile.ZipFile(path) as archive:
        text = archive.read("modelDescription.xml").decode()
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", text.replace(old, new, 1))


@SEVERAL
@given(
    some.tuples(*[some.sampled_from(["", ' factor="2"', ' offset="3"', ' factor="2.0"'])] * 2),
    some.sampled_from(["furlong", "m", "K"]),
)
def test_two_definitions_of_a_unit_in_one_file_must_agree(shop, scales, name):
    first, second = ('m="1"' + scale for scale in scales)
    shop.fmu("one", "input u Real m")
    shop.ssd(shop.component("one", "one", "input u"), rest=units((name, first), (name, second)))
    if first.replace("2.0", "2") == second.replace("2.0", "2"):
        shop.read()
    else:
        assert f"The unit '{name}' is defined twice" in shop.refused()


def test_a_connector_and_its_variable_in_two_units_of_one_name_are_told_apart(shop):
    shop.fmu("one", "input u Real m")
    component = shop.component("one", "one", f"input u {typed('m')}")
    shop.ssd(component, rest=units(("m", 'm="1" factor="1000"')))
    remarks = [problem.found for problem in shop.read().remarks]
    assert any("in m (1000 m), the variable in one.fmu in m (1 m)" in found for found in remarks)
