"""At night: 300 spoilt descriptions of FMUs, of which check must find what the validator of FMPy finds."""

import os

from cli.test_single_fmu import check_and_validator


def test_check_finds_what_the_validator_of_fmpy_finds_in_300_fmus(tmp_path):
    seed = os.urandom(8).hex() if os.environ.get("SHIPCOSIM_FRESH_SEEDS") else "night"
    verdicts = {n: check_and_validator(f"{seed} {n}", tmp_path) for n in range(300)}
    assert not [n for n, (found, theirs) in verdicts.items() if found != theirs], seed
