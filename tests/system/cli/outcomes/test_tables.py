"""Tables on the terminal: no number is cut and no column is empty, at any width and through a pipe."""

import importlib
import inspect
import re
from collections import Counter
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console
from rich.text import Text

import shipcosim as sc
from shipcosim.cli.tables import print_table

NUMBER = re.compile(r"[−+-]?\d[\d.,]*(?:e[+-]?\d+)?")
WIDTHS = ("60", "80", "100", "120", None)
"""Columns of the terminal; None is a pipe."""
NOT_SHOWN = "In a wider terminal also: "
STUDY = """scenario = "fill"

[[factor]]
name = "time_constant_of_the_lag"
signal = "lag.time_constant"
values = [0.5, 1.0]

[[quantity]]
name = "power"
signal = "lag.y"
reduce = "final"

[[summary]]
name = "highest_level_of_all_runs"
quantity = "power"
over = ["time_constant_of_the_lag"]
statistic = "mean"

[[summary]]
name = "lowest_level_of_all_runs"
quantity = "power"
over = ["time_constant_of_the_lag"]
statistic = "minimum"
"""
COMMANDS = {
    "run": lambda: {"scenario": "prediction/gnss_loss"},
    "run a folder": lambda: {"scenario": "."},
    "simulate": lambda: {"ssp": "tank", "stop_time": 1.0, "step_size": 0.1},
    "sweep": lambda: {"study": "constants", "engine": "fmpy", "workers": 1},
    "compare": lambda: {"what": "four_corner", "stop_time": 1.0},
    "check an FMU": lambda: {"files": ["vessel"]},
    "check a ship": lambda: {"files": ["osv"]},
    "diagnose": lambda: {"data": [Path("log.csv")]},
    "diagnose two": lambda: {"data": [Path("log.csv"), Path("again.csv")]},
    "replay": lambda: {"log": Path("gunnerus_log"), "horizon": 60.0},
    "calibrate": lambda: {"logs": [Path("log.csv")]},
    "capability": lambda: {},
}


def printed(console_width, head, rows):
    out = StringIO()
    console = Console(
        file=out, width=console_width, force_terminal=True, color_system=None, soft_wrap=True
    )
    print_table(console, rows, head)
    return out.getvalue().splitlines()


@pytest.fixture
def said_at(monkeypatch, capsys):
    """Function that shows what a command found at a width."""

    def said(show, width):
        monkeypatch.delenv("COLUMNS") if width is None else monkeypatch.setenv("COLUMNS", width)
        capsys.readouterr()
        show()
        return capsys.readouterr().out

    return said


def check_numbers(said_at, show):
    """At each width the numbers are those of a very wide terminal, but for columns that are named as left out."""
    wide = said_at(show, "400")
    all_numbers = Counter(NUMBER.findall(wide))
    assert "…" not in wide and NOT_SHOWN not in wide
    for width in WIDTHS:
        said = said_at(show, width)
        assert "…" not in said, (width, said)
        numbers = Counter(NUMBER.findall(said))
        assert numbers <= all_numbers, (width, numbers - all_numbers)
        if NOT_SHOWN not in said:
            assert numbers == all_numbers, (width, all_numbers - numbers)
        # Variables of an FMU are a line each through a pipe, however long, and a block each on a terminal.
        if width in ("80", "100", "120") and "causality" not in said:
            lines = [line for line in said.splitlines() if "  " in line.strip()]
            assert all(len(line) <= int(width) for line in lines), (width, max(lines, key=len))
    return wide


@pytest.mark.parametrize("name", COMMANDS)
def test_numbers_are_whole_at_every_width_of_every_command(name, project, six_minutes, said_at):
    (project / "studies").mkdir()
    (project / "studies" / "constants.toml").write_text(STUDY)
    for copy in ("log.csv", "again.csv"):
        six_minutes(copy)
    module = name.split()[0]
    command = getattr(importlib.import_module(f"shipcosim.cli.commands.{module}"), module)
    found = command(**COMMANDS[name]())
    wide = check_numbers(said_at, found.show)
    assert NUMBER.search(wide) or name == "simulate"  # of which nothing is expected


