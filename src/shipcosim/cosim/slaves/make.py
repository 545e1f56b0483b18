"""The slave for each version and interface type of FMI."""

from pathlib import Path

from shipcosim.cosim.slaves.fmi1 import Model1, Slave1
from shipcosim.cosim.slaves.fmi2 import Slave2
from shipcosim.cosim.slaves.fmi3 import Slave3
from shipcosim.cosim.slaves.interface_type import interface_type_of
from shipcosim.cosim.slaves.library_slave import LibrarySlave
from shipcosim.cosim.slaves.model_exchange import Model2, Model3
from shipcosim.ssp import Component

CO_SIMULATION = {"1.0": Slave1, "2.0": Slave2, "3.0": Slave3}
MODEL_EXCHANGE = {"1.0": Model1, "2.0": Model2, "3.0": Model3}


def make_slave(component: Component, folder: Path) -> LibrarySlave:
    """New instance of a component's FMU, which is unpacked in a folder.

    Raises
    ------
    SlaveError
        If the FMU cannot be loaded or instantiated.
    """
    fmu = component.fmu
    if interface_type_of(component) == "ModelExchange":
        return MODEL_EXCHANGE[fmu.fmi_version](component.name, folder, fmu)
    return CO_SIMULATION[fmu.fmi_version](component.name, folder, fmu.model_identifier, fmu.token)
