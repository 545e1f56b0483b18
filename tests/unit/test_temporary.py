"""What a killed process leaves is cleared away by the next one; files are there whole or not at all."""

import os
import subprocess
import sys

import pytest

from shipcosim.errors import ShipcosimError
from shipcosim.series import write_file
from shipcosim.ssp.edit.write import write_file as write_set
from shipcosim.staging import check_targets
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


WRITERS = pytest.mark.parametrize("write", [replace_file, write_file, write_set])
"""Functions that write a file whole or not at all."""
posix = pytest.mark.skipif(os.name != "posix", reason="Windows has no pipes of this kind")


@posix
@WRITERS
def test_a_pipe_stays_a_pipe_and_gets_the_content(tmp_path, write):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    end = os.open(pipe, os.O_RDWR)
    write(pipe, b"new")
    assert pipe.is_fifo() and os.read(end, 10) == b"new" and list(tmp_path.iterdir()) == [pipe]
    os.close(end)


@posix
@WRITERS
@pytest.mark.parametrize("is_there", [False, True])
def test_of_a_link_the_file_is_written_that_it_leads_to(tmp_path, write, is_there):
    file = tmp_path / "folder" / "file"
    file.parent.mkdir()
    if is_there:
        file.write_bytes(b"old")
    link = tmp_path / "link"
    link.symlink_to(file)
    write(link, b"new")
    assert link.is_symlink() and file.read_bytes() == b"new"
    assert list(file.parent.iterdir()) == [file]


@posix
@pytest.mark.parametrize("target", ["link", "nowhere"])
def test_a_link_to_nothing_is_no_folder_for_results(tmp_path, target):
    (tmp_path / "link").symlink_to(tmp_path / target)
    for folder in ("link", "link/deeper"):
        with pytest.raises(ShipcosimError, match="is a file, not a folder"):
            check_targets(tmp_path / folder)
