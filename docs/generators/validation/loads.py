"""Wind, wave drift and added mass against their tables, and against what was not used to make them."""

import json

import matplotlib.pyplot as plt
import numpy as np
from common import MODEL, REFERENCE, THIRD, hull_of, parameters, save, table

from shipcosim.models.environment.wave_loads import OMEGA_DRIFT_MAX, drift, drift_table, mean_drift
from shipcosim.models.environment.waves import components, jonswap
from shipcosim.models.environment.wind_loads import WindParameters, wind_loads
from shipcosim.models.ship.vessel import DriftParameters

DRIFT_33M9 = parameters(DriftParameters, "gunnerus-33m9", "vessel").drift_table
FRONTAL, LATERAL, LENGTH, DENSITY = (
    85.0,
    210.0,
    36.25,
    1.224,
)  # m2, m2, m, kg/m3: the lengthened ship
SHORT_FRONTAL, SHORT_LATERAL, SHORT_LENGTH, SHORT_DENSITY = 81.0, 172.0, 31.25, 1.23
ARM = 2.0  # m, centroid of the lateral area forward of midships
LABELS = ("X", "Y", "N")


def validate(shared):
    """Numbers of this section by name; draws its pictures."""
    return _wind(shared) | _drift(shared) | _added_mass(shared)


def blendermann(shared, angle):
    """Loads of Blendermann's research vessel per squared wind speed, (3, n); angle from the bow, 0 to pi."""
    data = json.loads((shared / "reference/data/blendermann94.json").read_text())["data"][
        "Research vessel"
    ]
    CDt, bow, stern, delta, _ = data
    CDlAF = np.where(angle <= 0.5 * np.pi, bow, stern)
    CDl = CDlAF * FRONTAL / LATERAL
    below = 1.0 - 0.5 * delta * (1.0 - CDl / CDt) * np.sin(2.0 * angle) ** 2
    X = -0.5 * DENSITY * FRONTAL * CDlAF * np.cos(angle) / below
    Y = -0.5 * DENSITY * LATERAL * CDt * np.sin(angle) / below
    return np.array([X, Y, Y * (ARM - 0.18 * LENGTH * (angle - 0.5 * np.pi))])


def _wind(shared):
    folder = shared / "reference/data"
    long, short = (
        parameters(WindParameters, ship, "vessel") for ship in ("gunnerus-33m9", "gunnerus-28m9")
    )
    to, *source = np.genfromtxt(
        folder / "gunnerus_33p9_wind_load_coefficients.csv", delimiter=",", skip_header=2
    ).T
    from_table = wind_loads(1.0, np.radians(to) - np.pi, wind=long)
    angle, *coefficients = np.genfromtxt(
        folder / "gunnerus_28p9_wind_coefficients.csv", delimiter=",", skip_header=2
    ).T
    sizes = (
        0.5
        * SHORT_DENSITY
        * np.array([[SHORT_FRONTAL], [SHORT_LATERAL], [SHORT_LATERAL * SHORT_LENGTH]])
    )
    short_table = wind_loads(1.0, -np.radians(angle), wind=short)
    fine = np.radians(np.linspace(0.0, 180.0, 721))
    model, formula = np.array(wind_loads(1.0, fine, wind=long)), blendermann(shared, fine)
    largest = np.max(np.abs(formula), axis=1)
    other = _coefficients(np.array(wind_loads(1.0, fine, wind=short)), short=True)
    own = _coefficients(model, short=False)
    _draw_wind(fine, own, _coefficients(formula, short=False), other)
    difference = np.max(np.abs(own - other), axis=1) / np.max(np.abs(own), axis=1)
    numbers = {
        "wind_table": float(
            np.max(np.abs(np.array(from_table) - source) / np.max(np.abs(source), axis=1)[:, None])
        ),
        "wind_table_short": float(
            np.max(
                np.abs(short_table - sizes * coefficients)
                / np.max(np.abs(sizes * coefficients), axis=1)[:, None]
            )
        ),
    }
    for k, name in enumerate(LABELS):
        numbers[f"blendermann_{name}"] = 100.0 * float(
            np.max(np.abs(model - formula)[k]) / largest[k]
        )
        numbers[f"ships_{name}"] = 100.0 * float(difference[k])
    return numbers


def _coefficients(loads, *, short):
    """Loads over pressure, area and length, (3, n). [1]"""
    if short:
        density, frontal, lateral, length = (
            SHORT_DENSITY,
            SHORT_FRONTAL,
            SHORT_LATERAL,
            SHORT_LENGTH,
        )
    else:
        density, frontal, lateral, length = DENSITY, FRONTAL, LATERAL, LENGTH
    return loads / (0.5 * density * np.array([[frontal], [lateral], [lateral * length]]))


def _drift(shared):
    path = shared / "reference/data/gunnerus_33p9_veres_wave_drift_U0.csv"
    rows = np.genfromtxt(path, delimiter=",", skip_header=2)
    rows = rows[rows[:, 0] <= OMEGA_DRIFT_MAX]
    omegas, headings = np.unique(rows[:, 0]), np.unique(rows[:, 1])
    full = rows[np.lexsort((rows[:, 0], rows[:, 1])), 2:].reshape(len(headings), len(omegas), 3)
    kept = drift_table(DRIFT_33M9)
    half = np.array(kept.loads)[-len(headings) :]  # 0 to 180 deg
    interpolated = np.array(
        [[np.interp(omegas, kept.omega, load) for load in heading] for heading in half]
    )
    off = np.max(np.abs(interpolated.transpose(0, 2, 1) - full), axis=(0, 1))
    size = np.max(np.abs(full), axis=(0, 1))
    _draw_drift(omegas, full[list(headings).index(90.0), :, 1], kept)
    numbers = {f"drift_{name}": float(off[k]) for k, name in enumerate(LABELS)}
    numbers |= {f"drift_size_{name}": float(size[k]) / 1e3 for k, name in enumerate(LABELS)}
    seas = [
        _sea_row(omegas, full, headings, kept, *sea) for sea in ((0.3, 5.0), (0.5, 6.0), (1.0, 7.0))
    ]
    header = [
        "Hs, Tp, beam sea",
        "2 ∫ S D dω [kN]",
        "40 components, mean of 20 seeds [kN]",
        "spread [kN]",
        "rms in time [kN]",
    ]
    return numbers | {
        "seas": table(header, [row for row, _ in seas]),
        "seas_off": max(abs(off) for _, off in seas),
        "beam_limit": 0.5 * 1025.0 * 9.81 * 33.9 / 1e3,
        "beam_largest": float(full[list(headings).index(90.0), :, 1].max()) / 1e3,
    }


