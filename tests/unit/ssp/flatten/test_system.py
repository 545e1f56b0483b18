"""Connections, units and transformations come out as plain factors and tables, and what is wrong is refused."""

import math
import pickle
import zipfile

import pytest

from shipcosim.errors import ShipcosimError
from shipcosim.ssp import check_system, pack, read_system, with_values

MODES = """
<SimpleType name="Mode"><Enumeration><Item name="off" value="1"/><Item name="on" value="2"/></Enumeration></SimpleType>
<SimpleType name="State"><Enumeration><Item name="dead" value="7"/><Item name="alive" value="8"/></Enumeration>
</SimpleType>
"""


def pair(shop, source="Real m", target="Real m", inside="", types="", **attributes):
    """Two components, one connection between them."""
    shop.fmu("one", f"output y {source}", types=types)
    shop.fmu("two", f"input u {target}", types=types)
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


def test_two_outputs_connected_are_refused(shop):
    shop.fmu("one", "output y Real m")
    shop.ssd(
        shop.component("a", "one", "output y") + shop.component("b", "one", "output y"),
        shop.connection("a.y", "b.y"),
    )
    assert (
        "a.y (output) and b.y (output): both give a value, and neither takes one." in shop.refused()
    )


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


def test_incompatible_units_are_refused_with_both_names(shop):
    pair(shop, "Real m/s", "Real deg")
    message = shop.refused()
    assert "line 10: a.y -> b.u: a.y is in m/s, b.u in deg; these cannot be converted." in message


def test_suppressed_unit_conversion_leaves_the_value(shop):
    pair(shop, "Real kn", "Real m/s", suppressUnitConversion="true")
    assert shop.read().connections[0].factor == 1.0


def test_a_linear_transformation_comes_after_the_conversion_of_units(shop):
    pair(shop, "Real km", "Real m", '<ssc:LinearTransformation factor="2" offset="5"/>')
    (connection,) = shop.read().connections
    assert (connection.factor, connection.offset) == (2000.0, 5.0)  # 2 * (1000 x) + 5


def test_a_linear_transformation_replaces_a_suppressed_conversion(shop):
    inside = '<ssc:LinearTransformation factor="-1"/>'
    pair(shop, "Real km", "Real m", inside, suppressUnitConversion="true")
    assert shop.read().connections[0].factor == -1.0


def test_a_linear_transformation_of_booleans_is_refused(shop):
    pair(shop, "Boolean", "Boolean", '<ssc:LinearTransformation factor="2"/>')
    assert "A linear transformation of Boolean values." in shop.refused()


def test_a_unit_that_is_defined_nowhere_is_a_remark_and_not_converted(shop):
    pair(shop, "Real parsnip", "Real m")
    system = shop.read()
    assert system.connections[0].factor == 1.0
    assert any("parsnip" in remark.found for remark in system.remarks)


def test_an_integer_feeds_a_real_and_not_the_other_way_round(shop):
    pair(shop, "Integer", "Real m")
    assert shop.read().connections[0].factor == 1.0


@pytest.mark.parametrize(
    ("source", "target"), [("Real m", "Integer"), ("Boolean", "Real m"), ("String", "Integer")]
)
def test_types_that_do_not_fit_are_refused(shop, source, target):
    pair(shop, source, target)
    kinds = source.split()[0], target.split()[0]
    assert f"a.y is {kinds[0]}, b.u is {kinds[1]}." in shop.refused()


def test_a_boolean_mapping_becomes_a_table(shop):
    entries = (
        '<ssc:MapEntry source="true" target="false"/><ssc:MapEntry source="false" target="true"/>'
    )
    inside = f"<ssc:BooleanMappingTransformation>{entries}</ssc:BooleanMappingTransformation>"
    pair(shop, "Boolean", "Boolean", inside)
    assert shop.read().connections[0].mapping == {True: False, False: True}


def test_an_integer_mapping_leaves_other_values_alone(shop):
    inside = '<ssc:IntegerMappingTransformation><ssc:MapEntry source="1" target="5"/></ssc:IntegerMappingTransformation>'
    pair(shop, "Integer", "Integer", inside)
    assert shop.read().connections[0].mapping == {1: 5}


ENUMERATION_MAPPING = (
    '<ssc:EnumerationMappingTransformation><ssc:MapEntry source="off" target="dead"/>'
    '<ssc:MapEntry source="on" target="{}"/></ssc:EnumerationMappingTransformation>'
)


