"""The ship of a system in array form, read from the parameters of its FMUs."""

from collections.abc import Iterator
from dataclasses import MISSING, fields
from typing import Any

from shipcosim.diagnose.ship.environment import water_of
from shipcosim.diagnose.ship.form import HullForm, ThrusterForm, WindForm, form_of
from shipcosim.diagnose.ship.instruments import Instruments
from shipcosim.diagnose.ship.model import OWN_THRUSTERS, ShipModel
from shipcosim.diagnose.ship.slipstreams import Slipstreams
from shipcosim.diagnose.ship.third_party_fmu import part_of, problem_of, third_party_fmu_of
from shipcosim.diagnose.ship.thrusters import fixed_of, neighbours_of, neighbours_placed
from shipcosim.diagnose.ship.tolerances import tolerances_of
from shipcosim.diagnose.ship.wiring import wiring_of
from shipcosim.errors import Problem, ShipcosimError, error_at
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.propulsion.interaction import InteractionParameters
from shipcosim.models.ship.hull import HullParameters
from shipcosim.ssp import System
from shipcosim.ssp.flatten.system import Component


def ship_model_of(system: System) -> ShipModel:
    """The ship of a system with our vessel.fmu; FMUs that load her may be third-party ones.

    Parameters
    ----------
    system : System
        With one vessel, and FMUs whose loads go into it.

    Returns
    -------
    ShipModel

    Raises
    ------
    ShipcosimError
        No vessel, or loads on it of FMUs that no log feeds.
    """
    ship = _vessel(system)
    if problems := list(_left_out(system, ship)):
        raise ShipcosimError(problems)
    # Parameter sets of the hull, the wind, and all components that load the ship.
    parts = {"hull": _values(ship, HullParameters), "wind": _values(ship, WindParameters)}
    third_party = {}
    for name in _loading(system, ship.name):
        kind = _thruster_kind(system.components[name])
        if kind is None:
            third_party[name] = third_party_fmu_of(system, name, ship.name)
        parts[name] = _values(system.components[name], kind) if kind else part_of(third_party[name])
    # Third-party FMUs need inputs that a log can feed.
    if problems := list(
        filter(
            None, (problem_of(system, name, ship.name, fmu) for name, fmu in third_party.items())
        )
    ):
        raise ShipcosimError(problems)
    # Surroundings, slipstream neighbours and neutral deviations of form.
    ours = [name for name in parts if isinstance(parts[name], OWN_THRUSTERS)]
    water = water_of(parts["hull"].length)
    neighbours = neighbours_of(system, parts)
    parts = neighbours_placed(parts, neighbours) | {"water": water, "instruments": Instruments()}
    driven = [*ours, *(name for name, fmu in third_party.items() if fmu.drives)]
    parts |= {"hull_form": HullForm(), "wind_form": WindForm()} | {
        form_of(name): ThrusterForm() for name in driven
    }
    parts_of_system = {"wiring": wiring_of(system, ship.name, ours), "third_party": third_party}
    parts_of_system |= {"fixed": fixed_of(system, parts), "neighbours": neighbours}
    parts_of_system["slipstreams"] = _slipstreams(system, ours)
    return ShipModel(parts, ship.name, tolerances_of(system, parts, ship.name), **parts_of_system)


def _vessel(system: System) -> Component:
    """The only component with the parameters of a hull; a predictor has them too, but no inputs for loads."""
    hulls = [c for c in system.components.values() if _holds(c, HullParameters)]
    vessels = [c for c in hulls if "tau_X_1" in c.variables] or hulls
    if len(vessels) != 1:
        shown = ", ".join(f"{name} ({c.fmu.model_name})" for name, c in system.components.items())
        raise error_at(
            system.file,
            f"{len(vessels)} components with the parameters of a hull among: {shown}.",
            "The diagnosis needs a system with exactly one vessel.fmu.",
        )
    return vessels[0]


def _loading(system: System, ship: str) -> list[str]:
    """Components that put a load on the ship."""
    # Sources of connections into the load inputs of the ship.
    sources = {
        c.source[0]
        for c in system.connections
        if c.target[0] == ship and c.target[1].startswith("tau_")
    }
    return [name for name in system.components if name in sources]


def _slipstreams(system: System, thrusters: list[str]) -> Slipstreams | None:
    """The interaction of thrusters by the system's own FMU; None without one."""
    for component in system.components.values():
        if not _holds(component, InteractionParameters):
            continue
        # Each connection from its outputs `thrust_share_1`, ... to a thruster gives that one's number.
        fed = {
            c.target[0]: c.source[1] for c in system.connections if c.source[0] == component.name
        }
        numbers = {
            name: int(fed[name].removeprefix("thrust_share_")) - 1
            for name in thrusters
            if name in fed
        }
        return Slipstreams(_values(component, InteractionParameters), numbers)
    return None


def _holds(component: Component, kind: type) -> bool:
    """Whether an FMU has the parameters of a kind; one built by an earlier version may lack a few."""
    there = [item.name in component.variables for item in fields(kind)]
    return sum(there) >= 0.7 * len(there)


def _thruster_kind(component: Component) -> type | None:
    """Class of parameters of a thruster of ours; None of any other FMU, and of one that lacks what describes a unit.

    An earlier version may have built that one, with numbers that only its code knows: it is learnt like anybody's.
    """
    kinds = [kind for kind in OWN_THRUSTERS if _holds(component, kind)]
    return next((kind for kind in kinds if not _missing(component, kind)), None)


def _missing(component: Component, kind: type) -> list[str]:
    """Names of what describes a ship and an FMU does not know."""
    names = [item.name for item in fields(kind) if item.default is MISSING]
    return [name for name in names if name not in component.variables]


def _left_out(system: System, ship: Component) -> Iterator[Problem]:
    """Problems of a ship and of thrusters of ours: parameters that nothing gives, or that the FMU does not know."""
    for component in system.components.values():
        kinds = (
            (HullParameters, WindParameters)
            if component is ship
            else filter(None, [_thruster_kind(component)])
        )
        kinds = list(kinds)
        where = f"{system.file}: {component.name}"
        if names := [
            item.name for kind in kinds for item in fields(kind) if item.name in component.left_out
        ]:
            message = f"parameters left out, which have no value of their own: {', '.join(names)}."
            yield Problem(where, message, "Give them, as a ship's parameter set does.")
        if names := [name for kind in kinds for name in _missing(component, kind)]:
            message = f"its FMU has no {', '.join(names)}: an earlier version built it."
            yield Problem(where, message, "Build it again: shipcosim build.")


def _values(component: Component, kind: type) -> Any:
    """Parameters of a component; defaults for those that its FMU lacks."""
    names = [item.name for item in fields(kind) if item.name in component.variables]
    return kind(**{name: component.start_value(name) for name in names})
