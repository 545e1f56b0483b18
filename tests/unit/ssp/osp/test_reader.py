"""OspSystemStructure.xml and its variable groups: read as libcosim means them, refused with line and remedy."""

import os
import shutil
import zipfile
from pathlib import Path
from urllib.parse import quote

import pytest

import shipcosim as sc
from shipcosim.errors import ShipcosimError
from shipcosim.ssp import check_file, read_system

NAMESPACE = "http://opensimulationplatform.com/MSMI/OSPSystemStructure"
HEAD = "<BaseStepSize>0.1</BaseStepSize>\n<Algorithm>fixedStep</Algorithm>"
GROUPS = """<ospModelDescription xmlns="http://opensimulationplatform.com/MSMI/OSPModelDescription" version="1.0">
<VariableGroups>{}</VariableGroups></ospModelDescription>"""
SIMULATORS = """
<Simulator name="a" source="resources/one.fmu" stepSize="0.2"/>
<Simulator name="b" source="resources/one.fmu">{}</Simulator>
"""


@pytest.fixture
def osp(shop):
    """Function that writes an OspSystemStructure.xml for two simulators of an FMU, and gives its path."""
    shop.fmu(
        "one",
        "input u Real m",
        "input v Real m",
        "output y Real m",
        "output z Real km",
        "parameter k Real",
    )

    def write(functions="", connections="", values="", head=HEAD, simulators=SIMULATORS):
        path = shop.folder / "OspSystemStructure.xml"
        initial = f"<InitialValues>{values}</InitialValues>" if values else ""
        path.write_text(
            f'<OspSystemStructure xmlns="{NAMESPACE}" version="0.1">\n{head}\n'
            f"<Simulators>{simulators.replace('{}', initial)}</Simulators>\n"
            f"<Functions>{functions}</Functions>\n<Connections>\n{connections}\n</Connections></OspSystemStructure>"
        )
        return path

    return write


def joined(one, other, more=""):
    ends = "".join(
        '<Variable simulator="{}" name="{}"/>'.format(*end.split(".")) for end in (one, other)
    )
    return f"<VariableConnection{more}>{ends}</VariableConnection>\n"


def through(end, function, name):
    simulator, variable = end.split(".")
    signal = f'<Signal function="{function}" name="{name}"/>'
    return f'<SignalConnection><Variable simulator="{simulator}" name="{variable}"/>{signal}</SignalConnection>\n'


def value(name, kind, text):
    return f'<InitialValue variable="{name}"><{kind} value="{text}"/></InitialValue>'


def text_of(problems, severity="error"):
    return "\n".join(str(problem) for problem in problems if problem.severity == severity)


def remarks_of(path):
    return [p for p in check_file(path) if p.severity == "remark" and "platform" not in p.found]


def test_a_system_has_its_steps_times_values_and_directions(osp):
    head = "<StartTime>2.0</StartTime><EndTime>12</EndTime>" + HEAD
    path = osp(
        connections=joined("a.u", "b.y"),
        values=value("k", "Real", "1e-3") + value("u", "Real", "4"),
        head=head,
    )
    system = read_system(path)
    assert system.components["b"].start == {"k": 1e-3, "u": 4.0}
    assert (system.components["a"].step_size, system.components["b"].step_size) == (0.2, None)
    assert [(c.source, c.target) for c in system.connections] == [(("b", "y"), ("a", "u"))]
    assert (
        system.experiment.start_time,
        system.experiment.stop_time,
        system.experiment.step_size,
    ) == (2.0, 12.0, 0.1)
    assert read_system(path.parent).components.keys() == {"a", "b"}


def test_parameter_sets_go_over_initial_values(osp, shop):
    path = osp(values=value("k", "Real", "1"))
    values = sc.parameter("b.k", 7.0)
    sc.write_ssv(shop.folder / "more.ssv", "more", [values])
    assert read_system(path, shop.folder / "more.ssv").components["b"].start == {"k": 7.0}


