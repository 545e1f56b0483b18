"""System structures (SSP 1.0 and 2.0): read, check, change, write. The only door to lxml."""

from shipcosim.ssp.archive import unpack
from shipcosim.ssp.check import check_file, check_system
from shipcosim.ssp.edit import SystemStructure, new, read
from shipcosim.ssp.fmu import FmuDescription, Variable, read_fmu
from shipcosim.ssp.system import Component, Signal, System, read_system, with_values
from shipcosim.ssp.wiring import Connection
from shipcosim.ssp.write import pack, parameter, write_ssv

__all__ = [
    "Component",
    "Connection",
    "FmuDescription",
    "Signal",
    "System",
    "SystemStructure",
    "Variable",
    "check_file",
    "check_system",
    "new",
    "pack",
    "parameter",
    "read",
    "read_fmu",
    "read_system",
    "unpack",
    "with_values",
    "write_ssv",
]
