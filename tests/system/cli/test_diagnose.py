"""The command `diagnose` on logs of the independent truth: verdict, exit code, files, and what it refuses."""

import json
import os
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Literal

import pytest
from pydantic import BaseModel, ConfigDict, Field
from typer.testing import CliRunner

import shipcosim.calls.logs as calls
import shipcosim.cli.diagnosis as command
from shipcosim.cli import app
from shipcosim.cli.progress import LAST_STEP
from shipcosim.diagnose.pipeline import STEPS
from shipcosim.diagnose.validation.cosimulation import MOST
from shipcosim.report.diagnosis.testability import visible_rows
from shipcosim.report.diagnosis.words import title
from shipcosim.report.theme.numbers import metres
from shipcosim.ssp import read_system
from truth import draw

FILES = ["diagnosis.json", "extended.ssp", "extended.ssv", "report.html"]
USED = ("build", "fmus", "ssp")
MINUTES = 12


class Strict(BaseModel):
    """What must be there and nothing else."""

    model_config = ConfigDict(extra="forbid")


class Estimate(Strict):
    estimate: float
    std: float
    unit: str


class Candidate(Strict):
    cause: str
    component: str | None
    probability: float


class Finding(Candidate):
    kind: Literal["data", "physics"]
    alternatives: list[str] | None = None
    parameters: dict[str, Estimate]
    segments: list[tuple[float, float]] | None = None
    channels: list[str] | None = None
    onset: float | None = None
    note: str | None = None
    at_reference: dict[str, Estimate] | None = None


class ExperimentDesign(Strict):
    manoeuvre: str
    minutes: float
    separates: list[tuple[str, str]]


class Baseline(Strict):
    horizon_s: list[float]
    position_error_m: list[float]
    heading_error_deg: list[float]


class Gain(Strict):
    horizon_s: float
    before_m: float
    bias_observer_m: float
    after_m: float
    noise_floor_m: float
    share_of_explainable: float | None
    ci95: tuple[float, float] | None


class Discrepancy(Strict):
    what: str
    component: str | None
    axis: Literal["surge", "sway", "yaw"] | None
    estimate: float
    std: float
    unit: str
    share: float


class FormNumber(Strict):
    number: str
    what: str
    model: float
    estimate: float
    std: float
    unit: str


class LoadForm(Strict):
    scale: float
    differs: dict[str, float]
    numbers: list[FormNumber]
    hides: list[str]
    horizon_s: float | None = None
    before_m: float | None = None
    after_m: float | None = None


class VisibleSize(Strict):
    cause: str
    component: str | None
    parameter: str
    size: float = Field(gt=0.0)
    unit: str
    largest: float = Field(gt=0.0)


class Schema(Strict):
    """diagnosis.json, version 1."""

    version: Literal["shipcosim-diagnosis/1"] = Field(alias="schema")
    verdict: Literal["consistent", "form", "named", "ambiguous", "unknown"]
    findings: list[Finding]
    discrepancies: list[Discrepancy]
    form: LoadForm | None
    craft: dict | None = None
    healthy_errors: dict | None = None
    candidates: list[Candidate]
    indistinguishable: list[Candidate]
    not_testable: list[str]
    smallest_visible: list[VisibleSize] = []
    prescription: ExperimentDesign | None
    baseline: Baseline | None
    gain: Gain | None


EXAMPLE = """{
  "schema": "shipcosim-diagnosis/1", "verdict": "named",
  "findings": [{"cause": "current", "component": null, "kind": "physics", "probability": 0.97, "parameters":
    {"north": {"estimate": 0.21, "std": 0.02, "unit": "m/s"},
     "east": {"estimate": -0.10, "std": 0.02, "unit": "m/s"}}}],
  "discrepancies": [], "form": null, "candidates": [{"cause": "current", "component": null, "probability": 0.97}],
  "indistinguishable": [], "not_testable": ["mass", "reverse_loss"], "prescription": null,
  "baseline": {"horizon_s": [10, 30, 60], "position_error_m": [0.3, 1.1, 3.2], "heading_error_deg": [0.2, 0.7, 1.6]},
  "gain": {"horizon_s": 60, "before_m": 3.2, "bias_observer_m": 1.9, "after_m": 0.9, "noise_floor_m": 0.6,
    "share_of_explainable": 0.88, "ci95": [0.80, 0.93]}
}"""  # of contracts.md, and what the log shows by itself


