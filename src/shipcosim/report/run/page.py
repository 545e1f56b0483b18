"""The page of a run: its contents, and functions that write or summarise it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from xarray import Dataset

from shipcosim.report.run.derived import add_derived
from shipcosim.report.run.details import details, parsed
from shipcosim.report.run.expectations import Judged, judged, outcome
from shipcosim.report.run.key_figures import key_figures
from shipcosim.report.run.moments import Moment, find_moments
from shipcosim.report.run.panels import Section, constants_as_words, make_sections
from shipcosim.report.run.predictions import make_predictions, summarise
from shipcosim.report.run.remarks import remarks
from shipcosim.report.run.roles import Roles, find_roles
from shipcosim.report.run.scene import Run, make_run
from shipcosim.report.theme import palette
from shipcosim.report.theme.display import display_table, is_constant, series_in, thinned
from shipcosim.report.theme.packing import most_rows, packed_series
from shipcosim.report.theme.pages import render as render_template
from shipcosim.report.theme.views import (
    Block,
    Fact,
    JsonObject,
    Outcome,
    Page,
    Table,
    known_facts,
)
from shipcosim.scenario import Scenario, Verdict
from shipcosim.series import write_file
from shipcosim.ssp import AnyPath, System

EXACT = 1e9  # steps of the time axis
BYTES_FOR_SIGNALS = 750_000  # of a page that shall stay below 1.5 MB


@dataclass(frozen=True)
class Thinned:
    """Number of drawn and of all rows, and rows that each drawn pair spans."""

    drawn: int
    rows: int
    span: int


@dataclass(frozen=True)
class RunPage(Page):
    """What the page of a run shows.

    Attributes
    ----------
    remarks : sequence of str
        What must not be overlooked.
    changed : sequence of str
        What the command line changed of what the files say.
    expectations : sequence of Judged
    key_figures : Table
    thinned : Thinned, optional
        Where not every row is drawn.
    sections : sequence of Section
        Panels over time.
    details : sequence of Block
        Tables to unfold.
    figures_title : str
        Heading of the key figures.
    changed_title : str
        What stands before `changed`.
    moments : sequence of Moment
        Buttons that lead there.
    """

    remarks: Sequence[str]
    expectations: Sequence[Judged]
    key_figures: Table
    thinned: Thinned | None
    sections: Sequence[Section]
    details: Sequence[Block]
    changed: Sequence[str] = ()
    figures_title: str = "Key figures"
    changed_title: str = "Changed for this run"
    moments: Sequence[Moment] = ()


class Digest(NamedTuple):
    """Summary of a page in words: verdict, remarks and expectations."""

    outcome: Outcome
    remarks: list[str]
    expectations: Sequence[Judged]


def write_report(
    table: Dataset,
    path: AnyPath,
    *,
    scenario: Scenario | None = None,
    verdicts: Sequence[Verdict] = (),
    system: System | None = None,
) -> None:
    """Write the page of a run.

    Parameters
    ----------
    table : xarray.Dataset
        A run of any system. What it shows follows from the names of its signals: a component with x, y and psi is a
        ship, one with a thrust and a shaft a thruster, and so on; the rest is there to choose from.
    path : path
        HTML file; it is there completely or not at all.
    scenario : Scenario, optional
        What happened.
    verdicts : sequence of Verdict
        What was expected of it.
    system : System, optional
        What was run.

    Raises
    ------
    ShipcosimError
        If the file cannot be written.
    """
    write_file(path, render(table, scenario=scenario, verdicts=verdicts, system=system).encode())


def render(
    table: Dataset,
    *,
    scenario: Scenario | None = None,
    verdicts: Sequence[Verdict] = (),
    system: System | None = None,
) -> str:
    """The page as HTML; arguments as for `write_report`."""
    return render_template("run/templates/run.html.jinja", _page(table, scenario, verdicts, system))


def digest(table: Dataset, verdicts: Sequence[Verdict] = ()) -> Digest:
    """Summarise a page in words, for a terminal.

    Parameters
    ----------
    table : xarray.Dataset
        A run.
    verdicts : sequence of Verdict
        What was expected of it.

    Returns
    -------
    Digest
    """
    roles, shown = shown_table(table, verdicts)
    return Digest(outcome(table, verdicts), remarks(table, shown, roles), judged(verdicts, shown))


def _page(
    table: Dataset, scenario: Scenario | None, verdicts: Sequence[Verdict], system: System | None
) -> RunPage:
    # Signals in the units of the page, and few enough rows to draw.
    roles, shown = shown_table(table, verdicts)
    drawn, thin = drawn_rows(shown)
    # Scene and panels draw the same run.
    run = make_run(table, verdicts)
    runs = () if run is None else (run,)
    sections = constants_as_words(make_sections(shown, roles, verdicts), shown)
    choice = [str(name) for name in table.data_vars if name in drawn]
    events = [event.time for event in scenario.events] if scenario else []
    expected = judged(verdicts, shown)
    moments = find_moments(verdicts, expected, scenario)
    data = drawn_data(drawn, choice, runs, sections, events)
    # The scene opens at the first moment after the start, else at the end of the run.
    start = float(table["time"].values[0]) if table.sizes["time"] else 0.0
    if later := [moment.time for moment in moments if moment.time > start]:
        data["opens_at"] = later[0]
    return RunPage(
        title=_title(scenario, system),
        facts=_facts(table, scenario),
        outcome=outcome(table, verdicts),
        data=data,
        remarks=tuple(remarks(table, shown, roles)),
        changed=tuple(parsed(table.attrs.get("changed", "[]"))),
        expectations=expected,
        key_figures=key_figures(shown, roles, summarise(make_predictions(table))),
        thinned=thin,
        sections=sections,
        details=details(table, scenario, system),
        moments=moments,
    )


def shown_table(table: Dataset, verdicts: Sequence[Verdict]) -> tuple[Roles, Dataset]:
    """Roles of the signals, and the table in the page's units with derived signals."""
    roles = find_roles(table.data_vars)
    return roles, add_derived(
        display_table(table, roles.signal(roles.ship, "psi")), table, roles, verdicts
    )