def test_an_enumeration_mapping_by_names_becomes_one_by_numbers(shop):
    inside = ENUMERATION_MAPPING.format("alive")
    pair(
        shop, "Enumeration declaredType=Mode", "Enumeration declaredType=State", inside, types=MODES
    )
    assert shop.read().connections[0].mapping == {1: 7, 2: 8}


def test_an_enumeration_mapping_to_an_unknown_item_is_refused(shop):
    inside = ENUMERATION_MAPPING.format("alvie")
    pair(
        shop, "Enumeration declaredType=Mode", "Enumeration declaredType=State", inside, types=MODES
    )
    assert "no item 'alvie'. It has: alive, dead. Did you mean 'alive'?" in shop.refused()


def test_different_enumerations_without_a_mapping_are_refused(shop):
    pair(shop, "Enumeration declaredType=Mode", "Enumeration declaredType=State", types=MODES)
    assert "Values 1, 2 of the source's enumeration do not exist in the target's." in shop.refused()


def test_a_connection_to_a_name_that_does_not_exist_says_what_there_is(shop):
    shop.fmu("allocation", "output thrust_cmd_bow Real m")
    shop.fmu("thruster", "input thrust_cmd Real m")
    elements = shop.component("allocation", "allocation", "output thrust_cmd_bow")
    elements += shop.component("thruster_bow", "thruster", "input thrust_cmd")
    shop.ssd(elements, shop.connection("allocation.thrust_cmd_bow", "thruster_bow.thrust_comand"))
    assert shop.refused() == (
        f"{shop.path}, line 10: allocation.thrust_cmd_bow -> thruster_bow.thrust_comand: "
        "thruster_bow has no input 'thrust_comand'. It has: thrust_cmd. Did you mean 'thrust_cmd'?"
    )


def test_a_connection_to_an_element_that_does_not_exist_says_what_there_is(shop):
    pair(shop)
    shop.path.write_text(shop.path.read_text().replace('endElement="b"', 'endElement="bb"'))
    assert "There is no element 'bb' in test. There is: a, b." in shop.refused()


def test_a_second_connection_into_an_input_names_the_first(shop):
    shop.fmu("one", "output y Real m", "output z Real m")
    shop.fmu("two", "input u Real m")
    elements = shop.component("a", "one", "output y", "output z") + shop.component(
        "b", "two", "input u"
    )
    shop.ssd(elements, shop.connection("a.y", "b.u") + shop.connection("a.z", "b.u"))
    message = shop.refused()
    assert "line 11: a.z -> b.u: A second connection into b.u." in message
    assert "line 10: a.y -> b.u" in message


def test_everything_wrong_is_reported_at_once(shop):
    shop.fmu("one", "output y Real m")
    elements = shop.component("a", "one", "output y", "output nothing") + shop.component(
        "b", "missing", "input u"
    )
    shop.ssd(elements, shop.connection("a.y", "c.u"))
    message = shop.refused()
    for part in (
        "no output 'nothing'",
        "'resources/missing.fmu' does not exist",
        "There is no element 'c'",
    ):
        assert part in message


def test_a_connector_whose_kind_or_type_is_not_the_fmus_is_refused(shop):
    shop.fmu("one", "output y Real m")
    shop.ssd(shop.component("a", "one", "input y <ssc:Integer/>"))
    message = shop.refused()
    assert "The connector is of kind input, the variable in one.fmu of causality output." in message
    assert "The connector is of type Integer, but in one.fmu the variable is Real." in message


def test_a_connectors_unit_counts_between_connectors_and_the_fmus_at_the_fmu(shop):
    """The SSD calls a variable in rad one in deg: what arrives in deg must be converted for the FMU, with a remark."""
    shop.fmu("one", "output y Real deg")
    shop.fmu("two", "input u Real rad")
    elements = shop.component("a", "one", "output y") + shop.component(
        "b", "two", 'input u <ssc:Real unit="deg"/>'
    )
    shop.ssd(elements, shop.connection("a.y", "b.u"))
    system = shop.read()
    assert system.connections[0].factor == pytest.approx(math.pi / 180)
    assert any(
        "The connector is in deg, the variable in two.fmu in rad" in remark.found
        for remark in system.remarks
    )


