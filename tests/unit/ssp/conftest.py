"""Small systems for the tests: FMUs that are a model description alone, and SSDs around them."""

import zipfile
from xml.sax.saxutils import quoteattr

import pytest

from shipcosim.errors import ShipcosimError
from shipcosim.ssp import read_system

UNITS = """
<Unit name="m"><BaseUnit m="1"/></Unit><Unit name="s"><BaseUnit s="1"/></Unit>
<Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit>
<Unit name="kn"><BaseUnit m="1" s="-1" factor="0.5144444444444445"/></Unit>
<Unit name="rad"><BaseUnit rad="1"/></Unit><Unit name="deg"><BaseUnit rad="1" factor="0.017453292519943295"/></Unit>
<Unit name="K"><BaseUnit K="1"/></Unit><Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>
<Unit name="km"><BaseUnit m="1" factor="1000"/></Unit><Unit name="1"><BaseUnit/></Unit>
"""
SSD = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription version="1.0" name="test"
  xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
  xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
  xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
  xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping"
  xmlns:ssb="http://ssp-standard.org/SSP1/SystemStructureSignalDictionary">
<ssd:System name="test">{system}</ssd:System>
{rest}
</ssd:SystemStructureDescription>
"""
SSV = """<?xml version="1.0" encoding="UTF-8"?>
<ssv:ParameterSet version="1.0" name="numbers"
  xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
  xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon">
<ssv:Parameters>{parameters}</ssv:Parameters></ssv:ParameterSet>
"""
SSM = """<?xml version="1.0" encoding="UTF-8"?>
<ssm:ParameterMapping version="1.0"
  xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping"
  xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon">{entries}</ssm:ParameterMapping>
"""


class Workshop:
    """Makes files in a folder and reads the system made of them."""

    def __init__(self, folder):
        self.folder = folder
        (folder / "resources").mkdir()

    def fmu(self, name, *variables, types="", head=""):
        """FMU stand-in; a variable is ``"input u Real m/s"``: causality, name, type, unit; more as ``key=value``."""
        scalars = "".join(self._scalar(number, text) for number, text in enumerate(variables))
        text = (
            f'<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="{name}">'
            f'<CoSimulation modelIdentifier="{name}"/>'
            f"<UnitDefinitions>{UNITS}</UnitDefinitions>"
            + (f"<TypeDefinitions>{types}</TypeDefinitions>" if types else "")
            + f"<ModelVariables>{scalars}</ModelVariables><ModelStructure/></fmiModelDescription>"
        )
        path = self.folder / "resources" / f"{name}.fmu"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", text)
        return path

    def _scalar(self, number, text):
        causality, name, kind, *more = text.split()
        given = dict(part.split("=", 1) if "=" in part else ("unit", part) for part in more)
        if causality in ("input", "parameter"):
            given.setdefault(
                "start", {"Boolean": "false", "String": "", "Enumeration": "1"}.get(kind, "0")
            )
        variability = {"parameter": "fixed"}.get(
            causality, "continuous" if kind == "Real" else "discrete"
        )
        attributes = "".join(f" {key}={quoteattr(value)}" for key, value in given.items())
        return (
            f'<ScalarVariable name="{name}" valueReference="{number}" causality="{causality}"'
            f' variability="{variability}">'
            f"<{kind}{attributes}/></ScalarVariable>"
        )

    def component(self, name, fmu, *connectors, more=""):
        """Component element; a connector is ``"input u"``, with a type behind it as XML if wanted."""
        inner = ""
        for text in connectors:
            kind, connector, *typed = text.split(maxsplit=2)
            inner += (
                f'<ssd:Connector name="{connector}" kind="{kind}">{"".join(typed)}</ssd:Connector>'
            )
        listed = f"<ssd:Connectors>{inner}</ssd:Connectors>" if inner else ""
        return f'<ssd:Component name="{name}" source="resources/{fmu}.fmu">{listed}{more}</ssd:Component>\n'

    def connection(self, source, target, inside="", **attributes):
        """Connection element between ``"element.connector"``; a name without a dot is on the system itself."""
        ends = ""
        for end, text in (("start", source), ("end", target)):
            element, dot, connector = text.rpartition(".")
            ends += f' {end}Element="{element}"' * bool(dot) + f' {end}Connector="{connector}"'
        ends += "".join(f' {key}="{value}"' for key, value in attributes.items())
        return f"<ssd:Connection{ends}>{inside}</ssd:Connection>\n"

    def ssd(self, elements, connections="", head="", tail="", rest="", text=SSD):
        """SystemStructure.ssd of elements and connections."""
        joined = f"<ssd:Connections>{connections}</ssd:Connections>" if connections else ""
        system = f"{head}<ssd:Elements>{elements}</ssd:Elements>{joined}{tail}"
        self.path = self.folder / "SystemStructure.ssd"
        self.path.write_text(text.format(system=system, rest=rest), encoding="utf-8")
        return self.path

    def ssv(self, parameters, name="resources/numbers.ssv"):
        """SSV file of a text with its Parameter elements."""
        path = self.folder / name
        path.write_text(SSV.format(parameters=parameters), encoding="utf-8")
        return path

    def ssm(self, entries, name="resources/names.ssm"):
        """SSM file of a text with its MappingEntry elements."""
        (self.folder / name).write_text(SSM.format(entries=entries), encoding="utf-8")

    def read(self, *parameters, **options):
        """The system."""
        return read_system(self.folder, parameters, **options)

    def refused(self, *parameters, **options):
        """Message of the error that reading the system ends in."""
        with pytest.raises(ShipcosimError) as caught:
            self.read(*parameters, **options)
        return str(caught.value)


def real(name, value, unit=None):
    """Parameter element of a real value."""
    given = f' unit="{unit}"' if unit else ""
    return f'<ssv:Parameter name="{name}"><ssv:Real value="{value}"{given}/></ssv:Parameter>'


@pytest.fixture
def shop(tmp_path):
    """Workshop in a new folder."""
    folder = tmp_path / "system"
    folder.mkdir()
    return Workshop(folder)


@pytest.fixture(name="real")
def real_element():
    """The function `real`."""
    return real
