"""XML read safely: no entities, no network, every finding with file and line."""

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import lxml.etree as etree

from shipcosim.errors import AnyPath, Problem

NAMESPACES = {
    prefix: f"http://ssp-standard.org/SSP1/SystemStructure{name}"
    for prefix, name in {
        "ssd": "Description",
        "ssc": "Common",
        "ssv": "ParameterValues",
        "ssm": "ParameterMapping",
        "ssb": "SignalDictionary",
    }.items()
}
REMEDIES = {
    "is not a Boolean": "Write true or false.",
    "is not a whole number": "Write a whole number, e.g. 3.",
    "number": "Write a number with a decimal point, e.g. 1.5.",
    "is not allowed": "Correct its name or remove it.",
    "is required but missing": "Add it.",
    "unique": "Names must differ.",
    "is not expected": "Remove it.",
    "is invalid": "Correct it.",
}
"""Remedy by a part of the message."""
MOST_PREFIXES = 10
UNDECLARED = "Namespace prefix"
LARGEST_FILE = 64 * 2**20  # bytes; the largest model descriptions in the wild are a few MB


class Findings:
    """Problems collected so far, so that a user sees all of them at once."""

    def __init__(self):
        self.problems: list[Problem] = []
        self._errors = list[Problem]()
        self._looked_at = 0
        self.refused_lines: set[str] = (
            set()
        )  # by a schema: what else is wrong with a value there has been said

    def error(self, where: str, found: str, remedy: str = "") -> None:
        """Add an error: it makes the input unusable.

        Parameters
        ----------
        where, found, remedy : str
            As in Problem.
        """
        self.problems.append(Problem(where, found, remedy))

    def remark(self, where: str, found: str, remedy: str = "") -> None:
        """Add a remark: a user should know it, but it stops nothing.

        Parameters
        ----------
        where, found, remedy : str
            As in Problem.
        """
        self.problems.append(Problem(where, found, remedy, severity="remark"))

    def flaw(self, where: str, found: str, remedy: str = "") -> None:
        """Add a flaw: a deviation with one possible meaning, an error only with `--strict`.

        Parameters
        ----------
        where, found, remedy : str
            As in Problem; `found` says what it is taken for.
        """
        self.problems.append(Problem(where, found, remedy, severity="remark", flaw=True))

    def back_to(self, count: int) -> None:
        """Forget all but the first problems."""
        del self.problems[count:]
        self._errors = []
        self._looked_at = 0

    @property
    def errors(self) -> list[Problem]:
        """Problems that make the input unusable."""
        # Only problems added since the last call: the list can be long.
        self._errors += [
            problem for problem in self.problems[self._looked_at :] if problem.is_error
        ]
        self._looked_at = len(self.problems)
        return self._errors

    @property
    def remarks(self) -> list[Problem]:
        """Problems that stop nothing."""
        return [problem for problem in self.problems if not problem.is_error]


@dataclass
class Document:
    """An XML file or the inline part of one.

    Parameters
    ----------
    file : str
        Name as the user knows it, also for what lies inside an archive.
    root : lxml element
        Its outermost element.
    folder : Path
        Folder that relative addresses in it start from.
    flaws : list of Problem
        Flaws of its form that were corrected in the tree, which reading it says again.
    mended : bool
        Whether they were looked for: what is changed here has none.
    """

    file: str
    root: etree._Element
    folder: Path = Path()
    flaws: list[Problem] = field(default_factory=list, compare=False)
    mended: bool = field(default=False, compare=False)

    def place(self, element: etree._Element, what: str = "") -> str:
        """Place of an element, for the user to look it up."""
        line = (
            f", line {element.sourceline}" if element.sourceline else ""
        )  # none where it was made in memory
        return f"{self.file}{line}" + (f": {what}" if what else "")


@contextmanager
def reporting(
    document: Document, element: etree._Element, findings: Findings, what: str = ""
) -> Iterator[None]:
    """Turn a ValueError within a ``with`` block into an error of the file.

    Parameters
    ----------
    document : Document
        The file.
    element : lxml element
        What is read.
    findings : Findings
        Takes what is wrong.
    what : str
        What of it, for messages.
    """
    try:
        yield
    except ValueError as error:
        # The schema may have refused this line already: report it once.
        if document.place(element) not in findings.refused_lines:
            findings.error(document.place(element, what), str(error), remedy_for(str(error)))


def remedy_for(found: str) -> str:
    """Remedy for a value of the wrong form.

    Examples
    --------
    >>> remedy_for("'2,0' is not a number.")
    'Write a number with a decimal point, e.g. 1.5.'
    """
    return next((remedy for part, remedy in REMEDIES.items() if part in found), "Correct it.")


def qualified(tag: str) -> str:
    """Tag in lxml's notation from one with our prefix: ``ssd:System``."""
    prefix, name = tag.split(":")
    return f"{{{NAMESPACES[prefix]}}}{name}"


def child(element: etree._Element, tag: str) -> etree._Element | None:
    """First child of this tag, whatever prefix the file uses, or None."""
    return element.find(qualified(tag))


def children(element: etree._Element, *path: str) -> list[etree._Element]:
    """Children of the last tag of a path, ``"ssd:Connectors", "ssd:Connector"``; may be empty."""
    return element.findall("/".join(qualified(tag) for tag in path))


def local(element: etree._Element) -> str:
    """Name of an element without its namespace; empty for comments and the like."""
    tag = element.tag
    return tag.rpartition("}")[2] if isinstance(tag, str) else ""


