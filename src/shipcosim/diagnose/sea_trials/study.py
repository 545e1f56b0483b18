"""A study of sea trials: which causes explain one side's circles, and how well they predict the others."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import combinations
from typing import Any

import numpy as np

from shipcosim.diagnose.checked_log import checked
from shipcosim.diagnose.experiment.design import (
    MOST_SETS,
    ExperimentDesign,
    Separation,
    differing,
    prescribed,
)
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.catalogue import Hypothesis, hypotheses_of
from shipcosim.diagnose.hypotheses.cause import Cause
from shipcosim.diagnose.log.runs import LogSource
from shipcosim.diagnose.pipeline import read_measurements
from shipcosim.diagnose.sea_trials import thresholds
from shipcosim.diagnose.sea_trials.evidence import (
    SetOfCauses,
    TrialEvidence,
    allowed_for,
    changes_of,
    predicted,
    ranked,
    trial_evidence,
)
from shipcosim.diagnose.sea_trials.features import ANGLES, FEATURES, features_of
from shipcosim.diagnose.sea_trials.sailing import sailed
from shipcosim.diagnose.sea_trials.separation import separations
from shipcosim.diagnose.sea_trials.windows import SeaTrial, as_ordered, sea_trials_of
from shipcosim.diagnose.ship.inputs import record_of, source_of
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.errors import error_at
from shipcosim.ssp import AnyPath, System

STEPS = {
    "which manoeuvres are in the log?": 1.0,
    "fitted on circles to port, judged on the others": 5.0,
    "fitted on circles to starboard, judged on the others": 5.0,
    "fitted on all manoeuvres": 5.0,
    "what would tell causes apart": 5.0,
}
"""Steps that `study` reports to its progress function, in order, with their typical times. [s]"""


@dataclass(frozen=True)
class HeldOut:
    """Causes fitted on some trials and judged on others.

    Attributes
    ----------
    fitted_on, judged_on : tuple of str
        Names of the trials.
    ranking : tuple of SetOfCauses
        Best first.
    before, after : dict of str to float
        Root mean square error of each feature on the trials judged on, in per cent (drift in deg), of the ship as
        modelled and with the best set.
    fitted : dict of str to float
        What the best set adds to the numbers of the ship, and what the trials fitted on say of compass and antenna.
    """

    fitted_on: tuple[str, ...]
    judged_on: tuple[str, ...]
    ranking: tuple[SetOfCauses, ...]
    before: dict[str, float]
    after: dict[str, float]
    fitted: dict[str, float]

    @property
    def best(self) -> SetOfCauses:
        """The set that is named."""
        return best_of(self.ranking)


@dataclass(frozen=True)
class SeaTrialStudy:
    """What the sea trials of a log say.

    Attributes
    ----------
    evidence : TrialEvidence
        Of all trials.
    held_out : dict of str to HeldOut
        By what was fitted on: ``"port"``, ``"starboard"``; empty where only one side was turned to.
    ranking : tuple of SetOfCauses
        On all trials, best first.
    after : (f,) array
        Features of all trials by the best set, with the compass and the antenna as the trials tell them.
    separations : tuple of Separation
        What each manoeuvre of the catalogue would tell of the best set and its rivals; empty without rivals.
    """

    evidence: TrialEvidence
    held_out: dict[str, HeldOut]
    ranking: tuple[SetOfCauses, ...]
    after: np.ndarray
    separations: tuple[Separation, ...] = ()

    @property
    def trials(self) -> tuple[SeaTrial, ...]:
        """All manoeuvres."""
        return self.evidence.trials

    @property
    def model(self) -> ShipModel:
        """The ship as modelled."""
        return self.evidence.model

    @property
    def prescriptions(self) -> tuple[ExperimentDesign, ...]:
        """Manoeuvres that are expected to tell the best set from its rivals."""
        return prescribed(self.separations, self.compared)

    @property
    def pairs(self) -> list[tuple[str, str]]:
        """Causes that two compared sets do not share, for each pair."""
        return [differing(first, other) for first, other in combinations(self.compared, 2)]

    @property
    def compared(self) -> list[SetOfCauses]:
        """The best set and its rivals, as many as manoeuvres are compared for."""
        return [self.best, *self.rivals][:MOST_SETS]

    @property
    def best(self) -> SetOfCauses:
        """The set that is named."""
        return best_of(self.ranking)

    @property
    def rivals(self) -> list[SetOfCauses]:
        """Sets that fit equally well."""
        return rivals_of(self.ranking)

    @property
    def verdict(self) -> str:
        """As of a diagnosis: ``"consistent"``, ``"named"`` or ``"ambiguous"``."""
        if not self.best.hypotheses:
            return "consistent"
        return "ambiguous" if self.rivals else "named"

    @property
    def findings(self) -> list[Finding]:
        """The causes that are named, as those of a diagnosis; their probability is the best set's among its rivals."""
        # Probability of the best set among its rivals, by their evidence.
        share = 1.0 / sum(
            np.exp(candidate.evidence - self.best.evidence)
            for candidate in (self.best, *self.rivals)
        )
        return [
            Finding(
                cause.cause,
                cause.component,
                probability=min(float(share), 0.99),
                parameters=_estimates(self.best, cause),
            )
            for cause in self.best.hypotheses
        ]

    def as_json(self) -> dict[str, Any]:
        """What `sea_trials.json` holds."""
        return {
            "schema": "shipcosim-sea-trials/1",
            "verdict": self.verdict,
            "trials": [trial.name for trial in self.trials],
            "causes": _as_json(self.best),
            "indistinguishable": [_as_json(rival) for rival in self.rivals],
            "prescriptions": [asdict(prescription) for prescription in self.prescriptions],
            "manoeuvres": [
                _separation_as_json(separation, self.compared) for separation in self.separations
            ],
            "held_out": {
                name: {
                    "causes": _as_json(judged.best),
                    "judged_on": list(judged.judged_on),
                    "before": judged.before,
                    "after": judged.after,
                }
                for name, judged in self.held_out.items()
            },
        }


