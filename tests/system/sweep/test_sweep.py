"""Studies from file to table: every run once, the same on any number of workers, killed and resumed, failing or not."""

import json

import pandas
import pytest
from typer.testing import CliRunner

import shipcosim
from shipcosim.cli import app
from shipcosim.scenario import Scenario
from shipcosim.sweep import plan_of, read_study, run_study

FAILING = 'extends = "levels"\n[set]\n"lag.fails_above" = 2.5\n'


def swept(name="levels", out="out", **options):
    options.setdefault("workers", 1)
    return shipcosim.sweep(name, out=out, engine="fmpy", **options)


def test_a_study_gives_a_row_a_run_in_the_order_of_its_factors(project):
    found = swept()
    assert list(found.runs.columns) == ["run", "level", "seed", "highest", "held", "error", "input"]
    assert found.runs["run"].tolist() == list(range(12))
    assert found.runs["level"].tolist() == [1.0] * 4 + [2.0] * 4 + [3.0] * 4
    assert found.runs["seed"].tolist() == [1, 2, 3, 4] * 3
    assert found.runs["highest"].nunique() == 12, "each seed makes a run of its own"
    assert found.runs["held"].tolist() == [True] * 8 + [False] * 4
    assert found.summary["share"].tolist() == [1.0, 1.0, 0.0]
    assert found.summary["mean"].tolist() == pytest.approx(
        found.runs.groupby("level")["highest"].mean().tolist()
    )
    assert sorted(path.name for path in (project / "out").iterdir()) == [
        "report.html",
        "runs.csv",
        "runs.parquet",
        "study.json",
        "summary.csv",
        "verdict.json",
    ]
    assert pandas.read_csv("out/runs.csv")["highest"].tolist() == found.runs["highest"].tolist()


def test_the_same_table_on_one_worker_and_on_two(project):
    one, two = swept(out="one"), swept(out="two", workers=2)
    pandas.testing.assert_frame_equal(one.runs, two.runs)
    assert (project / "one/runs.parquet").read_bytes() == (
        project / "two/runs.parquet"
    ).read_bytes()


def test_the_input_of_a_row_is_enough_to_run_it_alone(project):
    found = swept()
    for row in (found.runs.iloc[0], found.runs.iloc[7]):
        alone = shipcosim.run(Scenario(**json.loads(row["input"])))
        assert float(alone["lag.y"].max()) == row["highest"]
    again = found.run(7)
    assert float(again["lag.y"].max()) == found.runs["highest"][7] and again.passed


def test_a_study_that_stopped_goes_on_and_gives_the_same_table(project):
    whole = swept(out="whole")
    assert len(swept(at_most=5).runs) == 5
    done = []
    rest = swept(progress=lambda n, total: done.append(n))
    assert done[0] > 5 and done[-1] == 12, "what was done was not done again"
    pandas.testing.assert_frame_equal(rest.runs, whole.runs)
    assert not (project / "out/parts").exists()
    swept(progress=lambda n, total: pytest.fail("nothing is left to do"))


def test_a_changed_study_keeps_earlier_results_aside(project, study):
    swept(at_most=2)
    path = study('extends = "levels"\nstop_time = "1 s"\n')
    changed = swept(path)
    assert len(changed.runs) == 12 and len(pandas.read_parquet("out-1/runs.parquet")) == 2
    study(
        'extends = "levels"\nstop_time = "1 s"\n[[summary]]\nname = "largest"\nquantity = "highest"\n'
        'over = ["seed", "level"]\nstatistic = "maximum"\n'
    )
    other = swept(path, progress=lambda n, total: pytest.fail("a summary needs no new runs"))
    assert other.summary["largest"].max() == changed.runs["highest"].max()


def test_a_failing_run_is_a_row_with_its_error(project, study):
    study(FAILING)
    result = CliRunner().invoke(app, ["sweep", "own", "--engine", "fmpy", "--workers", "1"])
    assert (
        result.exit_code == 1
        and "4 runs failed" in result.output
        and "the pump has run dry" in result.output
    )
    runs = pandas.read_parquet("results/own/runs.parquet")
    assert (runs["error"] != "").tolist() == [False] * 8 + [True] * 4
    assert runs["highest"].isna().tolist() == [False] * 8 + [True] * 4
    assert pandas.read_csv("results/own/summary.csv")["failed"].tolist() == [0, 0, 4]


def test_a_run_that_ends_its_process_is_a_row_and_costs_no_other_run(project, study):
    whole = swept(out="whole")
    path = study('extends = "levels"\n[set]\n"lag.ends_above" = 2.5\n')
    ending = swept(path, workers=2)
    assert (
        ending.runs["error"].str.contains("worker process ended").tolist()
        == [False] * 8 + [True] * 4
    )
    assert ending.runs["highest"][:8].tolist() == whole.runs["highest"][:8].tolist()


def test_native_engine_gives_the_same_table(project):
    plan = plan_of(read_study("studies/levels.toml"))
    native = run_study(plan, project / "native", engine="native", workers=1).runs
    assert native["highest"].tolist() == pytest.approx(swept().runs["highest"].tolist(), rel=1e-12)


SAMPLED = """
scenario = "filling"
fork_at  = "1 s"

[names]
both = ["lag", "other"]

[sample]
method = "METHOD"
runs   = 4

[sample.of]
"both.u"            = { distribution = "uniform", loc = 100.0, scale = 100.0, unit = "cm", name = "level" }
"lag.time_constant" = { distribution = "truncnorm", a = -2.0, b = 2.0, loc = 1.0, scale = 0.2 }
"other.noise"       = { distribution = "uniform", scale = 0.1 }

[[quantity]]
name   = "late"
signal = "other.y"
reduce = "time_beyond"
limit  = "80 cm"

[tracks]
signals  = ["lag.y"]
interval = "0.5 s"
"""


@pytest.mark.parametrize(
    ("method", "runs"), [("sobol", 4), ("latin_hypercube", 4), ("random", 4), ("saltelli", 20)]
)
def test_samples_lie_in_their_distributions_and_follow_from_the_seed(project, study, method, runs):
    plan = plan_of(read_study(study(SAMPLED.replace("METHOD", method))))
    planned = [plan.run(number) for number in range(len(plan))]
    assert len(planned) == runs
    for run in planned:
        assert 1.0 <= run.values["lag.u"] == run.values["other.u"] == run.columns["level"] <= 2.0
        assert 0.6 <= run.columns["lag.time_constant"] <= 1.4
    other = plan_of(read_study(study("seed = 2\n" + SAMPLED.replace("METHOD", method))))
    assert (
        plan.run(0)
        == plan_of(read_study(study(SAMPLED.replace("METHOD", method)))).run(0)
        != other.run(0)
    )


def test_a_sampled_study_keeps_tracks_and_says_when_a_limit_is_passed(project, study):
    found = swept(study(SAMPLED.replace("METHOD", "sobol")))
    tracks = pandas.read_parquet("out/tracks.parquet")
    assert tracks["run"].tolist() == [run for run in range(4) for _ in range(5)]
    assert tracks["time"].tolist() == pytest.approx([0.0, 0.5, 1.0, 1.5, 2.0] * 4)
    alone = found.run(2)
    assert tracks.loc[tracks["run"] == 2, "lag.y"].tolist() == alone["lag.y"].values[::5].tolist()
    beyond = alone["time"].values[alone["other.y"].values > 0.8]
    assert found.runs["late"][2] == beyond[0]
