"""The system extended by the findings of a diagnosis, with every number that differs from the given one."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from shipcosim.diagnose.craft.learned import LearnedCraft
from shipcosim.diagnose.explanation.identification import Identification
from shipcosim.diagnose.extension.extend import Extension, extend
from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.hypotheses.cause import Cause
from shipcosim.errors import ShipcosimError
from shipcosim.ssp import AnyPath, System, SystemStructure, read_system


@dataclass(frozen=True)
class NumberChange:
    """A number that the extension changes; `before` is None for a new number."""

    name: str
    before: float | None
    after: float
    unit: str


@dataclass(frozen=True)
class ExtendedSystem:
    """A system with the named causes in it.

    Attributes
    ----------
    given : System
        That the log was compared with.
    source : path or SystemStructure
        What is extended.
    extension : Extension or None
        None where no cause of the physics was named, or it could not be made.
    system : System or None
        The extended system, which can be simulated.
    changes : tuple of NumberChange
        Every number that differs.
    remarks : tuple of str
        Why it could not be made.
    """

    given: System
    source: SystemStructure | str
    extension: Extension | None = None
    system: System | None = None
    changes: tuple[NumberChange, ...] = ()
    remarks: tuple[str, ...] = ()


def with_findings(
    given: ExtendedSystem,
    findings: Iterable[Finding],
    log: Identification,
    folder: AnyPath,
    craft: LearnedCraft | None = None,
) -> ExtendedSystem:
    """The system extended by findings of the physics and by what is learned of the craft; the given one without these.

    Parameters
    ----------
    given : ExtendedSystem
        Not extended yet.
    findings : iterable of Finding
    log : Identification
        That they were found in; its name and times go into the descriptions.
    folder : path
        Gets extended.ssp and extended.ssv.
    craft : LearnedCraft, optional
        Instead of the one that the log's comparison of forces teaches.

    Returns
    -------
    ExtendedSystem
        With a remark where the system cannot be extended.
    """
    time = log.repaired["time"].values
    source = log.log.encoding.get("source", "")
    about = {"source": Path(source).name, "sha256": log.log.encoding.get("sha256", "")}
    return extended_by(
        given,
        findings,
        about | {"span": (float(time[0]), float(time[-1]))},
        log.causes,
        folder,
        craft or log.comparison.craft,
    )


def extended_by(
    given: ExtendedSystem,
    findings: Iterable[Finding],
    about: Mapping[str, Any],
    causes: Mapping[str, Cause],
    folder: AnyPath,
    craft: LearnedCraft | None = None,
) -> ExtendedSystem:
    """Extend a system by the findings of several logs.

    Parameters
    ----------
    given, findings, folder
        As for `with_findings`.
    about : mapping
        Of the logs, as `extend` takes it: ``source``, ``sha256``, ``span``.
    causes : mapping of str to Cause
        The catalogue.
    craft : LearnedCraft, optional
        The ship as the logs taught her.
    """
    findings = [finding for finding in findings if finding.kind == "physics"]
    if not findings and craft is None:
        return given
    # The written system is read again, so that only one that can be simulated is reported.
    try:
        extension = extend(
            given.source, findings, folder, craft, log_attributes=about, catalogue=causes
        )
        system = read_system(str(extension.ssp))
    except ShipcosimError as error:
        texts = (f"{p.where}: {p.found} {p.remedy}".rstrip() for p in error.problems)
        return replace(
            given, remarks=tuple(f"The system was not extended: {text}" for text in texts)
        )
    changes = (
        _change(name, value, given.given, system) for name, value in extension.values.items()
    )
    return replace(given, extension=extension, system=system, changes=tuple(changes))


def _change(name, value, given, extended):
    component, _, variable = name.rpartition(".")
    start = (
        given.components[component].start_value(variable) if component in given.components else None
    )
    variables = (
        extended.components[component].variables
        if component in extended.components
        else extended.inputs
    )
    unit = variables[variable].unit if variable in variables else ""
    before = float(start) if isinstance(start, int | float) else None
    return NumberChange(name, before, float(value), "" if unit in (None, "1") else unit)
