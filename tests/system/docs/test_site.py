"""The site is built strictly and without a network: no dead link, no page without a place, nothing loaded from outside."""

import importlib.util
import json
import os
import re
import subprocess
import sys

import pytest
import yaml

OUTSIDE = re.compile(
    r"<(?:script|img|iframe|link)\b[^>]*\b(?:src|href)=[\"']?(https?:)?//[^\"'> ]*"
)
NO_RESOURCE = ('rel="canonical"', "rel=canonical")


def built(config, out, root):
    """Result of a strict build."""
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "-f", config, "-d", out]
    path = os.pathsep.join([str(root / "src"), os.environ.get("PYTHONPATH", "")])
    environment = os.environ | {"PYTHONPATH": path, "NO_MKDOCS_2_WARNING": "1"}
    return subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True)


@pytest.fixture(scope="module")
def site(root, needs, tmp_path_factory):
    """Folder of the site, built from the pages as they are."""
    for package in ("mkdocs", "material", "mkdocstrings", "ziglang"):
        if importlib.util.find_spec(package) is None:
            needs(package, "pip install -e '.[docs,native]'")
    out = tmp_path_factory.mktemp("site")
    done = built(root / "mkdocs.yml", out, root)
    assert done.returncode == 0, done.stderr
    return out


def test_pages_load_nothing_from_the_network(site):
    pages = sorted(site.rglob("*.html"))
    assert len(pages) > 80
    for page in pages:
        found = [match[0] for match in OUTSIDE.finditer(page.read_text(encoding="utf-8"))]
        assert [one for one in found if not any(part in one for part in NO_RESOURCE)] == [], page


def test_every_part_of_the_reference_is_filled(site):
    for page, words in {
        "commands.html": ("shipcosim diagnose", "--channels"),
        "formats.html": ("output_interval", "yaw_gyradius", "thrust_loss", "course_over_ground"),
        "fmus.html": ("thruster_monitor", "dead_reckoning"),
        "fmus/vessel.html": ("wind_load_scale",),
        "python-api.html": ("simulate_many", "read_scenario"),
        "exit-codes.html": ("130",),
        "dataflow.html": ("diagnose/log_faults", "models/propulsion"),
        "dp-loop.html": ("phase margin",),
        "dp-sensors.html": ("all_references_jump",),
    }.items():
        text = (site / page).read_text(encoding="utf-8")
        assert "<!-- generated" not in text
        assert [word for word in words if word not in text] == [], page


def test_a_ship_can_be_steered_on_the_page_of_live_runs(site):
    (frame,) = re.findall(
        r'<iframe src="([^"]+)"', (site / "live.html").read_text(encoding="utf-8")
    )
    page = site / frame
    assert "Four-corner DP test" in page.read_text(encoding="utf-8")
    assert page.stat().st_size < 3_000_000


def test_search_finds_tutorials_guides_reference_and_reports(site):
    (index,) = site.glob("search/search_index.json")
    found = {entry["location"].partition("#")[0] for entry in json.loads(index.read_text())["docs"]}
    assert {
        "learn/own-system.html",
        "studies.html",
        "commands.html",
        "generated/validation.html",
    } <= found


@pytest.mark.parametrize(
    "fault", ["[gone](gone.md)", "[no such heading](index.md#nowhere)", "[absolute](/index.md)"]
)
def test_a_dead_link_ends_the_build(site, fault, root, tmp_path):
    settings = yaml.load((root / "mkdocs.yml").read_text("utf-8"), yaml.BaseLoader)
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "index.md").write_text(f"# Page\n\n{fault}\n")
    own = {"site_name": "x", "validation": settings["validation"], "nav": [{"x": "index.md"}]}
    (tmp_path / "mkdocs.yml").write_text(yaml.safe_dump(own))
    done = built(tmp_path / "mkdocs.yml", tmp_path / "site", root)
    assert done.returncode != 0 and "WARNING" in done.stderr


def test_a_page_without_a_place_ends_the_build(site, root, tmp_path):
    settings = yaml.load((root / "mkdocs.yml").read_text("utf-8"), yaml.BaseLoader)
    (tmp_path / "docs").mkdir()
    for name in ("index", "orphan"):
        (tmp_path / "docs" / f"{name}.md").write_text("# Page\n")
    own = {"site_name": "x", "validation": settings["validation"], "nav": [{"x": "index.md"}]}
    (tmp_path / "mkdocs.yml").write_text(yaml.safe_dump(own))
    assert built(tmp_path / "mkdocs.yml", tmp_path / "site", root).returncode != 0


def test_the_site_has_four_parts_after_its_front_page(root):
    settings = yaml.load((root / "mkdocs.yml").read_text("utf-8"), yaml.BaseLoader)
    assert [next(iter(part)) for part in settings["nav"]] == [
        "Start",
        "Learn",
        "Do",
        "Look up",
        "Believe it or not",
    ]
