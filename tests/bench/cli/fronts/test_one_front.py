"""At night: what takes long by command and by call, each worked out anew, leaves the same files."""

import pytest
from cli.conftest import call, six_minutes
from cli.fronts.test_one_front import OF_SHIPS, WORK, both, same_files, write_trials


@pytest.mark.parametrize("name", WORK)
def test_what_takes_long_worked_out_twice_leaves_the_same_files(
    name, tmp_path, monkeypatch, call, six_minutes
):
    monkeypatch.chdir(tmp_path)
    if name == "sea-trials":
        write_trials(tmp_path)
    else:
        six_minutes("log.csv")
    ours, theirs = both(*OF_SHIPS[name], call, tmp_path)
    assert ours[1] == theirs[1], ours[0].err
    assert same_files(ours[2], theirs[2]) == []
