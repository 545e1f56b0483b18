"""A small trial: the diagnosis names what is hidden about as often as its table says.

The seed is always the same, or that of the week where SHIPCOSIM_FRESH_SEEDS is set (`make nightly`).
"""

import pytest

from trial import runs, scoring, tables
from trial.chance import most
from truth import bench_seed

SAMPLE = (
    ("trial", "one", 4),
    ("work", "one", 3),
    ("trial", "healthy", 1),
    ("work", "healthy", 1),
    ("hold", "healthy", 1),
)
RATES = {
    "trial": {"right": 0.98, "wrong": 0.01, "alarm": 0.01},
    "work": {"right": 0.88, "wrong": 0.02, "alarm": 0.02},
}
RATES["hold"] = RATES["work"]
PROCESSES = 2


@pytest.fixture(scope="module")
def seed():
    return bench_seed()


@pytest.fixture(scope="module")
def judged(seed):
    """Each result with its score, by set."""
    found = {}
    with runs.pool_of(PROCESSES) as pool:
        for kind, name, count in SAMPLE:
            for result in runs.diagnosed(
                kind, name, range(100 * seed, 100 * seed + count), pool=pool
            ):
                diagnosis = result["diagnosis"] or tables.UNJUDGED
                found.setdefault(name, []).append(
                    (result, scoring.score(result["answer"], diagnosis, result["span"]))
                )
    return found


def told(pairs, seed):
    lines = [
        f"{r['kind']} {r['seed']}: {tables.hidden_name(r)} -> {tables.answered_name(r)}"
        for r, _ in pairs
    ]
    return f"\nfirst seed {100 * seed}\n" + "\n".join(lines)


def test_hidden_causes_are_named_as_often_as_in_the_table(judged, seed, capsys):
    with capsys.disabled():
        print(told(judged["one"], seed), end=" ")
    misses = [not score.right for _, score in judged["one"]]
    assert sum(misses) <= most(1.0 - RATES[result["kind"]]["right"] for result, _ in judged["one"])


def test_wrong_names_are_as_rare_as_in_the_table(judged, seed):
    wrong = [score.named and not score.precise for _, score in judged["one"]]
    assert sum(wrong) <= most(RATES[r["kind"]]["wrong"] for r, _ in judged["one"]), told(
        judged["one"], seed
    )


def test_healthy_logs_are_called_healthy_as_often_as_in_the_table(judged, seed):
    alarms = [score.alarm for _, score in judged["healthy"]]
    assert sum(alarms) <= most(RATES[r["kind"]]["alarm"] for r, _ in judged["healthy"]), told(
        judged["healthy"], seed
    )


def test_no_diagnosis_ends_in_an_error(judged):
    assert not [
        result["error"] for pairs in judged.values() for result, _ in pairs if result["error"]
    ]
