"""The page of sea trials: tracks, features before and after, causes, and what would tell them apart."""

from collections.abc import Sequence
from dataclasses import dataclass

from shipcosim.diagnose.sea_trials.study import SeaTrialStudy, motions_of
from shipcosim.report.sea_trials.figures import track_figure
from shipcosim.report.sea_trials.words import (
    features_table,
    held_out_table,
    next_steps,
    outcome,
    separation_table,
    sets_table,
    trials,
)
from shipcosim.report.theme.pages import render as render_template
from shipcosim.report.theme.views import (
    FigurePage,
    KeyFigure,
    Table,
    facts_of,
    links_of,
)

SECTIONS = {
    "tracks": "Tracks",
    "features": "Features",
    "causes": "Causes",
    "judged": "Judged on what was not fitted",
    "next": "What to sail next",
}
KEY_FEATURES = {
    "speed": "steady speed",
    "rate": "steady rate of turn",
    "t90": "time to 90° of heading",
}


@dataclass(frozen=True)
class SeaTrialPage(FigurePage):
    """What the page of sea trials shows.

    Attributes
    ----------
    sets, held_out, features, separations : Table
    steps : sequence of str
        What to sail next.
    """

    sets: Table
    held_out: Table
    features: Table
    separations: Table
    steps: Sequence[str]


def render(study: SeaTrialStudy, facts: dict[str, str]) -> str:
    """The page of sea trials as HTML; `facts` are shown below its title."""
    return render_template("sea_trials/templates/sea_trials.html.jinja", _page(study, facts))


def _page(study: SeaTrialStudy, facts: dict[str, str]) -> SeaTrialPage:
    circles = any(trial.kind == "turning circle" for trial in study.trials)
    tracks = (track_figure(study, *motions_of(study)),) if circles else ()
    facts = facts | {"Trials": trials(study)}
    there = {"tracks": circles, "judged": bool(study.held_out), "next": bool(study.separations)}
    return SeaTrialPage(
        title="Sea trials",
        facts=facts_of(facts),
        outcome=outcome(study),
        links=links_of(SECTIONS, there),
        key_figures=_key_figures(study),
        figures=tracks,
        sets=sets_table(study),
        held_out=held_out_table(study),
        features=features_table(study),
        separations=separation_table(study),
        steps=next_steps(study),
    )


def _key_figures(study: SeaTrialStudy) -> Sequence[KeyFigure]:
    """Errors on what was not fitted, before and after, the worse of both sides."""
    figures = []
    for name, meaning in KEY_FEATURES.items():
        key = f"turning circle: {name}"
        both = [
            (errors.before[key], errors.after[key])
            for errors in study.held_out.values()
            if key in errors.before
        ]
        if both:
            before, after = (max(values) for values in zip(*both, strict=True))
            text = f"{meaning}: error on circles that were not fitted, before and after, the worse of both sides"
            figures.append(KeyFigure(f"{before:.0f} → {after:.0f} %", text))
    return figures
