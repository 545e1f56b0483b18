"""Mislabelled channels of the navigation, found from how the ship responds to thrusters and wind.

On a ship that hardly moves position against velocity says little, and at one heading a wrong sign of north is that of
surge. By her equations of motion each label is as likely as the motion that it describes.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray

from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.inference.fitting import IdentificationProblem
from shipcosim.diagnose.inference.innovations import innovations, smoothed
from shipcosim.diagnose.inference.noise import first_noise
from shipcosim.diagnose.inference.parts import linearised_by_parts
from shipcosim.diagnose.log.checks.kinematics import filter_for, is_clear, position_motion
from shipcosim.diagnose.log.mislabels import (
    POSITION_LABELS,
    negative,
    possible,
)
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.log.rows import arrays_of, inside
from shipcosim.diagnose.log_faults.input_labels import where_best, with_label
from shipcosim.diagnose.log_faults.thresholds import (
    BETTER_LABEL,
    CALM_JOLT,
    CHANGED,
    LABEL_GAIN,
    LIKELY_LABELS,
    SHORTEST_LABEL,
)
from shipcosim.diagnose.ship.inputs import CHANNELS, first_motion, record_of
from shipcosim.diagnose.ship.stretches import in_stretches

LABELS = (negative("yaw_rate"), *POSITION_LABELS)


@dataclass(frozen=True)
class Relabelled:
    """Faults of a log with its navigation labelled as the ship's response says.

    Attributes
    ----------
    faults : tuple of Finding
    density : float
        Log-density of the log as it is over that of the log with its units corrected, the same values in both. [nats]
    """

    faults: tuple[Finding, ...]
    density: float


def relabelled(
    log: xarray.Dataset, faults: Sequence[Finding], problem: IdentificationProblem
) -> list[Relabelled]:
    """The likeliest labels of the navigation, if they differ from those of the found faults.

    Each in its likeliest stretch, and except for units throughout: row by row it is judged with the noise of the log as it
    is, which a wrong label throughout makes too large.

    Parameters
    ----------
    log : xarray.Dataset
        As read.
    faults : sequence of Finding
        As from `examine`.
    problem : IdentificationProblem
        Of the log with these faults repaired.

    Returns
    -------
    list of Relabelled
    """
    # The log with all faults corrected but those of navigation labels.
    labelled = [fault for fault in faults if fault.mislabel in LABELS]
    others = [fault for fault in faults if fault not in labelled]
    plain = in_stretches(repaired(log, others), problem.model.length)
    # With several such faults, or none and clear kinematics, the response of the ship adds nothing.
    if len(labelled) > 1 or (not labelled and _is_clear(plain)):
        return []
    # Under a wrong label the fitted process noise is too large
    # and hides it: limit it to a share of its first guess.
    if labelled:
        calm = CALM_JOLT * first_noise(problem.record, problem.model.length).jolt
        problem = replace(
            problem, noise=replace(problem.noise, jolt=np.minimum(problem.noise.jolt, calm))
        )
    # Log-likelihood of each row as logged, and its gain with each label undone.
    base = _by_row(problem, record_of(plain, problem.model))
    found_labels = [fault.mislabel for fault in labelled]
    labels = [
        label
        for label in possible(LABELS, plain)
        if label in found_labels or _matters(plain, label)
    ]
    # A row after a step with unknown inputs is predicted by nothing: there a unit gains by its factor alone.
    judged = _judged(problem)
    gains = {label: judged * (_gain(plain, label, problem) - base) for label in labels}
    # What the present faults gain is the threshold for others, with a margin.
    so_far = sum(
        float(gains[fault.mislabel][inside(problem.record.time, fault.segments)].sum())
        for fault in labelled
    )
    tried = _likely(gains, problem.record, max(LABEL_GAIN, so_far + BETTER_LABEL))
    # Units change the density of the data; correct for the
    # factors of the faults at hand and of the candidates.
    less = sum(_density(fault, problem) for fault in labelled)
    return [
        Relabelled((*_not_answered(others, fault), fault), _density(fault, problem) - less)
        for fault in tried
    ]


def _not_answered(faults: Sequence[Finding], label: Finding) -> list[Finding]:
    """Faults without the open ones for which this label was among the readings, of all rows or of a part."""
    return [
        fault
        for fault in faults
        if not fault.alternatives or label.note not in (fault.note, *fault.alternatives)
    ]


def _judged(problem):
    """Rows that the row before predicts, as all that drives the ship is known over the step."""
    return np.r_[True, problem.record.usable[:-1]]


def _likely(gains, record, least):
    """Findings of the labels that gain most by their rows' gains, those above a least gain, in their stretches."""
    # Segment of largest gain for each label.
    stretches = [where_best(gain, label, record, SHORTEST_LABEL) for label, gain in gains.items()]
    likely = [
        finding
        for total, finding in sorted(stretches, key=lambda entry: -entry[0])
        if total > least
    ]
    # A label in its stretch and throughout; a unit throughout is a scale, which is a cause of its own.
    tried = {
        (finding.note, finding.segments): finding
        for part in likely[:LIKELY_LABELS]
        for finding in (
            (part,) if part.mislabel.scale is not None else (part, replace(part, segments=()))
        )
    }
    return tried.values()


