"""The page that runs a system: its code, its signals, and the scene that follows them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass, replace
from fractions import Fraction
from math import degrees
from typing import Any

from xarray import Dataset

from shipcosim.cosim.interactive import kinds_of, last_step, row_signals, start_values_of
from shipcosim.cosim.master.events import changes
from shipcosim.cosim.master.plan import Plan, label
from shipcosim.cosim.master.time_grid import time_grid_of
from shipcosim.cosim.webassembly import MOST_STEPS
from shipcosim.errors import error_at
from shipcosim.report.run.scene import Recipe, Run, make_run
from shipcosim.report.theme.packing import packed_bytes
from shipcosim.report.theme.pages import render as render_template
from shipcosim.report.theme.views import Fact, JsonObject, Outcome, Page, known_facts
from shipcosim.scenario import Scenario
from shipcosim.ssp import Signal, Variable

PREDICTED = {"north": "x", "east": "y", "heading": "psi", "radius": "position_region"}
"""Outputs of a predictor for each part of a predicted track, as in `interfaces.MotionPredictor`."""


@dataclass(frozen=True)
class LivePage(Page):
    """What the page of a running system shows.

    Attributes
    ----------
    code : str
        WebAssembly, compressed and in letters; empty where a server runs the system.
    others : sequence of LivePage
        The same for the system with other FMUs.
    labels : sequence of str
        What the reader chooses from, this page first; empty where there is nothing to choose.
    """

    code: str
    others: Sequence[LivePage] = ()
    labels: Sequence[str] = ()


def render(pages: Sequence[LivePage], labels: Sequence[str]) -> str:
    """HTML of a page that runs one of several systems, the first unless another one is chosen."""
    page = replace(pages[0], others=pages[1:], labels=labels)
    return render_template("live/templates/live.html.jinja", page)


def page_of(
    plan: Plan, code: bytes, table: Dataset, scenario: Scenario, written: Scenario
) -> LivePage:
    """The page of one system.

    Parameters
    ----------
    plan : Plan
        With a row for each input that the page may change.
    code : bytes
        The system as WebAssembly; empty where a server runs it.
    table : xarray.Dataset
        The first seconds of the run, from which the scene is made.
    scenario : Scenario
        With its values in the units of the signals.
    written : Scenario
        The same as its file says, for the scenario that the page saves.

    Raises
    ------
    ShipcosimError
        Nothing in the system has a position and a heading.
    """
    if not written.system:
        written = written.model_copy(update={"system": plan.system.name})
    run = make_run(table, goes_on=True)
    if run is None:
        raise error_at(
            plan.system.name,
            "Nothing in it has a position and a heading, so there is no ship to show.",
            "Run it with `shipcosim run`.",
        )
    return LivePage(
        title=written.description or f"Simulation of {plan.system.name}",
        facts=_facts(written),
        outcome=Outcome("", "", ""),
        data={
            "live": _description(plan, scenario, written) | {"server": not code},
            "scene": [_growing(run, plan)],
            "events": sorted({event.time for event in scenario.events}),
        },
        code=packed_bytes(code) if code else "",
    )


def _facts(written: Scenario) -> Sequence[Fact]:
    facts = {
        "Ship": ", ".join(written.parameters),
        "System": written.system,
        "Scenario": written.name,
        "Step size": f"{written.step_size:g} s",
    }
    return known_facts(facts)


def _growing(run: Run, plan: Plan) -> JsonObject:
    """The scene without rows: what its columns are made of, and which tracks are predicted."""
    scene = vars(run) | {"time": [], "columns": {}}
    outputs = {label(end) for end in plan.layouts["Real"].outputs}
    predicted = []
    for predictor in run.predicted:
        tracks: JsonObject = {key: predictor[key] for key in ("name", "horizons")}
        for part, connector in PREDICTED.items():
            tracks[part] = []
            for horizon in predictor["horizons"]:
                signal = f"{predictor['name']}.{connector}_{horizon}"
                column = f"{signal} {part}"
                if signal in outputs:
                    factor = degrees(1.0) if part == "heading" else 1.0
                    run.recipes[column] = Recipe(signal, factor)
                tracks[part].append(column if signal in outputs else None)
        made = f"{predictor['name']}.predicted_at"
        run.recipes[made] = Recipe(made)
        predicted.append(tracks | {"made": made})
    return scene | {
        "predicted": predicted,
        "recipes": {name: recipe._asdict() for name, recipe in run.recipes.items()},
    }


def _description(plan: Plan, scenario: Scenario, written: Scenario) -> JsonObject:
    """What the script needs to run the system and to write down what was done."""
    step = Fraction(repr(scenario.step_size))
    kinds = kinds_of(plan)
    grid = time_grid_of(scenario)
    happening = [
        [change.step, change.action, label(change.end), change.value]
        for change in changes(scenario, plan, grid)
    ]
    return {
        "step": [step.numerator, step.denominator],
        "steps_per_row": grid.steps_per_row,
        "most_steps": MOST_STEPS,
        "last_step": last_step(grid, scenario.step_size),
        "columns": [row_signals(plan, kind) for kind in kinds],
        "kinds": kinds,
        "signals": dict(_signals(plan)),
        "starts": [astuple(start) for start in start_values_of(plan)],
        "events": happening,
        "scenario": _header(written),
    }


def _header(written: Scenario) -> JsonObject:
    """Keys of the scenario's file, for the one that the page saves."""
    keys = ("description", "system", "parameters", "components", "step_size", "output_interval")
    header = {key: getattr(written, key) for key in keys}
    header["order"] = written.order if written.order != "jacobi" else ""
    return {key: value for key, value in header.items() if value} | {"set": written.set}


def _signals(plan: Plan) -> Iterator[tuple[str, JsonObject]]:
    """Every exchanged signal: place of its value, and description."""
    fed = plan.system.feeding
    # Of numbered switches of which some are fed, such as available_1 to 6, the others belong to no unit of this ship.
    numbered = {(component, name.rstrip("0123456789")) for component, name in fed}
    for number, kind in enumerate(kinds_of(plan)):
        layout = plan.layouts[kind]
        for side, ends in enumerate((layout.outputs, layout.inputs)):
            for row, end in enumerate(ends):
                about = _about(plan.variable(end), kind)
                # An input that a connection feeds follows it; the others are the user's.
                stem = end[0], end[1].rstrip("0123456789")
                free = side == 1 and end not in fed and (kind != "Boolean" or stem not in numbered)
                start = plan.system.components[end[0] or ""].start_value(end[1])
                place = {"x": number, "side": side, "row": row, "free": free, "start": start}
                yield label(end), about | place
        first = len(layout.outputs)
        for row, (end, start) in enumerate(layout.external.items(), start=first):
            if end[0] is None:
                signal = plan.system.inputs[end[1]]
                about = _about(signal, kind)
                place = {"x": number, "side": 2, "row": row, "free": True, "start": start}
                yield label(end), about | place


def _about(described: Variable | Signal, kind: str) -> dict[str, Any]:
    about: dict[str, Any] = {
        "kind": kind,
        "unit": described.unit or "",
        "text": described.description or "",
    }
    # A variable of an FMU may have bounds, an input of the system has none.
    for key, name in (("min", "minimum"), ("max", "maximum")):
        bound = getattr(described, name, None)
        if bound is not None:
            about[key] = bound
    return about