def test_functions_become_connections_and_a_sum_is_several_into_one(osp):
    functions = (
        '<LinearTransformation name="f" factor="2" offset="-1"/><Sum name="s" inputCount="2"/>'
    )
    connections = through("a.y", "f", "in") + through("b.v", "f", "out")
    connections += (
        through("b.y", "s", "in[1]") + through("b.u", "s", "out") + through("a.z", "s", "in[0]")
    )
    found = [
        (c.source, c.target, c.factor, c.offset)
        for c in read_system(osp(functions, connections)).connections
    ]
    assert found == [
        (("a", "y"), ("b", "v"), 2.0, -1.0),
        (("a", "z"), ("b", "u"), 1.0, 0.0),
        (("b", "y"), ("b", "u"), 1.0, 0.0),
    ]


def test_an_fmu_may_lie_elsewhere_and_be_addressed_as_a_file(osp, shop, tmp_path_factory):
    folder = tmp_path_factory.mktemp("else where")
    shutil.move(shop.folder / "resources" / "one.fmu", folder)
    path = osp(simulators='<Simulator name="a" source="gone/one.fmu"/>')
    assert read_system(path, fmus=[folder]).components.keys() == {"a"}
    relative = quote(Path(os.path.relpath(folder / "one.fmu", path.parent)).as_posix())
    for source in ((folder / "one.fmu").as_uri(), relative):
        assert "%20" in source
        path = osp(simulators=f'<Simulator name="a" source="{source}"/>')
        assert read_system(path).components["a"].fmu.path.samefile(folder / "one.fmu")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"simulators": '<Simulator name="a" source="proxyfmu://host?file=one.fmu"/>'},
            "of the kind 'proxyfmu'",
        ),
        (
            {"simulators": '<Simulator name="a" source="http://host/one.fmu"/>'},
            "of the kind 'http'. Name the FMU's",
        ),
        (
            {"simulators": '<Simulator name="a" source="two.fmu"/>'},
            "The file 'two.fmu' does not exist. In",
        ),
        ({"simulators": SIMULATORS.replace('"b"', '"a"')}, "A second simulator is named 'a'."),
        ({"simulators": SIMULATORS.replace("0.2", "-1")}, "stepSize is -1. It must be positive."),
        ({"simulators": SIMULATORS.replace("0.2", "1e400")}, "'1e400' is not a finite number"),
        ({"simulators": SIMULATORS.replace(' name="b"', "")}, "'name' is required but missing"),
        ({"head": HEAD.replace("0.1", "0.0")}, "base step size must be positive"),
        ({"head": HEAD.replace("0.1", "quick")}, "'quick' is not"),
        ({"values": value("l", "Real", "1")}, "b has no parameter 'l'. It has: k, u, v."),
        ({"values": value("k", "Boolean", "true")}, "the value is Boolean, b.k is Real"),
        ({"values": value("y", "Real", "1")}, "b.y is of causality output"),
        ({"connections": joined("a.y", "c.u")}, "There is no simulator 'c'. There is: a, b."),
        ({"connections": joined("a.y", "b.w")}, "b has no variable 'w'. It has: k, u, v, y, z."),
        (
            {"connections": joined("a.y", "b.z")},
            "b.z output. A connection leads from an output to an input.",
        ),
        ({"connections": joined("a.u", "b.u")}, "b.u is of causality input, a.u input."),
        ({"connections": joined("a.y", "b.k")}, "b.k parameter"),
        (
            {"connections": joined("a.y", "b.u") + joined("a.y", "b.u")},
            "line 11: a.y - b.u: A second connection",
        ),
        ({"connections": through("a.y", "g", "in")}, "There is no function 'g'."),
        ({"functions": '<Sum name="a" inputCount="2"/>'}, "'a' is the name of something else"),
        ({"functions": '<Sum name="s" inputCount="999999999"/>'}, "At most 10000 are taken."),
        ({"functions": '<LinearTransformation name="f" factor="INF"/>'}, "no finite number"),
        ({"functions": '<Sum name="s" inputCount="1"/>'}, "has nothing connected to in[0], out."),
        (
            {
                "functions": '<Sum name="s" inputCount="1"/>',
                "connections": through("a.y", "s", "in"),
            },
            "The Sum 's' has no signal 'in'. It has: in[0], out.",
        ),
        (
            {
                "functions": '<Sum name="s" inputCount="1"/>',
                "connections": through("a.y", "s", "in[0]")
                + through("a.z", "s", "in[0]")
                + through("b.u", "s", "out"),
            },
            "A second connection into s:in[0].",
        ),
    ],
    ids=lambda given: given[:20] if isinstance(given, str) else "",
)
def test_a_fault_is_refused_with_file_and_line(osp, change, message):
    path = osp(**change)
    found = text_of(check_file(path))
    assert message in found and f"{path}, line " in found
    with pytest.raises(ShipcosimError):
        read_system(path)