def _matters(plain, label):
    """Whether a label, corrected, makes its channels other ones: at a heading near north earth-fixed is body-fixed."""
    # Sum of squares of the change, relative to that of the channels.
    right = with_label(plain, label)
    changed = 0.0
    size = 0.0
    for role in label.channels:
        changed += np.nansum((right[role].values - plain[role].values) ** 2)
        size += np.nansum(plain[role].values ** 2)
    return label.scale is not None or bool(changed > CHANGED**2 * size)


def _is_clear(plain):
    """Whether the ship moves so much that position against velocity already decides the labels."""
    motion = position_motion(arrays_of(plain))
    return motion is not None and is_clear(motion, filter_for(motion)[0])


def _gain(plain, label, problem):
    """Log-likelihood of each row with a label corrected, as a density of what was logged."""
    # Noise belongs to the logged channels: scale it
    # with the unit, or exchange it with the channels.
    places = [CHANNELS.index(role) for role in label.channels]
    noise = problem.noise
    white = np.array(noise.white)
    wave = np.array(noise.wave)
    scale = np.ones(len(CHANNELS))
    if label.scale is not None:
        scale[places] = label.scale
    if label.cause == "channel_swap":
        white[places] = white[places[::-1]]
    noise = replace(noise, white=white * scale, wave=wave * scale[3:])
    # Jacobian of the change of units, for each value that was measured.
    whole = np.isfinite(problem.record.measured)
    record = record_of(with_label(plain, label), problem.model)
    return _by_row(replace(problem, noise=noise), record) + whole @ np.log(scale)


def _by_row(problem, record):
    """Log-likelihood of each row, about the motion that the record itself describes."""
    # Linearise about the smoothed motion of the relabelled record, twice for the nonlinearity.
    motion = first_motion(record)
    for _ in range(2):
        motion, _ = smoothed(
            linearised_by_parts(motion, record, problem.model, []), problem.noise, record, motion
        )
    # Innovations about this motion give the log-likelihood of each row.
    by_row = innovations(
        linearised_by_parts(motion, record, problem.model, []), problem.noise, record
    )
    return -0.5 * (by_row.squares + by_row.log_determinant)


def _density(finding, problem):
    """Logarithm of the factors by which a finding changes the values of its channels."""
    scale = finding.mislabel.scale or 1.0
    places = [CHANNELS.index(role) for role in finding.channels]
    here = (
        np.isfinite(problem.record.measured[:, places])
        & (inside(problem.record.time, finding.segments) & _judged(problem))[:, None]
    )
    return float(np.log(scale) * here.sum())
