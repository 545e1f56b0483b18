"""The page of a run: one HTML file with plotly.js inside, which opens anywhere and needs no network."""

import base64
import json
from dataclasses import asdict
from html import escape
from importlib.resources import files
from string import Template

import numpy as np

import shipcosim
from shipcosim.report.run import summary
from shipcosim.report.run.derived import add_derived
from shipcosim.report.run.panels import make_sections
from shipcosim.report.run.roles import find_roles
from shipcosim.report.run.track import ship_size, track_figure
from shipcosim.report.theme import palette, parts
from shipcosim.report.theme.display import display_table, is_constant, thinned
from shipcosim.series import write_file


def write_report(table, path, *, scenario=None, verdicts=(), system=None):
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


def render(table, *, scenario=None, verdicts=(), system=None):
    """The page as text; arguments as for `write_report`."""
    roles = find_roles(table.data_vars)
    shown = add_derived(display_table(table, roles), table, roles, verdicts)
    drawn, span = thinned(shown)
    track = track_figure(drawn, roles, verdicts, ship_size(table, roles))
    sections = make_sections(shown, roles, verdicts)
    return Template(_asset("template.html")).substitute(
        title=escape(parts.title_of(scenario, system)),
        css=_asset("page.css"),
        header=parts.header(table, scenario, system, summary.outcome(table, verdicts)),
        remarks=parts.remarks(summary.remarks(table, shown, roles)),
        navigation=parts.navigation(sections, track is not None),
        chart=parts.chart(track is not None),
        weather=parts.weather(summary.weather(shown, roles)),
        figures=parts.key_figures(summary.key_figures(shown, roles)),
        expectations=parts.expectations(summary.judged(verdicts, shown)),
        sections=parts.sections(sections),
        thinning=parts.thinning(span, shown.sizes["time"], drawn.sizes["time"]),
        details=parts.details(summary.details(table, system), scenario),
        version=shipcosim.__version__,
        plotly=_plotly(),
        data=_embedded(_payload(drawn, table, track, sections, scenario)),
        script=_asset("page.js"),
    )


def digest(table, verdicts=()):
    """What a page says in words, for those who do not open it.

    Parameters
    ----------
    table : xarray.Dataset
        A run.
    verdicts : sequence of Verdict
        What was expected of it.

    Returns
    -------
    (Outcome, list of str, list of tuple)
        Verdict on the run, what must not be overlooked, and the expectations as `summary.judged` gives them.
    """
    roles = find_roles(table.data_vars)
    shown = add_derived(display_table(table, roles), table, roles, verdicts)
    return summary.outcome(table, verdicts), summary.remarks(table, shown, roles), summary.judged(verdicts, shown)


def _payload(drawn, table, track, sections, scenario):
    """What the page's script draws."""
    return {
        "time": _packed(drawn["time"].values, "float64"),
        "signals": {
            str(name): {
                "unit": v.attrs["units"],
                "label": v.attrs["long_name"],
                "values": float(v.values[0]) if is_constant(v.values) else _packed(v.values, "float32"),
            }
            for name, v in drawn.data_vars.items()
        },
        "choice": [str(name) for name in table.data_vars if name in drawn],
        "track": track,
        "panels": [asdict(panel) for section in sections for panel in section.panels],
        "events": sorted({event.time for event in scenario.events}) if scenario else [],
        "colours": {"passed": palette.PASSED, "failed": palette.FAILED, "cycle": palette.CYCLE, "ink": palette.INK},
    }


def _packed(values, kind):
    """Numbers as base64 of little-endian bytes: a third of the size of text."""
    with np.errstate(over="ignore"):  # a run that diverged: what float32 cannot hold becomes a gap
        packed = np.asarray(values).astype(np.dtype(kind).newbyteorder("<"))
    return base64.b64encode(packed.tobytes()).decode()


def _embedded(payload):
    """JSON that cannot end the script it stands in."""
    return json.dumps(payload, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def _plotly():
    return files("plotly").joinpath("package_data/plotly.min.js").read_text(encoding="utf-8")


def _asset(name):
    return files("shipcosim.report.run").joinpath(name).read_text(encoding="utf-8")
