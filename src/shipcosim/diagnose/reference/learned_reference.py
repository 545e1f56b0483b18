"""A reference of a craft that is not the file's: her numbers as several logs teach them, and their spread."""

from collections.abc import Sequence

import numpy as np

import shipcosim
from shipcosim.diagnose.craft.learned import LearnedCraft
from shipcosim.diagnose.reference.reference import (
    SCHEMA,
    KnownNumber,
    Reference,
    ReferenceLog,
    fingerprint,
)
from shipcosim.diagnose.reference.thresholds import USUAL_FORM
from shipcosim.diagnose.ship.model import ShipModel

_LEAST_SPREAD = (
    0.05  # of a number's size: what logs agree upon by chance is no better known. Assumed
)


def learned_reference(
    craft: LearnedCraft, ship: ShipModel, logs: Sequence[ReferenceLog], system: str
) -> Reference:
    """What logs teach of a craft, as a reference.

    Parameters
    ----------
    craft : LearnedCraft
    ship : ShipModel
        With the system's own numbers.
    logs : sequence of ReferenceLog
    system : str
        Its name.
    """
    # Each number with its spread between the logs, but no less than a share of its size.
    numbers = []
    for name, estimate in craft.after.items():
        size = max(abs(estimate), abs(craft.before[name]))
        std = max(craft.std[name], _LEAST_SPREAD * size, 1e-9)
        unit = ship.about(name)["unit"]
        nominal = craft.before[name]
        numbers.append(
            KnownNumber(
                name=name, unit=unit, nominal=nominal, tolerance=std, estimate=estimate, std=std
            )
        )
    return Reference(
        schema=SCHEMA,
        form_scale=USUAL_FORM,
        shipcosim=shipcosim.__version__,
        system=system,
        system_sha256=fingerprint(ship, list(craft.after)),
        tolerance_scale=1.0,
        logs=tuple(logs),
        dispersion=1.0,
        ordinary_errors={},
        numbers=tuple(numbers),
        correlation=tuple(tuple(map(float, row)) for row in np.eye(len(numbers))),
    )
