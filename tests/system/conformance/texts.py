"""XML files of a case made of what a case says of them: outermost element, namespaces, version."""

import re
from pathlib import Path

NAMES = {
    "ssd": "SystemStructureDescription",
    "ssc": "SystemStructureCommon",
    "ssv": "SystemStructureParameterValues",
    "ssm": "SystemStructureParameterMapping",
    "ssb": "SystemStructureSignalDictionary",
}
SPACES = " ".join(
    f'xmlns:{prefix}="http://ssp-standard.org/SSP1/{name}"' for prefix, name in NAMES.items()
)
SPACES += ' xmlns:osp="https://opensimulationplatform.com/SSP/OSPAnnotations"'
DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>\n'
ROOTS = {
    ".ssd": ("ssd:SystemStructureDescription", ' name="case"'),
    ".ssv": ("ssv:ParameterSet", ' name="numbers"'),
    ".ssm": ("ssm:ParameterMapping", ""),
    ".ssb": ("ssb:SignalDictionary", ""),
}


def document(name, text, version):
    """The file of this name, unless the text is a whole one already."""
    tag, attributes = ROOTS.get(Path(name).suffix, ("", ""))
    if not tag or text.lstrip().startswith("<?xml"):
        return text
    if Path(name).suffix == ".ssd" and not text.lstrip().startswith('<ssd:System name="case">'):
        text = f'<ssd:System name="case">\n{text.strip()}\n</ssd:System>'
    text = re.sub(r'version="1\.0"', f'version="{version}"', text)
    return (
        f'{DECLARATION}<{tag} version="{version}"{attributes} {SPACES}>\n{text.strip()}\n</{tag}>\n'
    )


def with_other_prefixes(text):
    """The same as tools write it that have a default namespace and prefixes of their own."""
    for prefix, other in (("ssc", "common"), ("ssv", "v"), ("ssm", "ns3"), ("ssb", "ssd1")):
        text = re.sub(rf"(</?|xmlns:){prefix}\b", rf"\g<1>{other}", text)
    return re.sub(r"(</?)ssd:", r"\1", text).replace("xmlns:ssd=", "xmlns=")
