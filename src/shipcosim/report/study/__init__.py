"""The page of a study of many runs: table, views, and the way from a row to the page of its run."""

from shipcosim.report.study.page import outcome_of, render, summary_table
from shipcosim.report.study.tables import StudyTables, columns_of, tables_of

__all__ = ["StudyTables", "columns_of", "outcome_of", "render", "summary_table", "tables_of"]
