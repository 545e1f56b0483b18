"""Parameter classes of each FMU of a ship, and the FMU of each kind of thruster."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from shipcosim.models.allocation.consequences import ConsequenceParameters
from shipcosim.models.allocation.optimal import OptimalUnitsParameters
from shipcosim.models.control.observer import DpShip, ObserverParameters
from shipcosim.models.control.pid import ControlParameters
from shipcosim.models.control.reference import ReferenceParameters
from shipcosim.models.control.voting import VotingParameters
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.propulsion.azimuth import AzimuthParameters
from shipcosim.models.propulsion.fixed import FixedParameters
from shipcosim.models.propulsion.mapped import MapParameters
from shipcosim.models.propulsion.rudder import PropellerRudderParameters
from shipcosim.models.propulsion.tunnel import TunnelParameters
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.mast import MastParameters
from shipcosim.models.ship.sensors import SensorParameters
from shipcosim.models.ship.vessel import DriftParameters

PARAMETERS: dict[str, tuple[type, ...]] = {
    "vessel": (HullParameters, WindParameters, DriftParameters),
    "fixed_thruster": (FixedParameters,),
    "azimuth_thruster": (AzimuthParameters,),
    "tunnel_thruster": (TunnelParameters,),
    "mapped_thruster": (MapParameters,),
    "propeller_rudder": (PropellerRudderParameters,),
    "sensors": (SensorParameters, MastParameters),
    "reference": (ReferenceParameters,),
    "dp_controller": (
        DpShip,
        ObserverParameters,
        ControlParameters,
        WindParameters,
        MastParameters,
        VotingParameters,
    ),
    "optimal_units_allocator": (OptimalUnitsParameters,),
    "consequence_analysis": (ConsequenceParameters,),
}
"""FMU: its classes of parameters."""
FMU_OF = {
    "fixed": "fixed_thruster",
    "azimuth": "azimuth_thruster",
    "tunnel": "tunnel_thruster",
    "map": "mapped_thruster",
    "rudder": "propeller_rudder",
}
"""Kind of thruster: the FMU that it is."""


def metadata_of(fmu: str) -> dict[str, Mapping[str, Any]]:
    """Unit, columns and the like of an FMU's parameters by name, as `models.core.parameters` declares them."""
    return {
        field.name: field.metadata
        for kind in PARAMETERS[fmu]
        for field in fields(kind)
        if field.init
    }
