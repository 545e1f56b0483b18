"""Steps of `shipcosim train docking`: sail dockings, learn from them, calibrate, report."""

from collections.abc import Callable
from typing import Any

import numpy as np

from shipcosim.cosim import system_of
from shipcosim.learn.datasets import digest
from shipcosim.learn.docking import distance_ensemble, dockings, paper_iii, predictions, regions
from shipcosim.learn.docking.inputs import ShipModel, replay
from shipcosim.learn.docking.records import Record
from shipcosim.learn.results import Trained, settings_of
from shipcosim.learn.training import Progress, part_of
from shipcosim.learn.true_ships import known_to
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction.helm import HelmParameters
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.mast import MastParameters

OURS = distance_ensemble.DockingTraining()
PAPER_III = paper_iii.PaperIIITraining()
COMPONENT = "docking_predictor"
"""Component of the system that has the predictor's parameters."""
SETS = {
    "training": dockings.TRAINING,
    "choices": dockings.CHOICES[:12],
    "calibration": dockings.CALIBRATION[:16],
}
"""Seeds of the dockings by what they are for: of choices and calibration as many as sail in the time that there is."""
SAILING = 0.7
"""Share of the progress that sailing is. [1]"""
NOTES = (
    "Targets are what the ship measured later; no true place, current, wind or helmsman is used. Scores in the"
    " benchmark are by the truth.",
    "The best epoch is chosen on separate dockings, and regions are calibrated on others.",
)


def ship() -> ShipModel:
    """The ship as the predictor of the docking system knows her."""
    predictor = system_of(dockings.scenario(dockings.draw(1))).components[COMPONENT]
    return ShipModel(
        *known_to(predictor, HullParameters, WindParameters, HelmParameters, MastParameters)
    )


def sail(progress: Progress) -> dict[str, list[Record]]:
    """Records of all dockings to learn from, by what they are for."""
    # Sail all dockings in one pool, then sort the records by purpose.
    seeds = [seed for some in SETS.values() for seed in some]
    records = {
        record.seed: record
        for record in dockings.sail_all(map(dockings.draw, seeds), progress=progress)
    }
    return {
        name: [records[seed] for seed in some if seed in records] for name, some in SETS.items()
    }


def train(learn: Callable[..., Trained], recipe: Any, progress: Progress) -> Trained:
    """Train a predictor from scratch: sail the dockings, and learn from their records.

    Parameters
    ----------
    learn : callable
        `learn_ours` or `learn_paper_iii`.
    recipe : DockingTraining or PaperIIITraining
        How; that of `learn`.
    progress : callable
        Called with how far it is.

    Returns
    -------
    Trained
        Weights and report.
    """
    records = sail(part_of(progress, 0.0, SAILING))
    return learn(records, ship(), recipe, part_of(progress, SAILING, 1.0 - SAILING))


def learn_ours(
    records: dict[str, list[Record]],
    model: ShipModel,
    recipe: distance_ensemble.DockingTraining,
    progress: Progress,
) -> Trained:
    """Our predictor, learned from records.

    Parameters
    ----------
    records : dict of str to list of Record
        By `SETS`.
    model : ShipModel
        The ship as she knows herself.
    recipe : DockingTraining or PaperIIITraining
        How.
    progress : callable
        Called with how far it is.

    Returns
    -------
    Trained
        Weights, regions of this predictor and of the kinetic one, and report.
    """

    def inputs(replay):
        return distance_ensemble.features(replay, model.hull)

    replayed, pairs = _replayed(records, model, inputs, distance_ensemble.targets)
    # Train on some dockings; others decide which epoch to keep.
    arrays, epochs = distance_ensemble.fit(pairs["training"], pairs["choices"], recipe, progress)
    # Calibrate regions on dockings of their own: errors on training data are too small.
    calibration = replayed["calibration"]
    predicted = predictions.by_ours(calibration, arrays, model.hull)
    arrays["widths"] = regions.calibrated(predicted, calibration)
    arrays["kinetic_widths"] = regions.calibrated(predictions.kinetic(calibration), calibration)
    names = ("members", "width", "layers", "epochs", "batch", "learning_rate", "decay", "noise")
    settings = settings_of(recipe, names, "AdamW, cosine schedule")
    data = about(records, pairs["training"][0])
    return Trained(arrays, recipe.description, recipe.seed, data, settings, epochs, NOTES)


def learn_paper_iii(
    records: dict[str, list[Record]],
    model: ShipModel,
    recipe: paper_iii.PaperIIITraining,
    progress: Progress,
) -> Trained:
    """The networks of paper III, learned from records.

    Parameters
    ----------
    records, model, recipe, progress
        As `learn_ours`.

    Returns
    -------
    Trained
        Weights, regions and report.
    """
    replayed, pairs = _replayed(records, model, paper_iii.inputs_of, paper_iii.targets)
    # Search settings and train; other dockings decide.
    arrays, epochs, tried = paper_iii.fit(pairs["training"], pairs["choices"], recipe, progress)
    # Calibrate regions on dockings of their own: errors on training data are too small.
    calibration = replayed["calibration"]
    predicted = predictions.by_paper_iii(calibration, arrays)
    arrays["widths"] = regions.calibrated(predicted, calibration)
    names = ("members", "dropout", "epochs", "batch", "trial_epochs")
    settings = settings_of(recipe, names, "Adam, cosine schedule")
    # The report lists every setting that the search tried, with its loss.
    for trial, loss in tried:
        settings[
            f"tried: {trial.layers} layers of {trial.width}, learning rate {trial.learning_rate:g}"
        ] = round(loss, 4)
    data = about(records, pairs["training"][0])
    return Trained(arrays, recipe.description, recipe.seed, data, settings, epochs, NOTES)


def _replayed(records, model, inputs, targets):
    """Replayed records, and inputs and targets of the same replay, by what they are for."""
    replayed = {name: replay(some, model) for name, some in records.items()}
    return replayed, {name: (inputs(replay), targets(replay)) for name, replay in replayed.items()}


def about(records: dict[str, list[Record]], inputs: np.ndarray) -> dict[str, Any]:
    """Describe the data for the report."""
    rows = {}
    for name, some in records.items():
        seeds = [record.seed for record in some]
        rows[name] = (
            f"{len(seeds)} that end in time, of seeds {min(seeds)} to {max(seeds)}, learn/docking/dockings"
        )
    return rows | {"SHA-256 of the inputs to train on, rounded": digest(np.round(inputs, 3) + 0.0)}
