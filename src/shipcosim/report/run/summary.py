"""What a run comes to, in words and figures: verdict, weather, key figures, where the thrusters were at their limit."""

import json
from dataclasses import dataclass

import numpy as np

from shipcosim.report.run.derived import ERRORS, FROM_EXPECTED, FROM_REFERENCE

STRETCH = 60.0  # s over which a ship that cannot hold is recognised
AT_LIMIT = 0.5  # share of the stretch in which something must be at its limit
GROWTH = 2.0  # m by which the position error must grow over the stretch


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
    all_of_them = f"All {len(verdicts)} expectations hold." if len(verdicts) > 1 else "The expectation holds."
    return Outcome("passed", "PASS", all_of_them)


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
    return said + _failures(shown, roles) + _lost_hold(shown, roles)


_DERIVED = {*ERRORS.values(), FROM_REFERENCE, FROM_EXPECTED}


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


def _failures(shown, roles):
    """What failed during the run, and when."""
    begin = {}
    for component, signal in roles.flagged("failed").items():
        if signal in shown and (failed := shown[signal].values > 0.5).any():
            begin.setdefault(shown["time"].values[np.argmax(failed)], []).append(component)
    return [f"Failed from {time:g} s on: {', '.join(components)}." for time, components in begin.items()]


def _lost_hold(shown, roles):
    """Where the thrust is at its limit and the error grows all the same: the ship cannot hold there."""
    limits = {c: shown[s].values > 0.5 for c, s in roles.flagged("saturated").items() if s in shown}
    time = shown["time"].values
    starts = np.flatnonzero(time <= time[-1] - STRETCH)
    if not limits or FROM_REFERENCE not in shown or not len(starts):
        return []
    ends = np.searchsorted(time, time[starts] + STRETCH, side="right") - 1
    error = shown[FROM_REFERENCE].values
    shares = {c: _share(flags, starts, ends) for c, flags in limits.items()}
    lost = (error[ends] - error[starts] > GROWTH) & (np.max(list(shares.values()), axis=0) > AT_LIMIT)
    if not lost.any():
        return []
    k = int(np.argmax(lost))
    limited = [component for component, share in shares.items() if share[k] > AT_LIMIT]
    drift = "She cannot hold" if error[-1] > GROWTH else "She is driven off for a while"
    begin = starts[k] + np.argmax(limits[limited[0]][starts[k] :])
    return [
        f"{drift}: from {time[begin]:g} s on the thrust is at its limit ({', '.join(limited)}) while the "
        f"position error grows to {error[ends[k]]:.1f} m within a minute, and to {np.nanmax(error):.1f} m at most."
    ]


def _share(flags, starts, ends):
    """Share of set flags from each start up to its end."""
    count = np.concatenate([[0.0], np.cumsum(flags)])
    return (count[ends + 1] - count[starts]) / (ends + 1 - starts)


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
    for component, name in roles.flagged("saturated").items():
        if name in shown:
            figures.append((f"At a limit, {component}", f"{100 * np.mean(shown[name].values):.0f} % of the time"))
    return figures


def weather(shown, roles):
    """Wind, current and waves of the run: (what, mean size, unit, direction in deg, 'from' or 'to')."""
    found = []
    for what, sense in [("wind", "from"), ("current", "to")]:
        if f"{what} speed" in shown:
            means = [roles.signal(roles.environment, f"{what}_{part}_mean") for part in ("speed", sense)]
            size, angle = means if None not in means else (f"{what} speed", f"{what} {sense}")
            if np.nanmax(shown[size].values) > 0.0:
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
