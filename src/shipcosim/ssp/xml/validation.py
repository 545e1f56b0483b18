"""Validation of elements against the schema of their version of SSP or FMI."""

import lxml.etree as etree

from shipcosim.ssp.xml.document import Findings
from shipcosim.ssp.xml.schemas import names_of, report_schema, schema_of
from shipcosim.ssp.xml.version_2 import validate_2


def validate(root: etree._Element, schema: str, file: str, findings: Findings) -> bool:
    """Check an element against a schema of FMPy, or SSP 2.0 as `shipcosim.ssp.xml.version_2` does.

    Parameters
    ----------
    root : lxml element
        Outermost element, also one inside another file.
    schema : str
        A key of SCHEMAS.
    file : str
        Name for messages.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    bool
        Whether there are no errors; flaws and remarks do not count.
    """
    before = len(findings.errors)
    if schema.startswith("ss") and root.get("version", "").startswith("2."):
        validate_2(root, schema, file, findings)
    else:
        report_schema(schema_of(schema), names_of(schema), root, file, findings)
    return len(findings.errors) == before
