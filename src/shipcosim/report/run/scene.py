"""The scene of a run: data of the page's DP display, as one compact table and its records."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import degrees
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from xarray import Dataset

from shipcosim.angles import unwrap_series
from shipcosim.report.run.predictions import predicted_tracks
from shipcosim.report.run.roles import find_roles
from shipcosim.report.run.track import hull_outline, outline_rows, symbol_size
from shipcosim.report.run.vessels import (
    POSE_UNITS,
    DrawnThruster,
    Vessel,
    conversion_to,
    find_vessels,
    in_unit,
    pose_of,
    start_values,
)
from shipcosim.report.theme.display import is_constant
from shipcosim.report.theme.numbers import extent
from shipcosim.report.theme.packing import LARGEST, LEVELS, packed_series
from shipcosim.report.theme.views import JsonObject
from shipcosim.scenario import Verdict

MOST_ROWS = (
    2400  # of the scene's table: at 64 times real time half an hour of them passes in a minute
)
EXACT = 1e9  # steps of the time axis
METRES = 0.01  # what a screen can tell apart
DEGREES = 0.02
REFERENCE = re.compile(r"(?:.*\.)?((?:position|compass|heading|wind|gnss|gyro)\w*)_valid")
BUS = re.compile(r"(.*\.)(\w*bus\w*)_load")
FLOWS = {"wind": ("from", -1.0), "current": ("to", 1.0)}  # named by where it comes from or goes to


class Recipe(NamedTuple):
    """How a column follows from signals: ``factor * signal + offset``, times cosine or sine of an angle in rad.

    Attributes
    ----------
    signal : str
    factor, offset : float
    angle : str
        Signal of the angle; none where empty.
    trigonometric : str
        ``"cos"`` or ``"sin"``.
    turns : bool
        Whether it is an angle in degrees that goes on beyond a turn.
    """

    signal: str
    factor: float = 1.0
    offset: float = 0.0
    angle: str = ""
    trigonometric: str = ""
    turns: bool = False


@dataclass(frozen=True)
class Run:
    """One run in the scene.

    Attributes
    ----------
    label : str
        Its name where there are two.
    time : dict or list
        Column of times. [s]
    columns : dict of str to number, dict or list
        Packed columns by name.
    vessels : list of dict
        Name, size, outline, columns and thrusters of each.
    flows : list of dict
        Wind, current and waves.
    circles : list of dict
        Where expectations want her.
    watch : dict
        Limits that alarms of the position and heading watch. [m, deg]
    read_as : list of str
        What had to be supposed.
    predicted : list of dict
        Tracks that predictors foretold, of the first vessel.
    references : list of dict
        Label of each, and the columns that say that it works and that it is rejected.
    buses : list of dict
        Label of each, and the columns of its load and of the most that it has for thrusters. [W]
    recipes : dict of str to Recipe
        How the columns follow from signals, for a run that goes on; the page of a finished run has none.
    colour : str
        As the style sheet names it; empty: by the run's place among the others.
    """

    label: str
    time: Any
    columns: JsonObject
    vessels: list[JsonObject]
    flows: list[JsonObject]
    circles: list[JsonObject]
    watch: dict[str, float]
    read_as: list[str]
    predicted: list[JsonObject]
    references: list[JsonObject]
    buses: list[JsonObject]
    recipes: dict[str, Recipe] = field(default_factory=dict)
    colour: str = ""


@dataclass
class _Columns:
    """Columns while they are collected from a table."""

    table: Dataset
    rows: NDArray
    packed: JsonObject = field(default_factory=dict)
    recipes: dict[str, Recipe] = field(default_factory=dict)
    without_unit: list[str] = field(default_factory=list)

    def add(self, name: str | None, unit: str, resolution: float = np.inf) -> str | None:
        """Pack a signal, unless it is missing, has another quantity, or has no finite value."""
        if name is None or name not in self.table:
            return None
        # Flags have no unit; everything else is converted.
        values = (
            self.table[name].values.astype(float) if unit == "" else in_unit(self.table, name, unit)
        )
        if values is None or not np.isfinite(values).any():
            return None
        # A table without units is read as SI: remember this for the remark.
        if unit and not self.table[name].attrs.get("units"):
            self.without_unit.append(
                f"{name} in {'rad' if unit == 'deg' else unit.removeprefix('k')}"
            )
        # Angles without jumps, so that the display can interpolate.
        recipe = Recipe(
            name, *(self.conversion_of(name, unit) if unit else (1.0, 0.0)), turns=unit == "deg"
        )
        self.put(name, unwrap_degrees(values) if unit == "deg" else values, recipe, resolution)
        return name

    def conversion_of(self, name: str, unit: str) -> tuple[float, float]:
        """Factor and offset from a signal's own unit to another one."""
        return conversion_to(self.table, name, unit) or (1.0, 0.0)

    def put(self, name: str, values: ArrayLike, recipe: Recipe, resolution: float = np.inf) -> str:
        """Pack values under a name."""
        self.recipes[name] = recipe
        self.packed[name] = _packed(np.asarray(values, float)[self.rows], resolution)
        return name


