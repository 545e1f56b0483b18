"""Tolerances of a ship's numbers: as her parameter sets say, else in proportion to their size."""

from collections.abc import Mapping
from dataclasses import MISSING, Field, fields
from typing import Any

from shipcosim.ssp import System

_COEFFICIENT = 0.05  # of a hull's coefficient, as of the damping in surge (assumed)


def tolerances_of(system: System, parts: Mapping[str, Any], vessel: str) -> dict[str, float]:
    """Tolerances of the system's parameter sets, and usual ones where these have none.

    Parameters
    ----------
    system : System
    parts : dict of str to dataclass
        Of the ship.
    vessel : str
        Name of its component.

    Returns
    -------
    dict of str to float
        By ``place.name``, in its unit.
    """
    # Tolerances of the parameter set have precedence over assumed ones.
    tolerances = {}
    for part, values in parts.items():
        place = vessel if part in ("hull", "wind") else part
        stated = system.components[place].tolerances if place in system.components else {}
        for item in fields(values):
            path = f"{place}.{item.name}"
            if item.name in stated:
                tolerances[path] = stated[item.name]
            elif isinstance(value := getattr(values, item.name), float):
                tolerances[path] = _assumed(values, item, value)
    return {path: tolerance for path, tolerance in tolerances.items() if tolerance > 0.0}


def _assumed(values: Any, item: Field, value: float) -> float:
    """Assumed tolerance of a number without a stated one: that of its model, or a share of its size."""
    # Tolerances scale with the value relative to the default; a share is of the value itself.
    about = item.metadata
    if about["tolerance"]:
        return about["tolerance"] * (
            abs(value / item.default) if item.default not in (0.0, MISSING) else 1.0
        )
    if about["share"]:
        return about["share"] * (values.rpm_max if item.name == "rpm_offset" else abs(value))
    return _COEFFICIENT * abs(value) if item.name[:2] in ("X_", "Y_", "N_") else 0.0
