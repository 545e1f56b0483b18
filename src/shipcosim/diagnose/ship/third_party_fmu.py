"""Third-party FMUs that load the ship: what feeds them, what of their outputs reaches her, their parameters."""

import keyword
import re
from collections.abc import Collection
from dataclasses import dataclass, field, make_dataclass
from typing import Any, NamedTuple

from shipcosim.diagnose.ship.surrogate import Surrogate, ThirdPartyPart
from shipcosim.errors import Problem
from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.core.parameters import quantity
from shipcosim.series import conversion
from shipcosim.ssp import Component, Connection, System

DRIVES = {"rpm": "rpm", "thrust": "N", "azimuth": "rad"}
"""Quantity of a thruster in a log, and the unit in which the FMU gets it."""
MOTION = ("x", "y", "psi", "u", "v", "r", "u_r", "v_r")
"""Outputs of the ship that a log tells."""
_UNITS = {
    "rpm": ("rpm", "rad/s", "rev/s", "rev/min"),
    "thrust": ("N", "kN"),
    "azimuth": ("rad", "deg"),
}
_ENDINGS = {
    "rpm": ("rpm", "rpm_in"),
    "thrust": ("thrust", "thrust_in", "thrust_cmd"),
    "azimuth": ("azimuth", "azimuth_in"),
}
"""How names of inputs end that are such a quantity; no commanded speed: a log has the measured one."""
_KNOWN = 0.02  # of the thrust, if no more is given (assumed)


class Link(NamedTuple):
    """What feeds an input: ``factor * quantity + offset``, the quantity in rpm, N, rad, m, m/s or rad/s."""

    quantity: str
    variable: str
    factor: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class ThirdPartyFmu:
    """A third-party FMU that puts a load on the ship.

    Attributes
    ----------
    component : Component
    links : tuple of Link
        Inputs that a log feeds.
    loads : tuple of (str, str, float, float)
        Axis of the ship, output, and factor and offset on the way.
    parameters : dict of str to str
        By the number's name: variable of each parameter that is known within a tolerance.
    idle : tuple of str
        Inputs that the system feeds and no log: they keep their start value.
    unclear : tuple of str
        Inputs of which more than one could be its speed, or its direction.
    thrust_signal : str
        Signal of a run that is its commanded thrust; empty where there is none.
    step : float or None
        Of the system. [s]
    surrogate : Surrogate or None
        Its loads over a log.
    """

    component: Component
    links: tuple[Link, ...]
    loads: tuple[tuple[str, str, float, float], ...]
    parameters: dict[str, str] = field(default_factory=dict)
    idle: tuple[str, ...] = ()
    unclear: tuple[str, ...] = ()
    thrust_signal: str = ""
    step: float | None = None
    surrogate: Surrogate | None = None

    @property
    def built_surrogate(self) -> Surrogate:
        """Its surrogate, once `with_surrogates` has built one."""
        if self.surrogate is None:
            raise ValueError(f"{self.component.name} has no surrogate yet")
        return self.surrogate

    @property
    def drives(self) -> tuple[str, ...]:
        """Channels that a log needs for it: ``"rpm"`` or ``"thrust"``, ``"azimuth"``."""
        return tuple(kind for kind in DRIVES if any(link.quantity == kind for link in self.links))


def number_of(component: Component, name: str) -> float:
    """Start value of a number of a component."""
    value = component.start_value(name)
    if not isinstance(value, (int, float)):
        raise ValueError(f"{component.name}.{name} is {value!r}, no number")
    return float(value)


def drives_of(first: Arithmetic, azimuth: Arithmetic) -> dict[str, Arithmetic]:
    """Inputs of a third-party FMU by quantity; `first` is its speed [rev/s] or its thrust [N]."""
    return {"rpm": 60.0 * first, "thrust": first, "azimuth": azimuth}


def third_party_fmu_of(system: System, name: str, ship: str) -> ThirdPartyFmu:
    """A component of a system as a third-party FMU.

    Parameters
    ----------
    system : System
    name, ship : str
        Of the component, and of the ship that it loads.

    Returns
    -------
    ThirdPartyFmu
        Without links where nothing that a log has feeds it; `problem_of` says so.
    """
    component = system.components[name]
    # Connections into each input of the FMU.
    into = {}
    for connection in system.connections:
        if connection.target[0] == name:
            into.setdefault(connection.target[1], []).append(connection)
    links = []
    idle = []
    unclear = []
    drives = {kind: [] for kind in DRIVES}
    # Sort the inputs: fed by the motion of the ship, by a
    # drive of a thruster, or by nothing that a log has.
    for variable, feeding in into.items():
        if all(
            c.source[0] == ship and c.source[1] in MOTION and c.mapping is None for c in feeding
        ):
            links += [Link(c.source[1], variable, c.factor, c.offset) for c in feeding]
        elif kind := _kind(system, feeding[0]):
            drives[kind].append(feeding[0])
        else:
            idle.append(variable)
    # With a speed the FMU needs no commanded thrust, which keeps its start value.
    if drives["rpm"]:
        idle += [c.target[1] for c in drives.pop("thrust")]
    # Of several candidates for a drive, the one that is
    # named for this thruster; else it is unclear which.
    for kind, candidates in drives.items():
        named = [c for c in candidates if c.source[1] == f"{name}_{kind}"] or candidates
        one_source = len({c.source for c in named}) == 1
        links += [_drive(system, kind, c) for c in named if one_source]
        unclear += [c.target[1] for c in named if not one_source]
        idle += [c.target[1] for c in candidates if c not in named]
    # The output of another component that commands its thrust, if nothing scales it on the way.
    commands = [
        ".".join(c.source)
        for c in drives.get("thrust", ())
        if c.source[0] is not None and (c.factor, c.offset) == (1.0, 0.0)
    ]
    # Connections from the FMU's outputs to the load on the ship.
    loads = tuple(
        (c.target[1][4], c.source[1], c.factor, c.offset)
        for c in system.connections
        if c.source[0] == name and c.target[0] == ship and c.target[1].startswith("tau_")
    )
    step = max(filter(None, (system.experiment.step_size, component.step_size)), default=None)
    return ThirdPartyFmu(
        component,
        tuple(links),
        loads,
        _parameters(component),
        tuple(idle),
        tuple(unclear),
        commands[0] if len(commands) == 1 else "",
        step,
    )


