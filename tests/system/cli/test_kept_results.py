"""Results: nothing is overwritten silently, and the page says what the command line changed."""

import json
from pathlib import Path

import pytest
import xarray

from shipcosim.staging import set_aside, set_file_aside, staged


def written(folder, text):
    """Results as a command leaves them."""
    with staged(folder, ("partial.txt",)) as stage:
        (stage / "result.txt").write_text(text)


def test_earlier_results_are_kept_in_rising_numbers(tmp_path, capsys):
    folder = tmp_path / "calm"
    for text in ("first", "second", "third"):
        written(folder, text)
    assert (folder / "result.txt").read_text() == "third"
    assert [(tmp_path / f"calm-{n}" / "result.txt").read_text() for n in (1, 2)] == [
        "first",
        "second",
    ]
    assert capsys.readouterr().err.count("Earlier results are kept in") == 2


def test_a_number_that_was_deleted_is_not_taken_again(tmp_path):
    folder = tmp_path / "calm"
    (tmp_path / "calm-7").mkdir()
    (tmp_path / "calm-seas").mkdir()
    written(folder, "first")
    written(folder, "second")
    assert (tmp_path / "calm-8" / "result.txt").read_text() == "first"


def test_files_of_others_stay_where_they_are(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "partial.txt").write_text("half")
    written(tmp_path, "first")
    assert (tmp_path / "notes.txt").read_text() == "mine" and not (
        tmp_path / "partial.txt"
    ).exists()
    assert (tmp_path.with_name(f"{tmp_path.name}-1") / "partial.txt").read_text() == "half"


def test_results_that_fail_on_their_way_leave_the_earlier_ones(tmp_path):
    written(tmp_path / "calm", "first")
    with pytest.raises(ZeroDivisionError), staged(tmp_path / "calm") as stage:
        (stage / "result.txt").write_text("second")
        raise ZeroDivisionError
    assert (tmp_path / "calm" / "result.txt").read_text() == "first" and not (
        tmp_path / "calm-1"
    ).exists()


def test_folders_and_single_files_are_kept_too(tmp_path):
    (tmp_path / "all" / "one").mkdir(parents=True)
    set_aside(tmp_path / "all", ["one", "two"])
    assert (tmp_path / "all-1" / "one").is_dir() and not (tmp_path / "all" / "one").exists()
    (tmp_path / "state.bin").write_text("early")
    set_file_aside(tmp_path / "state.bin")
    assert (tmp_path / "state-1.bin").read_text() == "early"


def test_a_second_run_keeps_the_first_unless_forced(call, project):
    """And the page says what this run changed."""
    assert call("run", "fill").code == 0
    again = call("run", "fill", "--set", "lag.time_constant = 0.4", "--until", "4")
    assert "Earlier results are kept in results/fill-1" in again.err
    page = Path("results/fill/report.html").read_text(encoding="utf-8")
    assert "Changed for this run: lag.time_constant = 0.4; until 4 s." in page
    assert 'id="changed"' not in Path("results/fill-1/report.html").read_text(encoding="utf-8")
    with xarray.open_dataset("results/fill/result.nc") as table:
        assert json.loads(table.attrs["changed"])[-1] == "until 4 s"
    forced = call("run", "fill", "--force")
    assert "Earlier" not in forced.err and not Path("results/fill-2").exists()


def test_what_a_part_of_a_run_does_not_reach_is_said(call, project):
    part = call("run", "fill", "--until", "4000 ms")
    said = part.out.replace("\u00a0", " ")
    assert (
        part.code == 0
        and "Not reached: lag.y: 1 ± 0.05 m during 4 to 5 s. The run went from 0 to 4 s." in said
    )
    assert "None of its" in part.out or "not reached" in part.out


TIMES = [("ten", "'ten' is no time"), ("nan", "'nan' is no time"), ("5 kn", "'5 kn' is in kn")]


@pytest.mark.parametrize(("given", "found"), TIMES)
def test_a_time_that_is_none_is_refused_with_what_would_be_right(call, project, given, found):
    failed = call("run", "fill", "--until", given)
    assert failed.code == 2 and found in " ".join(failed.err.split()), failed.err
