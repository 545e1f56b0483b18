"""At night: sea trials by command and by call, each worked out anew, leave the same files."""

from cli.conftest import call
from cli.fronts.test_one_front import OF_SHIPS, both, same_files, write_trials


def test_sea_trials_worked_out_twice_leave_the_same_files(tmp_path, monkeypatch, call):
    monkeypatch.chdir(tmp_path)
    write_trials(tmp_path)
    ours, theirs = both(*OF_SHIPS["sea-trials"], call, tmp_path)
    assert ours[1] == theirs[1], ours[0].err
    assert same_files(ours[2], theirs[2]) == []
