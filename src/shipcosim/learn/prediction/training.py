"""Steps of `shipcosim train drift`: sail worlds, learn from their records, report."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from shipcosim.cosim import system_of
from shipcosim.learn.datasets import digest
from shipcosim.learn.prediction import drift, paper_iv, worlds
from shipcosim.learn.prediction.rollouts import HORIZONS, Sailed, Ship, followed
from shipcosim.learn.results import Trained, settings_of
from shipcosim.learn.training import Progress, part_of, repeatable
from shipcosim.learn.true_ships import known_to
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction import drift_off, own_record
from shipcosim.models.prediction.own_model import Learned
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.mast import MastParameters

OURS = drift.DriftTraining(
    "Our drift predictor of the DP ship: beliefs that her own record corrects", tuple(range(1, 25))
)
PAPER_IV = paper_iv.PaperIVTraining(
    "The drift predictor of paper IV for the DP ship", tuple(range(1, 13))
)
NOTES = (
    "Targets are the ships' own later estimates of place and heading; no true state, current or wind is used.",
    "An epoch is a step of the optimiser with all worlds.",
    "Few worlds are easily overfitted: only a quarter of the change from the assumed beliefs is kept. Noise,"
    " size of the remaining load and evidence were chosen on worlds 300 to 311, and so was that quarter.",
)
SETTINGS = ("steps", "learning_rate", "pull", "kept", "margin", "before")
SAILING = 0.5
"""Share of the progress that sailing the worlds is. [1]"""


def ship() -> Ship:
    """The DP ship as her predictor knows her."""
    predictor = system_of(worlds.scenario(worlds.draw(1, 0.0))).components["predictor"]
    return Ship(*known_to(predictor, HullParameters, WindParameters, MastParameters))


def aligned(records: Sequence[worlds.Record], before: int, after: int = 81) -> Sailed:
    """Records in one array, cut so that their losses fall in the same row.

    Parameters
    ----------
    records : sequence of Record
        As `worlds.sail` gives them.
    before, after : int
        Rows before that of the loss, and after it. [1]

    Returns
    -------
    Sailed
        Of `before + 1 + after` rows.
    """
    # Cut the same number of rows around each loss.
    cut = []
    for record in records:
        lost = int(np.searchsorted(record.time, record.lost_at - 1e-6))
        cut.append(record.known[lost - before : lost + after + 1])
    return Sailed(np.stack(cut, axis=1), before)


def sail(seeds: Sequence[int], progress: Progress) -> list[worlds.Record]:
    """Records of worlds to train on.

    Parameters
    ----------
    seeds : sequence of int
        Theirs, all of `worlds.TRAINING`.
    progress : callable
        Called with how many are sailed, of how many.

    Returns
    -------
    list of Record
        In their order.
    """
    # Other worlds calibrate or test: training on them would make the results look too good.
    if outside := [seed for seed in seeds if seed not in worlds.TRAINING]:
        raise ValueError(f"seeds {outside} are not of worlds to train on, {worlds.TRAINING}")
    return worlds.sail_all([worlds.draw(seed) for seed in seeds], progress=progress)


def train(
    learn: Callable[[list[worlds.Record], Any, Progress], Trained], recipe: Any, progress: Progress
) -> Trained:
    """Train a predictor from scratch: sail the worlds of its recipe, and learn from their records.

    Parameters
    ----------
    learn : callable
        `ours` or `as_paper_iv`.
    recipe : DriftTraining or PaperIVTraining
        How; that of `learn`.
    progress : callable
        Called with how far it is.

    Returns
    -------
    Trained
        Weights and report.
    """
    records = sail(recipe.seeds, part_of(progress, 0.0, SAILING))
    return learn(records, recipe, part_of(progress, SAILING, 1.0 - SAILING))


def ours(
    records: Sequence[worlds.Record], recipe: drift.DriftTraining, progress: Progress
) -> Trained:
    """Our predictor, learned from records of worlds.

    Parameters
    ----------
    records : sequence of Record
        Of the recipe's worlds.
    recipe : DriftTraining or PaperIVTraining
        How.
    progress : callable
        Called with how far it is.

    Returns
    -------
    Trained
        Weights and report.
    """
    # Train on all worlds at once.
    sailed = aligned(records, recipe.before)
    about = ship()
    with repeatable(recipe.seed):
        numbers, epochs = drift.fit(sailed, about, recipe, progress)
    # Keep only a share of the way from the assumed beliefs: few worlds are learned by heart.
    learned = drift.learned_of(recipe.kept * numbers)
    arrays = {name: np.asarray(getattr(learned, name)) for name in Learned._fields}
    # Beyond these limits the predictor does not trust what was learned.
    arrays["limits"] = recipe.margin * limits(learned, sailed, about)
    settings = settings_of(recipe, SETTINGS, "Adam, cosine schedule")
    settings["starts of predictions after the loss (s)"] = drift.STARTS
    return Trained(
        arrays,
        recipe.description,
        recipe.seed,
        _about(recipe.seeds, sailed.known),
        settings,
        epochs,
        NOTES,
    )


def limits(learned: Learned, sailed: Sailed, about: Ship) -> np.ndarray:
    """The largest of each of `drift_off.MEASURES` in training, up to 60 s after the loss.

    Parameters
    ----------
    learned : Learned
        What is believed before the record.
    sailed : Sailed
        Records of the training worlds.
    about : Ship
        The ship's own model.

    Returns
    -------
    (9,) array
        [units of `MEASURES`]
    """
    # Follow the records to 60 s after the loss, and predict from each second.
    record, known = followed(learned, sailed, range(1, 61), about, np)
    options = {"horizons": HORIZONS, "steps": drift_off.STEPS, "learned": learned}
    last = own_record.predict(record, known, **options, hull=about.hull, wind=about.wind)[-1]
    # The largest of each measure over all starts and worlds.
    measures = drift_off.measures(record, known, last, learned)
    return measures.reshape(len(drift_off.MEASURES), -1).max(axis=1)


def as_paper_iv(
    records: Sequence[worlds.Record], recipe: paper_iv.PaperIVTraining, progress: Progress
) -> Trained:
    """The networks of paper IV, learned from records of worlds.

    Parameters
    ----------
    records : sequence of Record
        Of the recipe's worlds.
    recipe : DriftTraining or PaperIVTraining
        How.
    progress : callable
        Called with how far it is.

    Returns
    -------
    Trained
        Weights and report.
    """
    # Samples of all worlds before their loss: the paper trains in DP and manoeuvring.
    inputs, targets = paper_iv.samples(aligned(records, OURS.before), ship())
    arrays, epochs = paper_iv.fit(inputs, targets, recipe, progress)
    names = ("samples", "members", "width", "batch", "most_epochs", "patience", "learning_rate")
    settings = settings_of(recipe, names, "Adam")
    data = _about(recipe.seeds, inputs)
    return Trained(arrays, recipe.description, recipe.seed, data, settings, epochs, paper_iv.NOTES)


def _about(seeds: Sequence[int], data: np.ndarray) -> dict[str, Any]:
    return {
        "worlds": f"seeds {min(seeds)} to {max(seeds)}, learn/prediction/worlds, at distance 1",
        "numbers": data.size,
        "SHA-256 of the data, rounded": digest(np.round(data, 3) + 0.0),
    }
