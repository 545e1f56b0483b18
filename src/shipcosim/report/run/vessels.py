"""Vessels of a table and their signals, found by the names of signals of any tool."""

import re
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from os.path import commonprefix
from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import Dataset

from shipcosim.errors import ShipcosimError
from shipcosim.models.core.tables import columns
from shipcosim.report.run.details import parsed
from shipcosim.report.run.roles import find_roles, join
from shipcosim.report.theme.display import series_in
from shipcosim.report.theme.numbers import finite
from shipcosim.series import conversion

Pair = tuple[float, float]


AXES = {
    "x": ("x", "north", "northing"),
    "y": ("y", "east", "easting"),
    "psi": ("psi", "heading", "yaw", "hdg"),
}
POSE_UNITS = ("m", "m", "deg")
AROUND = ("", "position", "pos", "displacement", "ned")  # words that may stand beside an axis
AIMS = {
    "set point": ("set", "setpoint", "sp"),
    "reference": ("d", "ref", "reference", "des", "desired"),
}
SAME_PLACE = 3.0  # m: what stays nearer to a vessel all along is the same vessel, as a sensor or a predictor sees it
COMMON_WORDS = {"vessel", "ship", "hull", "boat", "model", "fmu"}
PLACE = ("{}", "position_{}", "{}_position", "rudder_{}", "propeller_{}")
Pose = tuple[str, str, str]


@dataclass(frozen=True)
class DrawnThruster:
    """A thruster: its signals, None for missing ones, and its start values.

    Attributes
    ----------
    name : str
    thrust : str
    force : (str, str), optional
        Its load on the ship, forward and to starboard.
    azimuth, rpm, thrust_command, azimuth_command, saturated, failed, available : str, optional
    place : (float, float), optional
        Forward and to starboard. [m, m]
    limits : (float, float), optional
        Least and largest thrust. [N, N]
    sectors : tuple of (float, float)
        Angles that its allocator does not give it, from and to, clockwise from the bow. [rad, rad]
    """

    name: str
    thrust: str
    force: tuple[str, str] | None
    azimuth: str | None
    rpm: str | None
    thrust_command: str | None
    azimuth_command: str | None
    saturated: str | None
    failed: str | None
    available: str | None
    place: Pair | None
    limits: Pair | None
    sectors: tuple[Pair, ...]


@dataclass(frozen=True)
class Vessel:
    """Something with a position and a heading.

    Attributes
    ----------
    name : str
    pose : (str, str, str)
        Signals north, east, heading.
    velocity : sequence of str or None
        Signals u, v, r.
    aims : dict of str to tuple of str or None
        Signals north, east, heading of "reference" and "set point".
    size : (float, float), optional
        Length and breadth. [m, m]
    units : sequence of DrawnThruster
        Thrusters.
    """

    name: str
    pose: Pose
    velocity: Sequence[str | None]
    aims: dict[str, tuple[str, str, str | None]]
    size: Pair | None
    units: Sequence[DrawnThruster]


def find_vessels(table: Dataset) -> Sequence[Vessel]:
    """Every vessel of a table, the most important first.

    Parameters
    ----------
    table : xarray.Dataset
        A run of any system.

    Returns
    -------
    sequence of Vessel
    """
    names = list(series_in(table))
    main = find_roles(names).ship

    # The main ship first, then by number of loads: sensors have none.
    def rank(pose: Pose) -> tuple[bool, int]:
        loads = f"{_owner(pose)}.tau_"
        return _owner(pose) != main, -sum(name.startswith(loads) for name in names)

    # A pose that never moves is an unconnected input, unless it is called a ship, which may lie still.
    poses = sorted(_poses(table, names), key=rank)
    called_ship = tuple(COMMON_WORDS - {"model", "fmu"})
    moving = []
    for pose in poses:
        values = [table[name].values.astype(float) for name in pose]
        moves = table.sizes["time"] > 0 and any(np.ptp(value) > 0.0 for value in values)
        if moves or _owner(pose).lower().endswith(called_ship):
            moving.append(pose)
    apart: list[Pose] = []
    for pose in moving or poses[:1]:
        # A pose near another one is a sensor or a predictor of the same vessel.
        if all(_apart(table, pose, other) for other in apart):
            apart.append(pose)
    starts = start_values(table)
    return [_vessel(pose, _belonging(pose, apart, names), starts) for pose in apart]


