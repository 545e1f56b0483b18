"""Figures and tables of which cause: evidence, estimates, whiteness, and what this log could not have shown."""

from collections.abc import Mapping, Sequence

import numpy as np

from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.hypotheses.cause import Cause, placeholders
from shipcosim.diagnose.inference.fitting import IdentificationProblem
from shipcosim.diagnose.inference.innovations import innovations
from shipcosim.diagnose.inference.noise import explained
from shipcosim.diagnose.inference.search import without_causes
from shipcosim.diagnose.inference.thresholds import ENOUGH, UNMODELLED
from shipcosim.report.diagnosis.data import TIME, line, panel, rounded
from shipcosim.report.diagnosis.numbers import plain, span
from shipcosim.report.diagnosis.words import title

CHANNELS = ("north", "east", "heading", "surge", "sway", "yaw rate")
COLOURS = ("blue", "sky", "purple", "green", "olive", "orange")
MOST_SETS, LAGS = 12, 30
STRANGE_KINDS = {
    "slow": "a slow force in the ship's frame",
    "with the heading": "a force that goes with the heading",
    "from part to part": "the best cause's size, from part to part of the log",
    "beyond tolerances": "the ship's numbers, farther off than their tolerances say",
    "periodic": "a periodic force",
    "in a channel": "an error of a channel",
}


def label_of(fit):
    """A set of causes as people write it."""
    return "<br>+ ".join(title(s.cause, s.component) for s in fit.hypotheses) or "Nothing"


def evidence_panel(fits, chosen):
    """How much likelier the log is with each set of causes than with none.

    Parameters
    ----------
    fits : list of Fit
        Best first.
    chosen : Fit
        That the verdict rests on.
    """
    nothing = without_causes(fits).score
    sets = [fit for fit in fits if fit.hypotheses][:MOST_SETS][::-1]
    gains = [max(fit.score - nothing, 0.0) for fit in sets]
    bars = {
        **{"type": "bar", "orientation": "h", "y": [label_of(fit) for fit in sets], "x": rounded(gains, 4)},
        "marker": {"color": ["@blue" if fit is chosen else "@faint" for fit in sets]},
        **{"hovertemplate": "%{y}: %{x:.1f} nats<extra></extra>", "showlegend": False},
        **{"text": [f"{fit.score - nothing:.1f}" for fit in sets], "textposition": "auto"},
    }
    enough = {"type": "line", "x0": ENOUGH, "x1": ENOUGH, "y0": 0, "y1": 1, "yref": "paper"}
    shape = {**enough, "line": {"color": "@vermillion", "dash": "dot", "width": 1.5}}
    note = (
        f"Log-evidence over the ship without a cause, in nats: {ENOUGH:g} more (dotted) mean {np.exp(ENOUGH):.0f} "
        "times likelier. More causes have to pay for themselves. Blue is the set that the verdict rests on."
    )
    height = 90 + (12 + 16 * max([1, *(len(fit.hypotheses) for fit in sets)])) * max(len(sets), 2)
    axes = {"xaxis": {"title": {"text": "nats"}, "rangemode": "tozero"}, "yaxis": {"automargin": True}}
    return panel("Evidence of the best sets of causes", "nats", [bars], note, shapes=[shape], height=height, **axes)


def estimate_panel(fit):
    """Estimates of a set's parameters, in units of the size that matters, with two standard deviations."""
    parameters = [(s, k) for s in fit.hypotheses for k in s.parameters][::-1]
    names = [f"{title(s.cause, s.component)}:<br>{k.name.replace('_', ' ')}" for s, k in parameters]
    size = [(fit.values[k.paths[0]] - k.neutral) / k.typical for _, k in parameters]
    wide = [2.0 * fit.std[k.paths[0]] / k.typical for _, k in parameters]
    marks = {
        **{"type": "scatter", "mode": "markers", "x": rounded(size, 4), "y": names, "showlegend": False},
        "error_x": {"type": "data", "array": rounded(wide, 3), "color": "@blue", "thickness": 2},
        **{"marker": {"color": "@blue", "size": 9}, "hovertemplate": "%{x:.2f} typical sizes<extra></extra>"},
    }
    axes = {
        "xaxis": {"title": {"text": "typical sizes"}, "zeroline": True, "rangemode": "tozero"},
        "yaxis": {"range": [-0.6, len(parameters) - 0.4]},
    }
    note = "From what the model has, at 0; 1 is a size that matters. Bars are two standard deviations."
    return panel("How large, and how sure", "", [marks], note, height=110 + 40 * len(parameters), **axes)


