"""At night: ten thousand hostile and damaged files end in a clear error or are harmless."""

import pytest
from fuzz.survive import survive
from fuzz.test_fuzz import (
    IN_CI,
    NUMBER,
    SEED,
    TYPED,
    TYPED_AT_ONCE,
    TYPED_IN_CI,
    TYPED_NUMBER,
    check_noticed,
    shown,
)


@pytest.mark.timeout(3600)
def test_ten_thousand_damaged_files_end_in_a_clear_error_or_are_harmless():
    failures, counts = survive(SEED, IN_CI, NUMBER)
    assert failures == [], shown(failures)
    assert sum(counts.values()) == NUMBER - IN_CI


@pytest.mark.timeout(3600)
def test_three_thousand_files_of_wrong_types_and_sizes_end_in_a_clear_error_or_are_harmless():
    firsts = range(TYPED_IN_CI, TYPED_NUMBER, TYPED_AT_ONCE)
    failures = [one for first in firsts for one in survive(TYPED, first, first + TYPED_AT_ONCE)[0]]
    assert failures == [], shown(failures)


ENDLESS = "import time; end = time.process_time() + 11.0\nwhile time.process_time() < end: pass"


def test_an_input_that_takes_too_long_is_noticed(monkeypatch):
    monkeypatch.setenv("SHIPCOSIM_FUZZ_SABOTAGE", ENDLESS)
    failures, _ = survive(SEED, 0, 1)
    assert "took" in failures[0]["ended"]


@pytest.mark.parametrize(
    ("sabotage", "said"),
    [
        ("open(os.path.join(os.getcwd(), '..', 'x'), 'w')", "wrote"),
        ("x = bytearray(2**31)", "MemoryError"),
    ],
)
def test_what_else_should_not_happen_is_noticed(sabotage, said, monkeypatch):
    check_noticed(sabotage, said, monkeypatch)