def parts_in(element: Iterable[etree._Element], *names: str) -> list[etree._Element]:
    """Parts of an element with one of some local names, all without names; comments left out."""
    return [part for part in element if (local(part) in names if names else local(part))]


def parts_of(root: etree._Element, name: str) -> list[etree._Element]:
    """Elements within all children of a local name, whatever their namespace; comments left out."""
    return [part for group in parts_in(root, name) for part in parts_in(group)]


def parent_of(element: etree._Element) -> etree._Element:
    """Element that an element lies in.

    Raises
    ------
    ValueError
        If it is the outermost one.
    """
    parent = element.getparent()
    if parent is None:
        raise ValueError(f"<{local(element)}> is the outermost element")
    return parent


def is_true(text: str | None) -> bool:
    """Truth of an xs:boolean attribute; a missing one is false."""
    return (text or "").strip() in ("true", "1")


def parse(
    data: bytes, file: str, findings: Findings, *, utf8: bool = True
) -> etree._Element | None:
    """Root element of an XML text.

    Parameters
    ----------
    data : bytes
        The text.
    file : str
        Name for messages.
    findings : Findings
        Takes what is wrong.
    utf8 : bool
        Insist on UTF-8, as the SSP standard does.

    Returns
    -------
    lxml element, or None where there is no usable one.
    """
    # Limit the size before anything is parsed.
    if len(data) > LARGEST_FILE:
        findings.error(
            file, "The file is too large.", f"At most {LARGEST_FILE >> 20} MiB are read."
        )
        return None
    if utf8 and not _is_utf8(data):
        findings.error(
            file, "The file is not UTF-8.", "SSP files must be: save it with this encoding."
        )
        return None
    # No entities, no network, no DTD: a file must not read other files.
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False
    )
    try:
        root = etree.fromstring(data, parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        # The parser names the line in its message; put it where our messages have it.
        line = getattr(error, "lineno", None)
        text = re.sub(r", line \d+, column \d+.*", "", str(error), flags=re.DOTALL)
        findings.error(
            f"{file}, line {line}" if line else file,
            f"Not well-formed XML: {text}.",
            "Correct the file, or export it again.",
        )
        return None
    # Entities could expand without limit.
    if root.getroottree().docinfo.internalDTD is not None:
        findings.error(
            file,
            "The file has a document type declaration.",
            "Remove <!DOCTYPE ...> and its entities.",
        )
        return None
    return root


def read_document(path: AnyPath, shown: str, findings: Findings) -> Document | None:
    """Document of a file on disk, or None with an error.

    Parameters
    ----------
    path : path
        The file; relative addresses in it start from its folder.
    shown : str
        Its name in messages.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    Document or None
    """
    path = Path(path)
    try:
        # One byte more than allowed shows that the file is too large.
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except OSError as error:
        findings.error(shown, f"Cannot be read: {error.strerror}.")
        return None
    return parsed(data, shown, findings, path.parent)


def parsed(data: bytes, shown: str, findings: Findings, folder: Path = Path()) -> Document | None:
    """Document of an XML text of SSP or OSP, or None with an error.

    Parameters
    ----------
    data : bytes
        The text.
    shown : str
        Its name in messages.
    findings : Findings
        Takes what is wrong.
    folder : Path
        Folder that relative addresses in it start from.
    """
    # First as it is; undeclared prefixes are the one error that can be repaired in the text.
    flaws = Findings()
    tried = Findings()
    root = parse(data, shown, tried)
    if any(UNDECLARED in problem.found for problem in tried.problems):
        root = parse(with_prefixes(data, shown, flaws), shown, findings)
    else:
        findings.problems += tried.problems
    findings.problems += flaws.problems
    return None if root is None else Document(shown, root, folder, flaws.problems)


def with_prefixes(data: bytes, shown: str, findings: Findings) -> bytes:
    """Declare every undeclared prefix; those of SSP have their usual meaning."""
    # Prefixes in use, outside comments.
    first, *others = data.split(b"<!--")
    text = b"".join(
        [first, *(part.partition(b"-->")[2] for part in others)]
    )  # prefixes in comments are none
    used = set(re.findall(rb"</?([A-Za-z_][\w.-]{0,30}):[A-Za-z_]", text))
    missing = sorted(prefix for prefix in used - {b"xml"} if b"xmlns:" + prefix not in text)
    # Add the missing declarations to the outermost element.
    start = re.search(rb"<[A-Za-z_][^\s/>]*", data)
    if not missing or start is None or len(missing) > MOST_PREFIXES:
        return data
    spaces = {p: NAMESPACES.get(p.decode(), f"urn:undeclared:{p.decode()}") for p in missing}
    listed = ", ".join(f"'{prefix.decode()}'" for prefix in missing)
    declarations = ", ".join(
        f'xmlns:{prefix.decode()}="{uri}"' for prefix, uri in spaces.items() if "urn:" not in uri
    )
    line = data[: start.start()].count(b"\n") + 1
    findings.flaw(
        f"{shown}, line {line}",
        f"Prefixes that are not declared: {listed}. Those of SSP have their usual meaning, others are unknown.",
        f"Add {declarations} to the outermost element." if declarations else "Declare them.",
    )
    declared = b"".join(
        b' xmlns:%s="%s"' % (prefix, uri.encode()) for prefix, uri in spaces.items()
    )
    return data[: start.end()] + declared + data[start.end() :]


def _is_utf8(data: bytes) -> bool:
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return not re.match(rb"""<\?xml[^>]*encoding\s*=\s*["'](?!utf-?8)""", data, re.IGNORECASE)