def test_all_unconnected_inputs_are_one_remark_with_their_places(shop):
    shop.fmu("two", "input u Real m", "input w Real m")
    shop.fmu("one", "input v Real m")
    elements = (
        shop.component(name, fmu) for name, fmu in (("a", "two"), ("b", "two"), ("c", "one"))
    )
    shop.ssd("".join(elements))
    (remark,) = [one for one in check_system(shop.folder) if "inputs" in one.found]
    assert remark.severity == "remark"
    assert remark.found == "Unconnected inputs keep their start values. a, b: u, w; c: v."


BOUND = '<ssd:ParameterBindings><ssd:ParameterBinding source="resources/numbers.ssv"/></ssd:ParameterBindings>'


def test_inputs_that_are_meant_to_be_open_are_not_remarked_on(shop, real):
    path = shop.fmu("two", "input u Real m", "input w Real m", "input failed Boolean")
    mark = '<Annotations><Tool name="shipcosim"><Quantity optional="true"/></Tool></Annotations>'
    with zipfile.ZipFile(path) as archive:
        text = archive.read("modelDescription.xml").decode()
    head, tail = text.split('name="failed"')
    text = f'{head}name="failed"{tail.replace("</ScalarVariable>", f"{mark}</ScalarVariable>", 1)}'
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", text)
    shop.ssv(real("a.w", 1.0))
    elements = "".join(shop.component(name, "two") for name in "ab")
    shop.ssd(elements, head=BOUND)
    (remark,) = [one for one in check_system(shop.folder) if "inputs" in one.found]
    assert remark.found == "Unconnected inputs keep their start values. a: u; b: u, w."


@pytest.mark.parametrize("n_values", (1, 2, 40))
def test_values_for_an_element_that_does_not_exist_are_one_remark(shop, real, n_values):
    shop.fmu("one", "parameter k Real")
    shop.ssv("".join(real(f"crane.k{number}", 1.0) for number in range(n_values)))
    shop.ssd(shop.component("a", "one"), head=BOUND)
    (remark,) = [one for one in check_system(shop.folder) if "element" in one.found]
    assert remark.severity == "remark" and "crane.k0" in remark.where
    assert "There is no element 'crane'" in remark.found
    assert n_values == 1 or f"its {n_values} values are not used" in remark.found


def test_values_for_a_component_without_its_fmu_say_nothing_beside_its_error(shop, real):
    shop.ssv("".join(real(f"a.{name}", 1.0) for name in "klm"))
    shop.ssd(shop.component("a", "lost"), head=BOUND)
    problems = check_system(shop.folder)
    assert [one.severity for one in problems] == ["error"]
    assert "lost.fmu' does not exist" in problems[0].found


def test_a_connector_that_is_only_in_the_fmu_is_a_remark(shop):
    shop.fmu("one", "output y Real m")
    shop.fmu("two", "input u Real m")
    shop.ssd(
        shop.component("a", "one") + shop.component("b", "two", "input u"),
        shop.connection("a.y", "b.u"),
    )
    system = shop.read()
    assert len(system.connections) == 1
    assert any("a.y is not declared as a connector" in remark.found for remark in system.remarks)


def nested(shop, inner_unit="", fmu_unit="m", transformation="", suppress="false"):
    """Source a on the outside, b two systems deep; connectors on the way."""
    shop.fmu("one", "output y Real km")
    shop.fmu("two", f"input u Real {fmu_unit}", "output v Real m")
    typed = f'<ssc:Real unit="{inner_unit}"/>' if inner_unit else ""
    connectors = (
        f'<ssd:Connectors><ssd:Connector name="in" kind="input">{typed}</ssd:Connector>'
        '<ssd:Connector name="out" kind="output"/></ssd:Connectors>'
    )
    through = shop.connection("in", "core.in", transformation) + shop.connection("core.out", "out")
    core = shop.component("b", "two", "input u", "output v")
    core = (
        f'<ssd:System name="core">{connectors}<ssd:Elements>{core}</ssd:Elements><ssd:Connections>'
        + shop.connection("in", "b.u", suppressUnitConversion=suppress)
        + shop.connection("b.v", "out")
        + "</ssd:Connections></ssd:System>"
    )
    shell = (
        f'<ssd:System name="shell">{connectors}<ssd:Elements>{core}</ssd:Elements>'
        f"<ssd:Connections>{through}</ssd:Connections></ssd:System>"
    )
    outer = '<ssd:Connectors><ssd:Connector name="result" kind="output"/></ssd:Connectors>'
    elements = shop.component("a", "one", "output y") + shell
    shop.ssd(
        elements,
        shop.connection("a.y", "shell.in") + shop.connection("shell.out", "result"),
        head=outer,
    )


