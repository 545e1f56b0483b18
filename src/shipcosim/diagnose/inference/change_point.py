"""Whether a cause began during the log: the rows before it are then healthy, and the rest is diagnosed on its own."""

import numpy as np

from shipcosim.diagnose.inference.evidence import evidence, gram
from shipcosim.diagnose.inference.fitting import fitted, probes
from shipcosim.diagnose.inference.innovations import innovations
from shipcosim.diagnose.inference.linearisation import beside
from shipcosim.diagnose.inference.search import at_first_sight, explain, without_causes

_BLOCK = 60.0  # s
_BLIND = 2  # blocks after an onset, in which the filter still answers to it
_WORTH = 6.0  # nats, for a second look; twice that to be believed


def begun(problem, fits):
    """When the likeliest cause would have begun: where the log splits best into rows without and with it.

    Parameters
    ----------
    problem : IdentificationProblem
    fits : list of Fit
        Of `explain`.

    Returns
    -------
    float or None
        Time [s]; None where nothing is gained by an onset.
    """
    nothing = without_causes(fits)
    hypotheses = [hypothesis for hypothesis in problem.hypotheses if hypothesis.effect.law != "turning"]
    groups = [group for hypothesis in hypotheses for group in probes(hypothesis)]
    linear = beside(nothing.linear, problem.base_of([column for group in groups for column in group]))
    parts = max(int(problem.record.time.size * problem.record.step / _BLOCK), 8)
    blocks = gram(innovations(linear, problem.noise, problem.record), parts).blocks
    known, place, gains = len(nothing.columns), len(nothing.columns), []
    priors = []
    for group in groups:
        prior = np.zeros(linear.driven.shape[-1] - 1)
        prior[:known] = prior[place : place + len(group)] = 1.0
        place += len(group)
        priors.append(prior)
    none = np.where(np.arange(prior.size) < known, 1.0, 0.0)
    for first in range(3, parts - _BLIND - 3):
        before, after = blocks[:first].sum(0), blocks[first + _BLIND :].sum(0)
        healthy, throughout = evidence(before, none)[0], before + after
        later = max(evidence(after, prior)[0] for prior in priors)
        gains.append(healthy + later - max(evidence(throughout, prior)[0] for prior in (none, *priors)))
    if not gains:  # too short to be parted
        return None
    best = int(np.argmax(gains))
    row = round((3 + best) / parts * problem.record.time.size)
    return float(problem.record.time[row]) if gains[best] > _WORTH else None


def from_change_point(clean, problem, fits, prepare):
    """The diagnosis of the rows after an onset, where that explains the whole log better.

    Parameters
    ----------
    clean : xarray.Dataset
        Repaired log.
    problem : IdentificationProblem
    fits : list of Fit
        Of the whole log.
    prepare : callable
        Makes the case of a part of the log.

    Returns
    -------
    tuple of float, xarray.Dataset, Case, list of Fit, or None
        Time of the onset [s], and the later rows with their case and fits.
    """
    time = begun(problem, fits)
    if time is None:
        return None
    row = int(np.searchsorted(clean["time"].values, time))
    earlier, later = clean.isel(time=slice(0, row)), clean.isel(time=slice(row, None))
    healthy, after = fitted(prepare(earlier)), prepare(later)
    if healthy.score + at_first_sight(after) < fits[0].score:
        return None
    found = explain(after)
    if healthy.score + found[0].score < fits[0].score + 2.0 * _WORTH:
        return None
    return time, later, after, found
