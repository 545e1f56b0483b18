"""The four-corner test by co-simulation: beside chapter 5 of the thesis, and how it changes with the step."""

from math import degrees, pi
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from common import MODEL, REFERENCE, THIRD, save, table

from shipcosim.cosim import simulate
from shipcosim.library import build_stale
from shipcosim.scenario import read_scenario
from shipcosim.ssp import read_system

ROOT = Path(__file__).resolve().parents[3]
STEPS = (0.2, 0.1, 0.05, 0.025, 0.0125)  # s, coarse to fine; differences are to the finest
THRUSTERS = ("tunnel", "port", "starboard")
CALM = {
    "environment.wind_speed": 0.0,
    "environment.current_speed": 0.0,
    "environment.significant_wave_height": 0.0,
}
WIND = CALM | {
    "environment.wind_speed": 5.0,
    "environment.wind_from": 0.5 * pi,
    "environment.gust_scale": 0.0,
}
NO_NOISE = {
    f"sensors.{name}": 0.0
    for name in (
        "position_drift_std",
        "position_noise_std",
        "heading_drift_std",
        "heading_noise_std",
        "velocity_noise_std",
        "yaw_rate_noise_std",
        "wind_speed_noise",
        "wind_from_noise_std",
    )
}
CASES = {  # name: parameter set, start values over the scenario's
    "33m9, calm, no sensor noise": ("gunnerus-33m9", CALM | NO_NOISE),
    "33m9, calm": ("gunnerus-33m9", CALM),
    "33m9, wind 5 m/s from east": ("gunnerus-33m9", WIND),
    "thesis, calm, no sensor noise": ("thesis", CALM | NO_NOISE),
    "thesis, calm": ("thesis", CALM),
    "thesis, wind 5 m/s from east": ("thesis", WIND),
}
LEGS = {
    "B": (0.0, 250.0),
    "C": (250.0, 450.0),
    "D": (450.0, 650.0),
    "E": (650.0, 850.0),
    "F": (850.0, 1100.0),
}


def run(parameters, values, step=0.05, interval=0.5, first_leg=False):
    """Table of the four-corner scenario with another parameter set, start values and step; 40 s of its first leg."""
    scenario = read_scenario(ROOT / "scenarios" / "four_corner.toml").model_copy(
        update={"parameters": [parameters], "step_size": step, "output_interval": interval}
    )
    scenario = scenario.model_copy(update={"set": scenario.set | values})
    if first_leg:
        scenario = scenario.model_copy(
            update={"stop_time": 40.0, "events": scenario.events[:1], "expect": []}
        )
    system = read_system(scenario.system_path, scenario.parameter_paths, fmus=[build_stale(ROOT)])
    return simulate(system, scenario)


def validate_thesis():
    """Numbers of the comparison with the thesis by name; draws its pictures."""
    tables = {name: run(*case) for name, case in CASES.items()}
    figures = {name: _figures(result) for name, result in tables.items()}
    rows = [
        [
            name,
            f"{f['power']:.1f}",
            *(f"{f['peak_' + unit]:.1f}" for unit in THRUSTERS),
            f"{f['rate']:.0f}",
            f"{f['path']:.2f}",
            f"{f['late']:.2f}",
            f"{f['late_heading']:.1f}",
        ]
        for name, f in figures.items()
    ]
    header = [
        "parameter set, weather",
        "mean power [kW]",
        "peak T1, tunnel [kN]",
        "peak T2, port [kN]",
        "peak T3, starboard [kN]",
        "largest rate [N/s]",
        "off the reference, largest [m]",
        "off the corner at the end of a leg [m]",
        "off the heading [deg]",
    ]
    _draw_thesis(tables)
    calm, wind = figures["33m9, calm, no sensor noise"], figures["33m9, wind 5 m/s from east"]
    old, old_wind = (
        figures["thesis, calm, no sensor noise"],
        figures["thesis, wind 5 m/s from east"],
    )
    azimuths = ("peak_port", "peak_starboard")
    return {
        "table": table(header, rows),
        "legs": table(["mean power [kW]", *LEGS], [_leg_row(name, tables[name]) for name in CASES]),
        "power": calm["power"],
        "thesis_power": old["power"],
        "wind_power": wind["power"],
        "thesis_wind_power": old_wind["power"],
        "peak_tunnel": max(calm["peak_tunnel"], old["peak_tunnel"]),
        "peak_azimuth": max(f[unit] for f in (calm, old) for unit in azimuths),
        "wind_tunnel": max(wind["peak_tunnel"], old_wind["peak_tunnel"]),
        "wind_azimuth": max(f[unit] for f in (wind, old_wind) for unit in azimuths),
        "thesis_tunnel": old["peak_tunnel"],
        "thesis_azimuth": max(old[unit] for unit in azimuths),
        "thesis_wind_tunnel": old_wind["peak_tunnel"],
        "thesis_wind_azimuth": max(old_wind[unit] for unit in azimuths),
        "thesis_rate": old["rate"],
        "thesis_late": old["late"],
        "thesis_late_heading": old["late_heading"],
        "late": calm["late"],
        "late_heading": calm["late_heading"],
        **{f"noisy_{key}": value for key, value in figures["33m9, calm"].items()},
        **{f"windy_{key}": value for key, value in wind.items()},
    }


