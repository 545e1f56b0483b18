"""Each tutorial works by its words alone, from an empty folder.

Its blocks are taken in order. One with a file name as title is written to that file. `sh` blocks are run; those with
the title "exit code 1" must end so. Python without a title is run. Lines of `text` blocks must stand in the output of
the commands before; a title says that such a block shows something else.
"""

import importlib.util
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

PAGES = sorted((Path(__file__).parents[3] / "docs" / "learn").glob("*.md"))
BLOCK = re.compile(r'^```(\w+)(?: title="([^"]+)")?\n(.*?)^```', re.MULTILINE | re.DOTALL)
STAND_INS = {
    "shipcosim": "from shipcosim.cli import main; main()",
    "pytest": "import pytest, sys; sys.exit(pytest.main())",
}


@pytest.fixture
def shell(root, tmp_path, monkeypatch):
    """Function that runs a script in an empty folder, with the commands of an environment with shipcosim."""
    programs, empty = tmp_path / "bin", tmp_path / "empty"
    programs.mkdir()
    empty.mkdir()
    for name, code in STAND_INS.items():
        script = programs / name
        script.write_text(
            f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -c {shlex.quote(code)} "$@"\n'
        )
        script.chmod(0o755)
    path = os.pathsep.join([str(root / "src"), os.environ.get("PYTHONPATH", "")])
    monkeypatch.setenv("PYTHONPATH", path)
    monkeypatch.setenv("PATH", f"{programs}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.chdir(empty)

    def run(script, code=0):
        done = subprocess.run(["sh", "-ec", script], capture_output=True, text=True)
        assert done.returncode == code, f"{script}\n{done.stdout}\n{done.stderr}"
        return done.stdout + done.stderr

    return run


@pytest.mark.skipif(os.name == "nt", reason="the commands are those of a POSIX shell")
@pytest.mark.parametrize(
    "page", [p for p in PAGES if p.stem != "index"], ids=lambda page: page.stem
)
def test_a_tutorial_works_from_an_empty_folder(page, shell, needs):
    for package in re.findall(r"(?m)^from (libcosimpy)", page.read_text(encoding="utf-8")):
        if importlib.util.find_spec(package) is None:
            needs(package)
    printed, scope = "", {"__name__": "page"}
    for language, title, text in BLOCK.findall(page.read_text(encoding="utf-8")):
        if language == "sh":
            printed += " ".join(shell(text, code=1 if title == "exit code 1" else 0).split())
        elif language == "text" and not title:
            lines = [" ".join(line.split()) for line in text.splitlines() if line.strip()]
            assert [line for line in lines if line not in printed] == [], printed[-2000:]
        elif language == "python" and not title:
            exec(compile(text, page.stem, "exec"), scope)
        elif title and "/" in title or "." in title:
            Path(title).parent.mkdir(parents=True, exist_ok=True)
            Path(title).write_text(text, encoding="utf-8")


def test_tutorials_have_what_the_site_promises():
    assert {page.stem for page in PAGES} >= {
        "first-run",
        "own-system",
        "own-ship",
        "own-log",
        "other-tools",
    }
