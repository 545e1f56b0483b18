"""The page of a run: one HTML file that opens anywhere; and the page of several scenarios, which leads to theirs."""

from shipcosim.report.run.comparison import write_comparison
from shipcosim.report.run.overview import ScenarioRow, overview_outcome, write_overview
from shipcosim.report.run.page import digest, write_report

__all__ = [
    "ScenarioRow",
    "digest",
    "overview_outcome",
    "write_comparison",
    "write_overview",
    "write_report",
]
