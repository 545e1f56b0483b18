"""What was read and written again is the same system, whoever wrote it; what was changed runs in libcosim."""

import re
import textwrap
import zipfile

import pytest
from lxml import etree

from shipcosim.fmi.export.builder import build_fmu
from shipcosim.ssp import new, pack, parameter, read, read_system, write_ssv
from shipcosim.ssp.xml.document import Findings
from shipcosim.ssp.xml.validation import validate

RICH = """<?xml version="1.0" encoding="UTF-8"?>
<!-- Copyright of somebody -->
<ssd:SystemStructureDescription version="1.0" name="rich" description="with &quot;everything&quot; &amp; æøå"
    generationTool="another tool" xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
    xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping"
    xmlns:ssb="http://ssp-standard.org/SSP1/SystemStructureSignalDictionary"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:schemaLocation="here there" xmlns:oms="urn:oms">
  <ssd:System name="rich" id="top">
    <ssd:Connectors>
      <ssd:Connector name="u" kind="input" description="speed"><ssc:Real unit="kn"/>
        <ssd:ConnectorGeometry x="0" y="0.5"/></ssd:Connector>
      <ssd:Connector name="weight" kind="parameter"><ssc:Real unit="km"/></ssd:Connector>
      <ssd:Connector name="mode" kind="output"><ssc:Enumeration name="Mode"/></ssd:Connector>
    </ssd:Connectors>
    <ssd:ElementGeometry x1="0" y1="0" x2="100" y2="50" iconSource="resources/icon.svg"/>
    <ssd:ParameterBindings>
      <ssd:ParameterBinding source="resources/numbers.ssv">
        <ssd:ParameterMapping source="resources/names.ssm"/>
        <ssd:Annotations><ssc:Annotation type="t"><oms:why because="x"/></ssc:Annotation></ssd:Annotations>
      </ssd:ParameterBinding>
      <ssd:ParameterBinding prefix="a.">
        <ssd:ParameterValues><ssv:ParameterSet version="1.0" name="in line"><ssv:Parameters>
          <ssv:Parameter name="gain" description="measured"><ssv:Real value="2.50" unit="1"/></ssv:Parameter>
        </ssv:Parameters></ssv:ParameterSet></ssd:ParameterValues>
        <ssd:ParameterMapping><ssm:ParameterMapping version="1.0">
          <ssm:MappingEntry source="a.gain" target="a.gain"><ssc:LinearTransformation factor="3"/></ssm:MappingEntry>
        </ssm:ParameterMapping></ssd:ParameterMapping>
      </ssd:ParameterBinding>
    </ssd:ParameterBindings>
    <ssd:Elements>
      <ssd:Component name="a" source="resources/a%20part.fmu" implementation="CoSimulation" description="first">
        <ssd:Connectors>
          <ssd:Connector name="u" kind="input"><ssc:Real unit="m/s"/></ssd:Connector>
          <ssd:Connector name="y" kind="output"/>
          <ssd:Connector name="mode" kind="output"><ssc:Enumeration name="Mode"/></ssd:Connector>
          <ssd:Connector name="gain" kind="parameter"/>
        </ssd:Connectors>
        <ssd:ElementGeometry x1="1" y1="2" x2="3" y2="4" rotation="90" iconFlip="true"/>
        <ssd:Annotations><ssc:Annotation type="com.opensimulationplatform">
          <osp:StepSizeHint xmlns:osp="https://opensimulationplatform.com/SSP/OSPAnnotations" value="0.2"/>
        </ssc:Annotation></ssd:Annotations>
      </ssd:Component>
      <ssd:SignalDictionaryReference name="bus" dictionary="signals">
        <ssd:Connectors><ssd:Connector name="speed" kind="inout"><ssc:Real unit="m/s"/></ssd:Connector></ssd:Connectors>
      </ssd:SignalDictionaryReference>
      <ssd:System name="inner">
        <ssd:Connectors><ssd:Connector name="in" kind="input"/></ssd:Connectors>
        <ssd:Elements>
          <ssd:Component name="b" source="resources/a%20part.fmu">
            <ssd:Connectors><ssd:Connector name="u" kind="input"/></ssd:Connectors>
          </ssd:Component>
        </ssd:Elements>
        <ssd:Connections>
          <ssd:Connection startConnector="in" endElement="b" endConnector="u">
            <ssd:ConnectionGeometry pointsX="1 2" pointsY="3 4"/>
          </ssd:Connection>
        </ssd:Connections>
        <ssd:SystemGeometry x1="0" y1="0" x2="9" y2="9"/>
      </ssd:System>
    </ssd:Elements>
    <ssd:Connections>
      <ssd:Connection startConnector="u" endElement="a" endConnector="u" suppressUnitConversion="false"/>
      <ssd:Connection startElement="a" startConnector="y" endElement="bus" endConnector="speed">
        <ssc:LinearTransformation factor="2.0" offset="1"/>
      </ssd:Connection>
      <ssd:Connection startElement="bus" startConnector="speed" endElement="inner" endConnector="in"/>
      <ssd:Connection startElement="a" startConnector="mode" endConnector="mode">
        <ssc:EnumerationMappingTransformation><ssc:MapEntry source="on" target="off"/>
        </ssc:EnumerationMappingTransformation>
      </ssd:Connection>
    </ssd:Connections>
    <ssd:SignalDictionaries>
      <ssd:SignalDictionary name="signals"><ssb:SignalDictionary version="1.0">
        <ssb:DictionaryEntry name="speed"><ssc:Real unit="m/s"/></ssb:DictionaryEntry>
      </ssb:SignalDictionary></ssd:SignalDictionary>
    </ssd:SignalDictionaries>
    <ssd:GraphicalElements><ssd:Note x1="0" y1="0" x2="1" y2="1" text="a &lt; b"/></ssd:GraphicalElements>
    <ssd:Annotations>
      <ssc:Annotation type="org.unknown"><!-- kept too -->
        <thing xmlns="urn:unknown" oms:mark="1">text<plain xmlns="">  inside </plain> tail</thing>
      </ssc:Annotation>
    </ssd:Annotations>
  </ssd:System>
  <ssd:Enumerations>
    <ssc:Enumeration name="Mode"><ssc:Item name="off" value="1"/><ssc:Item name="on" value="2"/></ssc:Enumeration>
  </ssd:Enumerations>
  <ssd:Units>
    <ssc:Unit name="kn"><ssc:BaseUnit m="1" s="-1" factor="0.5144444444444445"/></ssc:Unit>
    <ssc:Unit name="km"><ssc:BaseUnit m="1" factor="1000"/></ssc:Unit>
  </ssd:Units>
  <ssd:DefaultExperiment startTime="0.50" stopTime="1e2">
    <ssd:Annotations><ssc:Annotation type="com.opensimulationplatform">
      <o:Algorithm xmlns:o="https://opensimulationplatform.com/SSP/OSPAnnotations">
        <o:FixedStepAlgorithm baseStepSize="0.1"/></o:Algorithm>
    </ssc:Annotation></ssd:Annotations>
  </ssd:DefaultExperiment>
</ssd:SystemStructureDescription>
"""
ITEMS = '<Item name="off" value="1"/><Item name="on" value="2"/>'
MODE = f'<SimpleType name="Mode"><Enumeration>{ITEMS}</Enumeration></SimpleType>'