def _separation_as_json(separation, sets):
    pairs = [
        {
            "between": differing(sets[a], sets[b]),
            "nats": round(nats, 1),
            "telling": separation.telling[a, b]._asdict(),
        }
        for (a, b), nats in separation.nats.items()
    ]
    return {
        "manoeuvre": separation.manoeuvre,
        "minutes": separation.minutes,
        "read_from_logs": separation.read,
        "pairs": pairs,
    }


def _as_json(causes):
    return [
        {
            "cause": cause.cause,
            "component": cause.component,
            "parameters": {
                name: vars(estimate) for name, estimate in _estimates(causes, cause).items()
            },
        }
        for cause in causes.hypotheses
    ]


def _estimates(causes, cause):
    return {
        parameter.name: estimate
        for (owner, parameter), estimate in zip(causes.parameters, estimates(causes), strict=True)
        if owner is cause
    }


def estimates(causes: SetOfCauses) -> list[ParameterEstimate]:
    """Estimates of a set's parameters in the units of their files."""
    return [
        ParameterEstimate(
            float(p.factor * (p.neutral + value * p.typical)),
            float(abs(p.factor * p.typical) * std),
            p.unit,
        )
        for (_, p), value, std in zip(causes.parameters, causes.values, causes.std, strict=True)
    ]