def test_two_levels_of_systems_become_one_connection(shop):
    nested(shop)
    system = shop.read()
    assert list(system.components) == ["a", "shell.core.b"]
    ways = {
        (connection.source, connection.target): connection.factor
        for connection in system.connections
    }
    assert ways == {
        (("a", "y"), ("shell.core.b", "u")): 1000.0,
        (("shell.core.b", "v"), (None, "result")): 1.0,
    }
    assert system.outputs["result"].unit == "m"


def test_units_and_transformations_on_the_way_through_systems_combine(shop):
    """km at the source; metres at the shell; 3 x + 1 in metres at the core; the FMU counts in km again."""
    nested(
        shop,
        inner_unit="m",
        fmu_unit="km",
        transformation='<ssc:LinearTransformation factor="3" offset="1"/>',
    )
    units = '<ssd:Units><ssc:Unit name="m"><ssc:BaseUnit m="1"/></ssc:Unit></ssd:Units>'
    end = "</ssd:SystemStructureDescription>"
    shop.path.write_text(shop.path.read_text().replace(end, units + end))
    connection = next(c for c in shop.read().connections if c.target[1] == "u")
    assert connection.factor * 2.0 + connection.offset == pytest.approx((3 * 2000.0 + 1) / 1000.0)


def test_there_and_back_through_units_changes_no_digit(shop):
    nested(shop, inner_unit="nmi", fmu_unit="km")
    connection = next(c for c in shop.read().connections if c.target[1] == "u")
    assert connection.factor == 1.0


def test_connections_in_a_circle_without_a_component_are_refused(shop):
    shop.fmu("two", "input u Real m")
    connectors = '<ssd:Connector name="in" kind="input"/><ssd:Connector name="out" kind="output"/>'
    through = f"<ssd:Connections>{shop.connection('in', 'out')}</ssd:Connections>"
    loop = f'<ssd:System name="loop"><ssd:Connectors>{connectors}</ssd:Connectors>{through}</ssd:System>'
    ways = shop.connection("loop.out", "loop.in") + shop.connection("loop.out", "b.u")
    shop.ssd(shop.component("b", "two", "input u") + loop, ways)
    assert "The connections go in a circle without a component." in shop.refused()


def test_a_missing_connector_of_a_nested_system_is_refused(shop):
    nested(shop)
    shop.path.write_text(
        shop.path.read_text().replace(
            'endElement="shell" endConnector="in"', 'endElement="shell" endConnector="inn"'
        )
    )
    assert (
        "a.y -> shell.inn: shell has no input 'inn'. It has: in. Did you mean 'in'?"
        in shop.refused()
    )


def test_inputs_of_the_system_feed_components_and_start_as_these_do(shop):
    shop.fmu("two", "input u Real m start=1500")
    head = '<ssd:Connectors><ssd:Connector name="way" kind="input"><ssc:Real unit="km"/></ssd:Connector></ssd:Connectors>'
    shop.ssd(shop.component("b", "two", "input u"), shop.connection("way", "b.u"), head=head)
    system = shop.read()
    (connection,) = system.connections
    assert (connection.source, connection.factor) == ((None, "way"), 1000.0)
    assert (system.inputs["way"].unit, system.inputs["way"].start) == ("km", 1.5)
    assert with_values(system, {"way": 2.0}).inputs["way"].start == 2.0
    with pytest.raises(ShipcosimError, match="way: 'far' is no Real"):
        with_values(system, {"way": "far"})


def test_calculated_parameters_go_to_parameters_once(shop):
    shop.fmu("one", "calculatedParameter c Real km", "output y Real m")
    shop.fmu("two", "parameter p Real m")
    elements = shop.component("a", "one", "calculatedParameter c", "output y") + shop.component(
        "b", "two", "parameter p"
    )
    shop.ssd(elements, shop.connection("a.c", "b.p"))
    (connection,) = shop.read().connections
    assert connection.initial and connection.factor == 1000.0

    shop.ssd(elements, shop.connection("a.y", "b.p"))
    assert "a.y (output) cannot feed b.p (parameter)." in shop.refused()


