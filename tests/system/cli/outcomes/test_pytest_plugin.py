"""Scenarios as tests of pytest: what is collected, what a failure says, what CI of a new project does."""

import os
import shlex
import subprocess
import sys
import tomllib
from importlib import import_module
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml

SECOND = """
[[expect]]
signal   = "lag.y"
at_most  = 0.9
"""
OTHERS = {
    "pyproject.toml": '[project]\nname = "tank"\nversion = "1"\n',
    "scenarios/pyproject.toml": '[tool.pytest.ini_options]\naddopts = "-q"\n',
    "scenarios/channels.toml": 'time = "t"\nnorth = "N"\n',
    "scenarios/study.toml": 'scenario = "fill"\n[set]\n"lag.u" = 1.0\n',
    "scenarios/notes.toml": "this is = = no TOML\n",
    "settings.toml": 'system = "x"\nstop_time = 1.0\nstep_size = 0.1\n',
}


def run_pytest(*arguments, **variables):
    """What pytest says, and its exit code; the plugin is loaded as its entry point does it."""
    command = [sys.executable, "-m", "pytest", "-p", "shipcosim.pytest_plugin", "-rA", *arguments]
    environment = os.environ | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"} | variables
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    return done.stdout + done.stderr, done.returncode


@pytest.fixture
def counted(project):
    """The project, whose FMU writes a line each time that it starts, with a second expectation that is missed."""
    fmu = project / "fmus" / "lag" / "lag.py"
    note = '        with open("starts", "a") as file:\n            file.write("start\\n")\n'
    fmu.write_text(
        fmu.read_text().replace("    def start(self):\n", f"    def start(self):\n{note}")
    )
    scenario = project / "scenarios" / "fill.toml"
    scenario.write_text(scenario.read_text() + SECOND)
    return project


def test_each_expectation_is_a_test_and_each_file_runs_once(counted):
    said, code = run_pytest("scenarios", "--junit-xml=junit.xml")
    assert code == 1 and "1 failed, 2 passed" in said
    assert Path("starts").read_text() == "start\n"
    missed = ElementTree.parse("junit.xml").getroot().find(".//testcase/failure/..")
    assert missed.get("name") == "lag.y ≤ 0.9"
    text = missed.find("failure").text
    page = "results/tests/fill/report.html"
    for part in ("lag.y", "≤ 0.9 m", "worst 1 m at 5 s", f"Page: {page}"):
        assert part in text, part
    assert Path(page).is_file() and missed.find("properties/property").get("value") == page
    assert "Traceback" not in said and f"Pages of scenarios: {page}" in said


def test_one_expectation_runs_alone_by_its_name(counted):
    said, code = run_pytest("scenarios", "-k", "within")
    assert code == 0 and "1 passed, 2 deselected" in said


def test_pages_lie_in_the_project_wherever_pytest_is_started(counted, monkeypatch):
    monkeypatch.chdir("scenarios")
    run_pytest()
    assert (counted / "results" / "tests" / "fill" / "report.html").is_file()


def test_other_files_in_toml_are_none_of_its_business(project):
    for name, text in OTHERS.items():
        (project / name).write_text(text)
    said, code = run_pytest("--collect-only", "-q", ".")
    collected = {line.partition("::")[0] for line in said.splitlines() if "::" in line}
    assert code == 0 and collected == {"scenarios/fill.toml"}


def test_scenario_beside_no_folder_of_scenarios_is_collected_where_it_is_named(project):
    Path("scenarios/fill.toml").rename("fill.toml")
    assert "no tests collected" in run_pytest("--collect-only", "-q", ".")[0]
    assert "2 tests collected" in run_pytest("--collect-only", "-q", "fill.toml")[0]


def test_broken_scenario_is_one_failed_test_and_the_others_run(project):
    text = Path("scenarios/fill.toml").read_text()
    Path("scenarios/broken.toml").write_text(text.replace("step_size", "step_siz"))
    said, code = run_pytest("scenarios")
    assert code == 1 and "1 failed, 2 passed" in said
    assert "broken.toml, line 4" in said and "Did you mean 'step_size'?" in said


def test_run_that_breaks_fails_all_its_tests_and_says_why_and_where_the_page_is(project):
    text = Path("scenarios/fill.toml").read_text()
    Path("scenarios/fill.toml").write_text(text.replace("[set]", '[set]\n"lag.fails_at" = 1.0'))
    said, code = run_pytest("scenarios")
    assert code == 1 and "2 failed" in said and "the pump has run dry" in said
    assert "Page: results/tests/fill/result-partial.html" in said


def test_summary_of_a_step_has_the_expectations(counted):
    run_pytest("scenarios", GITHUB_STEP_SUMMARY="summary.md")
    lines = Path("summary.md").read_text(encoding="utf-8").splitlines()
    assert sum("✅" in line for line in lines) == 2
    (missed,) = [line for line in lines if "❌" in line]
    assert "lag.y ≤ 0.9" in missed and "worst 1 m at 5 s" in missed


def test_pytest_finds_the_plugin_by_the_entry_point(root):
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    (module,) = project["entry-points"]["pytest11"].values()
    assert import_module(module).pytest_collect_file


def test_job_of_a_new_project_installs_runs_and_keeps_the_pages(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert call("init", ".").code == 0
    text = Path(".github/workflows/scenarios.yml").read_text(encoding="utf-8")
    steps = yaml.safe_load(text)["jobs"]["scenarios"]["steps"]
    install, tests = [shlex.split(step["run"]) for step in steps if "run" in step]
    assert install[:3] == ["pip", "install", "pytest"] and "shipcosim" in install[-1]
    # What cannot be on PyPI yet comes from a folder of the project or from a repository.
    assert "--find-links" in install or install[-1].startswith("git+")
    assert tests[0] == "pytest"
    Path("scenarios/loaded.toml").unlink()
    said, code = run_pytest(*tests[1:])
    assert code == 0 and "3 passed" in said
    kept = steps[-1]["with"]["path"].split()
    for name in (
        "junit.xml",
        "tests/hold_position/report.html",
        "tests/hold_position/verdict.json",
    ):
        assert any(Path("results", name) in Path().glob(pattern) for pattern in kept), name
