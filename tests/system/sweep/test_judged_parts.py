"""A study that ends before what is judged says so, and gives no verdict on what did not happen."""

import json

import pytest

from shipcosim import run, sweep
from shipcosim.calls.studies import PlannedStudy
from shipcosim.cosim import simulate
from shipcosim.errors import ShipcosimError

SCENARIO = """
system    = "tank"
stop_time = 2.0
step_size = 0.1

[[expect]]
signal  = "lag.y"
at_most = 99.0

[[expect]]
signal   = "lag.y"
at_most  = 99.0
statistic = "mean"

[[expect]]
signal  = "lag.y"
at_most = 99.0
during  = [0.5, 1.0]
"""
STUDY = """
scenario = "several"
{stop}
[[factor]]
name  = "seed"
seeds = 2

{factor}

[[quantity]]
name = "held"
scenario_expectations = true

[[quantity]]
name   = "late"
signal = "lag.y"
reduce = "maximum"
during = [0.0, {window}]

[[summary]]
name      = "share"
quantity  = "held"
over      = "seed"
statistic = "share"
"""
CASES = """
[[factor]]
name = "length"
case = [{ label = "short", stop_time = 0.7 }, { label = "long" }]
"""


@pytest.fixture
def several(project, study, tmp_path):
    """Function that runs the study over a scenario with three kinds of expectations."""

    def run(stop="", factor="", window=0.2):
        scenarios = project / "scenarios"
        if scenarios.is_symlink():
            files = {file.name: file.read_bytes() for file in scenarios.iterdir()}
            scenarios.unlink()
            scenarios.mkdir()
            for name, data in files.items():
                (scenarios / name).write_bytes(data)
        (scenarios / "several.toml").write_text(SCENARIO)
        path = study(STUDY.format(stop=stop, factor=factor, window=window))
        return sweep(path, out=tmp_path / "out", workers=1, force=True)

    return run


@pytest.mark.parametrize("how", ["until", "stop_time"])
@pytest.mark.parametrize(("end", "held"), [(0.4, 1), (1.0, 2), (2.0, 3)])
def test_a_run_names_the_part_that_it_judges(several, project, how, end, held):
    several(f"stop_time = {end}")
    done = run("several", out=project / "run", **{how: end})
    part = "" if end == 2.0 else f" Judged on 0 to {end:g} s of 2 s."
    sentence = (
        "All 3 expectations hold." if held == 3 else f"{held} of 3 hold, {3 - held} not reached."
    )
    assert f"PASS. {sentence}{part}" in repr(done)
    page = (project / "run" / "report.html").read_text(encoding="utf-8")
    assert f"{sentence}{part}" in page
    # A run of the study alone says the same.
    again = PlannedStudy(project / "studies" / "own.toml", out=project / "again").prepare(0)
    assert f"{sentence}{part}" in repr(again.judged(simulate(again.system, again.scenario)))


@pytest.mark.parametrize(
    ("stop", "late", "is_part"), [(2.0, 0, False), (1.0, 1, True), (0.7, 2, True), (0.4, 2, True)]
)
def test_expectations_beyond_a_studys_end_are_counted_and_parts_named(several, stop, late, is_part):
    done = several(f"stop_time = {stop}")
    assert done.runs["held"].all()
    remarks = "; ".join(done.about.get("remarks", ()))
    assert (f"held: {late} of 3 expectations of several are not judged" in remarks) == (late > 0)
    assert (f"judged on the first {stop:g} s of its 2 s" in remarks) == is_part
    page = (done.folder / "report.html").read_text(encoding="utf-8")
    assert ("not judged: they need more than" in page) == (late > 0)


def test_a_case_that_ends_early_has_no_verdict(several):
    done = several(factor=CASES, window=1.0)
    held = done.runs.set_index("length")["held"]
    assert held["long"].all() and held["short"].isna().all()
    late = done.runs.set_index("length")["late"]
    assert late["long"].notna().all() and late["short"].isna().all()
    remarks = "; ".join(done.about["remarks"])
    assert "held: 2 of 4 runs end before 2 s and have no value" in remarks
    assert "late: 2 of 4 runs end before 1 s and have no value" in remarks
    shares = done.summary.set_index("length")["share"]
    assert shares["long"] == 1.0 and shares.isna()["short"]
    assert json.loads((done.folder / "study.json").read_text())["remarks"]


def test_a_window_that_no_run_reaches_is_an_error(several):
    with pytest.raises(ShipcosimError, match="during lies beyond the end of the runs at 2 s"):
        several(window=3.0)
