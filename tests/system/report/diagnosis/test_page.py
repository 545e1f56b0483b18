"""The page of a diagnosis: what it says, and the whole in a browser, light or dark, wide or narrow."""

import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from shipcosim.diagnose.craft.learned import HeldOutErrors
from shipcosim.diagnose.experiment.design import ExperimentDesign
from shipcosim.diagnose.experiment.manoeuvres import library
from shipcosim.diagnose.experiment.testability import log_facts
from shipcosim.diagnose.explanation.summary import FormNumber, LoadForm
from shipcosim.diagnose.finding import Candidate, Finding
from shipcosim.diagnose.validation.gain import rms
from shipcosim.diagnose.validation.summary import prediction_errors
from shipcosim.report.diagnosis.page import render
from shipcosim.report.diagnosis.prediction_errors import condition_table
from shipcosim.report.diagnosis.testability import not_testable_rows
from shipcosim.report.diagnosis.words import outcome
from shipcosim.report.theme.numbers import metres

SECTIONS = ("log", "error", "causes", "extension", "gain")


def test_innovations_are_whiter_with_the_cause_than_without(diagnosis):
    before, after = (diagnosis.evidence.whiteness[name] for name in ("before", "after"))
    band = 2.0 / np.sqrt(diagnosis.evidence.rows)
    assert np.mean(np.abs(after) < band) > np.mean(np.abs(before) < band)
    assert np.mean(np.abs(after) < band) > 0.85


def test_cause_that_could_not_show_is_listed_with_what_the_log_has_of_it(diagnosis):
    problem = diagnosis.basis.problem
    ((name, sentence, why),) = not_testable_rows(
        ["reverse_loss"], diagnosis.causes, log_facts(problem)
    )
    astern = max(np.mean(problem.record.units[unit][0] < 0.0) for unit in problem.model.azimuths)
    assert name == "Reverse loss" and "astern" in sentence and f"{100 * astern:.0f} %" in why


def test_labels_that_could_not_be_judged_are_listed_with_the_reason():
    rows = not_testable_rows(["channel_swap", "sign"], {}, {})
    assert [name for name, _, _ in rows] == ["Channel swap", "Sign"]
    assert all("answers the motion" in why and sentence for _, sentence, why in rows)


def test_form_of_the_loads_is_told_with_what_it_hides(diagnosis):
    number = FormNumber(
        "vessel.cross_flow_drag", "cross-flow drag coefficient", 1.5, 1.86, 0.07, "1"
    )
    lost = FormNumber("port.form.across", "share of the thrust lost", 0.0, 0.06, 0.01, "1")
    form = LoadForm(
        1.0, {"drag across the hull, along her length": 0.14}, (number, lost), ("crossflow",)
    )
    text = render(replace(diagnosis, form=form, not_testable=("crossflow", "reverse_loss")))
    assert (
        "The form of her loads" in text and "14 %" in text and "1.86" in text and "± 0.070" in text
    )
    assert "Port: share of the thrust lost" in text
    assert text.count("would do the same, and hers have another form") == 1
    assert "The form of her loads" not in render(diagnosis)
    healthy = replace(diagnosis, verdict="consistent", findings=(), form=form)
    assert "where the loads may have another form" in outcome(healthy).sentence
    assert "tolerances of the model" in outcome(replace(healthy, form=None)).sentence


def test_ambiguous_log_shows_what_to_sail(diagnosis):
    alike = Candidate("mass", None, 0.6), Candidate("drag", None, 0.4)
    manoeuvre = library(diagnosis.basis.problem.model)[0]
    sail = ExperimentDesign(manoeuvre.name, manoeuvre.minutes, (("mass", "drag"),))
    said = {
        "verdict": "ambiguous",
        "findings": (),
        "candidates": alike,
        "indistinguishable": alike,
        "gain": None,
    }
    text = render(
        replace(diagnosis, **said, not_testable=(), prescription=sail, manoeuvre=manoeuvre)
    )
    assert f"To sail and log: {manoeuvre.name}" in text and "It tells mass from drag." in text
    assert "hold position and heading" in text


def test_every_link_of_the_chain_is_on_the_page(diagnosis):
    text = render(diagnosis)
    for key in SECTIONS:
        assert f'<section id="{key}">' in text and f'href="#{key}"' in text
    gain = diagnosis.gain
    assert f"{100 * gain['share_of_explainable']:.0f} %" in text
    assert "The system could not be extended" in text  # it was not


def test_gain_is_told_by_condition_with_an_interval_where_there_is_enough(diagnosis, predicted):
    errors = predicted[1].comparison.errors
    some = errors.isel(segment=slice(0, 12))
    summary = prediction_errors(
        predicted[1].comparison, errors, {"free drift": some}, is_named=True, is_simulated=False
    )
    table = condition_table(summary)
    head, rows = table.head, table.rows
    assert [row[0] for row in rows] == [
        "the later part",
        *(f"of it {name}" for name in np.unique(errors["regime"])),
        "free drift, not fitted on",
    ]
    assert sum(int(row[1]) for row in rows[1:-1]) == int(rows[0][1]) == errors.sizes["segment"]
    place = head.index("with the cause and a bias observer [m]")
    squares = some["position"].sel(model="extended_observer", horizon=60) ** 2
    assert float(rows[-1][place]) == pytest.approx(float(np.sqrt(squares.mean())), abs=0.06)
    assert rows[-1][-1].endswith(" %")  # a minute of predictions: no interval
    text = render(replace(diagnosis, predictions=summary))
    assert (
        "free drift, not fitted on" in text
        and "too little of another quarter of headings for it" in text
    )
    known = metres(rms(errors, "position", "calibrated"))
    assert f"{known} would be missed over the later part instead of" in text