def test_signals_of_a_dictionary_reach_all_who_read_them(shop):
    shop.fmu("one", "output y Real deg")
    shop.fmu("two", "input u Real rad")
    dictionaries = (
        '<ssd:SignalDictionaries><ssd:SignalDictionary name="bus"><ssb:SignalDictionary version="1.0">'
        '<ssb:DictionaryEntry name="heading"><ssc:Real unit="rad"/></ssb:DictionaryEntry><ssb:Units>'
        '<ssc:Unit name="rad"><ssc:BaseUnit rad="1"/></ssc:Unit></ssb:Units>'
        "</ssb:SignalDictionary></ssd:SignalDictionary></ssd:SignalDictionaries>"
    )

    def reference(name):
        return (
            f'<ssd:SignalDictionaryReference name="{name}" dictionary="bus"><ssd:Connectors>'
            '<ssd:Connector name="heading" kind="inout"/></ssd:Connectors></ssd:SignalDictionaryReference>'
        )

    parts = shop.component("b", "two", "input u") + reference("port")
    inner = (
        f'<ssd:System name="inner"><ssd:Elements>{parts}</ssd:Elements>'
        f"<ssd:Connections>{shop.connection('port.heading', 'b.u')}</ssd:Connections></ssd:System>"
    )
    elements = shop.component("a", "one", "output y") + reference("gate") + inner
    shop.ssd(elements, shop.connection("a.y", "gate.heading"), tail=dictionaries)
    (connection,) = shop.read().connections
    assert (connection.source, connection.target) == (("a", "y"), ("inner.b", "u"))
    assert connection.factor == pytest.approx(math.pi / 180)

    shop.path.write_text(
        shop.path.read_text().replace(
            'name="port" dictionary="bus"', 'name="port" dictionary="buss"'
        )
    )
    assert (
        "There is no signal dictionary 'buss' here or in a system around. There is: bus."
        in shop.refused()
    )


def test_a_system_in_another_file_counts_as_if_it_stood_here(shop, tmp_path):
    shop.fmu("two", "input u Real m")
    head = '<ssd:Connectors><ssd:Connector name="in" kind="input"/></ssd:Connectors>'
    shop.ssd(shop.component("b", "two", "input u"), shop.connection("in", "b.u"), head=head)
    text = shop.path.read_text().replace("resources/two.fmu", "two.fmu")
    (shop.folder / "resources/inner.ssd").write_text(text)
    shop.fmu("one", "output y Real km")
    component = '<ssd:Component name="part" type="application/x-ssp-definition" source="resources/inner.ssd"/>'
    shop.ssd(shop.component("a", "one", "output y") + component, shop.connection("a.y", "part.in"))
    (connection,) = shop.read().connections
    assert (connection.target, connection.factor) == (("part.b", "u"), 1000.0)


@pytest.mark.parametrize("source", ["SystemStructure.ssd", "#inner"])
def test_a_system_that_contains_itself_is_refused(shop, source):
    part = f'<ssd:Component name="part" type="application/x-ssp-definition" source="{source}"/>'
    shop.ssd(
        f'<ssd:System name="inner" id="inner"><ssd:Elements>{part}</ssd:Elements></ssd:System>'
    )
    assert f"'{source}' contains itself." in shop.refused()


def test_a_system_of_this_file_is_instantiated_again_by_its_id(shop):
    shop.fmu("two", "input u Real m")
    inner = f'<ssd:System name="one" id="pattern"><ssd:Elements>{shop.component("b", "two")}</ssd:Elements></ssd:System>'
    shop.ssd(
        inner
        + '<ssd:Component name="other" type="application/x-ssp-definition" source="#pattern"/>'
    )
    assert list(shop.read().components) == ["one.b", "other.b"]


def test_a_packed_system_within_a_system_takes_the_bindings_of_its_component(shop, tmp_path, real):
    shop.fmu("two", "parameter p Real m")
    shop.ssd(shop.component("b", "two"))
    pack(shop.folder, (), tmp_path / "inner.ssp")
    (tmp_path / "inner.ssp").rename(shop.folder / "resources/inner.ssp")
    shop.ssv(real("b.p", "4"))
    source = 'type="application/x-ssp-package" source="resources/inner.ssp"'
    shop.ssd(f'<ssd:Component name="part" {source}>{BOUND}</ssd:Component>')
    system = shop.read()
    assert system.components["part.b"].start == {"p": 4.0}
    path = system.components["part.b"].fmu.path
    assert path.is_file()
    del system
    assert not path.exists()  # what was unpacked goes with the system


