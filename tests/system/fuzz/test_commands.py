"""Commands on damaged files of a project end in an error of their own: no fault of ours, no escapes, nothing left."""

import os
import shutil

import pytest
from cli.conftest import built, call  # noqa: F401  (fixtures)
from fuzz.commands import write_command

IN_CI = 50


@pytest.fixture(scope="module")
def project(root, built, tmp_path_factory):  # noqa: F811
    """A project with its FMUs, and the results of a run in it."""
    folder = tmp_path_factory.mktemp("project")
    for name in ("fmus", "ssp", "scenarios", "studies"):
        shutil.copytree(root / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(built, folder / "build" / "fmus")
    import shipcosim as sc

    sc.simulate(folder / "ssp" / "otter_open", stop_time=1.0, step_size=0.1, out=folder / "result")
    return folder


def fault_of(call, project, seed, number):  # noqa: F811
    """What is wrong with how a command ends on a damaged file; empty where nothing is."""
    folder = project / "damaged"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.rmtree(project / "out", ignore_errors=True)
    folder.mkdir()
    command = write_command(seed, number, folder, project)
    before = set(os.listdir(project))
    ended = call(*command)
    text = ended.out + ended.err
    escapes = [c for c in text if c not in "\n\t\r" and (ord(c) < 32 or 0x7F <= ord(c) < 0xA0)]
    for made in project.glob("*/fresh*"):
        shutil.rmtree(made) if made.is_dir() else made.unlink()
    left = [name for name in {*os.listdir(project)} - before - {"out"} if name.startswith(".")]
    if "fault of shipcosim" in text or "Traceback" in text or escapes or left:
        return f"{number}: {' '.join(command)[:200]}: {escapes[:2]} {left} {ended.err[-300:]}"
    if ended.code not in (0, 1, 2) or (ended.code == 2 and not ended.err.strip()):
        return f"{number}: {' '.join(command)[:200]}: ends with {ended.code} and says {ended.err!r}"
    return ""


def test_commands_on_damaged_files_end_with_an_error_of_their_own(call, project, monkeypatch):  # noqa: F811
    monkeypatch.chdir(project)
    faults = [fault_of(call, project, "ci", number) for number in range(IN_CI)]
    assert not any(faults), "\n".join(filter(None, faults))