def test_numbers_are_whole_in_sea_trials(project, said_at):
    from shipcosim.cli.commands.sea_trials import sea_trials

    sc.run("steering/circle", out="run")
    wide = check_numbers(said_at, sea_trials(Path("run/result.nc")).show)
    assert "turning circle" in wide and NUMBER.search(wide)


def test_numbers_are_whole_in_the_list_of_channels(project, call, said_at):
    from shipcosim.calls.arguments import path_of_log
    from shipcosim.cli.channel_files import print_channels, proposed

    proposal = proposed(path_of_log("gunnerus_log"), None, None)
    check_numbers(said_at, lambda: print_channels(proposal))


def test_words_wrap_and_numbers_do_not():
    rows = [("a long sentence about something that takes more room than there is", "12345.678 m")]
    lines = printed(40, ("what it is", "how much"), rows)
    assert all(len(line) <= 40 for line in lines) and lines[1].endswith("12345.678 m")
    assert " ".join(" ".join(lines[1:]).replace("12345.678 m", "").split()) == rows[0][0]


def test_a_column_that_is_empty_in_every_row_is_no_fault():
    lines = printed(60, ("", ""), [("port", ""), ("tunnel", "")])
    assert [line.strip() for line in lines if line.strip()] == ["port", "tunnel"]


def test_columns_that_do_not_fit_are_named_and_the_first_two_stay():
    head = [f"quantity_{number} [m]" for number in range(6)]
    rows = [[f"{number}.25" for number in range(6)]]
    lines = printed(40, head, rows)
    assert lines[0].split("  ") == head[:2] and lines[1].split() == ["0.25", "1.25"]
    assert lines[2] == NOT_SHOWN + ", ".join(head[2:]) + "."


def test_styles_of_cells_stay():
    out = StringIO()
    console = Console(file=out, width=80, force_terminal=True, color_system="standard")
    print_table(console, [(Text("FAIL", style="red"), "lag.y")])
    assert out.getvalue().startswith("\x1b[31mFAIL")


def test_study_is_told_in_units_that_people_read(project, call, monkeypatch):
    """10 kN is no 1e+04."""
    fmu = project / "fmus" / "lag" / "lag.py"
    fmu.write_text(fmu.read_text().replace('Output("m"', 'Output("N"').replace("self.u -", "1e4 -"))
    ssd = project / "ssp" / "tank" / "SystemStructure.ssd"
    ssd.write_text(re.sub(r'("y" kind="output"><ssc:Real unit=)"m"', r'\1"N"', ssd.read_text()))
    scenario = project / "scenarios" / "fill.toml"
    scenario.write_text(scenario.read_text().partition("[[expect]]")[0])
    (project / "studies").mkdir()
    (project / "studies" / "constants.toml").write_text(STUDY)
    done = call("sweep", "constants", "--engine", "fmpy", "--workers", "1")
    assert done.code == 0, done.err
    assert "e+0" not in done.out and "[kN]" in done.out


def test_commands_that_show_a_result_are_all_among_those_tried():
    """A new command whose result is shown must be tried here, too."""
    from shipcosim.cli import app
    from shipcosim.cli.outcomes.exits import Conclusion

    def returns_one(command):
        annotation = inspect.unwrap(command.callback).__annotations__.get("return")
        return annotation in (Conclusion, "Conclusion")

    names = {
        command.callback.__name__ for command in app.registered_commands if returns_one(command)
    }
    tried = {name.split()[0] for name in COMMANDS}
    # Sea trials need a log that takes minutes to draw; their rows are made by one format.
    assert names - tried == {"sea_trials"} and tried <= names
