"""Model descriptions of FMI 2.0 and 3.0 are read whole."""

import zipfile

import pytest

from shipcosim.errors import ShipcosimError
from shipcosim.ssp import read_fmu
from shipcosim.ssp.fmu.reader import describe_fmu
from shipcosim.ssp.xml.document import Findings

FMI3 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="new" instantiationToken="{{1}}">
<CoSimulation modelIdentifier="new" canGetAndSetFMUState="true"/>
<UnitDefinitions><Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit></UnitDefinitions>
<TypeDefinitions><Float64Type name="Speed" unit="m/s" min="0"/>
<EnumerationType name="Mode"><Item name="off" value="1"/><Item name="on" value="2"/></EnumerationType></TypeDefinitions>
<ModelVariables>
<Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
<Float64 name="u" valueReference="1" causality="input" declaredType="Speed" start="1.5"><Alias name="speed"/></Float64>
<Float32 name="y" valueReference="2" causality="output"/>
<UInt64 name="n" valueReference="3" causality="structuralParameter" variability="fixed" start="3"/>
<Float64 name="v" valueReference="4" causality="input" start="1 2 3"><Dimension valueReference="3"/></Float64>
<String name="s" valueReference="5" causality="parameter" variability="fixed"><Start value="a b"/></String>
<Boolean name="b" valueReference="6" causality="input" start="true"/>
<Enumeration name="e" valueReference="7" declaredType="Mode" causality="input" start="2"/>
</ModelVariables><ModelStructure>{structure}</ModelStructure></fmiModelDescription>
"""


def fmu(path, text, *more):
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", text)
        for name in more:
            archive.writestr(name, "")
    return path


def test_fmi_2_variables_with_what_their_types_declare(shop):
    types = '<SimpleType name="Force"><Real unit="m" min="-5" max="5"/></SimpleType>'
    path = shop.fmu(
        "one",
        "input u Real declaredType=Force",
        "output y Real max=9 declaredType=Force",
        types=types,
    )
    described = read_fmu(path)
    assert (described.fmi_version, described.model_identifier, described.token) == (
        "2.0",
        "one",
        "one",
    )
    u, y = described.variables["u"], described.variables["y"]
    assert (u.unit, u.minimum, u.maximum, u.start, u.value_reference) == ("m", -5.0, 5.0, 0.0, 0)
    assert (y.unit, y.maximum, y.settable, u.settable) == ("m", 9.0, False, True)
    assert described.units["kn"].factor == pytest.approx(1852 / 3600)


def test_fmi_3_variables_arrays_and_aliases(tmp_path):
    path = fmu(
        tmp_path / "new.fmu",
        FMI3.format(structure='<Output valueReference="2"/>'),
        "binaries/x86_64-linux/new.so",
    )
    described = read_fmu(path)
    variables = described.variables
    assert (described.fmi_version, described.platforms) == ("3.0", ("x86_64-linux",))
    assert described.capability("canGetAndSetFMUState")
    assert (variables["u"].unit, variables["u"].minimum, variables["u"].start) == ("m/s", 0.0, 1.5)
    assert variables["speed"].value_reference == variables["u"].value_reference
    assert (variables["y"].kind, variables["n"].kind, variables["b"].start) == (
        "Real",
        "Integer",
        True,
    )
    assert (variables["v"].dimensions, variables["v"].start) == ((3,), (1.0, 2.0, 3.0))
    assert (variables["s"].start, variables["e"].start, variables["e"].items) == (
        "a b",
        2,
        {"off": 1, "on": 2},
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "<fmiModelDescription fmiVersion='0.9'/>",
            "FMI version '0.9'. Versions 1.0, 2.0 and 3.0 are read",
        ),
        ("<x/>", "Its outermost element is <x>."),
        ("<fmiModelDescription", "Not well-formed XML"),
        (
            "<fmiModelDescription fmiVersion='2.0'/>",
            "The attribute 'modelName' is required but missing.",
        ),
        (
            FMI3.format(structure="<Output/>"),
            "line 16: Element 'Output': The attribute 'valueReference' is required",
        ),
    ],
)
def test_what_is_no_fmu_is_refused(tmp_path, text, message):
    with pytest.raises(ShipcosimError) as caught:
        read_fmu(fmu(tmp_path / "x.fmu", text))
    assert message in str(caught.value)


def test_of_two_variables_of_one_name_the_first_is_meant_and_it_is_said(shop):
    path = shop.fmu("one", "output y Real m", "output y Integer", "output z Real m")
    findings = Findings()
    fmu = describe_fmu(path, findings)
    assert fmu.variables["y"].type == "Real"
    assert list(fmu.variables) == ["y", "z"]
    (flaw,) = findings.problems
    assert flaw.flaw
    assert "A second variable has this name, for another value (Integer" in flaw.found


def test_an_archive_without_a_model_description_is_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "x.fmu", "w"):
        pass
    with pytest.raises(ShipcosimError, match="no modelDescription.xml"):
        read_fmu(tmp_path / "x.fmu")


def test_our_stand_in_is_what_fmpy_reads_too(shop):
    fmpy = pytest.importorskip("fmpy")
    path = shop.fmu("one", "input u Real m start=2", "output y Integer", "parameter s String")
    theirs, ours = fmpy.read_model_description(str(path)), read_fmu(path)
    assert ours.token == theirs.guid
    for variable in theirs.modelVariables:
        own = ours.variables[variable.name]
        assert (own.value_reference, own.type, own.causality, own.unit) == (
            variable.valueReference,
            variable.type,
            variable.causality,
            variable.unit,
        )


FIRST = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="1.0" modelName="m" modelIdentifier="m" guid="{1}" numberOfContinuousStates="2"
    numberOfEventIndicators="1">
  <TypeDefinitions>
    <Type name="Gear"><EnumerationType min="0"><Item name="back"/><Item name="park"/></EnumerationType></Type>
    <Type name="Speed"><RealType unit="m/s" min="-3"/></Type>
  </TypeDefinitions>
  <ModelVariables>
   <ScalarVariable name="u" valueReference="0" causality="input"><Real declaredType="Speed" start="1"/></ScalarVariable>
   <ScalarVariable name="k" valueReference="1" variability="parameter"><Real start="2"/></ScalarVariable>
   <ScalarVariable name="y" valueReference="2" causality="output"><Real/></ScalarVariable>
   <ScalarVariable name="minus" valueReference="2" alias="negatedAlias"><Real/></ScalarVariable>
   <ScalarVariable name="gear" valueReference="3" causality="output"><Enumeration declaredType="Gear"/></ScalarVariable>
   <ScalarVariable name="guess" valueReference="4"><Real start="5" fixed="false"/></ScalarVariable>
  </ModelVariables>MORE
</fmiModelDescription>
"""
SLAVE = (
    '<Implementation><CoSimulation_StandAlone><Capabilities canHandleVariableCommunicationStepSize="true"/>'
    "</CoSimulation_StandAlone></Implementation>"
)


