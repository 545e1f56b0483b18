"""Writes docs/generated/ship-estimates.md: how far estimates of a ship file are off where numbers are known.

Run `python docs/generators/write_ship_estimates.py` after a formula of `shipcosim.ships.estimates` has changed; a test
compares the page with this. Each ship is described by her main particulars alone, as a user would who knows no more.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import shipcosim as sc
from shipcosim.library import build_stale
from shipcosim.models.core.tables import parse
from shipcosim.ships import Described, describe, make_systems, read_ship
from shipcosim.ships.file import ShipFile
from shipcosim.ssp import read_system

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "generated" / "ship-estimates.md"
AZIMUTH = {"kind": "azimuth", "ducted": True, "diameter": 1.9, "power": 500e3, "rpm": 203.0}
GUNNERUS = [
    {"name": "port", "x": -14.0, "y": -2.0} | AZIMUTH,
    {"name": "starboard", "x": -14.0, "y": 2.0} | AZIMUTH,
]
STERN = {"name": "propeller", "kind": "rudder", "x": -3.386, "y": 0.0, "diameter": 0.204}
STERN |= {"rudder_x": -3.5, "rudder_area": 0.0539, "rudder_span": 0.345}
SCREW = {"name": "screw", "kind": "fixed", "command": "thrust", "x": 0.0, "y": 0.0}
SHIPS = {
    "gunnerus-33m9": dict(
        length=33.9, breadth=9.6, draught=2.786, displacement=531e3, service_speed=5.14
    ),
    "gunnerus-28m9": dict(
        length=28.9, breadth=9.6, draught=2.7, displacement=410931.81, service_speed=5.14
    ),
    "kvlcc2": dict(
        length=7.0,
        breadth=1.2688,
        draught=0.455,
        displacement=3272.0,
        service_speed=1.179,
        water_density=1000.0,
    ),
    "otter": dict(
        length=2.0,
        breadth=1.08,
        draught=0.195,
        displacement=80.0,
        service_speed=3.09,
        hulls=2,
        hull_breadth=0.25,
    ),
    "blueboat": dict(
        length=1.2,
        breadth=0.93,
        draught=0.12,
        displacement=15.0,
        service_speed=1.4,
        hulls=2,
        hull_breadth=0.15,
        water_density=1000.0,
    ),
}
"""Main particulars, as in ssp/ships; breadth of BlueBoat's hulls assumed."""
THRUSTERS = {"gunnerus-33m9": GUNNERUS, "gunnerus-28m9": GUNNERUS, "kvlcc2": [STERN]}
CENTRES = {"kvlcc2": 0.2436, "otter": 0.1375, "blueboat": 0.1}
HULL = {
    "inertia_yaw": ("moment of inertia in yaw", "kg.m2"),
    "A11": ("added mass in surge", "kg"),
    "A22": ("added mass in sway", "kg"),
    "A66": ("added moment of inertia", "kg.m2"),
    "cross_flow_drag": ("cross-flow drag coefficient", "1"),
}
RUDDER = (
    *(
        "k0",
        "wake",
        "thrust_deduction",
        "lift_gradient",
        "rudder_deduction",
        "hull_share",
        "hull_x",
    ),
    *(
        "race_gain",
        "wake_ratio",
        "straightening_starboard",
        "straightening_port",
        "straightening_x",
    ),
)
TAKEN = {
    "race_gain",
    "wake_ratio",
    "straightening_starboard",
    "straightening_port",
    "straightening_x",
}
"""Of KVLCC2 herself, so no test on her."""
BEYOND = 2.0
"""Tolerances beyond which an estimate counts as missed."""


@dataclass(frozen=True)
class Row:
    """An estimate beside the number that is known."""

    ship: str
    what: str
    unit: str
    known: float
    estimate: float
    tolerance: float

    @property
    def off(self) -> float:
        """Estimate less the known number, over its tolerance."""
        return (self.estimate - self.known) / self.tolerance


