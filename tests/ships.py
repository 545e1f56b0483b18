"""Parameters of the ships in ssp/ships, for tests of the models."""

from dataclasses import MISSING, fields, replace
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from shipcosim.models.propulsion.azimuth import AzimuthParameters
from shipcosim.ships import Ship, read_ship

Kind = TypeVar("Kind")
FOLDER = Path(__file__).resolve().parents[1] / "ssp" / "ships"
SHIPS = sorted(file.parent.name for file in FOLDER.glob("*/ship.toml"))
GUNNERUS = sorted({"gunnerus-28m9", "gunnerus-33m9", "thesis", "thesis-28m9"} & set(SHIPS))
"""Those with DP and the thrusters of R/V Gunnerus; the others are craft of which measured logs are known."""
COMPONENTS = {
    "HullParameters": "vessel",
    "WindParameters": "vessel",
    "DriftParameters": "vessel",
    "AzimuthParameters": "port",
    "PropellerParameters": "port",
    "TunnelParameters": "tunnel",
    "FixedParameters": "left",
    "PropellerRudderParameters": "propeller",
    "SensorParameters": "sensors",
    "ReferenceParameters": "reference",
    "DpShip": "controller",
    "ObserverParameters": "controller",
    "ControlParameters": "controller",
    "FilteredPidParameters": "controller",
    "ExtremeLearningParameters": "allocator",
    "MastParameters": "sensors",
    "AllocationParameters": "allocator",
    "PaperVParameters": "allocator",
    "OptimalParameters": "allocator",
    "ExtendedParameters": "allocator",
    "PowerParameters": "allocator",
    "SurroundingsParameters": "predictor",
    "HelmParameters": "docking_predictor",
    "ObserverAhead": "predictor",
}
"""Class of parameters: a component that has them."""


@cache
def ship(name: str = "gunnerus-33m9") -> Ship:
    """A ship of ssp/ships."""
    return read_ship(FOLDER / name)


def parameters(kind: type[Kind], name: str = "gunnerus-33m9", component: str = "") -> Kind:
    """Parameters of a ship's component, of the one that has them by default."""
    return ship(name).parameters(kind, component or COMPONENTS[kind.__name__])


def unit_on_centreline(**changes: float) -> AzimuthParameters:
    """An azimuth thruster of the lengthened ship on her centreline, without a neighbour."""
    return replace(
        parameters(AzimuthParameters),
        **{"y": 0.0, "neighbour_x": 0.0, "neighbour_y": 0.0} | changes,
    )


def equipped(fmu: Any, component: str, name: str = "gunnerus-33m9") -> Any:
    """An FMU's object with the parameters of a ship's component."""
    for group in fmu.groups:
        made = ship(name).parameters(group.kind, component)
        for field in fields(group.kind):
            setattr(fmu, group.prefix + field.name, getattr(made, field.name))
    return fmu


def lend(structure: Any, component: str, *kinds: type) -> None:
    """Give a component of a system what the lengthened ship has: what has no default, and her hull's damping.

    Without tolerances, as of a ship of which nobody says how well she is known.
    """
    for kind in kinds:
        made = parameters(kind)
        for field in fields(kind):
            if field.default is MISSING or field.name in (
                "cross_flow_drag",
                "lift",
                "lift_x",
                "X_uu",
            ):
                structure.set(f"{component}.{field.name}", getattr(made, field.name))


COMPONENT_OF = {
    "vessel": "vessel",
    "rough_vessel": "vessel",
    "azimuth_thruster": "port",
    "tunnel_thruster": "tunnel",
    "sensors": "sensors",
    "reference": "reference",
    "dp_controller": "controller",
    "allocator": "allocator",
    "extended_allocator": "allocator",
    "optimal_allocator": "allocator",
    "paper_v_allocator": "allocator",
    "thruster_monitor": "monitor",
    "predictor": "predictor",
    "dp_predictor": "predictor",
    "drift_predictor": "predictor",
}
"""FMU: the component of the DP ship that it is."""
ELSEWHERE = {
    "fixed_thruster": ("otter", "left"),
    "propeller_rudder": ("kvlcc2", "propeller"),
    "pid_controller": ("osv", "controller"),
    "paper_i_allocator": ("osv", "allocator"),
    "thruster_interaction": ("four-azimuths", "interaction"),
    "consequence_analysis": ("four-azimuths", "consequences"),
    "docking_predictor": ("gunnerus-28m9", "docking_predictor"),
    "helmsman": ("gunnerus-28m9", "helmsman"),
}
"""FMU that the DP ship has not: a ship and her component that it is."""


def given_to(fmu: str) -> dict[str, Any]:
    """What the lengthened ship says of an FMU's parameters, or another that has one; nothing of one that is in none."""
    name, component = ELSEWHERE.get(fmu, ("gunnerus-33m9", COMPONENT_OF.get(fmu, "")))
    entries = ship(name).entries.get(component, {})
    return {name: entry.value for name, entry in entries.items()}