def make_run(
    table: Dataset,
    verdicts: Sequence[Verdict] = (),
    label: str = "",
    shift: float = 0.0,
    goes_on: bool = False,
) -> Run | None:
    """The scene of one run; None if no component has a position and a heading.

    Parameters
    ----------
    table : xarray.Dataset
        A run of any system, as it was stored.
    verdicts : sequence of Verdict
        What was expected; expectations on a position become circles.
    label : str
        Name of the run, where there are two.
    shift : float
        Added to its times. [s]
    goes_on : bool
        Whether the page goes on with the run: then flows that are zero so far are shown, too.

    Returns
    -------
    Run or None
    """
    # Collect columns while the vessels are made: each signal is stored once.
    vessels = find_vessels(table) if table.sizes["time"] else ()
    time = np.asarray(table["time"].values, float) + shift
    # Every row, or evenly fewer, first and last among them.
    shown = np.linspace(0, len(time) - 1, min(len(time), MOST_ROWS)).round().astype(int)
    columns = _Columns(table, np.unique(shown))
    drawn = [made for vessel in vessels if (made := _vessel(vessel, columns)) is not None]
    if not drawn:
        return None
    flows = _flows(table, columns, goes_on)
    # The page says how names were read, and which units were assumed.
    supposed = ["{} north, {} east, {} heading".format(*vessel.pose) for vessel in vessels]
    if columns.without_unit:
        without = ", ".join(dict.fromkeys(columns.without_unit))
        supposed.append(f"without a unit in the table: {without}")
    circles = []
    for vessel in vessels:
        circles += expected_circles(verdicts, vessel.pose, shift)
    return Run(
        label,
        packed_series(time[columns.rows], EXACT),
        columns.packed,
        drawn,
        flows,
        circles,
        _watch(table),
        supposed,
        predicted_tracks(table, shift),
        _references(columns),
        _buses(columns),
        columns.recipes if goes_on else {},
    )


def unwrap_degrees(values: NDArray) -> NDArray:
    """Angles without jumps at half turns. [deg]"""
    return np.degrees(unwrap_series(np.radians(values)))


def _packed(values: NDArray, resolution: float) -> float | JsonObject | list[float | None]:
    """Pack a column; a constant one becomes a single number."""
    if is_constant(values):
        return float(values[0])
    # Steps as fine as the resolution asks, or a share of the range.
    span = extent(values)
    return packed_series(values, max(LEVELS, span / resolution))


def _vessel(vessel: Vessel, columns: _Columns) -> JsonObject | None:
    """Data of a vessel for the display."""
    # Pose with the resolution of a screen.
    looks = zip(vessel.pose, POSE_UNITS, (METRES, METRES, DEGREES), strict=True)
    pose = [columns.add(*look) for look in looks]
    if None in pose:
        return None
    # Outlines along the way need the pose as numbers, where none of it is a gap of the series.
    north, east, heading = pose_of(columns.table, vessel.pose)
    shown = columns.rows
    drawable = shown[(np.abs([north, east, heading]).max(axis=0) < LARGEST)[shown]]
    if not len(drawable):
        return None
    # Without a known size: a symbol as large as the track suggests.
    size = vessel.size or symbol_size(north[drawable], east[drawable])
    where = drawable[
        outline_rows(north[drawable], east[drawable], unwrap_degrees(heading[drawable]), size[0])
    ]
    return {
        "name": vessel.name,
        "pose": pose,
        "velocity": [
            columns.add(name, unit)
            for name, unit in zip(vessel.velocity, ("m/s", "m/s", "deg/s"), strict=True)
        ],
        "aims": {
            word: made for word, names in vessel.aims.items() if (made := _aim(names, columns))
        },
        "size": list(size),
        "to_scale": vessel.size is not None,
        "outline": [np.round(side, 3).tolist() for side in hull_outline(*size)],
        "way": [np.round(values[where], 2).tolist() for values in (north, east, heading)],
        "units": [
            made for unit in vessel.units if (made := _unit(unit, columns, vessel.size is not None))
        ],
    }