def meaning(data):
    """What an XML file says, apart from prefixes and blanks between elements."""
    return [said(node) for node in etree.fromstring(data).getroottree().xpath("/node()")]


def said(element):
    text = [(part or "") if (part or "").strip() else "" for part in (element.text, element.tail)]
    return element.tag, sorted(element.attrib.items()), *text, [said(part) for part in element]


@pytest.fixture
def rich(shop, real):
    """A system with everything that SSP has, and files that nobody refers to."""
    fmu = shop.fmu(
        "a part",
        "input u Real m/s",
        "output y Real m/s",
        "output mode Enumeration declaredType=Mode",
        "parameter gain Real 1",
        types=MODE,
    )
    assert fmu.exists()
    shop.ssv(real("w", "1", "km"))
    shop.ssm('<ssm:MappingEntry source="w" target="weight"/>')
    (shop.folder / "resources/icon.svg").write_bytes(b"<svg/>\r\n")
    (shop.folder / "extra").mkdir()
    (shop.folder / "extra/notes.txt").write_text("kept")
    (shop.folder / "Variant.ssd").write_text(
        RICH.replace('name="rich"', 'name="variant"'), encoding="utf-8"
    )
    (shop.folder / "SystemStructure.ssd").write_text(RICH, encoding="utf-8")
    return shop


def files(path):
    if path.is_dir():
        return {
            f.relative_to(path).as_posix(): f.read_bytes() for f in path.rglob("*") if f.is_file()
        }
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def renamed(text):
    """The same SSD as tools write it that take a default namespace and prefixes of their own."""
    for prefix, other in (("ssc", "common"), ("ssv", "v"), ("ssm", "ns3"), ("ssb", "ssd1")):
        text = re.sub(rf"(</?|xmlns:){prefix}\b", rf"\g<1>{other}", text)
    return re.sub(r"(</?)ssd:", r"\1", text).replace("xmlns:ssd=", "xmlns=")


