"""Reader of FMUs: modelDescription.xml becomes an FmuDescription. No binary is loaded here.

Reference: FMI 1.0 for co-simulation and for model exchange, FMI 2.0.4 and FMI 3.0.1, section 2 of each.
"""

from functools import lru_cache
from math import inf, isfinite
from pathlib import Path

import lxml.etree as etree

from shipcosim.errors import Problem, ShipcosimError
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.fmu.fmi1 import interfaces_of
from shipcosim.ssp.fmu.variables import read_variables
from shipcosim.ssp.xml.archive import entries, read_entry
from shipcosim.ssp.xml.definitions import noted_units
from shipcosim.ssp.xml.document import (
    AnyPath,
    Document,
    Findings,
    local,
    parse,
    parts_in,
    parts_of,
)
from shipcosim.ssp.xml.validation import validate

MOST_KEPT = 64
"""FMUs whose descriptions are kept: systems are read again and again while they are edited."""
INTERFACES = ("CoSimulation", "ModelExchange", "ScheduledExecution")


def read_fmu(path: AnyPath) -> FmuDescription:
    """Read the description of an FMU without running any of it.

    Parameters
    ----------
    path : path
        The .fmu.

    Returns
    -------
    FmuDescription

    Raises
    ------
    ShipcosimError
        With everything that is wrong with it.
    """
    findings = Findings()
    fmu = describe_fmu(path, findings)
    if fmu is None or findings.errors:
        raise ShipcosimError(findings.errors)
    return fmu


def describe_fmu(
    path: AnyPath, findings: Findings, shown: str | None = None
) -> FmuDescription | None:
    """Description of an FMU, or None if it cannot be read; problems are collected.

    Parameters
    ----------
    path : path
        The .fmu.
    findings : Findings
        Takes what is wrong.
    shown : str, optional
        Its name in messages, where it is not `path`.
    """
    shown = shown or str(path)
    try:
        stat = Path(path).stat()
    except OSError:
        return _described(path, findings, shown)
    stamp = stat.st_dev, stat.st_ino, stat.st_mtime_ns, stat.st_ctime_ns, stat.st_size
    try:
        described, problems = _kept(str(path), shown, stamp)
    except ShipcosimError as error:
        findings.problems += error.problems
        return None
    findings.problems += problems
    return described


@lru_cache(MOST_KEPT)
def _kept(
    path: str, shown: str, stamp: tuple[int, ...]
) -> tuple[FmuDescription, tuple[Problem, ...]]:
    """Description of a file that has not changed since, and remarks; an error is not kept, as it may pass."""
    findings = Findings()
    described = _described(path, findings, shown)
    if described is None:
        raise ShipcosimError(findings.problems)
    return described, tuple(findings.problems)


def _described(path: AnyPath, findings: Findings, shown: str) -> FmuDescription | None:
    # The archive, and the description in it.
    try:
        data = read_entry(path, "modelDescription.xml", shown)
        names = entries(path, shown)
    except ShipcosimError as error:
        findings.problems += error.problems
        return None
    if data is None:
        findings.error(
            shown, "The archive has no modelDescription.xml.", "It is no FMU; export it again."
        )
        return None
    file = f"{shown}/modelDescription.xml"
    # The version decides which schema applies.
    root = parse(data, file, findings, utf8=False)
    if root is None or not _is_fmi(root, file, findings):
        return None
    version = root.get("fmiVersion", "")[:1]
    # A description that breaks its schema is refused.
    if not validate(root, f"fmi{version}", file, findings):
        return None  # a description that breaks its schema is not worth guessing at
    return _description(Document(file, root), Path(path), names, findings)


def _is_fmi(root: etree._Element, file: str, findings: Findings) -> bool:
    version = root.get("fmiVersion", "")
    if local(root) != "fmiModelDescription":
        findings.error(
            file,
            f"Its outermost element is <{local(root)}>.",
            "Right would be <fmiModelDescription>.",
        )
        return False
    if not version.startswith(("1.", "2.", "3.")):
        findings.error(
            file,
            f"FMI version '{version}'.",
            "Versions 1.0, 2.0 and 3.0 are read: export the FMU in one of them.",
        )
        return False
    return True


def _description(
    document: Document, path: Path, names: list[str], findings: Findings
) -> FmuDescription:
    root = document.root
    version = f"{root.get('fmiVersion', '')[:1]}.0"
    # Platforms are the folders in binaries/.
    platforms = {
        parts[1] for name in names if len(parts := name.split("/")) > 2 and parts[0] == "binaries"
    }
    # Number of continuous states: given in FMI 1.0, that of the listed derivatives in FMI 2.0.
    groups = [group for group in parts_of(root, "ModelStructure") if local(group) == "Derivatives"]
    derivatives = [part for group in groups for part in group]
    n_states = int(root.get("numberOfContinuousStates") or 0) or len(parts_in(derivatives))
    # FMI 3.0 lists its event indicators.
    listed = [local(part) for part in parts_of(root, "ModelStructure")]
    n_indicators = listed.count("EventIndicator")
    interfaces = (
        interfaces_of(root)
        if version == "1.0"
        else {local(part): dict(part.attrib) for part in root if local(part) in INTERFACES}
    )
    given = next((dict(part.attrib) for part in parts_in(root, "DefaultExperiment")), {})
    experiment = _experiment(document, given, findings)
    return FmuDescription(
        path=path,
        fmi_version=version,
        model_name=root.get("modelName", ""),
        token=root.get("guid") or root.get("instantiationToken", ""),
        variables=read_variables(document, findings),
        description=root.get("description", ""),
        generation_tool=root.get("generationTool", ""),
        interfaces=interfaces,
        units=noted_units(document, parts_of(root, "UnitDefinitions"), findings),
        platforms=tuple(sorted(platforms)),
        experiment=experiment,
        n_states=n_states,
        n_event_indicators=int(root.get("numberOfEventIndicators") or n_indicators),
    )


def _experiment(document: Document, given: dict[str, str], findings: Findings) -> dict[str, float]:
    """Numbers of the default experiment; those that no run can have are left out, and remarked."""
    numbers = {name: float(text) for name, text in given.items()}
    unusable = {
        name
        for name, number in numbers.items()
        if not isfinite(number) or (name in ("stepSize", "tolerance") and number <= 0.0)
    }
    if numbers.get("stopTime", inf) < numbers.get("startTime", 0.0):
        unusable.add("stopTime")
    for name in sorted(unusable):
        findings.flaw(
            f"{document.file}: DefaultExperiment",
            f"The default experiment has {name}={given[name]!r}, which is not used.",
            "Correct it, or leave it out.",
        )
        del numbers[name]
    return numbers
