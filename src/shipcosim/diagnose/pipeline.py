"""The diagnosis from end to end: from a log to its causes. Each stage is a function from one value to the next.

read_measurements  ReadLog         the log by the roles of its columns, the ship, the catalogue of causes
checked            CheckedLog      faults of the log that its own channels show, repaired
identified         Identification  the identification problem: noise, linearisation about the ship without a cause
corrected          Identification  faults of the log and of connections that only the ship's response shows
with_causes        ExplainedLog    sets of causes fitted to the log
with_right_inputs  ExplainedLog    mislabelled channels of thrusters and wind, which look like causes
with_change_point  ExplainedLog    causes that began during the log
judged             JudgedLog       the verdict, against unmodelled errors and what healthy ships gain
stated             Diagnosis       what is said of it, what this log could not have shown, what to sail next
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from threadpoolctl import threadpool_limits

from shipcosim.diagnose.experiment.design import design_experiment
from shipcosim.diagnose.experiment.testability import untestable_causes
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.inference.change_point import with_change_point
from shipcosim.diagnose.inference.problem import identified
from shipcosim.diagnose.inference.search import with_causes
from shipcosim.diagnose.inference.verdict import judged
from shipcosim.diagnose.log.checks.examine import checked
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.log_faults.corrections import corrected, with_right_inputs
from shipcosim.diagnose.result import Diagnosis
from shipcosim.diagnose.ship.model import ship_model_of
from shipcosim.diagnose.stages import JudgedLog, ReadLog

if TYPE_CHECKING:
    import xarray

    from shipcosim.ssp import System

__all__ = ["find_causes", "read_measurements", "stated", "verdict_on"]

Progress = Callable[..., None]
"""Called with what is being done, in words; and where known with how many parts of it are done, and of how many."""


def find_causes(
    log: str | os.PathLike | xarray.Dataset,
    system: System,
    channels: str | os.PathLike | None = None,
    causes: str | os.PathLike | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Diagnose a log: its faults, and the causes for which the ship does not behave as modelled.

    Parameters
    ----------
    log : path or xarray.Dataset
        Measured data, see docs/measured-data.md.
    system : System
        The ship that the log is held against, as `read_system` gives it.
    channels : path, optional
        Channel file.
    causes : path, optional
        Folder with further causes.
    progress : callable, optional
        Called with what is being done, in words.

    Returns
    -------
    Diagnosis
        Without the errors of predictions, the extended system and the gain, which `diagnose` adds.

    Raises
    ------
    ShipcosimError
        Data, system or causes that cannot be used.
    """
    with threadpool_limits(1):  # many small matrices: threads would only wait for each other
        say = progress or (lambda *_: None)
        say("is the log right?")
        read = read_measurements(log, system, channels, causes)
        return stated(verdict_on(read, say))


def read_measurements(
    log: str | os.PathLike | xarray.Dataset,
    system: System,
    channels: str | os.PathLike | None = None,
    causes: str | os.PathLike | None = None,
) -> ReadLog:
    """A log by the roles of its columns, with the ship of a system and the causes that could be found."""
    return ReadLog(read_log(log, channels), ship_model_of(system), read_catalogue(causes))


def verdict_on(read: ReadLog, progress: Progress) -> JudgedLog:
    """The way of a log to its verdict, stage by stage."""
    log = checked(read)
    progress("which causes explain it?")
    identification = corrected(identified(log))
    explained = with_change_point(with_right_inputs(with_causes(identification)))
    progress("what do healthy ships look like?")
    return judged(explained)


def stated(log: JudgedLog) -> Diagnosis:
    """What is said of a log: faults, causes since when they act, what it could not have shown, what to sail next."""
    found, judgement = log.explained.identification, log.judgement
    of_log = (*found.faults, *found.misconnections)
    rivals = judgement.rivals if not found.ship.third_party else ()  # with those no manoeuvre can be prescribed
    return Diagnosis(
        "named" if of_log and judgement.verdict == "consistent" else judgement.verdict,
        (*of_log, *(replace(finding, onset=log.explained.change_point) for finding in judgement.findings)),
        judgement.candidates,
        judgement.indistinguishable,
        untestable_causes(log),
        design_experiment(log.problem, log.fit, rivals) if rivals else None,
        basis=log,
    )