def described(name: str) -> Described:
    """A ship by her main particulars alone."""
    said = {"particulars": SHIPS[name], "thrusters": THRUSTERS.get(name, [SCREW])}
    said |= {"mass": {"centre_of_gravity_x": CENTRES.get(name, 0.0)}}
    return describe(f"{name}.toml", ShipFile.model_validate(said))


def rows() -> list[Row]:
    """All comparisons."""
    found = []
    for name in SHIPS:
        ship, known = described(name), read_ship(ROOT / "ssp" / "ships" / name)
        theirs = {key: entry.value for key, entry in known.entries["vessel"].items()}
        for key, (what, unit) in HULL.items():
            if theirs.get(key):
                found.append(_row(name, what, unit, theirs[key], ship.vessel[key]))
        speed, entry = ship.form.speed, ship.vessel["X_uu"]
        drag = -theirs.get("X_u", 0.0) * speed - theirs.get("X_uu", 0.0) * speed**2
        square = speed**2
        what = f"resistance at {speed:.2g} m/s"
        found.append(Row(name, what, "N", drag, -entry.value * square, entry.tolerance * square))
        found += _derivatives(name, ship, theirs)
    return [*found, *_propeller(), *_weather()]


def _row(ship, what, unit, known, entry):
    return Row(ship, what, unit, float(known), float(entry.value), entry.tolerance)


def _derivatives(name, ship, theirs):
    """Linear derivatives under way of KVLCC2, MMG's in N, N.m over u v and u r."""
    if name != "kvlcc2":
        return
    L, d, rho = 7.0, 0.455, 1000.0
    scale = 0.5 * rho * L * d
    yaw_by_u = (
        scale * L * theirs["mmg_Y_r"] - theirs["A11"]
    )  # Clarke's hold the Coriolis load of the added mass
    for key, unit, value in (
        ("Y_uv", "N.s2/m2", scale * theirs["mmg_Y_v"]),
        ("Y_ur", "N.s2/(m.rad)", yaw_by_u),
        ("N_uv", "N.s2/m", scale * L * theirs["mmg_N_v"]),
        ("N_ur", "N.s2/rad", scale * L**2 * theirs["mmg_N_r"]),
    ):
        yield _row(name, f"derivative {key}", unit, value, ship.vessel[key])


def _propeller():
    """Bollard thrust of R/V Gunnerus' azimuths at 203 rpm, propeller and rudder of KVLCC2."""
    unit = described("gunnerus-33m9").units[0]
    given = (
        read_ship(ROOT / "ssp" / "ships" / "gunnerus-33m9")
        .entries["port"]["thrust_polynomial"]
        .value
    )
    KT = parse(given)[0][1]
    thrust = KT * 1025.0 * (203.0 / 60.0) ** 2 * 1.9**4
    entry = unit.entries["thrust_max"]
    yield Row(
        "gunnerus-33m9",
        "bollard thrust at 203 rpm",
        "N",
        thrust,
        float(entry.value),
        entry.tolerance,
    )
    known = read_ship(ROOT / "ssp" / "ships" / "kvlcc2").entries["propeller"]
    (stern,) = described("kvlcc2").units
    for key in RUDDER:
        if key not in TAKEN:
            yield _row("kvlcc2", key, known[key].unit, known[key].value, stern.entries[key])


def _weather():
    """Largest loads of wind and waves of R/V Gunnerus, by estimated areas."""
    ship, known = (
        described("gunnerus-33m9"),
        read_ship(ROOT / "ssp" / "ships" / "gunnerus-33m9").entries["vessel"],
    )
    scale = ship.vessel["wind_load_scale"].tolerance
    tables = [np.array(parse(entries["wind_table"].value)) for entries in (known, ship.vessel)]
    for axis, unit in ((1, "N.s2/m2"), (2, "N.s2/m2"), (3, "N.s2/m")):
        theirs, ours = (np.abs(table[:, axis]).max() for table in tables)
        yield Row(
            "gunnerus-33m9",
            f"largest wind load {'XYN'[axis - 1]}",
            unit,
            theirs,
            ours,
            scale * ours,
        )
    tables = [np.array(parse(entries["drift_table"].value)) for entries in (known, ship.vessel)]
    for axis in (2, 3):
        theirs, ours = (np.abs(table[:, axis]).max() for table in tables)
        yield Row(
            "gunnerus-33m9", f"largest wave drift {'XY'[axis - 2]}", "N/m2", theirs, ours, ours
        )