@pytest.fixture(scope="module")
def like_the_root(root, built, tmp_path_factory):
    """A folder in which the project's FMUs and systems are found."""
    folder = tmp_path_factory.mktemp("project")
    for name in USED:
        (folder / name).symlink_to(root / name)
    return folder


@pytest.fixture(scope="module")
def ran(like_the_root):
    """Function that diagnoses a drawn log in there: exit code, stdout, folder of the results, what was found."""

    def run(name, case, *options):
        case.save(like_the_root / f"{name}.csv")
        diagnoses, diagnose = [], calls.diagnose

        def kept(*arguments, **more):
            diagnoses.append(diagnose(*arguments, **more))
            return diagnoses[-1]

        with pytest.MonkeyPatch.context() as patch:
            patch.chdir(like_the_root)
            patch.setenv("COLUMNS", "200")
            patch.setattr(calls, "diagnose", kept)
            result = CliRunner().invoke(
                app, ["diagnose", f"{name}.csv", *options], prog_name="shipcosim"
            )
        assert result.exception is None or isinstance(result.exception, SystemExit), (
            result.exception
        )
        out = like_the_root / "results" / name
        return SimpleNamespace(
            code=result.exit_code,
            out=result.stdout,
            err=result.stderr,
            folder=out,
            diagnosis=diagnoses[0],
        )

    return run


@pytest.fixture(scope="module")
def lossy(ran):
    """A thruster that has lost a third of its thrust."""
    return ran("lossy", draw("trial", 3000, among=["thrust_loss"], minutes=MINUTES), "--json")


@pytest.fixture(scope="module")
def healthy(ran, like_the_root):
    """A healthy ship, diagnosed into a folder with what an earlier diagnosis left."""
    old = like_the_root / "results" / "healthy"
    old.mkdir(parents=True)
    for name in FILES:
        (old / name).write_text("old", encoding="utf-8")
    return ran("healthy", draw("trial", 3007, causes=0, minutes=MINUTES))


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_hidden_cause_is_named_with_exit_code_1_and_four_files(lossy):
    answer = draw("trial", 3000, among=["thrust_loss"], minutes=MINUTES).answer[0]
    found = json.loads(lossy.out)
    assert lossy.code == 1 and names(lossy.folder) == FILES
    steps = [*STEPS, LAST_STEP]  # where no terminal is: a line for each but the first
    assert (
        lossy.err.splitlines()
        == [f"{k} of {len(steps)}: {step}" for k, step in enumerate(steps, 1)][1:]
    )
    assert found["verdict"] == "named" and len(found["findings"]) == 1
    finding = found["findings"][0]
    assert (finding["cause"], finding["component"]) == (answer.cause, answer.component)
    assert finding["parameters"]["loss"]["estimate"] == pytest.approx(
        answer.parameters["loss"], rel=0.15
    )


def test_json_holds_what_the_contract_says(lossy, healthy):
    Schema.model_validate_json(EXAMPLE)
    for ran in (lossy, healthy):
        Schema.model_validate_json((ran.folder / "diagnosis.json").read_text(encoding="utf-8"))
    assert json.loads(lossy.out) == json.loads(
        (lossy.folder / "diagnosis.json").read_text(encoding="utf-8")
    )


