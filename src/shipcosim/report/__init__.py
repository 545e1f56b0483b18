"""The page of a run: one HTML file that opens anywhere."""

from shipcosim.report.run.page import digest, write_report

__all__ = ["digest", "write_report"]
