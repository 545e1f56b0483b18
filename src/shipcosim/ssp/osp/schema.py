"""Schema of OspSystemStructure.xml.

libcosim (tried: libcosimpy 0.0.6) checks a file against its own schema first and refuses what breaks it.
"""

from functools import cache
from pathlib import Path

import lxml.etree as etree

from shipcosim.ssp.xml.document import Document, Findings
from shipcosim.ssp.xml.schemas import names_in, report_schema

NAMESPACE = "http://opensimulationplatform.com/MSMI/OSPSystemStructure"
SCHEMA = Path(__file__).with_name("OspSystemStructure.xsd").read_text("utf-8")


def validate_osp(document: Document, findings: Findings) -> None:
    """Check a document's root against the schema, with an error for each place where it breaks it."""
    report_schema(_checker(), names_in(SCHEMA), document.root, document.file, findings)


@cache
def _checker() -> etree.XMLSchema:
    return etree.XMLSchema(etree.fromstring(SCHEMA))