def test_fmi_1_is_described_in_the_words_of_fmi_2(tmp_path):
    described = read_fmu(fmu(tmp_path / "first.fmu", FIRST.replace("MORE", SLAVE)))
    traits = {
        v.name: (v.causality, v.variability, v.initial, v.start, v.settable)
        for v in described.variables.values()
    }
    assert traits == {
        "u": ("input", "continuous", None, 1.0, True),
        "k": ("parameter", "fixed", "exact", 2.0, True),
        "y": ("output", "continuous", None, None, False),
        "minus": ("local", "continuous", None, None, False),
        "gear": ("output", "discrete", None, None, False),
        "guess": ("local", "continuous", "approx", 5.0, True),
    }
    assert described.variables["minus"].negated and not described.variables["y"].negated
    assert described.variables["gear"].items == {"back": 0, "park": 1}
    assert (described.variables["u"].unit, described.variables["u"].minimum) == ("m/s", -3.0)
    assert (described.fmi_version, described.n_states, described.n_event_indicators) == (
        "1.0",
        2,
        1,
    )
    assert set(described.interfaces) == {"CoSimulation"} and described.model_identifier == "m"
    assert described.capability("canHandleVariableCommunicationStepSize")


def test_fmi_1_without_an_implementation_is_model_exchange(tmp_path):
    described = read_fmu(fmu(tmp_path / "first.fmu", FIRST.replace("MORE", "")))
    assert (
        set(described.interfaces) == {"ModelExchange"}
        and described.identifier("ModelExchange") == "m"
    )


EXPERIMENTS = [
    ('startTime="NaN" stopTime="1"', "startTime", {"stopTime": 1.0}),
    ('stopTime="INF"', "stopTime", {}),
    ('stopTime="-INF" stepSize="0.1"', "stopTime", {"stepSize": 0.1}),
    ('stopTime="1e999"', "stopTime", {}),
    ('stopTime="2" stepSize="0"', "stepSize", {"stopTime": 2.0}),
    ('stopTime="2" stepSize="-0.1"', "stepSize", {"stopTime": 2.0}),
    ('stopTime="2" stepSize="NaN"', "stepSize", {"stopTime": 2.0}),
    ('stopTime="2" tolerance="0"', "tolerance", {"stopTime": 2.0}),
    ('startTime="5" stopTime="3"', "stopTime", {"startTime": 5.0}),
    ('stopTime="-1"', "stopTime", {}),
    ('startTime="-2" stopTime="-1" stepSize="0.1" tolerance="1e-4"', None, None),
    ('startTime="0" stopTime="0"', None, None),
]


@pytest.mark.parametrize(("attributes", "unusable", "left"), EXPERIMENTS)
def test_of_a_default_experiment_only_what_a_run_can_have_is_kept(
    shop, tmp_path, attributes, unusable, left
):
    with zipfile.ZipFile(shop.fmu("one", "output y Real m")) as archive:
        text = archive.read("modelDescription.xml").decode()
    given = f"<DefaultExperiment {attributes}/><ModelVariables>"
    path = fmu(tmp_path / "new.fmu", text.replace("<ModelVariables>", given))
    findings = Findings()
    described = describe_fmu(path, findings)
    assert not findings.errors
    if unusable is None:
        assert not findings.problems and len(described.experiment) == attributes.count("=")
    else:
        assert described.experiment == left
        (remark,) = findings.problems
        assert f"has {unusable}=" in remark.found and remark.flaw


def test_a_description_is_kept_until_its_file_changes_and_an_error_is_not(tmp_path, monkeypatch):
    path = fmu(tmp_path / "first.fmu", FIRST.replace("MORE", SLAVE))
    first = read_fmu(path)
    assert read_fmu(path) is first
    # Another content of the same name.
    fmu(path, FIRST.replace("MORE", SLAVE).replace('"gear"', '"lever"'))
    assert "lever" in read_fmu(path).variables and "gear" in first.variables
    # What cannot be read at the moment, such as without a free file handle, can be read later.
    with monkeypatch.context() as patch:
        patch.setattr(zipfile, "ZipFile", None)
        path.touch()
        with pytest.raises(ShipcosimError):
            read_fmu(path)
    assert "lever" in read_fmu(path).variables