def test_named_cause_gains_over_the_plain_model_and_the_bias_observer(lossy):
    gain = json.loads(lossy.out)["gain"]
    assert gain["after_m"] < 0.5 * gain["before_m"] and gain["after_m"] < gain["bias_observer_m"]
    assert gain["ci95"][0] <= gain["share_of_explainable"] <= gain["ci95"][1]
    predictions = lossy.diagnosis.predictions
    assert (
        predictions.is_simulated and predictions.difference > 0.0
    )  # by co-simulation of the extended system
    assert all(0 < one.predictions <= MOST // 2 and one.gain for one in predictions.held_out)


def test_a_number_has_one_value_in_terminal_page_and_json(lossy, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    command.print_diagnosis(lossy.diagnosis, lossy.folder)
    terminal = capsys.readouterr().out
    page = (lossy.folder / "report.html").read_text(encoding="utf-8")
    shown = re.sub(r"<(script|style).*?</\1>|<[^>]+>", " ", page, flags=re.DOTALL)
    found = json.loads(lossy.out)
    gain = found["gain"]
    assert found["baseline"]["position_error_m"][-1] == gain["before_m"]
    errors = [
        metres(gain[f"{name}_m"]) for name in ("before", "bias_observer", "after", "noise_floor")
    ]
    for text in (terminal, shown):
        assert all(error in text for error in errors)
    # Wherever an error after this time stands in a sentence or a heading, it is the one of the simulation.
    assert set(re.findall(r"(?<!at most )(?<![\d.])([\d.]+ m)\s+after 60 s", shown)) == {errors[0]}


def test_extended_system_differs_from_the_given_one_in_the_named_number_alone(lossy, root, built):
    given = read_system(root / "ssp" / "gunnerus_open", fmus=[built])
    extended = read_system(lossy.folder / "extended.ssp")
    loss = json.loads(lossy.out)["findings"][0]["parameters"]["loss"]["estimate"]
    changed = {
        f"{name}.{variable}": value
        for name, component in extended.components.items()
        for variable, value in component.start.items()
        if value != given.components[name].start_value(variable)
    }
    assert changed == {"starboard.thrust_loss": pytest.approx(loss)}
    assert set(extended.components) == set(given.components)


def test_extended_system_runs(lossy, call, monkeypatch):
    monkeypatch.chdir(lossy.folder.parents[1])
    run = call(
        "simulate",
        lossy.folder / "extended.ssp",
        "--stop-time",
        "1",
        "--step-size",
        "0.1",
        "--out",
        "run",
    )
    assert run.code == 0, run.err


def test_healthy_log_is_consistent_with_exit_code_0_and_leaves_no_extended_system(healthy):
    assert healthy.code == 0 and healthy.out.startswith("CONSISTENT ")
    assert names(healthy.folder) == ["diagnosis.json", "report.html"]
    assert "old" not in (healthy.folder / "diagnosis.json").read_text(encoding="utf-8")


def test_summary_says_cause_size_gain_and_what_to_do(lossy, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    command.print_diagnosis(lossy.diagnosis, lossy.folder)
    said = capsys.readouterr().out
    for text in (
        "NAMED ",
        "starboard thruster delivers",
        "Thrust loss of starboard",
        " ± ",
        "% ",
        "bias observer",
    ):
        assert text in said
    assert "What to do next" in said and "extended.ssp" in said and "report.html" in said


def test_summary_of_a_healthy_log_says_what_it_could_not_have_shown(healthy):
    for name in healthy.diagnosis.not_testable:
        assert name.replace("_", " ") in healthy.out
    page = (healthy.folder / "report.html").read_text(encoding="utf-8")
    hidden = healthy.diagnosis.not_testable
    for cause, sizes in visible_rows(healthy.diagnosis.smallest_visible, hidden):
        assert cause in healthy.out and sizes.split(", ")[0] in healthy.out and sizes in page
    seen = healthy.out.partition("Smallest fault")[2]
    assert not any(title(name) + "  " in seen for name in hidden)
    assert "Thrust loss  " in healthy.out
    assert "Errors" in healthy.out and "Page: " in healthy.out


@pytest.mark.parametrize("error", [KeyboardInterrupt, RuntimeError("disk on fire")])
def test_diagnosis_that_is_cut_off_leaves_everything_as_it_was(
    lossy, like_the_root, call, monkeypatch, error
):
    """At the last moment, when the extended system is there and the page is written."""

    def known(*_, out, **__):
        (out / "extended.ssp").write_bytes(b"new")
        return lossy.diagnosis

    def cut_off(*_):
        raise error

    monkeypatch.chdir(like_the_root)
    monkeypatch.setattr("shipcosim.diagnose.pipeline.diagnose", known)
    monkeypatch.setattr("shipcosim.report.diagnosis.page.render", cut_off)
    before = {path.name: path.read_bytes() for path in lossy.folder.iterdir()}
    done = call("diagnose", "lossy.csv")
    assert done.code == (130 if error is KeyboardInterrupt else 2) and "Traceback" not in done.err
    assert {path.name: path.read_bytes() for path in lossy.folder.iterdir()} == before
    assert call("diagnose", "lossy.csv", "--out", "fresh").code != 0
    assert not Path("fresh").exists()


HEAD = "time [s],north [m],east [m],heading [deg],surge [m/s],wind_speed [m/s]"


def table(head, rows=300):
    return (
        "\n".join([head, *(",".join([str(k), *["1.5"] * head.count(",")]) for k in range(rows))])
        + "\n"
    )


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", ["log.csv:", "is empty"]),
        (HEAD + "\n", ["log.csv:", "no row below its header"]),
        (
            table(HEAD.replace("north [m],east [m],", "")),
            ["log.csv:", "no channel north, east", "needs north, east", "shipcosim channels"],
        ),
        (
            table(HEAD.replace("time [s]", "number")),
            ["log.csv:", "has no column 'time'", "shipcosim channels"],
        ),
        (
            table(HEAD.replace("[m/s]", "[kg]")),
            ["log.csv, surge:", "its unit 'kg' is none that converts to m/s"],
        ),
        (table(HEAD, rows=60), ["log.csv:", "60 rows over 59 s", "at the least"]),
    ],
    ids=["empty", "only a header", "no position", "no time", "other units", "too short"],
)
def test_unusable_data_is_refused_and_leaves_nothing(
    call, like_the_root, tmp_path, monkeypatch, content, said
):
    monkeypatch.chdir(like_the_root)
    (tmp_path / "log.csv").write_text(content, encoding="utf-8")
    done = call("diagnose", tmp_path / "log.csv", "--out", tmp_path / "out")
    assert (
        done.code == 2 and done.err.startswith("error: ") and "fault of shipcosim" not in done.err
    )
    for text in said:
        assert text in done.err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["absent.csv"], ["absent.csv:", "no such file of measured data"]),
        (["log.csv", "--channels", "absent.toml"], ["absent.toml:", "no such channel file"]),
        (["log.csv", "--effects", "absent"], ["absent:", "no such folder of causes"]),
        (
            ["log.csv", "--system", "gunnerus_opn"],
            ["gunnerus_opn:", "no such system", "Did you mean 'gunnerus_open'?"],
        ),
        (["log.csv", "--system", "log.csv"], ["log.csv:"]),
        (["log.csv", "--out", "log.csv"], ["log.csv", "is a file, not a folder", "--out"]),
    ],
    ids=lambda value: " ".join(value) if value[0].endswith(".csv") else "",
)
def test_unusable_arguments_are_refused_and_leave_nothing(
    call, root, built, tmp_path, monkeypatch, options, said
):
    for name in USED:
        (tmp_path / name).symlink_to(root / name)
    monkeypatch.chdir(tmp_path)
    Path("log.csv").write_text(table(HEAD), encoding="utf-8")
    done = call("diagnose", *options)
    assert (
        done.code == 2 and done.err.startswith("error: ") and "fault of shipcosim" not in done.err
    )
    for text in said:
        assert text in done.err
    assert sorted(os.listdir()) == sorted(
        ["log.csv", *USED, *(["results"] if Path("results").exists() else [])]
    )
    assert not list(Path().glob("results/*"))


def test_without_a_project_the_systems_of_the_package_are_there(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("log.csv").write_text(table(HEAD), encoding="utf-8")
    assert "There is no such system" not in call("diagnose", "log.csv").err
    done = call("diagnose", "log.csv", "--system", "gunnerus_opn")
    assert done.code == 2 and "--system" in done.err and "Did you mean 'gunnerus_open'?" in done.err


def test_help_names_the_exit_codes_and_options(call):
    said = call("diagnose", "--help").out
    assert "Exit codes" in said
    assert all(
        option in said
        for option in ("--channels", "--system", "--effects", "--out", "--json", "--debug")
    )
