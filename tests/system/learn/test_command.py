"""The command `train allocator`."""

import sys
from dataclasses import replace

import pytest
from typer.testing import CliRunner

from shipcosim import learn
from shipcosim.cli import app
from shipcosim.learn import kinds, paper_v
from shipcosim.learn.training import Schedule


@pytest.fixture
def tiny(monkeypatch):
    """A kind that is trained at once."""
    recipe = replace(
        paper_v.RECIPES["paper-v"],
        batches=10,
        sequences=2,
        samples=8,
        schedule=Schedule(most_epochs=1),
    )
    monkeypatch.setitem(
        learn.COMPONENTS, "allocator", kinds._kinds({"tiny": recipe}, paper_v.train)
    )


def train(*arguments):
    """What the command answers."""
    return CliRunner().invoke(
        app, ["train", "allocator", *map(str, arguments)], prog_name="shipcosim"
    )


def test_it_leaves_weights_and_report(tiny, tmp_path):
    done = train("--kind", "tiny", "--out", tmp_path / "new")
    assert done.exit_code == 0
    assert [line.rpartition("/")[2] for line in done.stdout.splitlines()] == [
        "tiny.npz",
        "tiny.json",
        "tiny.md",
    ]
    assert sorted(file.name for file in (tmp_path / "new").iterdir()) == [
        "tiny.json",
        "tiny.md",
        "tiny.npz",
    ]


def test_earlier_weights_are_kept(tiny, tmp_path):
    for _ in range(2):
        assert train("--kind", "tiny", "--out", tmp_path / "new").exit_code == 0
    assert (tmp_path / "new-1" / "tiny.npz").is_file()


def test_an_unknown_kind_is_answered_by_those_there_are():
    done = train("--kind", "paper-w")
    assert (
        done.exit_code == 2 and "There is no 'paper-w'" in done.stderr and "paper-v" in done.stderr
    )


def test_without_torch_one_error_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "torch", None)
    for name in [name for name in sys.modules if name.startswith("shipcosim.learn")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.delattr("shipcosim.learn", raising=False)
    done = train()
    assert (
        done.exit_code == 2
        and 'pip install "shipcosim[learn]"' in done.stderr
        and "Traceback" not in done.stderr
    )
