"""Channels of the navigation that are not what they are labelled, told by how the ship answers thrusters and wind.

A ship that hardly moves tells little by position against velocity, and at one heading a wrong sign of north is that of
surge. With her own law of motion each label is as likely as the motion that it tells of.
"""

from dataclasses import dataclass, replace

import numpy as np

from shipcosim.diagnose.inference.innovations import innovations
from shipcosim.diagnose.inference.linearisation import linearise
from shipcosim.diagnose.inference.noise import first_noise
from shipcosim.diagnose.log.checks.kinematics import filter_for, is_clear, position_motion
from shipcosim.diagnose.log.mislabels import HEADING_LABELS, POSITION_LABELS, mislabel_of, possible
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.log.rows import arrays_of, inside
from shipcosim.diagnose.log_faults.input_labels import where_best, with_label
from shipcosim.diagnose.ship.inputs import CHANNELS, first_motion, record_of

__all__ = ["Relabelled", "relabelled"]

LABELS = (HEADING_LABELS[0], *POSITION_LABELS)
LEAST_GAIN = 30.0  # nats of rows; healthy logs gain up to 7 in a stretch, faulty ones up to 20 by another label
BETTER = 15.0  # nats more than what was found by position against velocity
SHORTEST = 180.0  # [s]; along shorter stretches other causes look like labels
MATERIAL = 0.7  # of the root mean square of channels, by which another frame must change them
LIKELY = 4  # labels that are worth a closer look
CALM = 0.2  # of the jolts that noise is first taken to have; under a wrong label they grow to cover it


@dataclass(frozen=True)
class Relabelled:
    """Faults of a log with its navigation labelled as the ship's answer says.

    Attributes
    ----------
    faults : list of Finding
    stretch : float
        Log-density of the log as it is over that of the log with its units put right, the same values in both. [nats]
    """

    faults: list
    stretch: float


def relabelled(log, faults, problem):
    """The likeliest labels of the navigation, where they are not those that the faults say.

    Each in its likeliest stretch, and but for units throughout: row by row it is told with the noise of the log as it
    is, which a wrong label throughout swells.

    Parameters
    ----------
    log : xarray.Dataset
        As read.
    faults : list of Finding
        As from `examine`.
    problem : IdentificationProblem
        Of the log with these faults repaired.

    Returns
    -------
    list of Relabelled
    """
    told = [fault for fault in faults if mislabel_of(fault) in LABELS]
    others = [fault for fault in faults if fault not in told]
    plain = repaired(log, others)
    if len(told) > 1 or (not told and _is_clear(plain)):
        return []
    if told:
        calm = CALM * first_noise(problem.record, problem.model.parts["hull"].length).jolt
        problem = replace(problem, noise=replace(problem.noise, jolt=np.minimum(problem.noise.jolt, calm)))
    base = _by_row(problem, record_of(plain, problem.model))
    known = [mislabel_of(one) for one in told]
    labels = [label for label in possible(LABELS, plain) if label in known or _matters(plain, label)]
    gains = {label: _gain(plain, label, problem) - base for label in labels}
    found = [where_best(gain, label, problem.record, SHORTEST) for label, gain in gains.items()]
    so_far = sum(float(gains[mislabel_of(one)][inside(problem.record.time, one.segments)].sum()) for one in told)
    likely = [one for total, one in sorted(found, key=lambda one: -one[0]) if total > max(LEAST_GAIN, so_far + BETTER)]
    tried = {(one.note, one.segments): one for part in likely[:LIKELY] for one in _stretches(part)}
    less = sum(_stretch(one, problem) for one in told)
    return [Relabelled([*others, one], _stretch(one, problem) - less) for one in tried.values()]


def _stretches(found):
    """A label in its stretch and throughout; a unit throughout is a scale, which is a cause of its own."""
    return (found,) if mislabel_of(found).scale is not None else (found, replace(found, segments=()))


def _matters(plain, label):
    """Whether a label, put right, makes its channels other ones: at a heading near north earth-fixed is body-fixed."""
    right, changed, size = with_label(plain, label), 0.0, 0.0
    for role in label.channels:
        changed += np.nansum((right[role].values - plain[role].values) ** 2)
        size += np.nansum(plain[role].values ** 2)
    return label.scale is not None or bool(changed > MATERIAL**2 * size)


def _is_clear(plain):
    """Whether the ship moves so much that position against velocity has said what there is to say."""
    motion = position_motion(arrays_of(plain))
    return motion is not None and is_clear(motion, filter_for(motion)[0])


def _gain(plain, label, problem):
    """Log-likelihood of each row with a label put right, as a density of what was logged."""
    places, noise = [CHANNELS.index(role) for role in label.channels], problem.noise
    white, wave, scale = np.array(noise.white), np.array(noise.wave), np.ones(len(CHANNELS))
    if label.scale is not None:
        scale[places] = label.scale
    if label.cause == "channel_swap":
        white[places] = white[places[::-1]]
    noise = replace(noise, white=white * scale, wave=wave * scale[3:])
    whole = np.isfinite(problem.record.measured)
    record = record_of(with_label(plain, label), problem.model)
    return _by_row(replace(problem, noise=noise), record) + whole @ np.log(scale)


def _by_row(problem, record):
    """Log-likelihood of each row, about the motion that the record itself tells of."""
    motion = first_motion(record, problem.model)
    for _ in range(2):
        motion = innovations(linearise(motion, record, problem.model, []), problem.noise, record, motion).motion
    found = innovations(linearise(motion, record, problem.model, []), problem.noise, record)
    return -0.5 * ((found.white[..., 0] ** 2).sum(-1) + found.log_determinant)


def _stretch(finding, problem):
    """Logarithm of the factors by which a finding changes the values of its channels."""
    scale = mislabel_of(finding).scale or 1.0
    places = [CHANNELS.index(role) for role in finding.channels]
    here = np.isfinite(problem.record.measured[:, places]) & inside(problem.record.time, finding.segments)[:, None]
    return float(np.log(scale) * here.sum())
