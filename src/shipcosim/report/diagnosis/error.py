"""Figures of what the simulation gets wrong: errors of predictions, and the force that the model lacks."""

import numpy as np

from shipcosim.diagnose.validation.gain import gain, parts
from shipcosim.report.diagnosis.data import TIME, line, panel, rounded
from shipcosim.report.diagnosis.numbers import plain

MODELS = {
    "plain": ("plain model", "vermillion"),
    "bias_observer": ("plain model with bias observer", "orange"),
    "extended": ("with the cause", "blue"),
    "extended_observer": ("with the cause and a bias observer", "green"),
    "floor": ("noise floor", "faint"),
}
CHANNELS = {
    "position": ("Position", "m"),
    "heading": ("Heading", "°"),
    "surge": ("Surge", "m/s"),
    "sway": ("Sway", "m/s"),
    "yaw_rate": ("Rate of turn", "°/s"),
}
FORCES = (
    ("Missing force, body frame", (("surge", "forward", "blue"), ("sway", "to starboard", "orange"))),
    ("Missing moment", (("yaw", "clockwise", "purple"),)),
    ("Missing force, earth frame", (("north", "towards north", "blue"), ("east", "towards east", "orange"))),
)
BINS = 24
BLOCKS = 3  # of 120 s, for an interval of a part of the predictions
HELD = {"other headings": "headings not fitted on", "free drift": "free drift, not fitted on"}


def rms(values):
    """Root mean square of the finite values; NaN without any."""
    values = np.asarray(values, float)
    values = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(values**2))) if values.size else float("nan")


def error_panels(errors, models):
    """Errors over the horizon, a panel for position and heading each.

    Parameters
    ----------
    errors : xarray.Dataset
        Of a `Comparison`: channels by ``model``, ``horizon`` and ``segment``.
    models : sequence of str

    Returns
    -------
    list of dict
    """
    panels = []
    for channel in ("position", "heading"):
        title, unit = CHANNELS[channel]
        found = [
            {
                **{"type": "bar", "name": MODELS[model][0], "x": [f"{h:.0f} s" for h in errors["horizon"].values]},
                "y": rounded([rms(errors[channel].sel(model=model, horizon=h)) for h in errors["horizon"].values], 3),
                "marker": {"color": f"@{MODELS[model][1]}"},
                "hovertemplate": f"%{{y:.3~g}} {unit}",
            }
            for model in models
        ]
        axes = {"xaxis": {"type": "category"}, "yaxis": {"rangemode": "tozero"}}
        panels.append(panel(f"{title} error after 10, 30, 60 s", unit, found, barmode="group", **axes))
    return panels


def error_table(errors, models=("plain", "floor")):
    """Root mean square errors after the longest horizon, by what the ship did and channel.

    Returns
    -------
    tuple of list of str and list of list of str
        Head and rows; each cell shows the models' errors, the last as the floor.
    """
    head = ["", "Segments", *(f"{title} [{unit}]" for title, unit in CHANNELS.values())]
    regimes, last = errors["regime"].values, errors.isel(horizon=-1)
    groups = [("all", np.arange(regimes.size))]
    groups += [(str(name), np.flatnonzero(regimes == name)) for name in np.unique(regimes)]
    rows = []
    for name, which in groups:
        cells = [
            " / ".join(plain(rms(last[channel].sel(model=model).isel(segment=which)), 2) for model in models)
            for channel in CHANNELS
        ]
        rows.append([name, str(which.size), *cells])
    return head, rows


def condition_table(errors, unseen):
    """Position errors after the longest horizon with each model, by condition, and the share that the causes remove.

    Parameters
    ----------
    errors : xarray.Dataset
        On the rows that were held out in time.
    unseen : dict of str to xarray.Dataset
        By condition that nothing was fitted on.

    Returns
    -------
    tuple of list of str and list of list of str
        Head and rows.
    """
    head = ["Held out", "Predictions", *(f"{name} [m]" for name, _ in MODELS.values()), "explainable error removed"]
    groups = {"the later part": errors} | {f"of it {name}": part for name, part in parts(errors).items()}
    groups |= {HELD[name]: part for name, part in unseen.items()}
    rows = []
    for name, part in groups.items():
        last = part["position"].isel(horizon=-1)
        cells = [plain(rms(last.sel(model=model)), 2) for model in MODELS]
        rows.append([name, str(part.sizes["segment"]), *cells, removed(gain(part, fewest=BLOCKS))])
    return head, rows


def removed(entry):
    """Share of the explainable error that causes remove, with its interval, of an entry of `gain`."""
    if entry["share_of_explainable"] is None:
        return "nothing to remove"
    sure = " ({:.0f} to {:.0f} %)".format(*(100 * end for end in entry["ci95"])) if entry["ci95"] else ""
    return f"{100 * entry['share_of_explainable']:.0f} %{sure}"


