"""Every picture in README and docs has a command that makes it, and looks like what that command makes now."""

import importlib.util
import re
import shutil

import pytest

MOST = 0.08
"""Share of a picture that may look different: other fonts, a figure a little larger. Another layout is 0.3."""


@pytest.fixture(scope="module")
def images(root, needs):
    for tool in ("chromium", "chromedriver"):
        if shutil.which(tool) is None:
            needs(tool)
    for package in ("PIL", "selenium", "matplotlib"):
        if importlib.util.find_spec(package) is None:
            needs(package)
    spec = importlib.util.spec_from_file_location(
        "images", root / "docs" / "generators" / "write_images.py"
    )
    module = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(root / "docs" / "generators"))
        spec.loader.exec_module(module)
        yield module


def test_every_picture_is_listed_with_the_command_that_makes_it(root):
    folders = ("docs/*.md", "docs/*/*.md", "fmus/*/README.md", "tests/bench/*/README.md")
    pages = [root / "README.md", *(page for folder in folders for page in root.glob(folder))]
    shown = {
        (page.parent / path).resolve().relative_to(root).as_posix()
        for page in pages
        for path in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", page.read_text(encoding="utf-8"))
    }
    rows = re.findall(
        r"(?m)^\| `(docs/[^`]+)` \| `([^`]+)` \|",
        (root / "docs" / "dataflow.md").read_text("utf-8"),
    )
    listed = dict(rows)
    assert shown == set(listed), "the table of pictures in docs/dataflow.md"
    there = {
        path.relative_to(root).as_posix()
        for kind in ("png", "svg")
        for path in root.glob(f"docs/**/*.{kind}")
    }
    assert there == set(listed)
    assert all((root / command.split()[1]).is_file() for command in listed.values())


def test_another_page_is_clearly_different(images):
    one, other = (
        (images.IMAGES / f"{name}.png").read_bytes() for name in ("diagnosis", "capability")
    )
    assert images.difference(one, one) == 0.0
    assert images.difference(one, other) > MOST
