"""Azimuth and tunnel units: forces against the unit's own FMU, the four quadrants, torque and the thesis' curves."""

import json
from dataclasses import replace
from math import pi

import matplotlib.pyplot as plt
import numpy as np
from common import MODEL, REFERENCE, THIRD, parameters, save, table

from shipcosim.models.propulsion.azimuth import AzimuthParameters, azimuth_loads, azimuth_replay
from shipcosim.models.propulsion.propeller import PropellerParameters, propeller_loads, series
from shipcosim.models.propulsion.tunnel import TunnelParameters, tunnel_loads, tunnel_replay
from shipcosim.models.ship.hull import HullParameters

PORT = parameters(AzimuthParameters, "gunnerus-33m9", "port")
UNIT = replace(PORT, **dict.fromkeys(("x", "y", "neighbour_x", "neighbour_y"), 0.0))
PROPELLER = parameters(PropellerParameters, "gunnerus-33m9", "port")
PITCH, WAKE = 1.32, 0.18  # fit of the parameter sheet to the thrust of the unit's FMU
FINE = np.radians(np.linspace(-180.0, 180.0, 36001))
DISC = 0.5 * 1025.0 * 0.25 * pi * 1.9**2  # N over a squared speed


def read_points(shared):
    """Points of the unit's FMU: u, v in m/s, angle in rad, rpm, and force along and across the axis in N, (n,) each."""
    data = np.genfromtxt(
        shared / "reference/data/gunnerus_azimuth_fmu_dataset.csv", delimiter=",", skip_header=2
    )
    u, v, _, degrees, rpm, X, Y = data.T
    angle = np.radians(degrees)
    c, s = np.cos(angle), np.sin(angle)
    return u, v, angle, rpm, c * X + s * Y, c * Y - s * X


def model_points(u, v, angle, rpm):
    """Thrust and side force of our unit at those points. [N]"""
    still = 0.0 * u
    loads = azimuth_loads(
        azimuth_replay(rpm / 60.0, angle, u, v, still, unit=UNIT), u, v, still, unit=UNIT
    )
    return loads.thrust, loads.side_force


def validate(shared):
    """Numbers of this section by name; draws its pictures."""
    u, v, angle, rpm, thrust, side = read_points(shared)
    found_thrust, found_side = model_points(u, v, angle, rpm)
    on_axis = (angle == 0.0) & (v == 0.0)
    off_thrust, off_side = found_thrust - thrust, found_side - side
    _draw_points(thrust, side, found_thrust, found_side, on_axis)
    _draw_quadrants()
    rows = [
        _row("thrust, all points", off_thrust, thrust),
        _row("thrust, straight inflow", off_thrust[on_axis], thrust[on_axis]),
        _row("side force, all points", off_side, side),
        _row("side force, angle 0", off_side[angle == 0.0], side[angle == 0.0]),
        _row("side force, angle above 15°", off_side[angle > 0.27], side[angle > 0.27]),
    ]
    worst = int(np.argmax(np.abs(off_side)))
    return (
        {
            "points": len(u),
            "forces": table(
                ["", "points", "rms [kN]", "mean [kN]", "worst [kN]", "largest value [kN]"], rows
            ),
            "thrust_rms": _rms(off_thrust),
            "thrust_mean": float(np.mean(off_thrust)) / 1e3,
            "axis_rms": _rms(off_thrust[on_axis]),
            "side_rms": _rms(off_side),
            "thrust_worst": float(np.max(np.abs(off_thrust))) / 1e3,
            "side_worst": float(np.max(np.abs(off_side))) / 1e3,
            "side_largest": float(np.max(np.abs(side))) / 1e3,
            "thrust_largest": float(np.max(np.abs(thrust))) / 1e3,
            "worst_model": float(found_side[worst]) / 1e3,
            "worst_fmu": float(side[worst]) / 1e3,
            "worst_at": f"{u[worst]:.1f} m/s ahead, {v[worst]:.1f} m/s aside, {np.degrees(angle[worst]):.0f}°, "
            f"{rpm[worst]:.0f} rpm",
        }
        | _quadrants()
        | _torque(shared)
        | _curves(shared)
    )


