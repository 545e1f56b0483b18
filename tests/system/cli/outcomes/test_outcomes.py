"""What CI gets of a command: JSON, verdict.json, JUnit, the summary on GitHub, a quiet terminal."""

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

LATE = """
[[expect]]
signal   = "lag.y"
at_least = 2.0
during   = [4.5, 5.0]
"""
STUDY = """scenario = "fill"

[[factor]]
name = "constant"
signal = "lag.time_constant"
values = [0.5, 1.0]

[[factor]]
name = "end"
signal = "lag.fails_at"
values = [2.0, 9.0]

[[quantity]]
name = "level"
signal = "lag.y"
reduce = "final"
"""
SLOW = ["--set", "lag.time_constant=50"]
DRY = ["--set", "lag.fails_at=2.0"]


def cases_in(file="junit.xml"):
    """Status and text of each testcase by its name, and the suite."""
    (suite,) = ElementTree.parse(file).getroot()
    cases = {}
    for case in suite:
        (child,) = list(case) or [None]
        status = "passed" if child is None else child.tag
        cases[case.get("name")] = status, "" if child is None else child.text
    return cases, suite


def test_verdict_json_says_signal_limit_worst_value_and_time(call, project):
    assert call("run", "fill", *SLOW).code == 1
    found = json.loads(Path("results/fill/verdict.json").read_text(encoding="utf-8"))
    (level,) = found["expectations"]
    assert found["verdict"] == "failed" and found["schema"] == "shipcosim-verdict/1"
    assert level["signal"] == ["lag.y"] and level["near"] == [1.0] and level["within"] == 0.05
    assert level["during"] == [4.0, 5.0] and level["unit"] == "m" and not level["passed"]
    # A lag of 50 s has hardly begun to rise at the start of the window, where the distance is largest.
    assert level["worst"] == pytest.approx(0.923, abs=1e-3) and level["time"] == 4.0
    assert found["changed"] == ["lag.time_constant = 50"] and found["end"] == 5.0
    assert sorted(found["files"]) == sorted(path.name for path in Path("results/fill").iterdir())


@pytest.mark.parametrize("more", [[], SLOW, DRY, ["--until", "2"]])
def test_json_on_stdout_is_verdict_json_and_nothing_else(call, project, more):
    done = call("run", "fill", *more, "--json")
    assert done.out == Path("results/fill/verdict.json").read_text(encoding="utf-8")
    ends = {(): "passed", tuple(SLOW): "failed", tuple(DRY): "partial", ("--until", "2"): "done"}
    assert json.loads(done.out)["verdict"] == ends[tuple(more)]


def test_run_that_breaks_says_why_in_its_verdict_and_lists_what_it_left(call, project):
    failed = call("run", "fill", *DRY, "--json", "--junit", "junit.xml")
    found = json.loads(failed.out)
    assert failed.code == 1 and "the pump has run dry" in failed.err
    assert "the pump has run dry" in found["errors"][0] and found["expectations"] == []
    assert found["page"] == "result-partial.html"
    assert sorted(found["files"]) == sorted(path.name for path in Path("results/fill").iterdir())
    cases, _ = cases_in()
    status, text = cases["runs to its end"]
    assert status == "error" and "the pump has run dry" in text
    assert "results/fill/result-partial.html" in text


def test_a_verdict_of_an_earlier_run_does_not_stay_beside_a_run_that_breaks(call, project):
    call("run", "fill")
    call("run", "fill", *DRY)
    verdicts = [
        json.loads(Path(f"results/{name}/verdict.json").read_text(encoding="utf-8"))["verdict"]
        for name in ("fill", "fill-1")
    ]
    assert verdicts == ["partial", "passed"]


def test_junit_says_of_a_missed_expectation_signal_limit_worst_value_time_and_page(call, project):
    scenario = project / "scenarios" / "fill.toml"
    scenario.write_text(scenario.read_text() + LATE)
    assert call("run", "fill", "--junit", "deep/junit.xml").code == 1
    cases, suite = cases_in("deep/junit.xml")
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("3", "1", "0")
    assert cases["lag.y: 1 ± 0.05 m during 4 to 5 s"] == ("passed", "")
    status, text = cases["lag.y ≥ 2 m during 4.5 to 5 s"]
    assert status == "failure"
    for part in ("lag.y", "≥ 2 m", "worst 1 m", "at 4.5 s", "Page: results/fill/report.html"):
        assert part in text, part


