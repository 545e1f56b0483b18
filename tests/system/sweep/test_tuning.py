"""A search of a study: the same trials however it is run, a known front, failures, and margins of the DP loop."""

import json
from dataclasses import replace
from html import unescape

import numpy as np
import pandas
import pytest
from typer.testing import CliRunner

import shipcosim
from shipcosim.cli import app
from shipcosim.models.control.margins import Delays, linear_loop, margins
from shipcosim.models.control.observer import DpShip, ObserverParameters
from shipcosim.models.control.pid import ControlParameters
from shipcosim.ships import read_ship
from shipcosim.sweep import plan_of, read_study

STUDY = """
scenario = "filling"

[[factor]]
name  = "seed"
seeds = 2

[tune]
trials     = 12
population = 4

[tune.of]
"lag.u"             = { low = "50 cm", high = 2.0, name = "level" }
"lag.time_constant" = { low = 0.2, high = 5.0, log = true }

[[tune.objective]]
quantity  = "off_one"
direction = "minimise"

[[tune.objective]]
quantity  = "highest"
direction = "maximise"

[[quantity]]
name   = "off_one"
signal = "lag.y"
near   = 1.0
reduce = "rms"
during = [1.9, 2.0]

[[quantity]]
name   = "highest"
signal = "lag.y"
reduce = "maximum"

[[view]]
kind       = "pareto"
table      = "trials"
quantities = ["off_one", "highest"]
largest    = ["highest"]
marked     = "as_shipped"
"""


def swept(path, out="out", **options):
    options.setdefault("workers", 1)
    return shipcosim.sweep(path, out=out, engine="fmpy", **options)


def test_trials_lie_in_their_ranges_and_the_first_is_as_shipped(project, study):
    found = swept(study(STUDY))
    trials = found.tables["trials"]
    assert trials["trial"].tolist() == list(range(12)) and trials["generation"].tolist() == [
        t // 4 for t in range(12)
    ]
    assert (
        trials["level"].between(0.5, 2.0).all()
        and trials["lag.time_constant"].between(0.2, 5.0).all()
    )
    assert trials["as_shipped"].tolist() == [True] + 11 * [False]
    assert trials.loc[0, ["level", "lag.time_constant"]].tolist() == [1.0, 1.0]
    runs = found.runs[found.runs["sample"] == 5]
    assert runs["seed"].tolist() == [1, 2] and (runs["level"] == trials["level"][5]).all()
    assert trials["off_one"][5] == pytest.approx(runs["off_one"].mean())
    assert json.loads(runs["input"].iloc[1])["set"]["lag.u"] == trials["level"][5]


def test_no_trial_beats_one_of_the_front_and_each_other_is_beaten(project, study):
    trials = swept(study(STUDY)).tables["trials"]
    points = np.column_stack([trials["off_one"], -trials["highest"]])
    beaten = [
        bool(((points <= one).all(axis=1) & (points < one).any(axis=1)).any()) for one in points
    ]
    assert trials["pareto"].tolist() == [not one for one in beaten]
    assert 0 < trials["pareto"].sum() < len(trials)


def test_what_is_wanted_steers_the_search(project, study):
    """The first generation is the same; later ones go up where the largest value is wanted, down where the least is."""
    text = STUDY.replace("trials     = 12", "trials     = 40").replace("seeds = 2", "seeds = 1")
    up, down = (
        swept(study(one)).tables["trials"] for one in (text, text.replace("maximise", "minimise"))
    )
    assert up["highest"][:4].tolist() == down["highest"][:4].tolist()
    assert up["highest"][8:].mean() > down["highest"][8:].mean() + 0.2


def test_one_worker_two_and_a_study_that_stopped_give_the_same_trials(project, study):
    path = study(STUDY)
    one, two = swept(path, out="one"), swept(path, out="two", workers=2)
    for stop in (3, 10):
        part = swept(path, out="part", at_most=stop)
    assert len(part.runs) == 13 and part.tables["trials"]["runs"].sum() == 13
    rest = swept(path, out="part")
    for other in (two, rest):
        pandas.testing.assert_frame_equal(other.tables["trials"], one.tables["trials"])
        pandas.testing.assert_frame_equal(other.runs, one.runs)
    swept(path, out="part", progress=lambda done, total: pytest.fail("nothing is left to do"))


def test_a_failed_trial_is_beaten_by_all_others_and_the_search_goes_on(project, study):
    found = swept(study(STUDY + '[set]\n"lag.fails_above" = 1.2\n'))
    trials = found.tables["trials"]
    bad = trials["level"] > 1.2
    assert 0 < bad.sum() < 12 and (trials["failed"] == 2 * bad).all() and len(trials) == 12
    assert not trials.loc[bad, "pareto"].any() and trials.loc[bad, "highest"].isna().all()


def test_command_prints_the_front_the_page_marks_ours_and_a_run_is_made_again(project, study):
    study(STUDY)
    command = ["sweep", "own", "--engine", "fmpy", "--workers", "1"]
    called = CliRunner().invoke(app, command)
    assert called.exit_code == 0
    assert "off_one minimised, highest maximised: " in called.stdout
    assert "of 12 trials are Pareto-optimal" in called.stdout
    page = unescape((project / "results/own/report.html").read_text(encoding="utf-8"))
    assert "is not drawn" not in page and '"low": "50 cm"' in page
    again = CliRunner().invoke(app, [*command, "--run", "18"])  # run 18: trial 6 of seed 2
    trials = pandas.read_csv("results/own/trials.csv")
    assert again.exit_code == 0
    assert f"level {trials['level'][6]}" in (project / "results/own/run-18/report.html").read_text(
        encoding="utf-8"
    )
    early = CliRunner().invoke(app, [*command, "--out", "new", "--run", "18"])
    assert early.exit_code == 2 and "has not been proposed yet" in early.stderr


def test_margin_of_a_study_is_that_of_the_linear_loop(root, tmp_path, monkeypatch):
    """The controller of Gunnerus."""
    monkeypatch.chdir(root)
    path = tmp_path / "margins.toml"
    path.write_text(
        f'scenario = "{root}/scenarios/stationkeeping.toml"\n[[factor]]\nname = "drift"\n'
        'signal = "controller.bias_drift"\nvalues = [1.93e-7, 5e-8]\n'
        '[[quantity]]\nname = "margin"\nmargin = "phase"\npeak_period = "6 s"\n'
    )
    plan = plan_of(read_study(path))
    found = [plan.measures[0].margin.of(plan.run(number).values) for number in range(2)]
    ship = read_ship(root / "ssp/ships/gunnerus-33m9")
    sets = [
        ship.parameters(kind, "controller")
        for kind in (DpShip, ObserverParameters, ControlParameters)
    ]
    for margin, drift in zip(found, (1.93e-7, 5e-8), strict=True):
        sets[1] = replace(sets[1], bias_drift=drift)
        loop = linear_loop(*sets, Delays(), 2.0 * np.pi / 6.0)
        assert margin == pytest.approx(
            min(margins(loop, axis).phase for axis in range(3)), rel=1e-9
        )
    assert found[0] != found[1]
