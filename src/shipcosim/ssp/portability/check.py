"""Checks of a system for a tool that reads its file itself: features it ignores or misreads."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from shipcosim.errors import Problem, capitalised, error_at, suggestion
from shipcosim.ssp.flatten.hierarchy import Swapped
from shipcosim.ssp.osp.reader import assemble_osp, osp_file
from shipcosim.ssp.portability.subject import Subject, subject_of
from shipcosim.ssp.portability.support_table import FEATURES, HOSTS, TOLD, Feature
from shipcosim.ssp.xml.document import AnyPath, Findings, read_document


def check_host(host: str) -> None:
    """Refuse a tool that is not in the table.

    Raises
    ------
    ShipcosimError
        If it is not one of HOSTS.
    """
    if host not in HOSTS:
        raise error_at(f"--for {host}", "Nothing is known of this tool.", suggestion(host, HOSTS))


def check_for(
    host: str,
    path: AnyPath,
    *,
    fmus: Iterable[AnyPath] = (),
    components: Swapped = None,
) -> list[Problem]:
    """Features of a file that a tool would ignore, misread, refuse or crash on.

    Parameters
    ----------
    host : str
        One of HOSTS.
    path : path
        As for `read_system`.
    fmus : iterable of path
        Folders searched for FMUs that are not beside the system structure.
    components : mapping of str to Path, optional
        FMUs that components run in place of their own: the tool is taken to be given these.

    Returns
    -------
    list of Problem
        Errors; remarks on what the tool has to be told. Empty where the file cannot be read: `check` says why.

    Raises
    ------
    ShipcosimError
        If there is no such tool.
    """
    # OSP files are libcosim's own; ecos does not read them.
    check_host(host)
    osp = osp_file(path)
    if osp is not None and host == "ecos":
        remedy = "Give it the system as an SSP."
        return [Problem(str(path), "ecos does not read an OspSystemStructure.xml.", remedy)]
    subject = (
        subject_of(path, fmus, components) if osp is None else _osp_subject(osp, fmus, components)
    )
    if subject is None:
        return []
    # Only features that this tool does not support.
    features = (feature for feature in FEATURES if host in feature.becomes)
    return list(
        dict.fromkeys(
            problem for feature in features for problem in _problems(host, feature, subject)
        )
    )


def _problems(host: str, feature: Feature, subject: Subject) -> Iterator[Problem]:
    verdict = feature.becomes[host]
    for place, what in feature.find(subject):
        message = f"{what or feature.about}: {host} {verdict}."
        named = not message.partition(" ")[0].isalpha()  # such as gain.fmu
        problem = Problem(place, message if named else capitalised(message), feature.remedy)
        yield replace(problem, severity="remark") if verdict == TOLD else problem


def _osp_subject(path: Path, fmus: Iterable[AnyPath], components: Swapped) -> Subject | None:
    findings = Findings()
    system = assemble_osp(path, (), fmus, findings, components)
    document = read_document(path, str(path), findings)
    return (
        None if system is None or document is None or findings.errors else Subject(document, system)
    )
