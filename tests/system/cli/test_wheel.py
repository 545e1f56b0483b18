"""The wheel alone is enough: installed into a fresh environment, in an empty folder, the README's quickstart runs.

The bounded test installs the wheel without its dependencies, which it takes from the environment of the tests: it
shows that what we ship is whole, not that the list of dependencies is. The slow one has pip install all of them.
"""

import os
import re
import shlex
import subprocess
import sys
import sysconfig
import tomllib
import zipfile
from importlib.metadata import distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[3]
LARGEST = 350.0  # MB, the whole environment with pip and what Python puts into it
BESIDE = 30.0  # MB of those: pip, setuptools, links
BIN = "Scripts" if os.name == "nt" else "bin"


def megabytes(files):
    """Room that files take on a disk with blocks of 4 KiB, as `du -sm` says it."""
    return (
        sum(
            -(-file.stat().st_size // 4096) * 4096
            for file in files
            if file.is_file() and not file.is_symlink()
        )
        / 2**20
    )


def needed(requirements):
    """Distributions that pip would install for requirements without extras, of those that the tests run with."""
    names, waiting = set(), [Requirement(one) for one in requirements]
    while waiting:
        one = waiting.pop()
        if one.marker is not None and not one.marker.evaluate({"extra": ""}):
            continue
        name = one.name.lower()
        if name not in names:
            names.add(name)
            waiting += [Requirement(text) for text in distribution(name).requires or []]
    return names


def quickstart():
    """Commands of the README's quickstart, word by word."""
    text = (ROOT / "README.md").read_text(encoding="utf-8").partition("## Quickstart")[2]
    return [
        shlex.split(line)
        for line in re.findall(r"```sh\n(.*?)```", text, re.DOTALL)[0].splitlines()
    ]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """Folder with the wheel, made of the repository as it is."""
    pytest.importorskip("hatchling", reason="hatchling builds the wheel: pip install -e '.[test]'")
    out = tmp_path_factory.mktemp("dist")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", out], cwd=ROOT, check=True
    )
    return out


@pytest.fixture
def fresh(wheel, tmp_path):
    """Function that makes an environment, and one that runs a command in it, in an empty folder."""
    venv, folder = tmp_path / "venv", tmp_path / "empty"
    folder.mkdir()
    paths = {
        "PATH": f"{venv / BIN}{os.pathsep}{os.environ['PATH']}",
        "SHIPCOSIM_CACHE": str(tmp_path / "cache"),
    }
    left = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("PYTHON", "VIRTUAL_ENV"))
    }
    environment = left | paths | {"PIP_FIND_LINKS": str(wheel), "COLUMNS": "200"}

    def run(command, here, codes=(0,)):
        done = subprocess.run(command, cwd=here, env=environment, capture_output=True, text=True)
        assert done.returncode in codes, f"{command}\n{done.stdout}\n{done.stderr}"
        return done.stdout

    return venv, folder, run


def follow(commands, folder, run):
    """Run commands one after another; those of `diagnose` end with 1, since they find something."""
    said = {}
    for command in commands:
        if command[0] == "cd":
            folder = folder / command[1]
            continue
        said[" ".join(command[:3])] = run(
            command, folder, codes=(1,) if "diagnose" in command else (0,)
        )
    return said


def shown_verdict():
    """Lines that the README shows of a diagnosis."""
    text = (
        (ROOT / "README.md").read_text(encoding="utf-8").partition("## From a log to a verdict")[2]
    )
    return re.findall(r"```text\n(.*?)```", text, re.DOTALL)[0].splitlines()


def check_first(said):
    """What the first commands of the quickstart came to."""
    assert "report.html" in said["shipcosim run four_corner"]
    found = " ".join(said["shipcosim diagnose gunnerus_log"].split())
    assert "starboard thruster delivers" in found and "less thrust" in found
    assert [line for line in shown_verdict() if " ".join(line.split()) not in found] == []


def test_what_is_installed_with_the_wheel_is_small(wheel):
    """By what the tests run with; no extra counts. The slow test below measures a fresh environment."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    names = needed(project["dependencies"])
    sizes = {
        name: megabytes(Path(str(f.locate())) for f in distribution(name).files or [])
        for name in names
    }
    (file,) = wheel.glob("*.whl")
    with zipfile.ZipFile(file) as archive:
        sizes["shipcosim"] = sum(entry.file_size for entry in archive.infolist()) / 2**20
    assert not {"cmake", "scipy", "torch", "pyarrow", "plotly"} & names
    assert sum(sizes.values()) < LARGEST - BESIDE, sorted(sizes.items(), key=lambda item: -item[1])


def test_pages_that_messages_name_come_with_the_wheel(wheel):
    """Whoever has installed the package can open what a message or a generated file names."""
    sources = [
        file.read_text(encoding="utf-8")
        for kind in ("py", "html", "txt", "toml")
        for file in (ROOT / "src").rglob(f"*.{kind}")
    ]
    named = {page for text in sources for page in re.findall(r"docs/[a-z-]+\.md", text)}
    (file,) = wheel.glob("*.whl")
    with zipfile.ZipFile(file) as archive:
        there = set(archive.namelist())
    assert {"docs/add-a-cause.md", "docs/your-own-ship.md"} <= named
    assert {page for page in named if f"shipcosim/shipped/{page}" not in there} == set()


def test_quickstart_runs_from_the_wheel_in_an_empty_folder(fresh, wheel):
    venv, folder, run = fresh
    run([sys.executable, "-m", "venv", "--without-pip", str(venv)], folder)
    code = "import sysconfig; print(sysconfig.get_path('purelib'))"
    site = Path(run([str(venv / BIN / "python"), "-c", code], folder).strip())
    (file,) = wheel.glob("*.whl")
    install = [
        "-m",
        "pip",
        "--python",
        str(venv),
        "install",
        "--no-deps",
        "--no-index",
        "--quiet",
        str(file),
    ]
    run([sys.executable, *install], folder)
    (site / "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    where = run(
        [str(venv / BIN / "python"), "-c", "import shipcosim; print(shipcosim.__file__)"], folder
    )
    assert Path(where.strip()).is_relative_to(site)
    short = {"four_corner": ["--until", "5"], "tern": ["--until", "5"]}
    commands = [
        [*command, *short.get(command[-1], [])] for command in quickstart() if command[0] != "pip"
    ]
    pytest_ = ["python", "-m", "pytest", "-k", "loaded"]
    said = follow(
        [pytest_ if command == ["pytest"] else command for command in commands], folder, run
    )
    check_first(said)
    # That it runs to its end, and its two expectations.
    assert "3 passed" in said["python -m pytest"] and "PASS" in said["shipcosim run squall"]
    assert "report.html" in said["shipcosim run tern"]
    assert len(run(["shipcosim", "list", "scenarios"], folder).splitlines()) > 30
    assert not list((folder / "my-project").glob("build")) and list(
        (folder.parent / "cache" / "fmus").iterdir()
    )
