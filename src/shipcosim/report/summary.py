"""What a run comes to, in words and figures: verdict, weather, key figures, where the thrusters were at their limit."""

import json
from dataclasses import dataclass

import numpy as np

from shipcosim.report.derived import ERRORS, FROM_REFERENCE

LAST = 60.0  # s at the end of a run in which a ship that cannot hold is recognised
AT_LIMIT = 0.5  # share of LAST in which a thruster must be at its limit
GROWTH = 1.5  # by which the error must have grown over LAST


@dataclass(frozen=True)
class Outcome:
    """The verdict on a run in one word and one sentence; `kind` is passed, failed, partial or plain."""

    kind: str
    word: str
    sentence: str


def is_complete(table):
    """False for a run that was interrupted. NetCDF has no booleans, a text or a number counts too."""
    return str(table.attrs.get("complete", True)).lower() not in ("false", "0")


def outcome(table, verdicts):
    """What the run comes to.

    Parameters
    ----------
    table : xarray.Dataset
        The run.
    verdicts : sequence of Verdict
        Its expectations.

    Returns
    -------
    Outcome
    """
    missed = sum(not v.passed for v in verdicts)
    if not is_complete(table):
        end = float(table["time"].values[-1]) if table.sizes["time"] else 0.0
        return Outcome("partial", "PARTIAL", f"The run ended early, at {end:g} s. Its expectations were not judged.")
    if not verdicts:
        return Outcome("plain", "DONE", "Nothing was expected of this run.")
    if missed:
        return Outcome("failed", "FAIL", f"{missed} of {len(verdicts)} expectations missed.")
    return Outcome("passed", "PASS", f"All {len(verdicts)} expectations hold.")


def judged(verdicts, shown):
    """Expectations and their verdicts in the units that people read.

    Parameters
    ----------
    verdicts : sequence of Verdict
        What was judged.
    shown : xarray.Dataset
        Table in the page's units.

    Returns
    -------
    list of (bool, str, str, str, str)
        Passed, what was expected, when, the worst value and its time.
    """
    return [_judged(verdict, shown[verdict.expect.signal[0]].attrs) for verdict in verdicts]


def _judged(verdict, shown_as):
    expect, unit, factor = verdict.expect, shown_as["units"], shown_as["factor"]
    during = "{:g}–{:g} s".format(*expect.during) if expect.during else "the whole run"
    worst, when = "no row", "–"
    if np.isfinite(verdict.time):
        worst, when = f"{factor * verdict.worst:.3g} {unit}".rstrip(), f"{verdict.time:g} s"
    return verdict.passed, _claim(expect, unit, factor), during, worst, when


def _claim(expect, unit, factor):
    """What is expected: 'vessel.psi: 0 ± 1 deg'."""
    text = lambda value: value if isinstance(value, str) else f"{round(factor * value, 4):.4g}"  # noqa: E731
    subject = f"{expect.statistic} of " * bool(expect.statistic) + ", ".join(expect.signal)
    if expect.near is not None:
        target = ",\u00a0".join(map(text, expect.near))
        target = f"({target})" if len(expect.near) > 1 else target
        return f"{subject}: {target}\u00a0±\u00a0{factor * expect.within:.3g}\u00a0{unit}".rstrip()
    limits = {"≥": expect.at_least, "≤": expect.at_most}
    return f"{subject} " + ", ".join(f"{sign} {text(v)} {unit}" for sign, v in limits.items() if v is not None).rstrip()


def remarks(table, shown, roles):
    """Sentences for what a reader must not overlook.

    Parameters
    ----------
    table : xarray.Dataset
        The run; its attribute `remarks` holds what the FMUs warned of.
    shown : xarray.Dataset
        Table in the page's units, with the derived signals.
    roles : Roles
        What the signals stand for.

    Returns
    -------
    list of str
    """
    said = [*_parsed(table.attrs.get("remarks", "[]")), *_not_finite(shown)]
    limited = _limited(shown, roles)
    if limited and _grows(shown):
        error = shown[FROM_REFERENCE].values
        said.append(
            f"She cannot hold here: {' and '.join(limited)} at the limit for most of the last {LAST:g} s, "
            f"while the position error grew to {error[-1]:.1f} m."
        )
    return said


_DERIVED = {*ERRORS.values(), FROM_REFERENCE, "distance from expected point"}


def _not_finite(shown):
    """The first signals that stop being numbers, and how many follow."""
    begin = {
        str(name): float(shown["time"].values[~np.isfinite(v.values)][0])
        for name, v in shown.data_vars.items()
        if str(name) not in _DERIVED and not np.isfinite(v.values).all()
    }
    names = sorted(begin, key=begin.get)
    others = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return [f"Not finite from {begin[names[0]]:g} s on: {', '.join(names[:3])}{others}."] if names else []


