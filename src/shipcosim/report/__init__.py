"""The page of a run: one HTML file that opens anywhere."""

from shipcosim.report.page import write_report

__all__ = ["write_report"]