def strange_panel(unmodelled):
    """What errors without a name would gain beside the chosen causes."""
    names = [STRANGE_KINDS.get(kind, kind) for kind in unmodelled]
    bars = {
        **{
            "type": "bar",
            "orientation": "h",
            "y": names,
            "x": rounded([max(gain, 0.0) for gain in unmodelled.values()], 4),
        },
        "marker": {"color": ["@vermillion" if gain > UNMODELLED else "@faint" for gain in unmodelled.values()]},
        **{"showlegend": False, "hovertemplate": "%{x:.1f} nats<extra></extra>"},
        **{"text": ["none" if g <= 0.0 else f"{g:.1f}" for g in unmodelled.values()], "textposition": "outside"},
    }
    limit = {"type": "line", "x0": UNMODELLED, "x1": UNMODELLED, "y0": 0, "y1": 1, "yref": "paper"}
    shape = {**limit, "line": {"color": "@vermillion", "dash": "dot", "width": 1.5}}
    axes = {"xaxis": {"title": {"text": "nats"}, "range": [0.0, 1.15 * max(UNMODELLED, *unmodelled.values())]}}
    note = "Beyond the dotted line something acts that no known cause explains: the verdict is then unknown."
    height = 90 + 34 * len(names)
    return panel(
        "Errors without a name", "nats", [bars], note, shapes=[shape], height=height, yaxis={"automargin": True}, **axes
    )


def whiteness(problem, fit, as_it_is=False):
    """Autocorrelation of the whitened innovations that a fit leaves.

    Parameters
    ----------
    problem : IdentificationProblem
    fit : Fit
    as_it_is : bool
        Without moving known numbers within their tolerances.

    Returns
    -------
    (LAGS, 6) array
        From a lag of one row on; NaN for a channel that was not measured.
    """
    theta = 0.0 * fit.left if as_it_is else fit.left
    white = innovations(explained(fit.linear, theta), problem.noise, problem.record).white[..., 0]
    white = np.where(fit.linear.whole, white, np.nan)
    found = np.full((LAGS, white.shape[1]), np.nan)
    for channel, values in enumerate(white.T):
        if np.isfinite(values).sum() > 10 * LAGS:
            values = values - np.nanmean(values)
            power = np.nanmean(values**2)
            found[:, channel] = [np.nanmean(values[k:] * values[:-k]) / power for k in range(1, LAGS + 1)]
    return found


def whiteness_panel(heading, correlation, step, rows, between):
    """Autocorrelation of all channels over the lag, with the band of white noise."""
    lag = step * np.arange(1, LAGS + 1)
    traces = [
        line(name, lag, correlation[:, i], COLOURS[i], mode="lines+markers", marker={"size": 4})
        for i, name in enumerate(CHANNELS)
        if np.isfinite(correlation[:, i]).any()
    ]
    band = {"type": "rect", "x0": 0, "x1": 1, "xref": "paper", "y0": -2 / np.sqrt(rows), "y1": 2 / np.sqrt(rows)}
    shape = {**band, "layer": "below", "fillcolor": "@band", "line": {"width": 0}}
    axes = {"xaxis": TIME, "yaxis": {"range": between}}
    note = "Autocorrelation of the whitened innovations; inside the band they are as white as noise."
    return panel(f"White? {heading}", "", traces, note, shapes=[shape], **axes)


