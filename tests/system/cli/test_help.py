"""Help: each command has an example, which its own parser takes; what a terminal is too narrow for is not cut off."""

import shlex

import pytest
from typer.main import get_command

from shipcosim.cli import comparison, console
from shipcosim.cli.app import app
from shipcosim.cli.terminal import make_console


def commands():
    """Every command by its words: ("run",), ("export", "fmu")."""
    for name, command in vars(get_command(app))["commands"].items():
        inner = getattr(command, "commands", None)
        for words, one in (
            [((name, n), c) for n, c in inner.items()] if inner else [((name,), command)]
        ):
            yield pytest.param(words, one, id=" ".join(words))


@pytest.mark.parametrize(("words", "command"), [*commands()])
def test_each_command_has_an_example_that_its_parser_takes(words, command):
    _, example = command.help.split("Example: ")
    program, *given = shlex.split(example.replace("\n", " "))
    assert program == "shipcosim" and tuple(given[: len(words)]) == words
    assert command.make_context(words[-1], given[len(words) :]).params


@pytest.mark.parametrize("width", [30, 60, 80, 200])
def test_variables_are_whole_on_any_terminal(width, monkeypatch, capsys):
    monkeypatch.setattr(
        console,
        "make_console",
        lambda **given: make_console(**given, force_terminal=True, width=width, no_color=True),
    )
    rows = [
        (
            "a_very_long_name_of_a_variable_in_the_hull",
            "parameter",
            "Real",
            "kg.m2/s",
            "1234567.875",
            "what it is",
        )
    ]
    console.print_variables(rows)
    said = capsys.readouterr().out
    assert all(cell in said for cell in rows[0]) and "…" not in said


def test_a_comparison_says_first_what_it_will_not_do(monkeypatch):
    missing = {"libcosim": "it is not installed", "ecos": "it is not installed"}
    monkeypatch.setattr(comparison, "engines_missing", lambda: missing)
    *engines, alone = comparison.not_compared()
    assert engines == [f"{name} is not compared: it is not installed" for name in missing]
    assert "the step-size error of ours alone" in alone
    monkeypatch.setattr(comparison, "engines_missing", dict)
    assert comparison.not_compared() == []
