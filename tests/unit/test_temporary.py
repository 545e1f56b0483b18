"""What a killed process leaves is cleared away by the next one; files are there whole or not at all."""

import os
import subprocess
import sys

import pytest

from shipcosim.temporary import replace_file, temporary_folder

BEGUN = (
    "import os, sys, pathlib, shipcosim.temporary as t; path = pathlib.Path(sys.argv[1]);"
    "os.replace = lambda *_: os._exit(9); t.replace_file(path, b'new')"
)


@pytest.mark.skipif(os.name != "posix", reason="Windows has no such question")
def test_a_file_of_which_the_writing_is_killed_stays_as_it_was(tmp_path):
    path = tmp_path / "x.fmu"
    path.write_bytes(b"old")
    killed = subprocess.run([sys.executable, "-c", BEGUN, str(path)], check=False)
    assert killed.returncode == 9 and path.read_bytes() == b"old"
    assert len(list(tmp_path.iterdir())) == 2
    replace_file(path, b"new")
    assert path.read_bytes() == b"new" and list(tmp_path.iterdir()) == [path]


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux lists how processes are")
def test_a_folder_is_cleared_whose_process_has_ended_though_nobody_asked_how(tmp_path):
    ended = subprocess.Popen([sys.executable, "-c", ""])
    os.waitid(os.P_PID, ended.pid, os.WEXITED | os.WNOWAIT)
    with temporary_folder(tmp_path) as mine:
        name = os.path.basename(mine).replace(f"-{os.getpid()}-", f"-{ended.pid}-")
    (tmp_path / name).mkdir()
    with temporary_folder(tmp_path):
        assert not (tmp_path / name).exists()
    ended.wait()
