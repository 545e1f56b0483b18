"""A command and its call do the same work: the same files, byte for byte, the same verdict, the same remarks."""

import inspect
import os
import shutil
from pathlib import Path

import pytest
from diagnose.sea_trials import trials

import shipcosim as sc
from shipcosim.diagnose import calibration_pipeline, pipeline
from shipcosim.diagnose.sea_trials import separation, study

STUDY = """scenario = "fill"

[[factor]]
name = "constant"
signal = "lag.time_constant"
values = [0.5, 1.0]

[[quantity]]
name = "level"
signal = "lag.y"
reduce = "final"
"""
LATE = """
[[expect]]
signal   = "lag.y"
at_least = 0.9
during   = [4.5, 5.0]
"""
CASES = {
    "run": (
        ["run", "fill", "--out", "out"],
        lambda: sc.run("fill", out="out"),
    ),
    "run a part with other values": (
        ["run", "fill", "--set", "lag.time_constant=0.4 s", "--until", "4.2", "--out", "out"],
        lambda: sc.run("fill", set={"lag.time_constant": "0.4 s"}, until=4.2, out="out"),
    ),
    "run with other times": (
        ["run", "fill", "--stop-time", "6", "--step-size", "50 ms", "--every", "1", "--out", "out"],
        lambda: sc.run("fill", stop_time=6, step_size="50 ms", output_interval=1, out="out"),
    ),
    "run another FMU and a set": (
        ["run", "fill", "--component", "lag=lag", "--parameters", "fast.ssv", "--out", "out"],
        lambda: sc.run("fill", components={"lag": "lag"}, parameters=["fast.ssv"], out="out"),
    ),
    "run in another order": (
        ["run", "fill", "--order", "gauss-seidel", "--out", "out"],
        lambda: sc.run("fill", order="gauss-seidel", out="out"),
    ),
    "run native": (
        ["run", "fill", "--engine", "native", "--out", "out"],
        lambda: sc.run("fill", engine="native", out="out"),
    ),
    "run that misses what is expected": (
        ["run", "fill", "--set", "lag.time_constant=50", "--out", "out"],
        lambda: sc.run("fill", set={"lag.time_constant": 50}, out="out"),
    ),
    "run that fails on its way": (
        ["run", "fill", "--set", "lag.fails_at=2.0", "--out", "out"],
        lambda: sc.run("fill", set={"lag.fails_at": 2.0}, out="out"),
    ),
    "run with a state": (
        ["run", "fill", "--until", "2", "--store", "at2.state", "--out", "out"],
        lambda: sc.run("fill", until="2 s", store="at2.state", out="out"),
    ),
    "simulate a system": (
        [
            "simulate",
            "tank",
            "--stop-time",
            "2",
            "--step-size",
            "0.1",
            "--set",
            "lag.time_constant=2",
            "--out",
            "out",
        ],
        lambda: sc.simulate(
            "tank", stop_time=2, step_size="100 ms", set={"lag.time_constant": 2}, out="out"
        ),
    ),
    "simulate an FMU": (
        [
            "simulate",
            "lag",
            "--stop-time",
            "1",
            "--step-size",
            "0.1",
            "--set",
            "time_constant=2",
            "--out",
            "out",
        ],
        lambda: sc.simulate("lag", stop_time=1, step_size=0.1, set={"time_constant": 2}, out="out"),
    ),
    "simulate with a table": (
        ["simulate", "tank", "--stop-time", "2", "--step-size", "0.1", "--inputs", "inputs.csv"]
        + ["--interpolate", "level_set", "--out", "out"],
        lambda: sc.simulate(
            "tank",
            stop_time=2,
            step_size=0.1,
            inputs=sc.read_table("inputs.csv"),
            interpolate=["level_set"],
            out="out",
        ),
    ),
    "sweep": (
        ["sweep", "constants", "--engine", "fmpy", "--workers", "1", "--out", "out"],
        lambda: sc.sweep("constants", engine="fmpy", workers=1, out="out"),
    ),
}
OF_SHIPS = {
    "capability": (
        ["capability", "--failure", "port,tunnel", "--out", "out"],
        lambda: sc.capability(failures=[("port", "tunnel")], out="out"),
    ),
    "replay": (
        ["replay", "gunnerus_log", "--horizon", "60", "--out", "out"],
        lambda: sc.replay("gunnerus_log", horizon=60.0, out="out"),
    ),
    "diagnose": (
        ["diagnose", "log.csv", "--out", "out"],
        lambda: sc.diagnose("log.csv", out="out"),
    ),
    "sea-trials": (
        ["sea-trials", "trials.csv", "--orders", "--out", "out"],
        lambda: sc.sea_trials("trials.csv", orders=True, out="out"),
    ),
    "calibrate": (
        ["calibrate", "log.csv", "--out", "out"],
        lambda: sc.calibrate("log.csv", out="out"),
    ),
}
SET = """<?xml version="1.0" encoding="UTF-8"?>
<ssv:ParameterSet name="fast" version="1.0" xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">
  <ssv:Parameters>
    <ssv:Parameter name="lag.time_constant"><ssv:Real value="0.2"/></ssv:Parameter>
    <ssv:Parameter name="lag.nothing"><ssv:Real value="1.0"/></ssv:Parameter>
  </ssv:Parameters>
</ssv:ParameterSet>
"""


