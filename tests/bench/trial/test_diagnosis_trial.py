"""The whole trial of the diagnosis, a part each time: results are kept, and the rates so far held to what is wanted.

``SHIPCOSIM_TRIAL_MINUTES`` (default 30) is the time for this part, ``SHIPCOSIM_TRIAL_JOBS`` (default 2) the processes.
The results are in results/trial.jsonl; `python tests/bench/trial table --write` makes docs/reports/diagnosis-trial.md of
them.
"""

import os

import pytest

from trial import manoeuvres, runs, tables
from trial.__main__ import FIRST_SEED

SEEDS = range(FIRST_SEED, FIRST_SEED + 200)
MINUTES = float(os.environ.get("SHIPCOSIM_TRIAL_MINUTES", "30"))
JOBS = int(os.environ.get("SHIPCOSIM_TRIAL_JOBS", "2"))
ENOUGH = 20  # logs, before a rate is held to anything


@pytest.fixture(scope="module")
def results(root):
    """All results so far, with a further part of the plan done."""
    into = root / "results" / "trial.jsonl"
    manoeuvres.sail(runs.KINDS, ["one"], into, jobs=JOBS, minutes=0.2 * MINUTES)
    runs.run(runs.KINDS, list(runs.SETS), SEEDS, into, jobs=JOBS, minutes=0.8 * MINUTES)
    found = [result for result in runs.read_results(into) if result["seed"] in SEEDS]
    print(f"\n{tables.table(found)}")
    return found


@pytest.mark.parametrize(
    "row", [row for row in tables.ROWS if row.hit and any(row.targets)], ids=lambda row: row.label
)
def test_the_rate_so_far_is_compatible_with_what_is_wanted(results, row):
    """The upper (where little is wanted: lower) end of its 95 % interval reaches the target."""
    held = 0
    for kind, target in zip(runs.KINDS, row.targets, strict=True):
        hits, tries = tables.rates(results, row.name, kind, row.hit)
        if tries < ENOUGH or not target.isdigit():
            continue
        low, high = tables.interval(hits, tries)
        wanted = int(target) / 100
        held += 1
        assert low <= wanted if wanted < 0.5 else high >= wanted, f"{kind}: {hits} of {tries}"
    if not held:
        pytest.skip(f"fewer than {ENOUGH} logs so far")
