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
    assert found.summary["mean"].tolist() == pytest.approx(found.runs.groupby("level")["highest"].mean().tolist())
    assert sorted(path.name for path in (project / "out").iterdir()) == [
        "report.html",
        "runs.csv",
        "runs.parquet",
        "study.json",
        "summary.csv",
    ]
    assert pandas.read_csv("out/runs.csv")["highest"].tolist() == found.runs["highest"].tolist()


def test_the_same_table_on_one_worker_and_on_two(project):
    one, two = swept(out="one"), swept(out="two", workers=2)
    pandas.testing.assert_frame_equal(one.runs, two.runs)
    assert (project / "one/runs.parquet").read_bytes() == (project / "two/runs.parquet").read_bytes()


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
    assert result.exit_code == 1 and "4 runs failed" in result.output and "the pump has run dry" in result.output
    runs = pandas.read_parquet("results/own/runs.parquet")
    assert (runs["error"] != "").tolist() == [False] * 8 + [True] * 4
    assert runs["highest"].isna().tolist() == [False] * 8 + [True] * 4
    assert pandas.read_csv("results/own/summary.csv")["failed"].tolist() == [0, 0, 4]


def test_a_run_that_ends_its_process_is_a_row_and_costs_no_other_run(project, study):
    whole = swept(out="whole")
    path = study('extends = "levels"\n[set]\n"lag.ends_above" = 2.5\n')
    ending = swept(path, workers=2)
    assert ending.runs["error"].str.contains("worker process ended").tolist() == [False] * 8 + [True] * 4
    assert ending.runs["highest"][:8].tolist() == whole.runs["highest"][:8].tolist()


def test_native_engine_gives_the_same_table(project):
    plan = plan_of(read_study("studies/levels.toml"))
    native = run_study(plan, project / "native", engine="native", workers=1).runs
    assert native["highest"].tolist() == pytest.approx(swept().runs["highest"].tolist(), rel=1e-12)
