"""Schema of OspSystemStructure.xml.

libcosim (tried: libcosimpy 0.0.6) checks a file against its own schema first and refuses what breaks it.
"""

from functools import cache

import lxml.etree as etree

from shipcosim.ssp.xml.document import Document, Findings
from shipcosim.ssp.xml.schemas import names_in, report_schema

NAMESPACE = "http://opensimulationplatform.com/MSMI/OSPSystemStructure"

_VALUES = "".join(
    f'<xs:element name="{kind}"><xs:complexType>'
    f'<xs:attribute name="value" type="xs:{xml}" use="required"/></xs:complexType></xs:element>'
    for kind, xml in (
        ("Real", "double"),
        ("Integer", "int"),
        ("Boolean", "boolean"),
        ("String", "string"),
    )
)
_END = '<xs:attribute name="name" type="xs:string" use="required"/>'
_SIZES = (
    "SafetyFactor StepSize MinimumStepSize MaximumStepSize MinimumChangeRate MaximumChangeRate"
).split()
_GAINS = "ProportionalGain IntegralGain RelativeTolerance AbsoluteTolerance".split()


def _pair(tag: str, end: str) -> str:
    """Connection of two ends of one kind."""
    return f"""<xs:element name="{tag}"><xs:complexType>
      <xs:sequence><xs:element name="{end}" type="VariableEnd" minOccurs="2" maxOccurs="2"/></xs:sequence>
      <xs:attribute name="powerBond" type="xs:string"/></xs:complexType></xs:element>"""


def _mixed(tag: str, variable: str, signal: str) -> str:
    """Connection of a variable or group with a signal of a function, in any order."""
    return f"""<xs:element name="{tag}"><xs:complexType><xs:all>
      <xs:element name="{variable}" type="VariableEnd"/><xs:element name="{signal}" type="SignalEnd"/>
      </xs:all></xs:complexType></xs:element>"""


def _function(tag: str, *attributes: tuple[str, str, str]) -> str:
    more = "".join(f'<xs:attribute name="{n}" type="xs:{t}" {u}/>' for n, t, u in attributes)
    return f"""<xs:element name="{tag}" minOccurs="0" maxOccurs="unbounded">
      <xs:complexType>{_END}{more}</xs:complexType></xs:element>"""


def _count(name: str) -> tuple[str, str, str]:
    return name, "positiveInteger", 'use="required"'


SCHEMA = f"""<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema" xmlns="{NAMESPACE}"
    targetNamespace="{NAMESPACE}" elementFormDefault="qualified">
  <xs:complexType name="VariableEnd">{_END}<xs:attribute name="simulator" type="xs:string" use="required"/>
    <xs:attribute name="causality" type="xs:string"/></xs:complexType>
  <xs:complexType name="SignalEnd">{_END}
    <xs:attribute name="function" type="xs:string" use="required"/></xs:complexType>
  <xs:complexType name="Initial"><xs:choice>{_VALUES}</xs:choice>
    <xs:attribute name="variable" type="xs:string" use="required"/></xs:complexType>
  <xs:complexType name="Simulator"><xs:sequence>
    <xs:element name="InitialValues" minOccurs="0"><xs:complexType><xs:sequence>
      <xs:element name="InitialValue" type="Initial" minOccurs="0" maxOccurs="unbounded"/>
    </xs:sequence></xs:complexType></xs:element></xs:sequence>{_END}
    <xs:attribute name="source" type="xs:anyURI" use="required"/>
    <xs:attribute name="stepSize" type="xs:double"/></xs:complexType>
  <xs:element name="OspSystemStructure"><xs:complexType><xs:sequence>
    <xs:element name="StartTime" type="xs:double" minOccurs="0"/>
    <xs:element name="EndTime" type="xs:double" minOccurs="0"/>
    <xs:element name="BaseStepSize" type="xs:double" minOccurs="0"/>
    <xs:element name="Algorithm" type="xs:string" minOccurs="0"/>
    <xs:element name="Simulators"><xs:complexType><xs:sequence>
      <xs:element name="Simulator" type="Simulator" minOccurs="0" maxOccurs="unbounded"/>
    </xs:sequence></xs:complexType></xs:element>
    <xs:element name="Functions" minOccurs="0"><xs:complexType><xs:sequence>
      {_function("LinearTransformation", ("factor", "double", ""), ("offset", "double", ""))}
      {_function("Sum", _count("inputCount"))}
      {_function("VectorSum", _count("inputCount"), _count("dimension"))}
    </xs:sequence></xs:complexType></xs:element>
    <xs:element name="Connections" minOccurs="0"><xs:complexType><xs:choice minOccurs="0" maxOccurs="unbounded">
      {_pair("VariableConnection", "Variable")}{_pair("VariableGroupConnection", "VariableGroup")}
      {_mixed("SignalConnection", "Variable", "Signal")}
      {_mixed("SignalGroupConnection", "VariableGroup", "SignalGroup")}
    </xs:choice></xs:complexType></xs:element>
    <xs:element name="EccoConfiguration" minOccurs="0"><xs:complexType><xs:all>
      {"".join(f'<xs:element name="{name}" type="xs:double"/>' for name in (*_SIZES, *_GAINS))}
    </xs:all></xs:complexType></xs:element>
  </xs:sequence><xs:attribute name="version" type="xs:string" use="required" fixed="0.1"/></xs:complexType></xs:element>
</xs:schema>"""


def validate_osp(document: Document, findings: Findings) -> None:
    """Check a document's root against the schema, with an error for each place where it breaks it."""
    report_schema(_checker(), names_in(SCHEMA), document.root, document.file, findings)


@cache
def _checker() -> etree.XMLSchema:
    return etree.XMLSchema(etree.fromstring(SCHEMA))