def of_version_2(text):
    """The same as SSP 2.0, which allows more types."""
    text = text.replace('version="1.0" name="rich"', 'version="2.0" name="rich"')
    return text.replace(
        '<ssd:Connector name="y" kind="output"/>',
        '<ssd:Connector name="y" kind="output"><ssc:Float64/></ssd:Connector>',
    )


@pytest.mark.parametrize("target", ["new.ssp", "new"])
@pytest.mark.parametrize("written_by", [str, renamed, of_version_2])
def test_read_and_written_again_is_the_same(rich, tmp_path, target, written_by):
    (rich.folder / "SystemStructure.ssd").write_text(written_by(RICH), encoding="utf-8")
    assert [problem for problem in read(rich.folder).check() if problem.severity == "error"] == []
    read(rich.folder).write(tmp_path / target)
    before, after = files(rich.folder), files(tmp_path / target)
    assert meaning(after.pop("SystemStructure.ssd")) == meaning(before.pop("SystemStructure.ssd"))
    assert after == before


def test_the_comparison_sees_a_difference_and_no_prefixes():
    assert meaning(renamed(RICH).encode()) == meaning(RICH.encode()) and "<ssd:" not in renamed(
        RICH
    )
    for old, new_text in [
        ("inside ", "outside"),
        ("2.50", "2.5"),
        ("kept too", "lost"),
        ('x2="9"', 'x2="8"'),
    ]:
        assert meaning(RICH.replace(old, new_text).encode()) != meaning(RICH.encode())


def test_written_twice_gives_the_same_bytes(rich, tmp_path):
    read(rich.folder).write(tmp_path / "one.ssp")
    read(tmp_path / "one.ssp").write(tmp_path / "two.ssp")
    assert (tmp_path / "one.ssp").read_bytes() == (tmp_path / "two.ssp").read_bytes()


def test_the_system_as_it_runs_is_the_same(rich, tmp_path):
    read(rich.folder).write(tmp_path / "new.ssp")
    before, after = read_system(rich.folder), read_system(tmp_path / "new.ssp")
    for name, component in before.components.items():
        assert after.components[name].start == component.start
    strip = [
        [(c.source, c.target, c.factor, c.offset, c.mapping) for c in s.connections]
        for s in (before, after)
    ]
    assert strip[0] == strip[1] and after.experiment == before.experiment


def test_prefixes_are_those_that_libcosim_knows(rich, tmp_path):
    (rich.folder / "SystemStructure.ssd").write_text(renamed(RICH), encoding="utf-8")
    read(rich.folder).write(tmp_path / "new")
    text = (tmp_path / "new/SystemStructure.ssd").read_text(encoding="utf-8")
    head, _, body = text.partition("<ssd:System ")
    assert all(f"xmlns:{prefix}=" in head for prefix in ("ssd", "ssc", "ssv", "osp"))
    assert "<osp:Algorithm>" in body and "xmlns:osp" not in body and "<ssv:Parameter " in body


def test_a_variant_is_written_beside_the_others(rich, tmp_path):
    pack(rich.folder, (), tmp_path / "both.ssp")
    system = read(f"{tmp_path / 'both.ssp'}#Variant.ssd")
    assert system.name == "variant"
    system.stop_time = 7.0
    system.write(tmp_path / "new.ssp")
    assert read(f"{tmp_path / 'new.ssp'}#Variant.ssd").stop_time == 7.0
    assert read(tmp_path / "new.ssp").stop_time == 100.0


def test_a_single_ssd_takes_along_what_it_refers_to_and_nothing_else(rich, tmp_path):
    read(rich.folder / "SystemStructure.ssd").write(tmp_path / "other" / "mine.ssd")
    found = set(files(tmp_path / "other"))
    assert found == {
        "mine.ssd",
        "resources/a part.fmu",
        "resources/numbers.ssv",
        "resources/names.ssm",
    }
    assert meaning((tmp_path / "other/mine.ssd").read_bytes()) == meaning(RICH.encode())


@pytest.mark.parametrize("name", ["gunnerus_dp", "gunnerus_open"])
def test_our_own_systems_come_back_the_same(root, tmp_path, name):
    folder = root / "ssp" / name
    fmus = root / "build" / "fmus"
    if not fmus.is_dir():
        pytest.skip("needs build/fmus: run `shipcosim build`")
    read(folder).write(tmp_path / "new", fmus=False)
    before, after = files(folder), files(tmp_path / "new")
    assert meaning(after.pop("SystemStructure.ssd")) == meaning(before.pop("SystemStructure.ssd"))
    assert after == before


