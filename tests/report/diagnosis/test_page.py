"""The page of a diagnosis: its figures by numbers, and the whole in a browser, light or dark, wide or narrow."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from shipcosim.cli.project import build_stale
from shipcosim.diagnose.experiment.manoeuvres import Manoeuvre, library
from shipcosim.diagnose.experiment.testability import log_facts
from shipcosim.diagnose.pipeline import completed, find_causes
from shipcosim.diagnose.result import Candidate, ExperimentDesign, Finding
from shipcosim.diagnose.stages import ExtendedSystem, PredictedLog, SimulatedLog
from shipcosim.diagnose.validation.gain import compare, rms
from shipcosim.diagnose.validation.missing_force import MissingForce, by_sector, missing_forces
from shipcosim.diagnose.validation.summary import PredictionErrors, condition_errors, prediction_errors
from shipcosim.report.diagnosis.force_figures import force_figures
from shipcosim.report.diagnosis.log_figures import log_figures, track_figure
from shipcosim.report.diagnosis.manoeuvre_steps import manoeuvre_steps
from shipcosim.report.diagnosis.page import render, write_diagnosis
from shipcosim.report.diagnosis.prediction_errors import condition_table, error_figures, error_table
from shipcosim.report.diagnosis.testability import not_testable_rows
from shipcosim.report.theme.numbers import metres
from shipcosim.ssp import read_system
from truth import draw

SECTIONS = ("log", "error", "causes", "extension", "gain")


@pytest.fixture(scope="module")
def predicted(root, tmp_path_factory):
    """A thruster that has lost a third of its thrust, from a log of the independent truth: findings and predictions."""
    path = tmp_path_factory.mktemp("log") / "lossy.csv"
    draw("trial", 3000, among=["thrust_loss"], minutes=12).save(path)
    found = find_causes(path, read_system(root / "ssp" / "gunnerus_open", fmus=[build_stale(root)]))
    problem, fit = found.basis.problem, found.basis.fit
    return found, PredictedLog(found.basis, True, compare(problem, fit), {}, missing_forces(problem, fit))


@pytest.fixture(scope="module")
def diagnosis(root, predicted):
    """The same with all that the page shows, in array form, the system not extended."""
    found, log = predicted
    system = ExtendedSystem(read_system(root / "ssp" / "gunnerus_open", fmus=[build_stale(root)]), "")
    return completed(found, log, system, SimulatedLog(log.comparison.errors, {}, False))


# the figures


def log_of(rows=600):
    time = np.arange(rows, dtype=float)
    heading = np.mod(350.0 + 0.1 * time, 360.0)
    units = {"north": "m", "east": "m", "heading": "deg", "port_rpm": "rpm", "tunnel_rpm": "rpm"}
    values = {"north": time, "east": 2 * time, "heading": heading, "port_rpm": 0 * time + 60, "tunnel_rpm": time + 500}
    columns = {name: ("time", values[name], {"units": unit, "long_name": name}) for name, unit in units.items()}
    return xr.Dataset(columns, {"time": time})


def by_title(figures):
    return {figure.title: figure for figure in figures}


def test_stretches_of_a_fault_are_shaded_in_the_panels_of_its_channels_only():
    fault = Finding("gap", kind="data", segments=((100.0, 120.0),), channels=("north",))
    panels = by_title(log_figures(log_of(), log_of(), [fault]))
    (shape,) = panels["Position"].layout["shapes"]
    assert (shape["x0"], shape["x1"]) == (100.0, 120.0)
    assert panels["Heading"].layout["shapes"] == []


def test_fault_of_the_whole_log_is_shaded_throughout():
    fault = Finding("sign", kind="data", channels=("heading",))
    (shape,) = by_title(log_figures(log_of(), log_of(), [fault]))["Heading"].layout["shapes"]
    assert (shape["x0"], shape["x1"]) == (0.0, 599.0)


def test_channel_is_drawn_as_logged_only_where_it_was_changed():
    clean = log_of()
    clean["north"][100:121] = np.nan
    (logged, north, east) = by_title(log_figures(log_of(), clean, []))["Position"].traces
    assert (logged["name"], north["name"], east["name"]) == ("north, logged", "north", "east")
    assert logged["y"][110] == 110.0 and north["y"][110] is None


def test_repaired_clock_is_drawn_over_the_time_that_was_logged():
    clean = log_of().assign_coords(logged_time=("time", 0.5 * np.arange(600.0)))
    data = by_title(log_figures(log_of(), clean, []))["Position"].traces
    assert next(trace for trace in data if trace["name"] == "east")["x"][-1] == 299.5


def test_heading_is_interrupted_where_it_passes_north():
    (trace,) = by_title(log_figures(log_of(), log_of(), []))["Heading"].traces
    assert trace["y"].count(None) == 1
    pairs = [(a, b) for a, b in zip(trace["y"][:-1], trace["y"][1:], strict=True) if None not in (a, b)]
    assert max(abs(a - b) for a, b in pairs) < 1.0


def test_thruster_whose_speed_is_much_larger_gets_a_panel_of_its_own():
    titles = by_title(log_figures(log_of(), log_of(), []))
    assert {"Shaft speed, port", "Shaft speed, tunnel"} <= set(titles)


def test_track_is_to_one_scale_with_north_up():
    track = track_figure(log_of())
    assert track.layout["yaxis"]["scaleanchor"] == "x"
    assert track.traces[0]["y"][-1] == 599.0 and track.traces[0]["x"][-1] == 1198.0
    assert track_figure(log_of().drop_vars("north")) is None


def errors_of():
    shape = ("model", "horizon", "segment")
    position = np.arange(24.0).reshape(2, 3, 4)
    columns = {name: (shape, position) for name in ("position", "heading", "surge", "sway", "yaw_rate")}
    regime = ("segment", ["holding", "moving", "moving", "turning"])
    return xr.Dataset(columns, {"model": ["plain", "floor"], "horizon": [10.0, 30.0, 60.0], "regime": regime})


def test_errors_are_root_mean_squares_by_horizon_and_by_what_the_ship_did():
    each = errors_of()
    overall, moving = condition_errors("all", each), condition_errors("moving", each.isel(segment=[1, 2]))
    errors = PredictionErrors(each, overall, (moving,), (), False, None, 0.0, 0.0)
    plain = error_figures(overall, ("plain", "floor"))[0].traces[0]
    assert plain["x"] == ["10 s", "30 s", "60 s"]
    assert plain["y"][0] == pytest.approx(np.sqrt(np.mean([0, 1, 4, 9])), rel=1e-2)
    table = error_table(errors)
    moving = dict(zip(table.head, next(row for row in table.rows if row[0] == "moving"), strict=True))
    assert moving["Segments"] == "2" and moving["Position [m]"] == "9.5 / 22"  # of 9, 10 and 21, 22


def test_missing_force_against_the_wind_is_its_mean_in_sectors():
    n = 360
    wind = np.arange(n, dtype=float)
    force = {name: ("time", np.zeros(n), {"units": "N"}) for name in ("surge", "sway", "north", "east")}
    force["surge"] = ("time", 1000.0 * np.cos(np.radians(wind)), {"units": "N"})
    force |= {"yaw": ("time", np.zeros(n), {"units": "N.m"}), "heading": ("time", wind), "wind_from": ("time", wind)}
    force = xr.Dataset(force, {"time": wind})
    panels = by_title(force_figures(MissingForce(force, None, {"wind_from": by_sector(force, "wind_from")}, ())))
    surge = panels["Missing force against the wind"].traces[0]
    assert len(surge["x"]) == 24 and surge["x"][0] == 7.5
    assert surge["y"] == pytest.approx(np.cos(np.radians(surge["x"])), abs=0.01)
    assert panels["Missing force, body frame"].traces[0]["y"][0] == pytest.approx(1.0)  # kN


def test_innovations_are_whiter_with_the_cause_than_without(diagnosis):
    before, after = (diagnosis.evidence.whiteness[name] for name in ("before", "after"))
    band = 2.0 / np.sqrt(diagnosis.evidence.rows)
    assert np.mean(np.abs(after) < band) > np.mean(np.abs(before) < band)
    assert np.mean(np.abs(after) < band) > 0.85


def test_cause_that_could_not_show_is_listed_with_what_the_log_has_of_it(diagnosis):
    problem = diagnosis.basis.problem
    ((name, sentence, why),) = not_testable_rows(["reverse_loss"], diagnosis.causes, log_facts(problem))
    astern = max(np.mean(problem.record.units[unit][0] < 0.0) for unit in problem.model.azimuths)
    assert name == "Reverse loss" and "astern" in sentence and f"{100 * astern:.0f} %" in why


def test_manoeuvre_is_told_step_by_step_from_start_to_end(diagnosis):
    model = diagnosis.basis.problem.model
    for manoeuvre in library(model):
        rows = manoeuvre_steps(manoeuvre)
        assert rows[0][0].startswith("0–") and all(doing for _, doing in rows)
        assert max(int(re.search(r"–(\d+) s", when).group(1)) for when, _ in rows) == round(60 * manoeuvre.minutes)
        assert all(any(push.thruster in doing for _, doing in rows) for push in manoeuvre.pushes)


def test_box_is_told_with_its_corners():
    box = Manoeuvre("box", ((90.0, 30.0, 0.0, 0.0), (90.0, 30.0, 30.0, 0.0), (60.0, 30.0, 30.0, np.pi / 2)))
    assert manoeuvre_steps(box) == [
        ("0–90 s", "move to 30 m ahead"),
        ("90–180 s", "move to 30 m ahead and 30 m to starboard"),
        ("180–240 s", "turn to 90° clockwise of the first heading"),
    ]


def test_ambiguous_log_shows_what_to_sail(diagnosis):
    alike = Candidate("mass", None, 0.6), Candidate("drag", None, 0.4)
    manoeuvre = library(diagnosis.basis.problem.model)[0]
    sail = ExperimentDesign(manoeuvre.name, manoeuvre.minutes, (("mass", "drag"),))
    said = {"verdict": "ambiguous", "findings": (), "candidates": alike, "indistinguishable": alike, "gain": None}
    text = render(replace(diagnosis, **said, not_testable=(), prescription=sail, manoeuvre=manoeuvre))
    assert f"To sail and log: {manoeuvre.name}" in text and "It tells mass from drag." in text
    assert "hold position and heading" in text


# the page


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
    assert "free drift, not fitted on" in text and "too little of another quarter of headings for it" in text
    known = metres(rms(errors, "position", "calibrated"))
    assert f"{known} would be missed over the later part instead of" in text


def test_diagnosis_without_predictions_or_forces_still_makes_a_page(diagnosis):
    bare = replace(diagnosis, baseline=None, gain=None, predictions=None, force=None)
    assert "too short, or has too many gaps" in render(bare)


def test_texts_from_files_stay_texts(diagnosis):
    evil = "</script><script>document.title='owned'</script>.csv"
    finding = Finding("gap", kind="data", note=evil, channels=(evil,))
    log = replace(diagnosis.log, name=evil)
    told = replace(diagnosis, log=log, remarks=(evil,), findings=(finding,))
    assert "<script>document" not in render(told)


def test_data_of_the_page_is_strict_json(diagnosis):
    text = re.search(r'<script type="application/json" id="data">(.*?)</script>', render(diagnosis), re.DOTALL).group(1)
    assert len(json.loads(text, parse_constant=lambda name: pytest.fail(name))) > 20


@pytest.fixture(scope="module")
def file(diagnosis, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "report.html"
    write_diagnosis(diagnosis, path)
    return path


@pytest.fixture
def shown(browse, chromium, file):
    """Function that shows the page at a width, light or dark."""

    def show(width, scheme):
        size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 700}
        chromium.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        media = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
        chromium.execute_cdp_cmd("Emulation.setEmulatedMedia", media)
        return browse(file)

    yield show
    chromium.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    chromium.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


@pytest.mark.parametrize(("width", "scheme"), [(1280, "light"), (400, "dark")])
def test_page_draws_every_figure_without_error_network_or_sideways_overflow(shown, width, scheme):
    page = shown(width, scheme)
    assert page.errors() == [] and page.requests() == []
    places, drawn = page.ask("return ['.plot', '.plot.js-plotly-plot'].map(s => document.querySelectorAll(s).length)")
    assert places == drawn > 20
    assert page.ask("return document.documentElement.scrollWidth") <= width
    rights = page.ask("return [...document.querySelectorAll('.plot')].map(p => p.getBoundingClientRect().right)")
    assert max(rights) <= width


def test_first_screen_holds_verdict_figures_and_what_to_do(shown):
    page = shown(1280, "light")
    assert "starboard thruster delivers" in page.text("#verdict") and "NAMED" in page.text("#verdict")
    assert "Inspect the starboard thruster" in page.text("#next")
    for place in ("#verdict", "#figures", "#next"):
        assert page.ask("return document.querySelector(arguments[0]).getBoundingClientRect().bottom", place) < 900


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
    rgb = [int(digits[i : i + 2], 16) for i in (0, 2, 4)] if colour[0] == "#" else re.findall(r"\d+", colour)[:3]
    return sum(map(int, rgb)) / 3