def _figures(result):
    """Power, forces and path of a run."""
    get = {name: result[name].values for name in result.data_vars}
    time = result["time"].values
    power = sum(get[f"{unit}.power"] for unit in THRUSTERS)
    commands = [get[f"allocator.{unit}_thrust_cmd"] for unit in THRUSTERS]
    ends = [round(end / (time[1] - time[0])) for _, end in LEGS.values()]
    off = np.hypot(get["vessel.x"] - get["reference.x_d"], get["vessel.y"] - get["reference.y_d"])
    corner = [
        np.hypot(
            *(get[f"vessel.{axis}"][k - 1] - get[f"reference.{axis}_set"][k - 1] for axis in "xy")
        )
        for k in ends
    ]
    turn = [abs(_wrapped(get["vessel.psi"][k - 1] - get["reference.psi_set"][k - 1])) for k in ends]
    peaks = {
        f"peak_{unit}": float(np.max(np.abs(get[f"{unit}.thrust"]))) / 1e3 for unit in THRUSTERS
    }
    return peaks | {
        "power": float(np.mean(power)) / 1e3,
        "rate": float(
            max(np.max(np.abs(np.diff(command))) for command in commands) / (time[1] - time[0])
        ),
        "path": float(np.max(off)),
        "late": float(max(corner)),
        "late_heading": degrees(max(turn)),
    }


def _leg_row(name, result):
    time = result["time"].values
    power = sum(result[f"{unit}.power"].values for unit in THRUSTERS) / 1e3
    return [name, *(f"{np.mean(power[(time >= a) & (time < b)]):.1f}" for a, b in LEGS.values())]


def _wrapped(angle):
    return (angle + pi) % (2.0 * pi) - pi


def _draw_thesis(tables):
    figure, (track, force) = plt.subplots(1, 2, figsize=(7.6, 3.4), width_ratios=(1, 1.5))
    for name, color in (
        ("33m9, wind 5 m/s from east", MODEL),
        ("thesis, wind 5 m/s from east", THIRD),
    ):
        result = tables[name]
        track.plot(result["vessel.y"], result["vessel.x"], color=color, label=name.split(",")[0])
    track.plot(
        [0, 0, -20, -20, 0], [0, 20, 20, 0, 0], "o", color=REFERENCE, ms=4.0, label="corners"
    )
    track.set(xlabel="east [m]", ylabel="north [m]", aspect="equal", title="wind 5 m/s from east")
    track.legend()
    result = tables["thesis, calm, no sensor noise"]
    for unit, color in zip(THRUSTERS, (REFERENCE, MODEL, THIRD), strict=True):
        force.plot(result["time"], result[f"{unit}.thrust"] / 1e3, color=color, label=unit)
    force.set(
        xlabel="time [s]", ylabel="thrust [kN]", title="parameter set thesis, calm, no sensor noise"
    )
    force.legend(ncols=3, loc="upper center")
    save(figure, "four_corner_thesis")


