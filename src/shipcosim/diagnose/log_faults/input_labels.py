"""Channels of thrusters and wind that are not what they are labelled: only the ship's answer can tell.

Each way in which they could be wrong is undone, over all the log, and the likelihood row by row compared with that of
the log as it is: where the difference adds up most is about the segment in which they are wrong. Its ends are settled
about a motion that is smoothed with it put right: there every wrong row tells.
"""

from dataclasses import replace
from itertools import combinations

import numpy as np

from shipcosim.diagnose.inference.evidence import evidence, gram
from shipcosim.diagnose.inference.innovations import innovations
from shipcosim.diagnose.inference.linearisation import linearise
from shipcosim.diagnose.log.mislabels import WIND_LABELS, Mislabel, finding_of, negative, possible, undone
from shipcosim.diagnose.log.rows import arrays_of
from shipcosim.diagnose.ship.inputs import record_of

__all__ = ["best_run", "likelihood", "settled", "suspected", "where_best", "with_label"]

_SHORTEST = 60.0  # s
_WHOLE = 0.85  # of the log
_EVERY = 60.0  # s, between the places where an end of a segment is sought
_FIRST_STEP = 32  # rows, by which it is then moved
_WORTH = 5.0  # nats that another segment has to gain
_PART = 15.0  # nats that a segment has to gain over the whole log


def suspected(clean, problem):
    """Inputs that could be wrong, likeliest first.

    Parameters
    ----------
    clean : xarray.Dataset
        Repaired log.
    problem : IdentificationProblem
        Of it.

    Returns
    -------
    list of (float, Mislabel, Finding)
        Gain in log-likelihood [nats], what would be wrong, and about where.
    """
    base, found = _by_row(problem, problem.record), []
    for mislabel in _mislabels(clean, problem.model):
        gain = _by_row(problem, record_of(with_label(clean, mislabel), problem.model)) - base
        total, finding = where_best(gain, mislabel, problem.record)
        if total > 10.0:
            found.append((total, mislabel, finding))
    return sorted(found, key=lambda entry: -entry[0])


def settled(clean, mislabel, finding, problem):
    """A finding with the ends of its segment where the log is likeliest.

    Parameters
    ----------
    clean : xarray.Dataset
        Repaired log, the finding not put right.
    mislabel : Mislabel
    finding : Finding
        With one segment, or throughout.
    problem : IdentificationProblem
        Of the log with the finding put right.

    Returns
    -------
    Finding
        The same one if no other segment is worth it.
    """
    time, seen = problem.record.time, {}
    least, last = round(_SHORTEST / problem.record.step), time.size - 1

    def segment(ends):
        return ((float(time[ends[0]]), float(time[ends[1]])),)

    def worth(ends):
        if not 0 <= ends[0] <= ends[1] - least <= last - least:
            return -np.inf
        if ends not in seen:
            seen[ends] = likelihood(problem, record_of(with_label(clean, mislabel, segment(ends)), problem.model))
        return seen[ends]

    whole = (0, last)
    first = ends = tuple(int(i) for i in np.searchsorted(time, finding.segments[0])) if finding.segments else whole
    places = [*range(0, last, round(_EVERY / problem.record.step)), last]
    for _ in range(2):
        for i in (0, 1):
            ends = max([ends, *(_moved(ends, i, place) for place in places)], key=worth)
    step = _FIRST_STEP
    while step:
        near = [_moved(ends, i, ends[i] + by) for i in (0, 1) for by in (-step, step)]
        best = max(near, key=worth)
        ends, step = (best, step) if worth(best) > worth(ends) else (ends, step // 2)
    price = _PART if first == whole else _WORTH
    return finding if worth(ends) < worth(first) + price else replace(finding, segments=segment(ends))


def _moved(ends, i, place):
    return (place, ends[1]) if i == 0 else (ends[0], place)


def likelihood(problem, record):
    """Log-likelihood of a record about the motion of a case, up to a constant. [nats]"""
    found = innovations(linearise(problem.motion, record, problem.model, []), problem.noise, record)
    return float(gram(found).free)


def _mislabels(clean, model):
    """Every way in which channels of thrusters and wind could be wrong."""
    found = []
    for one, other in combinations(model.thrusters, 2):
        pairs = [(f"{one}_{what}", f"{other}_{what}") for what in ("rpm", "azimuth")]
        pairs = [pair for pair in pairs if pair[0] in clean and pair[1] in clean]
        if _make(model, one) == _make(model, other):
            found += [_swapped(group) for group in ([pairs] if len(pairs) == 1 else [pairs, pairs[1:]]) if group]
    for name in model.thrusters:
        found += [negative(role) for role in (f"{name}_rpm", f"{name}_azimuth") if role in clean]
    if "wind_from" in clean:
        motion = all(role in clean for role in ("heading", "surge", "sway"))
        labels = WIND_LABELS if motion else (negative("wind_from"),)
        found += possible(labels, clean)
    return found


def _make(model, name):
    """What kind of thruster it is."""
    third_party = model.third_party.get(name)
    return third_party.component.fmu.model_name if third_party else type(model.parts[name])


def _swapped(pairs):
    def undo(log):
        return {a: log[b] for a, b in pairs} | {b: log[a] for a, b in pairs}

    channels = tuple(role for side in zip(*pairs, strict=True) for role in side)
    names = " and ".join(" with ".join(pair) for pair in pairs)
    return Mislabel("channel_swap", channels, f"{names} are swapped", undo)


def with_label(clean, mislabel, segments=()):
    """A repaired log with a fault of labels undone, in segments or everywhere."""
    fixed = undone(arrays_of(clean), mislabel, segments)
    return clean.assign({role: clean[role].copy(data=fixed[role]) for role in mislabel.channels})


def _by_row(problem, record):
    """Log-likelihood of each row, known numbers fitted within their tolerances; what that costs is shared by all."""
    columns = problem.known(())
    linear = linearise(problem.motion, record, problem.model, columns)
    found = innovations(linear, problem.noise, record)
    theta = evidence(gram(found).products, np.ones(len(columns)))[1]
    left = found.white[..., 0] - found.white[..., 1:] @ theta
    return -0.5 * ((left**2).sum(-1) + found.log_determinant + (theta**2).sum() / len(left))


def where_best(gain, mislabel, record, shortest=_SHORTEST):
    """Sum of the gains of rows where a mislabel explains most, and the finding of it there."""
    first, last, total = best_run(gain, round(shortest / record.step))
    whole = last - first > _WHOLE * record.time.size
    segment = None if whole else (float(record.time[first]), float(record.time[last]))
    return total, finding_of(mislabel, 0.99, segment)


def best_run(gain, least):
    """First and last row of the run of at least `least` rows whose gains add up to most, and the sum."""
    total = np.concatenate([[0.0], np.cumsum(gain)])
    lowest, first, best = 0, 0, (0, 0, -np.inf)
    for last in range(least, gain.size + 1):
        if total[last - least] < total[lowest]:
            lowest = last - least
        first = lowest
        if total[last] - total[first] > best[2]:
            best = (first, last - 1, float(total[last] - total[first]))
    return best
