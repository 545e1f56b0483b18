"""Ships as files: particulars that a naval architect writes, estimates, and parameter sets."""

from shipcosim.ships.described import Described, describe, file_of
from shipcosim.ships.entries import Quantity
from shipcosim.ships.folder import Ship, read_ship
from shipcosim.ships.parameter_set import parameter_values
from shipcosim.ships.system import make_systems

__all__ = [
    "Described",
    "Quantity",
    "Ship",
    "describe",
    "file_of",
    "make_systems",
    "parameter_values",
    "read_ship",
]
