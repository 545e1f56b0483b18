"""A small craft with inputs of all kinds, as a page."""

import pytest

from shipcosim.fmi.export.builder import build_fmu
from shipcosim.report.live.export import export_page
from shipcosim.scenario import read_scenario
from shipcosim.ssp import read_fmu, read_system

CRAFT = '''
from shipcosim.fmi import Fmu, Input, Output, Parameter


class Craft(Fmu):
    """Goes where she is wanted."""

    push = Input("m/s", "how <b>fast</b> & 'far' \\"north\\" ⚓ </script><script>window.hacked = 1</script>", maximum=5.0)
    turn = Input("rad/s", "how fast she turns")
    engaged = Input("1", "the clutch is in", start=True)
    failed = Input("1", "nothing works", start=False)
    gear = Input("1", "gear", start=1, minimum=-2, maximum=3)
    x_set = Input("m", "north position to go to")
    y_set = Input("m", "east position to go to", maximum=1000.0)
    psi_set = Input("rad", "heading to go to")
    x = Output("m", "north position")
    y = Output("m", "east position")
    psi = Output("rad", "heading")
    position_1_valid = Output("1", "reference 1 works", start=True)
    position_1_rejected = Output("1", "reference 1 is not believed", start=False)
    bus_a_load = Output("W", "power of bus a")
    shaft_faulty = Output("1", "the shaft <i>slips</i>", start=False)
    factor = Parameter(1.0, "1", "factor of the speed", tunable=True)
    x_start = Parameter(0.0, "m", "position at the start")
    seed = Parameter(3, "1", "a whole number")

    def start(self):
        self.x = self.x_start

    def step(self, t, h):
        on = self.engaged * (1 - self.failed)
        self.x += h * on * (self.factor * self.push * self.gear + 0.1 * (self.x_set - self.x))
        self.y += h * (0.001 * self.seed + 0.1 * on * (self.y_set - self.y))
        self.psi += h * (self.turn + 0.1 * on * (self.psi_set - self.psi))
        self.position_1_valid = self.y < 50.0
        self.position_1_rejected = self.y > 20.0
        self.bus_a_load = 1000.0 * self.gear
        self.shaft_faulty = self.gear > 2
'''
PILOT = '''
from shipcosim.fmi import Fmu, Input, Output


class Pilot(Fmu):
    """Turns her; it acts seldom."""

    psi = Input("rad", "heading")
    wanted = Input("rad", "heading to go to")
    turn = Output("rad/s", "how fast she shall turn")

    def step(self, t, h):
        self.turn = 0.05 * (self.wanted - self.psi)
'''
SYSTEM = """<ssd:SystemStructureDescription name="craft" version="1.0"
 xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
 xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"><ssd:System name="craft"><ssd:Connectors>
<ssd:Connector name="wish" kind="input"><ssc:Real unit="rad"/></ssd:Connector>
<ssd:Connector name="speed" kind="input"><ssc:Real unit="m/s"/></ssd:Connector>
<ssd:Connector name="gear" kind="input"><ssc:Integer/></ssd:Connector>
</ssd:Connectors><ssd:Elements>{}</ssd:Elements><ssd:Connections>
<ssd:Connection startElement="craft" startConnector="psi" endElement="pilot" endConnector="psi"/>
<ssd:Connection startElement="pilot" startConnector="turn" endElement="craft" endConnector="turn"/>
<ssd:Connection startConnector="wish" endElement="pilot" endConnector="wanted"/>
<ssd:Connection startConnector="speed" endElement="craft" endConnector="push"/>
<ssd:Connection startConnector="gear" endElement="craft" endConnector="gear"/>
</ssd:Connections></ssd:System></ssd:SystemStructureDescription>"""
SELDOM = """<ssd:Annotations><ssc:Annotation type="com.opensimulationplatform"><osp:StepSizeHint
 xmlns:osp="https://opensimulationplatform.com/SSP" value="0.5"/></ssc:Annotation></ssd:Annotations>"""
SCENARIO = """
description = "Odd \\"craft\\" <b>&</b> ⚓ </script>"
system = "craft"
stop_time = 30.0
step_size = 0.1
output_interval = 0.5

[set]
"craft.x_start" = "0.1 km"
"craft.seed" = 3

[[events]]
time = 2.0
override = { "speed" = 1.5, "gear" = 1, "wish" = "30 deg" }

[[events]]
time = 5.1
bias = { "speed" = 0.5 }

[[events]]
time = 7.0
override = { "gear" = 2, "craft.engaged" = false, "craft.factor" = 2.0 }

[[events]]
time = 9.0
reset = ["craft.engaged", "speed"]
"""


def _component(folder, name, annotation=""):
    connectors = "".join(
        f'<ssd:Connector name="{v.name}" kind="{v.causality}"><ssc:{v.type}/></ssd:Connector>'
        for v in read_fmu(folder / f"{name}.fmu").variables.values()
    )
    return (
        f'<ssd:Component name="{name}" source="resources/{name}.fmu">'
        f"<ssd:Connectors>{connectors}</ssd:Connectors>{annotation}</ssd:Component>"
    )


@pytest.fixture(scope="session")
def craft_project(tmp_path_factory):
    """A project with the craft's system, and her page, craft.html."""
    project = tmp_path_factory.mktemp("craft")
    resources = project / "ssp" / "craft" / "resources"
    resources.mkdir(parents=True)
    for name, source in {"craft": CRAFT, "pilot": PILOT}.items():
        file = project / f"{name}.py"
        file.write_text(source, encoding="utf-8")
        build_fmu(file, resources)
    parts = _component(resources, "craft") + _component(resources, "pilot", SELDOM)
    (resources.parent / "SystemStructure.ssd").write_text(SYSTEM.format(parts), encoding="utf-8")
    file = project / "scenarios" / "odd.toml"
    file.parent.mkdir()
    file.write_text(SCENARIO, encoding="utf-8")
    scenario = read_scenario(file)
    export_page(read_system(resources.parent), scenario, project / "craft.html")
    return project


@pytest.fixture
def craft(craft_project, browse, monkeypatch):
    """The craft's page in a browser; scenarios that it saves find her system."""
    monkeypatch.chdir(craft_project)
    page = browse(craft_project / "craft.html")
    page.wait("return Boolean(window.desk && window.scene)")
    return page
