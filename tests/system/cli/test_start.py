"""Where a user begins: what is there, a project of one's own, new files, completion of names."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from shipcosim import library
from shipcosim.calls.arguments import Reading
from shipcosim.cli.start.completion import LISTED
from shipcosim.cli.start.files import (
    notebook,
    project_files,
    scenario_files,
    system_files,
    write_new,
)
from shipcosim.library import names
from shipcosim.ssp import parameter, read_system, write_ssv


@pytest.fixture
def empty(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def files_in(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def test_without_arguments_it_says_what_it_can_do_and_what_is_there(call, empty):
    said = call()
    assert said.code == 0
    assert all(text in said.out for text in ("diagnose", "init", "four_corner", "gunnerus_dp"))
    assert f"{len(names('scenario'))} shipcosim" in said.out


def test_each_kind_is_listed_with_a_line_for_each_thing(call, empty):
    said = call("list").out
    assert all(f"{kind}" in said for kind in LISTED)
    assert "  four_corner " in said and "  libcosim " in said and "  wave_drift " in said
    only = call("list", "systems").out.splitlines()
    assert len(only) == 1 + len(names("system")) and only[0] == "systems"


def test_things_of_the_project_are_listed_first_and_apart(call, empty):
    call("init", ".")
    said = call("list", "scenarios").out
    assert (
        said.index(f"scenarios of {empty.name}")
        < said.index("hold_position")
        < said.index("four_corner")
    )


def test_kind_that_is_none_is_refused(call, empty):
    failed = call("list", "scenario")
    assert failed.code == 2 and "Did you mean 'scenarios'?" in failed.err


def test_project_has_no_fault_and_is_not_laid_out_twice(call, empty):
    done = call("init", "mine")
    assert done.code == 0 and "cd mine" in done.out
    os.chdir("mine")
    assert (
        call("check", "my_ship", "hold_position", "loaded", "ssp/my_ship/resources/loaded.ssv").code
        == 0
    )
    before = files_in(empty)
    (empty / "mine" / "README.md").unlink()
    again = call("init", ".")
    assert again.code == 2 and "It is there already" in again.err
    assert files_in(empty) == {
        name: text for name, text in before.items() if name != "mine/README.md"
    }


def test_parameter_set_of_a_project_reaches_the_ship(call, empty):
    call("init", ".")
    path = library.find("system", "my_ship")
    ship, fmus = path / "resources" / "loaded.ssv", library.fmus(path)
    mass = [
        read_system(path, sets, fmus=fmus).components["vessel"].start["mass"]
        for sets in ((), [ship])
    ]
    assert mass == [531e3, 561e3]


def test_notebook_of_a_project_runs(call, empty):
    call("init", ".")
    cells = json.loads((empty / "first_run.ipynb").read_text(encoding="utf-8"))["cells"]
    scope = {"display": lambda *shown: None}
    code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    assert len(code) == 3 and all("".join(cell["source"]).strip() for cell in cells)
    for text in code:
        exec(text, scope)


def test_fenced_blocks_are_cells_of_code():
    cells = json.loads(notebook("# A\n\n```python\nx = 1\n```\n\nB\n"))["cells"]
    assert [(cell["cell_type"], "".join(cell["source"])) for cell in cells] == [
        ("markdown", "# A"),
        ("code", "x = 1"),
        ("markdown", "B"),
    ]


def test_the_next_command_takes_a_folder_with_a_blank_in_its_name(call, empty):
    assert "cd 'my ship' && shipcosim run" in call("init", "my ship").out


def test_new_fmu_is_built_and_checked_by_name(call, empty):
    done = call("new", "fmu", "deck_winch")
    assert done.code == 0 and "Go on with" in done.out
    assert call("build", "deck_winch").code == 0
    assert "time_constant" in call("check", "deck_winch").out
    alone = call(
        "simulate",
        "deck_winch",
        "--stop-time",
        "10",
        "--step-size",
        "0.1",
        "--set",
        "deck_winch.u=1",
    )
    assert alone.code == 0 and "results" in alone.out


def test_new_scenario_of_a_controlled_ship_runs_by_name(call, empty):
    assert call("new", "scenario", "storms/squall").code == 0
    done = call("run", "storms/squall", "--until", "1", "--out", "out")
    assert done.code == 0 and (empty / "out" / "report.html").is_file()


SYSTEMS = ("gunnerus_dp", "kvlcc2_open", "otter_open")
"""In a closed loop, with a rudder, and of a small craft; the others at night."""


@pytest.mark.parametrize("system", SYSTEMS)
def test_new_scenario_and_copy_of_a_system_have_no_fault(call, empty, system):
    check_copy(call, empty, system)


def check_copy(call, empty, system):
    assert call("new", "system", "copy", "--from", system).code == 0
    assert call("new", "scenario", "first").code == 0  # of the project's own system
    assert 'system          = "copy"' in (empty / "scenarios" / "first.toml").read_text(
        encoding="utf-8"
    )
    assert call("check", "copy", "first").code == 0


@pytest.mark.parametrize("system", SYSTEMS)
def test_parameters_of_a_system_are_written_as_they_are(call, empty, system):
    check_parameters(call, empty, system)


def check_parameters(call, empty, system):
    assert call("new", "parameters", "own", "--from", system).code == 0
    assert call("check", "own.ssv", "own.ssm").code == 0
    before = Reading().system(system)
    after = with_parameters(before.file, empty / "own.ssv")
    assert values_of(after) == values_of(before)


def test_parameters_of_fmus_are_written_as_they_are_and_taken_by_their_own_names(call, empty, root):
    """Of each third FMU; of all at night."""
    assert check_fmus(call, empty, all_fmus(root)[::3]) > 6


def all_fmus(root):
    fmus = sorted((root / "build" / "fmus").glob("*.fmu"))
    assert len(fmus) > 30
    return fmus


def check_fmus(call, empty, fmus):
    """How many took a value by their own name for it."""
    taken = 0
    for path in fmus:
        assert call("new", "parameters", path.stem, "--from", str(path)).code == 0
        before = read_system(path)
        ssv = empty / f"{path.stem}.ssv"
        assert values_of(read_system(path, parameters=ssv)) == values_of(before)
        # Plain names: the set can be bound to a component of any name.
        names = set(re.findall(r'<ssv:Parameter name="([^"]+)"', ssv.read_text()))
        assert names <= set(next(iter(before.components.values())).variables)
        # The FMU's own names, without the component's before them, do as well.
        ((name, component),) = before.components.items()
        free = [
            v.name
            for v in component.variables.values()
            if isinstance(values_of(before).get(f"{name}.{v.name}"), float)
            and (v.minimum, v.maximum) == (None, None)
        ]
        if not free:
            continue
        changed = values_of(before) | {f"{name}.{free[0]}": 12.5}
        unit = component.variables[free[0]].unit
        write_ssv(ssv, "plain", [parameter(free[0], 12.5, unit)])
        assert values_of(read_system(path, parameters=ssv)) == changed
        taken += 1
    return taken


def with_parameters(file, ssv):
    return read_system(file, parameters=ssv, fmus=library.fmus(Path(file)))


def values_of(system):
    """Start values of all parameters by their full names."""
    return {
        f"{component.name}.{variable.name}": component.start_value(variable.name)
        for component in system.components.values()
        for variable in component.variables.values()
        if "arameter" in variable.causality
    }


def test_copied_parameter_set_has_the_new_name_and_the_old_values(root, empty):
    write_new(empty, system_files("ferry", "gunnerus_dp"))
    copied = (empty / "ssp" / "ferry" / "resources" / "ferry.ssv").read_text(encoding="utf-8")
    old = (root / "ssp" / "gunnerus_dp" / "resources" / "gunnerus-33m9.ssv").read_text(
        encoding="utf-8"
    )
    assert (
        copied == old.replace('name="gunnerus-33m9"', 'name="ferry"')
        and "gunnerus" not in copied[:400]
    )


@pytest.mark.parametrize(
    "arguments, said",
    [
        (["fmu", "2winch"], "cannot name an FMU"),
        (["fmu", "a/b"], "cannot name an FMU"),
        (["scenario", "../out"], "cannot name a scenario"),
        (["parameters", "x/y"], "cannot name a parameter set"),
        (["parameters", "x", "--from", "absent"], "There is no such system"),
        (["scenario", "x", "--system", "gunnerus"], "Did you mean 'gunnerus_dp'?"),
        (["system", "a b"], "cannot name a system"),
        (["system", "x", "--from", "absent"], "There is no such system"),
    ],
)
def test_what_cannot_be_made_is_refused_and_nothing_is_written(call, empty, arguments, said):
    failed = call("new", *arguments)
    assert failed.code == 2 and said in failed.err
    assert files_in(empty) == {}


def test_nothing_new_overwrites_what_is_there(call, empty):
    call("new", "fmu", "winch")
    before = files_in(empty)
    assert call("new", "fmu", "winch").code == 2
    assert files_in(empty) == before


def test_files_that_cannot_be_written_leave_none(call, empty):
    (empty / "scenarios").write_text("a file", encoding="utf-8")
    assert call("init", ".").code == 2
    assert set(files_in(empty)) == {"scenarios"}


def test_every_file_of_a_project_ends_with_one_line_end():
    for name, content in project_files("mine").items():
        text = content.decode() if isinstance(content, bytes) else content
        assert text.endswith("\n") and not text.endswith("\n\n") and "$" not in text, name


def test_scenario_of_a_system_without_control_names_its_own_signals(empty):
    (text,) = scenario_files("still", "otter_open").values()
    assert '"left_rpm"' in text and "[[events]]" in text


def completed(shell, line):
    words = line.split(" ")
    asked = {
        "bash": {"COMP_WORDS": line, "COMP_CWORD": str(len(words) - 1)},
        "zsh": {"_TYPER_COMPLETE_ARGS": line},
        "fish": {"_TYPER_COMPLETE_ARGS": line, "_TYPER_COMPLETE_FISH_ACTION": "get-args"},
    }[shell]
    environment = os.environ | asked | {"_SHIPCOSIM_COMPLETE": f"complete_{shell}"}
    start = [sys.executable, "-c", "from shipcosim.cli import main; main()"]
    return subprocess.run(
        start, env=environment, capture_output=True, text=True, check=False
    ).stdout


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_names_are_completed(shell, empty):
    assert "four_corner_rough" in completed(shell, "shipcosim run four_c")


@pytest.mark.parametrize(
    "line, expected",
    [
        ("shipcosim new system x --from kvlcc2_o", "kvlcc2_open"),
        ("shipcosim diagnose gunn", "gunnerus_log"),
        ("shipcosim list sc", "scenarios"),
        ("shipcosim run nothing_of_this_name", ""),
    ],
)
def test_each_argument_completes_its_own_kind(line, expected, empty):
    assert completed("bash", line).split() == expected.split()


def test_the_documentation_is_read_in_the_terminal(call):
    listed = call("docs").out
    assert "own-ship" in listed and "Your own ship" in listed and "diagnosis" in listed
    assert call("docs", "diagnosis").out.startswith("# ")
    failed = call("docs", "diagnose")
    assert failed.code == 2 and "diagnosis" in failed.err
