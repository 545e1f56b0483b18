"""Writes docs/generated/sensitivity.md and its pictures: what the doubtful numbers of the ship do to the scenarios.

Run `python docs/generators/validation/sensitivity.py` (some minutes) after the controller, a scenario or an uncertainty
of a number in ssp/ships has changed. Needs matplotlib. Which numbers are doubtful, and within what, the ship's files
say (`uncertainty`).
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from math import hypot
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from common import MODEL, REFERENCE, SHIPS, THIRD, from_generated, save, table

from shipcosim.angles import wrap
from shipcosim.cosim import simulate
from shipcosim.library import build_stale
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.propulsion.azimuth import AzimuthParameters
from shipcosim.models.propulsion.tunnel import TunnelParameters
from shipcosim.models.ship.hull import HullParameters, hull_loads
from shipcosim.models.ship.vessel import DriftParameters
from shipcosim.scenario import read_scenario
from shipcosim.ships import read_ship
from shipcosim.ssp import read_system

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
PAGE = ROOT / "docs" / "generated" / "sensitivity.md"
SHIP = read_ship(SHIPS / "gunnerus-33m9")
COMPONENTS = {
    "vessel": (HullParameters, WindParameters, DriftParameters),
    "port": (AzimuthParameters,),
    "starboard": (AzimuthParameters,),
    "tunnel": (TunnelParameters,),
}
THRUSTERS = ("port", "starboard", "tunnel")
SCENARIOS = ("four_corner_rough", "current_turn", "drift")
LOST = 300.0  # s, when the drift scenario loses its power
SETTLED = 200.0  # s, before that the controllers of all scenarios settle
CROSS_FLOW = (0.6, 1.0, 1.5)
COLOURS = dict(zip(SCENARIOS, (MODEL, REFERENCE, THIRD), strict=True))


@dataclass(frozen=True)
class Doubt:
    """A number that sources disagree on.

    Attributes
    ----------
    name : str
        Of the parameter.
    places : tuple of str
        Components that have it.
    value : float
        In the model.
    ends : tuple of float
        The other values among its sources: one or two.
    unit, description, origin : str
    """

    name: str
    places: tuple[str, ...]
    value: float
    ends: tuple[float, ...]
    unit: str
    description: str
    origin: str

    def settings(self, value: float) -> dict[str, float]:
        """Start values with which it has another value."""
        return {f"{place}.{self.name}": value for place in self.places}

    def __str__(self):
        place = "azimuths" if len(self.places) == 2 else self.places[0]
        return f"`{self.name}` of the {place}"


def doubts() -> list[Doubt]:
    """The doubtful numbers of the ship, in the order of her files."""
    found: dict[str, Doubt] = {}
    for component, quantities in SHIP.parameter_set(COMPONENTS).items():
        for name, q in quantities.items():
            if q.uncertainty:
                places = (*found[name].places, component) if name in found else (component,)
                ends = tuple(end for end in q.uncertainty if end != q.value)
                found[name] = Doubt(name, places, q.value, ends, q.unit, q.description, q.origin)
    return list(found.values())


def run(
    scenario: str, settings: dict[str, Any], stop_time: float | None = None
) -> dict[str, float]:
    """What a scenario shows with other start values.

    Parameters
    ----------
    scenario : str
        Name of its file.
    settings : dict
        Start values over the scenario's.
    stop_time : float, optional
        Ends it earlier, without its expectations. [s]

    Returns
    -------
    dict of str to float
        ``footprint``, ``error`` [m], ``heading`` [deg] and ``power`` [kW] while the ship is held, ``drift`` [m] where
        she loses her power.
    """
    what = read_scenario(ROOT / "scenarios" / f"{scenario}.toml")
    changed: dict[str, Any] = {"set": what.set | settings}
    if stop_time is not None:
        events = [event for event in what.events if event.time < stop_time]
        changed |= {"stop_time": stop_time, "expect": [], "events": events}
    what = what.model_copy(update=changed)
    system = read_system(what.system_path, what.parameter_paths, fmus=[build_stale(ROOT)])
    return figures(simulate(system, what), scenario == "drift")


def figures(result: Any, drifts: bool) -> dict[str, float]:
    """`run` of a table of results."""
    time = result["time"].values
    held = time >= min(SETTLED, 0.5 * time[-1])
    if drifts:
        held &= time <= LOST
    x, y, psi = (result[f"vessel.{name}"].values for name in ("x", "y", "psi"))
    off = np.hypot(x - result["reference.x_d"].values, y - result["reference.y_d"].values)[held]
    turned = np.degrees(np.abs(wrap(psi - result["reference.psi_d"].values)))[held]
    power = sum(result[f"{name}.power"].values for name in THRUSTERS)[held]
    found = {"footprint": np.quantile(off, 0.95), "error": np.max(off), "heading": np.max(turned)}
    found["power"] = np.mean(power) / 1e3
    if drifts and time[-1] > LOST:
        start = int(np.searchsorted(time, LOST))
        found["drift"] = hypot(x[-1] - x[start], y[-1] - y[start])
    return {name: float(value) for name, value in found.items()}


def numbers(
    scenarios: tuple[str, ...] = SCENARIOS,
    stop_time: float | None = None,
    doubtful: list | None = None,
) -> dict:
    """All runs: by (name of the change, its value) and scenario what `run` gives.

    Parameters
    ----------
    scenarios : tuple of str
        Names.
    stop_time : float, optional
        As of `run`. [s]
    doubtful : list of Doubt, optional
        All if not given.

    Returns
    -------
    dict of dict of dict
    """
    cases: dict[tuple[str, float], dict[str, Any]] = {("as it is", 0.0): {}}
    for doubt in doubts() if doubtful is None else doubtful:
        values = CROSS_FLOW[:-1] if doubt.name == "cross_flow_drag" else doubt.ends
        cases |= {(doubt.name, value): doubt.settings(value) for value in values}
    cases["another seed", 0.0] = {"environment.seed": 11, "sensors.seed": 12}
    found = {}
    for case, settings in cases.items():
        print(*case, "...", flush=True)
        found[case] = {scenario: run(scenario, settings, stop_time) for scenario in scenarios}
    return found


def page(found: dict) -> str:
    """The page of `numbers`."""
    load = -hull_loads(0.0, 0.5, 0.0, hull=SHIP.parameters(HullParameters, "vessel"))[1] / 1e3
    plain, low = found["as it is", 0.0], found["cross_flow_drag", 0.6]
    text = from_generated((HERE / "sensitivity.md").read_text(encoding="utf-8"))
    return text.format(
        doubts=table(
            ["number", "model", "sources", "unit", "where from"], rows_of_doubts()
        ).replace("--:|\n", ":--|\n", 1),
        scenarios="\n\n".join(_table_of(name, found) for name in SCENARIOS),
        load=load,
        load_low=load * 0.6 / 1.5,
        plain=plain,
        low=low,
        drift_change=100.0 * (low["drift"]["drift"] / plain["drift"]["drift"] - 1.0),
        power_change=100.0 * (low["current_turn"]["power"] / plain["current_turn"]["power"] - 1.0),
        step_time=SETTLED,
        footprint_change=100.0
        * (low["current_turn"]["footprint"] / plain["current_turn"]["footprint"] - 1.0),
        **{f"other_{key}": _largest_change(found, key) for key in ("footprint", "power", "drift")},
    )


def _largest_change(found, key):
    """Largest change of a figure in any scenario by a number other than the cross flow's coefficient. [%]"""
    plain = found["as it is", 0.0]
    others = [
        results
        for (name, _), results in found.items()
        if name not in ("cross_flow_drag", "another seed")
    ]
    pairs = [
        (results[s][key], plain[s][key]) for results in others for s in SCENARIOS if key in plain[s]
    ]
    return max(100.0 * abs(value / before - 1.0) for value, before in pairs)