def _rms(off):
    return float(np.sqrt(np.mean(off**2))) / 1e3


def _row(name, off, values):
    numbers = (
        _rms(off),
        np.mean(off) / 1e3,
        np.max(np.abs(off)) / 1e3,
        np.max(np.abs(values)) / 1e3,
    )
    return [name, len(off), *(f"{number:.2f}" for number in numbers)]


def _coefficients(beta):
    """CT and CQ of our propeller over the hydrodynamic pitch angle."""
    speed = 5.0
    D = PROPELLER.diameter
    thrust, torque = propeller_loads(
        speed * np.sin(beta), speed * np.cos(beta) / (0.7 * pi * D), propeller=PROPELLER
    )
    return thrust / (DISC * speed**2), torque / (DISC * D * speed**2)


def _quadrants():
    """Largest step of the coefficients between neighbours 0.01 deg apart, and bollard points."""
    ct, cq = _coefficients(FINE)
    D, rho = PROPELLER.diameter, PROPELLER.water_density
    numbers = {}
    for name, n in (("ahead", 2.0), ("astern", -2.0)):
        thrust, torque = propeller_loads(0.0, n, propeller=PROPELLER)
        square = rho * D**4 * n * abs(n)
        numbers |= {f"KT_{name}": thrust / square, f"KQ_{name}": torque / (square * D)}
    return numbers | {
        "ct_step": float(np.max(np.abs(np.diff(ct)))),
        "cq_step": float(np.max(np.abs(np.diff(cq)))),
        "ct_range": float(np.ptp(ct)),
        "cq_range": float(np.ptp(cq)),
        "ct_closes": float(abs(ct[0] - ct[-1])),
    }


def _torque(shared):
    """Power at speed, ours against Ka4-70 in nozzle 19A as the parameter sheet reads it, and T V / P of both."""
    polynomials = json.loads(
        (shared / "reference/data/propeller_ka_19a_polynomials.json").read_text()
    )["Ka4-70_19A"]
    rows, offs, shares = [], [], []
    for rpm, knots in ((110.0, 7.25), (170.0, 10.57), (195.0, 11.87)):
        n, speed = rpm / 60.0, knots * 1852.0 / 3600.0
        thrust, torque = propeller_loads(speed, n, propeller=PROPELLER)
        J = (1.0 - WAKE) * speed / (n * PROPELLER.diameter)
        KT, KQ = (
            sum(c * PITCH**x * J**y for c, x, y in polynomials[name]) for name in ("KT", "KQ")
        )
        square = PROPELLER.water_density * n**2 * PROPELLER.diameter**4
        power, other = 2.0 * pi * n * torque, 2.0 * pi * n * KQ * square * PROPELLER.diameter
        offs.append(100.0 * (power / other - 1.0))
        shares.append(thrust * speed / power)
        values = (thrust / 1e3, KT * square / 1e3, power / 1e3, other / 1e3)
        last = [f"{offs[-1]:+.0f} %", f"{shares[-1]:.2f}", f"{KT * square * speed / other:.2f}"]
        rows.append(
            [f"{rpm:.0f} rpm, {knots:.2f} kn", *(f"{value:.1f}" for value in values), *last]
        )
    header = [
        "",
        "thrust [kN]",
        "Ka series [kN]",
        "power [kW]",
        "Ka series [kW]",
        "difference in power",
    ]
    table_of_power = table([*header, "T V / P", "Ka series"], rows)
    return {"torque": table_of_power, "power_low": min(offs), "power_high": max(offs)} | {
        "share_low": min(shares),
        "share_high": max(shares),
        "share_free": _running_free(),
    }