def validate_steps():
    """Numbers of the convergence with the step by name; draws its picture."""
    results = {step: run("gunnerus-33m9", {}, step, 1.0) for step in STEPS}
    finest = results[STEPS[-1]]
    offs = {step: _differences(results[step], finest) for step in STEPS[:-1]}
    _draw_steps(offs, finest["time"].values)
    rows = []
    for step, off in offs.items():
        previous = offs.get(2.0 * step)
        largest = [np.max(off[name]) for name in ("track", "heading", "thrust", "measured")]
        ratio = np.max(previous["track"]) / largest[0] if previous else float("nan")
        cells = [
            f"{1e3 * largest[0]:.1f}",
            f"{largest[1]:.3f}",
            f"{largest[2]:.0f}",
            f"{1e3 * largest[3]:.1f}",
        ]
        rows.append([f"{step:g} s", *cells, f"{ratio:.1f}" if ratio == ratio else "-"])
    header = [
        "step",
        "track, largest [mm]",
        "heading, largest [deg]",
        "thrust, largest [N]",
        "measured position less true, largest change [mm]",
        "track: step before / this",
    ]
    numbers = {
        f"track_{1e3 * step:.0f}": 1e3 * float(np.max(off["track"])) for step, off in offs.items()
    }
    numbers |= {
        f"heading_{1e3 * step:.0f}": float(np.max(off["heading"])) for step, off in offs.items()
    }
    deviation = np.hypot(
        finest["vessel.x"] - finest["reference.x_d"], finest["vessel.y"] - finest["reference.y_d"]
    )
    numbers |= {
        "table": table(header, rows),
        "finest": STEPS[-1],
        "wander": float(np.std(deviation)),
    }
    return numbers | _torque_at_the_start()


def _torque_at_the_start():
    """Largest difference of a motor's torque between steps of 0.05 and 0.025 s over its range [%], and when [s]; the
    same after the first second."""
    one, other = (
        run("gunnerus-33m9", {}, step, 0.05, first_leg=True)["starboard.torque"]
        for step in (0.05, 0.025)
    )
    off = 100.0 * np.abs(one - other).values / np.ptp(other.values)
    time = one["time"].values
    first, later = off.argmax(), np.where(time > 1.0, off, 0.0).argmax()
    return {
        "torque": off[first],
        "torque_time": time[first],
        "torque_later": off[later],
        "torque_later_time": time[later],
    }


def _differences(one, other):
    """Over time: track in m, heading in deg, largest thrust in N, error of the position sensor in m."""
    track = np.hypot(one["vessel.x"] - other["vessel.x"], one["vessel.y"] - other["vessel.y"])
    heading = np.degrees(np.abs(_wrapped(one["vessel.psi"] - other["vessel.psi"])))
    thrust = np.max(
        [np.abs(one[f"{unit}.thrust"] - other[f"{unit}.thrust"]) for unit in THRUSTERS], axis=0
    )
    errors = [
        run["sensors.x_1_meas"] - run["vessel.x"] - run["vessel.x_wave"] for run in (one, other)
    ]
    measured = np.abs(errors[0] - errors[1])
    return {
        "track": track.values,
        "heading": heading.values,
        "thrust": thrust,
        "measured": measured.values,
    }


def _draw_steps(offs, time):
    figure, axis = plt.subplots(figsize=(7.2, 2.8))
    for (step, off), color in zip(offs.items(), ("#999999", REFERENCE, MODEL, THIRD), strict=True):
        axis.semilogy(
            time[1:],
            1e3 * np.maximum(off["track"][1:], 1e-6),
            color=color,
            label=f"{step:g} s",
            lw=0.9,
        )
    axis.set(xlabel="time [s]", ylabel=f"off the track of {STEPS[-1]} s [mm]")
    axis.legend(ncols=4, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    save(figure, "convergence")