def _kind(system: System, connection: Connection) -> str | None:
    """Kind of drive that an input is, by the unit of its source, or by its name without a unit."""
    source, given = connection.source
    label = given if source is None else connection.target[1]
    # The unit decides, and the name must agree with it. Without a unit only a speed is recognised.
    unit = _unit(system, connection)
    named = next((kind for kind, ends in _ENDINGS.items() if label.endswith(ends)), None)
    if unit in (None, "", "1"):
        return "rpm" if named == "rpm" else None
    kind = next((kind for kind, units in _UNITS.items() if unit in units), None)
    return kind if named == kind or (source is None and kind != "thrust") else None


def _unit(system: System, connection: Connection) -> str | None:
    """Unit in which a log would feed it: that of the system's input, else of the variable."""
    (source, given) = connection.source
    (name, variable) = connection.target
    of_variable = None if name is None else system.components[name].variables[variable].unit
    return (system.inputs[given].unit or of_variable) if source is None else of_variable


def _drive(system: System, kind: str, connection: Connection) -> Link:
    """The link from a log to an input, through the system where one of its inputs feeds it."""
    unit = _unit(system, connection)
    # Convert from the unit of the log to that of the input,
    # then apply the connection's own factor and offset.
    per, offset = (1.0, 0.0) if unit in (None, "", "1") else conversion(DRIVES[kind], unit)
    if connection.source[0] is not None:
        return Link(kind, connection.target[1], per, offset)
    return Link(
        kind,
        connection.target[1],
        connection.factor * per,
        connection.factor * offset + connection.offset,
    )


def _parameters(component: Component) -> dict[str, str]:
    """Variables of real parameters with a tolerance, by the names of their numbers."""
    by_number = {}
    for variable in component.tolerances:
        real = component.variables.get(variable)
        scalar = (
            real is not None
            and isinstance(component.start_value(variable), float)
            and not real.dimensions
        )
        if scalar and variable not in _numbers(DRIVES):
            name = re.sub(r"\W", "_", variable)
            by_number[
                name if name.isidentifier() and not keyword.iskeyword(name) else f"_{name}"
            ] = variable
    return by_number


def _numbers(drives: Collection[str]) -> dict[str, Any]:
    """Numbers of every thruster, also of third parties: its loss, and offsets of its inputs."""
    loss = quantity(
        0.0, "1", "share of its load that is missing", "neutral", tolerance=_KNOWN, maximum=1.0
    )
    offset = quantity(0.0, "rpm", "given speed minus the real one", "neutral")
    most = quantity(1.0, "rpm", "largest speed", "the FMU's, else the log's", minimum=1e-6)
    turned = quantity(0.0, "rad", "real direction minus the given one", "neutral", tolerance=0.0035)
    numbers = {"thrust_loss": loss} if drives else {}
    numbers |= {"rpm_offset": offset, "rpm_max": most} if "rpm" in drives else {}
    return numbers | ({"azimuth_offset": turned} if "azimuth" in drives else {})


def part_of(third_party: ThirdPartyFmu) -> ThirdPartyPart:
    """Numbers of a third-party FMU: neutral ones, and its parameters that are known within a tolerance.

    Parameters
    ----------
    third_party : ThirdPartyFmu

    Returns
    -------
    ThirdPartyPart
    """
    component = third_party.component
    numbers = _numbers(third_party.drives)
    for name, variable in third_party.parameters.items():
        about = component.variables[variable]
        tolerance = component.tolerances[variable]
        text = about.description or variable
        value = component.start_value(variable)
        numbers[name] = quantity(
            value, about.unit or "1", text, "the system's", tolerance=tolerance
        )
    listed = [(name, float, number) for name, number in numbers.items()]
    return make_dataclass("ThirdPartyPartOf", listed, bases=(ThirdPartyPart,), frozen=True)()


def problem_of(system: System, name: str, ship: str, fmu: ThirdPartyFmu) -> Problem | None:
    """Remark on a third-party FMU whose load a log does not determine; None if it does."""
    if fmu.links and not fmu.unclear:
        return None
    why = (
        f"any of {', '.join(fmu.unclear)} could be what drives it"
        if fmu.unclear
        else "nothing of a log feeds it"
    )
    message = f"'{name}' ({fmu.component.fmu.model_name}) puts a load on '{ship}', and {why}."
    remedy = (
        f"Feed it by inputs of the system: its speed by '{name}_rpm' [rpm or rad/s] and its direction by '{name}_azimuth' "
        f"[deg or rad], or its thrust by '{name}_thrust'. Or feed its inputs from the ship's {', '.join(MOTION)}."
    )
    return Problem(system.file, message, remedy)
