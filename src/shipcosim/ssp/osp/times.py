"""Times, steps and the algorithm of an OspSystemStructure.xml."""

import lxml.etree as etree

from shipcosim.ssp.read.structure import Experiment
from shipcosim.ssp.xml.document import Document, Findings, local, reporting
from shipcosim.ssp.xml.values import read_value

DEFAULT_STEP = 0.1  # s; libcosim's where a file states none


def read_experiment(document: Document, findings: Findings) -> Experiment:
    """Read start, end and base step of an OspSystemStructure.xml; remark what is not used.

    Parameters
    ----------
    document : Document
        The file.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    Experiment
    """
    root = document.root
    # OSP states its times as elements of the root.
    times = {local(part): part for part in root if local(part).endswith(("Time", "StepSize"))}
    read = {name: _seconds(document, part, part.text, findings) for name, part in times.items()}
    # Without a base step libcosim takes its default: so do we.
    if "BaseStepSize" not in times:
        findings.remark(
            document.place(root),
            f"It has no BaseStepSize: {DEFAULT_STEP} s is taken, as libcosim does.",
            "Add one.",
        )
    elif read["BaseStepSize"] is not None and read["BaseStepSize"] <= 0.0:
        place = document.place(times["BaseStepSize"])
        findings.error(place, "The base step size must be positive.", "Give it in seconds.")
    _remark_algorithm(document, findings)
    step = read.get("BaseStepSize", DEFAULT_STEP)
    return Experiment(read.get("StartTime") or 0.0, read.get("EndTime"), step or None)


def own_step(document: Document, element: etree._Element, findings: Findings) -> float | None:
    """Step size of a simulator, or None where it is the base step. [s]

    Parameters
    ----------
    document : Document
        The file.
    element : lxml element
        The Simulator.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    float or None
    """
    # Without a step size of its own a simulator takes the base step.
    if element.get("stepSize") is None:
        return None
    step = _seconds(document, element, element.get("stepSize"), findings)
    if step is not None and step < 0.0:
        findings.error(
            document.place(element, element.get("name")),
            f"stepSize is {step:g}.",
            "It must be positive.",
        )
    return step or None


def _remark_algorithm(document: Document, findings: Findings) -> None:
    # Only the fixed step algorithm is known to libcosim.
    parts = {local(part): part for part in document.root}
    if "Algorithm" not in parts:
        findings.remark(
            document.place(document.root),
            "It names no algorithm, and libcosim refuses such a file.",
            "Add <Algorithm>fixedStep</Algorithm>.",
        )
    elif (name := (parts["Algorithm"].text or "").strip()) != "fixedStep":
        findings.remark(
            document.place(parts["Algorithm"]),
            f"The algorithm '{name}' is not known: it runs with fixed steps.",
        )
    if "EccoConfiguration" in parts:
        place = document.place(parts["EccoConfiguration"])
        findings.remark(place, "The configuration of the algorithm ecco is not used.")


def _seconds(
    document: Document, element: etree._Element, text: str | None, findings: Findings
) -> float | None:
    """Time in whole nanoseconds, as OSP counts; None with an error. [s]"""
    with reporting(document, element, findings, local(element)):
        return round(read_value("Real", text or ""), 9)
    return None
