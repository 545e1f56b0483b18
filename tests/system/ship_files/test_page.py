"""The ship file that the page shows is one that can be."""

import re

from shipcosim.ships.check import check_ship


def test_ship_file_of_the_page_has_no_mistake_and_holds_with_one_azimuth(root, tmp_path):
    """It has one azimuth and a tunnel, to be short: the azimuth turns, so there is a DP."""
    text = (root / "docs" / "your-own-ship.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```toml\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    (tmp_path / "ship.toml").write_text(
        next(b for b in blocks if "[particulars]" in b), encoding="utf-8"
    )
    found = check_ship(str(tmp_path))
    assert found and {problem.severity for problem in found} == {"remark"}
    assert not any("no DP system" in problem.found for problem in found)


def test_page_lists_every_key_of_a_ship_file(root):
    from shipcosim.ships.file import (
        KINDS,
        Control,
        Drag,
        Inertia,
        Particulars,
        Resistance,
        ShipFile,
        Waves,
        Wind,
    )

    text = (root / "docs" / "your-own-ship.md").read_text(encoding="utf-8")
    sections = (
        Particulars,
        Inertia,
        Resistance,
        Drag,
        Wind,
        Waves,
        Control,
        ShipFile,
        *KINDS.values(),
    )
    missing = {
        key
        for record in sections
        for key in record.model_fields
        if not re.search(rf"\b{key}\b", text)
    }
    assert missing == set()
