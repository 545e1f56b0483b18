"""The diagnosis from end to end: a log goes in, findings come out."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from shipcosim.diagnose.effects import read_catalogue, suspects
from shipcosim.diagnose.evidence import gram
from shipcosim.diagnose.examine import examine
from shipcosim.diagnose.finding import Diagnosis
from shipcosim.diagnose.linear import innovations
from shipcosim.diagnose.log import read_log
from shipcosim.diagnose.nameless import unexplained
from shipcosim.diagnose.noise import first_noise, tuned
from shipcosim.diagnose.plant import plant_of
from shipcosim.diagnose.ranking import Case, explain, fitted, prepared, probes, weighed
from shipcosim.diagnose.record import first_motion, record_of
from shipcosim.diagnose.repair import repaired
from shipcosim.diagnose.verdict import judge, not_testable

_MOST_WALK = 3e-5  # m/s2.5: some 400 N on Gunnerus in ten minutes


@dataclass(frozen=True)
class Details:
    """What the diagnosis rests on, for the page and for further work.

    Attributes
    ----------
    log, clean : xarray.Dataset
        As read, and repaired.
    case : Case
    fits : list of Fit
        Best first.
    fit : Fit
        The set of causes that the verdict rests on; empty where nothing is named.
    strange : dict of str to float
        Gain of nameless forces beside it, by kind. [nats]
    """

    log: Any
    clean: Any
    case: Any
    fits: list
    fit: Any
    strange: dict


def diagnose(data, system, channels=None, effects=None):
    """Diagnose a log.

    Parameters
    ----------
    data : path
        Measured data, see docs/measured-data.md.
    system : System
        The ship that the log is held against, as `read_system` gives it.
    channels : path, optional
        Channel file.
    effects : path, optional
        Folder with further causes.

    Returns
    -------
    tuple of Diagnosis, Details

    Raises
    ------
    ShipcosimError
        Data, system or causes that cannot be used.
    """
    with threadpool_limits(1):  # many small matrices: threads would only wait for each other
        log = read_log(data, channels)
        faults = examine(log)
        clean = repaired(log, faults)
        case = prepare(clean, plant_of(system), read_catalogue(effects))
        fits = explain(case)
        strange = {}

        def beside(fit):
            strange.update(unexplained(case, fit))
            return strange

        judgement = judge(case, fits, beside)
        verdict = "named" if faults and judgement.verdict == "consistent" else judgement.verdict
        diagnosis = Diagnosis(
            verdict,
            (*faults, *judgement.findings),
            judgement.candidates,
            judgement.indistinguishable,
            _not_testable(case, fits),
        )
        return diagnosis, Details(log, clean, case, fits, judgement.fit, strange)


def prepare(clean, plant, catalogue):
    """The case of a repaired log: noise tuned beside whatever explains it best at first sight.

    Parameters
    ----------
    clean : xarray.Dataset
    plant : Plant
    catalogue : dict of str to Effect

    Returns
    -------
    Case
    """
    plant = replace(plant, span=(float(clean["time"][0]), float(clean["time"][-1])))
    plant = replace(plant, wind_is_true="wind_speed" not in clean and "true_wind_speed" in clean)
    record, length = record_of(clean, plant), plant.parts["hull"].length
    noise = first_noise(record, length)
    case = prepared(Case(record, plant, tuple(suspects(catalogue, plant)), noise, first_motion(record, plant)))
    fit = fitted(case)
    gain, suspect, values = weighed(case, fit)[0]
    if gain > 3.0:
        fit = fitted(case, (suspect,), values)
    most = _MOST_WALK * np.array([1.0, 1.0, 4.0 / length])
    noise = tuned(noise, fit.linear, record, fit.left, most_walk=most)
    return prepared(replace(case, noise=noise))


def _not_testable(case, fits):
    nothing = next(fit for fit in fits if not fit.suspects)
    columns, groups = list(nothing.columns), []
    for suspect in case.suspects:
        for group in probes(suspect):
            groups.append((suspect, list(range(len(columns), len(columns) + len(group)))))
            columns.extend(group)
    products = gram(innovations(case.base_of(columns), case.noise, case.record)).products
    return not_testable(case, products, columns, groups)
