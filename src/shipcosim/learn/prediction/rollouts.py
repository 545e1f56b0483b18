"""Records of many ships in one array, and predictions for all of them in torch or NumPy."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import torch

from shipcosim.learn.datasets import mapped, stacked
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction import drift_off, own_model, own_record
from shipcosim.models.prediction.predictor_inputs import Known
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.mast import MastParameters, wind_from_mast

HORIZONS = (10.0, 30.0, 60.0)
"""How far ahead. [s]"""


class Ship(NamedTuple):
    """The ship's own model.

    Parameters
    ----------
    hull, wind, mast : parameter sets
        Her nominal numbers.
    """

    hull: HullParameters
    wind: WindParameters
    mast: MastParameters


class Sailed(NamedTuple):
    """Records of many worlds at 1 Hz, aligned at their loss of thrust.

    Parameters
    ----------
    known : (n, worlds, 15) array
        Columns as `worlds.KNOWN`.
    lost : int
        The row at which thrust is lost; from the next row on the ship knows.
    """

    known: np.ndarray
    lost: int


def known_of(rows: np.ndarray, ship: Ship) -> Known:
    """Inputs of the predictor, from the columns of records.

    Parameters
    ----------
    rows : (..., 15) array
        Columns as `worlds.KNOWN`.
    ship : Ship
        For the place of the anemometer.

    Returns
    -------
    Known
        With (...) arrays.
    """
    c = np.moveaxis(rows, -1, 0)
    # Apparent wind at 10 m above the origin, from the apparent wind at the mast.
    wind = wind_from_mast(c[12], c[13], *c[3:6], mast=ship.mast)
    # The last column says that wind is rejected; its complement is its validity.
    return Known(Motion(*c[:6]), tuple(c[6:9]), tuple(c[9:12]), *wind, 1.0 - c[14])


def tensors(record: Any) -> Any:
    """Turn arrays in nested tuples into tensors."""
    return mapped(lambda array: torch.from_numpy(np.ascontiguousarray(array, dtype=float)), record)


def followed(
    learned: own_model.Learned,
    sailed: Sailed,
    starts: Sequence[int],
    ship: Ship,
    library: Any,
    grid: int = 1,
) -> tuple[own_record.Record, Known]:
    """States of the filter in all worlds, at some rows after the loss.

    Parameters
    ----------
    learned : Learned
        Arrays or tensors that broadcast with the worlds.
    sailed : Sailed
        Records.
    starts : sequence of int
        Rows after that of the loss, increasing. [1]
    ship : Ship
        The ship's own model.
    library : module
        torch or numpy.
    grid : int
        Every so-manieth row is used before the loss; all after it. [1]

    Returns
    -------
    tuple of Record and Known
        With starts along their first axis, of what filters have along the second.
    """
    # Coarse grid before the loss, every row after it, as predictions start there.
    lost = sailed.lost
    last = sailed.lost + max(starts)
    rows = [*range(lost % grid, lost, grid), *range(lost, last + 1)]
    everything = known_of(sailed.known, ship)
    if library is torch:
        everything = tensors(everything)
    # The filter begins with the learned priors and follows the records row by row.
    now = mapped(lambda array: array[rows[0]], everything)
    record = own_record.begin(now, learned=learned, hull=ship.hull)
    by_start = []
    for before, row in pairwise(rows):
        now = mapped(lambda array, row=row: array[row], everything)
        record = own_record.step(
            record, now, float(row - before), learned=learned, hull=ship.hull, wind=ship.wind
        )
        # Keep the state at each start.
        if row - lost in starts:
            by_start.append((record, now))
    # Starts become the first axis; quantities per filter keep their axis in front.
    record = stacked([of_start for of_start, _ in by_start], library)
    first = {
        name: library.moveaxis(getattr(record, name), 1, 0)
        for name in ("mean", "covariance", "likelihood")
    }
    return record._replace(**first), stacked([now for _, now in by_start], library)


def ahead(
    learned: own_model.Learned, record: own_record.Record, known: Known, ship: Ship
) -> tuple[Motion, ...]:
    """Motions at `HORIZONS`.

    Parameters
    ----------
    learned : Learned
        As in `followed`.
    record, known : Record, Known
        As `followed` gives them.
    ship : Ship
        The ship's own model.

    Returns
    -------
    tuple of Motion
        One per horizon.
    """
    # Predict with each filter of the bank, then average by their weights.
    motions = own_record.predict(
        record,
        known,
        horizons=HORIZONS,
        steps=drift_off.STEPS,
        learned=learned,
        hull=ship.hull,
        wind=ship.wind,
    )
    return tuple(own_record.mixed(record, motion) for motion in motions)


def errors(motions: Sequence[Motion], sailed: Sailed, starts: Sequence[int]) -> torch.Tensor:
    """Prediction errors against the ship's later estimates of position and heading.

    Parameters
    ----------
    motions : sequence of Motion
        At `HORIZONS`; (starts, worlds) tensors.
    sailed : Sailed
        Records.
    starts : sequence of int
        Rows after that of the loss. [1]

    Returns
    -------
    (horizons, starts, worlds, 3) tensor
        North, east, heading. [m, m, rad]
    """
    # Compare with the record at each start plus horizon.
    rows = sailed.lost + np.array(starts)
    errors = []
    for horizon, motion in zip(HORIZONS, motions, strict=True):
        x, y, psi = torch.from_numpy(
            np.moveaxis(sailed.known[rows + int(horizon), :, :3], -1, 0).copy()
        )
        # Heading error wrapped by atan2, which has a gradient everywhere.
        turned = motion.psi - psi
        errors.append(
            torch.stack([motion.x - x, motion.y - y, torch.atan2(turned.sin(), turned.cos())], -1)
        )
    return torch.stack(errors)
