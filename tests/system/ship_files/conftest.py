"""Ships for the tests of ship files."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture
def written(tmp_path):
    """Function that writes the text of a ship file, with parts of it exchanged, and gives its path."""

    def write(text, *changes, name="tern"):
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new, 1)
        path = tmp_path / name / "ship.toml"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    return write
