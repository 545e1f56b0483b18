"""Default experiment of an SSD: start and stop time, and the base step size as an annotation."""

import lxml.etree as etree

from shipcosim.ssp.xml.annotations import step_sizes
from shipcosim.ssp.xml.document import child, local
from shipcosim.ssp.xml.markup import OSP_MARK, add_osp, ensure


def experiment_time(root: etree._Element, name: str) -> float | None:
    """The attribute ``startTime`` or ``stopTime`` of an SSD's default experiment, or None. [s]"""
    element = child(root, "ssd:DefaultExperiment")
    text = None if element is None else element.get(name)
    return None if text is None else float(text)


def set_experiment_time(root: etree._Element, name: str, time: float) -> None:
    """Set the start or stop time of an SSD's default experiment.

    Parameters
    ----------
    root : lxml element
        Of the SSD.
    name : str
        ``startTime`` or ``stopTime``.
    time : float
        The time. [s]
    """
    ensure(root, "ssd:DefaultExperiment").set(name, repr(float(time)))


def write_step_size(root: etree._Element, step_size: float) -> None:
    """Write a base step size [s] into an SSD: wherever one is stated, and in OSP's annotation."""
    # Other tools' annotations are kept in agreement.
    stated = list(step_sizes(root))
    for part, attribute in stated:
        part.set(attribute, repr(step_size))
    # libcosim reads OSP's annotation only.
    if not any(OSP_MARK in part.tag and local(part) == "FixedStepAlgorithm" for part, _ in stated):
        experiment = ensure(root, "ssd:DefaultExperiment")
        add_osp(root, experiment, "Algorithm", "FixedStepAlgorithm", baseStepSize=repr(step_size))
