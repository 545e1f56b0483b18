"""`shipcosim docs` opens the site where it is built and a browser is there, else it shows the page."""

import webbrowser

import pytest
from typer.testing import CliRunner

from shipcosim import library
from shipcosim.cli import app
from shipcosim.cli.commands import list as command


class Terminal:
    """Stands for the console of a person at a terminal."""

    is_terminal = True

    def print(self, text):
        print("shown in the terminal")


@pytest.fixture
def opened(tmp_path, monkeypatch):
    """Addresses that the browser was asked for, in a clone with a built site, at a terminal."""
    for name in ("docs/learn/own-log.md", "docs/theory.md"):
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("# Page\n")
    for name in ("index.html", "learn/own-log.html"):
        file = tmp_path / "build" / "site" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("<html>")
    addresses = []
    monkeypatch.setattr(library, "shipped", lambda: tmp_path)
    monkeypatch.setattr(command, "make_console", Terminal)
    monkeypatch.setattr(webbrowser, "open", lambda address: addresses.append(address) or True)
    return addresses


def test_the_site_is_opened_at_the_page(opened):
    for arguments, end in (([], "site/index.html"), (["own-log"], "site/learn/own-log.html")):
        done = CliRunner().invoke(app, ["docs", *arguments])
        assert done.exit_code == 0 and opened[-1].endswith(end)
        assert opened[-1].startswith("file:") and end in done.output


def test_a_page_that_the_site_lacks_is_shown_in_the_terminal(opened):
    assert "shown in the terminal" in CliRunner().invoke(app, ["docs", "theory"]).output
    assert opened == []


def test_the_terminal_can_be_asked_for(opened):
    done = CliRunner().invoke(app, ["docs", "own-log", "--terminal"])
    assert "shown in the terminal" in done.output and opened == []


def test_without_a_browser_the_page_is_shown_in_the_terminal(opened, monkeypatch):
    monkeypatch.setattr(webbrowser, "open", lambda address: False)
    assert "shown in the terminal" in CliRunner().invoke(app, ["docs", "own-log"]).output


def test_a_pipe_gets_the_text(opened, monkeypatch):
    monkeypatch.undo()
    done = CliRunner().invoke(app, ["docs", "own-log"])
    assert done.output.startswith("# Your log")
