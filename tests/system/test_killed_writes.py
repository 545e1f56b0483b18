"""A write that ends at any of its steps: the next one finds earlier or new files complete, and leaves nothing over."""

import os
import signal
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from shipcosim.cosim.export import osp
from shipcosim.series import write_file
from shipcosim.ssp.xml.archive import replaced
from shipcosim.staging import set_aside, staged
from shipcosim.temporary import clear_killed, exchange, replace_file

CALLS = ("mkdir", "open", "replace", "rename", "unlink", "rmdir", "chmod")
"""Functions of `os` by which folders change; before any of their calls a process may be killed."""
NAMES = ("a.txt", "b.txt", "c.txt", "folder")
forked = pytest.mark.skipif(not hasattr(os, "fork"), reason="a child is killed in each step")


def put(folder, generation, force=False):
    """Results of a run: two files and a folder; the first generation has one more file."""
    with staged(folder, ["c.txt"], force=force) as stage:
        for name in ("a.txt", "b.txt"):
            (stage / name).write_text(generation)
        (stage / "folder").mkdir()
        (stage / "folder" / "inner.txt").write_text(generation)
        if generation == "old":
            (stage / "c.txt").write_text(generation)


def held(folder):
    """Names and contents below a folder."""
    return {
        str(path.relative_to(folder)): path.read_text()
        for path in folder.rglob("*")
        if path.is_file()
    }


OLD = {name: "old" for name in ("a.txt", "b.txt", "c.txt", "folder/inner.txt")}
NEW = {name: "new" for name in ("a.txt", "b.txt", "folder/inner.txt")}


def ended_at(step, ends, work):
    """Do a work of which call number `step` to a function of `CALLS` ends it; return whether it got that far."""
    count = 0

    def counted(function):
        def call(*arguments, **options):
            nonlocal count
            count += 1
            if count == step:
                ends()
            return function(*arguments, **options)

        return call

    with pytest.MonkeyPatch.context() as patch:
        for name in CALLS:
            patch.setattr(os, name, counted(getattr(os, name)))
        work()
    return count >= step


def killed_at(step, work):
    """The same in a child that is killed there; return whether it was."""
    child = os.fork()
    if not child:
        with suppress(BaseException):
            ended_at(step, lambda: os.kill(os.getpid(), signal.SIGKILL), work)
        os._exit(0)
    _, status = os.waitpid(child, 0)
    return os.WIFSIGNALED(status)


def steps_of(folder, work, stride=1):
    """Folders in which a work was killed before its first step, its second, and so on until it was not killed."""
    for step in range(1, 200, stride):
        made = folder / str(step)
        (made / "calm").mkdir(parents=True)
        put(made / "calm", "old")
        killed = killed_at(step, lambda made=made: work(made / "calm"))
        yield made
        if not killed:
            assert step > 5, "nothing was killed"
            return
    raise AssertionError("it has no end")


@forked
@pytest.mark.parametrize("force", [False, True])
def test_results_replaced_are_complete_whenever_the_process_is_killed(tmp_path, force):
    outcomes = set()
    for made in steps_of(tmp_path, lambda folder: put(folder, "new", force)):
        clear_killed(made / "calm")
        found = {path.name: held(path) for path in made.iterdir()}
        outcome = "old" if found["calm"] == OLD else "new"
        outcomes.add(outcome)
        earlier = {} if outcome == "old" or force else {"calm-1": OLD}
        assert found == {"calm": OLD if outcome == "old" else NEW} | earlier
        names = {name.split("/")[0] for name in found["calm"]}
        assert {path.name for path in (made / "calm").iterdir()} == names
    assert outcomes == {"old", "new"}


@forked
def test_a_repair_that_is_killed_is_repaired_by_the_next(tmp_path):
    """For each fourth state that a kill leaves, at each step of the repair."""
    for step in range(1, 200):
        repairs = tmp_path / str(step)
        count = 0
        for made in steps_of(repairs, lambda folder: put(folder, "new"), 4):
            count += killed_at(step, lambda made=made: clear_killed(made / "calm"))
            clear_killed(made / "calm")
            found = {path.name: held(path) for path in made.iterdir()}
            assert found in ({"calm": OLD}, {"calm": NEW, "calm-1": OLD})
        if not count:
            assert step > 5
            return


@forked
def test_results_set_aside_stay_together_whenever_the_process_is_killed(tmp_path):
    for made in steps_of(tmp_path, lambda folder: set_aside(folder, NAMES)):
        put(made / "calm", "new")
        found = {path.name: held(path) for path in made.iterdir()}
        assert found == {"calm": NEW, "calm-1": OLD}