def test_one_unit_name_with_two_definitions_is_shown_with_both(osp, shop):
    shop.fmu("two", "input u Real deg")
    path = shop.folder / "resources" / "two.fmu"
    with zipfile.ZipFile(path) as archive:
        text = archive.read("modelDescription.xml").decode()
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", text.replace("0.017453292519943295", "57.3"))
    shop.fmu("one", "output y Real deg")
    simulators = SIMULATORS.replace('one.fmu">', 'two.fmu">')
    structure = osp(connections=joined("a.y", "b.u"), simulators=simulators)
    found = text_of(remarks_of(structure), "remark")
    assert "a.y is in deg (0.0174533 rad), b.u in deg (57.3 rad): OSP converts no units." in found


def test_what_libcosim_would_do_otherwise_is_remarked(osp):
    head = "<Algorithm>ecco</Algorithm>"
    connections = joined("a.z", "b.u", ' powerBond="p"')
    found = text_of(remarks_of(osp(connections=connections, head=head)), "remark")
    assert "0.1 s is taken, as libcosim does" in found
    assert "The algorithm 'ecco' is not known" in found
    assert "powerBond is not used" in found
    assert "a.z is in km, b.u in m: OSP converts no units. Put a LinearTransformation" in found
    functions = '<LinearTransformation name="f"/>'
    connections = (
        through("a.y", "f", "in") + through("b.u", "f", "out") + through("b.v", "f", "out")
    )
    path = osp(functions, connections)
    assert "libcosim makes the first alone" in text_of(remarks_of(path), "remark")
    assert len(read_system(path).connections) == 2


def grouped(one, other):
    ends = "".join(
        '<VariableGroup simulator="{}" name="{}"/>'.format(*end.split(".")) for end in (one, other)
    )
    return f"<VariableGroupConnection>{ends}</VariableGroupConnection>\n"


PORTS = """<Force name="taken"><Variable ref="u"/><Variable ref="v"/></Force>
<Force name="given"><Variable ref="y"/><Variable ref="z"/></Force>
<Generic name="one"><Force name="short"><Variable ref="y"/></Force></Generic>"""


@pytest.mark.parametrize(
    ("groups", "connections", "message"),
    [
        (
            None,
            grouped("a.given", "b.taken"),
            "are described nowhere. Put one_OspModelDescription.xml beside it.",
        ),
        (
            PORTS,
            grouped("a.given", "b.take"),
            "b has no variable group 'take'. It has: given, one, short, taken.",
        ),
        (PORTS, grouped("a.short", "b.taken"), "a.short has 1 variable, b.taken 2 variables."),
        (
            PORTS,
            grouped("a.one", "b.taken"),
            "a.one has 0 variables and 1 group, b.taken 2 variables.",
        ),
        (
            PORTS.replace('"y"', '"w"', 1),
            grouped("a.given", "b.taken"),
            "one.fmu has no variable 'w'.",
        ),
        (
            PORTS.replace("given", "taken"),
            grouped("a.taken", "b.taken"),
            "A second group has this name.",
        ),
    ],
)
def test_a_fault_of_groups_is_refused(osp, shop, groups, connections, message):
    if groups:
        (shop.folder / "resources" / "one_OspModelDescription.xml").write_text(
            GROUPS.format(groups)
        )
    assert message in text_of(check_file(osp(connections=connections)))


