"""Parameter values arrive where the standard says, in the FMU's unit and type, the highest level last."""

import zipfile

import pytest

from shipcosim.ssp import parameter, write_ssv
from shipcosim.ssp.read.parameters import read_parameter_set
from shipcosim.ssp.xml.document import Findings, read_document

ITEMS = '<Item name="off" value="1"/><Item name="on" value="2"/>'
TYPES = f'<SimpleType name="Mode"><Enumeration>{ITEMS}</Enumeration></SimpleType>'


def inline(parameters, prefix="", mapping=""):
    """ParameterBindings with one inline set."""
    given = f' prefix="{prefix}"' if prefix else ""
    return (
        f"<ssd:ParameterBindings><ssd:ParameterBinding{given}><ssd:ParameterValues>"
        f'<ssv:ParameterSet version="1.0" name="inline"><ssv:Parameters>{parameters}</ssv:Parameters>'
        f"</ssv:ParameterSet></ssd:ParameterValues>{mapping}</ssd:ParameterBinding></ssd:ParameterBindings>"
    )


def by_file(*sources, mapping=""):
    """ParameterBindings with sets in files."""
    inner = "".join(
        f'<ssd:ParameterBinding source="{source}">{mapping}</ssd:ParameterBinding>'
        for source in sources
    )
    return f"<ssd:ParameterBindings>{inner}</ssd:ParameterBindings>"


@pytest.fixture
def ship(shop):
    """FMU with parameters of every type."""
    shop.fmu(
        "hull",
        "parameter mass Real m min=0 max=10000",
        "parameter angle Real rad",
        "parameter seed Integer",
        "parameter replay Boolean",
        "parameter table String",
        "parameter mode Enumeration declaredType=Mode",
        "output x Real m",
        types=TYPES,
    )
    return shop


def start(shop, *parameters, component="hull"):
    return shop.read(*parameters).components[component].start


def test_an_inline_set_reaches_the_component_in_its_unit(ship, real):
    ship.ssd(ship.component("hull", "hull", more=inline(real("mass", "2", "km"))))
    assert start(ship) == {"mass": 2000.0}


def test_values_of_every_type_arrive_as_such(ship):
    values = "".join(
        f'<ssv:Parameter name="{name}"><ssv:{kind} value="{value}"/></ssv:Parameter>'
        for name, kind, value in [
            ("mass", "Integer", "3"),
            ("seed", "Integer", "-4"),
            ("replay", "Boolean", "1"),
            ("table", "String", "0 1; 2 3"),
            ("mode", "Enumeration", "on"),
        ]
    )
    ship.ssd(ship.component("hull", "hull", more=inline(values)))
    found = start(ship)
    assert found == {"mass": 3.0, "seed": -4, "replay": True, "table": "0 1; 2 3", "mode": 2}
    assert [type(value) for value in found.values()] == [float, int, bool, str, int]


@pytest.mark.parametrize(
    ("name", "kind", "value", "message"),
    [
        ("seed", "Real", "1.0", "the value is Real, hull.seed is Integer."),
        ("mass", "Boolean", "true", "the value is Boolean, hull.mass is Real."),
        (
            "mode",
            "Enumeration",
            "onn",
            "The enumeration has no item 'onn'. It has: off, on. Did you mean 'on'?",
        ),
        ("mass", "Real", "-1", "hull.mass cannot be -1 m. Allowed: 0 to 10000 m."),
        ("mass", "Real", "NaN", "'NaN' is not a finite number."),
        ("x", "Real", "1", "hull.x is of causality output, a value that the FMU calculates."),
        (
            "maass",
            "Real",
            "1",
            "hull has no parameter 'maass'. It has: angle, mass, mode, replay, seed, table.",
        ),
    ],
)
def test_values_that_do_not_fit_are_refused(ship, name, kind, value, message):
    values = f'<ssv:Parameter name="{name}"><ssv:{kind} value="{value}"/></ssv:Parameter>'
    ship.ssd(ship.component("hull", "hull", more=inline(values)))
    assert message in ship.refused()


def test_a_unit_that_does_not_fit_is_refused_with_its_line(ship, real):
    ship.ssv(real("hull.mass", "2", "deg"))
    ship.ssd(ship.component("hull", "hull"), head=by_file("resources/numbers.ssv"))
    message = ship.refused()
    assert (
        "resources/numbers.ssv, line 5: hull.mass: the value is in deg, hull.mass in m" in message
    )


