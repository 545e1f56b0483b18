"""Hostile and damaged files end in a clear error or are harmless: within 10 s, within 1 GiB, nothing written elsewhere.

What is tried is in `fuzz.inputs`, how it is judged in `fuzz.survive`.
"""

import sys

import pytest
from fuzz.inputs import KINDS, write_input
from fuzz.survive import survive

pytestmark = pytest.mark.skipif(
    sys.platform != "linux", reason="memory is limited and measured as Linux does it"
)
SEED, NUMBER, IN_CI = 0, 10_000, 120
TYPED, TYPED_NUMBER, TYPED_IN_CI, TYPED_AT_ONCE = "typed-0", 2850, 50, 200
"""Seed and numbers of well-formed files whose types and sizes are not those meant: `fuzz.typed`.

So many in one process, since what loads FMUs again and again does not give all memory back.
"""


def shown(failures):
    return "\n".join(f"{one['number']} ({one['how']}): {one['ended']}" for one in failures)


def test_some_hundred_damaged_files_end_in_a_clear_error_or_are_harmless():
    failures, counts = survive(SEED, 0, IN_CI)
    assert failures == [], shown(failures)
    assert sum(counts.values()) == IN_CI
    assert (
        counts["clear error"] > IN_CI / 3 and counts["success"] > 0
    )  # neither everything nor nothing is refused


def test_some_files_of_wrong_types_and_sizes_end_in_a_clear_error_or_are_harmless():
    failures, counts = survive(TYPED, 0, TYPED_IN_CI)
    assert failures == [], shown(failures)
    assert counts["clear error"] > TYPED_IN_CI / 3 and counts["success"] > 0


def test_an_input_is_the_same_whenever_it_is_made(tmp_path):
    made = []
    for folder in ("one", "two"):
        ways = [write_input(number, tmp_path / folder / str(number)) for number in range(40)]
        files = sorted(path for path in (tmp_path / folder).rglob("*") if path.is_file())
        made.append(
            (
                [how for _, how in ways],
                [(p.relative_to(tmp_path / folder), p.stat().st_size) for p in files],
            )
        )
    assert made[0] == made[1]


def test_inputs_of_every_kind_are_made(tmp_path):
    hows = [write_input(number, tmp_path / str(number))[1] for number in range(150)]
    assert {how.partition(":")[0] for how in hows} == set(KINDS)


@pytest.mark.parametrize(
    ("sabotage", "said"),
    [
        ("raise KeyError('x')", "KeyError"),
        ("import os; os.abort()", "died"),
    ],
)
def test_what_should_not_happen_is_noticed(sabotage, said, monkeypatch):
    check_noticed(sabotage, said, monkeypatch)  # further ways at night


def check_noticed(sabotage, said, monkeypatch):
    monkeypatch.setenv("SHIPCOSIM_FUZZ_SABOTAGE", f"import os, time; {sabotage}")
    failures, _ = survive(SEED, 0, 1)
    assert said in failures[0]["ended"]
