"""The base step size of an SSD, which the standard leaves to annotations of the tools."""

from shipcosim.ssp.xml.annotations import step_sizes
from shipcosim.ssp.xml.document import local
from shipcosim.ssp.xml.markup import OSP_MARK, add_osp, ensure


def write_step_size(root, step_size):
    """State a base step size [s] in an SSD: wherever one is stated, and in OSP's annotation."""
    stated = list(step_sizes(root))
    for part, attribute in stated:
        part.set(attribute, repr(step_size))
    if not any(OSP_MARK in part.tag and local(part) == "FixedStepAlgorithm" for part, _ in stated):
        experiment = ensure(root, "ssd:DefaultExperiment")
        add_osp(root, experiment, "Algorithm", "FixedStepAlgorithm", baseStepSize=repr(step_size))