def test_groups_are_found_beside_the_structure_and_by_the_name_of_the_file(osp, shop):
    fmu = shop.folder / "resources" / "one.fmu"
    with zipfile.ZipFile(fmu) as archive:
        text = archive.read("modelDescription.xml").decode()
    with zipfile.ZipFile(fmu, "w") as archive:
        archive.writestr(
            "modelDescription.xml", text.replace('modelName="one"', 'modelName="Only One"')
        )
    (shop.folder / "one_OspModelDescription.xml").write_text(GROUPS.format(PORTS))
    path = osp(connections=grouped("a.given", "b.taken"))
    pairs = [(".".join(c.source), ".".join(c.target)) for c in read_system(path).connections]
    assert pairs == [("a.y", "b.u"), ("a.z", "b.v")]
    assert "libcosim looks for Only One_OspModelDescription.xml instead" in text_of(
        remarks_of(path), "remark"
    )


@pytest.mark.parametrize(
    "text", ["<a/>", f'<OspModelDescription xmlns="{NAMESPACE}"/>', "", "<!DOCTYPE a><a/>"]
)
def test_another_file_is_none(tmp_path, text):
    path = tmp_path / "OspSystemStructure.xml"
    path.write_text(text)
    assert text_of(check_file(path))


def test_it_cannot_be_edited_and_says_so(osp):
    with pytest.raises(ShipcosimError, match="cannot be edited"):
        sc.read(osp())


ARRAYS = """<fmiModelDescription fmiVersion="3.0" modelName="m" instantiationToken="m">
<CoSimulation modelIdentifier="m"/><ModelVariables>
<UInt64 name="n" valueReference="1" causality="structuralParameter" variability="fixed" start="2"/>
<Float64 name="A" valueReference="2" causality="input" start="0 0"><Dimension valueReference="1"/></Float64>
<Float64 name="B" valueReference="3" causality="output"><Dimension valueReference="1"/></Float64></ModelVariables>
<ModelStructure><Output valueReference="3"/></ModelStructure></fmiModelDescription>"""


def test_arrays_of_fmi_3_are_connected_by_elements_and_sized_by_initial_values(osp, shop):
    with zipfile.ZipFile(shop.folder / "resources" / "three.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", ARRAYS)
    simulators = SIMULATORS.replace("one.fmu", "three.fmu")
    system = read_system(
        osp(connections=joined("a.B[2]", "b.A[1]"), simulators=simulators.replace("{}", ""))
    )
    assert [(c.source, c.target) for c in system.connections] == [(("a", "B[2]"), ("b", "A[1]"))]
    larger = read_system(osp(values=value("n", "Integer", "3"), simulators=simulators))
    assert (
        "A[3]" in larger.components["b"].fmu.variables
        and "A[3]" not in larger.components["a"].fmu.variables
    )


@pytest.mark.parametrize(
    ("first", "second", "refused"),
    [("1", "2", True), ("1", "1", False), ("0", "-0.0", False)],
)
def test_two_initial_values_of_a_variable_must_agree(osp, first, second, refused):
    path = osp(values=value("k", "Real", first) + value("k", "Real", second))
    assert ("b.k: It has two initial values." in text_of(check_file(path))) == refused


@pytest.mark.parametrize("kind", ["Boolean", "String"])
def test_an_initial_value_of_another_type_is_refused(osp, kind):
    path = osp(values=value("k", kind, "true"))
    assert f"the value is {kind}, b.k is Real" in text_of(check_file(path))


def test_a_simulator_needs_a_name(osp):
    path = osp(simulators=SIMULATORS.replace('name="a"', 'name=""'))
    assert "A simulator has no name." in text_of(check_file(path))


@pytest.mark.parametrize("name", ["ONE.fmu", "one.FMU", "One.Fmu"])
def test_a_file_name_in_other_letters_is_taken_with_a_remark(osp, name):
    path = osp(simulators=SIMULATORS.replace("one.fmu", name))
    assert not text_of(check_file(path))
    assert f"There is no 'resources/{name}'; one.fmu is taken." in text_of(
        check_file(path), "remark"
    )


def test_only_a_time_that_the_file_lacks_is_called_missing(osp):
    with pytest.raises(ShipcosimError, match="stop_time is missing") as refused:
        sc.simulate(osp())
    assert "step_size" not in str(refused.value)
