"""The page of a static DP capability: its contents, and the function that writes it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shipcosim.capability import Capability, notation
from shipcosim.capability.conditions import CONDITIONS, DIRECTIONS, DYNAMIC_FACTOR
from shipcosim.capability.result import LEVEL_1, SIMULATOR
from shipcosim.capability.sectors import sectors
from shipcosim.capability.thrust import BETA_MISC, ventilation
from shipcosim.report.capability.figures import capability_figures, limiting_condition, load_figures
from shipcosim.report.theme.numbers import plain
from shipcosim.report.theme.pages import render as render_template
from shipcosim.report.theme.views import (
    FigurePage,
    Figures,
    KeyFigure,
    Outcome,
    Table,
    known_facts,
)


@dataclass(frozen=True)
class CapabilityPage(FigurePage):
    """What the page of a capability shows.

    Attributes
    ----------
    plots, loads : sequence of Figure
        Polar plots, loads by direction.
    numbers, thrusters, conditions, particulars : Table
        Of each direction; of each thruster; the weather; what was read from the ship's files.
    simulated : str
        A, B, C, D by the simulator's models.
    assumed, total : int
        How many particulars are assumed, of how many.
    """

    plots: Figures
    loads: Figures
    numbers: Table
    thrusters: Table
    conditions: Table
    particulars: Table
    simulated: str
    assumed: int
    total: int


def render(capability: Capability) -> str:
    """The page of a capability as HTML."""
    return render_template("capability/templates/capability.html.jinja", page_of(capability))


def page_of(capability: Capability) -> CapabilityPage:
    """Contents of the page of a capability."""
    # Figures in the order in which the page draws them.
    plots = capability_figures(capability)
    loads = load_figures(capability)
    vessel = capability.vessel
    figures = (*plots, *loads)
    # Neutral particulars change nothing and are left out.
    stated = [
        (file, quantity)
        for file, quantities in vessel.particulars.items()
        for quantity in quantities.values()
        if quantity.origin != "neutral"
    ]
    facts = {
        "Ship": vessel.description or vessel.name,
        "System": vessel.system,
        "Dynamic factor": f"{DYNAMIC_FACTOR:g}",
    }
    rows = [
        (file, p.description, f"{p.value} {p.unit if p.unit != '1' else ''}".strip(), p.origin)
        for file, p in stated
    ]
    particulars = Table(rows, ("file", "what", "value", "from"))
    return CapabilityPage(
        title=f"Static DP capability of {vessel.name}",
        facts=known_facts(facts),
        outcome=_outcome(capability),
        key_figures=_key_figures(capability),
        plots=plots,
        loads=loads,
        figures=figures,
        numbers=_numbers(capability),
        thrusters=_thrusters(capability),
        conditions=_conditions(),
        particulars=particulars,
        simulated=", ".join(map(str, capability.elements(SIMULATOR))),
        assumed=sum("assumed" in parameter.origin for _, parameter in stated),
        total=len(stated),
    )


def _outcome(capability: Capability) -> Outcome:
    # Letters A to D of the notation, in words.
    a, b, c, d = capability.elements()
    intact = f"With all thrusters she keeps position and heading {_weather(a)} from within 30° of the bow"
    failed = f"After the worst single failure{_always_worst(capability)} it is number {c} from ahead and {d} from anywhere"
    # A failure may take several thrusters: tell the loss of one apart.
    if any(len(case.failed) > 1 for case in capability.cases):
        *_, c, d = capability.elements(most_lost=1)
        failed += f"; where only one thruster is lost, {c} and {d}"
    return Outcome(
        "named", notation(capability), f"{intact}, and {_weather(b)} from anywhere. {failed}."
    )


def _always_worst(capability: Capability) -> str:
    """Name of the failure that is worst in every direction, between commas; else empty."""
    # A case that equals the envelope of all failures everywhere.
    same = (capability.numbers() == capability.worst()).all(axis=1)
    return next(
        (
            f", {case.name},"
            for case, is_worst in zip(capability.cases, same, strict=True)
            if is_worst
        ),
        "",
    )


def _weather(number: int) -> str:
    """Meaning of a DP capability number."""
    if number == 0:
        return "in less than condition 1"
    condition = CONDITIONS[number - 1]
    return f"up to condition {number} ({condition.wind_speed:g} m/s of wind, Hs {condition.wave_height:g} m)"


def _key_figures(capability: Capability) -> Sequence[KeyFigure]:
    meanings = (
        "A: intact, weather within 30° of the bow",
        "B: intact, weather from anywhere",
        "C: worst single failure, within 30° of the bow",
        "D: worst single failure, from anywhere",
    )
    return [
        KeyFigure(str(n), text) for n, text in zip(capability.elements(), meanings, strict=True)
    ]


def _numbers(capability: Capability) -> Table:
    """A row for each direction: wind of the intact ship, numbers of each case and method."""
    # Columns: each case by Level 1, its worst failure, then the simulator.
    level_1 = capability.numbers(LEVEL_1)
    simulator = capability.numbers(SIMULATOR)
    columns = [*level_1, capability.worst(LEVEL_1), simulator[0], capability.worst(SIMULATOR)]
    names = [
        *(case.name for case in capability.cases),
        "worst failure",
        "simulator, intact",
        "simulator, worst failure",
    ]
    # Wind speed of the highest condition that the intact ship holds.
    speeds = (0.0, *(condition.wind_speed for condition in CONDITIONS))
    rows = [
        (
            f"{np.degrees(angle):.0f}°",
            f"{speeds[level_1[0][k]]:g} m/s",
            *(str(int(column[k])) for column in columns),
        )
        for k, angle in enumerate(DIRECTIONS)
    ]
    return Table(rows, ("weather from", "wind, intact", *names))


def _thrusters(capability: Capability) -> Table:
    """Thrust by Level 1, nominal and at the limit, and limits in the simulator."""
    limits = capability.vessel.simulated.limits
    hull = capability.vessel.hull
    condition = limiting_condition(capability)
    rows = []
    # Effective thrust in the limiting condition: losses and ventilation by direction.
    for thruster in capability.vessel.thrusters:
        limit = limits[thruster.name]
        left = BETA_MISC * ventilation(thruster, hull, condition, DIRECTIONS) * thruster.ahead / 1e3
        ends = (plain(left.min()), plain(left.max()))
        # Directions in which a thruster must not push, since its race would hit another that works.
        narrowed = sectors(thruster, capability.vessel.thrusters, ())
        forbidden = (
            ", ".join(
                f"{np.degrees(s.middle) % 360:.0f}° ± {np.degrees(s.half):.0f}°" for s in narrowed
            )
            or "–"
        )
        rows.append(
            (
                thruster.name,
                f"{thruster.kind}{', ducted' if thruster.ducted else ''}",
                f"{thruster.diameter:g} m, {thruster.power / 1000:g} kW",
                f"{thruster.x:g}, {thruster.y:g} m",
                f"{plain(thruster.ahead / 1e3)} kN",
                f"{' to '.join(dict.fromkeys(ends))} kN",
                f"{plain(limit.ahead / 1e3)} kN",
                forbidden,
            )
        )
    effective = f"thrust in condition {condition.number}"
    head = (
        "thruster",
        "kind",
        "propeller",
        "forward, starboard",
        "nominal thrust",
        effective,
        "simulator's",
        "forbidden",
    )
    return Table(rows, head)


def _conditions() -> Table:
    rows = [
        (
            str(c.number),
            f"{c.wind_speed:g} m/s",
            f"{c.wave_height:g} m",
            f"{c.wave_period:g} s",
            f"{c.current_speed:g} m/s",
        )
        for c in CONDITIONS
    ]
    return Table(rows, ("number", "wind", "Hs", "Tp", "current"))
