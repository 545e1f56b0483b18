"""Each tutorial works by its words alone, from an empty folder.

Its blocks are taken in order. One with a file name as title is written to that file. `sh` blocks are run; those with
the title "exit code 1" must end so. Python without a title is run. Lines of `text` blocks must stand in the output of
the commands before; a title says that such a block shows something else. Commands of shipcosim are called in the
process of the test: that they start from a shell too is shown by `cli/test_wheel.py`.
"""

import importlib.util
import os
import re
import shlex
import subprocess
from pathlib import Path

import pytest
from typer.testing import CliRunner

from shipcosim.cli import app

PAGES = sorted((Path(__file__).parents[3] / "docs" / "learn").glob("*.md"))
BLOCK = re.compile(r'^```(\w+)(?: title="([^"]+)")?\n(.*?)^```', re.MULTILINE | re.DOTALL)


@pytest.fixture
def shell(tmp_path, monkeypatch):
    """Function that runs the commands of a script in an empty folder: what they say. The last must end with the code."""
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.chdir(tmp_path)

    def run(script, code=0):
        *before, last = script.replace("\\\n", " ").splitlines()
        return "".join([one(command, 0) for command in before] + [one(last, code)])

    def one(command, code):
        program, *arguments = shlex.split(command)
        if program == "shipcosim":
            done = CliRunner().invoke(app, arguments, prog_name="shipcosim")
            ended, said = done.exit_code, done.output
        else:
            other = subprocess.run(["sh", "-ec", command], capture_output=True, text=True)
            ended, said = other.returncode, other.stdout + other.stderr
        assert ended == code, f"{command}\n{said}"
        return said

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
