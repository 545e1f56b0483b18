"""A ship file damaged at random is refused or taken, never a fault of ours."""

import random

import pytest
from ships_at_hand import FILES

from shipcosim.errors import ShipcosimError
from shipcosim.ships import describe
from shipcosim.ships.check import check_ship, estimated
from shipcosim.ships.control import dp_entries, why_no_dp

VALUES = [
    *(
        "0",
        "-1",
        "1e30",
        "1e-30",
        "nan",
        "inf",
        '"abc"',
        "[]",
        "{}",
        "true",
        '""',
        '"1e400 m"',
        "9" * 25,
        '"5 kn"',
    ),
    *(
        "[[1,2]]",
        "{value=1,unit=3}",
        "{value={}}",
        '{value=1,tolerance="x"}',
        "{value=1,uncertainty=[1]}",
        "1e-9",
    ),
    *("0.001", "1000", "2026-01-01", "{table=3}", '"-5 m"'),
]


@pytest.mark.parametrize("seed", range(100))
def test_a_damaged_ship_file_ends_in_problems_or_in_a_ship(seed, tmp_path):
    dice = random.Random(seed)
    lines = dice.choice(list(FILES.values())).splitlines()
    for _ in range(dice.choice((1, 1, 2, 3))):
        at, kind = dice.randrange(len(lines)), dice.random()
        if kind < 0.7 and "=" in lines[at]:
            lines[at] = f"{lines[at].split('=')[0]} = {dice.choice(VALUES)}"
        elif kind < 0.8:
            lines[at] = ""
        elif kind < 0.9:
            lines.insert(at, dice.choice(lines))
        else:
            lines[at] = lines[at][: dice.randrange(len(lines[at]) + 1)]
    path = tmp_path / "ship.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    found = check_ship(str(path))
    assert all(problem.where and problem.found for problem in found)
    if not any(problem.severity == "error" for problem in found):
        ship = describe(path)
        assert estimated(ship)
        try:
            assert why_no_dp(ship) or dp_entries(ship)
        except ShipcosimError:
            pytest.fail("what passes the check has a DP or a reason why not")
