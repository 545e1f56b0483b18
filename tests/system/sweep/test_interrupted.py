"""A study that cannot go on, since its disk is full or its process is killed, loses nothing that is on disk."""

import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas
import pyarrow.compute
import pytest
from pyarrow import parquet

import shipcosim
from shipcosim.sweep import plan_of, read_study
from shipcosim.sweep.storage import Store

SWEEP = [
    str(Path(sys.executable).parent / "shipcosim"),
    "sweep",
    "--engine",
    "fmpy",
    "--workers",
    "1",
    "--out",
]


class Disk:
    """A folder on a disk of its own, which is small; where nobody may mount one, files of processes are kept small."""

    def __init__(self, folder, size):
        self.folder, self.size = folder, size
        folder.mkdir()
        made = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", folder], capture_output=True
        )
        self.is_mounted = made.returncode == 0

    def sweep(self, study):
        limit = None if self.is_mounted or not self.size else self._limit
        return subprocess.run(
            [*SWEEP, self.folder / "out", study], capture_output=True, text=True, preexec_fn=limit
        )

    def enlarge(self):
        if self.is_mounted:
            subprocess.run(["mount", "-o", "remount,size=32m", self.folder], check=True)
        self.size = 0

    def close(self):
        if self.is_mounted:
            subprocess.run(["umount", self.folder], check=True)

    def _limit(self):
        resource.setrlimit(resource.RLIMIT_FSIZE, (self.size // 4, self.size // 4))


@pytest.fixture
def disk(project):
    made = []

    def make(size):
        made.append(Disk(project / "disk", size))
        return made[-1]

    yield make
    for one in made:
        one.close()


@pytest.mark.skipif(
    sys.platform == "win32", reason="small disks are made by mount, or by limits of Unix"
)
@pytest.mark.parametrize(
    "size", [8 * 1024, 160 * 1024], ids=["full before the table", "full before the page"]
)
def test_on_a_full_disk_a_study_says_so_and_goes_on_when_there_is_room(project, disk, size):
    whole = shipcosim.sweep("levels", out="whole", engine="fmpy", workers=1)
    small = disk(size)
    stopped = small.sweep("levels")
    assert stopped.returncode == 2 and "Traceback" not in stopped.stderr, stopped.stderr
    said = " ".join(stopped.stderr.split())
    assert "No space left on device" in said or "File too large" in said
    small.enlarge()
    again = small.sweep("levels")
    assert again.returncode == 0, again.stderr
    runs = pandas.read_parquet(small.folder / "out/runs.parquet")
    pandas.testing.assert_frame_equal(runs, whole.runs)
    assert (
        not list(small.folder.rglob("*.unfinished"))
        and (small.folder / "out/report.html").stat().st_size > 1e5
    )


@pytest.mark.parametrize("left", [None, 300])
def test_a_lost_table_of_runs_is_said_and_made_again(project, left):
    check_lost_table(project, left)  # an empty one: at night


def check_lost_table(project, left):
    whole = shipcosim.sweep("levels", out="lost", engine="fmpy", workers=1)
    table = project / "lost/runs.parquet"
    content = table.read_bytes()
    table.unlink()
    if left is not None:
        table.write_bytes(content[:left])
    again = shipcosim.sweep("levels", out="lost", engine="fmpy", workers=1)
    assert any(
        f"the {len(whole.runs)} runs that only it held" in one for one in again.about["remarks"]
    )
    pandas.testing.assert_frame_equal(again.runs, whole.runs)
    once_more = shipcosim.sweep("levels", out="lost", engine="fmpy", workers=1)
    assert not once_more.about.get("remarks")


def without(table, column):
    return table.drop_columns([column])


def with_column(table, column, values):
    return table.set_column(table.column_names.index(column), column, [values])


RUNS = {
    "beyond the plan": lambda table: with_column(table, "run", [*range(11), 99]),
    "negative": lambda table: with_column(table, "run", [*range(11), -1]),
    "missing": lambda table: with_column(table, "run", [*range(11), None]),
    "fractions": lambda table: with_column(table, "run", [one + 0.5 for one in range(12)]),
    "texts": lambda table: with_column(table, "highest", ["high"] * 12),
    "without a column": lambda table: without(table, "highest"),
}
STUDIES = [b"", b"[1]", b"5", b'{"plan": [], "runs": 3}', b'{"runs": {"done": "x"}}']


def test_a_study_whose_files_were_edited_does_again_what_they_lack(project, study):
    path = study('extends = "levels"\n[tracks]\nsignals = ["lag.y"]\ninterval = "1 s"\n')
    shipcosim.sweep(path, out="whole", engine="fmpy", workers=1)
    plan = plan_of(read_study(path))

    def done(file, change):
        """Number of runs that are done after a change to a file of the study."""
        folder = project / "edited"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree("whole", folder)
        change(folder / file)
        return int(Store(folder, plan, "fmpy").done.sum())

    def edited(edit):
        return lambda file: parquet.write_table(edit(parquet.read_table(file)), file)

    assert done("runs.parquet", lambda file: None) == 12
    for how, edit in RUNS.items():
        assert done("runs.parquet", edited(edit)) in (0, 11), how
    assert done("tracks.parquet", Path.unlink) == 0
    assert done("tracks.parquet", lambda file: file.write_bytes(b"PAR1")) == 0
    assert done("tracks.parquet", edited(lambda table: without(table, "lag.y"))) == 0
    # The tracks of some runs are lost: these alone are done again, and the others keep theirs.
    lose = edited(lambda table: table.filter(pyarrow.compute.field("run") > 3))
    assert done("tracks.parquet", lose) == 8
    shipcosim.sweep(path, out="edited", engine="fmpy", workers=1)
    tracks = [pandas.read_parquet(f"{folder}/tracks.parquet") for folder in ("edited", "whole")]
    pandas.testing.assert_frame_equal(*tracks)
    for content in STUDIES:
        assert done("study.json", lambda file, content=content: file.write_bytes(content)) == 0


def test_a_killed_study_goes_on_where_it_stopped(project, study):
    path = study('extends = "levels"\n[set]\n"lag.pause" = 0.5\n')
    whole = shipcosim.sweep(path, out="whole", engine="fmpy", workers=2)
    process = subprocess.Popen(
        [*SWEEP, "killed", "own"], start_new_session=True, stdout=subprocess.DEVNULL
    )
    parts = project / "killed/parts"
    deadline = time.monotonic() + 120.0
    while not list(parts.glob("runs-*.parquet")) and time.monotonic() < deadline:
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    done = []
    rest = shipcosim.sweep(
        path, out="killed", engine="fmpy", workers=1, progress=lambda n, total: done.append(n)
    )
    assert 1 < done[0] <= 12 and done[-1] == 12, "what was on disk was not done again"
    pandas.testing.assert_frame_equal(rest.runs, whole.runs)


def marked(text):
    """Processes with a text in their environment that are not only waiting to be asked how they ended."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            ended = ") Z " in (process / "stat").read_text()
            if not ended and text.encode() in (process / "environ").read_bytes():
                found.append(process.name)
        except OSError:
            pass
    return found


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux ends children with their parent")
@pytest.mark.parametrize("seconds", [1.1, 2.5])
def test_nothing_is_left_of_a_study_that_is_killed_after_the_next(project, seconds):
    """Also where its workers have just been started and do not know their parent yet."""
    temporary = project / "temporary"
    temporary.mkdir()
    environment = os.environ | {"TMPDIR": str(temporary), "MARK": str(project)}
    command = [*SWEEP, "killed", "levels"]
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL)
    time.sleep(seconds)
    process.kill()
    process.wait()
    deadline = time.monotonic() + 60.0
    while marked(f"MARK={project}") and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not marked(f"MARK={project}")
    again = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert again.returncode == 0, again.stderr
    # Python tries the folder with a file of its own, which stays where it is killed just then.
    left = [path for path in temporary.iterdir() if path.is_dir()]
    assert not left and not list(project.rglob("*.unfinished*"))