def start_values(table: Dataset) -> dict[str, Any]:
    """Start values of the run, as the table's attribute holds them; empty where there are none."""
    starts = parsed(table.attrs.get("start_values"))
    return starts if isinstance(starts, dict) else {}


def in_unit(table: Dataset, name: str, unit: str) -> NDArray | None:
    """Values of a signal in a unit, (n,); None for another quantity. SI where it has no unit."""
    scale = conversion_to(table, name, unit)
    if scale is None:
        return None
    factor, offset = scale
    return factor * np.asarray(table[name].values, float) + offset


def pose_of(table: Dataset, signals: Iterable[str]) -> list[NDArray]:
    """North, east and heading of a vessel, whose units have been checked. [m, m, deg]"""
    values = [in_unit(table, *each) for each in zip(signals, POSE_UNITS, strict=False)]
    return [value for value in values if value is not None]


def conversion_to(table: Dataset, name: str, unit: str) -> tuple[float, float] | None:
    """Factor and offset from a signal's unit to another one; None for another quantity."""
    # Without a unit: SI, so N for kN and rad for deg.
    own_unit = table[name].attrs.get("units") or {"kN": "N", "deg": "rad"}.get(unit, unit)
    try:
        return conversion(own_unit, unit)
    except ShipcosimError:
        return None


def _plain(connector: str) -> str:
    """A connector's name without case, underscores and brackets: `Position_North` is `positionnorth`."""
    return re.sub(r"[^a-z0-9]", "", connector.lower())


def _poses(table: Dataset, names: list[str]) -> list[Pose]:
    """Signals of every position that has an east for its north and a heading nearby."""
    poses = []
    headings = [n for n in names if _is(n, "psi") and in_unit(table, n, "rad") is not None]
    # North and east must be lengths, the heading an angle; names alone may mislead.
    for north in (n for n in names if _is(n, "x") and in_unit(table, n, "m") is not None):
        east = next(
            (e for e in _east_signals(north, names) if in_unit(table, e, "m") is not None), None
        )
        heading = _nearest(north, headings)
        if east is not None and heading is not None:
            poses.append((north, east, heading))
    return poses


def _is(name: str, axis: str, endings: Iterable[str] = ("",)) -> bool:
    # Names, as `_plain` gives them, under which an axis is known.
    words = [a + word + b for word in AXES[axis] for a in AROUND for b in AROUND if not (a and b)]
    spellings = {word + ending for word in words for ending in endings}
    return _plain(name.rpartition(".")[2]) in spellings


def _east_signals(north: str, names: list[str]) -> list[str]:
    """East signals for a north signal: the same name except for the word."""
    component, _, connector = north.rpartition(".")
    plain = _plain(connector)
    # Replace the word for north by the matching word for east: north and east, x and y.
    for word, other in zip(AXES["x"], AXES["y"], strict=True):
        wanted = {plain.replace(word, other, 1)} if word in plain else set()
        for name in names:
            place, _, last_name = name.rpartition(".")
            if (
                place == component
                and name != north
                and _plain(last_name) in wanted
                and _is(name, "y")
            ):
                return [name]
    return []


