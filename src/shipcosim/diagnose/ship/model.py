"""The ship of a system in array form: her parameter sets, and every number of them that may be wrong.

All numbers that a cause can change are of one flat mapping, named ``place.name``: parameters of components
(``vessel.mass``, ``port.thrust_loss``), of the surroundings (``water.current_north``) and of the instruments
(``instruments.lever_x``).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import MISSING, dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from shipcosim.diagnose.ship.environment import water_of
from shipcosim.diagnose.ship.form import HullForm, ThrusterForm, WindForm, form_of, form_sizes
from shipcosim.diagnose.ship.instruments import Instruments
from shipcosim.diagnose.ship.third_party_fmu import ThirdPartyFmu, part_of, problem_of, third_party_fmu_of
from shipcosim.diagnose.ship.thrusters import fixed_of, neighbours_of, neighbours_placed
from shipcosim.diagnose.ship.tolerances import tolerances_of
from shipcosim.diagnose.ship.wiring import wiring_of
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.propulsion.azimuth import AzimuthParameters
from shipcosim.models.propulsion.tunnel import TunnelParameters
from shipcosim.models.ship.hull import HullParameters

if TYPE_CHECKING:
    from shipcosim.diagnose.ship.wiring import Wiring
    from shipcosim.ssp import Component, System

__all__ = ["ANY_CAUSE", "ShipModel", "ship_model_of"]

ANY_CAUSE = "any cause"
_OURS = (AzimuthParameters, TunnelParameters)


@dataclass(frozen=True)
class ShipModel:
    """A ship with her thrusters, as the diagnosis moves her.

    Attributes
    ----------
    parts : dict of str to dataclass
        Parameter sets by place: ``vessel``'s hull and wind under ``hull`` and ``wind``, thrusters by component,
        ``water``, ``instruments``, and ``hull_form``, ``wind_form`` and, say, ``port.form``, how the loads differ from
        the model's form.
    vessel : str
        Name of the ship's component.
    tolerances : dict of str to float
        By ``place.name`` as the system names it, in its unit.
    form_scale : float
        How far the form of her loads may differ from the model's, over what is usual; 0 where it is the model's. [1]
    directions : tuple of dict of str to float
        What a reference leaves uncertain of her numbers, instead of their tolerances: changes of several numbers at
        once, independent of each other, each of one standard deviation.
    ordinary_errors : dict of str to float
        Gain of unmodelled errors, by kind, up to which they are no news by a reference; under `ANY_CAUSE` what a cause
        gains by a model of another form. [nats]
    span : tuple of two floats
        First and last time of the log, between which the current varies. [s]
    wind_is_true : bool
        The log has the wind over ground instead of the apparent one.
    wiring : Wiring or None
        Where the system wires thrusters otherwise than named.
    third_party : dict of str to ThirdPartyFmu
        Third-party FMUs that load the ship, with their surrogates once there is a log.
    fixed : dict of str to float
        Direction of azimuth thrusters of ours that neither the system nor the log turns. [rad]
    neighbours : dict of str to str
        By azimuth thruster of ours, the one whose slipstream can hit it.
    """

    parts: dict[str, Any]
    vessel: str = "vessel"
    tolerances: dict[str, float] = field(default_factory=dict)
    form_scale: float = 0.0
    directions: tuple[dict[str, float], ...] = ()
    ordinary_errors: dict[str, float] = field(default_factory=dict)
    span: tuple[float, float] = (0.0, 1.0)
    wind_is_true: bool = False
    wiring: Wiring | None = None
    third_party: dict[str, ThirdPartyFmu] = field(default_factory=dict)
    fixed: dict[str, float] = field(default_factory=dict)
    neighbours: dict[str, str] = field(default_factory=dict)

    @property
    def numbers(self) -> list[str]:
        """Every number that a cause can change, ``place.name``."""
        places = {part: self.vessel if part in ("hull", "wind") else part for part in self.parts}
        return [f"{places[part]}.{item.name}" for part, values in self.parts.items() for item in fields(values)]

    @property
    def uncertainties(self) -> dict[str, float]:
        """Standard deviation of every number that is not known for sure: by its tolerance, and by the form's."""
        found = dict(self.tolerances)
        for path, size in form_sizes(self).items() if self.form_scale else ():
            found[path] = float(np.hypot(found.get(path, 0.0), self.form_scale * size))
        return found

    @property
    def referenced(self) -> set[str]:
        """Numbers that a reference speaks for."""
        return set().union(*self.directions)

    @staticmethod
    def is_of_day(path: str) -> bool:
        """Whether a number is another on each day: what surrounds the ship, and the offsets of her instruments."""
        return path.startswith(("water.", "instruments."))

    @property
    def thrusters(self) -> list[str]:
        """Names of the thrusters."""
        return [name for name in self.parts if self.drives(name)]

    @property
    def azimuths(self) -> list[str]:
        """Names of the thrusters that turn."""
        return [name for name in self.parts if "azimuth" in self.drives(name)]

    def drives(self, name: str) -> tuple[str, ...]:
        """What a log should have of a part: ``"rpm"``, ``"azimuth"``; nothing where it is no thruster."""
        if name in self.third_party:
            return self.third_party[name].drives
        if isinstance(self.parts[name], AzimuthParameters) and name not in self.fixed:
            return "rpm", "azimuth"
        return ("rpm",) if isinstance(self.parts[name], _OURS) else ()

    def get(self, path: str) -> Any:
        """Value of a number."""
        part, name = self._where(path)
        return getattr(self.parts[part], name)

    def about(self, path: str) -> Mapping[str, Any]:
        """Unit, description, bounds and origin of a number."""
        part, name = self._where(path)
        return next(item for item in fields(self.parts[part]) if item.name == name).metadata

    def has(self, path: str) -> bool:
        """Whether there is such a number."""
        try:
            self._where(path)
        except KeyError:
            return False
        return True

    def with_values(self, values: Mapping[str, Any]) -> ShipModel:
        """The same ship with other numbers.

        Parameters
        ----------
        values : mapping of str to float or array

        Returns
        -------
        ShipModel
        """
        changes = {}
        for path, value in values.items():
            part, name = self._where(path)
            changes.setdefault(part, {})[name] = value
        return replace(
            self, parts=self.parts | {part: replace(self.parts[part], **new) for part, new in changes.items()}
        )

    def _where(self, path: str) -> tuple[str, str]:
        place, _, name = path.rpartition(".")
        for part in ("hull", "wind") if place == self.vessel else (place,):
            if part in self.parts and name in self.parts[part].__dataclass_fields__:
                return part, name
        raise KeyError(path)


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
    parts = {"hull": _values(ship, HullParameters), "wind": _values(ship, WindParameters)}
    third_party = {}
    for name in _loading(system, ship.name):
        kind = _thruster_kind(system.components[name])
        if kind is None:
            third_party[name] = third_party_fmu_of(system, name, ship.name)
        parts[name] = _values(system.components[name], kind) if kind else part_of(third_party[name])
    if problems := list(filter(None, (problem_of(system, name, ship.name, one) for name, one in third_party.items()))):
        raise ShipcosimError(problems)
    ours, water = [name for name in parts if isinstance(parts[name], _OURS)], water_of(parts["hull"].length)
    neighbours = neighbours_of(system, parts)
    parts = neighbours_placed(parts, neighbours) | {"water": water, "instruments": Instruments()}
    driven = [*ours, *(name for name, one in third_party.items() if one.drives)]
    parts |= {"hull_form": HullForm(), "wind_form": WindForm()} | {form_of(name): ThrusterForm() for name in driven}
    found = {"wiring": wiring_of(system, ship.name, ours), "third_party": third_party}
    found |= {"fixed": fixed_of(system, parts), "neighbours": neighbours}
    return ShipModel(parts, ship.name, tolerances_of(system, parts, ship.name), **found)


