"""The static DP capability of a ship: the weather of DNV-ST-0111 against her thrusters.

The room can be called: ``shipcosim.capability(system)`` is the function of this name in `shipcosim.calls`.
"""

import sys

from shipcosim import CallableRoom
from shipcosim.capability.assessment import vessel_of
from shipcosim.capability.compute import capability_of, cases_of
from shipcosim.capability.result import Capability, Case, as_json, dataset, notation, numbers_table
from shipcosim.capability.vessel import Vessel, read_vessel

__all__ = [
    "Capability",
    "Case",
    "Vessel",
    "as_json",
    "capability_of",
    "cases_of",
    "dataset",
    "notation",
    "numbers_table",
    "read_vessel",
    "vessel_of",
]

sys.modules[__name__].__class__ = CallableRoom
