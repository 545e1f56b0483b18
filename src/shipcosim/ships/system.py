"""Systems of a described ship: open, for replays and diagnosis; in a closed DP loop; in steering trials."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from shipcosim.errors import Problem, ShipcosimError, error_at
from shipcosim.ships.control import COMPONENTS, dp_entries, units_for_dp, why_no_dp
from shipcosim.ships.described import Described, describe
from shipcosim.ships.entries import Quantity
from shipcosim.ships.folder import Ship
from shipcosim.ships.kinds import FMU_OF, PARAMETERS
from shipcosim.ships.parameter_set import parameter_values
from shipcosim.ships.thrusters import ShipThruster
from shipcosim.ssp import AnyPath, SystemStructure, new, parameter, read, write_ssv

STEP = 0.05  # s
LONG_RUN = 600.0
SAID = {
    "open": "without control, thrusters and weather from outside, for replays",
    "dp": "in a closed DP loop, gains by rule",
    "trials": "in steering trials, turning circles and zig-zags, on calm water",
}
"""Kind of system: what it is."""
WEATHER = ("wind_north", "wind_east", "current_north", "current_east")
SEA = ("wave_height", "wave_period", "wave_from", "wave_peak_enhancement", "wave_seed")
OUTSIDE = {
    "true_wind_speed": ("wind_speed", "m/s", "mean wind speed over ground"),
    "true_wind_from": ("wind_from", "deg", "direction the wind comes from, from true north"),
    "current_speed": ("current_speed", "m/s", "speed of the current"),
    "current_to": ("current_to", "deg", "direction the current flows to, from true north"),
}
"""Input of an open system: input of the environment, unit, meaning."""
REPLAYED = ("azimuth_thruster", "tunnel_thruster", "mapped_thruster")
MEASURED = (
    *(f"{name}_{i}_meas" for i in (1, 2, 3) for name in "xyuv"),
    *(f"position_{i}_valid" for i in (1, 2, 3)),
    *(f"psi_{i}_meas" for i in (1, 2)),
    *(f"compass_{i}_valid" for i in (1, 2)),
    *("r_meas", "wind_speed_meas", "wind_from_meas", "wind_valid"),
    *(f"{name}_time_meas" for name in ("position", "heading", "wind")),
)
DESIRED = ("x_d", "y_d", "psi_d", "x_d_dot", "y_d_dot", "r_d", "x_d_ddot", "y_d_ddot", "r_d_dot")
TRUTH = (
    *("x", "y", "psi", "u", "v", "r"),
    *(f"{name}_wave" for name in ("x", "y", "psi", "u", "v", "r")),
)
APPARENT = ("apparent_wind_speed", "apparent_wind_from")


def make_systems(
    ship: AnyPath | Described,
    out: AnyPath,
    fmus: Iterable[AnyPath],
) -> list[Path]:
    """Parameter sets and systems of a ship: ``NAME_open``, and where her thrusters allow them ``NAME_dp``, ``NAME_trials``.

    Parameters
    ----------
    ship : path or Described
        Her file, or what is known of her.
    out : path
        Folder that gets a folder for each system.
    fmus : iterable of path
        Folders with the FMUs.

    Returns
    -------
    list of Path
        Folders of the systems.

    Raises
    ------
    ShipcosimError
        With everything that is missing.
    """
    described = ship if isinstance(ship, Described) else describe(Path(ship))
    folders = [Path(folder) for folder in fmus]
    made = []
    # Every ship gets an open system; a DP system and steering trials only if her thrusters allow them.
    kinds = ["open"]
    if not why_no_dp(described):
        kinds.append("dp")
    if steering_units(described):
        kinds.append("trials")
    for kind in kinds:
        name = f"{described.name}_{kind}"
        entries = described.entries | (dp_entries(described) if kind == "dp" else {})
        system = structure(described, kind, folders)
        folder = Path(out) / name
        # Values of all components; estimates included.
        values = list(parameter_values(_as_ship(described, entries), _kinds(described, kind)))
        # Without a DP thrusters follow measured inputs instead of commands.
        if kind != "dp":
            follow = "follows the inputs of the system, not a command"
            values += [
                parameter(f"{u.name}.replay", True, None, follow)
                for u in described.units
                if u.fmu in REPLAYED
            ]
        if kind == "trials":
            values += _trial_values(described)
        # Write the structure, then the values, then bind them: the check needs both.
        system.write(folder, fmus=False)
        write_ssv(folder / "resources" / f"{described.name}.ssv", described.name, values)
        bound = read(folder, fmus=folders)
        bound.bind(f"resources/{described.name}.ssv")
        bound.write(folder, fmus=False)
        made.append(folder)
    return made


def check_numbers(ship: Described) -> list[Problem]:
    """Problems of a ship's parameters: missing, out of bounds, wrong unit.

    Parameters
    ----------
    ship : Described
    """
    try:
        _as_ship(ship, ship.entries).parameter_set(_kinds(ship, "open"))
    except ShipcosimError as error:
        return error.problems
    return []


def structure(ship: Described, kind: str, fmus: Iterable[Path]) -> SystemStructure:
    """System of a ship without her numbers.

    Parameters
    ----------
    ship : Described
    kind : str
        ``"open"``, ``"dp"`` or ``"trials"``.
    fmus : iterable of Path
        Folders with the FMUs.

    Raises
    ------
    ShipcosimError
        If an FMU is missing.
    """
    folders = list(fmus)
    # Components first, then connections: each block is checked at its end.
    system = new(f"{ship.name}_{kind}")
    components = {"environment": "environment", "vessel": "vessel"} | {
        unit.name: unit.fmu for unit in ship.units
    }
    components |= {"dp": COMPONENTS, "trials": {"trial": "steering_trial"}}.get(kind, {})
    with system.changes():
        for name, fmu in components.items():
            system.add_component(name, _fmu(fmu, folders))
    # Wires of ship and weather, and those of the loop or of the trials.
    more = {"dp": _loop_wires, "trials": _trial_wires}.get(kind, lambda _: ())
    wires = [*_around(ship.units), *more(ship)]
    with system.changes():
        for source, target in wires:
            system.connect(source, target)
        # Commands and weather come from outside in an open system.
        if kind == "open":
            _open_to_outside(system, ship)
    system.description = f"{ship.file.description or ship.name}: {SAID[kind]}"
    # Default experiment of the system.
    system.start_time = 0.0
    system.stop_time = LONG_RUN
    system.step_size = STEP
    return system


def _fmu(name: str, folders: list[Path]) -> Path:
    for folder in folders:
        if (folder / f"{name}.fmu").is_file():
            return folder / f"{name}.fmu"
    raise error_at(f"{name}.fmu", "There is no such FMU.", "`shipcosim build` builds them.")


def _around(units: list[ShipThruster]) -> Iterable[tuple[str, str]]:
    """Connections between weather, hull and thrusters."""
    # The environment acts on the hull.
    yield from ((f"environment.{name}", f"vessel.{name}") for name in (*WEATHER, *SEA))
    # Each thruster gives its load to the hull, and gets the flow at the hull.
    for number, unit in enumerate(units, 1):
        yield from ((f"{unit.name}.tau_{axis}", f"vessel.tau_{axis}_{number}") for axis in "XYN")
        flow = ("u_r",) if unit.fmu == "tunnel_thruster" else ("u_r", "v_r", "r")
        yield from ((f"vessel.{name}", f"{unit.name}.{name}") for name in flow)


def _open_to_outside(system: SystemStructure, ship: Described) -> None:
    """Inputs of an open system: commands of thrusters, wind and current."""
    for unit in ship.units:
        for name, unit_of, target, description in _commands(unit, ship):
            system.add_connector(name, "input", unit=unit_of, description=description)
            system.connect(name, f"{unit.name}.{target}")
    for name, (target, unit_of, description) in OUTSIDE.items():
        system.add_connector(name, "input", unit=unit_of, description=description)
        system.connect(name, f"environment.{target}")


def _commands(unit: ShipThruster, ship: Described) -> Iterable[tuple[str, str | None, str, str]]:
    """Inputs of a thruster from outside: name, unit, FMU input, description."""
    # The command is a force, a map's command, or a speed.
    by_thrust = any(
        thruster.name == unit.name and getattr(thruster, "command", "") == "thrust"
        for thruster in ship.file.thrusters
    )
    if by_thrust:
        yield f"{unit.name}_thrust", "N", "thrust_in", f"force of thruster {unit.name}"
    elif unit.kind == "map":
        yield (
            f"{unit.name}_command",
            "1",
            "command_in",
            f"command of thruster {unit.name}, in the unit of its map",
        )
    else:
        yield f"{unit.name}_rpm", "rpm", "rpm_in", f"speed of thruster {unit.name}"
    # Azimuths and rudders also have an angle.
    if unit.kind == "azimuth":
        yield (
            f"{unit.name}_azimuth",
            "deg",
            "azimuth_in",
            "direction of positive thrust, clockwise from the bow",
        )
    if unit.kind == "rudder":
        yield (
            f"{unit.name}_azimuth",
            "deg",
            "azimuth_in",
            "rudder angle, positive to where it turns the ship to port",
        )


def _loop_wires(ship: Described) -> Iterable[tuple[str, str]]:
    """Connections of the DP loop."""
    # Ship to sensors, sensors and reference to controller.
    yield from ((f"vessel.{name}", f"sensors.{name}") for name in (*TRUTH, *APPARENT))
    yield from ((f"sensors.{name}", f"controller.{name}") for name in MEASURED)
    yield from ((f"reference.{name}", f"controller.{name}") for name in DESIRED)
    # Requested load to allocator and consequence analysis, allocated load back to the observer.
    for axis in "XYN":
        yield f"controller.tau_{axis}_cmd", f"allocator.tau_{axis}_cmd"
        yield f"controller.tau_{axis}_cmd", f"consequences.tau_{axis}_cmd"
        yield f"allocator.tau_{axis}", f"controller.tau_{axis}_allocated"
    # Commands to each thruster, and its availability back.
    for number, unit in enumerate(units_for_dp(ship), 1):
        given = "thrust_in" if unit.fmu == "fixed_thruster" else "thrust_cmd"
        yield f"allocator.thrust_cmd_{number}", f"{unit.name}.{given}"
        if unit.kind == "azimuth":
            yield f"allocator.azimuth_cmd_{number}", f"{unit.name}.azimuth_cmd"
        yield f"{unit.name}.available", f"allocator.available_{number}"
        yield f"{unit.name}.available", f"consequences.available_{number}"


def steering_units(ship: Described) -> list[ShipThruster]:
    """Thrusters that steer her under way: rudders behind propellers, and azimuths at the stern."""
    return [unit for unit in ship.units if unit.kind in ("azimuth", "rudder") and unit.x < 0.0]


def _trial_wires(ship: Described) -> Iterable[tuple[str, str]]:
    """Connections of the steering trials: her motion to the trial, its orders to the units that steer."""
    yield from ((f"vessel.{name}", f"trial.{name}") for name in ("x", "y", "psi"))
    for unit in steering_units(ship):
        yield "trial.rpm", f"{unit.name}.rpm_in"
        yield "trial.azimuth", f"{unit.name}.azimuth_in"


def _trial_values(ship: Described) -> Iterable[Any]:
    """Start values of the steering trials: full ahead at the service speed, ten lengths straight ahead first."""
    unit = steering_units(ship)[0]
    speed = ship.form.speed
    yield parameter("vessel.u_start", speed, "m/s", "service speed")
    yield parameter("trial.order_time", 10.0 * ship.form.length / speed, "s", "ten lengths")
    if unit.screw:
        yield parameter("trial.shaft_rpm", unit.screw.rpm, "rpm", "full ahead")
    if unit.azimuth_rate:
        yield parameter("trial.helm_rate", unit.azimuth_rate, "rad/s", "the azimuth's turning rate")


def _kinds(ship: Described, kind: str) -> dict[str, tuple[type, ...]]:
    """Parameter classes by component."""
    kinds = {"vessel": PARAMETERS["vessel"]} | {
        unit.name: PARAMETERS[FMU_OF[unit.kind]] for unit in ship.units
    }
    return kinds | (
        {name: PARAMETERS[fmu] for name, fmu in COMPONENTS.items()} if kind == "dp" else {}
    )


def _as_ship(ship: Described, entries: Mapping[str, Mapping[str, Quantity]]) -> Ship:
    return Ship(ship.name, ship.file.description, ship.path.parent, (), entries)