@pytest.mark.parametrize(
    ("name", "definition", "is_right"),
    [
        ("deg", 'rad="1" factor="57.29746"', False),
        ("deg", 'rad="1" factor="0.017453"', True),
        ("deg", 'factor="0.0174533"', True),
        ("m", 'm="1" factor="1e-3"', False),
        ("kn", 'm="1" s="-1" factor="0.514444"', True),
        ("kn", 'm="1" factor="0.514444"', False),
        ("degC", 'K="1" offset="273.15"', True),
        ("degC", 'K="1"', False),
        ("C", 'K="1" offset="273.15"', True),
        ("furlong", 'm="1" factor="201.168"', True),
    ],
)
def test_a_definition_that_contradicts_the_name_is_a_remark(ship, name, definition, is_right):
    units = (
        f'<ssd:Units><ssc:Unit name="{name}"><ssc:BaseUnit {definition}/></ssc:Unit></ssd:Units>'
    )
    ship.ssd(ship.component("hull", "hull"), rest=units)
    said = [one for one in ship.read().remarks if "commonly it is" in one.found]
    assert len(said) == (not is_right)


def test_one_unit_name_with_two_definitions_shows_both(ship, real):
    units = (
        '<ssv:Units><ssc:Unit name="m"><ssc:BaseUnit m="1" factor="1e-3"/></ssc:Unit></ssv:Units>'
    )
    values = inline(real("mass", "1", "m")).replace(
        "</ssv:Parameters>", "</ssv:Parameters>" + units
    )
    ship.ssd(ship.component("hull", "hull", more=values))
    said = " ".join(map(str, ship.read().remarks))
    assert "the value is in m (0.001 m), hull.mass in m (1 m): one name, two definitions" in said


def test_a_value_without_a_unit_is_in_the_fmus(ship, real):
    ship.ssd(ship.component("hull", "hull", more=inline(real("angle", "0.5"))))
    assert start(ship) == {"angle": 0.5}


def test_later_sets_and_higher_levels_win(ship, real):
    """mass: set at the component, at both systems around it and for this run; each level is taken away in turn."""
    for number in (2, 3, 4, 5):
        ship.ssv(
            real({2: "hull.mass"}.get(number, "inner.hull.mass"), str(number)),
            f"resources/{number}.ssv",
        )
    own = inline(real("mass", "1"))
    component = ship.component("hull", "hull", more=own)
    inner = f'<ssd:System name="inner">{by_file("resources/2.ssv")}<ssd:Elements>{component}</ssd:Elements></ssd:System>'
    ship.ssd(inner, head=by_file("resources/3.ssv", "resources/4.ssv"))
    run = ship.folder / "resources/5.ssv"
    assert start(ship, run, component="inner.hull") == {"mass": 5.0}
    assert start(ship, component="inner.hull") == {"mass": 4.0}
    ship.ssd(inner, head=by_file("resources/4.ssv", "resources/3.ssv"))
    assert start(ship, component="inner.hull") == {"mass": 3.0}
    ship.ssd(inner)
    assert start(ship, component="inner.hull") == {"mass": 2.0}
    ship.ssd(inner.replace("resources/2.ssv", "resources/empty.ssv"))
    ship.ssv("", "resources/empty.ssv")
    assert start(ship, component="inner.hull") == {"mass": 1.0}


def test_a_prefix_makes_a_components_set_fit_a_system(ship, real):
    ship.ssd(ship.component("hull", "hull"), head=inline(real("mass", "7"), prefix="hull."))
    assert start(ship) == {"mass": 7.0}


def test_a_mapping_renames_transforms_and_leaves_out_what_it_does_not_name(ship, real):
    ship.ssv(real("m", "2", "km") + real("hull.angle", "1"))
    linear = '<ssc:LinearTransformation factor="2" offset="10"/>'
    ship.ssm(f'<ssm:MappingEntry source="m" target="hull.mass">{linear}</ssm:MappingEntry>')
    mapping = '<ssd:ParameterMapping source="resources/names.ssm"/>'
    ship.ssd(ship.component("hull", "hull"), head=by_file("resources/numbers.ssv", mapping=mapping))
    assert start(ship) == {"mass": 4010.0}  # 2 * 2000 m + 10

    ship.ssm('<ssm:MappingEntry source="m" target="hull.mass" suppressUnitConversion="true"/>')
    assert start(ship) == {"mass": 2.0}

    ship.ssm('<ssm:MappingEntry source="mm" target="hull.mass"/>')
    assert "The parameter set 'numbers' has no 'mm'." in ship.refused()


