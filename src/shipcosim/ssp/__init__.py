"""System structures (SSP 1.0 and 2.0): read, checked, edited, written; FMUs' descriptions, OSP's structures."""

from shipcosim.ssp.check import check_file, check_system
from shipcosim.ssp.edit.opening import new, read
from shipcosim.ssp.edit.system_structure import SystemStructure
from shipcosim.ssp.edit.write import (
    mapping_text,
    pack,
    parameter,
    parameters_of,
    ssv_text,
    write_ssv,
)
from shipcosim.ssp.fitting_values import fitting_values
from shipcosim.ssp.flatten.connections import Connection
from shipcosim.ssp.flatten.system import Component, Signal, System
from shipcosim.ssp.flatten.with_values import with_values
from shipcosim.ssp.fmu.description import FmuDescription, Variable
from shipcosim.ssp.fmu.reader import read_fmu
from shipcosim.ssp.osp.log_config import read_log_config
from shipcosim.ssp.osp.reader import osp_file
from shipcosim.ssp.osp.writer import Simulator, seconds_text, structure_text
from shipcosim.ssp.single_fmu import default_step_size, settings_for, step_remarks
from shipcosim.ssp.system_files import read_system
from shipcosim.ssp.xml.archive import unpack
from shipcosim.ssp.xml.document import AnyPath

AnySystem = AnyPath | SystemStructure | System
"""A system in whichever form."""

__all__ = [
    "AnyPath",
    "AnySystem",
    "Component",
    "Connection",
    "FmuDescription",
    "Signal",
    "Simulator",
    "System",
    "SystemStructure",
    "Variable",
    "check_file",
    "check_system",
    "default_step_size",
    "fitting_values",
    "new",
    "osp_file",
    "pack",
    "parameter",
    "parameters_of",
    "ssv_text",
    "mapping_text",
    "read",
    "read_fmu",
    "read_log_config",
    "read_system",
    "seconds_text",
    "settings_for",
    "step_remarks",
    "structure_text",
    "unpack",
    "with_values",
    "write_ssv",
]