def test_the_form_of_an_fmu_that_is_asked_for_must_be_there(shop):
    shop.fmu("one", "output y Real m")
    shop.ssd(
        shop.component("a", "one").replace("source=", 'implementation="ModelExchange" source=')
    )
    assert "one.fmu offers no ModelExchange. It offers CoSimulation." in shop.refused()


def test_a_path_relative_to_the_working_folder_is_shown_as_given(shop, monkeypatch):
    pair(shop)
    shop.ssv('<ssv:Parameter name="oops"/>')
    text = shop.path.read_text().replace("<ssd:Elements>", BOUND + "<ssd:Elements>")
    shop.path.write_text(text)
    monkeypatch.chdir(shop.folder.parent)
    with pytest.raises(ShipcosimError) as caught:
        read_system(shop.folder.name)
    assert str(caught.value).startswith("system/resources/numbers.ssv, line 5: Element 'Parameter'")


def test_a_system_travels_to_another_process(shop, tmp_path):
    pair(shop)
    pack(shop.folder, (), tmp_path / "x.ssp")
    system = read_system(tmp_path / "x.ssp")
    copy = pickle.loads(pickle.dumps(system))
    assert copy.connections == system.connections
    del copy
    assert system.components["a"].fmu.path.is_file()


def test_blanks_and_dots_in_names_are_names(shop):
    shop.fmu("one", "output y.a[1] Real m")
    shop.fmu("two", "input u Real m")
    elements = shop.component("my a.b", "one", "output y.a[1]") + shop.component(
        "b", "two", "input u"
    )
    elements = elements.replace("resources/two.fmu", "resources/t%20wo.fmu")
    (shop.folder / "resources/two.fmu").rename(shop.folder / "resources/t wo.fmu")
    connection = '<ssd:Connection startElement="my a.b" startConnector="y.a[1]" endElement="b" endConnector="u"/>'
    shop.ssd(elements, connection)
    system = shop.read()
    assert system.connections[0].source == ("my a.b", "y.a[1]")
    assert system.split("my a.b.y.a[1]") == ("my a.b", "y.a[1]")


def test_prefixes_do_not_matter(shop):
    pair(shop, "Real km", "Real m", '<ssc:LinearTransformation factor="2"/>')
    text = shop.path.read_text()
    default = text.replace("xmlns:ssd=", "xmlns=").replace("<ssd:", "<").replace("</ssd:", "</")
    other = (
        default.replace("xmlns:ssc=", "xmlns:q=").replace("<ssc:", "<q:").replace("</ssc:", "</q:")
    )
    shop.path.write_text(other)
    assert "ssd:" not in other and "ssc:" not in other
    assert shop.read().connections[0].factor == 2000.0


def test_experiment_and_step_sizes_come_from_annotations(shop):
    shop.fmu("one", "output y Real m")
    hint = (
        '<ssd:Annotations><ssc:Annotation type="com.opensimulationplatform">'
        '<osp:StepSizeHint xmlns:osp="urn:osp" value="0.1"/></ssc:Annotation></ssd:Annotations>'
    )
    rest = (
        '<ssd:DefaultExperiment startTime="1" stopTime="20"><ssd:Annotations>'
        '<ssc:Annotation type="com.opensimulationplatform">'
        '<osp:Algorithm xmlns:osp="urn:osp"><osp:FixedStepAlgorithm baseStepSize="0.05"/></osp:Algorithm>'
        "</ssc:Annotation></ssd:Annotations></ssd:DefaultExperiment>"
    )
    shop.ssd(shop.component("a", "one", "output y", more=hint), rest=rest)
    system = shop.read()
    experiment = system.experiment
    assert (experiment.start_time, experiment.stop_time, experiment.step_size) == (1.0, 20.0, 0.05)
    assert system.components["a"].step_size == 0.1

    shop.path.write_text(
        shop.path.read_text().replace('baseStepSize="0.05"', 'baseStepSize="-0.05"')
    )
    assert "FixedStepAlgorithm: baseStepSize is -0.05. It must be positive." in shop.refused()


