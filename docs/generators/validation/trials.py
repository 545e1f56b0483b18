"""The 2022 trials against the long ship: speeds, turning circles, zig-zags."""

from dataclasses import replace
from math import copysign, degrees, exp, radians

import matplotlib.pyplot as plt
import numpy as np
import trial_log
from common import (
    KNOT,
    MODEL,
    REFERENCE,
    hull_of,
    save,
    settle,
    speed_of,
    table,
    thrust_loads,
    units,
)
from trial_log import STEP
from turning import swings, turn_numbers

from shipcosim.models.core.motion import Motion
from shipcosim.models.propulsion.azimuth import turned
from shipcosim.models.ship.vessel import step

SHIP = "gunnerus-33m9"
PARTS = 5  # steps per row of the log
AZIMUTH_RATE = radians(10.0)  # rad/s, of the thesis; the trial's is not logged
RPM_LAG = 1.0  # s, assumed as in MCSim_python
RPM_MAX = 203.0
SWING = 0.8  # of the heading of the helm change: smaller swings do not count


def replay(part, state, hull, azimuths):
    """Sail the logged orders: both units follow the one logged azimuth and rpm.

    Parameters
    ----------
    part : trial_log.Log
        Orders; a positive azimuth turns the ship to port, in the log as in the model.
    state : Motion
        The ship at its first row.
    hull : HullParameters
    azimuths : list of AzimuthParameters

    Returns
    -------
    (n, 6) array
        x, y, psi (not wrapped), u, v, r at its rows.
    """

    def order(k, share):
        rpm = (1.0 - share) * part.rpm[k] + share * part.rpm[k + 1]
        return (1.0 - share) * part.azimuth[k] + share * part.azimuth[k + 1], min(
            rpm, RPM_MAX
        ) / 60.0

    helm = part.azimuth[0], min(part.rpm[0], RPM_MAX) / 60.0
    states = [state]
    for k in range(len(part.time) - 1):
        for share in (np.arange(PARTS) + 0.5) / PARTS:
            state, helm = _sailed(state, helm, order(k, share), STEP / PARTS, hull, azimuths)
        states.append(state)
    states = np.array(states)
    states[:, 2] = np.unwrap(states[:, 2])
    return states


def own_zig_zag(order, change, speed, rpm, hull, azimuths, *, time=220.0, h=0.1):
    """Zig-zag of the model with its own helm changes: times in s, headings in deg off the base course."""
    state = settle(Motion(0.0, 0.0, 0.0, speed, 0.0, 0.0), rpm, 0.0, hull, azimuths, time=120.0)
    state, side, helm, psi = state._replace(psi=0.0), 1.0, (0.0, rpm / 60.0), []
    for _ in range(round(time / h)):
        if -side * degrees(state.psi) >= change:  # positive order, turn to port
            side = -side
        state, helm = _sailed(state, helm, (side * radians(order), rpm / 60.0), h, hull, azimuths)
        psi.append(state.psi)
    return swings(h * np.arange(len(psi)), np.array(psi), 0.0, SWING * change)


def _sailed(state, helm, order, h, hull, azimuths):
    """Ship and helm a step later; the helm is azimuth and shaft speed of both units."""
    azimuth = float(turned(helm[0], order[0], AZIMUTH_RATE * h))
    n = order[1] + (helm[1] - order[1]) * exp(-h / RPM_LAG)
    load = thrust_loads(state, n, azimuth, azimuths)
    return step(state, *map(float, load), 0.0, 0.0, h, hull=hull), (azimuth, n)


def start_of(part, scale):
    """The ship at the first row of a window: speed through the water taken as that over ground, along the heading."""
    return Motion(
        0.0,
        0.0,
        float(part.psi[0]),
        float(scale * np.hypot(part.u[0], part.v[0])),
        0.0,
        float(part.r[0]),
    )


def veres_hull(shared, *names):
    """The long ship with VERES' added mass at the lowest frequency instead of the calibrated one, of these names."""
    path = shared / "reference/data/gunnerus_33p9_veres_added_mass_damping.csv"
    low = np.genfromtxt(path, delimiter=",", names=True, skip_header=1)[0]
    return replace(hull_of(SHIP), **{name: float(low[name]) for name in names})


