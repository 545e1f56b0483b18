"""Sides and signs of thrusters: which labels of their channels make the commanded force agree with the measured force.

Three measures tell. The *fit* holds commanded against measured force, smoothed, each axis by itself. The *foresight* asks
whether commands come before what they do. The *likelihood* takes all axes at once, with errors that are autocorrelated
and one gain. Each is misled by something: the fit by what thrusters answer, the foresight by a steady command, the
likelihood by noise that the controller does not see. A reading is believed that two of them prefer beyond doubt.

Beside them stands the power: thrusters that sail a craft cannot take energy out of her surge and yaw.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.comparison.axes import Axis
from shipcosim.diagnose.comparison.causality import causal_support
from shipcosim.diagnose.comparison.commanded import Commanded, late
from shipcosim.diagnose.comparison.label_hypotheses import (
    LabelHypothesis,
    changes_of,
    driven,
    reading,
)
from shipcosim.diagnose.comparison.likelihood import Blocks, blocks_of, likelihood_of, smoothed
from shipcosim.diagnose.comparison.measured_force import MeasuredForce
from shipcosim.diagnose.comparison.thresholds import (
    AGREED,
    ALIKE,
    BRAKES,
    CHANGE_COST,
    CONTRADICTED,
    LAG_COST,
    LEAST_GAIN,
    LEAST_SUPPORT,
    LIKELIHOOD_LAGS,
    MOST_WEIGHED,
    OPPOSITE,
    PLAINLY_WRONG,
    RIVAL,
    SURELY_BRAKES,
    SURELY_CAUSED,
    SURELY_WRONG,
    TOLD,
    UNLIKELIER,
)
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.smoothing import froude_time


@dataclass(frozen=True)
class Labels:
    """What the labels of the thrusters' channels are.

    Attributes
    ----------
    logged : LabelHypothesis
        As logged.
    best : LabelHypothesis
        That explains most; where the labels are wrong the one that is believed.
    rivals : tuple of LabelHypothesis
        Other readings that cannot be told from the best.
    is_wrong : bool
        Whether the labels are wrong beyond doubt, in one way or another.
    is_judged : bool
        Whether the log tells if they are.
    margin : float
        By how much the best reading is better than the logged one. [nats]
    """

    logged: LabelHypothesis
    best: LabelHypothesis
    rivals: tuple[LabelHypothesis, ...] = ()
    is_wrong: bool = False
    is_judged: bool = True
    margin: float = 0.0

    @property
    def is_sure(self) -> bool:
        """Whether the correction of the labels is known."""
        return self.is_wrong and not self.rivals

    @property
    def used(self) -> LabelHypothesis:
        """The best reading if it is certain, else the logged one."""
        return self.best if self.is_sure else self.logged


@dataclass(frozen=True)
class _Weighed:
    """A reading with its evidence by each measure, less the cost of its changes. [nats]

    `drives`: the correlation of what the thrusters are commanded with how the craft moves, the lesser of surge and yaw.
    """

    reading: LabelHypothesis
    fit: float
    foresight: float
    likelihood: float
    drives: float

    @property
    def measures(self) -> np.ndarray:
        """Evidence by the three measures, (3,) array."""
        return np.array([self.fit, self.foresight, self.likelihood])

    def over(self, other: _Weighed) -> np.ndarray:
        """Gain by the three measures, (3,) array, the smallest first."""
        # Differences by measure in ascending order.
        return np.sort(self.measures - other.measures)

    def beats(self, other: _Weighed, least: float) -> bool:
        """Whether two measures prefer it by `least`, the third does not speak against it, nor all three together."""
        worst, middle, _ = over = self.over(other)
        # Two of three tests must agree; the third is capped, so that one extreme value does not
        # decide.
        return bool(
            middle > least
            and worst > -CONTRADICTED
            and not self.brakes_more_than(other)
            and np.minimum(over, CONTRADICTED).sum() > 2.0 * least
        )

    def brakes_more_than(self, other: _Weighed) -> bool:
        """Whether by this reading the thrusters surely brake the craft, and more than by the other."""
        return self.drives < min(-SURELY_BRAKES, other.drives)

    def is_as(self, other: _Weighed) -> bool:
        """Whether two readings have the same effect with a different number of changes."""
        # Undo the cost of changes: compare what the measures themselves give.
        cost = CHANGE_COST * (len(self.reading.changes) - len(other.reading.changes))
        return bool(np.abs(self.measures + cost - other.measures).max() < ALIKE)


def read_labels(
    record: Record, measured: MeasuredForce, axes: Sequence[Axis], model: ShipModel
) -> Labels:
    """The readings of the thrusters' channels.

    Other readings than the logged one are only tried where that is in doubt: where on some axis the thrusters together
    do not surely what they are commanded, or one of them does surely the opposite; and where they do it late: half a
    period of a manoeuvre late looks like a wrong sign.

    Parameters
    ----------
    record : Record
    measured : MeasuredForce
    axes : sequence of Axis
    model : ShipModel
        With surrogates of third-party FMUs.

    Returns
    -------
    Labels
    """
    # Logged labels that already explain each axis without delay need no alternatives.
    logged = reading((), record, measured, axes, model)
    if not logged.lag and all(_does_as_told(axis, logged.commanded) for axis in axes):
        return Labels(logged, logged)
    # The fit is cheap: evaluate all interpretations, and weigh only the credible ones by the other
    # measures.
    hypotheses = [
        logged,
        *(reading(changes, record, measured, axes, model) for changes in changes_of(record, model)),
    ]
    credible = [
        hypothesis
        for hypothesis in hypotheses[1:]
        if hypothesis.score > logged.score - CONTRADICTED
    ]
    credible = sorted(credible, key=lambda hypothesis: -hypothesis.score)[:MOST_WEIGHED]
    weighed = _weighed([logged, *credible], record, measured, model)
    # Two decisions: by the fit, checked by the others, and by agreement of two measures.
    labels = _by_fit(weighed, axes)
    agreed = _by_agreement(weighed)
    # Both sure but different: nothing is decided.
    if labels.is_sure and agreed and agreed.is_sure and agreed.best is not labels.best:
        return Labels(logged, labels.best, (agreed.best,), is_judged=False)
    if agreed and (agreed.is_sure or not labels.is_wrong):
        return agreed
    return labels


def _weighed(
    hypotheses: Sequence[LabelHypothesis], record: Record, measured: MeasuredForce, model: ShipModel
) -> list[_Weighed]:
    """Readings with what the three measures say, the logged one first."""
    # Likelihood and foresight need the log in blocks, prepared once.
    unit = froude_time(model.length)
    smooth = smoothed(measured)
    log = blocks_of(measured, driven(hypotheses[0].units, record, smooth, model), model)
    foresight = causal_support(measured, [hypothesis.commanded for hypothesis in hypotheses], unit)
    weighed = []
    for candidate, seen in zip(hypotheses, foresight, strict=True):
        commanded = driven(candidate.units, record, smooth, model)
        # All measures pay for changes; the likelihood has its own delay.
        cost = CHANGE_COST * len(candidate.changes)
        likelihood = max(_likelihoods(log, commanded, candidate, unit))
        drives = _drives(candidate.commanded, measured)
        weighed.append(
            _Weighed(candidate, candidate.score, float(seen) - cost, likelihood - cost, drives)
        )
    return weighed


def _drives(commanded: Commanded, measured: MeasuredForce) -> float:
    """Correlation, about zero, of commanded load and speed, the lesser of surge and yaw; 0 on an axis at rest.

    Sway does not count: a rudder pushes against the drift of a turning ship.
    """
    # Power: load times velocity, normalised, over usable rows.
    loads = commanded.thrust[:, measured.usable]
    correlations = []
    for load, speed in ((loads[0], measured.motion.u), (loads[2], measured.motion.r)):
        speed = np.asarray(speed)[measured.usable]
        most = np.sqrt((load @ load) * (speed @ speed))
        correlations.append(float(load @ speed / most) if most > 0.0 else 0.0)
    return min(correlations)


def _likelihoods(
    log: Blocks, commanded: Commanded, hypothesis: LabelHypothesis, unit: float
) -> Iterator[float]:
    """Log-likelihood of a reading for each lag of the thrusters, less the cost of the lag. [nats]"""
    for lag in LIKELIHOOD_LAGS:
        # A longer delay is less likely beforehand.
        moved = late(commanded, lag * unit / hypothesis.step) if lag else commanded
        yield likelihood_of(log, moved, hypothesis.ahead) - (LAG_COST + lag if lag else 0.0)


def _by_fit(weighed: Sequence[_Weighed], axes: Sequence[Axis]) -> Labels:
    """The reading that fits best, and whether it is certain and nothing contradicts it."""
    first, ranked = weighed[0], sorted(weighed, key=lambda each: -each.fit)
    best = ranked[0]
    logged = first.reading
    # By the labels as logged the thrusters would brake the craft: readings by which they do, too, are no rivals.
    brakes = first.drives < -BRAKES < BRAKES < best.drives
    others = [hypothesis for hypothesis in ranked[1:] if not brakes or hypothesis.drives > 0.0]
    rivals = tuple(hypothesis.reading for hypothesis in others if hypothesis.fit > best.fit - RIVAL)
    # Gain in fit, and whether the logged labels are plainly wrong by it.
    gained = best.fit - first.fit
    plain = _is_contradicted(best.reading, logged, axes) or gained > PLAINLY_WRONG
    # How much the foresight must agree: more where the interpretation explains little, less where
    # other evidence is strong.
    if _explained(best.reading, logged, axes) <= TOLD:
        least = SURELY_CAUSED
    elif brakes:
        least = -UNLIKELIER
    else:
        least = 0.0 if plain else RIVAL
    changes = CHANGE_COST * len(best.reading.changes)
    # Changed labels need a clear gain in fit, no better logged rival, no braking, and foresight.
    is_wrong = (
        gained > (RIVAL if brakes else SURELY_WRONG)
        and logged not in rivals
        and not best.brakes_more_than(first)
        and best.foresight - first.foresight + changes > least
    )
    # The likelihood may not clearly prefer another interpretation.
    likeliest = max(hypothesis.likelihood for hypothesis in (best, *others))
    is_wrong &= (
        best.likelihood + changes > first.likelihood - UNLIKELIER
        and best.likelihood > likeliest - UNLIKELIER
    )
    # The log decides if labels are wrong, or if the logged ones beat every different
    # interpretation.
    is_judged = is_wrong or all(
        first.beats(hypothesis, RIVAL) or hypothesis.is_as(first) for hypothesis in weighed[1:]
    )
    return Labels(logged, best.reading, rivals, is_wrong, is_judged, gained)


def _by_agreement(weighed: Sequence[_Weighed]) -> Labels | None:
    """The reading that two measures clearly prefer to all others, the logged one included; None if there is none."""
    first = weighed[0]
    for hypothesis in weighed[1:]:
        # Interpretations with the same effect are no competitors.
        others = [other for other in weighed[1:] if other is not hypothesis]
        twins = [other for other in others if hypothesis.is_as(other)]
        rest = [other for other in others if other not in twins]
        # Among equivalent ones, fewest changes are preferred; the rest remain rivals.
        if hypothesis.beats(first, AGREED) and all(
            hypothesis.beats(other, RIVAL) for other in rest
        ):
            fewest = min(len(other.reading.changes) for other in (hypothesis, *twins))
            simplest = [
                other.reading
                for other in (hypothesis, *twins)
                if len(other.reading.changes) == fewest
            ]
            return Labels(
                first.reading,
                simplest[0],
                tuple(simplest[1:]),
                True,
                True,
                float(hypothesis.over(first)[1]),
            )
    return None


def _is_contradicted(best: LabelHypothesis, logged: LabelHypothesis, axes: Sequence[Axis]) -> bool:
    """True if the logged labels clearly give a wrong sign on an axis where this reading differs."""
    for axis in axes:
        if axis.is_driven(logged.commanded) and axis.is_changed(logged.commanded, best.commanded):
            # One gain for the logged commands, of any sign.
            fit = axis.compared(axis.total(logged.commanded)[None])
            if (
                fit.gains[0] < -OPPOSITE * fit.std[0]
                and fit.support > LEAST_SUPPORT
                and fit.share > TOLD
            ):
                return True
    return False


def _explained(best: LabelHypothesis, logged: LabelHypothesis, axes: Sequence[Axis]) -> float:
    """Largest share of the measured force that a reading explains on an axis where it differs from the logged one."""
    shares = [0.0]
    for axis in axes:
        if axis.is_changed(logged.commanded, best.commanded) and axis.is_driven(best.commanded):
            shares.append(axis.explained(_each(axis, best.commanded)).share)
    return max(shares)


def _does_as_told(axis: Axis, commanded: Commanded) -> bool:
    """Whether the thrusters clearly follow their commands on an axis, and none acts the opposite way."""
    if not axis.is_driven(commanded):
        return True
    # Gain of the sum and gains of each thruster.
    each = _each(axis, commanded)
    together = axis.compared(each.sum(0)[None])
    apart = axis.compared(each)
    opposite = bool(np.any(apart.gains < -OPPOSITE * np.maximum(apart.std, 1e-9)))
    return not opposite and together.gains[0] > max(OPPOSITE * together.std[0], LEAST_GAIN)


def _each(axis: Axis, commanded: Commanded) -> np.ndarray:
    """Commanded force of each thruster that acts on an axis, (k, n) array."""
    return np.stack(
        [axis.smoothed(load) for load in commanded.thrusters.values() if np.any(load[axis.number])]
    )
