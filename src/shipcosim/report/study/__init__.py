"""The page of a study of many runs: table, views, and the way from a row to the page of its run."""

from shipcosim.report.study.page import render
from shipcosim.report.study.tables import StudyTables, tables_of

__all__ = ["StudyTables", "render", "tables_of"]