def validate(shared):
    """Numbers of this section by name; draws its pictures."""
    log = trial_log.read(shared)
    hull, azimuths, scale = hull_of(SHIP), units(SHIP), trial_log.speed_ratio(log)
    turns = [_turn(log.part(*window), scale, hull, azimuths) for window in trial_log.circles(log)]
    zig_zags = {
        name: _zig_zag(log.part(*about[2:]), *about[:2], scale, hull, azimuths)
        for name, about in trial_log.ZIG_ZAGS.items()
    }
    heavy, slow = veres_hull(shared, "A11", "A22", "A26", "A62", "A66"), veres_hull(shared, "A66")
    what_ifs = {
        name: [_turn(turn["part"], scale, other, azimuths)["model"] for turn in turns]
        for name, other in (("veres", heavy), ("A66", slow))
    }
    _draw_turns(turns)
    _draw_zig_zags(zig_zags)
    return (
        {
            "velocity_scale": scale,
            "lost": " and ".join(
                f"{start:.0f} to {end:.1f} s" for start, end in trial_log.lost(log)
            ),
        }
        | _speeds(log, scale, hull, azimuths)
        | _circle_numbers(turns, what_ifs)
        | _zig_zag_numbers(zig_zags)
    )


def _speeds(log, scale, hull, azimuths):
    """Speeds of the trial at its three orders, mean of two directions, and the model's."""
    numbers, rows = {}, []
    for rpm, legs in trial_log.STRAIGHT.items():
        parts = [log.part(*leg) for leg in legs]
        speeds = [scale * float(np.mean(np.hypot(part.u, part.v))) / KNOT for part in parts]
        logged = min(float(np.mean([part.rpm.mean() for part in parts])), RPM_MAX)
        state = settle(
            Motion(0.0, 0.0, 0.0, 0.5 * sum(speeds) * KNOT, 0.0, 0.0), logged, 0.0, hull, azimuths
        )
        trial, model = 0.5 * sum(speeds), speed_of(state) / KNOT
        numbers |= {
            f"trial_{rpm}": trial,
            f"model_{rpm}": model,
            f"off_{rpm}": 100.0 * (model / trial - 1.0),
        }
        order = f"{logged:.0f}" if rpm < RPM_MAX else f"{rpm} (model: {RPM_MAX:.0f})"
        numbers[f"apart_{rpm}"] = KNOT * abs(speeds[0] - speeds[1])
        rows.append(
            [
                order,
                *(f"{s:.2f}" for s in speeds),
                f"{trial:.2f}",
                f"{model:.2f}",
                f"{model / trial - 1:+.1%}",
            ]
        )
    state = settle(Motion(0.0, 0.0, 0.0, 6.0, 0.0, 0.0), 195.0, 0.0, hull, azimuths)
    numbers["model_195"] = speed_of(state) / KNOT
    header = [
        "order [rpm]",
        "one way [kn]",
        "other way [kn]",
        "trial, mean [kn]",
        "model [kn]",
        "difference",
    ]
    sides = [
        float(np.mean(log.part(*leg).v)) for legs in trial_log.STRAIGHT.values() for leg in legs
    ]
    numbers |= {"sway_low": min(sides), "sway_high": max(sides)}
    return numbers | {"speeds": table(header, rows)}


