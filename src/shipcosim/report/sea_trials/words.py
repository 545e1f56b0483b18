"""Texts and rows of sea trials."""

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np

from shipcosim.diagnose.experiment.design import Separation
from shipcosim.diagnose.sea_trials.evidence import SetOfCauses
from shipcosim.diagnose.sea_trials.features import FEATURES
from shipcosim.diagnose.sea_trials.study import SeaTrialStudy, estimates
from shipcosim.errors import capitalised
from shipcosim.report.theme.numbers import plain, signed
from shipcosim.report.theme.views import Block, Outcome, Table

_SETS = 8  # in the table


def outcome(study: SeaTrialStudy) -> Outcome:
    """The verdict, and what it means."""
    return Outcome(study.verdict, study.verdict.upper(), sentence(study))


def sentence(study: SeaTrialStudy) -> str:
    """The verdict in a sentence."""
    if study.verdict == "consistent":
        return (
            "The model sails these trials as the ship did, within the repeatability of such trials."
        )
    best = capitalised(causes_text(study.best.label))
    if study.verdict == "named":
        return f"{best} fits best where the model sails differently from the ship."
    count = len(study.rivals)
    others = "another set" if count == 1 else f"{count} other sets"
    return f"{best} fits best where the model sails differently from the ship; {others} of causes fit equally well."


def causes_text(label: str) -> str:
    """Names of causes as people read them."""
    return label.replace("_", " ")


def trials(study: SeaTrialStudy) -> str:
    """How many trials there are of each kind."""
    counts = Counter(trial.kind for trial in study.trials)
    return ", ".join(f"{count} {kind}{'s' * (count > 1)}" for kind, count in counts.items())


def blocks(study: SeaTrialStudy) -> Sequence[Block]:
    """Sets of causes, how they predict the side that was not fitted, and what to sail, for terminal and notebook."""
    return (
        Block("Causes", sets_table(study)),
        Block("Judged on the other side", held_out_table(study)),
        Block("What to do next", lines=next_steps(study)),
    )


def sets_table(study: SeaTrialStudy) -> Table:
    """Sets of causes, those of most evidence first: estimates, and how far each is behind."""
    shown = [causes for causes in study.ranking if causes.plausible and causes.hypotheses][:_SETS]
    shown += [causes for causes in study.ranking if not causes.hypotheses]
    first = study.best.evidence
    rows = [
        (causes_text(causes.label), estimates_text(causes), signed(causes.evidence - first))
        for causes in shown
    ]
    return Table(rows, ("Causes", "Estimates", "Nats"))


def estimates_text(causes: SetOfCauses) -> str:
    """Estimates of a set in one line."""
    texts = []
    for (cause, parameter), value in zip(causes.parameters, estimates(causes), strict=True):
        unit = "" if value.unit == "1" else f" {value.unit}"
        texts.append(
            f"{causes_text(cause.label)} {parameter.name} {plain(value.estimate)} ± {plain(value.std, 1)}{unit}"
        )
    return "; ".join(texts)


def held_out_table(study: SeaTrialStudy) -> Table:
    """Errors on trials that were not fitted, by feature and by the side that was."""
    sides = list(study.held_out.items())
    names = list(dict.fromkeys(name for _, errors in sides for name in errors.before))
    rows = []
    for name in names:
        unit = "°" if name.endswith("drift") else " %"
        errors = [
            f"{errors.before[name]:.1f} → {errors.after[name]:.1f}{unit}"
            if name in errors.before
            else "–"
            for _, errors in sides
        ]
        rows.append((feature_text(name), *errors))
    return Table(rows, ("Feature", *(f"Fitted on circles to {side}" for side, _ in sides)))


def feature_text(name: str) -> str:
    """A feature as people read it: `t90` is the time to 90° of heading; numbers at the end are headings."""
    text = re.sub(r"\bt(?=\d)", "time to ", name)
    return f"{text}°" if text[-1].isdigit() else text


def features_table(study: SeaTrialStudy) -> Table:
    """Every feature of every trial: measured, as modelled, with the causes, and how well it repeats."""
    spread = np.sqrt(np.diag(study.evidence.noise))
    rows = []
    at = 0
    for trial in study.trials:
        for name in FEATURES[trial.kind]:
            values = (study.evidence.measured[at], study.evidence.predicted[at], study.after[at])
            repeats = f"{100.0 * spread[at]:.1f} %"
            if name == "drift":
                repeats = f"{np.degrees(spread[at]):.1f}°"
            rows.append(
                (trial.name, feature_text(name), *(_read(name, value) for value in values), repeats)
            )
            at += 1
    return Table(rows, ("Trial", "Feature", "Measured", "As modelled", "With causes", "Repeats to"))


def _read(name, value):
    """A feature in the unit that people read."""
    if name == "drift":
        return f"{np.degrees(value):.1f}°"
    # All others are logarithms of a size.
    size = float(np.exp(value))
    if name in ("rate", "peak rate"):
        return f"{plain(np.degrees(size))}°/s"
    if name == "swing":
        return f"{plain(np.degrees(size))}°"
    if name.startswith("speed"):
        return f"{plain(size)} m/s"
    is_time = name.startswith("t") and name[1:].isdigit()
    return f"{plain(size)} {'s' if is_time else 'm'}"


def next_steps(study: SeaTrialStudy) -> Sequence[str]:
    """What to sail, and what stays open."""
    steps = []
    for prescription in study.prescriptions:
        record = next(
            each for each in study.separations if each.manoeuvre == prescription.manoeuvre
        )
        pairs = [
            f"{causes_text(a)} from {causes_text(b)} ({_telling(study, record, (a, b))})"
            for a, b in prescription.separates
        ]
        tells = f"It tells {', '.join(pairs)}."
        steps.append(
            f"{capitalised(prescription.manoeuvre)}, to both sides, {prescription.minutes:.0f} minutes. {tells}"
        )
    told_apart = {pair for planned in study.prescriptions for pair in planned.separates}
    left = [pair for pair in study.pairs if pair not in told_apart]
    return (
        *steps,
        *(
            f"No manoeuvre of the catalogue tells {causes_text(a)} from {causes_text(b)}."
            for a, b in left
        ),
    )


def _telling(study, record: Separation, pair):
    key = list(record.nats)[study.pairs.index(pair)]
    telling = record.telling[key]
    difference = f"{abs(telling.difference):.0f} {telling.unit}"
    spread = f"{telling.spread:.0f} {telling.unit}"
    return (
        f"{record.nats[key]:.0f} nats; {feature_text(telling.name)} differs by {difference}, "
        f"known to {spread}"
    )


def separation_table(study: SeaTrialStudy) -> Table:
    """Every manoeuvre: minutes, and by pair the nats and the feature that tells most."""
    rows = []
    for separation in study.separations:
        cells = []
        for pair, nats in separation.nats.items():
            telling = separation.telling[pair]
            size = f"{telling.difference:+.1f} ± {telling.spread:.1f} {telling.unit}"
            cells.append(f"{nats:.1f}: {feature_text(telling.name)} {size}".replace("-", "−"))
        rows.append((separation.manoeuvre, f"{separation.minutes:.0f}", *cells))
    return Table(
        rows,
        ("Manoeuvre", "Min", *(f"{causes_text(a)} / {causes_text(b)}" for a, b in study.pairs)),
    )
