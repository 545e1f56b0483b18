"""Figures of the capability: polar plots, bow up, and the loads by direction."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from shipcosim.capability import Capability
from shipcosim.capability.conditions import CONDITIONS, DIRECTIONS, DYNAMIC_FACTOR, Condition
from shipcosim.capability.loads import level_1_parts
from shipcosim.capability.result import LEVEL_1, SIMULATOR
from shipcosim.capability.simulator import simulated_parts
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import line, polar_axes, polar_curve
from shipcosim.report.theme.views import Figure, Figures, PlotlyDict

TALL = 400
"""Height of a polar plot. [px]"""

SOURCES = {"wind": palette.SKY, "current": palette.ORANGE, "waves": palette.GREEN}


def capability_figures(capability: Capability) -> Figures:
    """Polar plots: Level 1, and Level 1 with the simulator."""
    # Intact, and the worst loss of one thruster, by both methods.
    numbers = {method: capability.numbers(method) for method in (LEVEL_1, SIMULATOR)}
    single = {method: capability.worst(method, most_lost=1) for method in (LEVEL_1, SIMULATOR)}
    # Level 1 alone is the standard's answer.
    level_1 = (
        _curve("intact", numbers[LEVEL_1][0], palette.BLUE, fill=0.18),
        _curve("worst loss of one thruster", single[LEVEL_1], palette.ORANGE, fill=0.3),
        _curve("worst single failure", capability.worst(), palette.VERMILLION, dash="dot"),
    )
    # Compare both methods with the same conditions and dynamic factor.
    comparison = (
        _curve("Level 1, intact", numbers[LEVEL_1][0], palette.BLUE),
        _curve("Level 1, one thruster lost", single[LEVEL_1], palette.BLUE, dash="dot"),
        _curve("simulator, intact", numbers[SIMULATOR][0], palette.PURPLE),
        _curve("simulator, one thruster lost", single[SIMULATOR], palette.PURPLE, dash="dot"),
    )
    note = "DP capability number over the direction that the weather comes from; bow up, 90° from starboard."
    other = "The same conditions and dynamic factor; loads and thrust as the simulator has them."
    return (
        _polar("Level 1: intact, and after the worst single failure", level_1, note),
        _polar("Level 1 beside the simulator's own models", comparison, other),
    )


def limiting_condition(capability: Capability) -> Condition:
    """Hardest condition that the intact ship holds from everywhere, at least the first."""
    return CONDITIONS[max(capability.elements()[1], 1) - 1]


def load_figures(capability: Capability) -> Figures:
    """Sway force and yaw moment by source and method, at the limit of the intact ship."""
    # At the limit the loads are as large as the thrust.
    condition = limiting_condition(capability)
    vessel = capability.vessel
    # Loads of each source by direction.
    parts = {
        LEVEL_1: level_1_parts(vessel.hull, condition, DIRECTIONS),
        SIMULATOR: simulated_parts(vessel.simulated, condition, DIRECTIONS),
    }
    note = f"Condition {condition.number}, dynamic factor {DYNAMIC_FACTOR:g} included. Solid: Level 1, dotted: simulator."
    axes = {"Force to starboard": ("kN", 1, 1e3), "Yaw moment, bow to starboard": ("kN m", 2, 1e3)}
    return tuple(
        Figure(
            title,
            unit,
            [
                trace
                for method, loads in parts.items()
                for trace in _lines(loads, axis, size, method == LEVEL_1)
            ],
            {"xaxis": {"dtick": 45, "ticksuffix": "°", "range": [0, 350]}},
            note,
        )
        for title, (unit, axis, size) in axes.items()
    )


def _lines(loads: dict[str, NDArray], axis: int, size: float, is_level_1: bool) -> list[PlotlyDict]:
    # Dynamic factor included, as in the balance of forces.
    angles = np.degrees(DIRECTIONS)
    factor = DYNAMIC_FACTOR / size
    dash = "solid" if is_level_1 else "dot"
    more = {"showlegend": is_level_1, "hovertemplate": "%{y:.3~g}"}
    word = "" if is_level_1 else ", simulator"
    # Curves of each source, and their sum.
    curves = [(name, part, SOURCES[name], 1.5) for name, part in loads.items()]
    curves.append(("sum", sum(loads.values(), np.zeros((len(angles), 3))), palette.INK, 2.5))
    return [
        line(
            f"{name}{word}", angles, factor * part[:, axis], colour, width=width, dash=dash, **more
        )
        for name, part, colour, width in curves
    ]


def _curve(
    name: str, numbers: NDArray, colour: str, *, dash: str = "solid", fill: float | None = None
) -> PlotlyDict:
    """A closed curve of capability numbers around the ship."""
    # Repeat the first direction at 360 deg to close the curve.
    angles = np.degrees(DIRECTIONS)
    values = np.asarray(numbers, float)
    return polar_curve(name, [*angles, 360.0], [*values, values[0]], colour, dash=dash, fill=fill)


def _polar(title: str, traces: Sequence[PlotlyDict], note: str) -> Figure:
    axes = polar_axes(range=[0, 11], tickvals=[2, 4, 6, 8, 10])
    return Figure(title, "", traces, {"polar": axes}, note, TALL)