def _turn(part, scale, hull, azimuths):
    """Trial and model of one turning circle."""
    time = part.time - part.time[0]
    trial = turn_numbers(
        time, part.psi, scale * part.u, scale * part.v, part.r, part.north, part.east
    )
    turned_by_rate = np.concatenate(([0.0], np.cumsum(0.5 * STEP * (part.r[1:] + part.r[:-1]))))
    by_rate = turn_numbers(time, turned_by_rate, part.u, part.v, part.r, part.north, part.east)
    trial |= {"t90_rate": by_rate["t90"], "t180_rate": by_rate["t180"]}
    states = replay(part, start_of(part, scale), hull, azimuths)
    x, y, psi, u, v, r = states.T
    model = turn_numbers(time, psi, u, v, r, x, y)
    middle = slice(len(time) // 3, 2 * len(time) // 3)
    return {
        "part": part,
        "order": degrees(float(np.median(part.azimuth[middle]))),
        "rpm": (float(np.mean(part.rpm[:4])), float(np.median(part.rpm[middle]))),
        "states": states,
        "trial": trial,
        "model": model,
    }


def _name(turn):
    before, after = turn["rpm"]
    side = "port" if turn["order"] > 0.0 else "stbd"
    rpm = f"{before:.0f}" if abs(before - after) < 5.0 else f"{before:.0f} → {after:.0f}"
    return f"{abs(turn['order']):.0f}° {side}, {rpm} rpm"


def _circle_numbers(turns, what_ifs):
    def pair(turn, name, digits=0):
        return f"{turn['trial'][name]:.{digits}f} / {turn['model'][name]:.{digits}f}"

    def off(name, reference=None):
        values = [
            100.0 * (turn["model"][name] / turn["trial"][reference or name] - 1.0) for turn in turns
        ]
        key = reference or name
        return {
            f"{key}_low": min(values),
            f"{key}_high": max(values),
            f"{key}_mean": float(np.mean(values)),
        }

    steady = [
        [
            _name(t),
            pair(t, "approach", 2),
            pair(t, "speed", 2),
            pair(t, "rate", 2),
            pair(t, "diameter"),
        ]
        for t in turns
    ]
    transient = [
        [
            _name(t),
            *(
                f"{t['trial'][k]:.1f} ({t['trial'][k + '_rate']:.1f}) / {t['model'][k]:.1f}"
                for k in ("t90", "t180")
            ),
            pair(t, "advance"),
            pair(t, "tactical"),
        ]
        for t in turns
    ]
    clocks = [_clock_to_quarter(turn) for turn in turns]
    numbers = {
        "circles": table(
            ["turn", "approach [m/s]", "steady speed [m/s]", "rate [deg/s]", "diameter [m]"], steady
        ),
        "transients": table(
            ["turn", "t90 [s]", "t180 [s]", "advance [m]", "tactical diameter [m]"], transient
        ),
        "number": len(turns),
        "clock_low": min(heading for heading, _ in clocks),
        "clock_high": max(heading for heading, _ in clocks),
        "clock_agree": max(abs(heading - way) for heading, way in clocks),
    }
    for name in ("speed", "rate", "diameter", "t90", "t180", "advance", "tactical"):
        numbers |= off(name)
    numbers |= off("t90", "t90_rate") | off("t180", "t180_rate")
    for what_if, models in what_ifs.items():
        for name in ("t90", "rate", "diameter"):
            values = [
                100.0 * (m[name] / t["model"][name] - 1.0)
                for t, m in zip(turns, models, strict=True)
            ]
            numbers[f"{what_if}_{name}"] = float(np.mean(values))
    return numbers


def _clock_to_quarter(turn):
    """Up to 90 deg of turn: heading over integral of the rate, and way of the positions over that of the speeds."""
    part = turn["part"]
    first = part.part(part.time[0], part.time[0] + turn["trial"]["t90"])
    way = np.sum(np.hypot(np.diff(first.north), np.diff(first.east)))
    sailed = np.trapezoid(np.hypot(first.u, first.v), dx=STEP) * turn["trial"]["approach"]
    return trial_log.clock_ratio(first), float(way / sailed * np.hypot(part.u[0], part.v[0]))


def _zig_zag(part, order, change, scale, hull, azimuths):
    """Trial, replay and the model's own run of one zig-zag."""
    time = part.time - part.time[0]
    base = float(part.psi[0])
    state = start_of(part, scale)
    states = replay(part, state, hull, azimuths)
    rpm = float(np.median(part.rpm))
    return {
        "part": part,
        "base": base,
        "states": states,
        "change": change,
        "trial": swings(time, part.psi, base, SWING * change),
        "late": _first_reversal(part, base),
        "clock": trial_log.clock_ratio(part),
        "own": own_zig_zag(order, change, state.u, rpm, hull, azimuths),
        "rates": [_peak_rate(r) for r in (part.r, states[:, 5])],
    }


def _first_reversal(part, base):
    """Heading off the base course when the order first passed through zero after its first swing. [deg]"""
    sign = np.sign(part.azimuth) * (np.abs(part.azimuth) > radians(4.0))
    first = np.flatnonzero(sign)[0]
    reversal = first + np.flatnonzero(np.sign(part.azimuth[first:]) == -sign[first])[0]
    return abs(degrees(float(part.psi[reversal]) - base))


def _peak_rate(r):
    """Typical largest yaw rate of the swings: its 90th percentile. [deg/s]"""
    return degrees(float(np.percentile(np.abs(r), 90.0)))


def _zig_zag_numbers(zig_zags):
    rows, numbers = [], {}
    for name, z in zig_zags.items():
        (times, peaks), (own_times, own_peaks) = z["trial"], z["own"]
        over, own_over = np.abs(peaks) - z["change"], np.abs(own_peaks) - z["change"]
        key = _key(name)
        half, own_half = (
            float(np.mean(np.diff(t))) if len(t) > 1 else float("nan") for t in (times, own_times)
        )
        numbers |= {
            f"over_{key}": float(np.mean(over)),
            f"own_over_{key}": float(np.mean(own_over)),
            f"half_{key}": half,
            f"half_true_{key}": half * z["clock"],
            f"own_half_{key}": own_half,
            f"late_{key}": z["late"],
        }
        rows.append(
            [
                name,
                len(peaks),
                f"{np.min(over):.1f} to {np.max(over):.1f}",
                f"{np.min(own_over):.1f} to {np.max(own_over):.1f}",
                f"{half:.1f} ({half * z['clock']:.1f})" if half == half else "-",
                f"{own_half:.1f}",
                f"{z['rates'][0]:.2f} / {z['rates'][1]:.2f}",
            ]
        )
    header = [
        "zig-zag",
        "swings",
        "overshoot, trial [deg]",
        "overshoot, model [deg]",
        "half period, trial [s]",
        "half period, model [s]",
        "yaw rate, trial / replay [deg/s]",
    ]
    for name in ("half", "half_true"):
        numbers[f"{name}_off_10_20"] = 100.0 * (
            numbers["own_half_10_20_170"] / numbers[f"{name}_10_20_170"] - 1.0
        )
    true, rates = [], []
    for name, z in zig_zags.items():
        key = _key(name)
        true.append(100.0 * (numbers[f"own_half_{key}"] / numbers[f"half_true_{key}"] - 1.0))
        rates.append(100.0 * (z["rates"][1] / z["rates"][0] - 1.0))
    numbers |= {"half_true_low": np.nanmin(true), "half_true_high": np.nanmax(true)}
    numbers |= {"rates_low": min(rates), "rates_high": max(rates)}
    numbers["over_off_10_20"] = numbers["own_over_10_20_170"] - numbers["over_10_20_170"]
    return numbers | {"zig_zags": table(header, rows)}


def _key(name):
    """Name of a zig-zag as part of a key."""
    return name.replace("/", "_").replace(" at ", "_").replace(" rpm", "")


def _draw_turns(turns):
    chosen = [
        next(t for t in turns if round(abs(t["order"]) / 10.0) == k and _sharp(t))
        for k in (1, 2, 3)
    ]
    figure, axes = plt.subplots(2, 3, figsize=(7.6, 5.0))
    for (track, rate), turn in zip(axes.T, chosen, strict=True):
        part, states = turn["part"], turn["states"]
        x, y = _from_start(part.north, part.east, part.psi[0], turn["order"])
        track.plot(x, y, color=REFERENCE, label="trial (positions)")
        x, y = _from_start(states[:, 0], states[:, 1], states[0, 2], turn["order"])
        track.plot(x, y, color=MODEL, label="model, same orders")
        track.set(aspect="equal", title=_name(turn), xlabel="to the side of the turn [m]")
        time, side = part.time - part.time[0], -copysign(1.0, turn["order"])
        rate.plot(time, np.degrees(side * part.r), color=REFERENCE)
        rate.plot(time, np.degrees(side * states[:, 5]), color=MODEL)
        rate.set(xlabel="time [s]", xlim=(0.0, 160.0))
    axes[0, 0].set(ylabel="ahead [m]")
    axes[1, 0].set(ylabel="yaw rate [deg/s]")
    axes[1, 0].legend(*axes[0, 0].get_legend_handles_labels(), loc="lower right")
    save(figure, "turning_circles")


def _sharp(turn):
    return turn["order"] > 0.0


def _from_start(north, east, psi, order):
    """Track from its first point: to the side of the turn, and ahead. [m]"""
    c, s, side = np.cos(psi), np.sin(psi), -copysign(1.0, order)
    north, east = north - north[0], east - east[0]
    return side * (-north * s + east * c), north * c + east * s


def _draw_zig_zags(zig_zags):
    figure, axes = plt.subplots(4, 1, figsize=(7.2, 8.0))
    for axis, (name, z) in zip(axes, zig_zags.items(), strict=True):
        part = z["part"]
        time = part.time - part.time[0]
        axis.plot(time, np.degrees(part.psi - z["base"]), color=REFERENCE, label="trial")
        axis.plot(
            time, np.degrees(z["states"][:, 2] - z["base"]), color=MODEL, label="model, same orders"
        )
        axis.plot(
            time,
            -np.degrees(part.azimuth),
            color="#888888",
            lw=0.7,
            label="azimuth order, sign turned",
        )
        axis.set(title=name, ylabel="[deg]")
    axes[-1].set(xlabel="time [s]")
    axes[0].legend(ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.15))
    save(figure, "zig_zags")
