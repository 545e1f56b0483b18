"""What the trial has diagnosed: functions of the path of a log."""

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pandas as pd

ROOT = Path(__file__).resolve().parents[3]
UNTIL = 2400.0  # end of the log that is diagnosed, where a drift follows it [s]
SHARE = 0.65  # of it that is fitted on, for the gain under DP
_BESIDE = {  # what the entry of diagnosis.json does not have: of the log (0) or of its twin (1), by which model
    "after_observer_m": (0, "extended_observer"),
    "twin_m": (1, "plain"),
    "twin_observer_m": (1, "bias_observer"),
}


@cache
def system():
    """The lengthened Gunnerus with her thrusters' inputs open."""
    from shipcosim.ssp import read_system

    return read_system(ROOT / "ssp" / "gunnerus_open", fmus=[ROOT / "build" / "fmus"])


def ours(path):
    """The project's own diagnosis."""
    from shipcosim.diagnose.pipeline import find_causes

    return find_causes(path, system())


def with_reference_log(path):
    """The diagnosis of a log against the ship as she was on another day, whose log lies beside it; see `reference_of`.

    Where that log makes no reference the log is diagnosed without one.
    """
    from shipcosim.diagnose.calibration_pipeline import calibrate
    from shipcosim.diagnose.pipeline import find_causes, given_system
    from shipcosim.diagnose.reference.parameter_set import with_calibrated_numbers

    ship = calibrate([reference_of(path)], system())
    if ship.refusals:
        return find_causes(path, system())
    with TemporaryDirectory() as folder:
        given = with_calibrated_numbers(given_system(system()), ship.reference, folder)
        return find_causes(path, given.given, reference=ship.reference)


def reference_of(path):
    """Where the log of another day of the same ship is."""
    return Path(path).with_suffix(".reference.csv")


@dataclass(frozen=True)
class WithGain:
    """A diagnosis with what naming the cause was worth: under DP, and in the drift that follows the log.

    Attributes
    ----------
    diagnosis : Diagnosis
        Its gain is that under DP.
    drift : dict or None
        As the gain, of predictions without power.
    """

    diagnosis: Any
    drift: dict | None = None

    def as_json(self):
        """Content of diagnosis.json, and the drift's gain besides."""
        return self.diagnosis.as_json() | {"drift": self.drift}


def with_drift(path, nameless=None):
    """The diagnosis of a log until `UNTIL`; its gain there, and in the drift at the end, which it has not seen.

    Both in the array form, where a cause of the physics is named. ``after_observer_m`` is missed with
    the causes and a bias observer, ``chance_worse`` is how sure that is more than the plain model misses with one;
    ``twin_m`` and ``twin_observer_m`` by the plain model, without and with an observer, on the healthy twin of the log,
    which lies beside it, see `twin_of`.

    Parameters
    ----------
    path : path
    nameless : callable, optional
        Of a case and a comparison: position errors of another model after 60 s, for ``network_m``.

    Returns
    -------
    WithGain
    """
    from shipcosim.diagnose.pipeline import find_causes
    from shipcosim.diagnose.validation.gain import compare

    head = Path(path).with_suffix(".head.csv")
    table = pd.read_csv(path)
    table[table["time [s]"] <= UNTIL].to_csv(head, index=False)
    diagnosis = find_causes(head, system())
    problem, fit = diagnosis.basis.problem, diagnosis.basis.fit
    if diagnosis.verdict != "named" or not fit.hypotheses:
        return WithGain(diagnosis)
    under_dp = problem, compare(problem, fit)
    adrift = _compared(path, problem.noise, fit, UNTIL)
    healthy = [
        _compared(twin_of(path), problem.noise, None, until)[1] for until in (SHARE * UNTIL, UNTIL)
    ]
    under_dp = _gain(
        *under_dp, healthy[0], lambda errors: errors["start_time"].values <= UNTIL - 60.0, nameless
    )
    adrift = _gain(
        *adrift, healthy[1], lambda errors: errors["regime"].values == "drifting", nameless
    )
    return WithGain(replace(diagnosis, gain=under_dp), adrift)


def twin_of(path):
    """Where the healthy twin of a log is."""
    return Path(path).with_suffix(".twin.csv")


def _compared(path, noise, fit, until):
    """Problem of a log, and predictions on it after some time by the causes of a fit, fitted until then."""
    from shipcosim.diagnose.checked_log import checked
    from shipcosim.diagnose.inference.fitting import fitted
    from shipcosim.diagnose.inference.problem import identification_problem
    from shipcosim.diagnose.pipeline import read_measurements
    from shipcosim.diagnose.validation.gain import compare

    log = checked(read_measurements(path, system()))
    problem = identification_problem(log.repaired, log.ship, log.causes, noise)
    fit = fitted(problem, fit.hypotheses, fit.values) if fit else fitted(problem)
    return problem, compare(problem, fit, train=problem.record.time <= until)


def _gain(case, compared, healthy, chosen, nameless):
    """The gain on some of the predictions, and how many; None where there are none."""
    from shipcosim.diagnose.validation.gain import gain, rms
    from trial.gains import chance_of_more

    parts = []
    for one in (compared, healthy):
        some = np.flatnonzero(chosen(one.errors)) if one else []
        if not len(some):
            return None
        parts.append(one.errors.isel(segment=some))
    (errors, twins), found = parts, {}
    for name, (one, model) in _BESIDE.items():
        found[name] = rms((errors, twins)[one], "position", model)
    found["chance_worse"] = chance_of_more(errors, "extended_observer", "bias_observer")
    if nameless:
        missed = nameless(case, compared)[chosen(compared.errors)]
        found["network_m"] = float(np.sqrt((missed**2).mean()))
    return gain(errors) | found | {"segments": errors.sizes["segment"]}