def _sea_row(omegas, full, headings, kept, height, period):
    """Mean sway drift in a beam sea: by the integral over the whole table, and as the model has it."""
    fine = np.linspace(0.3, OMEGA_DRIFT_MAX, 4000)
    D = np.interp(fine, omegas, full[list(headings).index(90.0), :, 1])
    integral = 2.0 * np.trapezoid(jonswap(fine, height, period, 3.3) * D, fine)
    means, times = [], np.arange(0.0, 1800.0, 0.5)
    for seed in range(20):
        sea = components(height, period, -0.5 * np.pi, 3.3, seed)
        means.append(mean_drift(0.0, sea, kept)[1])
    still = 0.0 * times
    slow = np.std(drift(times, still, still, still, sea, kept)[1])
    row = [
        f"{height} m, {period:.0f} s",
        *(f"{x / 1e3:.2f}" for x in (integral, np.mean(means), np.std(means), slow)),
    ]
    return row, 100.0 * (np.mean(means) / integral - 1.0)


def _added_mass(shared):
    path = shared / "reference/data/gunnerus_33p9_veres_added_mass_damping.csv"
    data = np.genfromtxt(path, delimiter=",", names=True, skip_header=1)
    still = data[data["U_mps"] == 0.0]
    low, high = still[0], still[-1]
    hull, short = hull_of("gunnerus-33m9"), hull_of("gunnerus-28m9")
    _draw_added_mass(still, hull)
    rows, numbers = (
        [],
        {"omega_low": float(low["omega_rad_s"]), "omega_high": float(high["omega_rad_s"])},
    )
    masses = {"A11": hull.mass, "A22": hull.mass, "A26": None, "A66": hull.inertia_yaw}
    for name, own in masses.items():
        value = getattr(hull, name)
        size = 1e3 if name in ("A11", "A22", "A26") else 1e6
        rows.append(
            [
                f"{name} [{'t' if name in ('A11', 'A22') else 't·m' if name == 'A26' else '1000 t·m²'}]",
                *(f"{x / size:.1f}" for x in (value, low[name], high[name], getattr(short, name))),
                f"{value / low[name]:.2f}",
                f"{(own + value) / (own + low[name]):.2f}" if own else "-",
            ]
        )
        numbers[f"ratio_{name}"] = float(value / low[name])
        if own:
            numbers[f"inertia_{name}"] = float((own + value) / (own + low[name]))
    header = [
        "",
        "model",
        "VERES, lowest frequency",
        "VERES, highest",
        "28.9 m ship (SIMVAL)",
        "model / VERES lowest",
        "with the ship's own mass",
    ]
    return numbers | {"added_mass": table(header, rows)}


def _draw_wind(angle, own, formula, other):
    figure, axes = plt.subplots(1, 3, figsize=(7.6, 2.8))
    degrees = np.degrees(angle)[::12]
    for axis, k, name in zip(axes, range(3), ("CX", "CY", "CN"), strict=True):
        axis.plot(
            degrees, formula[k, ::12], color=REFERENCE, lw=2.4, alpha=0.5, label="Blendermann"
        )
        axis.plot(degrees, own[k, ::12], color=MODEL, label="33.9 m, model")
        axis.plot(degrees, other[k, ::12], color=THIRD, ls="--", label="28.9 m, model")
        axis.set(title=name, xlabel="wind from [deg]", xticks=range(0, 181, 60))
    axes[0].legend()
    save(figure, "wind")


def _draw_drift(omegas, beam, kept):
    figure, axis = plt.subplots(figsize=(4.4, 2.8))
    axis.plot(omegas, beam / 1e3, "o", ms=3.0, color=REFERENCE, label="VERES")
    middle = kept.heading.index(min(kept.heading, key=lambda heading: abs(heading - 0.5 * np.pi)))
    axis.plot(kept.omega, np.array(kept.loads[middle][1]) / 1e3, color=MODEL, label="model")
    axis.set(xlabel="frequency [rad/s]", ylabel="beam sway drift [kN/m²]")
    axis.legend()
    save(figure, "drift")


def _draw_added_mass(still, hull):
    figure, axes = plt.subplots(1, 4, figsize=(7.8, 2.6))
    for axis, name, size, unit in zip(
        axes,
        ("A11", "A22", "A26", "A66"),
        (1e3, 1e3, 1e3, 1e6),
        ("t", "t", "t·m", "1000 t·m²"),
        strict=True,
    ):
        axis.plot(still["omega_rad_s"], still[name] / size, color=REFERENCE, label="VERES")
        axis.axhline(getattr(hull, name) / size, color=MODEL, label="model")
        axis.set(title=f"{name} [{unit}]", xlabel="ω [rad/s]")
    axes[0].legend()
    save(figure, "added_mass")