def study(
    log: LogSource,
    system: System,
    channels: AnyPath | None = None,
    causes: AnyPath | None = None,
    progress: Callable[..., None] | None = None,
    *,
    orders: bool = False,
) -> SeaTrialStudy:
    """Find the sea trials of a log, and the causes for which the ship model does not sail them as the ship did.

    Parameters
    ----------
    log : path or xarray.Dataset
        Measured data, see docs/measured-data.md.
    system : System
    channels : path, optional
        Channel file.
    causes : path, optional
        Folder with further causes.
    progress : callable, optional
        Called with what is being done, in words.
    orders : bool
        Whether the thrusters' channels are orders, which the units follow, instead of feedback.

    Returns
    -------
    SeaTrialStudy

    Raises
    ------
    ShipcosimError
        Data that cannot be used; no turning circle.
    """
    say = progress or (lambda *_: None)
    say("which manoeuvres are in the log?")
    read = checked(read_measurements(log, system, channels, causes))
    if read.ship.third_party:
        message = f"{', '.join(read.ship.third_party)}: what such an FMU gives is only known where a log has been."
        right = "Sea trials need the FMUs azimuth_thruster and tunnel_thruster."
        raise error_at(system.file, message, right)
    # Gaps must not fall within a trial.
    lost = [segment for fault in read.faults if fault.cause == "gap" for segment in fault.segments]
    record = record_of(read.repaired, read.ship)
    record = as_ordered(record, read.repaired, read.ship) if orders else record
    trials = sea_trials_of(record, read.ship, lost, orders=orders)
    if not any(trial.kind == "turning circle" for trial in trials):
        message = f"no turning circle among {len(trials)} manoeuvres: {', '.join(t.name for t in trials) or 'none'}."
        right = f"A circle is an order held until she has turned by {thresholds.CIRCLE:.0f} deg, from a straight course."
        raise error_at(source_of(read.repaired), message, right)
    causes_of_log = causes_of_trials(read.ship, read.causes, orders=orders)
    return studied(trials, read.ship, causes_of_log, say)


