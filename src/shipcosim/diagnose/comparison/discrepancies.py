"""What differs between commanded and measured force, in words with sizes, the largest first, and what remains."""

from collections.abc import Iterator, Sequence

import numpy as np

from shipcosim.diagnose.comparison.gains import AxisGain, CommonRatio, is_beyond
from shipcosim.diagnose.comparison.label_hypotheses import LabelError
from shipcosim.diagnose.comparison.labels import Labels
from shipcosim.diagnose.comparison.missing_loads import FORCES, MissingLoad
from shipcosim.diagnose.comparison.regression import regressed
from shipcosim.diagnose.comparison.thresholds import (
    LEAST_DAMPING,
    LEAST_SUPPORT,
    MENTIONED,
    REMAINS,
    SURE_OF_GAIN,
    TOLD,
)
from shipcosim.diagnose.finding import Discrepancy

_DAMPING = "damping in"


def discrepancies_of(
    labels: Labels,
    gains: Sequence[AxisGain],
    ratio: CommonRatio | None,
    missing: Sequence[MissingLoad],
) -> list[Discrepancy]:
    """What differs between commanded and measured force: signs, then sizes, largest first, then what is left.

    A large error on an axis of which nothing of this is said is said by itself, whatever its cause.

    Parameters
    ----------
    labels : Labels
        Of the thrusters.
    gains : sequence of AxisGain
        With those labels.
    ratio : CommonRatio or None
    missing : sequence of MissingLoad
        By axis.

    Returns
    -------
    list of Discrepancy
    """
    # Wrong signs come first, whatever their size.
    signs = sorted(_wrong_signs(labels, gains), key=lambda discrepancy: -discrepancy.share)
    discrepancies = []
    # A ratio common to all axes is one finding; else each axis has its own.
    off = [gain for gain in gains if gain.is_off and gain.is_known]
    if ratio is not None and ratio.differs(MENTIONED):
        share = max((_explained_by_gain(gain) for gain in off), default=0.0)
        text = f"thrust over inertia {ratio.ratio:.2f} of the model's"
        discrepancies.append(Discrepancy(text, None, None, ratio.ratio, ratio.std, "1", share))
    else:
        discrepancies += [
            discrepancy
            for gain in gains
            if gain.is_told and (gain.is_off or gain.differs_by_way)
            for discrepancy in _weak(gain)
        ]
    if all(gain.is_common for gain in off):  # else what one thruster lacks passes for damping
        discrepancies += [discrepancy for gain in off for discrepancy in _damping(gain)]
    # Late thrust, by the support that it loses without the delay.
    if labels.used.is_late:
        text = f"thrust acts {labels.used.lag:.2g} s after its command"
        discrepancies.append(
            Discrepancy(
                text, None, None, labels.used.lag, 0.25 * labels.used.lag, "s", _of_lag(labels)
            )
        )
    discrepancies = [*signs, *sorted(discrepancies, key=lambda discrepancy: -discrepancy.share)]
    # Axes that one of these findings explains already.
    explained = {discrepancy.axis for discrepancy in discrepancies} | set(
        ratio.axes if ratio and ratio.differs(MENTIONED) else ()
    )
    # A large difference without any explanation is reported by itself, and its axis is not repeated
    # as a remainder.
    large = [load for load in missing if load.is_large and load.axis not in explained]
    rest = [
        gain
        for gain in gains
        if gain.is_off and gain.axis.name not in {load.axis for load in large}
    ]
    return [
        *discrepancies,
        *(load.discrepancy for load in large),
        *(discrepancy for gain in rest if discrepancies for discrepancy in _rest(gain)),
    ]


def _wrong_signs(labels: Labels, gains: Sequence[AxisGain]) -> Iterator[Discrepancy]:
    """Axes on which the thrusters do the opposite of what they are commanded, as logged; else the labels themselves."""
    # Interpretations that would correct wrong labels: the best, and those that cannot be told from
    # it.
    readings = [labels.best, *labels.rivals] if labels.is_wrong else []
    why = " or ".join("; ".join(map(in_words, reading.changes)) for reading in readings)
    is_reported = False
    for axis_gain in gains:
        axis = axis_gain.axis
        # Gain of the logged commands, of any sign.
        before = axis.total(labels.logged.commanded)
        fit = axis.compared(before[None])
        gain = float(fit.gains[0])
        std = float(fit.std[0])
        # Report only gains that are surely negative, on axes where the commands explain much of the
        # force.
        if gain >= -SURE_OF_GAIN * std or fit.support < LEAST_SUPPORT or fit.share < TOLD:
            continue
        # Corrected labels account for the sign if they change the commands on this axis.
        because = bool(why) and axis.is_changed(labels.logged.commanded, labels.best.commanded)
        if (
            axis_gain.is_balanced and not because
        ):  # a way that is weaker makes the sum of both look reversed
            continue
        is_reported |= because
        text = f"{FORCES[axis.name]}: wrong sign" + (f", as with {why}" if because else "")
        # Share of the unexplained mean square that the negative gain removes.
        share = _gone(fit.squares, axis.unexplained(np.zeros(before.size)))
        yield Discrepancy(text, None, axis.name, gain, std, "1", share)
    # Labels that are wrong without a reversed axis are reported once, for the ship as a whole.
    if why and not is_reported:
        gained = _gone(labels.logged.support, max(labels.best.support, 1e-9))
        yield Discrepancy(
            f"thrust does not go with its command, but with {why}",
            None,
            None,
            -1.0,
            0.0,
            "1",
            gained,
        )


