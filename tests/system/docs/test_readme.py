"""The README is short, says what works, and shows outside of the repository."""

import importlib.util
import re
import tomllib

import pytest

WORDS, SENTENCE = 900, 25


@pytest.fixture(scope="module")
def readme(root):
    return (root / "README.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def hook(root):
    """The module that makes the README of the packages."""
    pytest.importorskip(
        "hatchling", reason="hatchling builds the packages: pip install -e '.[test]'"
    )
    spec = importlib.util.spec_from_file_location("hatch_build", root / "hatch_build.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_it_is_short_and_so_are_its_sentences(readme, generator):
    texts = generator("sentences")
    assert texts.words(readme) <= WORDS
    assert [one for one in texts.sentences(readme) if texts.length(one) > SENTENCE] == []


def test_contributing_is_a_page(root, generator):
    assert generator("sentences").words((root / "CONTRIBUTING.md").read_text("utf-8")) <= 500


def test_its_first_block_is_what_a_fresh_machine_needs(readme, root):
    first = re.findall(r"```sh\n(.*?)```", readme, re.DOTALL)[0].splitlines()
    assert [line.split("#")[0].split()[:2] for line in first] == [
        ["git", "clone"],
        ["cd", "shipcosim"],
        ["make", "demo"],
        ["make", "test"],
    ]
    targets = re.findall(r"(?m)^([a-z]+):", (root / "Makefile").read_text(encoding="utf-8"))
    assert set(re.findall(r"`make (\w+)`", readme)) <= set(targets)


def test_the_demo_shows_the_lines_that_it_promises(readme, root):
    scenario = tomllib.loads((root / "scenarios" / "four_corner.toml").read_text("utf-8"))
    assert "You see ten lines that begin with `pass`" in readme and len(scenario["expect"]) == 10
    assert "run scenarios/four_corner.toml" in (root / "Makefile").read_text("utf-8")


def test_every_command_that_it_names_exists(readme, generator):
    look_up = generator("look_up")
    known = {name for name, _ in look_up.all_commands(look_up.command_group())}
    shown = "".join(re.findall(r"(?ms)^```(?:sh)?\n(.*?)^```", readme))
    assert shown.count("shipcosim") > 8
    for words in re.findall(r"(?m)^shipcosim (.*)$", shown):
        one, two, *_ = [*words.split(), ""]
        assert f"shipcosim {one}" in known or f"shipcosim {one} {two}" in known, words


def test_it_has_no_relative_link_in_a_package_with_an_address(readme, hook):
    text = hook.outside_the_repository(readme, "https://host/owner/shipcosim")
    targets = re.findall(r"\]\(([^)]+)\)", text)
    assert len(targets) > 20 and all(
        target.startswith("https://host/owner/shipcosim/") for target in targets
    )
    assert "![" in text and "/raw/main/docs/images/live.png" in text


def test_it_has_no_link_in_a_package_without_an_address(readme, hook):
    text = hook.outside_the_repository(readme, "")
    assert re.findall(r"\]\(([^)]+)\)", text) == [] and "![" not in text
    assert "trial (`docs/reports/diagnosis-trial.md`)" in text


def test_every_address_of_the_project_is_a_file_of_it(hook, root):
    """Those that lead into the repository, so that an address set later has no dead link."""
    for name, address in hook.urls("https://host/owner/shipcosim").items():
        path = address.partition("/main/")[2]
        assert not path or (root / path).exists(), name


def test_the_packages_say_who_may_use_them_and_where_they_run(root):
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert {"authors", "license", "classifiers", "keywords"} <= set(project)
    assert {"readme", "urls", "version"} <= set(project["dynamic"])


def test_the_changelog_has_one_line_a_change_and_500_words(root):
    """Under the four headings, of the version that CITATION.cff names."""
    text = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    newest = re.split(r"(?m)^## ", text)[1]
    version = re.findall(r"(?m)^version: (.*)$", (root / "CITATION.cff").read_text("utf-8"))
    assert newest.split(",")[0] == version[0]
    assert re.findall(r"(?m)^### (.*)$", newest) == ["Breaking", "Added", "Fixed", "Deprecated"]
    entries = newest.partition("### Breaking")[2].splitlines()
    assert [line for line in entries if line and not line.startswith(("- ", "### "))] == []
    assert [line for line in entries if len(line) > 140] == []
    assert sum(len(re.findall(r"\S*\w\S*", line)) for line in entries) <= 500