def _vessel(system: System) -> Component:
    """The only component with the parameters of a hull."""
    vessels = [c for c in system.components.values() if _holds(c, HullParameters)]
    if len(vessels) != 1:
        found = ", ".join(f"{name} ({c.fmu.model_name})" for name, c in system.components.items())
        raise ShipcosimError(
            Problem(
                system.file,
                f"{len(vessels)} components with the parameters of a hull among: {found}.",
                "The diagnosis needs a system with exactly one vessel.fmu.",
            )
        )
    return vessels[0]


def _loading(system: System, ship: str) -> list[str]:
    """Components that put a load on the ship."""
    sources = {c.source[0] for c in system.connections if c.target[0] == ship and c.target[1].startswith("tau_")}
    return [name for name in system.components if name in sources]


def _holds(component: Component, kind: type) -> bool:
    """Whether an FMU has the parameters of a kind; one built by an earlier version may lack a few."""
    there = [item.name in component.fmu.variables for item in fields(kind)]
    return sum(there) >= 0.7 * len(there)


def _thruster_kind(component: Component) -> type | None:
    """Class of parameters of a thruster of ours; None of any other FMU, and of one that lacks what describes a unit.

    An earlier version may have built that one, with numbers that only its code knows: it is learnt like anybody's.
    """
    kinds = [kind for kind in _OURS if _holds(component, kind)]
    return next((kind for kind in kinds if not _missing(component, kind)), None)


def _missing(component: Component, kind: type) -> list[str]:
    """Names of what describes a ship and an FMU does not know."""
    names = [item.name for item in fields(kind) if item.default is MISSING]
    return [name for name in names if name not in component.fmu.variables]


def _left_out(system: System, ship: Component) -> Iterator[Problem]:
    """Problems of a ship and of thrusters of ours: parameters that nothing gives, or that the FMU does not know."""
    for component in system.components.values():
        kinds = (HullParameters, WindParameters) if component is ship else filter(None, [_thruster_kind(component)])
        kinds, where = list(kinds), f"{system.file}: {component.name}"
        if names := [item.name for kind in kinds for item in fields(kind) if item.name in component.left_out]:
            found = f"parameters left out, which have no value of their own: {', '.join(names)}."
            yield Problem(where, found, "Give them, as a ship's parameter set does.")
        if names := [name for kind in kinds for name in _missing(component, kind)]:
            found = f"its FMU has no {', '.join(names)}: an earlier version built it."
            yield Problem(where, found, "Build it again: shipcosim build.")


def _values(component: Component, kind: type) -> Any:
    """Parameters of a component; those that its FMU does not know change nothing."""
    names = [item.name for item in fields(kind) if item.name in component.fmu.variables]
    return kind(**{name: component.start_value(name) for name in names})
