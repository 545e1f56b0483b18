"""Channels of thrusters and wind that are not what they are labelled: only the ship's response shows it.

Each way in which they could be wrong is undone, over all the log, and the likelihood row by row compared with that of
the log as it is: where the difference adds up most is about the segment in which they are wrong. Its ends are refined
about a motion that is smoothed with it corrected, on which every wrong row counts.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
import xarray

from shipcosim.diagnose.finding import Finding, Segment
from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.fitting import IdentificationProblem
from shipcosim.diagnose.inference.innovations import inner_products, innovations
from shipcosim.diagnose.inference.parts import explained, linearised_by_parts
from shipcosim.diagnose.inference.workers import each
from shipcosim.diagnose.log.mislabels import (
    WIND_LABELS,
    Mislabel,
    drive_channels,
    exchanged,
    finding_of,
    late,
    negative,
    possible,
    undone,
)
from shipcosim.diagnose.log.rows import arrays_of, inside
from shipcosim.diagnose.log_faults.thresholds import (
    FIRST_MOVE,
    LAGS_TRIED,
    LEAST_ROW_GAIN,
    MOST_PLACES,
    PART_GAIN,
    SEARCH_STEP,
    SEGMENT_GAIN,
    SHORTEST_INPUT,
    SHORTEST_LABEL,
    WHOLE,
)
from shipcosim.diagnose.numerics import running_sums
from shipcosim.diagnose.ship.inputs import Record, record_of, with_inputs_of

WHERE_TO = Mislabel(
    "frame",
    ("wind_from",),
    "wind_from is where the wind goes to",
    lambda log: {"wind_from": np.mod(log["wind_from"] + 180.0, 360.0)},
)


def _late(role, seconds):
    """A thruster's channel that comes late; rows that have no value, and the last, stay as they are.

    With more rows the log would be likelier, whatever comes late.
    """
    label = late((role,), ("the other channels",), seconds)

    def undo(log):
        stays = (log["time"] + seconds > log["time"][-1]) | ~np.isfinite(log[role])
        return {role: np.where(stays, log[role], label.undo(log)[role])}

    return replace(label, undo=undo)


def suspected_inputs(log: xarray.Dataset, problem: IdentificationProblem) -> list[Finding]:
    """Channels of thrusters and wind that could be mislabelled, likeliest first.

    Parameters
    ----------
    log : xarray.Dataset
        Repaired.
    problem : IdentificationProblem
        Of it.

    Returns
    -------
    list of Finding
        What would be wrong, and about where.
    """
    # Log-likelihood of each row as logged, as the reference.
    base = _by_row(problem, problem.record)
    gained = []
    # For each mislabel the gain of each row if it is
    # undone everywhere, and the segment of largest sum.
    for mislabel in _mislabels(log, problem.model):
        gain = _by_row(problem, record_of(with_label(log, mislabel), problem.model)) - base
        is_lag = mislabel.cause == "channel_lag"
        shortest = SHORTEST_LABEL if is_lag else SHORTEST_INPUT
        total, finding = where_best(gain, mislabel, problem.record, shortest)
        if is_lag:
            # A lag shows at every move, an error of the model at one: the less telling half counts.
            halves = np.array_split(gain[inside(problem.record.time, finding.segments)], 2)
            total = 2.0 * min(half.sum() for half in halves)
        if total > LEAST_ROW_GAIN:
            gained.append((total, finding))
    return [finding for _, finding in sorted(gained, key=lambda entry: -entry[0])]


def with_refined_segment(
    log: xarray.Dataset, finding: Finding, problem: IdentificationProblem
) -> Finding:
    """A finding with the ends of its segment where the log is likeliest.

    Parameters
    ----------
    log : xarray.Dataset
        Repaired, the finding not corrected.
    finding : Finding
        Of a mislabel, with one segment, or throughout.
    problem : IdentificationProblem
        Of the log with the finding corrected.

    Returns
    -------
    Finding
        The same one if no other segment gains enough.
    """
    # Log-likelihoods by the ends of the segment, kept since the search returns to the same ones.
    time = problem.record.time
    cached = {}
    least = round(SHORTEST_INPUT / problem.record.step)
    last = time.size - 1

    def segment(ends):
        return ((float(time[ends[0]]), float(time[ends[1]])),)

    def likelihood_of(ends):
        if not 0 <= ends[0] <= ends[1] - least <= last - least:
            return -np.inf
        if ends not in cached:
            relabelled = with_label(log, finding.mislabel, segment(ends))
            record = with_inputs_of(problem.record, relabelled, problem.model)
            cached[ends] = likelihood(problem, record)
        return cached[ends]

    def likelihoods_of(many):
        """Likelihoods of several segments, computed side by side."""
        return dict(zip(many, each(likelihood_of, many), strict=True)).get

    # Start from the segment at hand, and search coarsely, then finely.
    whole = (0, last)
    first = (
        tuple(int(i) for i in np.searchsorted(time, finding.segments[0]))
        if finding.segments
        else whole
    )
    stride = max(round(SEARCH_STEP / problem.record.step), last // MOST_PLACES)
    ends = _likeliest_ends(likelihoods_of, first, last, stride)
    # Part of a log instead of all of it needs more evidence than another segment.
    least_gain = PART_GAIN if first == whole else SEGMENT_GAIN
    gained = likelihood_of(ends) >= likelihood_of(first) + least_gain
    return replace(finding, segments=segment(ends)) if gained else finding


def _likeliest_ends(likelihoods_of, first, last, stride):
    """First and last row of the likeliest segment: each end anywhere in coarse steps, then moved by halved steps."""
    ends = first
    # Coarse search: each end over all places, twice, as the ends depend on each other.
    places = [*range(0, last, stride), last]
    for _ in range(2):
        for i in (0, 1):
            tried = list(dict.fromkeys([ends, *(_moved(ends, i, place) for place in places)]))
            ends = max(tried, key=likelihoods_of(tried))
    # Pattern search: move either end by a step, and halve the step when no move helps.
    step = max(FIRST_MOVE, stride // 2)
    while step:
        tried = [_moved(ends, i, ends[i] + by) for i in (0, 1) for by in (-step, step)]
        likelihood_of = likelihoods_of([*tried, ends])
        best = max(tried, key=likelihood_of)
        ends, step = (
            (best, step) if likelihood_of(best) > likelihood_of(ends) else (ends, step // 2)
        )
    return ends


def _moved(ends, i, place):
    return (place, ends[1]) if i == 0 else (ends[0], place)


def likelihood(problem: IdentificationProblem, record: Record) -> float:
    """Log-likelihood of a record about the motion of a problem, up to a constant. [nats]"""
    linear = linearised_by_parts(problem.motion, record, problem.model, [])
    return float(inner_products(linear, problem.noise, record).free)


def _mislabels(log, model):
    """Every way in which channels of thrusters and wind could be wrong."""
    # Two thrusters of the same make can be exchanged: all their channels, or all but the speed.
    mislabels = []
    for first, other in combinations(model.thrusters, 2):
        pairs = [(role, other + role.removeprefix(first)) for role in drive_channels(first, log)]
        pairs = [pair for pair in pairs if pair[1] in log]
        if model.make_of(first) == model.make_of(other):
            mislabels += [
                exchanged(group)
                for group in ([pairs] if len(pairs) == 1 else [pairs, pairs[1:]])
                if group
            ]
    # Wrong signs of speed, thrust and azimuth, and each of these channels late.
    for name in model.thrusters:
        for role in drive_channels(name, log):
            mislabels.append(negative(role))
            mislabels += [_late(role, lag) for lag in LAGS_TRIED]
    # Labels of the wind that involve the motion need its channels.
    if "wind_from" in log:
        motion = all(role in log for role in ("heading", "surge", "sway"))
        labels = WIND_LABELS if motion else (negative("wind_from"),)
        mislabels += possible((*labels, WHERE_TO), log)
    return mislabels


def with_label(
    log: xarray.Dataset, mislabel: Mislabel, segments: Sequence[Segment] = ()
) -> xarray.Dataset:
    """A repaired log with a mislabel undone, in segments [s] or everywhere."""
    fixed = undone(arrays_of(log), mislabel, segments)
    return log.assign({role: log[role].copy(data=fixed[role]) for role in mislabel.channels})


def _by_row(problem, record):
    """Log-likelihood of each row, known numbers fitted within their tolerances; what that costs is shared by all."""
    # Fit the uncertain parameters within their priors, so that they do not count as a mislabel.
    columns = problem.ship_columns(())
    linear = linearised_by_parts(problem.motion, record, problem.model, columns)
    theta = evidence(inner_products(linear, problem.noise, record).products, np.ones(len(columns)))[
        1
    ]
    # Whitened innovations give the Gaussian log-likelihood
    # of each row. The prior's cost is spread evenly.
    left = innovations(explained(linear, theta), problem.noise, record)
    return -0.5 * (left.squares + left.log_determinant + (theta**2).sum() / linear.rows)


def where_best(
    gain: np.ndarray, mislabel: Mislabel, record: Record, shortest: float = SHORTEST_INPUT
) -> tuple[float, Finding]:
    """Sum of the gains of rows where a mislabel explains most, and the finding of it there."""
    first, last, total = best_run(gain, round(shortest / record.step))
    whole = last - first > WHOLE * record.time.size
    segment = None if whole else (float(record.time[first]), float(record.time[last]))
    return total, finding_of(mislabel, 0.99, segment)


def best_run(gain: np.ndarray, least: int) -> tuple[int, int, float]:
    """First and last row of the run of at least `least` rows whose gains add up to most, and the sum."""
    # Maximum subarray of a minimal length: the running minimum stays this many rows behind.
    if gain.size < least:
        return 0, 0, -np.inf
    total = running_sums(gain)
    sums = total[least:] - np.minimum.accumulate(total[: total.size - least])
    last = int(np.argmax(sums))
    first = int(np.argmin(total[: last + 1]))
    return first, last + least - 1, float(sums[last])
