"""The page of sea trials, and what `sea_trials.json` says of what to sail next."""

import json
import re

import numpy as np
import pytest
from diagnose import twin

from shipcosim.cli.sea_trials import print_study
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.sea_trials import separation
from shipcosim.diagnose.sea_trials.manoeuvres import as_trials, catalogue
from shipcosim.diagnose.sea_trials.study import causes_of_trials, studied
from shipcosim.report.sea_trials.page import render
from shipcosim.report.sea_trials.words import next_steps


@pytest.fixture(scope="module")
def found():
    """A ship slowed down by drift, in a circle to each side: causes of drag in a turn fit alike."""
    model, shafts = twin.model(), {"port": 170.0 / 60.0, "starboard": 170.0 / 60.0}
    circles = [
        one for one in catalogue(model) if one.name == "turning circle with 35 deg at full speed"
    ]
    ((_, pair),) = as_trials(circles, model, shafts, {"vessel.mmg_X_vv": -0.7})
    causes = [
        one
        for one in causes_of_trials(model, read_catalogue(), orders=True)
        if one.cause.endswith("_drag")
    ]
    few = [one for one in catalogue(model) if "35 deg" in one.name and "half speed" in one.name]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(separation, "catalogue", lambda _: few)
        return studied(pair, model, causes)


def test_the_page_says_what_is_wrong_what_fits_alike_and_what_to_sail(found, tmp_path, data_of):
    (tmp_path / "report.html").write_text(render(found, {"Log": "<trials>.csv"}), encoding="utf-8")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "&lt;trials&gt;.csv" in page and "AMBIGUOUS" in page
    for anchor in re.findall(r'<a href="#(\w+)"', page):
        assert f'id="{anchor}"' in page
    data = data_of(page)
    tracks = data[0]["data"]
    assert len(tracks) == 2 * 3 and {trace["name"] for trace in tracks} == {
        "measured",
        "as modelled",
        "with the causes",
    }
    for one in found.prescriptions:
        assert one.manoeuvre[1:] in page


def test_the_summary_says_the_same_as_the_page(found, tmp_path, capsys):
    (tmp_path / "report.html").write_text(render(found, {}), encoding="utf-8")
    print_study(found, tmp_path)
    said = capsys.readouterr().out
    sentence = re.search(r"[A-Z][a-z ]+ drag fits best[^.]*\.", said)[0]
    assert sentence in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert said.count("\n- ") == len(next_steps(found)) and "to both sides" in said


def test_a_circle_to_port_is_drawn_to_the_left(found, tmp_path):
    from shipcosim.report.sea_trials.figures import track_figure

    measured = [trial.measured for trial in found.trials]
    traces = track_figure(found, measured, measured).traces
    sides = [np.sign(np.mean(trace["x"])) for trace in traces if trace["name"] == "measured"]
    assert sides == [trial.side for trial in found.trials]


def test_what_separates_is_said_by_pair_with_its_numbers(found):
    said = json.loads(json.dumps(found.as_json()))
    assert said["verdict"] == "ambiguous" and said["prescriptions"]
    first = said["prescriptions"][0]
    (record,) = [one for one in said["manoeuvres"] if one["manoeuvre"] == first["manoeuvre"]]
    told = {tuple(pair["between"]): pair["nats"] for pair in record["pairs"]}
    assert all(told[tuple(pair)] >= 10.0 for pair in first["separates"])