def _nearest(north: str, headings: list[str]) -> str | None:
    """Heading of the same component; for `north`, which is always a position, the nearest one."""
    # Nearest in the tree of components: the longest common path.
    path = north.split(".")[:-1]
    shared = {name: len(commonprefix([path, name.split(".")[:-1]])) for name in headings}
    best = max(headings, key=lambda name: (shared[name], -name.count(".")), default=None)
    if best is None or best.split(".")[:-1] == path:
        return best
    # A bare x of another component may be anything: then no heading is taken.
    is_bare = shared[best] == 0 or _plain(north.split(".")[-1]) == "x"
    return None if is_bare else best


def _owner(pose: Pose) -> str:
    return pose[0].rpartition(".")[0]


def _apart(table: Dataset, pose: Pose, other: Pose) -> bool:
    """True if two poses belong to two vessels, which are not in the same place."""
    # Distance over the run; median, since two ships may pass close to each other.
    gaps = [
        (in_unit(table, a, "m"), in_unit(table, b, "m"))
        for a, b in zip(pose[:2], other[:2], strict=True)
    ]
    distance = np.hypot(*(np.subtract(a, b) for a, b in gaps if a is not None and b is not None))
    distance = finite(distance)
    return bool(len(distance) and np.max(distance) > 0.0 and np.median(distance) > SAME_PLACE)


