"""The pictures of pages in README and docs look like the pages of now."""

import importlib.util
import shutil

import pytest

MOST = 0.08
"""Share of a picture that may look different: other fonts, a figure a little larger. Another layout is 0.3."""


@pytest.fixture(scope="module")
def images(root, needs):
    for tool in ("chromium", "chromedriver"):
        if shutil.which(tool) is None:
            needs(tool)
    for package in ("PIL", "selenium"):
        if importlib.util.find_spec(package) is None:
            needs(package)
    spec = importlib.util.spec_from_file_location("images", root / "docs" / "generators" / "write_images.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", ["four_corner", "capability", pytest.param("diagnosis", marks=pytest.mark.slow)])
def test_picture_is_of_the_page_as_it_is_now(images, name, tmp_path):
    kept = (images.IMAGES / f"{name}.png").read_bytes()
    assert images.difference(kept, images.fresh(name, tmp_path)) <= MOST, "run docs/generators/write_images.py"


def test_another_page_is_clearly_different(images):
    one, other = ((images.IMAGES / f"{name}.png").read_bytes() for name in ("diagnosis", "capability"))
    assert images.difference(one, one) == 0.0
    assert images.difference(one, other) > MOST