def manoeuvre_rows(manoeuvre):
    """What to sail: from when to when, and what the ship or a thruster does, in order of time.

    Parameters
    ----------
    manoeuvre : Manoeuvre
        Of the diagnosis' library.

    Returns
    -------
    list of (str, str)
    """
    found, start, before = [], 0.0, (0.0, 0.0, 0.0)
    for duration, *there in manoeuvre.legs:
        if not any(a <= start and start + duration <= b for a, b in manoeuvre.free):
            found.append((start, start + duration, _leg(tuple(there), before)))
        start, before = start + duration, tuple(there)
    for push in manoeuvre.pushes:
        angles = [round(float(np.degrees(angle))) for angle in push.azimuth]
        towards = f", turned from {angles[0]} to {angles[1]}° off the bow" if angles[0] != angles[1] else ""
        force = f"{'−' * (push.force < 0.0)}{plain(abs(push.force) / 1e3, 2)} kN"
        doing = f"{push.thruster} pushes with {force} along its axis"
        found.append((push.start, push.end, doing + towards))
    found += [(a, min(b, start), "DP off, thrusters idle, the ship drifts") for a, b in manoeuvre.free]
    return [(span(a, b), doing) for a, b, doing in sorted(found, key=lambda entry: entry[:2])]


def _leg(there, before):
    """A leg in words: where the ship goes, seen from where and how she lay at the start."""
    if there == before:
        return "hold position and heading"
    ahead, across, turned = there
    words = [f"{abs(ahead):.0f} m {'ahead' if ahead > 0.0 else 'astern'}"] if ahead else []
    words += [f"{abs(across):.0f} m to {'starboard' if across > 0.0 else 'port'}"] if across else []
    moved = there[:2] != before[:2]
    text = f"move to {' and '.join(words) or 'the start'}" if moved else ""
    if turned != before[2]:
        text += f"{', ' if text else ''}turn to {np.degrees(turned):.0f}° clockwise of the first heading"
    return text


def not_testable_rows(
    problem: IdentificationProblem, names: Sequence[str], causes: Mapping[str, Cause] | None = None
) -> list[tuple[str, str, str]]:
    """Why this log could not have shown some causes: the cause, and what the log has of what would show it."""
    facts, known, rows = log_facts(problem), read_catalogue() if causes is None else causes, []
    for name in names:
        cause = known.get(name)
        reason = f"{_reason(cause, facts)}an effect of typical size would not have stood out"
        rows.append((title(name), cause.sentence if cause else "", reason))
    return rows


def _reason(cause: Cause | None, facts: Mapping[str, str | None]) -> str:
    """What the log lacks to show a cause, and a semicolon; nothing where its file does not say."""
    if cause is None or not cause.why_not_testable:
        return ""
    missing = [name for name in placeholders(cause.why_not_testable) if facts[name] is None]
    if missing:
        return f"there is no {missing[0].partition('_')[0]} in the log; "
    return cause.why_not_testable.format_map(facts) + "; "


def log_facts(problem: IdentificationProblem) -> dict[str, str | None]:
    """What a cause's file can say of a log, see `FACTS`; None for what the log does not have."""
    record, motion = problem.record, problem.motion
    return {
        "astern_share": f"{_reverse(problem):.0f} %",
        "speed": f"{_rms(np.hypot(motion.u, motion.v))} m/s",
        "surge": f"{_rms(motion.u)} m/s",
        "surge_acceleration": f"{_rms(np.gradient(motion.u, record.step))} m/s²",
        "sway": f"{_rms(motion.v)} m/s",
        "wind_speed": None if record.wind is None else f"{plain(float(np.mean(record.wind[0])), 2)} m/s",
        "yaw_rate": f"{_rms(np.degrees(motion.r))} °/s",
    }


def _rms(values):
    return plain(float(np.sqrt(np.nanmean(np.asarray(values) ** 2))), 2)


def _reverse(problem):
    shares = [np.mean(problem.record.units[name][0] < 0.0) for name in problem.model.azimuths]
    return 100.0 * max(shares, default=0.0)