def force_panels(force, left, thrusters):
    """The missing force over time, against heading, and against the direction of the wind.

    Parameters
    ----------
    force : xarray.Dataset
        What the plain model lacks, of `missing_force`.
    left : xarray.Dataset or None
        What the causes leave of it.
    thrusters : sequence of str

    Returns
    -------
    list of dict
    """
    groups = list(FORCES)
    for name in thrusters:
        pair = ((f"{name}_along", "along its positive thrust", "blue"), (f"{name}_across", "across", "orange"))
        groups.append((f"Missing force, frame of {name}", pair))
    panels = [_over_time(force, left, title, lines) for title, lines in groups]
    panels += [_against(force, "heading", "heading", "Missing force against heading")]
    if "wind_from" in force:
        panels.append(_against(force, "wind_from", "wind from, clockwise of the bow", "Missing force against the wind"))
    return panels


def _over_time(force, left, title, lines):
    traces, time = [], _minutes(force["time"].values)
    for name, label, colour in lines:
        if name in force:
            traces.append(line(label, time[0], _averaged(force[name], time[1]), colour))
            if left is not None:
                after = _averaged(left[name], time[1])
                traces.append(line(f"{label}, cause in", time[0], after, colour, dash="dot", width=1.2))
    unit = "kN·m" if force[lines[0][0]].attrs["units"] == "N.m" else "kN"
    return panel(title, unit, traces, xaxis=TIME, yaxis={"zeroline": True})


def _minutes(time, most=1200):
    """Middle times of stretches that are averaged, and their edges in rows."""
    edges = np.unique(np.linspace(0, time.size, min(most, time.size) + 1).round().astype(int))
    return np.array([time[a:b].mean() for a, b in zip(edges[:-1], edges[1:], strict=True)]), edges


def _averaged(series, edges):
    """Averages over stretches of rows. [kN]"""
    values, pairs = 1e-3 * series.values, zip(edges[:-1], edges[1:], strict=True)
    return np.array([values[a:b].mean() for a, b in pairs])


def _against(force, angle, label, title):
    """Mean and scatter of the missing force in sectors of an angle."""
    at, traces = force[angle].values % 360.0, []
    sector = np.minimum((at / (360.0 / BINS)).astype(int), BINS - 1)
    middle = (np.arange(BINS) + 0.5) * 360.0 / BINS
    for name, text, colour in FORCES[0][1]:
        values = 1e-3 * force[name].values
        groups = [values[(sector == k) & np.isfinite(values)] for k in range(BINS)]
        mean = np.array([g.mean() if g.size > 4 else np.nan for g in groups])
        spread = np.array([g.std() if g.size > 4 else 0.0 for g in groups])
        traces.append(
            {
                **{"type": "scatter", "mode": "lines+markers", "name": text, "x": rounded(middle), "y": rounded(mean)},
                "error_y": {"type": "data", "array": rounded(spread), "color": f"@{colour}", "thickness": 1},
                **{"line": {"color": f"@{colour}", "width": 1.5}, "marker": {"color": f"@{colour}", "size": 6}},
            }
        )
    axis = {"title": {"text": label}, "ticksuffix": "°", "range": [0, 360], "dtick": 90}
    return panel(title, "kN", traces, "Mean in sectors of 15°; bars are the standard deviation within.", xaxis=axis)


def gain_panels(errors, models):
    """Errors after the longest horizon by what the ship did, with each model."""
    regimes, last = errors["regime"].values, errors.isel(horizon=-1)
    names = [str(name) for name in np.unique(regimes)]
    traces = [
        {
            **{"type": "bar", "name": MODELS[model][0], "x": names, "marker": {"color": f"@{MODELS[model][1]}"}},
            "y": rounded([rms(last["position"].sel(model=model).isel(segment=regimes == n)) for n in names], 3),
            "hovertemplate": "%{y:.3~g} m",
        }
        for model in models
    ]
    over = [
        line(
            MODELS[model][0],
            last["start_time"].values,
            last["position"].sel(model=model).values,
            MODELS[model][1],
            mode="markers",
            marker={"color": f"@{MODELS[model][1]}", "size": 5},
        )
        for model in models
    ]
    return [
        panel(
            "Position error after 60 s, by what the ship did",
            "m",
            traces,
            barmode="group",
            yaxis={"rangemode": "tozero"},
        ),
        panel("Position error after 60 s, each prediction", "m", over, xaxis=TIME, yaxis={"rangemode": "tozero"}),
    ]