def _words(name: str) -> set[str]:
    """Words and numbers of a component's name: of `fleet.tug_2` fleet, tug and 2."""
    return (
        set(re.findall(r"[a-z]+|\d+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).lower()))
        - COMMON_WORDS
    )


def _belonging(pose: Pose, poses: list[Pose], names: list[str]) -> list[str]:
    """Signals of a vessel: in the same nested system, or with the word that distinguishes her."""
    owners = {other: _owner(other) for other in poses}
    owner = owners[pose]
    # With one vessel everything is hers.
    if len(poses) == 1:
        return names
    # Vessels in nested systems of their own: the system decides.
    systems = {other: name.rpartition(".")[0] for other, name in owners.items()}
    if systems[pose] and len(set(systems.values())) == len(poses):
        return [name for name in names if name.startswith(f"{systems[pose]}.")]
    # Else the words that only this vessel's name has, as a number or a ship's name.
    common = set.intersection(*(_words(name) for name in owners.values()))
    keys = {other: _words(name) - common for other, name in owners.items()}

    def whose(name: str) -> list[Pose]:
        words = _words(name.rpartition(".")[0])
        return [other for other, key in keys.items() if key and key <= words]

    return [name for name in names if name.startswith(f"{owner}.") or whose(name) == [pose]]


def _vessel(pose: Pose, names: list[str], starts: Mapping[str, Any]) -> Vessel:
    # Size from the start values, under the names that tools use.
    owner = _owner(pose)
    length, breadth = (
        _first_number(starts, owner, words)
        for words in (("length", "length_pp", "lpp"), ("breadth", "beam"))
    )
    velocity = [join(owner, axis) for axis in "uvr"]
    return Vessel(
        name=owner or "ship",
        pose=pose,
        velocity=[name if name in names else None for name in velocity],
        aims=_aims(pose, names),
        size=None
        if length is None or breadth is None or min(length, breadth) <= 0.0
        else (length, breadth),
        units=find_units(names, starts),
    )


def _aims(pose: Pose, names: list[str]) -> dict[str, tuple[str, str, str | None]]:
    """Signals of set point and reference on the way there."""
    aims = {}
    for aim, endings in AIMS.items():
        # North by its name, then east and heading of the same component.
        north = next((name for name in names if _is(name, "x", endings) and name != pose[0]), None)
        candidates = [
            n
            for n in names
            if north is not None and n.rpartition(".")[0] == north.rpartition(".")[0]
        ]
        east = next((name for name in candidates if _is(name, "y", endings)), None)
        heading = next((name for name in candidates if _is(name, "psi", endings)), None)
        if north is not None and east is not None:
            aims[aim] = (north, east, heading)
    return aims


def find_units(names: Iterable[Hashable], starts: Mapping[str, Any]) -> Sequence[DrawnThruster]:
    """Thrusters of these signals.

    Parameters
    ----------
    names : iterable of str
        Signals.
    starts : mapping of str to value
        Start values, as `start_values` gives them.

    Returns
    -------
    sequence of DrawnThruster
    """
    # Forces on the ship, where a thruster puts out both.
    roles = find_roles(names)
    drawn = []
    for unit in roles.thrusters:
        x, y = (roles.signal(unit, f"tau_{axis}") for axis in "XY")
        azimuth = roles.signal(unit, "azimuth")
        place = _place(unit, starts)
        drawn.append(
            DrawnThruster(
                name=unit,
                thrust=join(unit, "thrust"),
                force=(x, y) if x and y else None,
                azimuth=azimuth,
                rpm=roles.signal(unit, "rpm"),
                thrust_command=roles.command(unit, "thrust"),
                azimuth_command=roles.command(unit, "azimuth"),
                saturated=roles.signal(unit, "saturated"),
                failed=roles.signal(unit, "failed"),
                available=roles.signal(unit, "available"),
                place=place,
                limits=_limits(unit, starts),
                # Only what turns has angles that it is not given.
                sectors=_sectors(unit, place, roles.allocators(), starts) if azimuth else (),
            )
        )
    return drawn


def _place(unit: str, starts: Mapping[str, Any]) -> Pair | None:
    """Place of a thruster, forward and to starboard; the latter is 0 where missing. [m, m]"""
    forward, starboard = (
        _first_number(starts, unit, [word.format(axis) for word in PLACE]) for axis in "xy"
    )
    return None if forward is None else (forward, starboard or 0.0)


def _limits(unit: str, starts: Mapping[str, Any]) -> Pair | None:
    # Limits by name, else the ends of the thrust map.
    most, least = (_first_number(starts, unit, (f"thrust_{end}",)) for end in ("max", "min"))
    if most is None:
        least, most = _ends_of_map(starts.get(join(unit, "thrust_table")))
    if most is None or most <= 0.0:
        return None
    # Without a least thrust: the same astern as ahead.
    return (-most if least is None else least, most)


def _ends_of_map(table: Any) -> Pair | tuple[None, None]:
    """Least and largest thrust of a map, rows 'command thrust' as text. [N, N]"""
    try:
        thrusts = columns(table if isinstance(table, str) else "", 2)[1]
    except ValueError:
        return None, None
    return thrusts[0], thrusts[-1]


def _sectors(
    unit: str,
    place: Pair | None,
    allocators: Iterable[str],
    starts: Mapping[str, Any],
) -> tuple[Pair, ...]:
    """Sector outside the range of angles that an allocator gives a thruster. [rad, rad]

    The unit is found by its name in that of the range, `port_azimuth_first`, or by the place of `azimuth_first_1`.
    """
    # The range is in the allocator's parameters, by the thruster's name or number.
    for allocator in allocators:
        for before, after in (
            (f"{unit.rpartition('.')[2]}_", ""),
            *(("", f"_{n}") for n in range(1, 10)),
        ):
            names = (f"{before}azimuth_{end}{after}" for end in ("first", "last"))
            first, last = (_first_number(starts, allocator, (name,)) for name in names)
            # A number belongs to this thruster if the allocator has its place.
            there = before or place == tuple(
                _first_number(starts, allocator, (axis + after,)) for axis in "xy"
            )
            if not there or first is None or last is None:
                continue
            # The forbidden sector is the rest of the turn.
            if 0.0 < last - first < 2.0 * np.pi:
                return ((last, first + 2.0 * np.pi),)
    return ()


def _first_number(starts: Mapping[str, Any], component: str, words: Iterable[str]) -> float | None:
    """The first start value of these names that is a number."""
    values = (starts.get(join(component, word)) for word in words)
    numbers = (float(v) for v in values if isinstance(v, int | float) and not isinstance(v, bool))
    return next((number for number in numbers if np.isfinite(number)), None)
