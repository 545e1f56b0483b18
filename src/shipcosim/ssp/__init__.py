"""System structures (SSP 1.0 and 2.0): read, check, write. The only door to lxml."""

from shipcosim.ssp.archive import unpack
from shipcosim.ssp.fmu import FmuDescription, Variable, read_fmu
from shipcosim.ssp.system import Component, Signal, System, read_system, with_values
from shipcosim.ssp.wiring import Connection

__all__ = [
    "Component",
    "Connection",
    "FmuDescription",
    "Signal",
    "System",
    "Variable",
    "read_fmu",
    "read_system",
    "unpack",
    "with_values",
]