def test_expectation_that_a_run_did_not_reach_is_a_skipped_testcase(call, project):
    assert call("run", "fill", "--until", "2", "--junit", "junit.xml").code == 0
    cases, suite = cases_in()
    status, text = cases["lag.y: 1 ± 0.05 m during 4 to 5 s"]
    assert status == "skipped" and "from 0 to 2 s" in text and suite.get("skipped") == "1"


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["run", "fill"], 0),
        (["run", "fill", *SLOW], 1),
        (["run", "fill", *DRY], 1),
        (["run", "fil"], 2),
        (["run", "fill", "--set", "lag.nothing=1"], 2),
        (["run", "scenarios"], 0),
        (["run", "scenarios", *SLOW], 1),
        (["run", ".", *DRY], 1),
        (["simulate", "tank", "--stop-time", "1", "--step-size", "0.1"], 0),
        (["sweep", "ends", "--engine", "fmpy", "--workers", "1"], 1),
        (["check", "fill", "tank"], 0),
        (["check", "fill", "broken.toml"], 1),
        (["compare", "fill"], 0),
    ],
)
def test_exit_code_junit_and_quiet_agree(call, project, monkeypatch, arguments, code):
    (project / "studies").mkdir()
    (project / "studies" / "ends.toml").write_text(STUDY)
    (project / "broken.toml").write_text('system = "tank"\nstop_tme = 1.0\n')
    call("build")
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", "summary.md")
    done = call(*arguments, "--junit", "junit.xml", "--quiet")
    assert done.code == code
    cases, suite = cases_in()
    bad = [name for name, (status, _) in cases.items() if status in ("failure", "error")]
    assert bool(bad) == (code > 0) and int(suite.get("tests")) == len(cases) > 0
    summary = Path("summary.md").read_text(encoding="utf-8")
    assert summary.count("❌") == len(bad) and all(name in summary for name in bad)
    # Only the verdict line on stdout, only what is wrong on stderr.
    assert done.out.count("\n") == (code < 2)
    assert ("error:" in done.err) == (done.err != "")


def test_every_run_of_a_study_is_a_testcase_with_its_values(call, project):
    (project / "studies").mkdir()
    (project / "studies" / "ends.toml").write_text(STUDY)
    done = call("sweep", "ends", "--engine", "fmpy", "--workers", "1", "--json", "--junit", "j.xml")
    found = json.loads(done.out)
    assert done.out == Path("results/ends/verdict.json").read_text(encoding="utf-8")
    assert found["runs"] == {"planned": 4, "done": 4, "failed": 2} and found["verdict"] == "failed"
    assert sorted(found["files"]) == sorted(path.name for path in Path("results/ends").iterdir())
    cases, _ = cases_in("j.xml")
    assert [status for status, _ in cases.values()] == ["error", "passed", "error", "passed"]
    assert "the pump has run dry" in cases["run 0: constant 0.5, end 2.0"][1]


def test_file_with_an_error_is_a_failed_testcase_with_line_and_remedy(call, project):
    (project / "broken.toml").write_text('system = "tank"\nstop_tme = 1.0\nstep_size = 0.1\n')
    call("build")
    assert call("check", "fill", "broken.toml", "--junit", "j.xml").code == 1
    cases, _ = cases_in("j.xml")
    assert cases["fill"][0] == "passed" and cases["broken.toml"][0] == "failure"
    assert "line 2" in cases["broken.toml"][1] and "stop_time" in cases["broken.toml"][1]


def test_signal_that_differs_between_engines_is_a_failed_testcase(call, project, monkeypatch):
    from shipcosim.cosim import ENGINES

    def doubled(system, scenario, options):
        table = ENGINES["fmpy"](system, scenario, options)
        return table.assign({"lag.y": 2.0 * table["lag.y"]})

    for name in set(ENGINES) - {"fmpy"}:
        monkeypatch.delitem(ENGINES, name)
    monkeypatch.setitem(ENGINES, "other", doubled)
    assert call("compare", "fill", "--junit", "j.xml").code == 1
    status, text = cases_in("j.xml")[0]["lag.y"]
    assert (
        status == "failure" and "other differs from ours by 1 m" in text and "limit 1e-09" in text
    )


