"""Texts and rows of sea trials."""

from collections import Counter

import numpy as np

from shipcosim.diagnose.experiment.design import Separation
from shipcosim.diagnose.sea_trials.evidence import SetOfCauses
from shipcosim.diagnose.sea_trials.features import FEATURES
from shipcosim.diagnose.sea_trials.study import SeaTrialStudy, estimates
from shipcosim.errors import capitalised
from shipcosim.report.theme.numbers import plain, signed
from shipcosim.report.theme.views import Block, Outcome, Table

_SETS = 8  # in the table


def outcome(found: SeaTrialStudy) -> Outcome:
    """The verdict, and what it means."""
    return Outcome(found.verdict, found.verdict.upper(), sentence(found))


def sentence(found: SeaTrialStudy) -> str:
    """The verdict in a sentence."""
    if found.verdict == "consistent":
        return (
            "The model sails these trials as the ship did, within the repeatability of such trials."
        )
    best = capitalised(said(found.best.label))
    if found.verdict == "named":
        return f"{best} fits best where the model sails differently from the ship."
    count = len(found.rivals)
    others = "another set" if count == 1 else f"{count} other sets"
    return f"{best} fits best where the model sails differently from the ship; {others} of causes fit equally well."


def said(label: str) -> str:
    """Names of causes as people read them."""
    return label.replace("_", " ")


def trials(found: SeaTrialStudy) -> str:
    """How many trials there are of each kind."""
    counts = Counter(trial.kind for trial in found.trials)
    return ", ".join(f"{count} {kind}{'s' * (count > 1)}" for kind, count in counts.items())


def blocks(found: SeaTrialStudy) -> tuple[Block, ...]:
    """Sets of causes, how they predict the side that was not fitted, and what to sail, for terminal and notebook."""
    return (
        Block("Causes", sets_table(found)),
        Block("Judged on the other side", held_out_table(found)),
        Block("What to do next", lines=next_steps(found)),
    )


def sets_table(found: SeaTrialStudy) -> Table:
    """Sets of causes, those of most evidence first: estimates, and how far each is behind."""
    shown = [one for one in found.ranking if one.plausible and one.hypotheses][:_SETS]
    shown += [one for one in found.ranking if not one.hypotheses]
    first = found.best.evidence
    rows = [(said(one.label), told(one), signed(one.evidence - first)) for one in shown]
    return Table(rows, ("Causes", "Estimates", "Nats"), (2,))


def told(one: SetOfCauses) -> str:
    """Estimates of a set in one line."""
    texts = []
    for (cause, parameter), value in zip(one.parameters, estimates(one), strict=True):
        unit = "" if value.unit == "1" else f" {value.unit}"
        texts.append(
            f"{said(cause.label)} {parameter.name} {plain(value.estimate)} ± {plain(value.std, 1)}{unit}"
        )
    return "; ".join(texts)


def held_out_table(found: SeaTrialStudy) -> Table:
    """Errors on trials that were not fitted, by feature and by the side that was."""
    sides = list(found.held_out.items())
    names = list(dict.fromkeys(name for _, one in sides for name in one.before))
    rows = []
    for name in names:
        unit = "°" if name.endswith("drift") else " %"
        errors = [
            f"{one.before[name]:.1f} → {one.after[name]:.1f}{unit}" if name in one.before else "–"
            for _, one in sides
        ]
        rows.append((name, *errors))
    return Table(rows, ("Feature", *(f"Fitted on circles to {side}" for side, _ in sides)))


def features_table(found: SeaTrialStudy) -> Table:
    """Every feature of every trial: measured, as modelled, with the causes, and how well it repeats."""
    spread = np.sqrt(np.diag(found.evidence.noise))
    rows = []
    at = 0
    for trial in found.trials:
        for name in FEATURES[trial.kind]:
            values = (found.evidence.measured[at], found.evidence.predicted[at], found.after[at])
            repeats = f"{100.0 * spread[at]:.1f} %"
            if name == "drift":
                repeats = f"{np.degrees(spread[at]):.1f}°"
            rows.append((trial.name, name, *(_read(name, value) for value in values), repeats))
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


def next_steps(found: SeaTrialStudy) -> tuple[str, ...]:
    """What to sail, and what stays open."""
    steps = []
    for one in found.prescriptions:
        record = next(each for each in found.separations if each.manoeuvre == one.manoeuvre)
        pairs = [
            f"{said(a)} from {said(b)} ({_telling(found, record, (a, b))})"
            for a, b in one.separates
        ]
        tells = f"It tells {', '.join(pairs)}."
        steps.append(
            f"{capitalised(one.manoeuvre)}, to both sides, {one.minutes:.0f} minutes. {tells}"
        )
    told_apart = {pair for one in found.prescriptions for pair in one.separates}
    left = [pair for pair in found.pairs if pair not in told_apart]
    return (
        *steps,
        *(f"No manoeuvre of the catalogue tells {said(a)} from {said(b)}." for a, b in left),
    )


def _telling(found, record: Separation, pair):
    key = list(record.nats)[found.pairs.index(pair)]
    telling = record.telling[key]
    return (
        f"{record.nats[key]:.0f} nats; {telling.name} differs by {abs(telling.difference):.0f} {telling.unit}, "
        f"known to {telling.spread:.0f} {telling.unit}"
    )


def separation_table(found: SeaTrialStudy) -> Table:
    """Every manoeuvre: minutes, and by pair the nats and the feature that tells most."""
    rows = []
    for one in found.separations:
        cells = []
        for pair, nats in one.nats.items():
            telling = one.telling[pair]
            size = f"{telling.difference:+.1f} ± {telling.spread:.1f} {telling.unit}"
            cells.append(f"{nats:.1f}: {telling.name} {size}".replace("-", "−"))
        rows.append((one.manoeuvre, f"{one.minutes:.0f}", *cells))
    return Table(
        rows, ("Manoeuvre", "Min", *(f"{said(a)} / {said(b)}" for a, b in found.pairs)), (1,)
    )
