"""The page of sea trials: tracks, features before and after, causes, and what would tell them apart."""

from collections.abc import Sequence

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
    known_facts,
)

KEY_FEATURES = {
    "speed": "steady speed",
    "rate": "steady rate of turn",
    "t90": "time to 90° of heading",
}


def render(study: SeaTrialStudy, facts: dict[str, str]) -> str:
    """The page of sea trials as HTML; `facts` are shown below its title."""
    circles = any(trial.kind == "turning circle" for trial in study.trials)
    page = FigurePage(
        title="Sea trials",
        facts=known_facts(facts | {"Trials": trials(study)}),
        outcome=outcome(study),
        key_figures=_key_figures(study),
        figures=(track_figure(study, *motions_of(study)),) if circles else (),
    )
    return render_template(
        "sea_trials/templates/sea_trials.html.jinja",
        page,
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