def failing(step, work):
    def fails():
        raise OSError(5, "Input/output error")

    return ended_at(step, fails, work)


@pytest.mark.parametrize("force", [False, True])
def test_results_replaced_stay_as_they_were_where_a_step_fails(tmp_path, force):
    """Whatever the step; where only the clearing away fails, the new ones are there."""
    for step in range(1, 200):
        folder = tmp_path / str(step) / "calm"
        put(folder, "old")
        got_there = True
        with suppress(Exception):
            got_there = failing(step, lambda folder=folder: put(folder, "new", force))
        there = {name: text for name, text in held(folder).items() if not name.startswith(".")}
        assert there in (OLD, NEW)
        if not force:
            kept = folder.with_name("calm-1")
            assert kept.exists() == (there == NEW) and (not kept.exists() or held(kept) == OLD)
        if not got_there:
            assert there == NEW and step > 5
            return


def test_results_survive_where_neither_the_new_nor_the_earlier_can_be_moved(tmp_path, monkeypatch):
    """The disk fails from some move on: the next process makes all moves."""
    move = os.replace
    for allowed in range(1, 8):
        folder = tmp_path / str(allowed) / "calm"
        put(folder, "old")
        left = [allowed]

        def failing_from_then(source, target, left=left):
            left[0] -= 1
            if left[0] < 0:
                raise OSError(5, "Input/output error")
            move(source, target)

        monkeypatch.setattr(os, "replace", failing_from_then)
        with suppress(Exception):
            put(folder, "new")
        monkeypatch.setattr(os, "replace", move)
        # As if this process had ended.
        monkeypatch.setattr("shipcosim.temporary._is_alive", lambda process: False)
        clear_killed(folder)
        found = {path.name: held(path) for path in folder.parent.iterdir()}
        assert found in ({"calm": OLD}, {"calm": NEW, "calm-1": OLD})
        monkeypatch.undo()


def through_package(path, content):
    with replaced(path) as partial:
        partial.write_bytes(content)


WRITERS = [replace_file, write_file, through_package]


@forked
@pytest.mark.parametrize("write", WRITERS, ids=lambda one: one.__name__)
def test_a_file_is_whole_and_alone_whenever_its_writing_is_killed(tmp_path, write):
    contents = set()
    for step in range(1, 100):
        path = tmp_path / str(step) / "x.bin"
        path.parent.mkdir()
        path.write_bytes(b"old")
        killed = killed_at(step, lambda path=path: write(path, b"new"))
        contents.add(path.read_bytes())
        # The next write, of another file beside it, clears away what is left.
        write(path.with_name("y.bin"), b"other")
        assert sorted(one.name for one in path.parent.iterdir()) == ["x.bin", "y.bin"]
        if not killed:
            break
    assert contents == {b"old", b"new"}


@forked
def test_an_export_for_osp_is_complete_whenever_it_is_killed(tmp_path, monkeypatch):
    files = {}
    monkeypatch.setattr(osp, "osp_files", lambda *_, **__: (files, []))
    systems = {"old": ["s.xml", "a.fmu", "scenario.json"], "new": ["s.xml", "a.fmu"]}

    nothing: Any = None

    def export(folder, generation):
        files.clear()
        files.update(dict.fromkeys(systems[generation], generation.encode()))
        osp.write_osp(nothing, nothing, folder)

    outcomes = []
    for step in range(1, 100):
        folder = tmp_path / str(step)
        export(folder, "old")
        killed = killed_at(step, lambda folder=folder: export(folder, "new"))
        clear_killed(folder)
        outcomes.append(held(folder))
        if not killed:
            break
    wanted = [dict.fromkeys(names, text) for text, names in systems.items()]
    assert all(found in wanted for found in outcomes) and outcomes[-1] == wanted[1]


def test_the_list_of_moves_counts_only_when_it_is_whole(tmp_path):
    """A kill in the middle of writing it leaves the earlier files."""
    put(tmp_path / "calm", "old")
    stage = tmp_path / "calm" / ".unfinished-host-1-a"
    (stage / "new").mkdir(parents=True)
    (stage / "new" / "a.txt").write_text("new")
    with pytest.raises(OSError), pytest.MonkeyPatch.context() as patch:
        patch.setattr(Path, "write_text", lambda *_, **__: (_ for _ in ()).throw(OSError()))
        exchange(stage, tmp_path / "calm", [], keep=True)
    assert {name: text for name, text in held(tmp_path / "calm").items() if name[0] != "."} == OLD
    assert not (stage / "moves.json").exists()