def in_words(change: LabelError) -> str:
    """A change of labels: ``left and right exchanged``, ``left running the other way``."""
    if len(change.thrusters) == 2:
        return " and ".join(change.thrusters) + " exchanged"
    return f"{change.thrusters[0]} running the other way"


def _gone(left: float, before: float) -> float:
    """Share of what was there before that is gone, from 0 to 1."""
    return float(np.clip(1.0 - left / before, 0.0, 1.0))


def _explained_by_gain(gain: AxisGain) -> float:
    """Share of the error that comes from the gain, the water's load as the log has it."""
    return _gone(gain.fit.squares, gain.axis.unexplained(gain.total))


def _weak(gain: AxisGain) -> Iterator[Discrepancy]:
    """Gain on one axis, or the gains of its thrusters if they differ."""
    if max(gain.support_of_each, gain.fit.support) < LEAST_SUPPORT:
        return
    # Different gains ahead and astern say more than a mean of the two.
    share = _explained_by_gain(gain)
    if gain.differs_by_way and gain.ways is not None:
        (ahead, std), (astern, other) = gain.ways
        text = f"{FORCES[gain.axis.name]} of thrust astern over inertia {astern:.2f} of the model's, ahead {ahead:.2f}"
        yield Discrepancy(text, None, gain.axis.name, astern, other, "1", share)
        return
    # Gains of single thrusters, where they can be told apart and differ surely from 1.
    apart = {} if gain.is_common or not gain.has_thrusters_apart else gain.each
    apart = {
        n: v
        for n, v in apart.items()
        if v > SURE_OF_GAIN * gain.each_std[n]
        and abs(v - 1.0) > SURE_OF_GAIN * gain.each_std[n] + MENTIONED - 1.0
    }
    for name, value in apart.items():
        text = f"{FORCES[gain.axis.name]} of {name} over inertia {value:.2f} of the model's"
        yield Discrepancy(text, name, gain.axis.name, value, gain.each_std[name], "1", share)
    # Otherwise one gain for all thrusters of the axis.
    if gain.is_common and gain.is_known and gain.differs(MENTIONED):
        text = f"{FORCES[gain.axis.name]} over inertia {gain.gain:.2f} of the model's"
        yield Discrepancy(text, None, gain.axis.name, gain.gain, gain.std, "1", share)


def _damping(gain: AxisGain) -> Iterator[Discrepancy]:
    """Discrepancy of the resistance, if the log shows it."""
    axis = gain.axis
    fit = gain.fit
    # Damping can only be compared where thrust has a positive gain and the model a load of the
    # water.
    if fit.gains[0] <= 0.0 or not np.any(axis.hull):
        return
    scale = max(gain.gain, float(fit.gains[0])) / float(
        fit.gains[0]
    )  # what makes the gain look small does it to both
    # Damping and its standard deviation, scaled like the gain; both share the error of the scale.
    damping = fit.damping * scale
    std = fit.damping_std * scale + fit.damping * scale * gain.std / gain.gain
    # Alternative fit: the damping of the model as it is, thrust and other forces free.
    left = regressed(
        axis.force - axis.hull,
        np.concatenate([gain.total[:, None], axis.rest[:, 3:]], axis=1),
        np.r_[False, axis.positive[3:]],
        axis.block,
    )
    # Log-likelihood ratio of free over modelled damping.
    support = 0.5 * left.independent * np.log(left.squares / fit.squares)
    far = is_beyond(max(damping, 0.01), std, MENTIONED, SURE_OF_GAIN)
    if support > LEAST_SUPPORT and far and damping > max(SURE_OF_GAIN * std, LEAST_DAMPING):
        text = f"{_DAMPING} {axis.name} over inertia {damping:.2f} of the model's"
        yield Discrepancy(
            text, None, axis.name, damping, std, "1", float(1.0 - fit.squares / left.squares)
        )


def _of_lag(labels: Labels) -> float:
    """Share of the support that only a lag gives."""
    return float(
        np.clip(
            0.0 if not labels.used.support else labels.used.gained_by_lag / labels.used.support,
            0.0,
            1.0,
        )
    )


def _rest(gain: AxisGain) -> Iterator[Discrepancy]:
    """Discrepancy that no other finding explains."""
    left = gain.fit.squares / float((gain.axis.force**2).mean())
    if left > REMAINS:
        name = FORCES[gain.axis.name]
        text = f"{name}: {100.0 * left:.0f} % of the measured force remains unexplained"
        yield Discrepancy(text, None, gain.axis.name, left, 0.0, "1", 0.0)