def files_in(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def both(command, call_in_python, call, folder):
    """What a command and its call leave, each in a folder of its own, and how they end."""
    left = {}
    for front in ("command", "call"):
        place = folder / front
        place.mkdir()
        for name in os.listdir(folder):
            if name not in ("command", "call"):
                (place / name).symlink_to(folder / name)
        os.chdir(place)
        if front == "command":
            done = call(*command)
            ended = done.code
        else:
            done, ended = in_python(call_in_python)
        left[front] = done, ended, files_in(place / "out")
    os.chdir(folder)
    return left["command"], left["call"]


def in_python(function):
    """What a call gives back and the exit code that its command should have."""
    try:
        result = function()
    except sc.ShipcosimError as error:
        has_rows = hasattr(error, "table") and error.table.sizes["time"]
        return error, 1 if has_rows else 2  # a run that fails on its way is no unusable input
    verdict = getattr(result, "verdict", "consistent")
    refused = bool(getattr(result, "refusals", ()))
    return result, int(not getattr(result, "passed", True) or verdict != "consistent" or refused)


def same_files(ours, theirs):
    assert sorted(ours) == sorted(theirs) and ours
    return [name for name in ours if ours[name] != theirs[name]]


@pytest.fixture
def tank(project):
    """The small project, with a study, a late expectation, a parameter set that fits in part, and a table."""
    scenario = project / "scenarios" / "fill.toml"
    scenario.write_text(scenario.read_text() + LATE)
    (project / "studies").mkdir()
    (project / "studies" / "constants.toml").write_text(STUDY)
    (project / "fast.ssv").write_text(SET)
    (project / "inputs.csv").write_text("time [s],level_set [m]\n0,0\n2,2\n")
    return project


@pytest.mark.parametrize("name", CASES)
def test_command_and_call_leave_the_same_files(name, tank, call):
    command, call_in_python = CASES[name]
    ours, theirs = both(command, call_in_python, call, tank)
    assert ours[1] == theirs[1], ours[0].err
    assert same_files(ours[2], theirs[2]) == [] and "verdict.json" in ours[2]


def write_trials(folder):
    planted = {"heavy to turn": {"vessel.inertia_yaw": 2.0 * 43e6}}
    log = trials.logs(planted, seed=3, until=480.0)["heavy to turn"]
    # Its first circle is enough for a study.
    sc.write_table(log.isel(time=slice(0, 365)), folder / "trials.csv")


def few_of_trials(monkeypatch):
    """Have a study of sea trials seek one cause and compute few next manoeuvres."""
    all_causes, all_manoeuvres = study.causes_of_trials, separation.catalogue

    def few_causes(model, catalogue, *, orders):
        causes = all_causes(model, catalogue, orders=orders)
        return [one for one in causes if one.cause == "yaw_inertia"]

    def few_manoeuvres(model):
        return [one for one in all_manoeuvres(model) if "35 deg" in one.name][:1]

    monkeypatch.setattr(study, "causes_of_trials", few_causes)
    monkeypatch.setattr(separation, "catalogue", few_manoeuvres)


WORK = {
    "diagnose": (pipeline, "diagnose"),
    "sea-trials": (study, "study"),
    "calibrate": (calibration_pipeline, "calibrate"),
}
"""What takes long of a command: both fronts must ask for the same of it, and it is worked out once."""


def work_out_once(monkeypatch, name, folder):
    """Have the second that asks for some work get what the first got, with the files; it must have asked alike.

    Returns what was asked for, one entry for each time.
    """
    module, function = WORK[name]
    work_out, asked, found = getattr(module, function), [], []

    def once(*arguments, **options):
        given = dict(inspect.signature(work_out).bind(*arguments, **options).arguments)
        out = given.pop("out", None)
        asked.append(given | {"progress": None, "system": given["system"].name})
        assert asked[-1] == asked[0]
        if not found:
            found.append(work_out(*arguments, **options))
            if out is not None:
                shutil.copytree(out, folder)
        elif out is not None:
            shutil.copytree(folder, out, dirs_exist_ok=True)
        return found[0]

    monkeypatch.setattr(module, function, once)
    return asked


@pytest.mark.parametrize("name", OF_SHIPS)
def test_command_and_call_on_ships_leave_the_same_files(
    name, tmp_path, tmp_path_factory, monkeypatch, call, six_minutes
):
    monkeypatch.chdir(tmp_path)
    six_minutes("log.csv")
    if name == "sea-trials":
        write_trials(tmp_path)
        few_of_trials(monkeypatch)
    asked = []
    if name in WORK:
        asked = work_out_once(monkeypatch, name, tmp_path_factory.mktemp("work") / "files")
    command, call_in_python = OF_SHIPS[name]
    ours, theirs = both(command, call_in_python, call, tmp_path)
    assert ours[1] == theirs[1], ours[0].err
    assert same_files(ours[2], theirs[2]) == []
    assert len(asked) == (2 if name in WORK else 0)


def test_what_a_run_was_is_in_its_file_on_its_page_and_in_its_card(tank):
    found = sc.run(
        "fill", set={"lag.time_constant": 0.4}, parameters=["fast.ssv"], until=4.2, out="out"
    )
    again = sc.read_table("out/result.nc")
    page, card = Path("out/report.html").read_text(encoding="utf-8"), found._repr_html_()
    assert len(found.not_judged) == 2 and found.expectations == ()
    for text in (
        "None of its 2 expectations was reached",
        "lag.time_constant = 0.4",
        "until 4.2 s",
        "Left out",
    ):
        assert text in page and text in card, text
    for key in ("changed", "not_reached", "remarks", "seeds"):
        assert again.attrs[key] == found.attrs[key], key
    assert "Left out" in again.attrs["remarks"]


def test_no_path_of_the_user_is_in_the_list_of_changes(tank):
    (tank / "more").mkdir()
    found = sc.run("fill", parameters=[tank / "fast.ssv"], fmus=[tank / "more"], until=1.0)
    assert str(tank) not in found.attrs["changed"] and "fast.ssv" in found.attrs["changed"]
