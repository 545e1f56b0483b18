"""`check` knows what a .toml describes by its keys, whatever is wrong with it."""

import pytest

from shipcosim import check
from shipcosim.checks import kind_of_toml
from shipcosim.errors import ShipcosimError

KINDS = {
    "src/shipcosim/diagnose/hypotheses/causes/*.toml": "cause",
    "scenarios/**/*.toml": "scenario",
    "studies/*.toml": "study",
    "ssp/ships/osv/ship.toml": "ship",
    "tests/system/measured/channels/*.toml": "channels",
}


@pytest.mark.parametrize("pattern", KINDS)
def test_files_of_the_project_are_of_their_kind(pattern, root):
    files = list(root.glob(pattern))
    assert files and {kind_of_toml(file) for file in files} == {KINDS[pattern]}


@pytest.mark.parametrize(
    "pattern", ["src/shipcosim/diagnose/hypotheses/causes/*.toml", "ssp/ships/osv/ship.toml"]
)
def test_a_file_that_is_no_toml_is_still_of_its_kind(pattern, root, tmp_path):
    for file in root.glob(pattern):
        broken = tmp_path / "broken.toml"
        broken.write_text(file.read_text(encoding="utf-8") + "\nbroken = = 1\n", encoding="utf-8")
        assert kind_of_toml(broken) == KINDS[pattern]


def test_a_cause_is_right_or_its_mistakes_are_said(root, tmp_path, call):
    own = root / "src/shipcosim/diagnose/hypotheses/causes/tow.toml"
    assert call("check", own).code == 0
    wrong = tmp_path / "tow.toml"
    wrong.write_text('cause = "tow"\nsentense = "A line pulls"\n')
    done = call("check", wrong)
    assert done.code == 1 and "tow.toml, sentense" in done.out and "docs/add-a-cause.md" in done.out


def test_a_value_of_another_kind_in_a_cause_is_told_in_plain_words(tmp_path, call):
    (tmp_path / "tow.toml").write_text('cause = "tow"\nsentence = 3\nparameters = 4\n')
    said = call("check", tmp_path / "tow.toml").out
    assert "sentence = 3. It should be a text in quotes." in said and "valid" not in said
    assert "'reference' is missing." in said and "should be a table" in said


def test_a_channel_file_is_right_or_its_mistakes_are_said(root, tmp_path, call):
    assert call("check", root / "tests/system/measured/channels/otter.toml").code == 0
    wrong = tmp_path / "channels.toml"
    wrong.write_text('north = "N"\nheadin = "psi"\n')
    done = call("check", wrong)
    assert done.code == 1 and "Did you mean 'heading'?" in done.out and "time" in done.out


@pytest.mark.parametrize(
    ("folder", "files"),
    [(".", ["scenarios/fill.toml", "ssp/tank"]), ("scenarios", ["scenarios/fill.toml"])],
)
def test_a_folder_is_checked_with_all_that_is_in_it(project, folder, files):
    (project / "scenarios" / "fill.toml").write_text("stop_tim = 1\n")
    checked = check(folder)
    assert [*checked.files] == files and not checked.passed


def test_a_folder_of_logs_is_named_as_such(tmp_path, call):
    (tmp_path / "b.csv").write_text("time,a\n0,1\n1,2\n")
    done = call("check", tmp_path)
    assert "This folder has no system, but logs or tables, such as b.csv." in done.out
    assert f"Give one of them: {tmp_path / 'b.csv'}." in " ".join(done.out.split())


def test_a_table_is_no_system(tmp_path, call):
    (tmp_path / "b.csv").write_text("time,a\n0,1\n1,2\n")
    for command in ("simulate", "compare"):
        done = call(command, tmp_path / "b.csv")
        assert done.code == 2 and "This is a table, no system." in done.err


def test_a_file_that_is_missing_keeps_no_other_from_being_checked(root, call):
    scenario = root / "scenarios/gust.toml"
    done = call("check", scenario, "absent", root / "scenarios/held.toml")
    assert done.code == 1 and done.out.count("nothing wrong") == 2
    assert "absent: 1 error" in done.out and "There is no such file or folder." in done.out
    done = call("check", "absent", "missing")
    assert done.code == 2 and "absent" in done.err and "missing" in done.err


def test_a_check_of_nothing_is_refused():
    with pytest.raises(ShipcosimError, match="Name one to check"):
        check([])


@pytest.mark.parametrize("content", [b"", b"MATLAB 5.0 MAT-file", b"\x89HDF\r\n\x1a\n"])
def test_a_file_of_matlab_is_checked_as_a_log(tmp_path, call, content):
    (tmp_path / "log.mat").write_bytes(content)
    done = call("check", tmp_path / "log.mat")
    assert done.code == 1 and "log.mat: " in done.out and "are not known" not in done.out


@pytest.mark.parametrize(
    "ending, kind",
    [("ssv", "parameter set"), ("ssm", "parameter mapping"), ("ssb", "signal dictionary")],
)
@pytest.mark.parametrize("command", ["simulate", "compare", "capability"])
def test_a_part_of_a_system_is_no_system(call, command, ending, kind, tmp_path):
    path = tmp_path / f"a.{ending}"
    path.write_text("<a/>")
    done = call(command, path)
    assert done.code == 2 and f"This is a {kind}, no system." in done.err