def rows_of_doubts() -> Iterator[list[str]]:
    """Rows of the table of doubtful numbers."""
    for doubt in doubts():
        low, high = min(doubt.value, *doubt.ends), max(doubt.value, *doubt.ends)
        unit = "-" if doubt.unit == "1" else doubt.unit
        yield [
            f"{doubt}: {doubt.description}",
            f"{doubt.value:g}",
            f"{low:g} to {high:g}",
            unit,
            doubt.origin,
        ]


def _table_of(scenario, found):
    """Table of one scenario, a row for each change."""
    keys = {
        "footprint": "footprint [m]",
        "error": "largest error [m]",
        "heading": "largest heading error [deg]",
    }
    keys |= {"power": "mean power [kW]"} | (
        {"drift": "drift in 600 s [m]"} if scenario == "drift" else {}
    )
    rows = []
    for (name, value), results in found.items():
        label = name if name in ("as it is", "another seed") else f"`{name}` {value:g}"
        rows.append(
            [
                label,
                *(
                    f"{results[scenario][key]:.{1 if key in ('power', 'drift') else 2}f}"
                    for key in keys
                ),
            ]
        )
    return f"**{scenario}**\n\n{table(['', *keys.values()], rows)}"


def draw(found: dict) -> None:
    """The two pictures of `numbers`."""
    _draw_cross_flow(found)
    _draw_all(found)