def _last(shown):
    time = shown["time"].values
    return time >= time[-1] - LAST if len(time) else np.zeros(0, bool)


def _limited(shown, roles):
    """Thrusters that were at their limit for most of the end."""
    rows = _last(shown)
    names = [(unit, roles.signal(unit, "saturated")) for unit in roles.thrusters]
    return [unit for unit, name in names if name in shown and np.mean(shown[name].values[rows]) > AT_LIMIT]


def _grows(shown):
    if FROM_REFERENCE not in shown:
        return False
    error = shown[FROM_REFERENCE].values[_last(shown)]
    return len(error) > 1 and error[-1] > GROWTH * max(error[0], 1.0)


def key_figures(shown, roles):
    """Figures that people compare runs by, as (name, text).

    Parameters
    ----------
    shown : xarray.Dataset
        Table in the page's units, with the derived signals.
    roles : Roles
        What the signals stand for.

    Returns
    -------
    list of (str, str)
    """
    figures = []
    for name, title in {FROM_REFERENCE: "Position error", ERRORS["psi"]: "Heading error"}.items():
        if name in shown:
            size, unit = np.abs(shown[name].values), shown[name].attrs["units"]
            rms, largest = np.sqrt(np.nanmean(size**2)), np.nanmax(size)
            figures.append((title, f"{rms:.2f} {unit} rms, {largest:.2f} {unit} at most"))
    powers = [p for p in (roles.signal(unit, "power") for unit in roles.thrusters) if p in shown]
    if powers:
        total, unit = np.sum([shown[p].values for p in powers], axis=0), shown[powers[0]].attrs["units"]
        figures.append(("Shaft power", f"{np.nanmean(total):.4g} {unit} mean, {np.nanmax(total):.4g} {unit} at most"))
    for unit in roles.thrusters:
        name = roles.signal(unit, "saturated")
        if name in shown:
            figures.append((f"At a limit, {unit}", f"{100 * np.mean(shown[name].values):.0f} % of the time"))
    return figures


def weather(shown, roles):
    """Wind, current and waves of the run: (what, mean size, unit, direction in deg, 'from' or 'to')."""
    found = []
    for what, sense in [("wind", "from"), ("current", "to")]:
        if f"{what} speed" in shown:
            means = [roles.signal(roles.environment, f"{what}_{part}_mean") for part in ("speed", sense)]
            size, angle = means if None not in means else (f"{what} speed", f"{what} {sense}")
            found.append((what, _span(shown[size].values), "m/s", _mean_direction(shown[angle].values), sense))
    height, source = (roles.signal(roles.environment, f"wave_{part}") for part in ("height", "from"))
    if height in shown and source in shown and np.nanmax(shown[height].values) > 0.0:
        found.append(("waves", _span(shown[height].values), "m", _mean_direction(shown[source].values), "from"))
    return found


def _span(values):
    """A value, or from least to largest where it changes."""
    least, largest = (f"{pick(values):.2g}" for pick in (np.nanmin, np.nanmax))
    return least if least == largest else f"{least}–{largest}"


def _mean_direction(degrees):
    angle = np.radians(degrees)
    return float(np.degrees(np.arctan2(np.nanmean(np.sin(angle)), np.nanmean(np.cos(angle)))) % 360.0)


SHOWN_ELSEWHERE = ("events", "remarks")


def details(table, system=None):
    """Start values, versions and whatever else the table says of itself.

    Parameters
    ----------
    table : xarray.Dataset
        The run.
    system : System, optional
        Gives the units of start values.

    Returns
    -------
    list of (str, dict)
        Titles and contents of tables to unfold.
    """
    plain, nested = {}, []
    for name, value in table.attrs.items():
        content = _parsed(value)
        if name == "start_values":
            nested += _by_component(content, system)
        elif isinstance(content, dict):
            nested.append((name, content))
        elif name not in SHOWN_ELSEWHERE:
            plain[name] = content
    return ([("run", plain)] if plain else []) + nested


def _by_component(values, system):
    """Start values with their units, a table for each component."""
    groups = {}
    for signal, value in values.items():
        component, _, name = signal.rpartition(".")
        unit = _unit(system, component, name) or ""
        groups.setdefault(component, {})[name] = value if unit in ("", "1") else f"{value} {unit}"
    return [(f"Start values: {component or 'the system'}", content) for component, content in groups.items()]


def _unit(system, component, name):
    if system is None:
        return None
    variables = system.components[component].fmu.variables if component in system.components else system.inputs
    return variables[name].unit if name in variables else None


def _parsed(value):
    """Attributes of NetCDF are flat: a dictionary travels as JSON text."""
    if isinstance(value, str) and value[:1] in "{[":
        try:
            return json.loads(value)
        except ValueError:
            return value
    return value
