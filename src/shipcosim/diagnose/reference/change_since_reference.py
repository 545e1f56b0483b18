"""What has changed since a reference: the size of a cause at the reference beside what it is now."""

from collections.abc import Iterable, Mapping
from dataclasses import replace

from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.hypotheses.catalogue import hypotheses_of
from shipcosim.diagnose.hypotheses.cause import Cause
from shipcosim.diagnose.reference.reference import Reference, with_reference
from shipcosim.diagnose.ship.model import ShipModel


def with_sizes_at_reference(
    findings: Iterable[Finding], ship: ShipModel, reference: Reference, causes: Mapping[str, Cause]
) -> tuple[Finding, ...]:
    """Findings with the size that each cause in the ship had when the reference was made.

    Parameters
    ----------
    findings : iterable of Finding
    ship : ShipModel
        Of the system, or of the reference.
    reference : Reference
    causes : mapping of str to Cause
        The catalogue.

    Returns
    -------
    tuple of Finding
        Those of the data, and of what no number of the reference holds, are as they were: a current is the day's.
    """
    # Numbers of the reference, and the causes that the ship can have.
    numbers = {number.name: number for number in reference.numbers}
    hypotheses = {
        hypothesis.label: hypothesis
        for hypothesis in hypotheses_of(dict(causes), with_reference(ship, reference))
    }
    sized = []
    for finding in findings:
        # The size of each cause follows from the reference's estimate of its number.
        hypothesis = hypotheses.get(finding.label) if finding.kind == "physics" else None
        before = {
            of.name: of.estimate(numbers[of.path].estimate, numbers[of.path].std)
            for of in (hypothesis.parameters if hypothesis else ())
            if of.path in numbers
        }
        sized.append(replace(finding, at_reference=before) if before else finding)
    return tuple(sized)
