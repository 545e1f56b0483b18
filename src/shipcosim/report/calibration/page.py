"""The page of a calibration: what moved, the error before and after, and what the logs could not tell."""

from collections.abc import Sequence

from shipcosim.diagnose.calibration_pipeline import CalibratedShip
from shipcosim.report.calibration.words import (
    errors_by_log,
    log_rows,
    moved,
    moved_rows,
    outcome,
)
from shipcosim.report.diagnosis.by_log import error_table
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import rounded, shade
from shipcosim.report.theme.numbers import metres, signed
from shipcosim.report.theme.pages import render as render_template
from shipcosim.report.theme.views import (
    Figure,
    FigurePage,
    KeyFigure,
    Table,
    known_facts,
)

_ROW = 22  # px, of a number in the figure


def render(ship: CalibratedShip) -> str:
    """The page of a calibration as HTML."""
    reference = ship.reference
    scale = reference.tolerance_scale
    facts = {
        "System": reference.system,
        "Logs": ", ".join(log.name for log in ship.logs),
        "Tolerances": "as stated" if scale == 1.0 else f"{scale:g} times as stated",
    }
    page = FigurePage(
        title=f"Calibration of {reference.system}",
        facts=known_facts(facts),
        outcome=outcome(ship),
        key_figures=_key_figures(ship),
        figures=(_moved_figure(ship),),
    )
    return render_template(
        "calibration/templates/calibration.html.jinja",
        page,
        refusals=ship.refusals,
        remarks=ship.remarks,
        numbers=Table(moved_rows(ship), ("Number", "System", "By the logs", "Tolerances")),
        errors=error_table(errors_by_log(ship), "calibrated"),
        logs=Table(
            log_rows(ship), ("Log", "Faults, repaired", "Weather fitted", "Unmodelled errors left")
        ),
        untold=", ".join(number.name for number in ship.untold),
    )


def _key_figures(ship: CalibratedShip) -> Sequence[KeyFigure]:
    errors = errors_by_log(ship).values()
    most = max(ship.reference.numbers, key=lambda number: abs(moved(number)))
    figures = [
        KeyFigure(
            signed(moved(most)),
            f"tolerances: most that a number moved, {most.name}",
        )
    ]
    if errors:
        worst = max(errors, key=lambda log: log.position["after"][-1])
        by = "by the other logs" if worst.fitted_on else "by the first part of the log"
        after = f"position error after {worst.horizon[-1]:.2g} s"
        figures += [
            KeyFigure(metres(worst.position["before"][-1]), f"{after}, as the system is"),
            KeyFigure(
                metres(worst.position["after"][-1]),
                f"the same, calibrated {by}: the error that remains",
            ),
            KeyFigure(metres(worst.position["floor"][-1]), "the same, with this log fitted too"),
        ]
    return figures


def _moved_figure(ship: CalibratedShip) -> Figure:
    """How far each number is from that of the system, in tolerances, with its standard deviation before and after."""
    ranked = sorted(ship.reference.numbers, key=lambda number: abs(moved(number)))
    names = [number.name for number in ranked]
    at = [moved(number) for number in ranked]
    spread = rounded([number.std / number.tolerance for number in ranked], 3)
    look = {"color": palette.BLUE, "thickness": 1.5, "width": 0}
    dots = {
        "type": "scatter",
        "mode": "markers",
        "name": "by the logs",
        "x": rounded(at, 3),
        "y": names,
        "marker": {"color": palette.BLUE, "size": 8},
        "error_x": {"type": "data", "array": spread} | look,
        "hovertemplate": "%{x:.2f} ± %{error_x.array:.2f} tolerances",
    }
    layout = {
        "shapes": [shade(palette.BAND, x=(-1, 1))],
        "xaxis": {"title": {"text": "tolerances"}, "zeroline": True},
        "yaxis": {"automargin": True, "tickfont": {"size": 12}, "dtick": 1},
        "hovermode": "closest",
        "showlegend": False,
    }
    note = "Dot and line: estimate and standard deviation on another day. Shaded: the tolerance that the system states."
    height = 90 + _ROW * len(names)
    return Figure("What moved", "tolerances", (dots,), layout, note, height)