def _running_free():
    """T V / P of the long ship on a straight course in calm water; J, and so this, is the same at all speeds."""
    resistance = -parameters(HullParameters, "gunnerus-33m9", "vessel").X_uu
    n = 170.0 / 60.0
    speeds = np.linspace(1.0, 9.0, 8001)
    thrust, torque = propeller_loads(speeds, n + 0.0 * speeds, propeller=PROPELLER)
    k = int(np.argmin(np.abs(2.0 * thrust - resistance * speeds**2)))
    return float(thrust[k] * speeds[k] / (2.0 * pi * n * torque[k]))


def _curves(shared):
    """Bollard curves of the thesis: its parameter set, and the tunnel."""
    folder = shared / "reference/data"
    rpm, thrust, power = np.genfromtxt(
        folder / "gunnerus_azimuth_nominal_curve.csv", delimiter=",", skip_header=2
    ).T
    thesis = parameters(AzimuthParameters, "thesis", "port")
    n = rpm / 60.0
    found, torque = propeller_loads(0.0 * n, n, propeller=thesis)
    motor, nominal = np.genfromtxt(
        folder / "gunnerus_tunnel_nominal_curve.csv", delimiter=",", skip_header=2
    ).T
    tunnel = parameters(TunnelParameters, "gunnerus-33m9", "tunnel")
    pushed = tunnel_loads(
        tunnel_replay(motor / 60.0, tunnel=tunnel), 0.0 * motor, tunnel=tunnel
    ).thrust
    return {
        "thesis_thrust": float(np.max(np.abs(found - thrust))) / 1e3,
        "thesis_power": float(np.max(np.abs(2.0 * pi * n * torque - power))) / 1e3,
        "thesis_largest": float(np.max(thrust)) / 1e3,
        "thesis_power_largest": float(np.max(power)) / 1e3,
        "tunnel_off": float(np.max(np.abs(pushed - nominal))) / 1e3,
        "tunnel_largest": float(np.max(nominal)) / 1e3,
    }


def _draw_points(thrust, side, found_thrust, found_side, on_axis):
    figure, axes = plt.subplots(1, 2, figsize=(7.2, 3.4))
    pairs = ((thrust, found_thrust, "thrust"), (side, found_side, "side force"))
    for axis, (value, found, name) in zip(axes, pairs, strict=True):
        ends = [min(value.min(), found.min()) / 1e3, max(value.max(), found.max()) / 1e3]
        axis.plot(ends, ends, color="#888888", lw=0.8)
        axis.plot(
            value / 1e3, found / 1e3, ".", ms=2.0, color=MODEL, label="all points", rasterized=True
        )
        axis.plot(
            value[on_axis] / 1e3,
            found[on_axis] / 1e3,
            ".",
            ms=3.0,
            color=REFERENCE,
            label="straight inflow",
        )
        axis.set(xlabel=f"{name}, unit's FMU [kN]", ylabel="model [kN]", aspect="equal")
    axes[0].legend()
    save(figure, "unit_forces")


def _draw_quadrants():
    beta = FINE[::100]
    ct, cq = _coefficients(beta)
    open_ct, open_cq = series(beta)
    figure, axis = plt.subplots(figsize=(7.2, 3.0))
    degrees = np.degrees(beta)
    axis.plot(degrees, ct, color=MODEL, label="CT, model")
    axis.plot(degrees, open_ct, color=MODEL, ls=":", label="CT, open B4-70")
    axis.plot(degrees, 10.0 * cq, color=THIRD, label="10 CQ, model")
    axis.plot(degrees, 10.0 * open_cq, color=THIRD, ls=":", label="10 CQ, open B4-70")
    axis.axvspan(0.0, 31.9, color="#eeeeee", zorder=0)
    axis.set(
        xlabel="hydrodynamic pitch angle [deg]; grey: polynomials", xticks=range(-180, 181, 45)
    )
    axis.legend(ncols=2)
    save(figure, "four_quadrants")