def test_findings_of_a_diagnosis_are_failed_testcases_and_json_is_diagnosis_json(
    call, tmp_path, monkeypatch, six_minutes
):
    monkeypatch.chdir(tmp_path)
    six_minutes("log.csv")
    done = call("diagnose", "log.csv", "--json", "--junit", "j.xml", "--out", "out")
    assert done.out == Path("out/diagnosis.json").read_text(encoding="utf-8")
    found = json.loads(done.out)
    cases, _ = cases_in("j.xml")
    failed = [name for name, (status, _) in cases.items() if status == "failure"]
    assert bool(failed) == (found["verdict"] != "consistent") == (done.code == 1)
    for finding in found["findings"]:
        assert any(finding["cause"] in name for name in failed), finding["cause"]


def test_run_of_a_project_runs_all_its_scenarios_and_says_all_in_one_file(call, project):
    inner = project / "scenarios" / "storms"
    inner.mkdir()
    text = (project / "scenarios" / "fill.toml").read_text()
    (inner / "slow.toml").write_text(text.replace("= 0.5", "= 50.0"))
    (project / "pyproject.toml").write_text("[project]\nname = 'tank'\n")
    done = call("run", ".", "--json", "--junit", "j.xml", "--out", "out")
    found = json.loads(done.out)
    assert done.code == 1 and [one["name"] for one in found["scenarios"]] == ["fill", "storms/slow"]
    assert done.out == Path("out/verdict.json").read_text(encoding="utf-8")
    assert Path("out/storms/slow/report.html").is_file()
    (suite,) = ElementTree.parse("j.xml").getroot()
    (failed,) = [case for case in suite if case.find("failure") is not None]
    assert failed.get("classname").endswith(".storms/slow")
    assert "Page: out/storms/slow/report.html" in failed.find("failure").text


BROKEN = {
    "name": lambda text: text.replace("lag.y", "lag.z"),
    "TOML": lambda text: text + "[",
    "bytes": lambda text: "\x00" + text,
    "key": lambda text: "stoptime = 3\n" + text,
    "empty": lambda text: "",
}


@pytest.mark.parametrize("fault", BROKEN)
@pytest.mark.parametrize("form", [[], ["--json"], ["-q"]])
def test_a_scenario_that_cannot_be_read_is_named_and_the_others_run(call, project, fault, form):
    text = (project / "scenarios" / "fill.toml").read_text()
    for name in ("a", "z"):
        (project / "scenarios" / f"{name}.toml").write_text(BROKEN[fault](text))
    failed = call("run", "scenarios", "--junit", "j.xml", *form)
    assert failed.code == 2 and "a.toml" in failed.err and "z.toml" in failed.err
    found = json.loads(Path("results/scenarios/verdict.json").read_text(encoding="utf-8"))
    assert found["verdict"] == "failed" and list(found["refused"]) == ["a", "z"]
    assert found["scenarios"][0]["name"] == "fill"
    assert Path("results/scenarios/fill/report.html").is_file()
    page = Path("results/scenarios/report.html").read_text(encoding="utf-8")
    assert "2 of 3 scenarios miss something: a, z." in page
    cases = ElementTree.parse("j.xml").getroot()[0]
    assert {
        case.get("classname").rpartition(".")[2] for case in cases if case.find("error") is not None
    } == {"a", "z"}


def test_a_folder_of_broken_scenarios_is_one_error(call, project):
    (project / "scenarios" / "fill.toml").write_text("[")
    assert call("run", "scenarios").code == 2 and not (project / "results").exists()


def test_a_run_that_breaks_does_not_keep_the_others_of_its_folder_from_running(call, project):
    text = (project / "scenarios" / "fill.toml").read_text()
    dry = text.replace("[set]", '[set]\n"lag.fails_at" = 1.0')
    (project / "scenarios" / "a_dry.toml").write_text(dry)
    failed = call("run", "scenarios")
    assert failed.code == 1 and "1 of 2 scenarios miss something: a_dry." in failed.out
    assert Path("results/scenarios/fill/report.html").is_file()


def test_file_of_junit_that_is_a_folder_is_refused_before_the_run(call, project):
    failed = call("run", "fill", "--junit", "scenarios")
    assert failed.code == 2 and "--junit" in failed.err and not (project / "results").exists()


def test_short_help_is_the_long_one(call):
    for command in ([], ["run"], ["export", "fmu"], ["new", "scenario"]):
        assert call(*command, "-h").out == call(*command, "--help").out
        assert call(*command, "-h").code == 0


def test_words_for_several_are_those_of_the_list_command(call, project):
    said = call().out
    assert "studies " in said and "studys" not in said
