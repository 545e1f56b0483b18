"""Time series of the page, in sections of panels; missing signals are left out."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from numpy.typing import NDArray
from xarray import Dataset

from shipcosim.report.run.bands import Band, bands_of, distance_bands
from shipcosim.report.run.derived import ERRORS, FROM_EXPECTED, FROM_REFERENCE, desired
from shipcosim.report.run.roles import Roles
from shipcosim.report.run.vessels import find_units, start_values
from shipcosim.report.run.zones import Zone, angle_zones, thrust_zones
from shipcosim.report.theme import palette
from shipcosim.report.theme.display import is_constant
from shipcosim.scenario import Verdict

AXES = {"x": "North", "y": "East", "psi": "Heading"}
LOADS = {"X": "Surge force", "Y": "Sway force", "N": "Yaw moment"}


@dataclass(frozen=True)
class Line:
    """One curve: a signal of the shown table (None: not there) and how it looks."""

    signal: str | None
    label: str
    colour: str
    dash: str = "solid"
    width: float = 1.5


@dataclass(frozen=True)
class Panel:
    """Curves over time on one axis, with the limits they should keep; `states` draws logical signals as bars.

    `zones` are values that cannot or must not be: from and to, in the panel's unit.
    """

    title: str
    unit: str
    lines: Sequence[Line]
    bands: Sequence[Band] = ()
    states: bool = False
    zones: Sequence[Zone] = ()

    @property
    def signals(self) -> list[str | None]:
        """Signals of its curves."""
        return [line.signal for line in self.lines]


@dataclass(frozen=True)
class Section:
    """Panels under one heading, and sentences for signals that stay constant."""

    title: str
    panels: Sequence[Panel]
    constant: Sequence[str] = ()


def make_sections(shown: Dataset, roles: Roles, verdicts: Sequence[Verdict]) -> Sequence[Section]:
    """Every section that the table has signals for.

    Parameters
    ----------
    shown : xarray.Dataset
        The table in the page's units, with the derived signals.
    roles : Roles
        What the signals stand for.
    verdicts : sequence of Verdict
        Expectations to draw.

    Returns
    -------
    sequence of Section
    """
    motion = _motion(shown, roles, verdicts)
    # A panel for every signal with an expectation that no other panel shows with its limits.
    drawn = {line.signal for panel in motion for line in panel.lines}
    expected = []
    for signal in dict.fromkeys(name for verdict in verdicts for name in verdict.expect.signal):
        if signal in shown and signal not in drawn:
            line = Line(signal, signal, palette.SHIP)
            expected += _panel(shown, signal, [line], bands_of(shown, signal, verdicts))
    made = {
        "Reference and error": motion,
        "Other expectations": expected,
        "Forces on the ship": _loads(shown, roles),
        "Thrusters": _thrusters(shown, roles),
        "Allocation": _allocation(shown, roles),
        "Environment": _environment(shown, roles),
    }
    return [Section(title, panels) for title, panels in made.items() if panels]


def constants_as_words(sections: Sequence[Section], shown: Dataset) -> Sequence[Section]:
    """Sections in which panels without limits and without change have become words.

    Parameters
    ----------
    sections : sequence of Section
        With all panels.
    shown : xarray.Dataset
        Table in the page's units, which holds the signals of the panels.

    Returns
    -------
    sequence of Section
        In their order.
    """
    return [_section(section, shown) for section in sections]


def _section(section: Section, shown: Dataset) -> Section:
    drawn = []
    constant = []
    for panel in section.panels:
        values = {line.label: shown[line.signal].values for line in panel.lines}
        if panel.bands or not all(is_constant(value) for value in values.values()):
            drawn.append(panel)
        elif panel.states:
            flags = [name for name, flags in values.items() if flags[0]]
            constant.append(f"{panel.title}: {', '.join(flags) or 'none'}")
        else:
            constant.append(f"{panel.title} {_levels(values, panel.unit)}")
    return Section(section.title, drawn, constant)


def _levels(values: Mapping[str, NDArray], unit: str) -> str:
    """Constant values with their unit: '0.3 m/s', or '0 kN commanded, 2 kN delivered'."""
    levels = {name: f"{series[0]:.4g} {unit}".rstrip() for name, series in values.items()}
    # Equal values need no names.
    if len(set(levels.values())) == 1:
        return next(iter(levels.values()))
    return ", ".join(f"{level} {name}" for name, level in levels.items())


def _panel(
    shown: Dataset,
    title: str,
    lines: Iterable[Line],
    bands: Sequence[Band] = (),
    states: bool = False,
) -> list[Panel]:
    """List with the panel of the available lines; empty if there are none."""
    there = [line for line in lines if line.signal in shown]
    if not there:
        return []
    return [Panel(title, shown[there[0].signal].attrs["units"], there, bands, states)]


def _commanded(
    shown: Dataset, title: str, command: str | None, delivered: str | None
) -> list[Panel]:
    """List with the panel of a command and its answer."""
    lines = [
        Line(command, "commanded", palette.COMMAND, "dot"),
        Line(delivered, "delivered", palette.SHIP),
    ]
    return _panel(shown, title, lines)


def _coloured(labels: Mapping[str | None, str]) -> list[Line]:
    """Lines of equal rank, each in its colour; `labels` maps signals to labels."""
    return [Line(s, label, palette.in_turn(k)) for k, (s, label) in enumerate(labels.items())]


def _first(names: Iterable[str]) -> str | None:
    return next(iter(names), None)


def _motion(shown: Dataset, roles: Roles, verdicts: Sequence[Verdict]) -> list[Panel]:
    """North, east and heading with their errors; distance and speeds."""
    panels = []
    for axis, title in AXES.items():
        if ship := roles.signal(roles.ship, axis):
            # Measured value, set point, reference and ship; the ship on top.
            measured = _first(roles.anywhere(f"{axis}_meas", f"{axis}_1_meas"))
            reference = roles.signal(roles.reference, f"{axis}_d")
            lines = [
                Line(measured, "measured", palette.MEASURED, width=1.0),
                Line(_first(roles.anywhere(f"{axis}_set")), "set point", palette.SET_POINT, "dot"),
                Line(reference, "reference", palette.REFERENCE, "dash"),
                Line(ship, "ship", palette.SHIP, width=2.0),
            ]
            panels += _panel(shown, title, lines, bands_of(shown, ship, verdicts))
            # The error has a panel of its own: it is small against the value.
            error = [Line(ERRORS[axis], "ship − reference", palette.SHIP)]
            limits = (
                bands_of(shown, ship, verdicts, minus=desired(roles, axis))
                if ERRORS[axis] in shown
                else ()
            )
            panels += _panel(shown, f"{title} error", error, limits)
    lines = [
        Line(FROM_REFERENCE, "from the reference", palette.SHIP),
        Line(FROM_EXPECTED, "from the expected point", palette.EXPECTED, width=2.0),
    ]
    position = [roles.signal(roles.ship, axis) for axis in "xy"]
    panels += _panel(shown, "Position error", lines, distance_bands(shown, position, verdicts))
    ahead, sideways, turn = (roles.signal(roles.ship, connector) for connector in "uvr")
    speeds = _coloured({ahead: "ahead", sideways: "to starboard"})
    panels += _panel(shown, "Speed over ground", speeds)
    return panels + _panel(shown, "Rate of turn", _coloured({turn: "to starboard"}))


def _loads(shown: Dataset, roles: Roles) -> list[Panel]:
    """Forces and moment by source, and the command of the controller."""
    panels = []
    for axis, title in LOADS.items():
        lines = []
        for k, source in enumerate(roles.sources()):
            signal = roles.signal(roles.ship, f"tau_{source}_{axis}")
            lines.append(Line(signal, source, palette.source(source, k)))
        command = _first(roles.anywhere(f"tau_{axis}_cmd"))
        lines.append(Line(command, "commanded", palette.COMMAND, "dot", 1.0))
        panels += _panel(shown, title, lines)
    return panels


def _thrusters(shown: Dataset, roles: Roles) -> list[Panel]:
    """Thrust commanded and delivered per thruster; angles, speeds, power and limits of all."""
    panels = []
    # Thrust of each thruster, with the zones beyond its limits.
    units = find_units(shown.data_vars, start_values(shown))
    for unit in units:
        thrust = _commanded(shown, f"Thrust, {unit.name}", unit.thrust_command, unit.thrust)
        panels += [replace(p, zones=thrust_zones(shown, p.signals, unit.limits)) for p in thrust]
    # Angle of each thruster that turns or is commanded to, with the sectors that it is not given.
    for unit in units:
        angle = _commanded(shown, f"Azimuth, {unit.name}", unit.azimuth_command, unit.azimuth)
        panels += [replace(p, zones=angle_zones(shown, p.signals, unit.sectors)) for p in angle]
    # Shaft speeds of azimuths and other thrusters differ in size: a panel for each group.
    turning = [unit for unit in roles.thrusters if roles.signal(unit, "azimuth")]
    for units in (turning, [unit for unit in roles.thrusters if unit not in turning]):
        lines = _coloured({roles.signal(unit, "rpm"): unit for unit in units})
        panels += _panel(shown, f"Shaft speed, {', '.join(units)}", lines)
    # Power and torque of all thrusters in one panel each.
    for quantity, title in {"power": "Power", "torque": "Torque"}.items():
        panels += _panel(
            shown, title, _coloured({roles.signal(u, quantity): u for u in roles.thrusters})
        )
    # Logical signals as bars: at a limit, or failed.
    states: dict[str | None, str] = {
        signal: f"{c} {what}"
        for what in ("saturated", "failed")
        for c, signal in roles.flagged(what).items()
    }
    return panels + _panel(shown, "At a limit, failed", _coloured(states), states=True)


def _allocation(shown: Dataset, roles: Roles) -> list[Panel]:
    """Load that the allocator misses, its power, and its computing time."""
    # Slack forces in one panel; the moment has another unit.
    slack = {axis: roles.anywhere(f"slack_{axis}") for axis in LOADS}
    forces = _coloured(
        {_first(slack[axis]): title for axis, title in (("X", "forward"), ("Y", "to starboard"))}
    )
    panels = _panel(shown, "Force missed by the allocator", forces)
    panels += _panel(
        shown, "Yaw moment missed by the allocator", _coloured({_first(slack["N"]): "clockwise"})
    )
    power = {_first(roles.anywhere("thruster_power")): "all thrusters"}
    panels += _panel(shown, "Power of the thrusters, estimated by the allocator", _coloured(power))
    # Only allocators that measure their time.
    times = [
        name for name in roles.anywhere("solve_time") if name in shown and shown[name].values.any()
    ]
    return panels + _panel(
        shown, "Time of an allocation", _coloured(dict.fromkeys(times, "by the clock"))
    )


def _environment(shown: Dataset, roles: Roles) -> list[Panel]:
    """Wind, current and waves as speed and direction."""
    panels = []
    # Wind at the ship, with the mean at sea for comparison.
    label = "mean at sea" if roles.harbour else "mean"
    for part in ("speed", "from"):
        mean = roles.signal(roles.environment, f"wind_{part}_mean")
        gusts = Line(f"wind {part}", "with gusts", palette.SKY)
        panels += _panel(shown, f"Wind {part}", [gusts, Line(mean, label, palette.INK, "dash")])
    for part in ("speed", "to"):
        line = Line(f"current {part}", "current", palette.BLUE)
        panels += _panel(shown, f"Current {part}", [line])
    waves = {roles.signal(roles.environment, "elevation"): "surface"}
    return panels + _panel(shown, "Waves", _coloured(waves))
