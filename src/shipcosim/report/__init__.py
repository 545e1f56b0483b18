"""The page of a run: one HTML file that opens anywhere; and the page of several scenarios, which leads to theirs.

The room can be called: ``shipcosim.report(a, b)`` is the function of this name in `shipcosim.calls`.
"""

import sys

from shipcosim import CallableRoom
from shipcosim.report.run.overview import ScenarioRow, overview_outcome, write_overview
from shipcosim.report.run.page import digest, write_report

__all__ = [
    "ScenarioRow",
    "digest",
    "overview_outcome",
    "write_overview",
    "write_report",
]

sys.modules[__name__].__class__ = CallableRoom