def test_values_that_no_mapping_names_are_one_remark_and_those_of_another_binding_none(ship, real):
    ship.ssv("".join(real(name, "2") for name in ("m", "a", "b", "c")))
    ship.ssm('<ssm:MappingEntry source="m" target="hull.mass"/>')
    ship.ssm('<ssm:MappingEntry source="b" target="hull.mass"/>', "resources/more.ssm")
    bindings = "".join(
        f'<ssd:ParameterBinding source="resources/numbers.ssv"><ssd:ParameterMapping source="resources/{name}.ssm"/>'
        "</ssd:ParameterBinding>"
        for name in ("names", "more")
    )
    head = f"<ssd:ParameterBindings>{bindings}</ssd:ParameterBindings>"
    ship.ssd(ship.component("hull", "hull"), head=head)
    remarks = [str(remark) for remark in ship.read().remarks if "mapping" in remark.found]
    assert len(remarks) == 1
    assert "a: No mapping names a, c; not used." in remarks[0]


def test_two_values_from_one_place_for_one_parameter_are_a_remark(ship, real):
    # Once by the system's own connector, once by the component's name; overrides of a level by another are none.
    connectors = '<ssd:Connectors><ssd:Connector name="q" kind="parameter"/></ssd:Connectors>'
    hull = ship.component("hull", "hull", "parameter mass", more=inline(real("mass", "1")))
    line = ship.connection("q", "hull.mass")
    ship.ssd(hull, line, head=connectors + inline(real("hull.mass", "7")))
    assert [str(r) for r in ship.read().remarks if "already" in r.found] == []
    ship.ssd(hull, line, head=connectors + inline(real("hull.mass", "7") + real("q", "2")))
    (remark,) = (str(r) for r in ship.read().remarks if "already" in r.found)
    assert "q: hull.mass has got 7.0 from here already; 2.0 is used." in remark
    assert start(ship) == {"mass": 2.0}


def test_a_value_in_a_unit_for_a_variable_that_has_none_is_a_remark(ship, real):
    ship.fmu("scale", "parameter m Real", "parameter g Real")
    values = real("scale.m", "3", "km") + real("scale.g", "4", "1")
    ship.ssd(ship.component("scale", "scale"), head=inline(values))
    system = ship.read()
    assert system.components["scale"].start == {"m": 3.0, "g": 4.0}
    (remark,) = (str(r) for r in system.remarks if "no unit" in r.found)
    assert "since no unit is stated where they go: scale.m in km." in remark


def test_a_value_that_a_connection_replaces_is_a_remark(ship, real):
    ship.fmu("scale", "calculatedParameter m Real m")
    parts = ship.component("scale", "scale", "calculatedParameter m")
    parts += ship.component("hull", "hull", "parameter mass", more=inline(real("mass", "1")))
    ship.ssd(parts, ship.connection("scale.m", "hull.mass"))
    remarks = "\n".join(map(str, ship.read().remarks))
    assert "hull: Connections replace the values that are set for mass." in remarks


def test_an_enumeration_is_mapped_by_the_names_of_its_items(ship):
    value = '<ssv:Parameter name="state"><ssv:Enumeration value="alive"/></ssv:Parameter>'
    mapping = (
        '<ssd:ParameterMapping><ssm:ParameterMapping version="1.0"><ssm:MappingEntry source="state" target="hull.mode">'
        '<ssc:EnumerationMappingTransformation><ssc:MapEntry source="alive" target="on"/>'
        "</ssc:EnumerationMappingTransformation></ssm:MappingEntry></ssm:ParameterMapping></ssd:ParameterMapping>"
    )
    ship.ssd(ship.component("hull", "hull"), head=inline(value, mapping=mapping))
    assert start(ship) == {"mode": 2}


def test_a_systems_parameter_connector_hands_its_value_in(ship, real):
    connector = (
        '<ssd:Connector name="weight" kind="parameter"><ssc:Real unit="km"/></ssd:Connector>'
    )
    head = f"<ssd:Connectors>{connector}</ssd:Connectors>" + inline(real("weight", "3"))
    ship.ssd(
        ship.component("hull", "hull", "parameter mass"),
        ship.connection("weight", "hull.mass"),
        head=head,
    )
    system = ship.read()
    assert system.components["hull"].start == {"mass": 3000.0}
    assert (system.parameters["weight"].start, system.parameters["weight"].unit) == (3.0, "km")
    assert system.connections == ()


def test_a_set_may_hold_values_for_elements_that_are_not_here(ship, real):
    """One set serves several systems; what it holds for the others is a remark."""
    ship.ssv(real("hull.mass", "2") + real("controller.gain", "1"))
    ship.ssd(ship.component("hull", "hull"), head=by_file("resources/numbers.ssv"))
    system = ship.read()
    assert system.components["hull"].start == {"mass": 2.0}
    assert any("There is no element 'controller'" in remark.found for remark in system.remarks)


