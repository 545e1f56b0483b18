"""Tolerances of a ship's numbers: as her parameter sets say, else in proportion to those of our ship."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import Field, fields
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from shipcosim.ssp import System

__all__ = ["tolerances_of"]

_COEFFICIENT = 0.05  # of a hull's coefficient that ours does not use, as of her damping in surge (assumed)


def tolerances_of(system: System, parts: Mapping[str, Any], vessel: str) -> dict[str, float]:
    """Tolerances of the system's parameter sets, where they are silent those of our ship's relative to size.

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
    found = {}
    for part, values in parts.items():
        place = vessel if part in ("hull", "wind") else part
        known = system.components[place].tolerances if place in system.components else {}
        for item in fields(values):
            path, default = f"{place}.{item.name}", item.metadata["tolerance"]
            if item.name in known:
                found[path] = known[item.name]
            elif isinstance(value := getattr(values, item.name), float):
                found[path] = default * _size(values, item, value) if default else _assumed(item, value)
    return {path: tolerance for path, tolerance in found.items() if tolerance > 0.0}


def _size(values: Any, item: Field, value: float) -> float:
    """How large a number is against that of our ship; one that is neutral at nought as large as its scale."""
    if item.name == "rpm_offset":
        return values.rpm_max / type(values).rpm_max
    return abs(value / item.default) if item.default else 1.0


def _assumed(item: Field, value: float) -> float:
    """Tolerance of a hull's coefficient that our ship does not use."""
    return _COEFFICIENT * abs(value) if item.name[:2] in ("X_", "Y_", "N_") else 0.0
