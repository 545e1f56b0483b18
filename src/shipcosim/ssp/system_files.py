"""Read a system from any file: an SSP in its three forms, an OspSystemStructure.xml, or an FMU."""

from collections.abc import Iterable
from pathlib import Path

from shipcosim.errors import ShipcosimError, held_strictly
from shipcosim.ssp.flatten.assemble import assemble_package
from shipcosim.ssp.flatten.hierarchy import Swapped
from shipcosim.ssp.flatten.system import System
from shipcosim.ssp.osp.reader import assemble_osp, osp_file
from shipcosim.ssp.read.package import open_package, remark_others
from shipcosim.ssp.read.parameters import ParameterSets
from shipcosim.ssp.single_fmu import assemble_fmu, single_fmu
from shipcosim.ssp.xml.document import AnyPath, Findings


def read_system(
    path: AnyPath,
    parameters: ParameterSets = (),
    *,
    fmus: Iterable[AnyPath] = (),
    components: Swapped = None,
    strict: bool = False,
) -> System:
    """Read a system structure and everything it refers to, with all checks.

    Parameters
    ----------
    path : path
        A .ssp (with ``#Variant.ssd`` behind it for another SSD), a folder with a SystemStructure.ssd, a .ssd, or an
        OspSystemStructure.xml (a folder with one); or one .fmu, whose inputs are those of the system.
    parameters : path or ParameterSet, or iterable of them
        Parameter sets (.ssv) applied over those of the system, the last one last.
    fmus : iterable of path
        Folders searched for FMUs that are not beside the system structure.
    components : mapping of str to Path, optional
        FMUs that components run in place of their own, by full name. An FMU must have the connectors that are wired;
        values for parameters that it has not are left out, with a remark.
    strict : bool
        Refuse what breaks a standard, also where it can mean one thing only.

    Returns
    -------
    System

    Raises
    ------
    ShipcosimError
        With everything that is wrong.
    """
    # Flaws have one possible meaning: they are errors only in strict reading.
    system, findings = assemble(path, parameters, fmus, components)
    refused = [p for p in findings.problems if p.is_error or (strict and p.flaw)]
    if system is None or refused:
        raise ShipcosimError(list(dict.fromkeys(held_strictly(refused))))
    return system


def assemble(
    path: AnyPath,
    parameters: ParameterSets = (),
    fmus: Iterable[AnyPath] = (),
    components: Swapped = None,
) -> tuple[System | None, Findings]:
    """Like `read_system`, but collects the problems.

    Parameters
    ----------
    path, parameters, fmus, components
        As for `read_system`.

    Returns
    -------
    tuple of System or None, and Findings
        The system is None or incomplete where there are errors.
    """
    findings = Findings()
    # The kind of file decides who reads it.
    osp = osp_file(path)
    if osp is not None:
        if Path(path).is_dir():
            remark_others(Path(path), str(path), osp.name, "", findings)
        return assemble_osp(osp, parameters, fmus, findings, components), findings
    fmu = single_fmu(path)
    if fmu is not None:
        return assemble_fmu(fmu, parameters, fmus, findings, components), findings
    package = open_package(path, findings, fmus)
    if package is None:
        return None, findings
    return assemble_package(package, parameters, str(path), findings, swapped=components), findings
