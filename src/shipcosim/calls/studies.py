"""Studies: planned, run, and any of their runs again with its page."""

from __future__ import annotations

import json
import os
import shlex
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from shipcosim.calls.arguments import AnyPath, find, mapping
from shipcosim.calls.runs import PreparedRun, prepare_run
from shipcosim.errors import error_at
from shipcosim.keywords import with_known_keywords
from shipcosim.options import CountProgress
from shipcosim.results.run import Run
from shipcosim.results.shown import parts_of
from shipcosim.results.study import StudyResult
from shipcosim.sweep import Plan, plan_of, read_study, run_study


class PlannedStudy:
    """A study that is read and laid out.

    Parameters
    ----------
    study : path or name
    out : path, optional
        Folder of the results; results/STUDY without.
    engine : str
        ``"native"`` or ``"fmpy"``.
    set : mapping of str to value, optional
        Start values of all runs.
    """

    def __init__(
        self,
        study: AnyPath,
        *,
        out: AnyPath | None = None,
        engine: str = "native",
        set: Mapping[str, object] | None = None,
    ) -> None:
        self.plan: Plan = plan_of(read_study(find("study", study)), mapping("set", set))
        self.folder = Path("results") / self.plan.study.name if out is None else Path(out)
        self.engine = engine
        self.command = command_of(os.fspath(study), out, engine, set)

    def run(self, **options: Any) -> StudyResult:
        """Run what is not done, and write tables and page; options as of `shipcosim.sweep.run_study`."""
        swept = run_study(self.plan, self.folder, engine=self.engine, **options)
        result = StudyResult(
            **parts_of(swept), command=self.command, simulate=lambda n: self.prepare(n).run()
        )
        result.write()
        return result

    def prepare(self, number: int) -> PreparedRun:
        """One run of the study, to be simulated with all its signals.

        Raises
        ------
        ShipcosimError
            If there is no such run.
        """
        if not 0 <= number < len(self.plan):
            raise error_at(
                self.plan.study.name,
                f"There is no run {number}.",
                f"Runs are numbered from 0 to {len(self.plan) - 1}.",
            )
        values = [f"{name} {value}" for name, value in self.plan.run(number).columns.items()]
        changed = [f"run {number} of the study {self.plan.study.name}", *values]
        prepared = prepare_run(self.plan.alone(number), changed=changed, engine=self.engine)
        # Expectations are those of the whole scenario, as the study's quantities take them.
        return replace(prepared, planned=self.plan.planned)

    def run_again(self, number: int, simulate: Callable[[PreparedRun, Path], Run]) -> Run:
        """Simulate one run of the study into its folder; the page of the study, if there, leads to it.

        Parameters
        ----------
        number : int
            Of the run.
        simulate : callable
            Gets the prepared run and the folder ``run-N``, which it replaces.
        """
        if self.plan.study.tune and self._is_there():
            run_study(
                self.plan, self.folder, engine=self.engine, at_most=0
            )  # later trials depend on those done
        result = simulate(self.prepare(number), self.folder / f"run-{number}")
        if self._is_there():
            self.run(at_most=0)
        return result

    def _is_there(self) -> bool:
        """Whether the results in the folder are those of this plan, and not of another one."""
        try:
            about = json.loads((self.folder / "study.json").read_text(encoding="utf-8"))
            return (
                about["plan"] == self.plan.digest(self.engine)
                and (self.folder / "runs.parquet").is_file()
            )
        except (OSError, ValueError, KeyError, TypeError):
            return False


@with_known_keywords
def sweep(
    study: AnyPath,
    *,
    out: AnyPath | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    engine: str = "native",
    set: Mapping[str, object] | None = None,
    at_most: int | None = None,
    progress: CountProgress | None = None,
    force: bool = False,
) -> StudyResult:
    """Run a study: a scenario many times, with other weather, events, parameters.

    It goes on where it was interrupted. A run that fails is a row with its error.

    Parameters
    ----------
    study : path or name
        A study file, or its name: ``"wind_limits"``.
    out : path, optional
        Folder of the results; results/STUDY without.
    scheduler : str, optional
        Address of a scheduler of Dask; processes of this machine without.
    workers : int, optional
        Processes of this machine; one a core without.
    engine : str
        ``"native"`` or ``"fmpy"``, as in `shipcosim.options.RunOptions`.
    set : mapping of str to value, optional
        Start values of all runs, over those of scenario and study; factors go before them.
    at_most : int, optional
        Do at most so many runs now.
    progress : callable, optional
        Called with (runs done, runs in all).
    force : bool
        Do all runs again, and replace earlier results.

    Returns
    -------
    StudyResult

    Raises
    ------
    ShipcosimError
        If something does not fit together, or results cannot be written.
    """
    planned = PlannedStudy(study, out=out, engine=engine, set=set)
    return planned.run(
        scheduler=scheduler, workers=workers, at_most=at_most, progress=progress, force=force
    )


def command_of(
    study: str, out: AnyPath | None, engine: str, start_values: Mapping[str, object] | None
) -> str:
    """The command line that makes a study.

    Examples
    --------
    >>> command_of("wind_limits", None, "native", {"environment.wind_speed": "10 kn"})
    "shipcosim sweep wind_limits --set 'environment.wind_speed=10 kn'"
    """
    words = ["shipcosim", "sweep", study]
    if out is not None:
        words += ["--out", os.fspath(out)]
    if engine != "native":
        words += ["--engine", engine]
    for name, value in (start_values or {}).items():
        words += ["--set", f"{name}={value}"]
    return shlex.join(words)
