"""The slave for each version and form of FMI."""

from pathlib import Path

from shipcosim.cosim.slaves.fmi1 import Model1, Slave1
from shipcosim.cosim.slaves.fmi2 import Slave, Slave2
from shipcosim.cosim.slaves.fmi3 import Slave3
from shipcosim.cosim.slaves.form import form_of
from shipcosim.cosim.slaves.model_exchange import Model2, Model3
from shipcosim.ssp import Component

SLAVES = {"1.0": Slave1, "2.0": Slave2, "3.0": Slave3}
MODELS = {"1.0": Model1, "2.0": Model2, "3.0": Model3}


def slave_of(component: Component, folder: Path) -> Slave:
    """New instance of a component's FMU, which is unpacked in a folder. Raises SlaveError if that fails."""
    fmu = component.fmu
    if form_of(component) == "ModelExchange":
        return MODELS[fmu.fmi_version](component.name, folder, fmu)
    return SLAVES[fmu.fmi_version](component.name, folder, fmu.model_identifier, fmu.token)
