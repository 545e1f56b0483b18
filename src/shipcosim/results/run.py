"""A run: its table, what was expected of it, and how it shows itself."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shipcosim.errors import Problem, error_at
from shipcosim.keywords import with_known_keywords
from shipcosim.results.shown import (
    Check,
    HtmlPage,
    LikeTable,
    Picture,
    Result,
    passed_or_failed,
)
from shipcosim.scenario.signals import chosen
from shipcosim.series import write_json
from shipcosim.staging import staged

if TYPE_CHECKING:
    import pandas
    import xarray

    from shipcosim.report.notebook.card import Card
    from shipcosim.report.run.page import Digest
    from shipcosim.report.theme.views import Outcome
    from shipcosim.scenario import Expectation, Scenario, Verdict
    from shipcosim.ssp import AnyPath, System


PARTIAL = ("result-partial.nc", "result-partial.csv", "result-partial.html")
"""Files of a run that did not get to its end; a complete one takes them away."""
PREDICTIONS = "predictions.csv"
VERDICT = "verdict.json"
SCHEMA = "shipcosim-verdict/1"


@dataclass(frozen=True, repr=False, eq=False)
class Run(LikeTable, Result):
    """What `shipcosim.run` and `shipcosim.simulate` give back. What its table has, it has, too.

    ``run["vessel.x"]``, ``run.sizes``, ``run.sel(time=60.0)`` are those of `table`. Functions of xarray and numpy that
    ask for a Dataset take ``run.table``.

    Attributes
    ----------
    table : xarray.Dataset
        One row per output interval, `time` in s; variables are named ``component.connector``.
    scenario : Scenario
        What happened.
    system : System
        What ran, flat and checked.
    expectations : tuple of Verdict
        Those of the scenario that lie within the run: ``.passed``, ``.worst``, ``.time``, and ``.expect`` as written.
    not_judged : tuple of Expectation
        Those whose times the run did not reach.
    remarks : tuple of Problem
        What does not stop a run and should be known.
    errors : tuple of Problem
        Why it did not get to its end.
    """

    table: xarray.Dataset
    scenario: Scenario
    system: System
    expectations: tuple[Verdict, ...] = ()
    not_judged: tuple[Expectation, ...] = ()
    remarks: tuple[Problem, ...] = ()
    errors: tuple[Problem, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether the run got to its end and all that was expected of it holds."""
        return self._is_complete and all(verdict.passed for verdict in self.expectations)

    @property
    def failures(self) -> tuple[Problem, ...]:
        """Why it did not get to its end."""
        return self.errors

    @property
    def _is_complete(self) -> bool:
        from shipcosim.report.run.expectations import is_complete

        return is_complete(self.table)

    @cached_property
    def digest(self) -> Digest:
        """Verdict, remarks and expectations in words, as the page and the terminal show them."""
        from shipcosim.report import digest

        return digest(self.table, self.expectations)

    @property
    def outcome(self) -> Outcome:
        """Verdict in one word and one sentence."""
        return self.digest.outcome

    @property
    def checks(self) -> tuple[Check, ...]:
        """That the run got to its end, each expectation, and each that it did not reach."""
        page = "report.html" if self._is_complete else PARTIAL[-1]
        end = Check(
            "runs to its end",
            "passed" if self._is_complete else "error",
            " ".join(map(str, self.errors)) or ("" if self._is_complete else self.outcome.sentence),
            page=page,
        )
        checks = [end]
        for verdict, words in zip(self.expectations, self.digest.expectations, strict=True):
            during = verdict.expect.during
            name = words.expected + (" during {:g} to {:g} s".format(*during) if during else "")
            signals = ", ".join(verdict.expect.signal)
            message = f"worst {words.worst} at {words.time} ({signals})"
            checks.append(Check(name, passed_or_failed(verdict.passed), message, page=page))
        for claim in json.loads(self.table.attrs.get("not_reached", "[]")):
            message = "not reached, the run went from {:g} to {:g} s".format(*self._span)
            checks.append(Check(claim, "skipped", message, page=page))
        return tuple(checks)

    def as_json(self) -> dict[str, Any]:
        """What verdict.json holds and `shipcosim run --json` prints; numbers are in the units of the signals."""
        end, *others = self.checks
        judged = others[: len(self.expectations)]
        expectations = [
            {
                "passed": verdict.passed,
                **verdict.expect.model_dump(),
                "unit": self.table[verdict.expect.signal[0]].attrs.get("units", ""),
                "worst": verdict.worst if math.isfinite(verdict.worst) else None,
                "time": verdict.time if math.isfinite(verdict.time) else None,
                "message": str(check),
            }
            for verdict, check in zip(self.expectations, judged, strict=True)
        ]
        return {
            "schema": SCHEMA,
            "name": self.name,
            "description": self.scenario.description,
            "verdict": {"plain": "done"}.get(self.outcome.kind, self.outcome.kind),
            "sentence": self.outcome.sentence,
            "errors": list(map(str, self.errors)),
            "expectations": expectations,
            "not_reached": [check.name for check in others if check.status == "skipped"],
            "start": self._span[0],
            "end": self._span[1],
            "stop_time": self.scenario.stop_time,
            "changed": json.loads(self.table.attrs.get("changed", "[]")),
            "remarks": self.digest.remarks,
            "page": end.page,
            "files": self.files,
        }

    @property
    def _span(self) -> tuple[float, float]:
        """First and last time of the table. [s]"""
        first, last = self.table["time"].values[[0, -1]]
        return float(first), float(last)

    @property
    def files(self) -> list[str]:
        """Names of the files that `save` or `save_part` writes."""
        if not self._is_complete:
            return sorted([*PARTIAL, VERDICT])
        predictions = [PREDICTIONS] if len(self.predictions) else []
        return [*predictions, "report.html", "result.csv", "result.nc", VERDICT]

    @property
    def name(self) -> str:
        """Name of the scenario, or of the system where there is no scenario file."""
        return self.scenario.name or self.system.name

    @cached_property
    def predictions(self) -> pandas.DataFrame:
        """Every prediction of the run's predictors, beside what became of the ship; no rows where nothing predicts.

        A row for each prediction and horizon: time, component, horizon, predicted and true x, y, psi, errors north,
        east and of heading, radius and half-width of the regions, whether the truth is in them (1, 0, or no number
        where there is no region or the run ends before), and the share of what is learned. SI and radians.
        """
        from shipcosim.report.run.predictions import make_predictions

        return make_predictions(self.table)

    def plot(self, *signals: str) -> Picture:
        """Signals over time, a panel for each unit; moments of events are marked.

        Parameters
        ----------
        *signals : str
            Each a signal, a component, a connector or a pattern: ``"vessel.psi"``, ``"controller"``, ``"thrust"``,
            ``"vessel.tau_*_X"``. Without one: position and heading of the ship, or all signals where there is none.

        Returns
        -------
        Picture

        Raises
        ------
        ShipcosimError
            If there is no such signal.
        """
        from shipcosim.report.notebook.figures import panels_svg
        from shipcosim.report.run.roles import find_roles
        from shipcosim.report.theme.display import display_table

        roles = find_roles(self.table.data_vars)
        pose = (
            [roles.signal(roles.ship, axis) for axis in ("x", "y", "psi")]
            if roles.ship is not None
            else []
        )
        names = chosen(map(str, self.table.data_vars), signals or [n for n in pose if n] or ["*"])
        shown = display_table(self.table, roles.signal(roles.ship, "psi"))
        drawn = [name for name in names if name in shown]
        if not drawn:
            raise error_at(
                self.name,
                f"{', '.join(names)}: no signal among these is a number over time.",
                "Only those can be drawn.",
            )
        title = f"{', '.join(signals) or 'signals'} of {self.name}"
        events = sorted({event.time for event in self.scenario.events})
        return Picture(title, panels_svg(shown, drawn, title, events))

    def track(self) -> Picture:
        """The way of the ship on a chart, north up, with where she was to be.

        Raises
        ------
        ShipcosimError
            If nothing in the table is a ship: a component with x, y and psi.
        """
        from shipcosim.report.notebook.run_track import run_track

        svg = run_track(self.table, self.expectations, f"track of {self.name}")
        if svg is None:
            raise error_at(
                self.name,
                "Nothing here is a ship, with x, y and psi over time.",
                "`.plot(...)` draws any signals.",
            )
        return Picture(f"track of {self.name}", svg)

    def page(self) -> HtmlPage:
        """The page of the run, as `shipcosim run` writes it."""
        from shipcosim.report.run.page import render

        page = render(
            self.table, scenario=self.scenario, verdicts=self.expectations, system=self.system
        )
        return HtmlPage(self.name, page)

    @with_known_keywords
    def save(self, folder: AnyPath, *, force: bool = False) -> Path:
        """Write result.nc, result.csv, report.html, verdict.json and, where something predicts, predictions.csv.

        Returns the folder.

        Parameters
        ----------
        folder : path
            Made if needed.
        force : bool
            Replace files of these names there, instead of keeping them in a numbered folder beside it.

        Raises
        ------
        ShipcosimError
            If they cannot be written.
        """
        from shipcosim.report.run.predictions import write_predictions

        with staged(Path(folder), (*PARTIAL, PREDICTIONS), force=force) as stage:
            self._write(stage, "result", "report.html")
            if PREDICTIONS in self.files:
                write_predictions(self.predictions, stage / PREDICTIONS)
        return Path(folder)

    @with_known_keywords
    def save_part(self, folder: AnyPath, *, force: bool = False) -> Path:
        """Write result-partial.nc, .csv and .html of a run that did not get to its end, and its verdict.json.

        Returns the folder.

        Parameters and errors as for `save`.
        """
        with staged(Path(folder), force=force) as stage:
            self._write(stage, "result-partial", "result-partial.html")
        return Path(folder)

    def _write(self, stage: Path, stem: str, page: str) -> None:
        """Write table, page and verdict into a folder that is there."""
        from shipcosim.series import write_table

        for suffix in (".nc", ".csv"):
            write_table(self.table, stage / f"{stem}{suffix}")
        self.page().save(stage / page)
        write_json(self.as_json(), stage / VERDICT)

    def claims_not_reached(self) -> list[str]:
        """What was expected later than the run went, each as a sentence with the units that people read."""
        from shipcosim.report.run.expectations import claims
        from shipcosim.scenario import units_of, with_numbers

        late = self.scenario.model_copy(update={"expect": list(self.not_judged)})
        return claims(with_numbers(late, units_of(self.system)).expect, self.table)

    def __repr__(self) -> str:
        components = {n.rpartition(".")[0] for n in map(str, self.table)}
        size = f"{self.table.sizes['time']} rows of {len(self.table)} signals of {len(components)} components"
        return f"<Run of {self.name!r}: {self.outcome.word}. {self.outcome.sentence} {size}>"

    def _card(self) -> Card:
        from shipcosim.report.notebook.run_card import run_card

        return run_card(self.table, self.scenario, self.system, self.expectations)