def _draw_cross_flow(found):
    panels = {
        "footprint": "footprint [m]",
        "error": "largest error [m]",
        "power": "mean power [kW]",
    }
    figure, axes = plt.subplots(1, 4, figsize=(8.4, 2.8))
    for scenario, colour in COLOURS.items():
        results = [
            found[("cross_flow_drag", c) if c != 1.5 else ("as it is", 0.0)][scenario]
            for c in CROSS_FLOW
        ]
        for axis, (key, name) in zip(axes[:3], panels.items(), strict=True):
            axis.plot(
                CROSS_FLOW,
                [result[key] for result in results],
                "o-",
                ms=3,
                color=colour,
                label=scenario,
            )
            axis.set(title=name)
        if scenario == "drift":
            axes[3].plot(
                CROSS_FLOW, [result["drift"] for result in results], "o-", ms=3, color=colour
            )
    axes[3].set(title="drift in 600 s [m]")
    for axis in axes:
        axis.margins(y=0.1)
        axis.set(xlabel="cross-flow coefficient", xticks=CROSS_FLOW)
        axis.set_ylim(bottom=0.0)
        axis.title.set_fontsize(9)
    axes[0].legend(fontsize=7)
    save(figure, "sensitivity_cross_flow")


def _draw_all(found):
    """Change of each figure by each number at the ends of its uncertainty, in per cent."""
    panels = {"footprint": "footprint", "error": "largest error", "power": "mean power"}
    kept = [case for case in found if case[0] != "as it is" and case != ("cross_flow_drag", 1.0)]
    figure, axes = plt.subplots(1, 3, figsize=(8.4, 0.32 * len(kept) + 1.2), sharey=True)
    height = 0.8 / len(SCENARIOS)
    for axis, (key, name) in zip(axes, panels.items(), strict=True):
        for place, (scenario, colour) in enumerate(COLOURS.items()):
            changes = [
                100.0 * (found[c][scenario][key] / found["as it is", 0.0][scenario][key] - 1.0)
                for c in kept
            ]
            at = np.arange(len(kept)) + (place - 1.0) * height
            axis.barh(at, changes, height, color=colour, label=scenario)
        axis.axvline(0.0, color="#444444", lw=0.8)
        axis.set_axisbelow(True)
        axis.set(title=f"{name}, change [%]", yticks=range(len(kept)))
        axis.title.set_fontsize(9)
    axes[0].set_yticklabels(
        [name if name == "another seed" else f"{name} {value:g}" for name, value in kept]
    )
    axes[0].invert_yaxis()
    axes[2].legend(fontsize=7)
    save(figure, "sensitivity")


def main() -> int:
    """Write the page and its pictures."""
    found = numbers()
    draw(found)
    PAGE.write_text(page(found), encoding="utf-8")
    print("docs/generated/sensitivity.md and its pictures are written.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