def motions_of(trial_study: SeaTrialStudy) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Motions (n, 6) of all trials by the ship as modelled, and with the best set, compass and antenna as told."""
    best = changes_of(trial_study.best) | allowed_for(trial_study.evidence, trial_study.best)
    motions = sailed(trial_study.trials, trial_study.model, [{}, best])
    return [motion[0] for motion in motions], [motion[1] for motion in motions]


def causes_of_trials(
    model: ShipModel, catalogue: Mapping[str, Cause], *, orders: bool
) -> list[Hypothesis]:
    """Causes in the hull and its thrusters, and where a log has orders how late these are answered.

    A current, the compass and the antenna are allowed for beside every cause.
    """
    places = {model.vessel, *model.thrusters}
    allowed = {
        path for path in model.numbers if path.rpartition(".")[0] in places and "wind" not in path
    }
    allowed |= {"instruments.order_lag"} if orders else set()
    everyone = hypotheses_of(catalogue, model, "sea trials")
    return [
        hypothesis
        for hypothesis in everyone
        if hypothesis.definition.law == "linear"
        and all(path in allowed for p in hypothesis.parameters for path in p.paths)
    ]


def studied(
    trials: Sequence[SeaTrial],
    model: ShipModel,
    hypotheses: Sequence[Hypothesis],
    progress: Callable[..., None] = lambda *_: None,
) -> SeaTrialStudy:
    """The study of known sea trials: each side judged by the other, then all together.

    Parameters
    ----------
    trials : sequence of SeaTrial
    model : ShipModel
    hypotheses : sequence of Hypothesis
    progress : callable

    Returns
    -------
    SeaTrialStudy
    """
    # Cross-validation by side: fit one side's circles with the straight runs, judge on all others.
    sides = {
        name: [t for t in trials if t.kind == "turning circle" and t.side == side]
        for name, side in (("port", -1), ("starboard", 1))
    }
    held_out = {}
    if all(sides.values()):
        for name, of_side in sides.items():
            progress(f"fitted on circles to {name}, judged on the others")
            others = [
                trial for trial in trials if trial.kind != "straight run" and trial not in of_side
            ]
            straight = [trial for trial in trials if trial.kind == "straight run"]
            held_out[name] = _judged([*straight, *of_side], others, model, hypotheses)
    # The result itself is fitted on all trials.
    progress("fitted on all manoeuvres")
    whole = trial_evidence(trials, model, hypotheses)
    ranking = ranked(whole)
    best = best_of(ranking)
    rivals = rivals_of(ranking)
    (after,) = predicted(trials, model, [changes_of(best) | allowed_for(whole, best)])
    progress("what would tell causes apart")
    separated = separations(whole, [best, *rivals]) if best.hypotheses and rivals else []
    return SeaTrialStudy(whole, held_out, tuple(ranking), after, tuple(separated))


def _judged(train, others, model, hypotheses):
    both_sides = [
        hypothesis for hypothesis in hypotheses if hypothesis.component is None
    ]  # one unit alone: told by comparing both sides
    evidence = trial_evidence(train, model, both_sides)
    ranking = tuple(ranked(evidence))
    best = best_of(ranking)
    fitted = changes_of(best) | allowed_for(evidence, best)
    before, after = (errors(others, model, changes) for changes in ({}, fitted))
    fitted_on, judged_on = (tuple(trial.name for trial in some) for some in (train, others))
    return HeldOut(fitted_on, judged_on, ranking, before, after, fitted)


def best_of(ranking: Iterable[SetOfCauses]) -> SetOfCauses:
    """The set that is named: each of its causes adds enough, to any set of fewer and to what it explains without it."""
    ranking = list(ranking)
    # A set is named if each of its causes adds enough to the set without it.
    by_label = {
        frozenset(c.label for c in ranked_set.hypotheses): ranked_set for ranked_set in ranking
    }
    for best in sorted(
        (ranked_set for ranked_set in ranking if ranked_set.plausible), key=_worth, reverse=True
    ):
        names = frozenset(c.label for c in best.hypotheses)
        less = [by_label[names - {name}].evidence for name in names if names - {name} in by_label]
        if all(best.evidence - value > thresholds.NAMED for value in less):
            return best
    return by_label[frozenset()]


def _worth(ranked_set):
    """Evidence minus the cost of each cause. [nats]"""
    return ranked_set.evidence - thresholds.NAMED * len(ranked_set.hypotheses)


def rivals_of(ranking: Iterable[SetOfCauses]) -> list[SetOfCauses]:
    """Sets of no more causes that fit as well as the best one."""
    ranking = list(ranking)
    best = best_of(ranking)
    return [
        ranked_set
        for ranked_set in ranking
        if ranked_set is not best
        and ranked_set.plausible
        and len(ranked_set.hypotheses) <= len(best.hypotheses)
        and _worth(ranked_set) > _worth(best) - thresholds.RIVAL
    ]


def errors(
    trials: Sequence[SeaTrial], model: ShipModel, changes: dict[str, float]
) -> dict[str, float]:
    """Root mean square errors of a changed ship on trials, by kind and feature, in per cent (drift in deg).

    Parameters
    ----------
    trials : sequence of SeaTrial
    model : ShipModel
    changes : dict of str to float
        What is added to the ship's numbers.

    Returns
    -------
    dict of str to float
        ``"turning circle: speed"`` and the like.
    """
    measured = [features_of(trial, trial.measured) for trial in trials]
    # Simulate all trials with the changes and compare features: logarithms as relative errors.
    sailed = predicted(trials, model, [changes])[0]
    by_feature = {}
    at = 0
    for trial, of_trial in zip(trials, measured, strict=True):
        for name, off in zip(
            FEATURES[trial.kind], sailed[at : at + of_trial.size] - of_trial, strict=True
        ):
            size = np.degrees(off) if name in ANGLES else 100.0 * np.expm1(off)
            by_feature.setdefault(f"{trial.kind}: {name}", []).append(size)
        at += of_trial.size
    return {name: float(np.sqrt(np.mean(np.square(values)))) for name, values in by_feature.items()}