def _aim(names: tuple[str, str, str | None], columns: _Columns) -> list[str | None] | None:
    north, east = (columns.add(name, "m", METRES) for name in names[:2])
    return (
        None
        if north is None or east is None
        else [north, east, columns.add(names[2], "deg", DEGREES)]
    )


def _unit(unit: DrawnThruster, columns: _Columns, to_scale: bool) -> JsonObject | None:
    """A thruster: bars need its thrust; vectors also its force, its place and a ship to scale."""
    thrust = columns.add(unit.thrust, "kN")
    if thrust is None:
        return None
    values = in_unit(columns.table, unit.thrust, "kN")
    return {
        "name": unit.name.rpartition(".")[2],
        "thrust": thrust,
        "command": columns.add(unit.thrust_command, "kN"),
        "azimuth": columns.add(unit.azimuth, "deg", 0.1),
        "azimuth_command": columns.add(unit.azimuth_command, "deg", 0.1),
        "rpm": columns.add(unit.rpm, "rpm"),
        "force": _force(unit, columns),
        "place": unit.place if to_scale else None,
        "limits": None if unit.limits is None else [limit / 1000.0 for limit in unit.limits],
        "sectors": [[round(degrees(angle), 3) for angle in sector] for sector in unit.sectors],
        "largest": float(np.nanmax(np.abs(values))) if values is not None else 0.0,
        **{
            flag: columns.add(getattr(unit, flag), "")
            for flag in ("saturated", "failed", "available")
        },
    }


def _force(unit: DrawnThruster, columns: _Columns) -> list[str] | None:
    """Columns of the force on the ship: as put out, else thrust along the azimuth."""
    # The force that the thruster puts out includes losses: prefer it.
    if unit.force is not None:
        put_out = [columns.add(name, "kN") for name in unit.force]
        if None not in put_out:
            return [str(name) for name in put_out]
    # Else the thrust along its direction.
    if unit.azimuth is None:
        return None
    angle = in_unit(columns.table, unit.azimuth, "rad")
    thrust = in_unit(columns.table, unit.thrust, "kN")
    if angle is None or thrust is None:
        return None
    recipe = Recipe(unit.thrust, *columns.conversion_of(unit.thrust, "kN"), unit.azimuth)
    return [
        columns.put(
            f"{unit.name} force forward",
            thrust * np.cos(angle),
            recipe._replace(trigonometric="cos"),
        ),
        columns.put(
            f"{unit.name} force starboard",
            thrust * np.sin(angle),
            recipe._replace(trigonometric="sin"),
        ),
    ]


def _flows(table: Dataset, columns: _Columns, goes_on: bool) -> list[JsonObject]:
    """Wind and current as velocity north and east, waves as height and direction, if logged."""
    roles = find_roles(table.data_vars)
    flows: list[JsonObject] = []
    # Flows that are zero all along are not shown.
    for what, (sense, sign) in FLOWS.items():
        parts = _velocity(columns, roles.anywhere, what, sense, sign)
        if parts and (goes_on or np.nanmax(np.hypot(*(v for v, _ in parts)), initial=0.0) > 0.0):
            names = [
                columns.put(f"{what} {way}", *part)
                for way, part in zip(("north", "east"), parts, strict=True)
            ]
            flows.append({"what": what, "sense": sense, "velocity": names})
    # Waves need height and direction.
    heights, sources = (
        _first_in(table, roles.anywhere(f"wave_{part}")) for part in ("height", "from")
    )
    height = columns.add(heights, "m")
    source = columns.add(sources, "deg")
    if height and source and (goes_on or np.nanmax(table[height].values) > 0.0):
        flows.append({"what": "waves", "sense": "from", "height": height, "direction": source})
    return flows