def test_a_slip_in_an_elements_name_is_refused_but_another_number_is_not(ship, real):
    ship.ssd(ship.component("hull_1", "hull"), head=by_file("resources/numbers.ssv"))
    ship.ssv(real("hulk_1.mass", "2"))
    assert (
        "There is no element 'hulk_1'. There is: hull_1. Did you mean 'hull_1'?" in ship.refused()
    )
    ship.ssv(real("hull_2.mass", "2"))
    assert ship.read().components["hull_1"].start == {}


def test_a_parameter_twice_in_a_set_is_refused(ship, real):
    ship.ssd(
        ship.component("hull", "hull", more=inline(real("mass", "2") + "\n" + real("mass", "3")))
    )
    assert "line 9: mass: The set has this parameter already, in line 8." in ship.refused()


def test_a_set_that_breaks_the_schema_is_refused_with_its_line(ship):
    path = ship.ssv('<ssv:Parameter name="mass"><ssv:Real valu="2"/></ssv:Parameter>')
    ship.ssd(ship.component("hull", "hull"))
    assert f"{path}, line 5" in ship.refused(path)


def test_a_written_set_reads_back_the_same(tmp_path):
    values = [
        parameter("vessel.mass", 577e3, "kg", "displacement at the trial; assumed", tolerance=5e3),
        parameter("vessel.inertia", 1.1e8, "kg.m2"),
        parameter("environment.wind_from", 45.0, "deg"),
        parameter("environment.seed", 12),
        parameter("port.replay", False),
        parameter(
            "vessel.wind_table",
            "0 -0.53 0; 10 -0.59 0.22; " * 800,
            description="from <tests> & 'drawings'",
        ),
    ]
    path = tmp_path / "new" / "ship.ssv"
    write_ssv(path, "ship", values)
    findings = Findings()
    read = read_parameter_set(read_document(path, str(path), findings), findings)
    assert findings.problems == [] and read.name == "ship"
    for one, other in zip(values, read.values, strict=True):
        same = ("name", "kind", "value", "unit", "description", "tolerance")
        assert [getattr(one, name) for name in same] == [getattr(other, name) for name in same]
    assert b'<ssv:ParameterSet xmlns:ssv="' in path.read_bytes()  # libcosim needs these prefixes


def test_a_set_inside_the_fmu_is_found_there(ship, real):
    with zipfile.ZipFile(ship.folder / "resources/hull.fmu", "a") as archive:
        archive.writestr("extra/own.ssv", ship.ssv(real("mass", "8")).read_text())
    ship.ssd(
        ship.component(
            "hull",
            "hull",
            more=by_file("extra/own.ssv").replace("source", 'sourceBase="component" source'),
        )
    )
    assert start(ship) == {"mass": 8.0}
    ship.ssd(
        ship.component(
            "hull",
            "hull",
            more=by_file("own.ssv").replace("source", 'sourceBase="component" source'),
        )
    )
    assert "hull.fmu has no file 'own.ssv'." in ship.refused()


def test_a_read_only_place_for_a_set_is_an_error_and_leaves_nothing(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(Exception, match="Cannot be written"):
        write_ssv(tmp_path / "file" / "ship.ssv", "ship", [])


PARAMETERS = {
    "mass": "Real",
    "seed": "Integer",
    "replay": "Boolean",
    "table": "String",
    "mode": "Enumeration",
}
VALUES = {
    "Real": "2.5",
    "Integer": "1",
    "Boolean": "true",
    "String": "4",
    "Enumeration": "on",
    "Binary": "00ff",
}
TAKEN = {("Integer", "Real"), ("Enumeration", "Integer"), ("Integer", "Enumeration")}
TYPES_OF_VALUES = [
    (kind, name)
    for kind in VALUES
    for name, wanted in PARAMETERS.items()
    if kind != wanted and (kind, wanted) not in TAKEN
]


@pytest.mark.parametrize("through", ["component", "system connector"])
@pytest.mark.parametrize(("kind", "name"), TYPES_OF_VALUES)
def test_a_value_of_another_type_is_refused_in_one_sentence(ship, kind, name, through):
    value = f'<ssv:Parameter name="{name}"><ssv:{kind} value="{VALUES[kind]}"/></ssv:Parameter>'
    if through == "component":
        ship.ssd(ship.component("hull", "hull", more=inline(value)))
    else:
        head = f'<ssd:Connectors><ssd:Connector name="{name}" kind="parameter"/></ssd:Connectors>'
        hull = ship.component("hull", "hull", f"parameter {name}")
        ship.ssd(hull, ship.connection(name, f"hull.{name}"), head=head + inline(value))
    refused = ship.refused()
    assert f"is {kind}" in refused or "The enumeration has no item" in refused
    assert "fault of shipcosim" not in refused and len(refused.splitlines()) == 1
