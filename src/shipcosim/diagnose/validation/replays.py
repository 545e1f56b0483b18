"""The errors of predictions again as co-simulations: the given system, and the one extended by what was fitted."""

from dataclasses import dataclass
from functools import partial

import xarray

from shipcosim.diagnose.extension.extend import extend
from shipcosim.diagnose.extension.extended_system import ExtendedSystem
from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.inference.fitting import Fit
from shipcosim.diagnose.validation.conditions import PredictedLog
from shipcosim.diagnose.validation.cosimulation import MOST, Replayed, simulated
from shipcosim.errors import ShipcosimError
from shipcosim.options import CountProgress
from shipcosim.ssp import read_system
from shipcosim.temporary import temporary_folder


@dataclass(frozen=True)
class SimulatedLog:
    """Predictions as co-simulations of the given and the extended system, or in array form where that was not possible.

    Attributes
    ----------
    errors : xarray.Dataset or None
        As of a `Comparison`; None where the log has too few rows.
    held_out : dict of str to xarray.Dataset
        By condition that was held out of the fit.
    is_simulated : bool
    remarks : tuple of str
        Why they were not co-simulated.
    """

    errors: xarray.Dataset | None
    held_out: dict[str, xarray.Dataset]
    is_simulated: bool
    remarks: tuple[str, ...] = ()


def with_cosimulation(
    log: PredictedLog, extended: ExtendedSystem, progress: CountProgress | None = None
) -> SimulatedLog:
    """Predictions as co-simulations, with what was fitted on the training rows.

    Parameters
    ----------
    log : PredictedLog
    extended : ExtendedSystem
        Where causes were named but the system could not be extended, the predictions stay in array form.
    progress : callable, optional
        Called with (parts done, parts in all), whose number changes on the way.
    """
    # Too few rows, or a system that could not be extended: predictions in array form stand.
    if log.comparison is None:
        return SimulatedLog(None, {}, False)
    in_array_form = {name: comparison.errors for name, comparison in log.held_out.items()}
    identification = log.judged.explained.identification
    craft = identification.comparison.started_craft
    if (log.comparison.fit.hypotheses or craft) and extended.extension is None:
        return SimulatedLog(log.comparison.errors, in_array_form, False)
    run = partial(_cosimulated, extended, identification.causes, craft)
    count = 1 + len(log.held_out)
    say = progress or (lambda *_: None)
    # All rows first, then each held-out condition with half as many segments.
    try:
        errors = run(lambda done, of: say(done, count * of), log.comparison, MOST)
        held_out = {
            name: run(lambda done, of, k=k: say(k * of + done, count * of), comparison, MOST // 2)
            for k, (name, comparison) in enumerate(log.held_out.items(), start=1)
        }
    except ShipcosimError as error:
        first = {
            (p.found, p.remedy): p for p in reversed(error.problems)
        }  # that of many segments is reported once
        problems = reversed(first.values())
        remarks = tuple(f"The system was not co-simulated: {problem}" for problem in problems)
        return SimulatedLog(log.comparison.errors, in_array_form, False, remarks)
    return SimulatedLog(errors, held_out, True)


def _cosimulated(extended, causes, craft, progress, comparison, most):
    """Errors of one comparison, by the given system and by the one extended by what the comparison was fitted with."""
    fitted = None
    findings = findings_of(comparison.fit)
    with temporary_folder() as folder:
        # Extend the system by the causes as fitted on the training rows, not by those of the whole
        # log.
        if findings or craft:
            about = {"span": comparison.fit.model.span}
            made = extend(
                extended.source, findings, folder, craft, log_attributes=about, catalogue=causes
            )
            fitted = Replayed(read_system(str(made.ssp)), made.signals)
        return simulated(comparison, Replayed(extended.given), fitted, most=most, progress=progress)


def findings_of(fit: Fit) -> list[Finding]:
    """The causes of a fit as findings."""
    return [
        Finding(
            hypothesis.cause,
            hypothesis.component,
            parameters={
                of.name: of.estimate(fit.values[of.path], fit.std[of.path])
                for of in hypothesis.parameters
            },
        )
        for hypothesis in fit.hypotheses
    ]