def turning_circles(folder: Path) -> list[tuple[str, float, float, float, float]]:
    """Advance and tactical diameter of KVLCC2 by her particulars alone, measured and simulated, in lengths."""
    (open_system,) = make_systems(described("kvlcc2"), folder, [build_stale(ROOT)])
    system, found = read_system(open_system, fmus=[build_stale(ROOT)]), []
    for side, name, advance, diameter in (
        (1.0, "starboard", 3.25, 3.34),
        (-1.0, "port", 3.11, 3.08),
    ):
        at_start = {
            "vessel.u_start": 1.179,
            "propeller_rpm": 660.0,
            "propeller_azimuth": -35.0 * side,
        }
        run = sc.simulate(system, stop_time=120.0, step_size=0.05, set=at_start)
        turned = np.abs(np.unwrap(run["vessel.psi"].values))
        quarter, half = (int(np.argmax(turned >= angle)) for angle in (np.pi / 2, np.pi))
        ours = run["vessel.x"].values[quarter] / 7.0, side * run["vessel.y"].values[half] / 7.0
        found.append((name, advance, float(ours[0]), diameter, float(ours[1])))
    return found


def page(circles: list[tuple[str, float, float, float, float]]) -> str:
    """Text of the page."""
    compared = rows()
    missed = [row for row in compared if abs(row.off) > BEYOND]
    lines = [
        "# How far the estimates of a ship file are off",
        "",
        "Each ship is described by her main particulars alone: length, breadth, draught, displacement, service "
        "speed, and place, diameter and power of her thrusters. What formulae make of it stands beside what is known "
        "of her. *Off* counts in tolerances of the estimate (standard deviations).",
        "",
        "| ship | number | known | estimated | tolerance | off |",
        "|---|---|---|---|---|---|",
        *(
            f"| {r.ship} | {r.what} [{r.unit}] | {r.known:.3g} | {r.estimate:.3g} | {r.tolerance:.2g} | {r.off:+.1f} |"
            for r in compared
        ),
        "",
        f"Of {len(compared)} estimates {sum(abs(row.off) <= 1.0 for row in compared)} lie within one tolerance, "
        f"{len(compared) - len(missed)} within two. Beyond: "
        + "; ".join(f"{row.what} of {row.ship}" for row in missed)
        + ".",
        "",
        "The two models of R/V Gunnerus disagree among themselves: the longer hull has half the added mass in sway, "
        "and their resistances differ by a quarter. The numbers of Otter and BlueBoat are published models, not "
        "measurements; both boats run beyond Froude number 0.4, where the formulae of resistance end, and BlueBoat's "
        "authors call theirs a guess, twice that of the maker's top speed. `shipcosim check` says so of such a ship "
        "and asks for a point of the speed trial.",
        "",
        "## Turning circle of KVLCC2 at 35 deg, in lengths",
        "",
        "| to | advance, measured | estimated | tactical diameter, measured | estimated |",
        "|---|---|---|---|---|",
        *(f"| {n} | {a:.2f} | {b:.2f} | {c:.2f} | {d:.2f} |" for n, a, b, c, d in circles),
        "",
        "Measured: Yasukawa and Yoshimura 2015. Estimated: hull, propeller and rudder by her particulars alone.",
        "",
        "*Made by `python docs/generators/write_ship_estimates.py`.*",
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        PAGE.write_text(page(turning_circles(Path(folder))), encoding="utf-8")