def _title(scenario: Scenario | None, system: System | None) -> str:
    if scenario is not None and (scenario.description or scenario.name):
        return scenario.description or scenario.name
    return f"Simulation of {system.name}" if system is not None and system.name else "Simulation"


def _facts(table: Dataset, scenario: Scenario | None) -> Sequence[Fact]:
    """What was run, for how long, with which step size and engine."""
    time = table["time"].values
    facts = {}
    if scenario is not None:
        facts["Ship"] = ", ".join(scenario.parameters)
        facts |= {"System": scenario.system, "Scenario": scenario.name}
    facts["Simulated"] = f"{time[-1] - time[0]:g} s" if len(time) else ""
    facts["Step size"] = f"{table.attrs['step_size']} s" if "step_size" in table.attrs else ""
    facts["Engine"] = str(table.attrs.get("engine", ""))
    return known_facts(facts)


def drawn_rows(shown: Dataset) -> tuple[Dataset, Thinned | None]:
    """The rows that fit on a page, and what was left out; None where every row is drawn."""
    # Constant signals need no space: only the others count.
    varying = [v.values for v in series_in(shown).values() if not is_constant(v.values)]
    drawn, span = thinned(shown, most_rows(varying, BYTES_FOR_SIGNALS))
    return drawn, Thinned(drawn.sizes["time"], shown.sizes["time"], span) if span > 1 else None


def drawn_data(
    drawn: Dataset,
    choice: Sequence[str],
    runs: Sequence[Run],
    sections: Sequence[Section],
    events: Iterable[float],
) -> JsonObject:
    """What the script of the page draws.

    Parameters
    ----------
    drawn : xarray.Dataset
        Signals in the page's units.
    choice : sequence of str
        Those to choose from.
    runs : sequence of Run
        The scene.
    sections : sequence of Section
        Panels over time.
    events : iterable of float
        When something happens. [s]

    Returns
    -------
    dict
    """
    return {
        "time": packed_series(drawn["time"].values, EXACT),
        "signals": {
            name: {
                "unit": v.attrs["units"],
                "label": v.attrs["long_name"],
                "values": float(v.values[0]) if is_constant(v.values) else packed_series(v.values),
            }
            for name, v in series_in(drawn).items()
        },
        "choice": list(choice),
        "scene": list(runs),
        "panels": [panel for section in sections for panel in section.panels],
        "events": sorted(set(events)),
        "colours": {"passed": palette.PASSED, "failed": palette.FAILED, "cycle": palette.CYCLE},
    }
