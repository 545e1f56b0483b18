"""At night: two thousand commands on damaged files of a project."""

import os

import pytest
from cli.conftest import built, call
from fuzz.test_commands import fault_of, project


@pytest.mark.timeout(3600)
def test_two_thousand_commands_on_damaged_files_end_with_an_error_of_their_own(
    call,
    project,
    monkeypatch,
):
    monkeypatch.chdir(project)
    seed = os.urandom(8).hex() if os.environ.get("SHIPCOSIM_FRESH_SEEDS") else "night"
    faults = [fault_of(call, project, seed, number) for number in range(2000)]
    assert not any(faults), "\n".join([seed, *filter(None, faults)])