def _references(columns: _Columns) -> list[JsonObject]:
    """Position references, compasses and sensors, each with its signals for valid and rejected."""
    names = list(map(str, columns.table.data_vars))
    references = []
    for name in names:
        if (match := REFERENCE.fullmatch(name)) and columns.add(name, ""):
            label = match[1]
            # A sensor says that it works; the controller that votes says whom it rejects.
            rejected = next(
                (signal for signal in names if signal.endswith(f".{label}_rejected")), None
            )
            references.append(
                {
                    "label": label.replace("_", " "),
                    "valid": name,
                    "rejected": columns.add(rejected, ""),
                }
            )
    return references


def _buses(columns: _Columns) -> list[JsonObject]:
    """Buses with the power that their thrusters take, and the most that they have for them."""
    buses = []
    for name in map(str, columns.table.data_vars):
        if (match := BUS.fullmatch(name)) and columns.add(name, "W"):
            most = columns.add(f"{match[1]}{match[2]}_power", "W")
            buses.append({"label": match[2].replace("_", " "), "load": name, "most": most})
    return buses


def _velocity(
    columns: _Columns, anywhere: Any, what: str, sense: str, sign: float
) -> list[tuple[NDArray, Recipe]]:
    """Velocity north and east, and how it follows: by its components, else by speed and direction. [m/s]"""
    # Components are exact; read them first.
    table = columns.table
    parts = [_first_in(table, anywhere(f"{what}_{way}")) for way in ("north", "east")]
    read = [
        (values, Recipe(name, *columns.conversion_of(name, "m/s")))
        for name in parts
        if name is not None and (values := in_unit(table, name, "m/s")) is not None
    ]
    if len(read) == 2:
        return read
    # Else speed and direction; a direction "from" points against the velocity.
    speed, angle = (_first_in(table, anywhere(f"{what}_{part}")) for part in ("speed", sense))
    if speed is None or angle is None:
        return []
    size, direction = in_unit(table, speed, "m/s"), in_unit(table, angle, "rad")
    if size is None or direction is None:
        return []
    factor, _ = columns.conversion_of(speed, "m/s")
    recipe = Recipe(speed, sign * factor, 0.0, angle)
    return [
        (sign * size * np.cos(direction), recipe._replace(trigonometric="cos")),
        (sign * size * np.sin(direction), recipe._replace(trigonometric="sin")),
    ]


def _first_in(table: Dataset, names: Iterable[str]) -> str | None:
    return next((name for name in names if name in table and table[name].dtype.kind in "fiu"), None)


def expected_circles(
    verdicts: Sequence[Verdict], pose: Sequence[str], shift: float = 0.0
) -> list[JsonObject]:
    """Centre, radius, window and result of the expectations on a vessel's position. [m, m, s]"""
    circles = []
    for verdict in verdicts:
        expect = verdict.expect
        # Only fixed points: a moving target is no circle.
        centre = [value for value in expect.near or [] if isinstance(value, int | float)]
        if expect.signal == list(pose[:2]) and len(centre) == 2 and expect.within is not None:
            during = None if expect.during is None else [t + shift for t in expect.during]
            circle = {"centre": centre, "radius": expect.within, "during": during}
            circles.append(circle | {"passed": verdict.passed})
    return circles


def _watch(table: Dataset) -> dict[str, float]:
    """Limits of position and heading alarms, where the start values have them. [m, deg]"""
    starts: Mapping[str, Any] = start_values(table)
    limits = {}
    # Name of the limit follows from that of the alarm: position_alarm, position_limit.
    for what, factor in (("position", 1.0), ("heading", 180.0 / np.pi)):
        for alarm in find_roles(table.data_vars).anywhere(f"{what}_alarm"):
            limit = starts.get(alarm.removesuffix("alarm") + "limit")
            if isinstance(limit, int | float) and limit > 0.0:
                limits[what] = float(limit) * factor
    return limits