SOURCES = {
    "ramp": '''
        class Ramp(Fmu):
            """Rises at a rate."""

            height = Output("m", "height")
            rate = Parameter(1.0, "m/s", "rate")
            bottom = Parameter(0.0, "m", "height at the start")

            def start(self):
                self.height = self.bottom

            def step(self, t, h):
                self.height += h * self.rate
        ''',
    "gain": '''
        class Gain(Fmu):
            """Multiplies."""

            level = Input("m", "what it multiplies")
            result = Output("m", "factor times level")
            factor = Parameter(1.0, "1", "factor")

            def start(self):
                self.result = self.factor * self.level

            def step(self, t, h):
                self.start()
        ''',
}


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Folder with two FMUs that run."""
    folder = tmp_path_factory.mktemp("built")
    for name, text in SOURCES.items():
        source = tmp_path_factory.mktemp("source") / f"{name}.py"
        head = "from shipcosim.fmi import Fmu, Input, Output, Parameter\n\n\n"
        source.write_text(head + textwrap.dedent(text))
        build_fmu(source, folder)
    return folder


def in_libcosim(path, n_steps=5):
    """Outputs of ramp and gain after some steps, as libcosim has them, its step from the file."""
    execution_module = pytest.importorskip(
        "libcosimpy.CosimExecution", reason="needs libcosim", exc_type=ImportError
    )
    from libcosimpy.CosimObserver import CosimObserver

    execution = execution_module.CosimExecution.from_ssp_file(ssp_path=str(path))
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    for _ in range(n_steps):
        assert execution.step()
    system = read_system(path)
    values = {}
    for name, output in (("ramp", "height"), ("gain", "result")):
        component = next(
            part for part in system.components.values() if output in part.fmu.variables
        )
        index = execution.slave_index_from_instance_name(component.name)
        reference = component.fmu.variables[output].value_reference
        values[name] = observer.last_real_values(index, [reference])[0]
    return values


def valid(path):
    """Whether SSD and SSVs of an .ssp are valid against the schemas."""
    findings = Findings()
    for name, data in files(path).items():
        if name.endswith((".ssd", ".ssv")):
            validate(etree.fromstring(data), name[-3:], name, findings)
    return findings.problems == []


def assembled(built):
    system = new("small")
    system.add_component("ramp", built / "ramp.fmu")
    system.add_component("gain", built / "gain.fmu")
    system.connect("gain.level", "ramp.height", factor=2.0, offset=0.5)
    system.parameters.update({"ramp.rate": 3.0, "ramp.bottom": 10.0, "gain.factor": -1.0})
    system.step_size, system.stop_time = 0.1, 1.0
    return system


def test_a_new_system_validates_and_runs_in_libcosim(built, tmp_path):
    """Height 10 + 3 t at 0.5 s; the gain has the height one step earlier, 2 h + 0.5 of it, times -1."""
    assembled(built).write(tmp_path / "small.ssp")
    assert valid(tmp_path / "small.ssp")
    values = in_libcosim(tmp_path / "small.ssp")
    assert values["ramp"] == pytest.approx(11.5, rel=1e-12)
    assert values["gain"] == pytest.approx(-(2.0 * 11.2 + 0.5), rel=1e-12)


def test_a_changed_system_of_another_tools_prefixes_runs_in_libcosim(built, tmp_path):
    assembled(built).write(tmp_path / "small")
    ssd = tmp_path / "small/SystemStructure.ssd"
    ssd.write_text(renamed(ssd.read_text(encoding="utf-8")), encoding="utf-8")
    system = read(tmp_path / "small")
    system.rename("ramp", "tide")
    system.parameters["tide.rate"] = 4.0
    system.disconnect("tide.height", "gain.level")
    system.connect("tide.height", "gain.level")
    system.step_size = 0.2
    system.write(tmp_path / "changed.ssp")
    assert valid(tmp_path / "changed.ssp")
    values = in_libcosim(tmp_path / "changed.ssp")
    assert values["ramp"] == pytest.approx(10.0 + 4.0 * 1.0, rel=1e-12)
    assert values["gain"] == pytest.approx(-(10.0 + 4.0 * 0.8), rel=1e-12)


def test_values_of_a_systems_sets_reach_libcosim_once_they_are_bound_to_components(built, tmp_path):
    system = assembled(built)
    write_ssv(
        tmp_path / "fast.ssv",
        "fast",
        [parameter("ramp.rate", 3600.0, "m/h"), parameter("gain.factor", 5.0)],
    )
    system.bind(tmp_path / "fast.ssv")
    assert (system.parameters["ramp.rate"], system.parameters["gain.factor"]) == (1.0, 5.0)
    before = system.checked()
    system.bind_to_components()
    assert {n: c.start for n, c in system.components.items()} == {
        n: c.start for n, c in before.components.items()
    }
    system.write(tmp_path / "bound.ssp")
    assert valid(tmp_path / "bound.ssp")
    assert in_libcosim(tmp_path / "bound.ssp")["ramp"] == pytest.approx(10.5, rel=1e-12)