def test_gain_of_a_learned_craft_is_told_over_her_own_time(diagnosis):
    same = (0.2, 0.4)
    errors = HeldOutErrors(3.0, 2.0, 0.5, 40.0, 5.0, same, same, 1.0, 20.0, same)
    shown = render(replace(diagnosis, gain=errors.as_gain()))
    assert "75 % of the error" in shown and "25 % (95 % sure: 20 % to 40 %)" in shown
    assert "Position error after 3 s" in shown and "bias observer, as DP" not in shown


def test_diagnosis_without_predictions_or_forces_still_makes_a_page(diagnosis):
    bare = replace(diagnosis, baseline=None, gain=None, predictions=None, force=None)
    assert "too short, or has too many gaps" in render(bare)


def test_texts_from_files_stay_texts(diagnosis):
    evil = "</script><script>document.title='owned'</script>.csv"
    finding = Finding("gap", kind="data", note=evil, channels=(evil,))
    log = replace(diagnosis.log, name=evil)
    told = replace(diagnosis, log=log, remarks=(evil,), findings=(finding,))
    assert "<script>document" not in render(told)


def test_data_of_the_page_is_strict_json(diagnosis, data_of):
    assert len(data_of(render(diagnosis))["figures"]) > 20


@pytest.fixture(scope="module")
def file(diagnosis, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(render(diagnosis), encoding="utf-8")
    return path


@pytest.fixture
def shown(shown_at, file):
    """Function that shows the page at a width, light or dark."""
    return partial(shown_at, file)


@pytest.mark.parametrize(("width", "scheme"), [(1280, "light"), (500, "dark")])
def test_page_draws_every_figure_without_error_network_or_sideways_overflow(shown, width, scheme):
    page = shown(width, scheme)
    assert page.errors() == [] and page.requests() == []
    places, drawn = page.ask(
        "return ['.plot', '.plot.js-plotly-plot'].map(s => document.querySelectorAll(s).length)"
    )
    assert places == drawn > 20
    assert page.ask("return document.documentElement.scrollWidth") <= width
    rights = page.ask(
        "return [...document.querySelectorAll('.plot')].map(p => p.getBoundingClientRect().right)"
    )
    assert max(rights) <= width
    assert page.collisions() == []


@pytest.mark.parametrize("share", (0.1, 0.5, 0.9))
def test_measured_ship_and_her_simulations_sail_where_the_log_and_the_tracks_have_them(
    shown, diagnosis, share
):
    page, tracks = shown(1280, "light"), diagnosis.tracks
    time = tracks.measured["time"].values
    row = int(share * time.size)
    page.ask("scene.time = arguments[0]; scene.paint()", float(time[row]))
    rows = page.ask(
        "return [...document.getElementById('scene-figures').rows].map(r => [...r.cells].map(c => c.textContent))"
    )
    head, north = rows[0], next(cells for cells in rows if cells[0] == "North [m]")
    assert head[1:] == ["measured", *tracks.predicted]
    assert north[1] == f"{float(tracks.measured['north'][row]):.2f}".replace("-", "−")
    # What each simulation has at this time: of the prediction that holds it, or nothing after the last one.
    for text, one in zip(north[2:], tracks.predicted.values(), strict=True):
        starts = one["start_time"].values
        segment = np.searchsorted(starts, time[row], side="right") - 1
        after = time[row] - starts[segment]
        if after > one["time"].values[-1]:
            assert text == "–"
        else:
            at = np.interp(after, one["time"].values, one["north"].values[segment])
            assert float(text.replace("−", "-")) == pytest.approx(at, abs=0.02)
    # The arrow of the missing force has the size of the figure below.
    assert page.text("#scene-thrusters figcaption") == "measured: missing"


def test_page_is_small(file):
    assert file.stat().st_size < 1.5e6


def test_first_screen_holds_verdict_figures_and_what_to_do(shown):
    page = shown(1280, "light")
    assert "starboard thruster delivers" in page.text("#verdict") and "NAMED" in page.text(
        "#verdict"
    )
    assert "Inspect the starboard thruster" in page.text("#next")
    for place in ("#verdict", "#figures", "#next"):
        assert (
            page.ask(
                "return document.querySelector(arguments[0]).getBoundingClientRect().bottom", place
            )
            < 900
        )


def test_dark_page_is_dark_and_its_figures_too(shown):
    colours = {}
    for scheme in ("light", "dark"):
        page = shown(1280, scheme)
        behind = page.ask("return getComputedStyle(document.body).backgroundColor")
        letters = page.ask("return document.querySelector('.plot')._fullLayout.font.color")
        colours[scheme] = brightness(behind), brightness(letters)
    (light, ink), (dark, chalk) = colours["light"], colours["dark"]
    assert light > 200 > ink and dark < 50 < chalk


def brightness(colour):
    """Mean of red, green and blue, 0 to 255."""
    digits = colour.removeprefix("#")
    rgb = (
        [int(digits[i : i + 2], 16) for i in (0, 2, 4)]
        if colour[0] == "#"
        else re.findall(r"\d+", colour)[:3]
    )
    return sum(map(int, rgb)) / 3
