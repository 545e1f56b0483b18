"""The recorded turn of the 28.9 m ship: forces against accelerations, and the turn sailed again."""

from math import degrees, hypot, radians
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from common import MODEL, REFERENCE, THIRD, hull_of, save, thrust_loads, units

from shipcosim.models.core.motion import Motion
from shipcosim.models.propulsion.azimuth import azimuth_loads, azimuth_replay
from shipcosim.models.ship.hull import hull_loads
from shipcosim.models.ship.vessel import step

SHIP = "gunnerus-28m9"
RPM, AZIMUTH = 100.0, radians(20.0)  # of the record, both units
PARTS = 10  # steps per recorded second


class Record(NamedTuple):
    """The record, one column a second.

    Parameters
    ----------
    eta, nu, acceleration : (3, n) array
        North, east, heading; surge, sway, yaw rate; their rates. [SI, rad]
    forces : (2, 2, n) array
        Force of each unit: unit, forward or starboard, sample. [N]
    tau : (3, n) array
        Load of both units. [N, N, N.m]
    """

    eta: np.ndarray
    nu: np.ndarray
    acceleration: np.ndarray
    forces: np.ndarray
    tau: np.ndarray


def read(shared):
    """The record of the co-simulation of the ship's own FMUs in Vico."""
    path = shared / "reference/data/gunnerus_28p9_vico_turn_reference.csv"
    run = np.genfromtxt(path, delimiter=",", names=True, skip_header=1)
    forces = np.array([[run[f"bodyforce{i}_{axis}"] for axis in ("surge", "sway")] for i in (0, 1)])
    port, starboard = units(SHIP)
    N = sum(unit.x * Y - unit.y * X for unit, (X, Y) in zip((port, starboard), forces, strict=True))
    return Record(
        np.array([run["N"], run["E"], np.unwrap(np.radians(run["heading"]))]),
        np.array([run["surge_vel"], run["sway_vel"], np.radians(run["yaw_vel"])]),
        np.array([run["surge_acc"], run["sway_acc"], np.radians(run["yaw_acc"])]),
        forces,
        np.array([*forces.sum(axis=0), N]),
    )


def missing_loads(record):
    """What the model's loads miss of mass times recorded acceleration, (3, n). [N, N, N.m]"""
    hull = hull_of(SHIP)
    u, v, r = record.nu
    mass = np.array(
        [
            [hull.mass + hull.A11, 0.0, 0.0],
            [0.0, hull.mass + hull.A22, hull.A26],
            [0.0, hull.A62, hull.inertia_yaw + hull.A66],
        ]
    )
    inertia = hull.mass * np.array([-v * r, u * r, 0.0 * r])
    return mass @ record.acceleration + inertia - record.tau - hull_loads(u, v, r, hull=hull)


def sailed_again(record, load):
    """States of the ship each second under loads ``load(second, share of the second, state)``, (n, 6)."""
    hull = hull_of(SHIP)
    state = Motion(*map(float, (*record.eta[:, 0], *record.nu[:, 0])))
    states = [state]
    for k in range(record.eta.shape[1] - 1):
        for share in (np.arange(PARTS) + 0.5) / PARTS:
            state = step(
                state, *map(float, load(k, share, state)), 0.0, 0.0, 1.0 / PARTS, hull=hull
            )
        states.append(state)
    return np.array(states)


def unit_force_errors(record):
    """Force of each unit in our model less the recorded one, (2, 2, n). [N]"""
    u, v, r = record.nu
    errors = []
    for unit, force in zip(units(SHIP), record.forces, strict=True):
        replay = azimuth_replay(RPM / 60.0 + 0.0 * u, AZIMUTH + 0.0 * u, u, v, r, unit=unit)
        loads = azimuth_loads(replay, u, v, r, unit=unit)
        errors.append([loads.tau_X - force[0], loads.tau_Y - force[1]])
    return np.array(errors)


def validate(shared):
    """Numbers of this section by name; draws its picture."""
    record = read(shared)
    missing = np.max(np.abs(missing_loads(record)), axis=1)
    given = sailed_again(
        record, lambda k, share, _: (1.0 - share) * record.tau[:, k] + share * record.tau[:, k + 1]
    )
    azimuths = units(SHIP)
    free = sailed_again(
        record, lambda k, share, state: thrust_loads(state, RPM / 60.0, AZIMUTH, azimuths)
    )
    errors = unit_force_errors(record)
    largest = np.max(np.hypot(*record.forces.transpose(1, 0, 2)))
    _draw(record, given, free)
    return (
        {
            "seconds": record.eta.shape[1] - 1,
            "way": float(np.sum(np.hypot(*np.diff(record.eta[:2])))),
            "turned": abs(degrees(record.eta[2, -1] - record.eta[2, 0])),
            "X_miss": missing[0],
            "Y_miss": missing[1] / 1e3,
            "N_miss": missing[2] / 1e3,
            "X_size": np.max(np.abs(record.tau[0])) / 1e3,
            "Y_size": np.max(np.abs(record.tau[1])) / 1e3,
            "N_share": 100.0 * missing[2] / np.max(np.abs(record.tau[2])),
            "N_size": np.max(np.abs(record.tau[2])) / 1e3,
            "unit_rms": float(np.sqrt(np.mean(np.sum(errors**2, axis=1)))) / 1e3,
            "unit_worst": float(np.max(np.hypot(errors[:, 0], errors[:, 1]))) / 1e3,
            "unit_size": largest / 1e3,
        }
        | _ends("given", given, record)
        | _ends("free", free, record)
    )


def _ends(name, states, record):
    x, y, psi = states[-1, :3]
    u, v, r = record.nu[:, -1]
    turn = (psi - record.eta[2, -1] + np.pi) % (2.0 * np.pi) - np.pi
    return {
        f"{name}_end": hypot(x - record.eta[0, -1], y - record.eta[1, -1]),
        f"{name}_end_heading": abs(degrees(turn)),
        f"{name}_rate": degrees(states[-1, 5]),
        "rate": degrees(r),
        f"{name}_speed": hypot(*states[-1, 3:5]),
        "speed": hypot(u, v),
    }


def _draw(record, given, free):
    figure, (track, rate) = plt.subplots(1, 2, figsize=(7.2, 3.2))
    track.plot(record.eta[1], record.eta[0], color=REFERENCE, label="recorded", lw=2.4, alpha=0.5)
    track.plot(given[:, 1], given[:, 0], color=MODEL, label="hull model, recorded forces")
    track.plot(free[:, 1], free[:, 0], color=THIRD, label="hull and thruster model", ls="--")
    track.set(xlabel="east [m]", ylabel="north [m]", aspect="equal")
    time = np.arange(record.eta.shape[1])
    rate.plot(time, np.degrees(record.nu[2]), color=REFERENCE, lw=2.4, alpha=0.5, label="recorded")
    rate.plot(time, np.degrees(given[:, 5]), color=MODEL, label="hull model, recorded forces")
    rate.plot(time, np.degrees(free[:, 5]), color=THIRD, ls="--", label="hull and thruster model")
    rate.set(xlabel="time [s]", ylabel="yaw rate [deg/s]")
    rate.legend()
    save(figure, "short_turn")
