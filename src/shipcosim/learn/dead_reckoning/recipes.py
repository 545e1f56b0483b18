"""What can be trained for dead reckoning, from records to weights and report."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shipcosim.learn.datasets import digest
from shipcosim.learn.dead_reckoning import inputs, motion_filter, paper_ii, worlds
from shipcosim.learn.dead_reckoning.motion_filter import GAINS, KNOWN, reckoned
from shipcosim.learn.dead_reckoning.regions import TIMES, calibrated
from shipcosim.learn.dead_reckoning.worlds import CALIBRATION, TRAINING, Record
from shipcosim.learn.networks import Arrays
from shipcosim.learn.results import Trained
from shipcosim.learn.training import Progress, part_of
from shipcosim.models.prediction import motion_filter as filter_law
from shipcosim.models.prediction import velocity_network as network_law
from shipcosim.models.prediction.motion_filter import FilterNumbers

CALIBRATED_FOR = 720.0  # s, with four of the drills
UNLEARNED = {
    "kinetic": "The filter with the numbers of the ship's files and gains by hand: nothing is learned",
    "last-position": "For comparison: the ship is taken to stay where she was, the mean of some ten seconds",
}
FILTER = "motion-filter"
DESCRIPTION = (
    "Our filter: equations of motion and observer, learned through drills of a minute without GNSS"
)
NOTES = (
    "In a drill GNSS is masked for a minute out of two. DP rides on the filter as it is before training. A second"
    " receiver, which DP does not see, is logged. The region is calibrated in other worlds, against the true place.",
)


@dataclass(frozen=True)
class Size:
    """How much is trained on; smaller in tests.

    Parameters
    ----------
    training, calibration : sequence of int
        Seeds of worlds.
    duration, calibrated_for : float
        Of a run. [s]
    """

    training: Sequence[int] = TRAINING
    calibration: Sequence[int] = CALIBRATION
    duration: float = worlds.DURATION
    calibrated_for: float = CALIBRATED_FOR


def train(name: str, progress: Progress, size: Size | None = None) -> Trained:
    """Train one kind from scratch, records included.

    Parameters
    ----------
    name : str
        One of `UNLEARNED`, `FILTER` or `paper_ii.RECIPES`.
    progress : callable
        Called with how far it is, in thousandths.
    size : Size, optional
        How much is trained on.

    Returns
    -------
    Trained
        Weights, data and losses.
    """
    size = size or Size()
    # Kinds without training: assumed numbers, and an assumed region that grows with time.
    if name in UNLEARNED:
        progress(1, 1)
        region = {"region.times": np.array([0.0, 60.0]), "region.radii": np.array([0.5, 3.0])}
        notes = (
            "Its region is no more than a guess: half a metre at once, three metres after a minute.",
        )
        arrays = _arrays(design_of(name)) | region | {"region.sea_share": np.array(1.0)}
        return Trained(arrays, UNLEARNED[name], 0, {"worlds": 0}, {}, [], notes)
    return _filter(progress, size) if name == FILTER else _networks(name, progress, size)


def design_of(name: str) -> FilterNumbers:
    """Numbers of the filter that nothing was learned for.

    Parameters
    ----------
    name : str
        One of `UNLEARNED`.

    Returns
    -------
    FilterNumbers
        Numbers.
    """
    learned_for = FilterNumbers(**KNOWN, **GAINS)
    return (
        learned_for._replace(surge_time=1e-3, sway_time=1e-3, **STILL)
        if name == "last-position"
        else learned_for
    )


STILL = {
    "position_by_velocity": 0.0,
    "velocity_by_position": 0.0,
    "velocity_by_velocity": 0.0,
    "position_in_sea": 0.0,
}


def _filter(progress, size):
    """Train the filter on drills and calibrate its region."""
    # Sail the drills, then fit the filter to them.
    record = _recorded(size.training, size.duration, part_of(progress, 0.0, 0.35), worlds.DRILLS)
    design, epochs = motion_filter.fitted(record, part_of(progress, 0.35, 0.1))
    # Calibrate the region in other worlds than those of the training.
    apart = _recorded(
        size.calibration, size.calibrated_for, part_of(progress, 0.45, 0.55), worlds.DRILLS
    )
    arrays = _arrays(design) | _region(apart, reckoned(apart, filter_law, design))
    # The report shows each parameter before and after the fit.
    settings = {"numbers": len(design), "robust beyond (m)": motion_filter.ROBUST}
    settings |= {"weight of the start": motion_filter.PRIOR}
    for name, at_start in (KNOWN | GAINS).items():
        settings[f"{name}, from {at_start:.4g} to"] = float(f"{getattr(design, name):.4g}")
    return Trained(arrays, DESCRIPTION, 0, _about(size, record, "drills"), settings, epochs, NOTES)


def _networks(name, progress, size):
    """Train the networks on records with GNSS and calibrate their region."""
    # The paper trains with GNSS available: no losses in the records.
    recipe = paper_ii.RECIPES[name]
    record = _recorded(size.training, size.duration, part_of(progress, 0.0, 0.4), ())
    arrays, epochs = paper_ii.trained(recipe, record, part_of(progress, 0.4, 0.2))
    # The region is calibrated in drills of other worlds, as for the filter.
    apart = _recorded(
        size.calibration, size.calibrated_for, part_of(progress, 0.6, 0.4), worlds.DRILLS
    )
    arrays |= _region(apart, reckoned(apart, network_law, network_law.design(arrays)))
    # Mutual information by input, to compare with Table III of the paper.
    table = inputs.table(record, paper_ii.features_of(record))
    facts = {
        f"mutual information with {axis} velocity": {
            key: round(information, 2) for key, information in row.items()
        }
        for axis, row in table.items()
    }
    # What the report says of the network and its training.
    settings = {
        "network": "LSTM and a dense layer"
        if recipe.recurrent
        else "a layer of sigmoids and a dense layer",
        "units, surge and sway": list(recipe.width),
        "learning rates": list(recipe.learning_rate),
        "inputs": {axis: list(names) for axis, names in paper_ii.INPUTS.items()},
        "patience": recipe.patience,
        "most epochs": recipe.most_epochs,
        "mini-batch": paper_ii.BATCH,
    }
    about = _about(size, record, "stationkeeping with GNSS") | facts
    return Trained(arrays, recipe.description, recipe.seed, about, settings, epochs, paper_ii.NOTES)


def _recorded(seeds, duration, progress, losses):
    return worlds.recorded([worlds.drawn(seed) for seed in seeds], duration, progress, losses)


def _region(record: Record, states: list) -> Arrays:
    """Calibrate the region on all samples without GNSS."""
    # Distance between estimated and true position.
    names = ("x", "y", "lost_for", "sea")
    x, y, lost_for, sea = (
        np.stack([getattr(state, name) for state in states], axis=-1) for name in names
    )
    error = np.hypot(x - record.x, y - record.y)
    # Only outages count: with GNSS the region is not used.
    lost = record.measured["valid"] < 0.5
    return calibrated(lost_for[lost], sea[lost], error[lost])


def _about(size: Size, record: Record, kind: str) -> dict:
    measured = np.stack([record.measured[name] for name in worlds.MEASURED])
    return {
        "records": f"{kind}, co-simulation of {worlds.SYSTEM}, one sample a second",
        "seeds of the worlds": f"{size.training[0]} to {size.training[-1]}",
        "seeds of the worlds that calibrate the region": f"{size.calibration[0]} to {size.calibration[-1]}",
        "times of the region (s)": list(TIMES),
        "samples": int(record.x.size),
        "SHA-256 of the measurements": digest(measured.round(6)),
    }


def _arrays(design: FilterNumbers) -> Arrays:
    return {name: np.array(float(number)) for name, number in design._asdict().items()}


KINDS = {FILTER: DESCRIPTION}
KINDS |= {name: recipe.description for name, recipe in paper_ii.RECIPES.items()} | UNLEARNED
"""Kinds by name, with one line for users."""
