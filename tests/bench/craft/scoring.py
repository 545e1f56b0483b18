"""What the comparison of commanded and measured force says of a drawn log: right, open, silent or wrong."""

from collections import Counter

import numpy as np

from shipcosim.diagnose.checked_log import ReadLog, checked
from shipcosim.diagnose.compared_log import compared
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.log.reader import read_log

NEAR = 0.25  # natural logarithm by which a ratio may be off: the bench's own inertia and thrust differ by a tenth


def answer(drawn):
    """The log after the comparison."""
    return compared(checked(ReadLog(read_log(drawn.log), drawn.model, read_catalogue())))


def score(drawn, found):
    """One row: what was hidden, what is said, and how it counts."""
    comparison = found.comparison
    labels = sorted((fault.cause, *fault.channels) for fault in found.faults)
    found_ratio = comparison.findings(found.causes)
    ratio = [finding.parameters["ratio"].estimate for finding in found_ratio]
    is_open = (
        comparison.labels is not None
        and comparison.labels.is_wrong
        and not comparison.labels.is_sure
    )
    row = {"style": drawn.style, "fault": drawn.fault, "change": drawn.change, "size": drawn.size}
    row |= {"length": round(drawn.craft.length, 1), "labels": labels, "ratio": ratio}
    row |= {"said": [one.what for one in comparison.discrepancies]}
    return row | {
        "of labels": _of_labels(drawn, labels, is_open),
        "of ratio": _of_ratio(drawn, ratio),
    }


def _of_labels(drawn, labels, is_open):
    if not labels:
        return "open" if is_open else ("right" if drawn.fault == "none" else "silent")
    return "right" if labels == _hidden(drawn) else "wrong"


def _hidden(drawn):
    names = list(drawn.craft.thrusters)
    if drawn.fault == "exchanged":
        left = drawn.thruster.replace("right", "left")
        return [("channel_swap", f"{left}_rpm", f"{left.replace('left', 'right')}_rpm")]
    reversed_ = {"one reversed": [drawn.thruster], "all reversed": names}.get(drawn.fault, [])
    return sorted(("sign", f"{name}_rpm") for name in reversed_)


def _of_ratio(drawn, ratio):
    if not ratio:
        return "silent" if drawn.change == "ratio" else "right"
    hidden = drawn.size if drawn.change == "ratio" else 1.0
    return "right" if abs(np.log(ratio[0] / hidden)) < NEAR else "wrong"


def counted(rows):
    """Counts by what was hidden, as text."""
    lines = []
    for hidden in dict.fromkeys((row["fault"], row["change"]) for row in rows):
        own = [row for row in rows if (row["fault"], row["change"]) == hidden]
        counts = (dict(Counter(row[of] for row in own)) for of in ("of labels", "of ratio"))
        lines.append(
            f"{hidden[0]}, {hidden[1]}: {len(own)} logs; labels %s; ratio %s" % tuple(counts)
        )
    return "\n".join(lines)
