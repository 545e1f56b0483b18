"""The ship of a system in array form: her parameter sets, and every number of them that may be wrong.

All numbers that a cause can change are of one flat mapping, named ``place.name``: parameters of components
(``vessel.mass``, ``port.thrust_loss``), of the surroundings (``water.current_north``) and of the instruments
(``instruments.lever_x``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from shipcosim.diagnose.ship.form import form_functions, form_sizes
from shipcosim.diagnose.ship.slipstreams import Slipstreams
from shipcosim.diagnose.ship.third_party_fmu import ThirdPartyFmu
from shipcosim.diagnose.ship.wiring import Wiring
from shipcosim.models.propulsion.azimuth import AzimuthParameters
from shipcosim.models.propulsion.tunnel import TunnelParameters

ANY_CAUSE = "any cause"
OWN_THRUSTERS = (AzimuthParameters, TunnelParameters)


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
    slipstreams : Slipstreams or None
        What the system's own FMU of their interaction says of it.
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
    slipstreams: Slipstreams | None = None

    @property
    def numbers(self) -> list[str]:
        """Every number that a cause can change, ``place.name``."""
        places = {part: self.vessel if part in ("hull", "wind") else part for part in self.parts}
        return [
            f"{places[part]}.{item.name}"
            for part, values in self.parts.items()
            for item in fields(values)
        ]

    @property
    def length(self) -> float:
        """Between the perpendiculars. [m]"""
        return self.parts["hull"].length

    @property
    def mass_matrix(self) -> np.ndarray:
        """Mass and moment of inertia with added mass, (3, 3) array. [kg, kg, kg.m2]"""
        # Inverse of the inverse mass matrix, with surge decoupled from sway and yaw.
        i11, i22, i26, i62, i66 = self.parts["hull"].inverse_mass
        return np.linalg.inv(np.array([[i11, 0.0, 0.0], [0.0, i22, i26], [0.0, i62, i66]]))

    def make_of(self, thruster: str) -> object:
        """What kind of thruster it is."""
        third_party = self.third_party.get(thruster)
        if third_party:
            return third_party.component.fmu.model_name
        return type(self.parts[thruster])

    @property
    def uncertainties(self) -> dict[str, float]:
        """Standard deviation of every number that is not known for sure: by its tolerance, and by the form's."""
        # Independent errors of parameters and of form add up as squares.
        stds = dict(self.tolerances)
        for path, size in self.form_sizes.items() if self.form_scale else ():
            stds[path] = float(np.hypot(stds.get(path, 0.0), self.form_scale * size))
        return stds

    @property
    def form_sizes(self) -> dict[str, float]:
        """How far each number of her form may be off, of scale 1: standard deviation by ``place.name``."""
        return form_sizes(self.parts, self.vessel, self._driven)

    @property
    def form_functions(self) -> dict[str, dict[str, float]]:
        """Functions of her form in words, each with its numbers and how much one adds to its mean square."""
        return form_functions(self.parts, self.vessel, self._driven)

    @property
    def _driven(self) -> dict:
        return {name: self.drives(name) for name in self.thrusters}

    @property
    def referenced(self) -> set[str]:
        """Numbers that a reference is evidence for."""
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
    def thrust_signals(self) -> dict[str, str]:
        """Signals of a run that command the thrust of thrusters which follow that, by thruster."""
        return {
            name: fmu.thrust_signal for name, fmu in self.third_party.items() if fmu.thrust_signal
        }

    @property
    def azimuths(self) -> list[str]:
        """Names of the thrusters that turn."""
        return [name for name in self.parts if "azimuth" in self.drives(name)]

    def drives(self, name: str) -> tuple[str, ...]:
        """Channels that a log should have for a part: ``"rpm"``, ``"azimuth"``; none unless it is a thruster."""
        if name in self.third_party:
            return self.third_party[name].drives
        if isinstance(self.parts[name], AzimuthParameters) and name not in self.fixed:
            return "rpm", "azimuth"
        return ("rpm",) if isinstance(self.parts[name], OWN_THRUSTERS) else ()

    def get(self, path: str) -> Any:
        """Value of a number."""
        part, name = self._where(path)
        return getattr(self.parts[part], name)

    def about(self, path: str) -> Mapping[str, Any]:
        """Unit, description, bounds and origin of a number."""
        part, name = self._where(path)
        return next(item for item in fields(self.parts[part]) if item.name == name).metadata

    def within_bounds(self, path: str, value: float) -> float:
        """The value of a number, brought to what it can be."""
        about = self.about(path)
        low = -np.inf if about["minimum"] is None else about["minimum"]
        high = np.inf if about["maximum"] is None else about["maximum"]
        return float(np.clip(value, low, high))

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
        # Collect the values of each part, so that each is replaced once.
        changes = {}
        for path, value in values.items():
            part, name = self._where(path)
            changes.setdefault(part, {})[name] = value
        return replace(
            self,
            parts=self.parts
            | {part: replace(self.parts[part], **new) for part, new in changes.items()},
        )

    def with_tolerances(self, tolerances: dict[str, float]) -> ShipModel:
        """The same ship with other tolerances of some numbers."""
        return replace(self, tolerances=self.tolerances | tolerances)

    def _where(self, path: str) -> tuple[str, str]:
        place, _, name = path.rpartition(".")
        for part in ("hull", "wind") if place == self.vessel else (place,):
            if part in self.parts and name in self.parts[part].__dataclass_fields__:
                return part, name
        raise KeyError(path)
