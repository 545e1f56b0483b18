"""Checks of files: everything that is wrong with one, at once; no binary is loaded."""

import platform
import sys
from collections.abc import Iterable
from pathlib import Path

from shipcosim.errors import Problem, shortened
from shipcosim.ssp.flatten.loops import loop_problems
from shipcosim.ssp.flatten.system import System
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.fmu.reader import describe_fmu
from shipcosim.ssp.read.parameters import (
    ParameterSets,
    read_dictionary,
    read_mapping,
    read_parameter_set,
)
from shipcosim.ssp.system_files import assemble
from shipcosim.ssp.xml.document import AnyPath, Findings, read_document

READERS = {".ssv": read_parameter_set, ".ssm": read_mapping, ".ssb": read_dictionary}


def check_system(
    path: AnyPath,
    parameters: ParameterSets = (),
    *,
    fmus: Iterable[AnyPath] = (),
) -> list[Problem]:
    """Problems of a system structure and all it refers to; no binary is loaded.

    Parameters
    ----------
    path, parameters, fmus
        As for `read_system`.

    Returns
    -------
    list of Problem
        Errors, and remarks on what stops nothing; empty where all is well.
    """
    return problems_of(*assemble(path, parameters, fmus))


def problems_of(system: System | None, findings: Findings) -> list[Problem]:
    """Findings about a system, each once, with remarks on platforms and algebraic loops.

    Parameters
    ----------
    system : System or None
        None where it cannot be read.
    findings : Findings
        Of reading it.

    Returns
    -------
    list of Problem
    """
    # Each FMU once, however many components use it.
    described = (
        {} if system is None else {part.fmu.path: part.fmu for part in system.components.values()}
    )
    for fmu in described.values():
        _remark_platform(fmu, fmu.path.name, findings)
    # Connections are only there in a system that can be read.
    if system is None or findings.errors:
        return list(dict.fromkeys(findings.problems))
    remarks = [*_unconnected_inputs(system), *loop_problems(system)]
    return list(dict.fromkeys([*findings.problems, *remarks]))


def _unconnected_inputs(system: System) -> list[Problem]:
    """A remark on the inputs that nothing feeds, one for all; components with the same ones share their names.

    Not on those that are meant to be open: the FMU marks them optional, or the system gives them a start value.
    """
    fed = system.feeding
    owners: dict[tuple[str, ...], list[str]] = {}
    for component in system.components.values():
        free = tuple(
            name
            for name in component.fmu.named("input")
            if (component.name, name) not in fed
            and name not in component.start
            and not component.variables[name].optional
        )
        if free:
            owners.setdefault(free, []).append(component.name)
    if not owners:
        return []
    groups = [f"{shortened(those, 12)}: {shortened(free, 40)}" for free, those in owners.items()]
    message = f"Unconnected inputs keep their start values. {shortened(groups, 40, '; ')}."
    return [Problem(system.name, message, severity="remark")]


def check_file(path: AnyPath, *, fmus: Iterable[AnyPath] = ()) -> list[Problem]:
    """Problems of a file by its ending: .ssp, .ssd, .ssv, .ssm, .ssb, .fmu, .xml (of OSP), or of a folder.

    Parameters
    ----------
    path : path
        The file.
    fmus : iterable of path
        Folders searched for FMUs that are not beside an SSD.

    Returns
    -------
    list of Problem
    """
    # A variant may be named after '#': the ending before it decides. A folder may have one in its name, too.
    archive = path if Path(path).exists() else str(path).partition("#")[0]
    suffix = Path(archive).suffix.lower()
    if suffix in (".ssp", ".ssd", ".xml") or Path(path).is_dir():
        return check_system(path, fmus=fmus)
    findings = Findings()
    # An FMU is described, not run; other files are read by their kind.
    if suffix == ".fmu":
        fmu = describe_fmu(path, findings)
        if fmu is not None:
            _remark_platform(fmu, str(path), findings)
    elif suffix in READERS:
        document = read_document(path, str(path), findings)
        if document is not None:
            READERS[suffix](document, findings)
    else:
        return [
            Problem(
                str(path),
                f"Files ending in '{suffix}' are not known.",
                "Known: .ssp .ssd .ssv .ssm .ssb .fmu .xml.",
            )
        ]
    return list(dict.fromkeys(findings.problems))


def _remark_platform(fmu: FmuDescription, where: str, findings: Findings) -> None:
    names = this_platform()
    if not set(names) & set(fmu.platforms):
        there = ", ".join(fmu.platforms) or "none"
        findings.remark(
            where, f"It has no binary for this platform ({names[0]}).", f"It has: {there}."
        )


def this_platform() -> tuple[str, str]:
    """Names of this platform in FMI 2.0 and FMI 3.0."""
    system = {"win32": "windows", "darwin": "darwin"}.get(sys.platform, "linux")
    machine = {"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine())
    bits = 64 if sys.maxsize > 2**32 else 32
    return f"{'win' if system == 'windows' else system}{bits}", f"{machine}-{system}"
