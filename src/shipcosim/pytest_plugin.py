"""Plugin of pytest: `pytest scenarios` runs the scenarios there, and each of their expectations is a test.

A scenario is a .toml with keys of scenarios, below a folder `scenarios` or named on the command line. Each file is run
once. The page of its run is kept in `results/tests`, or where `shipcosim_results` of pytest's configuration says.
`-p no:shipcosim` turns it off.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from shipcosim import library
from shipcosim.errors import ShipcosimError

if TYPE_CHECKING:
    from shipcosim.results.run import Run
    from shipcosim.results.shown import Check
    from shipcosim.scenario import Expectation

FOLDER = "scenarios"
RESULTS = "shipcosim_results"
PAGE = "page"
"""Property of a test with the path of its page, which JUnit's XML has too."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let a project choose where the results go."""
    parser.addini(RESULTS, "Folder of the results of scenarios.", default="results/tests")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """A collector for a scenario; None for any other file."""
    if file_path.suffix != ".toml":
        return None
    # Other tools have their .toml anywhere: only the folder of scenarios and what is named are looked at.
    if FOLDER not in file_path.parts[:-1] and not parent.session.isinitpath(file_path):
        return None

    from shipcosim.checks import is_scenario

    return ScenarioFile.from_parent(parent, path=file_path) if is_scenario(file_path) else None


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say where the pages are, and add the scenarios to the summary of a step on GitHub."""
    from shipcosim.cli.outcomes.exits import add_to_summary
    from shipcosim.results.shown import Check

    checks = []
    for status in ("passed", "failed", "skipped"):
        for report in terminalreporter.stats.get(status, ()):
            properties = dict(getattr(report, "user_properties", ()))
            if PAGE in properties:
                lines = report.longreprtext.splitlines() if status == "failed" else [""]
                file, _, name = report.nodeid.partition("::")
                checks.append(Check(name, status, lines[0], file, properties[PAGE]))
    if checks:
        pages = dict.fromkeys(check.page for check in checks)
        terminalreporter.write_line(f"Pages of scenarios: {', '.join(pages)}")
        add_to_summary("scenarios", checks)


class Missed(Exception):
    """An expectation that does not hold, or a run that broke."""


class ScenarioFile(pytest.File):
    """A scenario: that it runs to its end, and its expectations."""

    def collect(self) -> Iterator[ScenarioItem]:
        """A test for the run and one for each expectation; a file with faults is one failed test."""
        from shipcosim.scenario import read_scenario

        yield ScenarioItem.from_parent(self, name="runs to its end")
        try:
            scenario = read_scenario(self.path)
        except ShipcosimError:
            return
        for expect in scenario.expect:
            yield ScenarioItem.from_parent(self, name=str(expect), expect=expect)

    @property
    def results(self) -> Path:
        """Folder of the results, by the scenario's place in the folder of scenarios."""
        # The root of pytest is the folder of scenarios where that is all that was asked for and there is no file of
        # settings: results belong into the project around.
        parts = self.path.with_suffix("").parts
        start = parts.index(FOLDER) + 1 if FOLDER in parts else -1
        project = library.project_of(self.path.parent) or self.config.rootpath
        return project.joinpath(self.config.getini(RESULTS), *parts[start:])

    @cached_property
    def run(self) -> Run | ShipcosimError:
        """The run, which is done once, or why it could not begin."""
        from shipcosim.calls.runs import prepare_run

        try:
            return prepare_run(self.path).finish(self.results, force=True)
        except ShipcosimError as error:
            return error


class ScenarioItem(pytest.Item):
    """A test: the run as a whole, or one expectation."""

    def __init__(self, *, expect: Expectation | None = None, **keywords: Any) -> None:
        super().__init__(**keywords)
        self.expect = expect

    def runtest(self) -> None:
        """Run the scenario unless that is done, and look at this expectation."""
        assert isinstance(self.parent, ScenarioFile)
        run = self.parent.run
        if isinstance(run, ShipcosimError):
            raise Missed(str(run))
        check = self._check_in(run)
        page = self.parent.results / check.page
        root = self.config.invocation_params.dir
        shown = (page.relative_to(root) if page.is_relative_to(root) else page).as_posix()
        self.user_properties.append((PAGE, shown))
        if check.status == "skipped":
            pytest.skip(check.message)
        if check.status != "passed":
            raise Missed(f"{check}\nPage: {shown}")

    def _check_in(self, run: Run) -> Check:
        """Check of the expectation; that of the whole run where it broke before it was judged."""
        end, *others = run.checks
        if self.expect is None or not others:
            return end
        reached = [expect for expect in run.scenario.expect if expect not in run.not_judged]
        return others[[*reached, *run.not_judged].index(self.expect)]

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> str:
        """The message alone; a fault of shipcosim has its traceback."""
        if isinstance(excinfo.value, Missed):
            return str(excinfo.value)
        return str(super().repr_failure(excinfo, style))

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """File, line and name."""
        return self.path, None, self.name
