"""What the pages show works: their Python runs, their scenarios are read, their links lead somewhere."""

import re
from pathlib import Path

import pytest

from shipcosim.library import build_stale
from shipcosim.scenario import check_scenario, read_scenario
from shipcosim.ssp import read_system
from shipcosim.sweep import plan_of, read_study

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md")]
PAGES += sorted((ROOT / "docs").glob("*.md"))
PAGES += sorted((ROOT / "docs" / "learn").glob("*.md"))
PAGES += sorted((ROOT / "docs" / "reports").glob("*.md"))
PAGES += sorted((ROOT / "docs" / "generated").glob("*.md"))
PAGES += sorted((ROOT / "fmus").glob("*/README.md"))
TEMPLATES = sorted((ROOT / "docs" / "generators").rglob("*.md"))
USED = ("build", "docs", "fmus", "scenarios", "ssp", "studies")


def blocks(page, language):
    return re.findall(
        rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL
    )


def name_of(page):
    return str(page.relative_to(ROOT))


@pytest.fixture(scope="session")
def fmus():
    return build_stale(ROOT)


@pytest.fixture
def like_the_root(fmus, tmp_path, monkeypatch):
    """A folder in which the project's own are found and in which a page may write."""
    for name in USED:
        (tmp_path / name).symlink_to(ROOT / name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    "page",
    [page for page in PAGES if blocks(page, "python") and page.parent.name != "learn"],
    ids=name_of,
)
def test_python_of_a_page_runs_from_top_to_bottom(page, fmus, tmp_path, monkeypatch):
    """In an empty folder, as for users of pip: no page takes a file of the repository by its path."""
    monkeypatch.chdir(tmp_path)
    scope = {"__name__": "page"}
    for code in blocks(page, "python"):
        exec(compile(code, str(page), "exec"), scope)


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "toml")], ids=name_of)
def test_scenarios_of_a_page_fit_their_system(page, tmp_path, fmus):
    scenarios = [
        text for text in blocks(page, "toml") if "stop_time" in text and "[[quantity]]" not in text
    ]
    for number, text in enumerate(scenarios):
        path = tmp_path / f"scenario{number}.toml"
        path.write_text(
            text.replace('"gunnerus_dp"', f'"{(ROOT / "ssp" / "gunnerus_dp").as_posix()}"'),
            encoding="utf-8",
        )
        scenario = read_scenario(path)
        system = read_system(scenario.system_path, scenario.parameter_paths, fmus=[fmus])
        assert check_scenario(scenario, system) == []


@pytest.mark.parametrize(
    "page",
    [page for page in PAGES if any("[[quantity]]" in text for text in blocks(page, "toml"))],
    ids=name_of,
)
def test_studies_of_a_page_can_be_laid_out(page, like_the_root):
    for number, text in enumerate(text for text in blocks(page, "toml") if "[[quantity]]" in text):
        path = Path(f"study{number}.toml")
        path.write_text(text, encoding="utf-8")
        assert len(plan_of(read_study(path))) > 1


@pytest.mark.parametrize("page", PAGES + TEMPLATES, ids=name_of)
def test_links_of_a_page_lead_to_files(page):
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    targets = [
        target.partition("#")[0]
        for target in re.findall(r"\]\(([^)\s]+)\)", text)
        if "://" not in target
    ]
    missing = [target for target in targets if target and not (page.parent / target).exists()]
    assert missing == []


@pytest.fixture(scope="session")
def tracked():
    """Paths of all files of the project, from its root."""
    folders = ("docs", "fmus", "scenarios", "src", "ssp", "studies", "tests")
    return [
        path.relative_to(ROOT).as_posix()
        for folder in folders
        for path in (ROOT / folder).rglob("*.*")
    ]


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_source_files_that_a_page_names_exist(page, tracked):
    text = re.sub(
        r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL
    )
    named = set(re.findall(r"`([a-z_0-9/]+/[a-z_0-9]+\.py)`", text)) - {
        "fmus/lag/lag.py"
    }  # the reader writes it
    assert {
        name for name in named if not any(f"/{path}".endswith(f"/{name}") for path in tracked)
    } == set()
