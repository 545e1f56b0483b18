"""The page of a diagnosis: one HTML file that shows every link of the chain and opens anywhere."""

import json
from dataclasses import dataclass, field
from html import escape
from importlib.resources import files
from string import Template
from typing import Any

import shipcosim
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.hypotheses.cause import Cause
from shipcosim.diagnose.log.remarks import remarks
from shipcosim.report.diagnosis import parts
from shipcosim.report.diagnosis.numbers import plain
from shipcosim.report.diagnosis.sections import (
    causes_section,
    data_section,
    error_section,
    extension_section,
    gain_section,
    status,
)
from shipcosim.report.diagnosis.words import next_steps, outcome
from shipcosim.series import write_file


@dataclass(frozen=True)
class Story:
    """All that a page tells of a diagnosis.

    Attributes
    ----------
    diagnosis : Diagnosis
    details : JudgedLog
        What it rests on.
    source : str
        Name of the log.
    system : System
        The ship that the log was held against.
    extension : Extension, optional
        Where a cause was put into the system.
    extended : System, optional
        The extended system.
    comparison : Comparison, optional
        Predictions with the models, where there was data for it.
    simulated : xarray.Dataset, optional
        Its errors as co-simulations.
    force, force_left : xarray.Dataset, optional
        What the plain model lacks over time, and what it lacks with the causes in it.
    remarks : tuple of str
        What else needs to be known.
    unseen : dict of str to Comparison
        By condition, predictions on it with nothing fitted on it.
    unseen_errors : dict of str to xarray.Dataset
        Their errors, as co-simulations where those were run.
    """

    diagnosis: Any
    details: Any
    source: str
    system: Any
    extension: Any = None
    extended: Any = None
    comparison: Any = None
    simulated: Any = None
    force: Any = None
    force_left: Any = None
    remarks: tuple = ()
    unseen: Any = field(default_factory=dict)
    unseen_errors: Any = field(default_factory=dict)

    @property
    def causes(self) -> dict[str, Cause]:
        """The causes by name."""
        return read_catalogue() | {one.cause: one.effect for one in self.details.problem.hypotheses}

    @property
    def notes(self):
        """What could not be known from this log, and what did not work."""
        return [*self.details.problem.record.remarks, *self.remarks]

    @property
    def handled(self):
        """What is ordinary in a log and was handled without being a fault."""
        log = self.details.explained.identification.log
        unused = ", ".join(map(str, log.attrs.get("unused_columns", ())))
        return [*remarks(log), *([f"Columns without a role are not used: {unused}."] if unused else [])]

    @property
    def errors(self):
        """Errors of predictions: as co-simulations where those were run."""
        if self.simulated is not None:
            return self.simulated
        return None if self.comparison is None else self.comparison.errors


def write_diagnosis(story, path):
    """Write the page of a diagnosis.

    Parameters
    ----------
    story : Story
    path : path
        HTML file; it is there completely or not at all.

    Raises
    ------
    ShipcosimError
        If the file cannot be written.
    """
    write_file(path, render(story).encode())


def render(story):
    """The page as text."""
    figures = parts.Figures()
    made = [section(story, figures) for section in _SECTIONS.values()]
    word, sentence = outcome(story.diagnosis, story.causes)
    title = f"Diagnosis of {story.source}"
    extended = story.extension.ssp.name if story.extension is not None and story.extension.values else None
    summary = [
        parts.verdict(story.diagnosis.verdict, word, sentence),
        parts.key_figures(key_figures(story.diagnosis)),
        parts.next_steps(next_steps(story.diagnosis, extended, story.causes)),
    ]
    return Template(_asset("diagnosis.html")).substitute(
        title=escape(title),
        css=_asset("diagnosis.css"),
        header=parts.header(title, _facts(story)),
        summary="".join(summary),
        navigation=parts.navigation([(key, _TITLES[key], status(key, story)) for key in _SECTIONS]),
        sections="".join(made),
        version=shipcosim.__version__,
        plotly=files("plotly").joinpath("package_data/plotly.min.js").read_text(encoding="utf-8"),
        data=json.dumps(figures.drawn, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c"),
        script=_asset("diagnosis.js"),
    )


_SECTIONS = {
    "log": data_section,
    "error": error_section,
    "causes": causes_section,
    "extension": extension_section,
    "gain": gain_section,
}
_TITLES = {"log": "Log", "error": "Error", "causes": "Cause", "extension": "Extension", "gain": "Gain"}


def key_figures(diagnosis):
    """The numbers that matter most, as (number, what it is).

    Parameters
    ----------
    diagnosis : Diagnosis

    Returns
    -------
    list of (str, str)
    """
    found, gain, base = [], diagnosis.gain, diagnosis.baseline
    sure = [f.probability for f in diagnosis.findings if f.kind == "physics"]
    if sure:
        found.append((f"{100 * min(sure):.0f} %", "probability that the cause is right"))
    if gain:
        horizon = f"after {gain['horizon_s']:g} s"
        found.append((parts.metres(gain["before_m"]), f"position error of the simulation {horizon}"))
        found.append((parts.metres(gain["bias_observer_m"]), "the same with a bias observer, as DP systems have"))
        found.append((parts.metres(gain["after_m"]), "the same with the cause in the model"))
        found.append((parts.metres(gain["noise_floor_m"]), "what a perfect model would still miss"))
        if gain["share_of_explainable"] is not None:
            low, high = (f"{100 * edge:.0f}" for edge in gain["ci95"])
            share = f"{100 * gain['share_of_explainable']:.0f} %"
            found.append((share, f"of the explainable error removed (95 % sure: {low} to {high} %)"))
    elif base:
        horizon, angle = base["horizon_s"][-1], base["heading_error_deg"][-1]
        found.append(
            (parts.metres(base["position_error_m"][-1]), f"position error of the simulation after {horizon:g} s")
        )
        found.append((f"{plain(angle, 2)}°", f"heading error after {horizon:g} s"))
    return found


def _facts(story):
    log = story.details.explained.identification.log
    time = log["time"].values
    span = f"{(time[-1] - time[0]) / 60:.0f} min, {time.size} rows"
    step = f"{story.details.problem.record.step:g} s"
    return [("System", getattr(story.system, "name", "")), ("Log", span), ("Step", step)]


def _asset(name):
    return files("shipcosim.report.diagnosis").joinpath(name).read_text(encoding="utf-8")
