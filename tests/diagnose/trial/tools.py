"""What the trial has diagnosed: functions of the path of a log."""

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

ROOT = Path(__file__).resolve().parents[3]
UNTIL = 2400.0  # end of the log that is diagnosed, where a drift follows it [s]


@cache
def system():
    """The lengthened Gunnerus with her thrusters' inputs open."""
    from shipcosim.ssp import read_system

    return read_system(ROOT / "ssp" / "gunnerus_open", fmus=[ROOT / "build" / "fmus"])


def ours(path):
    """The project's own diagnosis."""
    from shipcosim.diagnose.run import diagnose

    return diagnose(path, system())[0]


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


def with_drift(path):
    """The diagnosis of a log until `UNTIL`; its gain there, and in the drift at the end, which it has not seen.

    Both in the array form, where a cause of the physics is named.
    """
    from shipcosim.diagnose.gain import compare, gain
    from shipcosim.diagnose.run import diagnose

    head = Path(path).with_suffix(".head.csv")
    table = pd.read_csv(path)
    table[table["time [s]"] <= UNTIL].to_csv(head, index=False)
    diagnosis, details = diagnose(head, system())
    if diagnosis.verdict != "named" or not details.fit.suspects:
        return WithGain(diagnosis)
    found = compare(details.case, details.fit)
    if found:
        diagnosis = replace(diagnosis, gain=gain(found.errors))
    return WithGain(diagnosis, _gain_in_drift(path, details))


def _gain_in_drift(path, details):
    """Of the causes that were named, fitted on the rows until `UNTIL`; None where the drift is too short."""
    from shipcosim.diagnose.effects import read_catalogue
    from shipcosim.diagnose.examine import examine
    from shipcosim.diagnose.gain import compare, gain
    from shipcosim.diagnose.log import read_log
    from shipcosim.diagnose.plant import plant_of
    from shipcosim.diagnose.ranking import fitted
    from shipcosim.diagnose.repair import repaired
    from shipcosim.diagnose.run import prepare

    log = read_log(path)
    case = prepare(repaired(log, examine(log)), plant_of(system()), read_catalogue(None), details.case.noise)
    fit = fitted(case, details.fit.suspects, details.fit.values)
    found = compare(case, fit, train=case.record.time <= UNTIL)
    if found is None:
        return None
    errors = found.errors.isel(segment=np.flatnonzero(found.errors["regime"].values == "drifting"))
    return gain(errors) | {"segments": errors.sizes["segment"]} if errors.sizes["segment"] else None