def test_fmus_are_found_in_the_folders_given(shop, tmp_path):
    pair(shop)
    store = tmp_path / "store"
    store.mkdir()
    for name in ("one", "two"):
        (shop.folder / f"resources/{name}.fmu").rename(store / f"{name}.fmu")
    assert shop.read(fmus=[store]).components["a"].fmu.path.parent == store
    message = shop.refused()
    assert "line 8: a: The file 'resources/one.fmu' does not exist." in message


def test_a_ssd_file_and_its_folder_read_alike(shop):
    pair(shop)
    assert (
        read_system(shop.path).connections[0].factor
        == read_system(shop.folder).connections[0].factor
    )


def test_values_given_for_a_run_are_checked(shop):
    shop.fmu(
        "two",
        "input u Real m",
        "parameter n Integer",
        "parameter p Real m min=0 max=5",
        "output v Real m",
    )
    shop.ssd(shop.component("b", "two"))
    system = with_values(shop.read(), {"b.p": 2, "b.n": 3})
    assert (system.components["b"].start["p"], system.components["b"].start["n"]) == (2.0, 3)
    with pytest.raises(ShipcosimError) as caught:
        with_values(
            system,
            {"b.p": 7.0, "b.n": 1.5, "b.q": 1, "c.p": 1, "b.v": 1.0, "b.u": math.nan},
            "four.toml",
        )
    assert str(caught.value).splitlines() == [
        "four.toml: b.p: p cannot be 7 m. Allowed: 0 to 5 m.",
        "four.toml: b.n: 1.5 is no Integer. Give a whole number.",
        "four.toml: b.q: b has no variable 'q'. It has: n, p, u, v.",
        "four.toml: c.p: There is no component or connector 'c'. There is: b.",
        "four.toml: b.v: It is of causality output, a value that the FMU calculates. Set parameters and inputs.",
        "four.toml: b.u: nan is not a finite number. Give a number, with a decimal point, in m.",
    ]


def test_an_item_that_stands_for_two_values_is_refused(shop):
    pair(
        shop,
        *("Enumeration declaredType=Mode", "Enumeration declaredType=Mode"),
        types=MODES.replace('"on"', '"off"'),
    )
    assert "The item 'off' is defined twice: 1 and 2." in shop.refused()


@pytest.mark.parametrize(
    ("items", "found"),
    [
        ('<ssc:Item name="off" value="2"/>', "The item 'off' is defined twice: 1 and 2."),
        (
            '</ssc:Enumeration><ssc:Enumeration name="E"><ssc:Item name="on" value="2"/>',
            "The enumeration 'E' is defined twice",
        ),
    ],
)
def test_an_enumeration_of_a_structure_that_is_ambiguous_is_refused(shop, items, found):
    shop.fmu("one", "output y Real m")
    head = f'<ssd:Enumerations><ssc:Enumeration name="E"><ssc:Item name="off" value="1"/>{items}'
    shop.ssd(
        shop.component("a", "one", "output y"),
        rest=f"{head}</ssc:Enumeration></ssd:Enumerations>",
    )
    assert found in shop.refused()


def test_values_of_one_component_do_not_look_at_the_others(shop, monkeypatch):
    shop.fmu("one", "output y Real m", "input u Real m")
    shop.ssd(shop.component("a", "one", "output y") + shop.component("b", "one", "output y"))
    system = shop.read()
    looked_at = []
    monkeypatch.setattr(
        "shipcosim.ssp.flatten.with_values.alias_remarks",
        lambda components, connections: looked_at.extend(components) or [],
    )
    assert with_values(system, {"a.u": 2.0}).components["a"].start == {"u": 2.0}
    assert set(looked_at) == {"a"}


@pytest.mark.parametrize("type_", ["Real m", "Integer"])
def test_a_value_beyond_all_floats_is_refused(shop, type_):
    shop.fmu("one", f"input u {type_}")
    shop.ssd(shop.component("a", "one", "input u"))
    system = shop.read()
    for value in (10**400, -(10**400), math.inf, -math.inf, math.nan):
        with pytest.raises(ShipcosimError, match="a.u: .*(is not a finite number|is no Integer)"):
            with_values(system, {"a.u": value})
