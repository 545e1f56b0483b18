"""The base step size of an SSD, which the standard leaves to annotations of the tools."""

from shipcosim.ssp.markup import OSP_MARK, add_osp, ensure
from shipcosim.ssp.structure import STEP_SIZES
from shipcosim.ssp.xml import child, children, local


def step_sizes(root):
    """(element, attribute) of all that state it in an SSD, the one that counts first."""
    for owner in (child(root, "ssd:DefaultExperiment"), child(root, "ssd:System")):
        for annotation in () if owner is None else children(owner, "ssd:Annotations", "ssc:Annotation"):
            for part in annotation.iter():
                attribute = STEP_SIZES.get(local(part))
                if attribute and part.get(attribute) is not None:
                    yield part, attribute


def write_step_size(root, step_size):
    """State a base step size [s] in an SSD: wherever one is stated, and in OSP's annotation."""
    stated = list(step_sizes(root))
    for part, attribute in stated:
        part.set(attribute, repr(step_size))
    if not any(OSP_MARK in part.tag and local(part) == "FixedStepAlgorithm" for part, _ in stated):
        experiment = ensure(root, "ssd:DefaultExperiment")
        add_osp(root, experiment, "Algorithm", "FixedStepAlgorithm", baseStepSize=repr(step_size))
